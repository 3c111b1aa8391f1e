//! Friction over a warm-up and a cool-down: the viscosity of the lubricant falls with temperature.
//!
//! The joint is worked until it is warm, then it cools with short groups of legs in between. Warm-up and cool-down
//! pass the same temperatures at different times, so that effects of temperature and drifts over time can be
//! separated.

use super::legs::{ACCELERATION, Legs, sample_rate, turn_s, within_range_s};
use super::warm_up;
use super::{Findable, Procedure, ProcedureInfo, findable};
use crate::bench_facts::BenchFacts;
use crate::findings::{Plateau, Unusable, interval_of, parameter, plateaus, quantity, scatter, settled, verdict};
use crate::identification::{Axis, Figure, Form, Identification, Quantity, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{Phase, Plan, PlanFault};
use crate::profile::Profile;
use crate::thresholds::{LEAST_SPAN_K, NO_CHANGE};
use jointbench_instrument::{Kind, RunTable};
use jointbench_model::{Fit, ModelSpec, Options, fit_prepared};

pub(super) struct FrictionTemperature;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "friction_temperature",
    title: "Friction over temperature",
    summary: "Runs the joint until warm, then records the cool-down. Identifies how Coulomb and viscous friction \
              change with temperature.",
    kind: Kind::Friction,
    schema: &[
        Parameter::number("top_speed_rad_s", "Speed (motor)", "rad/s", 180.0, [1.0, 1000.0]),
        Parameter::number("heat_s", "Warm-up time", "s", 420.0, [20.0, 14400.0]),
        Parameter::number("cool_s", "Cool-down time", "s", 420.0, [0.0, 14400.0]),
        Parameter::number("rest_s", "Pause between measurements during cool-down", "s", 45.0, [1.0, 3600.0]),
        ACCELERATION,
        sample_rate(100.0),
    ],
};

/// Reference temperature of the coefficients.
const REFERENCE_C: f64 = 25.0;

impl Procedure for FrictionTemperature {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn can_resume(&self) -> Result<(), &'static str> {
        Err("warm-up and cool-down form one temperature history")
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let rate_hz = values.number("sample_rate_hz");
        let top_rad_s = values.number("top_speed_rad_s");
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        warm_up::work(&mut legs, top_rad_s, values.number("heat_s"), bench);
        for step in &mut legs.steps {
            step.phase = Phase::Measure;
        }
        legs.repeat = 1;
        let heated = legs.steps.len();
        let mut cooled_s = 0.0;
        while cooled_s < values.number("cool_s") {
            legs.push("rest".into(), Profile::from(0.0).hold(values.number("rest_s")), Profile::constant(0.0));
            for speed_rad_s in [top_rad_s, warm_up::SLOW_SHARE * top_rad_s] {
                let dwell_s = turn_s(0.5, speed_rad_s, bench, 1.0).min(2.0);
                let dwell_s = within_range_s(dwell_s, speed_rad_s, legs.acceleration_rad_s2, bench);
                legs.leg(speed_rad_s, dwell_s, 0.0);
                legs.leg(-speed_rad_s, dwell_s, 0.0);
            }
            cooled_s = legs.steps[heated..].iter().map(crate::plan::Step::duration_s).sum();
        }
        Ok(legs.friction_plan(self, values, bench, rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[
            ("°C", "temperature_low temperature_high"),
            ("Nm", "tau_c"),
            ("Nm·s/rad", "c_v"),
            ("Nm/K", "tau_t"),
            ("Nm·s/(rad·K)", "c_t"),
        ])
    }

    fn identify(&self, _: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify(run))
    }
}

fn identify(run: &RunTable) -> Result<Identification, Unusable> {
    if run.column("temperature_c").is_none() {
        return Err(Unusable::InsufficientData(
            "The joint reports no temperature.",
            "Connect a thermistor or a thermometer.",
        ));
    }
    let prepared = settled(run)?;
    let points = plateaus(&prepared);
    let (low_c, high_c) = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
        (p.temperature_c.min(low), p.temperature_c.max(high))
    });
    let given = run.column("link_torque_nm").map(|_| "load_transmission");
    let effects = ["coulomb", "viscous", "temperature_coulomb", "temperature_viscous"];
    let spec = ModelSpec::new(run.kind(), given.into_iter().chain(effects))?;
    let fit = fit_prepared(&prepared, &spec, &Options::default())?;
    let top_rad_s = points.iter().map(|p| p.velocity_rad_s.abs()).fold(0.0, f64::max);
    let most_nm = points.iter().map(|p| (p.target - p.load_nm).abs()).fold(0.0, f64::max);
    // Significant, and above the least change over the whole temperature span, at the highest speed.
    let moves = |effect: &str, name: &str, times: f64| {
        let least_nm = NO_CHANGE * most_nm;
        parameter(&fit, effect, name).is_some_and(|p| {
            (p.ci95[0] > 0.0 || p.ci95[1] < 0.0) && (p.value * times * (high_c - low_c)).abs() > least_nm
        })
    };
    let (dry, wet) = (moves("temperature_coulomb", "tau_t", 1.0), moves("temperature_viscous", "c_t", top_rad_s));
    let enough = high_c - low_c >= LEAST_SPAN_K;
    Ok(Identification {
        verdict: if enough { Verdict::Identified } else { Verdict::Inconclusive },
        summary: format!("{low_c:.1} to {high_c:.1} °C: {}.", changes(&fit, dry, wet)),
        advice: (!enough).then(|| "The temperature range is too small. Increase heat_s or top_speed_rad_s.".into()),
        quantities: quantities(&fit, low_c, high_c),
        figures: vec![over_temperature(run, &points), over_time(&points)],
        ..Identification::default()
    })
}

