//! Stiction: the motor current rises until the joint breaks away, at many positions and in both directions.
//!
//! Document 000 raises the current until the encoder increases in five consecutive samples. Each position is one step
//! that includes the approach: the joint always arrives in the direction in which it will break away. A joint whose
//! friction falls with speed creeps before it breaks away. A faster torque ramp then gives a lower breakaway torque
//! (Canudas de Wit, Olsson, Åström, Lischinsky 1995). Only a slow ramp approximates the friction at rest.
//!
//! Gravity loads a joint without a torque sensor. It is estimated from the angles of the breakaways. A constant part of
//! it looks like a difference of the directions, so that only the mean of both directions is free of it on a short arc.

use super::legs::{ACCELERATION, Legs, sample_rate, stroke};
use super::{Findable, Procedure, findable};
use crate::bench_facts::BenchFacts;
use crate::findings::{Mean, Unusable, combined, directions, quantity, scatter, solve, verdict};
use crate::identification::{Axis, Figure, Form, Identification, Mark, Series, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{Drive, EndCondition, Plan, PlanFault};
use crate::profile::Profile;
use jointbench_instrument::{Kind, RunTable};
use jointbench_model::words;
use std::f64::consts::TAU;

pub(super) struct Breakaway;

const SCHEMA: &[Parameter] = &[
    Parameter::count("positions", "Number of positions in each direction", 12, [2, 200]),
    Parameter::number("arc_rad", "Arc of the positions (link)", "rad", TAU, [0.02, TAU]),
    Parameter::number("top_torque_nm", "Maximum torque of the ramp (motor)", "Nm", 0.08, [1e-3, 100.0]),
    Parameter::number("ramp_nm_s", "Torque ramp rate (motor)", "Nm/s", 0.005, [1e-4, 10.0]),
    Parameter::count("increases", "Consecutive encoder increments", 5, [2, 50]),
    Parameter::number("speed_rad_s", "Approach speed (motor)", "rad/s", 60.0, [1.0, 1000.0]),
    ACCELERATION,
    sample_rate(250.0),
];

/// Rest without torque between the approach and the ramp (s).
const REST_S: f64 = 0.4;
/// Highest motor speed after the breakaway, at which the velocity loop takes over.
const RUNAWAY_RAD_S: f64 = 10.0;

impl Procedure for Breakaway {
    fn id(&self) -> &'static str {
        "breakaway"
    }

    fn title(&self) -> &'static str {
        "Breakaway"
    }

    fn summary(&self) -> &'static str {
        "Ramps the motor current until the joint breaks away, at many positions and in both directions. The velocity \
         loop takes over as soon as the joint moves."
    }

    fn kind(&self) -> Kind {
        Kind::Friction
    }

    fn schema(&self) -> &'static [Parameter] {
        SCHEMA
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let rate_hz = values.number("sample_rate_hz");
        let top_a = values.number("top_torque_nm") / bench.constants.torque_constant_nm_per_a;
        let ramp_s = values.number("top_torque_nm") / values.number("ramp_nm_s");
        let positions = values.count("positions");
        let arc_rad = values.number("arc_rad") * bench.constants.gear_ratio;
        let stretch_rad = arc_rad / f64::from(positions);
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        if bench.constants.link_range_rad.is_some_and(|range_rad| range_rad < TAU) {
            // A whole turn does not fit in the range: the arc is centred on the initial pose.
            let velocity = stroke(-0.5 * arc_rad, values.number("speed_rad_s"), legs.acceleration_rad_s2);
            legs.push("to the start of the arc".into(), velocity, Profile::constant(0.0));
        }
        for (repeat, sign) in [(0, 1.0), (1, -1.0)] {
            legs.repeat = repeat;
            for position in 1..=positions {
                let velocity = stroke(sign * stretch_rad, values.number("speed_rad_s"), legs.acceleration_rad_s2);
                let from_s = velocity.duration_s() + REST_S;
                let current_a = Profile::from(0.0).hold(REST_S).to(sign * top_a, ramp_s);
                let way = if sign > 0.0 { "forward" } else { "backward" };
                legs.push(format!("breakaway {way}, {position} of {positions}"), velocity, Profile::constant(0.0));
                let until = EndCondition { increases: values.count("increases"), speed_rad_s: RUNAWAY_RAD_S };
                legs.drive_of_last(Drive::Current { from_s, current_a, until });
            }
        }
        // The velocity loop stops the joint after the last breakaway before the run ends.
        legs.push("rest".into(), Profile::from(0.0).hold(REST_S), Profile::constant(0.0));
        Ok(legs.friction_plan(self, values, bench, rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[("Nm", "tau_b tau_b_positive tau_b_negative tau_b_difference deviation")])
    }

    fn identify(&self, values: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify(values, run))
    }
}

