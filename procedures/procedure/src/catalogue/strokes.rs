//! A few speeds under one load, out and back: a short run for one question.
//!
//! Every leg returns to its start, so that a joint or slide with a short range can be measured. A leg ends when its
//! time or its distance is reached, whichever is first.

use super::legs::{Legs, sample_rate};
use super::{Findable, Procedure, ProcedureInfo, findable};
use crate::bench_facts::BenchFacts;
use crate::findings::{
    Line, Plateau, Unusable, curve, jackknife95, legs, plateaus, quantity, scatter, select_legs, settled, solve,
    verdict,
};
use crate::identification::{Axis, Direction, Figure, Form, Identification, Quantity, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{Plan, PlanFault};
use crate::thresholds::{FASTER_LEG, VAGUE_OFFSET};
use jointbench_instrument::{Kind, RunTable};
use jointbench_model::preprocess::Prepared;
use jointbench_model::signal::Signal;
use jointbench_model::thresholds::ALPHA;
use jointbench_model::words;
use nalgebra::{Matrix2, Vector2};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

pub(super) struct Strokes;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "strokes",
    title: "Constant-speed strokes",
    summary: "Strokes in both directions at a few constant speeds under one load. A short run that answers one open \
              question of a longer run.",
    kind: Kind::Friction,
    schema: &[
        Parameter::number("low_speed_rad_s", "Minimum stroke speed (motor)", "rad/s", 15.0, [1e-3, 1000.0]),
        Parameter::number("top_speed_rad_s", "Maximum stroke speed (motor)", "rad/s", 150.0, [1e-3, 1000.0]),
        Parameter::count("speeds", "Number of speeds (logarithmically spaced)", 4, [1, 20]),
        Parameter::fraction("load", "Brake current, relative to rated", 0.0, [0.0, 1.0]),
        Parameter::count("repeats", "Repeats of the profile", 2, [1, 50]),
        Parameter::number("dwell_s", "Maximum dwell time at each speed", "s", 3.0, [0.3, 60.0]),
        Parameter::number("travel_rad", "Maximum stroke length (link)", "rad", 1.2, [1e-3, 100.0]),
        Parameter::number("acceleration_rad_s2", "Acceleration (motor)", "rad/s²", 400.0, [1e-2, 5000.0]),
        sample_rate(250.0),
        Parameter::count("order_seed", "Random seed (step order)", 1, [0, 1_000_000]),
    ],
};

/// Least speed for magnetising and demagnetising the brake, as a share of the highest speed.
const TURNING_SHARE: f64 = 0.5;

/// Shortest dwell, absolute and relative to both ramps together, that contains a detectable steady state.
const SHORTEST_S: f64 = 0.3;
const OF_RAMPS: f64 = 1.0;

impl Procedure for Strokes {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let brake_a = values.number("load") * bench.constants.brake_rated_current_a;
        if brake_a > 0.0 && !bench.has_brake {
            return Err(bench.missing("brake", "set load = 0, or connect it"));
        }
        let speeds = speeds(values, bench)?;
        let turning_rad_s = values.number("top_speed_rad_s").max(TURNING_SHARE * bench.limits.motor_velocity_rad_s);
        let rate_hz = values.number("sample_rate_hz");
        let mut rng = ChaCha8Rng::seed_from_u64(u64::from(values.count("order_seed")));
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        for repeat in 0..values.count("repeats") {
            legs.repeat = repeat;
            if brake_a > 0.0 {
                legs.change(turning_rad_s, 0.0, brake_a);
            }
            let mut order = speeds.clone();
            order.shuffle(&mut rng);
            for (speed_rad_s, dwell_s) in order {
                legs.leg(speed_rad_s, dwell_s, brake_a);
                legs.leg(-speed_rad_s, dwell_s, brake_a);
            }
            if brake_a > 0.0 {
                legs.unload(turning_rad_s, brake_a, bench);
            }
        }
        Ok(legs.friction_plan(self, values, bench, rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[
            ("Nm", "offset_positive offset_negative"),
            ("Nm·s/rad", "slope_positive slope_negative"),
            ("", "r2_positive r2_negative"),
            ("Nm", "offset_half_difference"),
        ])
    }

    fn identify(&self, values: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify(values, run))
    }
}

/// Speed and friction of each stroke of one direction, and the line through them.
type Side = (Vec<(f64, f64)>, Option<Line>);

/// Results of both directions.
struct Lines {
    /// Positive direction, then negative.
    sides: [Side; 2],
    /// Half the difference of both offsets with its interval, which excludes gravity. For a bench without a load
    /// sensor.
    half_difference: Option<(f64, [f64; 2])>,
}