/// Changes with temperature in words. `dry`, `wet`: Coulomb and viscous friction change significantly.
fn changes(fit: &Fit, dry: bool, wet: bool) -> String {
    match (dry, wet) {
        (false, false) => format!("Coulomb and viscous friction change by less than {:.0} %", 100.0 * NO_CHANGE),
        (true, false) => "only Coulomb friction changes".to_owned(),
        (_, true) => {
            let share = parameter(fit, "temperature_viscous", "c_t").map_or(0.0, |p| p.value)
                / parameter(fit, "viscous", "c_v").map_or(f64::NAN, |p| p.value);
            let coulomb = if dry { "changes too" } else { "does not change significantly" };
            format!(
                "viscous friction changes by {:.2} %/K at {REFERENCE_C} °C; Coulomb friction {coulomb}",
                100.0 * share
            )
        }
    }
}

fn quantities(fit: &Fit, low_c: f64, high_c: f64) -> Vec<Quantity> {
    let mut quantities = vec![
        quantity(["temperature_low", "T₁", "Minimum temperature", "°C"], low_c, None),
        quantity(["temperature_high", "T₂", "Maximum temperature", "°C"], high_c, None),
    ];
    for (effect, name, words) in [
        ("coulomb", "tau_c", ["tau_c", "τ_c", "Coulomb friction (motor) at 25 °C", "Nm"]),
        ("viscous", "c_v", ["c_v", "c_v", "Viscous friction (motor) at 25 °C", "Nm·s/rad"]),
        ("temperature_coulomb", "tau_t", ["tau_t", "τ_T", "Coulomb friction (motor), change with temperature", "Nm/K"]),
        (
            "temperature_viscous",
            "c_t",
            ["c_t", "c_T", "Viscous friction (motor), change with temperature", "Nm·s/(rad·K)"],
        ),
    ] {
        if let Some(found) = parameter(fit, effect, name) {
            let (value, ci95) = interval_of(found, 1.0);
            quantities.push(quantity(words, value, Some(ci95)));
        }
    }
    quantities
}

fn over_temperature(run: &RunTable, points: &[Plateau]) -> Figure {
    let resting = |p: &&Plateau, cooling: bool| (repeat_of(run, p.segment) > 0.0) == cooling;
    let top = points.iter().map(|p| p.velocity_rad_s.abs()).fold(0.0, f64::max);
    let mut series = Vec::new();
    for (speed, fast) in [("fast", true), ("slow", false)] {
        for (way, cooling) in [("warming", false), ("cooling", true)] {
            let own = points.iter().filter(|p| resting(p, cooling) && (p.velocity_rad_s.abs() > 0.6 * top) == fast);
            let point = |p: &Plateau| (p.temperature_c, (p.target - p.load_nm).abs());
            series.push(scatter(&format!("{speed}, {way}"), own.map(point)).in_group(way));
        }
    }
    Figure {
        name: "friction_over_temperature".into(),
        title: "Friction over temperature".into(),
        form: Form::Cartesian,
        x: Axis::of("temperature", "°C"),
        y: Axis::of("friction torque (motor)", "Nm"),
        series,
    }
}

fn repeat_of(run: &RunTable, segment: i64) -> f64 {
    let row = run.column("segment").and_then(|s| s.iter().position(|v| *v as i64 == segment));
    row.zip(run.column("repeat")).map_or(0.0, |(row, repeat)| repeat[row])
}

fn over_time(points: &[Plateau]) -> Figure {
    Figure {
        name: "temperature".into(),
        title: "Temperature".into(),
        form: Form::Cartesian,
        x: Axis::of("time", "s"),
        y: Axis::of("temperature", "°C"),
        series: vec![scatter("legs", points.iter().map(|p| (p.time_s, p.temperature_c)))],
    }
}
