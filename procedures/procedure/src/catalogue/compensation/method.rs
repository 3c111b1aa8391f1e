//! The compensation methods and their feed-forward, from the friction in the parameters.

use crate::parameter::Values;
use crate::plan::{Drive, Feedforward};
use crate::profile::Profile;
use jointbench_instrument::bench::JointConstants;

/// Around zero velocity the jump of Coulomb friction is omitted or linearised (link side).
const RAMP_RAD_S: f64 = 0.05;
/// The full model includes that region: its slope is limited only by the uncertainty of the velocity set-point.
const STEEP_RAD_S: f64 = 0.002;
/// Corner frequency of the observer.
const CORNER_HZ: f64 = 10.0;

/// Difference of the column `repeat` between rounds.
const ROUND: u32 = 100;

/// The compensation methods. The column `repeat` contains these numbers in the first round; stored runs have them too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Method {
    None = 0,
    DeadBand = 1,
    Interpolated = 2,
    CoulombViscous = 3,
    Full = 4,
    Observer = 5,
    IdealCoulomb = 6,
    Load = 7,
    Dynamic = 8,
    ObserverAndModel = 9,
}

impl Method {
    /// In the order of the rows of a report.
    pub const ALL: [Method; 10] = [
        Method::None,
        Method::IdealCoulomb,
        Method::DeadBand,
        Method::Interpolated,
        Method::CoulombViscous,
        Method::Full,
        Method::Load,
        Method::Dynamic,
        Method::Observer,
        Method::ObserverAndModel,
    ];

    /// Suffix of its quantities, and its name for people.
    pub fn words(self) -> [&'static str; 2] {
        match self {
            Method::None => ["none", "no compensation"],
            Method::IdealCoulomb => ["ideal_coulomb", "ideal Coulomb"],
            Method::DeadBand => ["zero_area", "Coulomb with dead band"],
            Method::Interpolated => ["interpolated", "Coulomb, interpolated"],
            Method::CoulombViscous => ["coulomb_viscous", "Coulomb and viscous"],
            Method::Full => ["full", "full model"],
            Method::Load => ["load", "full model with load term"],
            Method::Dynamic => ["dynamic", "dynamic model"],
            Method::Observer => ["observer", "observer"],
            Method::ObserverAndModel => ["observer_and_model", "observer and full model"],
        }
    }

    /// Its number in the column `repeat`.
    pub fn repeat(self, round: u32) -> u32 {
        self as u32 + round * ROUND
    }

    /// Whether its own parameters are known.
    pub fn is_planned(self, values: &Values) -> bool {
        match self {
            Method::Load => values.number("load_friction") > 0.0,
            Method::Dynamic => values.number("presliding_stiffness_nm_rad") > 0.0,
            _ => true,
        }
    }
}

/// Friction from the parameters, over the link velocity; motor torque.
pub(super) struct FrictionParameters {
    coulomb_nm: f64,
    viscous_nm_s: f64,
    rise_nm: f64,
    stribeck_rad_s: f64,
    exponent: f64,
    /// σ₀; 0 if unknown.
    bristle_nm_rad: f64,
    /// Friction per load torque, both at the motor; 0 if unknown.
    load_friction: f64,
    gear_ratio: f64,
    torque_constant_nm_per_a: f64,
}

impl FrictionParameters {
    pub fn new(values: &Values, constants: &JointConstants) -> Self {
        let coulomb_nm = values.number("tau_c_nm");
        Self {
            coulomb_nm,
            viscous_nm_s: values.number("c_v_nm_s"),
            rise_nm: (values.number("tau_h_nm") - coulomb_nm).max(0.0),
            stribeck_rad_s: values.number("stribeck_speed_rad_s"),
            exponent: values.number("stribeck_exponent"),
            bristle_nm_rad: values.number("presliding_stiffness_nm_rad"),
            load_friction: values.number("load_friction"),
            gear_ratio: constants.gear_ratio,
            torque_constant_nm_per_a: constants.torque_constant_nm_per_a,
        }
    }

