//! Torque commands through the inverse hysteresis model of the brake, after random histories, compared with the
//! sensor.
//!
//! The model is that of an earlier run of `brake_hysteresis`. Each history begins with a demagnetised brake and
//! passes torques that are drawn uniformly from the brake's range. The inverse model gives the current for each
//! torque, depending on the history of the current. The measured torque is compared with the commanded one.

use super::brake_run::{self, rated_nm};
use super::legs::{ACCELERATION, Legs, sample_rate};
use super::{Findable, Procedure, ProcedureInfo, findable};
use crate::bench_facts::BenchFacts;
use crate::brake_model::{BrakeModel, CurrentHistory};
use crate::catalogue::brake_hysteresis::{BOUND, SETTLED};
use crate::findings::{Unusable, holds, jackknife95, percentage, quantity, scatter, verdict};
use crate::identification::{Axis, Figure, Form, Identification, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{Plan, PlanFault};
use jointbench_instrument::{Kind, RunTable};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};

pub(super) struct BrakeTorque;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "brake_torque",
    title: "Verify the brake model",
    summary: "Commands random torques through the inverse of the brake's hysteresis model after random histories. \
              Reports the error against the torque sensor. Needs a run of brake_hysteresis.",
    kind: Kind::Brake,
    schema: &[
        Parameter::count(
            "model_run",
            "Run of brake_hysteresis with the model (0: the applied model, else the latest)",
            0,
            [0, 2_000_000_000],
        ),
        Parameter::count("histories", "Random histories", 12, [1, 100]),
        Parameter::count("torques", "Torques in each history", 20, [2, 200]),
        Parameter::number("dwell_s", "Dwell time at each torque", "s", 0.9, [0.5, 20.0]),
        Parameter::number("speed_rad_s", "Speed (link)", "rad/s", 1.5, [0.2, 20.0]),
        ACCELERATION,
        sample_rate(100.0),
        Parameter::count("order_seed", "Random seed (histories)", 1, [0, 1_000_000]),
    ],
};

/// Name of the fact that assigns a torque to each current: a list of pairs for each history.
const COMMANDED: &str = "commanded_a_nm";
/// Tolerance of a current in the table relative to the commanded one.
const SAME_A: f64 = 1e-3;

impl Procedure for BrakeTorque {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn brake_model(&self, values: &Values) -> Option<u32> {
        Some(values.count("model_run"))
    }

    fn can_resume(&self) -> Result<(), &'static str> {
        Err("the model may have changed since then")
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        brake_run::check(bench)?;
        let model = bench.brake_model.as_ref().ok_or_else(|| PlanFault::Contradiction {
            what: "the brake of this bench has no model".into(),
            cure: "run brake_hysteresis first",
        })?;
        let rate_hz = values.number("sample_rate_hz");
        let dwell_s = values.number("dwell_s");
        // Half of the range is sufficient, because a run may begin off the middle.
        let longest_s = 2.0 * f64::from(values.count("torques") + 2) * dwell_s;
        let wanted_rad_s =
            (values.number("speed_rad_s") * bench.constants.gear_ratio).min(0.95 * bench.limits.motor_velocity_rad_s);
        let speed_rad_s = brake_run::speed_rad_s(wanted_rad_s, longest_s, bench);
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        legs.demagnetise(wanted_rad_s, model.top_a(), 2.0, bench);
        let mut rng = ChaCha8Rng::seed_from_u64(u64::from(values.count("order_seed")));
        let (mut way_rad, mut commanded) = (0.0, Vec::new());
        for history in 1..=values.count("histories") {
            let pairs = random(model, values.count("torques"), &mut rng);
            let currents_a: Vec<f64> = pairs.iter().map(|(current_a, _)| *current_a).collect();
            legs.repeat = history;
            let sign = if way_rad > 0.0 { -1.0 } else { 1.0 };
            legs.sweep(format!("history {history}"), sign * speed_rad_s, &currents_a, dwell_s);
            way_rad += legs.way_of_last();
            commanded.push(json!(pairs));
        }
        legs.repeat = 0;
        legs.way_back(way_rad, speed_rad_s);
        let mut meta = brake_run::meta(bench, rate_hz);
        meta.other.insert(COMMANDED.into(), Value::Array(commanded));
        Ok(legs.plan(self, values, meta, rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[("%", "error_max error_rms error_mean"), ("", "torques")])
    }

    fn identify(&self, _: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify(run))
    }
}

/// Currents with the commanded torques, in sequence from a demagnetised brake.
fn random(model: &BrakeModel, torques: u32, rng: &mut ChaCha8Rng) -> Vec<(f64, f64)> {
    let mut history = CurrentHistory::default();
    let (drag_nm, most_nm) = (model.torque_nm(&history), model.torque_nm(&history.after(model.top_a())));
    // A current below the resolution of the supply is no command.
    let least_nm = drag_nm + 0.02 * (most_nm - drag_nm);
    let mut pairs = Vec::new();
    while pairs.len() < torques as usize {
        let torque_nm = rng.random_range(least_nm..most_nm);
        // Not every fall can reach the lowest torques.
        let Some(current_a) = model.current_a(&history, torque_nm) else { continue };
        history.go(current_a);
        pairs.push((current_a, torque_nm));
    }
    pairs
}

