//! Friction of the joint without load over speed, motor side.

use crate::findings::{Plateau, Unusable, combined, interval_of, parameter};
use jointbench_model::preprocess::Prepared;
use jointbench_model::signal::Signal;
use jointbench_model::{Fit, ModelError, ModelSpec, Options, fit_prepared};

/// A figure with its 95 % interval.
pub(super) type Figured = (f64, [f64; 2]);

/// Static friction over speed, motor side.
pub(super) struct FreeFriction {
    pub coulomb: Figured,
    pub viscous: Figured,
    /// `None`: no significant rise at low speed.
    pub stribeck: Option<Stribeck>,
}

/// Rise of Coulomb friction, the motor speed at which it decays, and the exponent.
pub(super) struct Stribeck {
    pub rise: Figured,
    pub speed: Figured,
    pub exponent: Figured,
}

impl FreeFriction {
    /// Fits the legs without load, with a Stribeck part if the run identifies it and its validation error is smaller.
    pub fn of(run: &Prepared) -> Result<Self, Unusable> {
        let (rich, plain) = (fit_with(run, &["stribeck"]), fit_with(run, &[])?);
        if let Ok(rich) = rich
            && rich.validation_rms < plain.validation_rms
            && let Some(rise) = parameter(&rich, "stribeck", "tau_s")
            && let Some(speed) = parameter(&rich, "stribeck", "omega_s")
            && let Some(exponent) = rich.parameters.iter().find(|p| p.effect == "stribeck" && p.name == "delta")
        {
            let [rise, speed, exponent] = [rise, speed, exponent].map(|p| interval_of(p, 1.0));
            return Self::from(&rich, Some(Stribeck { rise, speed, exponent }));
        }
        Self::from(&plain, None)
    }

    fn from(fit: &Fit, stribeck: Option<Stribeck>) -> Result<Self, Unusable> {
        let figure = |effect, name| parameter(fit, effect, name).map(|p| interval_of(p, 1.0));
        let coulomb = figure("coulomb", "tau_c");
        let viscous = figure("viscous", "c_v");
        match (coulomb, viscous) {
            (Some(coulomb), Some(viscous)) => Ok(Self { coulomb, viscous, stribeck }),
            _ => Err(Unusable::Scattered { rest_nm: fit.rms }),
        }
    }

    /// Friction at a motor speed above 0.
    pub fn at(&self, speed_rad_s: f64) -> f64 {
        let rise =
            self.stribeck.as_ref().map_or(0.0, |s| s.rise.0 * (-(speed_rad_s / s.speed.0).powf(s.exponent.0)).exp());
        self.coulomb.0 + self.viscous.0 * speed_rad_s + rise
    }

    /// Breakaway torque at rest.
    pub fn breakaway(&self) -> Option<Figured> {
        self.stribeck.as_ref().map(|s| combined(self.coulomb, s.rise, 1.0))
    }
}

/// Fits Coulomb and viscous friction with further effects.
pub(super) fn fit_with(run: &Prepared, more: &[&str]) -> Result<Fit, ModelError> {
    let load = run.main.view.find(Signal::Load).map(|_| "load_transmission");
    let effects = load.into_iter().chain(["coulomb", "viscous"]).chain(more.iter().copied());
    fit_prepared(run, &ModelSpec::new(run.kind, effects)?, &Options::default())
}

/// Friction torque of a point, without its load.
pub(super) fn friction_nm(point: &Plateau) -> f64 {
    point.target - point.load_nm
}
