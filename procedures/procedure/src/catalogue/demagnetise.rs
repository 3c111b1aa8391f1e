//! Removes magnetic poles from a brake that was unloaded at standstill, and checks the result.

use super::brake_run;
use super::legs::{ACCELERATION, Legs, sample_rate, turn_s};
use super::{Findable, Procedure, findable};
use crate::bench_facts::BenchFacts;
use crate::findings::{Hold, Unusable, holds, quantity, scatter, verdict};
use crate::identification::{Axis, Figure, Form, Identification, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{Plan, PlanFault};
use jointbench_instrument::{Kind, RunTable};
use jointbench_model::words;
use std::f64::consts::TAU;

pub(super) struct Demagnetise;

const SCHEMA: &[Parameter] = &[
    Parameter::number("speed_rad_s", "Speed (link)", "rad/s", 1.5, [0.2, 20.0]),
    Parameter::number("turns", "Link turns while the current decreases", "", 3.0, [1.0, 20.0]),
    Parameter::number("top_current", "Initial current, fraction of rated", "", 1.0, [0.05, 1.0]),
    ACCELERATION,
    sample_rate(250.0),
];

/// Largest remaining torque ripple, peak to peak, as a share of the rated torque (bench-physics, section 3).
const LEFT_SHARE: f64 = 0.005;
/// Angles of a turn at which the torque is averaged: several for each of up to 25 poles.
const PLACES: usize = 120;
/// The range of this number of noise means is about this multiple of their standard deviation.
const RANGE_OF_NOISE: f64 = 5.2;

impl Procedure for Demagnetise {
    fn id(&self) -> &'static str {
        "demagnetise"
    }

    fn title(&self) -> &'static str {
        "Demagnetise the brake"
    }

    fn summary(&self) -> &'static str {
        "Magnetises the brake fully, then reduces the current to zero while the shaft turns. One turn without current \
         measures the remanent torque."
    }

    fn kind(&self) -> Kind {
        Kind::Brake
    }

    fn is_modelled(&self) -> bool {
        false
    }

    fn schema(&self) -> &'static [Parameter] {
        SCHEMA
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        brake_run::check(bench)?;
        let rate_hz = values.number("sample_rate_hz");
        let speed_rad_s =
            (values.number("speed_rad_s") * bench.constants.gear_ratio).min(0.95 * bench.limits.motor_velocity_rad_s);
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        let top_a = values.number("top_current") * bench.constants.brake_rated_current_a;
        legs.demagnetise(speed_rad_s, top_a, values.number("turns"), bench);
        legs.repeat = 1;
        legs.leg(speed_rad_s, turn_s(1.2, speed_rad_s, bench, 1.0), 0.0);
        legs.leg(-speed_rad_s, turn_s(1.2, speed_rad_s, bench, 1.0), 0.0);
        Ok(legs.plan(self, values, brake_run::meta(bench, rate_hz), rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[("Nm", "left noise")])
    }

    fn identify(&self, _: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify(run))
    }
}

/// Torque of one turn without current.
struct Turn {
    /// Link angle and mean torque.
    means: Vec<(f64, f64)>,
    /// Range of these means, peak to peak.
    range_nm: f64,
    /// Part of that range that noise explains.
    noise_nm: f64,
}

impl Turn {
    fn of(hold: &Hold, angle_rad: &[f64], torque_nm: &[f64]) -> Self {
        let rows = hold.tail(0.9);
        let mut sums = vec![(0.0, 0.0); PLACES];
        for row in rows.clone() {
            let place = (angle_rad[row].rem_euclid(TAU) / TAU * PLACES as f64) as usize % PLACES;
            sums[place] = (sums[place].0 + torque_nm[row], sums[place].1 + 1.0);
        }
        let means: Vec<(f64, f64)> = sums
            .iter()
            .enumerate()
            .filter(|(_, (_, n))| *n > 0.0)
            .map(|(place, (sum, n))| ((place as f64 + 0.5) / PLACES as f64 * TAU, sum / n))
            .collect();
        let (low, high) = means.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), (_, v)| (v.min(l), v.max(h)));
        // Noise from differences of consecutive samples, within which the rotor does not pass a pole.
        let steps = torque_nm[rows.clone()].windows(2).map(|w| (w[1] - w[0]).powi(2));
        let sigma_nm = (steps.sum::<f64>() / (2.0 * (rows.len() - 1) as f64)).sqrt();
        let noise_nm = RANGE_OF_NOISE * sigma_nm / (rows.len() as f64 / means.len() as f64).sqrt();
        Self { means, range_nm: high - low, noise_nm }
    }
}

fn identify(run: &RunTable) -> Result<Identification, Unusable> {
    const LITTLE: Unusable = Unusable::InsufficientData("The run ended before the last turn.", "Repeat the run.");
    let (Some(torque), Some(angle), Some(rated_nm)) =
        (run.column("brake_torque_nm"), run.column("position_rad"), rated_nm(run))
    else {
        return Err(LITTLE);
    };
    let holds = holds(run, 0.5).into_iter().filter(|hold| hold.repeat == 1);
    let turns: Vec<Turn> = holds.take(2).map(|hold| Turn::of(&hold, angle, torque)).collect();
    if turns.len() < 2 {
        return Err(LITTLE);
    }
    let left_nm = turns.iter().map(|turn| turn.range_nm).fold(0.0, f64::max);
    let noise_nm = turns.iter().map(|turn| turn.noise_nm).fold(0.0, f64::max);
    let allowed_nm = LEFT_SHARE * rated_nm + noise_nm;
    let clean = left_nm <= allowed_nm;
    Ok(Identification {
        verdict: if clean { Verdict::Identified } else { Verdict::Inconclusive },
        summary: format!(
            "Torque variation over one turn without current: {}, {} the limit of {} (noise + 0.5 % of rated).",
            words::figure(left_nm, "Nm"),
            if clean { "below" } else { "above" },
            words::figure(allowed_nm, "Nm"),
        ),
        advice: (!clean)
            .then(|| "The rotor is still magnetised. Increase the number of turns or the initial current.".into()),
        quantities: vec![
            quantity(["left", "ΔT", "Remanent torque over one turn, peak to peak", "Nm"], left_nm, None),
            quantity(["noise", "σ", "Noise contribution, peak to peak", "Nm"], noise_nm, None),
        ],
        figures: vec![Figure {
            name: "torque_over_angle".into(),
            title: "Torque without current over one turn".into(),
            form: Form::Polar,
            x: Axis::of("link angle", "rad"),
            y: Axis::of("torque", "Nm"),
            series: ["out", "back"].into_iter().zip(turns).map(|(label, turn)| scatter(label, turn.means)).collect(),
        }],
        ..Identification::default()
    })
}

/// Torque of the brake at rated current, from the bench description.
pub(super) fn rated_nm(run: &RunTable) -> Option<f64> {
    run.meta().other.get("rated_torque_nm").and_then(serde_json::Value::as_f64)
}