    /// Friction without its viscous part, at steady motion: g(ω) of LuGre.
    fn level_nm(&self, link_rad_s: f64) -> f64 {
        self.coulomb_nm + self.rise_nm * (-(link_rad_s.abs() / self.stribeck_rad_s).powf(self.exponent)).exp()
    }

    fn viscous_nm(&self, link_rad_s: f64) -> f64 {
        self.viscous_nm_s * self.gear_ratio * link_rad_s
    }

    pub fn friction_nm(&self, link_rad_s: f64) -> f64 {
        self.level_nm(link_rad_s).copysign(link_rad_s) + self.viscous_nm(link_rad_s)
    }

    /// Feed-forward of a static model, before scaling. `None`: the method has none.
    pub fn static_nm(&self, method: Method, link_rad_s: f64) -> Option<f64> {
        let line = |over: f64| (link_rad_s / over).clamp(-1.0, 1.0);
        match method {
            Method::None | Method::Observer | Method::IdealCoulomb | Method::Dynamic => None,
            Method::DeadBand if link_rad_s.abs() < RAMP_RAD_S => Some(0.0),
            Method::DeadBand => Some(self.coulomb_nm.copysign(link_rad_s)),
            Method::Interpolated => Some(self.coulomb_nm * line(RAMP_RAD_S)),
            Method::CoulombViscous => Some(self.coulomb_nm * line(RAMP_RAD_S) + self.viscous_nm(link_rad_s)),
            Method::Full | Method::Load | Method::ObserverAndModel => {
                Some(self.friction_nm(link_rad_s).abs() * line(STEEP_RAD_S))
            }
        }
    }

    /// Friction of the dynamic model (LuGre, Canudas de Wit et al. 1995, without bristle damping) along one period of
    /// a periodic velocity, after a period that brings the bristles into their cycle.
    fn dynamic_nm(&self, link_rad_s: &[f64], step_s: f64) -> Vec<f64> {
        let mut bristle_nm = 0.0;
        let mut along = || -> Vec<f64> {
            let advance = |v: &f64| {
                let level_nm = self.level_nm(*v).copysign(*v);
                // Exact for a constant velocity.
                let turned_nm = self.bristle_nm_rad * self.gear_ratio * v.abs() * step_s;
                let fading = turned_nm / level_nm.abs().max(f64::MIN_POSITIVE);
                bristle_nm = level_nm + (bristle_nm - level_nm) * (-fading).exp();
                bristle_nm + self.viscous_nm(*v)
            };
            link_rad_s.iter().map(advance).collect()
        };
        along();
        along()
    }

    /// The command of the drive along a periodic link velocity, sampled every `step_s` over one period.
    pub fn drive(&self, method: Method, share: f64, period: &[f64], step_s: f64, periods: u32) -> Drive {
        let ramp_rad_s = RAMP_RAD_S * self.gear_ratio;
        let current_a = |nm: f64| share * nm / self.torque_constant_nm_per_a;
        let of_model = |method: Method| {
            let nm = match method {
                Method::Dynamic => self.dynamic_nm(period, step_s),
                _ => period.iter().map(|v| self.static_nm(method, *v).unwrap_or(0.0)).collect(),
            };
            let points = nm.iter().cycle().take(nm.len() * periods as usize);
            points.fold(Profile::from(0.0), |profile, nm| profile.to(current_a(*nm), step_s))
        };
        let observed = |planned_a| Feedforward::Observed { planned_a, share, corner_hz: CORNER_HZ, ramp_rad_s };
        Drive::Fed(match method {
            Method::None => return Drive::Velocity,
            Method::IdealCoulomb => Feedforward::MeasuredDirection { current_a: current_a(self.coulomb_nm) },
            Method::Observer => observed(Profile::constant(0.0)),
            Method::ObserverAndModel => observed(of_model(method)),
            Method::Load => {
                let per_nm = current_a(self.load_friction / self.gear_ratio);
                Feedforward::LoadDependent { planned_a: of_model(method), a_per_nm: per_nm, ramp_rad_s }
            }
            _ => Feedforward::Planned(of_model(method)),
        })
    }
}