/// A line through the strokes of each direction, under the load of the run.
fn identify(values: &Values, run: &RunTable) -> Result<Identification, Unusable> {
    let legs = legs(run);
    let heaviest = legs.iter().filter_map(|leg| leg.brake_nm).fold(0.0, f64::max);
    let prepared = settled(&select_legs(run, legs.iter().filter(|leg| leg.brake_nm == Some(heaviest)))?)?;
    let planned = values.number("top_speed_rad_s");
    let is_stroke = |p: &Plateau| p.velocity_rad_s.abs() < FASTER_LEG * planned;
    let points: Vec<Plateau> = plateaus(&prepared).into_iter().filter(is_stroke).collect();
    let weighed = match run.column("link_torque_nm") {
        Some(_) => None,
        None => without_gravity(&prepared, &points, FASTER_LEG * planned),
    };
    let plain = || Lines { sides: [1.0, -1.0].map(|sign| side(&points, sign, [0.0; 2])), half_difference: None };
    let lines = weighed.unwrap_or_else(plain);
    Ok(identification(&points, &lines, planned))
}

fn side(points: &[Plateau], sign: f64, gravity: [f64; 2]) -> Side {
    let friction =
        |p: &Plateau| p.target - p.load_nm - waves(p.link_rad).iter().zip(gravity).map(|(w, g)| w * g).sum::<f64>();
    let of_side = points.iter().filter(|p| p.velocity_rad_s * sign > 0.0);
    let of_side: Vec<(f64, f64)> = of_side.map(|p| (p.velocity_rad_s, friction(p))).collect();
    let line = Line::through(&of_side);
    (of_side, line)
}

/// Gravity as a function of the link angle, for any zero of the angle.
fn waves(link_rad: f64) -> [f64; 2] {
    [link_rad.sin(), link_rad.cos()]
}

/// Both lines and the unmeasured gravity of the link: least squares over all steady-state rows, with intervals of a
/// jackknife over the strokes. `None` if gravity is not significant (Wald test).
fn without_gravity(prepared: &Prepared, points: &[Plateau], fastest_rad_s: f64) -> Option<Lines> {
    let (problem, view) = (&prepared.main, &prepared.main.view);
    let (speed, link) = (view.get(Signal::Velocity), view.get(Signal::Link));
    let strokes: Vec<usize> = (0..problem.rows()).filter(|row| speed[*row].abs() < fastest_rad_s).collect();
    let row = |i: usize| -> [f64; 6] {
        let [forward, backward] = [f64::from(speed[i] > 0.0), f64::from(speed[i] < 0.0)];
        let [sine, cosine] = waves(link[i]);
        [forward, backward, forward * speed[i], backward * speed[i], sine, cosine]
    };
    let solved = |without: Option<i64>| {
        let kept: Vec<usize> = strokes.iter().copied().filter(|i| without != Some(problem.segment[*i])).collect();
        let rows: Vec<[f64; 6]> = kept.iter().map(|i| row(*i)).collect();
        let response: Vec<f64> = kept.iter().map(|i| problem.target[*i]).collect();
        solve(&rows, &response).map(|solved| solved.values)
    };
    let values = solved(None)?;
    let mut segments: Vec<i64> = strokes.iter().map(|i| problem.segment[*i]).collect();
    segments.dedup();
    let replicates: Vec<[f64; 6]> = segments.iter().map(|segment| solved(Some(*segment))).collect::<Option<_>>()?;
    let n = replicates.len() as f64;
    let scaled = |v: &[f64; 6]| Vector2::new(v[4] - values[4], v[5] - values[5]);
    let covariance: Matrix2<f64> = replicates.iter().map(scaled).map(|v| v * v.transpose() * ((n - 1.0) / n)).sum();
    let gravity = Vector2::new(values[4], values[5]);
    let wald = 0.5 * gravity.dot(&(covariance.try_inverse()? * gravity));
    if FisherSnedecor::new(2.0, n - 2.0).ok()?.sf(wald) > ALPHA {
        return None;
    }
    let interval = |of: &dyn Fn(&[f64; 6]) -> f64| {
        let reach = jackknife95(&replicates.iter().map(of).collect::<Vec<f64>>());
        [of(&values) - reach, of(&values) + reach]
    };
    let line = |k: usize| {
        let (points, line) = side(points, [1.0, -1.0][k], [values[4], values[5]]);
        let line = line.map(|line| Line {
            offset: values[k],
            slope: values[2 + k],
            offset_ci95: interval(&|v| v[k]),
            slope_ci95: interval(&|v| v[2 + k]),
            r2: line.r2,
        });
        (points, line)
    };
    let half = |v: &[f64; 6]| 0.5 * (v[0] - v[1]);
    Some(Lines { sides: [line(0), line(1)], half_difference: Some((half(&values), interval(&half))) })
}

