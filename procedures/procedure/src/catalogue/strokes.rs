//! A few speeds under one load, out and back: the short run that settles one question.
//!
//! Every leg returns to where it began, so that a joint or a slide with little room can be measured. A leg ends when its
//! time or its way is up, whichever comes first.

use super::legs::{Legs, sample_rate};
use super::{Findable, Procedure, findable};
use crate::findings::{Line, Unusable, curve, keep, legs, plateaus, quantity, scatter, settled, verdict};
use crate::identification::{Axis, Figure, Form, Identification, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{BenchFacts, Plan, PlanFault};
use jointbench_instrument::{Kind, RunTable};
use jointbench_model::words;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

pub(super) struct Strokes;

const SCHEMA: &[Parameter] = &[
    Parameter::number("low_speed_rad_s", "Minimum speed (motor)", "rad/s", 15.0, [1e-3, 1000.0]),
    Parameter::number("top_speed_rad_s", "Maximum speed (motor)", "rad/s", 150.0, [1e-3, 1000.0]),
    Parameter::count("speeds", "Number of speeds (logarithmically spaced)", 4, [1, 20]),
    Parameter::number("load", "Brake current, fraction of rated", "", 0.0, [0.0, 1.0]),
    Parameter::count("repeats", "Repeats of the profile", 2, [1, 50]),
    Parameter::number("dwell_s", "Maximum dwell time at each speed", "s", 3.0, [0.3, 60.0]),
    Parameter::number("travel_rad", "Maximum stroke length (link)", "rad", 0.6, [1e-3, 100.0]),
    Parameter::number("acceleration_rad_s2", "Acceleration (motor)", "rad/s²", 400.0, [1e-2, 5000.0]),
    sample_rate(250.0),
    Parameter::count("order_seed", "Random seed (step order)", 1, [0, 1_000_000]),
];

/// The brake is magnetised and demagnetised at this share of the highest speed at least, however slow the strokes are.
const TURNING_SHARE: f64 = 0.5;

/// A plateau shorter than this holds no settled motion.
const SHORTEST_S: f64 = 0.3;

impl Procedure for Strokes {
    fn id(&self) -> &'static str {
        "strokes"
    }

    fn title(&self) -> &'static str {
        "Constant-speed strokes"
    }

    fn summary(&self) -> &'static str {
        "Strokes in both directions at a few constant speeds under one load. A short run that answers one open \
         question of a longer run."
    }

    fn kind(&self) -> Kind {
        Kind::Friction
    }

    fn schema(&self) -> &'static [Parameter] {
        SCHEMA
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let brake_a = values.number("load") * bench.constants.brake_rated_current_a;
        if brake_a > 0.0 && !bench.has_brake {
            let cure = "set load = 0, or connect it";
            return Err(PlanFault::MissingInstrument { bench: bench.name.clone(), role: "brake", cure });
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
        ])
    }

    fn identify(&self, _: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify(run))
    }
}

/// A line through the strokes of each direction, under the load that they were made under.
fn identify(run: &RunTable) -> Result<Identification, Unusable> {
    let legs = legs(run);
    let heaviest = legs.iter().filter_map(|leg| leg.brake_nm).fold(0.0, f64::max);
    let points = plateaus(&settled(&keep(run, legs.iter().filter(|leg| leg.brake_nm == Some(heaviest)))?)?);
    let top = points.iter().map(|p| p.velocity_rad_s.abs()).fold(0.0, f64::max);
    let (mut quantities, mut series, mut flat, mut said) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (suffix, mark, sign) in [("positive", "⁺", 1.0), ("negative", "⁻", -1.0)] {
        let side = points.iter().filter(|p| p.velocity_rad_s * sign > 0.0);
        let side: Vec<(f64, f64)> = side.map(|p| (p.velocity_rad_s, p.target - p.load_nm)).collect();
        let line = Line::through(&side);
        series.push(scatter(suffix, side));
        let Some(line) = line else { continue };
        let ends = if sign > 0.0 { [0.0, top] } else { [-top, 0.0] };
        series.push(curve(&format!("line, {suffix}"), ends, 1, |v| line.at(v)));
        if line.slope_ci95[0] <= 0.0 && line.slope_ci95[1] >= 0.0 {
            flat.push(format!("{suffix} motion (r² {:.2})", line.r2));
        }
        let [offset, slope] = [(line.offset, "Nm"), (line.slope, "Nm·s/rad")].map(|(v, unit)| words::figure(v, unit));
        said.push(format!("Line in {suffix} direction: {offset} at zero speed, slope {slope}."));
        let named = |name: &str, symbol: &str, title: &str, unit: &str, value: f64, ci95: Option<[f64; 2]>| {
            let title = format!("{title}, {suffix} direction");
            let words = [&format!("{name}_{suffix}"), &format!("{symbol}{mark}"), &title, unit];
            quantity(words, value, ci95)
        };
        quantities.extend([
            named("offset", "τ₀", "Friction at zero speed (fitted line)", "Nm", line.offset, Some(line.offset_ci95)),
            named("slope", "c", "Slope over motor speed", "Nm·s/rad", line.slope, Some(line.slope_ci95)),
            named("r2", "r²", "Coefficient of determination", "", line.r2, None),
        ]);
    }
    let advice = if quantities.len() < 6 {
        Some("A line requires at least two speeds. Increase speeds.".to_owned())
    } else {
        let other = "Diagnose the run to find the cause of the differences, or increase top_speed_rad_s.";
        (!flat.is_empty()).then(|| format!("Speed has no significant linear effect in {}. {other}", flat.join(" and ")))
    };
    Ok(Identification {
        verdict: if advice.is_none() { Verdict::Identified } else { Verdict::Inconclusive },
        summary: format!("{} strokes up to {top:.1} rad/s (motor). {}", points.len(), said.join(" ")),
        advice,
        quantities,
        figures: vec![Figure {
            name: "friction_over_speed".into(),
            title: "Friction over motor speed".into(),
            form: Form::Cartesian,
            x: Axis::of("motor velocity", "rad/s"),
            y: Axis::of("friction torque (motor)", "Nm"),
            series,
        }],
        ..Identification::default()
    })
}

/// Motor speeds with the time at each.
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
            if room_s < SHORTEST_S {
                return Err(PlanFault::Contradiction {
                    what: format!("{speed_rad_s:.3} rad/s would be held for only {:.2} s", room_s.max(0.0)),
                    cure: "increase travel_rad or acceleration_rad_s2, or reduce top_speed_rad_s",
                });
            }
            Ok((speed_rad_s, room_s.min(values.number("dwell_s"))))
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
        assert!(plan(json!({})).unwrap().duration_s() < 60.0);
    }

    #[test]
    fn what_cannot_be_held_is_refused_with_a_cure() {
        for (given, said) in [
            (json!({"low_speed_rad_s": 200.0}), "low_speed_rad_s = 200 must be below"),
            (json!({"travel_rad": 0.1}), "increase travel_rad"),
        ] {
            let fault = plan(given).unwrap_err().to_string();
            assert!(fault.contains(said), "{fault}");
        }
        let bare = BenchFacts { has_brake: false, ..joint_a() };
        let fault = Strokes.plan(json!({"load": 0.3}).as_object().unwrap(), &bare).unwrap_err();
        assert!(matches!(fault, PlanFault::MissingInstrument { .. }));
    }
}
