//! The load behind the torque sensor: brake A alone, or brake A idle and behind it the 1:10 gear with brake B.

use super::brake::Brake;
use super::friction::Friction;
use super::hidden::HiddenBrake;
use super::{CoilSupply, curve};
use crate::sim::data_sheet::{LINE_RATIO as RATIO, Load, brake};

/// Shafts and wheels, reduced to the link (assumed).
const GEAR_KG_M2: f64 = 0.05;
/// Friction of the gear, link side, over the link speed [rad/s]: several Nm at breakaway, far less in rotation, more
/// again because of oil churning (assumed: the owner of the bench only says "strongly non-linear").
const GRIP_NM: [(f64, f64); 7] = [(0.0, 4.0), (0.05, 3.0), (0.2, 2.2), (0.6, 1.9), (1.5, 2.3), (4.0, 3.6), (8.0, 5.0)];

struct Geared {
    idle: Brake,
    friction: Friction,
}

enum Behind {
    Nothing,
    BrakeA,
    Gear(Box<Geared>),
}

pub struct Line {
    behind: Behind,
}

impl Line {
    pub fn new(load: Load, brake_nm: f64) -> Self {
        let geared = || Geared {
            idle: Brake::new(brake_nm, HiddenBrake::default()),
            friction: Friction::new(GRIP_NM[0].1, 0.0, inertia_kg_m2(load)),
        };
        let behind = match load {
            Load::None => Behind::Nothing,
            Load::BrakeA => Behind::BrakeA,
            Load::GearAndBrakeB => Behind::Gear(Box::new(geared())),
        };
        Self { behind }
    }

    /// Torque on the link after one step, with `fed` as the brake that the supply feeds.
    pub fn advance(&mut self, fed: &mut Brake, supply: Option<CoilSupply>, link_rad_s: f64) -> f64 {
        let Geared { idle, friction } = match &mut self.behind {
            Behind::Nothing => return 0.0,
            Behind::BrakeA => return fed.advance(supply, link_rad_s),
            Behind::Gear(geared) => geared.as_mut(),
        };
        let grip_nm = curve::at(&GRIP_NM, link_rad_s.abs());
        let gear_nm = friction.advance(link_rad_s, grip_nm);
        idle.advance(None, link_rad_s) + gear_nm + RATIO * fed.advance(supply, RATIO * link_rad_s)
    }
}

/// Inertia of all rotating parts behind the torque sensor.
pub fn inertia_kg_m2(load: Load) -> f64 {
    match load {
        Load::None => 0.0,
        Load::BrakeA => brake::INERTIA_KG_M2,
        Load::GearAndBrakeB => brake::INERTIA_KG_M2 * (1.0 + RATIO * RATIO) + GEAR_KG_M2,
    }
}
