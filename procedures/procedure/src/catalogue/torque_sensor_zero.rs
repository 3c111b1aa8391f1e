//! The torque sensor's zero and its drift.
//!
//! A resting line is never free of torque: what it was wound up with stays in it. So the joint goes out and back slowly
//! without load, and the zero is half the sum of both directions: drag has the sign of motion, the zero has not.

use super::Procedure;
use super::legs::{ACCELERATION, Legs, sample_rate};
use crate::findings::{Line, Mean, Unusable, curve, holds, quantity, scatter, verdict};
use crate::identification::{Axis, Figure, Form, Identification, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{BenchFacts, Plan, PlanFault};
use jointbench_instrument::{Kind, RunTable};

pub(super) struct TorqueSensorZero;

const SCHEMA: &[Parameter] = &[
    Parameter::number("duration_s", "Duration", "s", 300.0, [10.0, 7200.0]),
    Parameter::number("speed_rad_s", "Speed (link)", "rad/s", 0.3, [0.05, 20.0]),
    Parameter::number("dwell_s", "Constant speed each way", "s", 2.0, [0.5, 60.0]),
    Parameter::number("steady_nm_per_min", "Steady below this drift", "Nm/min", 0.002, [1e-5, 1.0]),
    ACCELERATION,
    sample_rate(100.0),
];

/// The settled end of a hold: the brake's rotor winds up first.
const SETTLED: f64 = 0.6;
/// Share of the run at its end that the zero and its drift are taken from.
const END: f64 = 1.0 / 3.0;

impl Procedure for TorqueSensorZero {
    fn id(&self) -> &'static str {
        "torque_sensor_zero"
    }

    fn title(&self) -> &'static str {
        "Zero of the torque sensor"
    }

    fn summary(&self) -> &'static str {
        "Goes out and back slowly without load: half the sum of both directions is the sensor's zero. Shows how it drifts as the sensor warms up."
    }

    fn kind(&self) -> Kind {
        Kind::Friction
    }

    fn schema(&self) -> &'static [Parameter] {
        SCHEMA
    }

    fn goes_on(&self) -> Result<(), &'static str> {
        Err("the sensor's drift is one history")
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        if !bench.has_torque_sensor {
            let cure = "connect it";
            return Err(PlanFault::MissingInstrument { bench: bench.name.clone(), role: "torque sensor", cure });
        }
        let rate_hz = values.number("sample_rate_hz");
        let speed_rad_s = values.number("speed_rad_s") * bench.constants.gear_ratio;
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        let mut planned_s = 0.0;
        while planned_s < values.number("duration_s") {
            legs.leg(speed_rad_s, values.number("dwell_s"), 0.0);
            legs.leg(-speed_rad_s, values.number("dwell_s"), 0.0);
            legs.repeat += 1;
            planned_s = legs.steps.iter().map(crate::plan::Step::duration_s).sum();
        }
        Ok(legs.friction_plan(self, values, bench, rate_hz))
    }

    fn identify(&self, values: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify(values, run))
    }
}

fn identify(values: &Values, run: &RunTable) -> Result<Identification, Unusable> {
    let torque = run.column("link_torque_nm").unwrap_or_default();
    let time_s = run.column("time_s").unwrap_or_default();
    let held: Vec<_> = holds(run, 0.3).into_iter().filter(|hold| hold.velocity_rad_s != 0.0).collect();
    let pairs = held.chunk_by(|a, b| a.repeat == b.repeat).filter(|pair| pair.len() == 2);
    let (mut zeros, mut drags) = (Vec::new(), Vec::new());
    for pair in pairs {
        let [out, back] = [&pair[0], &pair[1]].map(|hold| hold.mean(torque, SETTLED));
        let at_min = 0.5 * (time_s[pair[0].rows.start] + time_s[pair[1].rows.end - 1]) / 60.0;
        zeros.push((at_min, 0.5 * (out + back)));
        drags.push(0.5 * (out - back));
    }
    let end = &zeros[zeros.len() - (zeros.len() as f64 * END).ceil() as usize..];
    let values_nm: Vec<f64> = end.iter().map(|p| p.1).collect();
    let (Some(zero), Some(drift), Some(drag)) = (Mean::of(&values_nm), Line::through(end), Mean::of(&drags)) else {
        return Err(Unusable::TooLittle("too few strokes: give it a longer duration_s"));
    };
    let steady = drift.slope_ci95.map(f64::abs).into_iter().fold(0.0, f64::max) <= values.number("steady_nm_per_min");
    Ok(Identification {
        verdict: if steady { Verdict::Identified } else { Verdict::Inconclusive },
        summary: format!(
            "The zero of the range in use is {:.1} mNm at the end and drifts by {:.2} mNm/min.",
            1e3 * zero.value,
            1e3 * drift.slope
        ),
        advice: (!steady).then(|| "Let the sensor warm up and measure again, or take a longer duration_s.".into()),
        quantities: vec![
            quantity(["zero", "τ₀", "Zero of the torque sensor", "Nm"], zero.value, Some(zero.ci95)),
            quantity(["drift", "dτ₀/dt", "Drift of the zero", "Nm/min"], drift.slope, Some(drift.slope_ci95)),
            quantity(["drag", "τ_d", "Drag of the line", "Nm"], drag.value, Some(drag.ci95)),
        ],
        figures: vec![Figure {
            name: "zero_over_time".into(),
            title: "Zero of the torque sensor".into(),
            form: Form::Cartesian,
            x: Axis::of("time", "min"),
            y: Axis::of("torque", "Nm"),
            series: vec![
                scatter("half the sum of both directions", zeros.iter().copied()),
                curve("drift", [end[0].0, end[end.len() - 1].0], 1, |t| drift.at(t)),
            ],
        }],
    })
}