/// A commanded torque with the measured one.
struct Point {
    history: i64,
    asked_nm: f64,
    felt_nm: f64,
}

fn identify(run: &RunTable) -> Result<Identification, Unusable> {
    const FOREIGN: Unusable =
        Unusable::InsufficientData("The commanded torques are not stored with the run.", "Repeat the run.");
    let commanded = run.meta().other.get(COMMANDED).cloned().ok_or(FOREIGN)?;
    let commanded: Vec<Vec<(f64, f64)>> = serde_json::from_value(commanded).map_err(|_| FOREIGN)?;
    let rated_nm = rated_nm(run).ok_or(FOREIGN)?;
    let torque = run.column("brake_torque_nm").unwrap_or_default();
    let held: Vec<_> = holds(run, 0.3).into_iter().filter(|hold| hold.repeat > 0 && hold.brake > 0.0).collect();
    let mut points = Vec::new();
    for history in held.chunk_by(|a, b| a.segment == b.segment) {
        let Some(pairs) = commanded.get(history[0].repeat as usize - 1) else { continue };
        for (hold, (current_a, asked_nm)) in history.iter().zip(pairs) {
            if (hold.brake - current_a).abs() > SAME_A {
                break;
            }
            points.push(Point { history: hold.repeat, asked_nm: *asked_nm, felt_nm: hold.mean(torque, SETTLED) });
        }
    }
    if points.len() < 2 {
        return Err(Unusable::InsufficientData("No random history was completed.", "Repeat the run."));
    }
    let errors: Vec<(i64, f64)> =
        points.iter().map(|point| (point.history, (point.felt_nm - point.asked_nm) / rated_nm)).collect();
    let worst = errors.iter().map(|(_, error)| error.abs()).fold(0.0, f64::max);
    let (mean, mean_ci95) = over_histories(&errors, |sum, _, n| sum / n);
    let (rms, rms_ci95) = over_histories(&errors, |_, squares, n| (squares / n).sqrt());
    let good = worst <= BOUND;
    let count = points.len();
    Ok(Identification {
        verdict: if good { Verdict::Identified } else { Verdict::Inconclusive },
        summary: format!(
            "{count} torques commanded through the model after {} random histories: maximum error {:.2} % of the rated \
             torque.",
            commanded.len(),
            100.0 * worst
        ),
        advice: (!good).then(|| {
            "Repeat brake_hysteresis with more levels or a longer dwell_s at the present brake temperature.".into()
        }),
        quantities: vec![
            percentage(
                ["error_max", "e_max", "Maximum error against the sensor, relative to rated torque"],
                worst,
                None,
            ),
            percentage(["error_rms", "e_rms", "RMS error against the sensor, relative to rated torque"], rms, rms_ci95),
            percentage(["error_mean", "ē", "Mean error against the sensor, relative to rated torque"], mean, mean_ci95),
            quantity(["torques", "n", "Number of torques", ""], count as f64, None),
        ],
        figures: figures(&points),
        ..Identification::default()
    })
}

/// A figure from the sum, the sum of the squares and the number of the errors, and its 95 % interval over the histories. The
/// errors of one history are not independent: they have its remanence in common.
fn over_histories(errors: &[(i64, f64)], figure: fn(f64, f64, f64) -> f64) -> (f64, Option<[f64; 2]>) {
    let without = |history: Option<i64>| {
        let others = errors.iter().filter(|(of, _)| Some(*of) != history);
        let [sum, squares, n] = others.fold([0.0; 3], |[sum, squares, n], (_, e)| [sum + e, squares + e * e, n + 1.0]);
        figure(sum, squares, n)
    };
    let histories = errors.chunk_by(|a, b| a.0 == b.0).map(|part| part[0].0);
    let (value, parts) = (without(None), histories.map(|history| without(Some(history))).collect::<Vec<f64>>());
    let reach = jackknife95(&parts);
    (value, (parts.len() > 2).then_some([value - reach, value + reach]))
}

fn figures(points: &[Point]) -> Vec<Figure> {
    let figure = |name: &str, title: &str, label: &str, y: fn(&Point) -> f64| Figure {
        name: name.into(),
        title: title.into(),
        form: Form::Cartesian,
        x: Axis::of("commanded torque", "Nm"),
        y: Axis::of(label, "Nm"),
        series: vec![scatter("sensor", points.iter().map(|point| (point.asked_nm, y(point))))],
    };
    vec![
        figure("felt_over_asked", "Measured torque over commanded torque", "measured torque", |point| point.felt_nm),
        figure("error_over_asked", "Error of the commanded torque", "measured − commanded torque", |point| {
            point.felt_nm - point.asked_nm
        }),
    ]
}