/// Position and torque of a breakaway.
struct BreakawayPoint {
    link_rad: f64,
    torque_nm: f64,
    sign: f64,
}

/// Statistics of the breakaway torque.
struct Torques {
    mean: Mean,
    forward: Mean,
    backward: Mean,
    difference: (f64, [f64; 2]),
}

impl Torques {
    fn of(points: &[BreakawayPoint], step_nm: f64) -> Option<Self> {
        let of = |sign: f64| -> Vec<f64> { points.iter().filter(|b| b.sign == sign).map(|b| b.torque_nm).collect() };
        let all: Vec<f64> = points.iter().map(|b| b.torque_nm).collect();
        let [mean, forward, backward] =
            [Mean::of(&all)?, Mean::of(&of(1.0))?, Mean::of(&of(-1.0))?].map(|mean| with_resolution(mean, step_nm));
        let difference = combined((forward.value, forward.ci95), (backward.value, backward.ci95), -1.0);
        Some(Self { mean, forward, backward, difference })
    }

    /// By least squares with gravity as a wave of the link angle. Its change with the angle is removed from `points`.
    fn without_gravity(points: &mut [BreakawayPoint], step_nm: f64) -> Option<Self> {
        let response: Vec<f64> = points.iter().map(|b| b.sign * b.torque_nm).collect();
        let solved = |columns: fn(f64) -> [f64; 2]| {
            let row = |b: &BreakawayPoint| {
                let ([first, second], (sine, cosine)) = (columns(b.sign), b.link_rad.sin_cos());
                [first, second, sine, cosine]
            };
            solve(&points.iter().map(row).collect::<Vec<_>>(), &response)
        };
        let both = solved(|sign| [sign, 1.0])?;
        let each = solved(|sign| [sign.max(0.0), sign.min(0.0)])?;
        let cosine = points.iter().map(|b| b.link_rad.cos()).sum::<f64>() / points.len() as f64;
        for b in points {
            let (sine, cosine) = (b.link_rad.sin(), b.link_rad.cos() - cosine);
            b.torque_nm -= b.sign * (both.values[2] * sine + both.values[3] * cosine);
        }
        let mean = |value: f64, ci95: [f64; 2]| with_resolution(Mean { value, ci95 }, step_nm);
        Some(Self {
            mean: mean(both.values[0], both.ci95(0)),
            forward: mean(each.values[0], each.ci95(0)),
            backward: mean(each.values[1], each.ci95(1)),
            difference: (2.0 * both.values[1], both.ci95(1).map(|end| 2.0 * end)),
        })
    }
}

/// Position at which a ramp of motor current moved the joint.
pub(super) struct Onset {
    /// First row of the consecutive increases, and the end of the ramp's rows.
    pub row: usize,
    pub end: usize,
    pub current_a: f64,
}

/// The ramps that ended with motion of the joint, and the number of ramps that reached `top_a` without motion. A ramp
/// that a pause interrupted at rest is neither.
pub(super) fn onsets(run: &RunTable, setpoint_a: &[f64], increases: usize, top_a: f64) -> (Vec<Onset>, usize) {
    let (mut onsets, mut held, mut start) = (Vec::new(), 0, 0);
    let position = run.column("motor_position_rad").unwrap_or_default();
    for rows in run.column("segment").unwrap_or_default().chunk_by(|a, b| a == b) {
        let end = start + rows.len();
        let last_a = setpoint_a[end - 1].abs();
        let row = end - increases.min(rows.len() - 1);
        if last_a > 0.999 * top_a {
            held += 1;
        } else if last_a > 0.0 && 2 * onward(&position[row - 1..end], setpoint_a[end - 1]) >= increases {
            onsets.push(Onset { row, end, current_a: setpoint_a[row] });
        }
        start = end;
    }
    (onsets, held)
}

/// The step of the torque between two rows of a ramp.
pub(super) fn ramp_step_nm(values: &Values) -> f64 {
    values.number("ramp_nm_s") / values.number("sample_rate_hz")
}

/// A mean breakaway with the resolution of its ramp: equal readings differ by up to one step.
pub(super) fn with_resolution(mean: Mean, step: f64) -> Mean {
    let [low, high] = mean.ci95;
    Mean { ci95: [low - step, high + step], ..mean }
}

/// Number of row-to-row steps in the direction of the current. A fast breakaway ends before all increases occurred.
fn onward(position_rad: &[f64], current_a: f64) -> usize {
    position_rad.windows(2).filter(|pair| (pair[1] - pair[0]) * current_a > 0.0).count()
}