impl Lines {
    /// The directions that have a line.
    fn fitted(&self) -> Vec<(Direction, &Line)> {
        let sides = Direction::ALL.into_iter().zip(&self.sides);
        sides.filter_map(|(direction, (_, line))| Some((direction, line.as_ref()?))).collect()
    }

    fn quantities(&self) -> Vec<Quantity> {
        let mut quantities = Vec::new();
        for (direction, line) in self.fitted() {
            let named = |name, symbol, title, unit, value, ci95| {
                quantity([name, symbol, title, unit], value, ci95).in_direction(direction)
            };
            let offset_ci95 = Some(line.offset_ci95);
            quantities.extend([
                named("offset", "τ₀", "Friction at zero speed (motor), fitted line", "Nm", line.offset, offset_ci95),
                named(
                    "slope",
                    "c",
                    "Slope over motor speed (motor torque)",
                    "Nm·s/rad",
                    line.slope,
                    Some(line.slope_ci95),
                ),
                named("r2", "r²", "Coefficient of determination", "", line.r2, None),
            ]);
        }
        if let Some((value, ci95)) = self.half_difference {
            let title = "Friction at zero speed (motor), half difference of both directions";
            quantities.push(quantity(["offset_half_difference", "τ₀", title, "Nm"], value, Some(ci95)));
        }
        quantities
    }

    fn sentences(&self) -> Vec<String> {
        let line = |(direction, line): (Direction, &Line)| {
            let [offset, slope] =
                [(line.offset, "Nm"), (line.slope, "Nm·s/rad")].map(|(v, unit)| words::figure(v, unit));
            format!("Line in {} direction: {offset} at zero speed, slope {slope}.", direction.word())
        };
        self.fitted().into_iter().map(line).collect()
    }

    /// `None` if the lines are identified. `top_rad_s`: the highest measured motor speed.
    fn advice(&self, top_rad_s: f64, planned_rad_s: f64) -> Option<String> {
        let fitted = self.fitted();
        if fitted.len() < 2 {
            return Some("A line requires at least two speeds. Increase speeds.".to_owned());
        }
        if FASTER_LEG * top_rad_s < planned_rad_s {
            return Some(format!(
                "The strokes at {planned_rad_s:.1} rad/s held no steady state. Increase travel_rad or acceleration_rad_s2."
            ));
        }
        let is_vague =
            |line: &Line| 0.5 * (line.offset_ci95[1] - line.offset_ci95[0]) > VAGUE_OFFSET * line.offset.abs();
        let vague: Vec<&str> =
            fitted.iter().filter(|(_, line)| is_vague(line)).map(|(direction, _)| direction.word()).collect();
        if !vague.is_empty() && self.half_difference.is_some() {
            return Some(format!(
                "Friction at zero speed is not determined in {} direction: no sensor measures gravity. The half difference of both \
                 directions is free of it. Increase travel_rad, or run puma_friction.",
                vague.join(" and ")
            ));
        }
        let is_flat = |line: &Line| line.slope_ci95[0] <= 0.0 && line.slope_ci95[1] >= 0.0;
        let motion =
            |(direction, line): &(Direction, &Line)| format!("{} motion (r² {:.2})", direction.word(), line.r2);
        let flat: Vec<String> = fitted.iter().filter(|(.., line)| is_flat(line)).map(motion).collect();
        let other = "Diagnose the run to find the cause of the differences, or increase top_speed_rad_s.";
        (!flat.is_empty()).then(|| format!("Speed has no significant linear effect in {}. {other}", flat.join(" and ")))
    }

    fn figure(&self, top_rad_s: f64) -> Figure {
        let mut series = Vec::new();
        for ((direction, ends), (points, line)) in
            Direction::ALL.into_iter().zip([[0.0, top_rad_s], [-top_rad_s, 0.0]]).zip(&self.sides)
        {
            let word = direction.word();
            series.push(scatter(word, points.clone()));
            let label = format!("line, {word}");
            series.extend(line.as_ref().map(|line| curve(&label, ends, 1, |v| line.at(v)).in_group(word)));
        }
        let title = match self.half_difference {
            Some(_) => "Friction over motor speed, gravity removed",
            None => "Friction over motor speed",
        };
        Figure {
            name: "friction_over_speed".into(),
            title: title.into(),
            form: Form::Cartesian,
            x: Axis::of("motor velocity", "rad/s"),
            y: Axis::of("friction torque (motor)", "Nm"),
            series,
        }
    }
}

