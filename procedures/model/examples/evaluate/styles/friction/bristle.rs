//! Presliding contacts: three models of the literature.

use crate::made::Dice;

/// How contacts follow a motion. Deflections are shares of the presliding displacement.
#[derive(Clone)]
pub enum Bristle {
    /// Canudas de Wit, Olsson, Åström, Lischinsky 1995.
    LuGre(f64),
    /// Dupont, Hayward, Armstrong, Altpeter 2002: no slip below the share.
    ElastoPlastic(f64, f64),
    /// Al-Bender, Lampaert, Swevers 2005: reach, weight and deflection of each element.
    MaxwellSlip(Vec<(f64, f64, f64)>),
}

impl Bristle {
    pub fn draw(dice: &mut Dice) -> Self {
        match dice.uniform(0.0, 3.0) as u32 {
            0 => Self::LuGre(0.0),
            1 => Self::ElastoPlastic(0.0, dice.uniform(0.2, 0.7)),
            _ => {
                let parts: Vec<f64> = (0..5).map(|_| dice.uniform(0.3, 1.0)).collect();
                let all: f64 = parts.iter().sum();
                Self::MaxwellSlip((0..5).map(|i| (0.3 + 0.4 * i as f64, parts[i] / all, 0.0)).collect())
            }
        }
    }

    pub fn name(&self) -> &'static str {
        match self {
            Self::LuGre(_) => "LuGre",
            Self::ElastoPlastic(..) => "elasto-plastic",
            Self::MaxwellSlip(_) => "Maxwell-slip",
        }
    }

    /// The state after a displacement, given as a share of the presliding displacement.
    pub fn after(&mut self, way: f64) -> f64 {
        match self {
            Self::LuGre(state) => {
                let end = way.signum();
                *state = end + (*state - end) * (-way.abs()).exp();
                *state
            }
            Self::ElastoPlastic(state, sticks) => {
                let end = way.signum();
                let slipping = ((*state * end - *sticks) / (1.0 - *sticks)).clamp(0.0, 1.0);
                let share = 0.5 - 0.5 * (std::f64::consts::PI * slipping).cos();
                *state = (*state + way - share * *state * way.abs()).clamp(-1.0, 1.0);
                *state
            }
            Self::MaxwellSlip(parts) => parts
                .iter_mut()
                .map(|(reach, part, state)| {
                    *state = (*state + way / *reach).clamp(-1.0, 1.0);
                    *part * *state
                })
                .sum(),
        }
    }
}