fn identify(values: &Values, run: &RunTable) -> Result<Identification, Unusable> {
    let Some(setpoint) = run.column("motor_current_setpoint_a") else {
        return Err(Unusable::InsufficientData(
            "The run has no motor current set-point, so it belongs to another procedure.",
            "Run breakaway.",
        ));
    };
    let km = run.meta().torque_constant_nm_per_a.unwrap_or(1.0);
    let gear = run.meta().gear_ratio.unwrap_or(1.0);
    let position = run.column("motor_position_rad").unwrap_or_default();
    let link = |row: usize| run.column("link_position_rad").map_or(position[row] / gear, |link| link[row]);
    let increases = values.count("increases") as usize;
    let top_a = values.number("top_torque_nm") / km;
    let (onsets, held) = onsets(run, setpoint, increases, top_a);
    let point = |onset: Onset| BreakawayPoint {
        link_rad: link(onset.end - 1).rem_euclid(TAU),
        torque_nm: km * onset.current_a.abs(),
        sign: onset.current_a.signum(),
    };
    let mut points: Vec<BreakawayPoint> = onsets.into_iter().map(point).collect();
    let step_nm = ramp_step_nm(values);
    let torques = match run.column("link_torque_nm") {
        Some(_) => Torques::of(&points, step_nm),
        None => Torques::without_gravity(&mut points, step_nm),
    };
    let Some(Torques { mean, forward, backward, difference }) = torques else {
        let advice =
            "Increase top_torque_nm. An arm moves by its weight where gravity exceeds friction: reduce arc_rad.";
        return Err(Unusable::InsufficientData("Too few breakaway events.", advice));
    };
    let all: Vec<f64> = points.iter().map(|b| b.torque_nm).collect();
    let deviation = (all.iter().map(|t| (t - mean.value).powi(2)).sum::<f64>() / (all.len() - 1) as f64).sqrt();
    let named = |name, symbol, title, mean: &Mean| quantity([name, symbol, title, "Nm"], mean.value, Some(mean.ci95));
    Ok(Identification {
        verdict: if held == 0 { Verdict::Identified } else { Verdict::Inconclusive },
        summary: format!(
            "Breakaway torque {} (motor side, mean of {} positions), standard deviation {}. {}.",
            words::figure(mean.value, "Nm"),
            all.len(),
            words::figure(deviation, "Nm"),
            directions("Breakaway torque", difference, "Nm")
        ),
        advice: (held > 0)
            .then(|| format!("The joint did not break away at {held} positions. Increase top_torque_nm.")),
        quantities: vec![
            named("tau_b", "τ_b", "Breakaway torque, mean", &mean),
            named("tau_b_positive", "τ_b⁺", "Breakaway torque", &forward).in_configuration("positive direction"),
            named("tau_b_negative", "τ_b⁻", "Breakaway torque", &backward).in_configuration("negative direction"),
            quantity(
                ["tau_b_difference", "τ_b⁺ − τ_b⁻", "Breakaway torque, difference between directions", "Nm"],
                difference.0,
                Some(difference.1),
            ),
            quantity(["deviation", "s", "Standard deviation over positions", "Nm"], deviation, None),
        ],
        figures: vec![over_angle(&points), distribution(&all)],
        ..Identification::default()
    })
}

fn over_angle(points: &[BreakawayPoint]) -> Figure {
    let side = |label, sign: f64| {
        scatter(label, points.iter().filter(move |b| b.sign == sign).map(|b| (b.link_rad, b.torque_nm)))
    };
    Figure {
        name: "breakaway_over_angle".into(),
        title: "Breakaway torque over link angle".into(),
        form: Form::Polar,
        x: Axis::of("link angle", "rad"),
        y: Axis::of("breakaway torque (motor)", "Nm"),
        series: vec![side("positive", 1.0), side("negative", -1.0)],
    }
}

fn distribution(all: &[f64]) -> Figure {
    let (low, high) = all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (v.min(l), v.max(h)));
    // Sturges' rule.
    let bins = (all.len() as f64).log2().ceil() as usize + 1;
    let width = ((high - low) / bins as f64).max(f64::MIN_POSITIVE);
    let mut counts = vec![0.0; bins];
    for value in all {
        counts[(((value - low) / width) as usize).min(bins - 1)] += 1.0;
    }
    let centres = (0..bins).map(|i| low + (i as f64 + 0.5) * width).collect();
    Figure {
        name: "distribution".into(),
        title: "Distribution of the breakaway torque".into(),
        form: Form::Cartesian,
        x: Axis::of("breakaway torque (motor)", "Nm"),
        y: Axis::of("positions", ""),
        series: vec![Series::new("positions", Mark::Bars, centres, counts)],
    }
}