fn identification(points: &[Plateau], lines: &Lines, planned_rad_s: f64) -> Identification {
    let top_rad_s = points.iter().map(|p| p.velocity_rad_s.abs()).fold(0.0, f64::max);
    let advice = lines.advice(top_rad_s, planned_rad_s);
    let sentences = lines.sentences().join(" ");
    Identification {
        verdict: if advice.is_none() { Verdict::Identified } else { Verdict::Inconclusive },
        summary: format!("{} strokes up to {top_rad_s:.1} rad/s (motor). {sentences}", points.len()),
        advice,
        quantities: lines.quantities(),
        figures: vec![lines.figure(top_rad_s)],
        ..Identification::default()
    }
}

/// Motor speeds with the dwell time at each.
fn speeds(values: &Values, bench: &BenchFacts) -> Result<Vec<(f64, f64)>, PlanFault> {
    let (low_rad_s, top_rad_s) = (values.number("low_speed_rad_s"), values.number("top_speed_rad_s"));
    if low_rad_s > top_rad_s {
        return Err(PlanFault::Contradiction {
            what: format!("low_speed_rad_s = {low_rad_s} must be below top_speed_rad_s = {top_rad_s}"),
            cure: "swap the two values",
        });
    }
    let steps = f64::from(values.count("speeds").max(2) - 1);
    let way_rad = values.number("travel_rad") * bench.constants.gear_ratio;
    (0..values.count("speeds"))
        .map(|i| {
            let speed_rad_s = top_rad_s * (low_rad_s / top_rad_s).powf(f64::from(i) / steps);
            let room_s = way_rad / speed_rad_s - speed_rad_s / values.number("acceleration_rad_s2");
            let ramps_s = 2.0 * speed_rad_s / values.number("acceleration_rad_s2");
            let held_s = room_s.min(values.number("dwell_s"));
            if held_s < SHORTEST_S.max(OF_RAMPS * ramps_s) {
                return Err(PlanFault::Contradiction {
                    what: format!(
                        "{speed_rad_s:.3} rad/s would be held for only {:.2} s, between ramps of {:.2} s",
                        held_s.max(0.0),
                        0.5 * ramps_s
                    ),
                    cure: "increase travel_rad, dwell_s or acceleration_rad_s2, or reduce top_speed_rad_s",
                });
            }
            Ok((speed_rad_s, held_s))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::legs::testing::joint_a;
    use super::*;
    use serde_json::json;

    fn plan(given: serde_json::Value) -> Result<Plan, PlanFault> {
        Strokes.plan(given.as_object().unwrap(), &joint_a())
    }

    #[test]
    fn every_stroke_keeps_its_way_and_its_time_and_comes_back() {
        for load in [0.0, 0.5] {
            let plan = plan(json!({"load": load, "travel_rad": 1.0, "repeats": 3})).unwrap();
            assert!(plan.preview(&joint_a()).is_allowed());
            let (lowest, highest) = plan.travel_rad();
            // Under load the brake is demagnetised over a whole link turn.
            let room_rad = if load > 0.0 { 8.0 } else { 1.0 } * joint_a().constants.gear_ratio;
            assert!(lowest > -1e-6 && highest < room_rad * 1.001, "{lowest} to {highest}");
            let legs = plan.steps.iter().filter(|s| s.brake.largest() == load * 0.6 && s.velocity.largest() < 149.0);
            assert_eq!(legs.count(), 3 * 2 * 3, "three of the four speeds, out and back, thrice");
        }
        assert!(plan(json!({})).unwrap().duration_s() < 90.0);
    }

    #[test]
    fn what_cannot_be_held_is_refused_with_a_cure() {
        for (given, message) in [
            (json!({"low_speed_rad_s": 200.0}), "low_speed_rad_s = 200 must be below"),
            (json!({"travel_rad": 0.1}), "increase travel_rad"),
        ] {
            let fault = plan(given).unwrap_err().to_string();
            assert!(fault.contains(message), "{fault}");
        }
        let bare = BenchFacts { has_brake: false, ..joint_a() };
        let fault = Strokes.plan(json!({"load": 0.3}).as_object().unwrap(), &bare).unwrap_err();
        assert!(matches!(fault, PlanFault::MissingInstrument { .. }));
    }
}
