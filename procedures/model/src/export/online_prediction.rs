//! Online prediction of a friction model during a run, row by row.

use crate::effect::Regime;
use crate::export::predict;
use crate::report::fit::Fit;
use crate::signal::Signal;
use crate::user_effects::{find_with_user_effects, signals_with};
use jointbench_instrument::{Kind, Trace};

/// Below this share of the fastest fitted speed, the direction of the previous motion is kept.
const STILL: f64 = 0.005;

/// Measured and predicted motor torque, row by row.
#[derive(Debug)]
pub struct OnlinePrediction {
    fit: Fit,
    torque_constant_nm_per_a: f64,
    gear_ratio: f64,
    still_rad_s: f64,
    direction: f64,
    began_s: Option<f64>,
    /// Time and velocity of the previous row.
    before: Option<(f64, f64)>,
}

impl OnlinePrediction {
    /// `None` for a model that needs more history than the previous row.
    pub fn new(fit: Fit, torque_constant_nm_per_a: f64, gear_ratio: f64) -> Option<Self> {
        let stage =
            |id: &String| find_with_user_effects(fit.kind, &fit.user_effects, id).map(|effect| effect.traits().regime);
        let knows = fit.effects.iter().all(|id| stage(id).is_ok_and(|stage| stage != Regime::Hysteresis));
        let velocity = fit.scope.as_ref()?.signals.iter().find(|signal| signal.name == "velocity")?;
        let still_rad_s = STILL * velocity.min.abs().max(velocity.max.abs());
        (fit.kind == Kind::Friction && knows).then_some(Self {
            fit,
            torque_constant_nm_per_a,
            gear_ratio,
            still_rad_s,
            direction: 0.0,
            began_s: None,
            before: None,
        })
    }

    /// Measured and predicted torque [Nm], one value for each row. `None` if the rows lack a signal of the model.
    pub fn push(&mut self, rows: &Trace) -> Option<[Vec<f64>; 2]> {
        let (time_s, velocity) = (rows.column("time_s")?, rows.column("motor_velocity_rad_s")?);
        let end = (*time_s.last()?, *velocity.last()?);
        let (from_s, from_rad_s) = self.before.replace(end).unwrap_or((time_s[0], velocity[0]));
        let passed_s = end.0 - from_s;
        let acceleration = if passed_s > 0.0 { (end.1 - from_rad_s) / passed_s } else { 0.0 };
        let began_s = *self.began_s.get_or_insert(time_s[0]);
        let direction = velocity.iter().map(|v| {
            if v.abs() > self.still_rad_s {
                self.direction = v.signum();
            }
            self.direction
        });
        let measured: Vec<f64> =
            rows.column("motor_current_a")?.iter().map(|i| self.torque_constant_nm_per_a * i).collect();
        let position = rows.column("motor_position_rad")?;
        let geared = |values: &[f64]| values.iter().map(|v| v / self.gear_ratio).collect::<Vec<f64>>();
        let mut moments = vec![
            ("time", time_s.iter().map(|t| t - began_s).collect()),
            ("position", position.to_vec()),
            ("velocity", velocity.to_vec()),
            ("acceleration", vec![acceleration; rows.len()]),
            ("direction", direction.collect()),
            ("link_position", rows.column("link_position_rad").map_or_else(|| geared(position), <[f64]>::to_vec)),
            ("motor_torque", measured.clone()),
        ];
        moments.extend(rows.column("link_torque_nm").map(|load| ("load", geared(load))));
        moments.extend(rows.column("temperature_c").map(|measured| ("temperature", measured.to_vec())));
        let named = signals_with(self.fit.kind, &self.fit.user_effects).into_iter();
        let unknown = named.filter(|s| matches!(s.signal, Signal::Column(_)));
        moments.extend(unknown.filter_map(|s| Some((s.name, rows.column(s.column)?.to_vec()))));
        let sample_s = passed_s / rows.len() as f64;
        Some([measured, predict(&self.fit, &moments, sample_s).ok()?])
    }
}
