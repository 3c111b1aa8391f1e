//! Friction over load and speed: the dependence of friction on the load.
//!
//! The plan is that of `friction` with more loads and fewer speeds. The torque sensor measures the brake torque. The
//! additional motor torque is the load-dependent friction.

use super::compensation;
use super::friction::Friction;
use super::legs::sample_rate;
use super::{Findable, Procedure, ProcedureInfo, findable};
use crate::bench_facts::BenchFacts;
use crate::findings::{
    Unusable, bounded, curve, interval_of, legs, parameter, plateaus, quantity, scatter, select_legs, settled, verdict,
};
use crate::identification::{Axis, Figure, FollowUp, Form, Identification, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{Plan, PlanFault};
use jointbench_instrument::{Kind, RunTable};
use jointbench_model::words;
use jointbench_model::{Fit, ModelError, ModelSpec, Options, fit};

pub(super) struct FrictionLoad;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "friction_load",
    title: "Friction under load",
    summary: "Measures friction on a grid of loads and speeds. Decides whether friction grows with the load, in \
              proportion or with its square.",
    kind: Kind::Friction,
    schema: &[
        Parameter::number("top_speed_rad_s", "Maximum speed (motor)", "rad/s", 120.0, [5.0, 1000.0]),
        Parameter::number("stribeck_speed_rad_s", "Expected Stribeck velocity (link)", "rad/s", 0.07, [0.001, 10.0]),
        Parameter::count("speeds", "Number of speeds above the Stribeck velocity", 3, [2, 20]),
        Parameter::count("load_levels", "Load levels, including no load", 6, [3, 20]),
        Parameter::fraction("top_load", "Maximum brake current, relative to rated", 0.8, [0.05, 1.0]),
        Parameter::count("repeats", "Repeats of the profile", 2, [2, 50]),
        Parameter::number("warm_up_s", "Maximum warm-up time", "s", 20.0, [1.0, 3600.0]),
        sample_rate(250.0),
        Parameter::count("order_seed", "Random seed (step order)", 1, [0, 1_000_000]),
    ],
};

impl Procedure for FrictionLoad {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let mut given = values.to_json();
        if let Some(speeds) = given.remove("speeds") {
            given.insert("fast_speeds".into(), speeds);
        }
        let plan = Friction.plan(&given, bench)?;
        Ok(Plan { procedure: self.id().to_owned(), parameters: values.to_json(), ..plan })
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[("Nm", "tau_c added"), ("Nm·s/rad", "c_v"), ("", "mu"), ("1/Nm", "mu_2")])
    }

    fn identify(&self, _: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify(run))
    }

    fn follow_up(&self, found: &Identification) -> Option<FollowUp> {
        compensation::of_load(found)
    }
}

/// Candidate laws of load-dependent friction, alone or in combination.
const LAWS: [&[&str]; 4] = [&[], &["load_linear"], &["load_quadratic"], &["load_linear", "load_quadratic"]];

fn identify(run: &RunTable) -> Result<Identification, Unusable> {
    let warm_up = run.meta().other.get("warm_up_segments").and_then(serde_json::Value::as_i64).unwrap_or(0);
    let legs = legs(run);
    let held = || legs.iter().filter(|leg| leg.segment >= warm_up && leg.direction != 0.0 && leg.brake_nm.is_some());
    let table = select_legs(run, held())?;
    let (law, fit) = choose(&table)?;
    let gear = run.meta().gear_ratio.unwrap_or(1.0);
    let mut quantities = Vec::new();
    for (effect, name, words) in [
        ("coulomb", "tau_c", ["tau_c", "τ_c", "Coulomb friction (motor)", "Nm"]),
        ("viscous", "c_v", ["c_v", "c_v", "Viscous friction (motor)", "Nm·s/rad"]),
        ("load_linear", "mu", ["mu", "μ", "Friction per Nm of load (motor)", ""]),
        ("load_quadratic", "mu_2", ["mu_2", "μ₂", "Friction per Nm² of load (motor)", "1/Nm"]),
    ] {
        if let Some(found) = parameter(&fit, effect, name) {
            let (value, ci95) = interval_of(found, 1.0);
            quantities.push(quantity(words, value, Some(ci95)));
        }
    }
    let laws = Law::of(&fit);
    let heaviest = held().filter_map(|leg| leg.brake_nm).fold(0.0, f64::max);
    let added_nm = laws.added_nm(heaviest / gear);
    let added = added(&table, law, &fit, heaviest / gear);
    let words_of_added = ["added", "Δτ", "Additional friction at maximum load (motor)", "Nm"];
    quantities.push(match added {
        Some((value, ci95)) => quantity(words_of_added, value, Some(ci95)),
        None => quantity(words_of_added, added_nm, None),
    });
    let more = format!("+{} at {heaviest:.1} Nm (commanded)", words::figure(added_nm, "Nm"));
    let summary = match law {
        [] => {
            let bound =
                added.map(|added| format!(": {} at {heaviest:.1} Nm", bounded(added, "Nm"))).unwrap_or_default();
            format!("Friction does not change significantly with the load{bound}.")
        }
        ["load_linear"] => format!("Friction grows in proportion to the load: {more}."),
        ["load_quadratic"] => format!("Friction grows with the square of the load: {more}."),
        _ => format!("Friction grows with the load, with a linear and a quadratic part: {more}."),
    };
    Ok(Identification {
        verdict: Verdict::Identified,
        summary,
        quantities,
        figures: vec![over_load(&table, gear, laws)?],
        ..Identification::default()
    })
}

/// Additional friction at a load (motor side), with the interval of its coefficient. Without a significant law that of
/// the linear one. `None` for two coefficients, whose errors depend on each other.
fn added(table: &RunTable, law: &'static [&'static str], fit: &Fit, load_nm: f64) -> Option<(f64, [f64; 2])> {
    let of = |fit: &Fit, effect: &str, name: &str, times: f64| {
        parameter(fit, effect, name).map(|found| interval_of(found, times))
    };
    match law {
        [] => of(&under(table, LAWS[1]).ok()?, "load_linear", "mu", load_nm),
        ["load_linear"] => of(fit, "load_linear", "mu", load_nm),
        ["load_quadratic"] => of(fit, "load_quadratic", "mu_2", load_nm * load_nm),
        _ => None,
    }
}

/// The law with the smallest validation error, among those whose parameters are all identified.
fn choose(table: &RunTable) -> Result<(&'static [&'static str], Fit), Unusable> {
    let mut best = (LAWS[0], under(table, LAWS[0])?);
    for law in &LAWS[1..] {
        let Ok(fit) = under(table, law) else { continue };
        let decided = fit.parameters.iter().filter(|p| law.contains(&p.effect.as_str())).all(|p| {
            let [low, high] = p.ci95;
            low > 0.0 || high < 0.0
        });
        if decided && fit.validation_rms < 0.99 * best.1.validation_rms {
            best = (law, fit);
        }
    }
    Ok(best)
}

/// The fit of one law, with a Stribeck part if the run identifies it. The Stribeck part is selected for each law
/// separately: a missing load effect hides the rise and biases Coulomb and viscous friction.
fn under(table: &RunTable, law: &[&'static str]) -> Result<Fit, ModelError> {
    let with = |more: &[&'static str]| {
        let effects = ["load_transmission", "coulomb", "viscous"].iter().chain(more).chain(law).copied();
        ModelSpec::new(table.kind(), effects).and_then(|spec| fit(table, &spec, &Options::default()))
    };
    let plain = with(&[])?;
    // A Stribeck part that the run does not identify only widens the interval of Coulomb friction.
    let is_decided = |rich: &Fit| ["tau_s", "omega_s"].iter().all(|name| parameter(rich, "stribeck", name).is_some());
    Ok(match with(&["stribeck"]) {
        Ok(rich) if rich.validation_rms < plain.validation_rms && is_decided(&rich) => rich,
        _ => plain,
    })
}

/// Fitted load-dependent friction.
#[derive(Debug, Clone, Copy)]
struct Law {
    mu: f64,
    mu_2_per_nm: f64,
}

impl Law {
    fn of(fit: &Fit) -> Self {
        let value = |effect: &str, name: &str| parameter(fit, effect, name).map_or(0.0, |p| p.value);
        Self { mu: value("load_linear", "mu"), mu_2_per_nm: value("load_quadratic", "mu_2") }
    }

    /// Both on the motor side (Nm).
    fn added_nm(self, load_nm: f64) -> f64 {
        self.mu * load_nm + self.mu_2_per_nm * load_nm * load_nm
    }
}

/// Points of a fitted line from zero load to the highest.
const STEPS: u32 = 20;

/// Friction over load with the fitted law, one series for each speed, both directions as magnitudes.
fn over_load(table: &RunTable, gear: f64, law: Law) -> Result<Figure, Unusable> {
    let mut points = plateaus(&settled(table)?);
    points.sort_by(|a, b| a.velocity_rad_s.abs().total_cmp(&b.velocity_rad_s.abs()));
    let alike = |a: &crate::findings::Plateau, b: &crate::findings::Plateau| {
        (a.velocity_rad_s.abs() / b.velocity_rad_s.abs() - 1.0).abs() < 0.05
    };
    let series = points.chunk_by(alike).filter(|same| same.len() >= 4).flat_map(|same| {
        let label = format!("{:.1} rad/s", same[same.len() / 2].velocity_rad_s.abs());
        let point = |p: &crate::findings::Plateau| ((p.load_nm * gear).abs(), (p.target - p.load_nm).abs());
        let seen: Vec<(f64, f64)> = same.iter().map(point).collect();
        // The part without load depends on the speed only.
        let bare_nm =
            seen.iter().map(|(link_nm, nm)| nm - law.added_nm(link_nm / gear)).sum::<f64>() / seen.len() as f64;
        let top_nm = seen.iter().map(|p| p.0).fold(0.0, f64::max);
        let line =
            curve(&format!("fit, {label}"), [0.0, top_nm], STEPS, |link_nm| bare_nm + law.added_nm(link_nm / gear));
        [scatter(&label, seen), line.in_group(&label)]
    });
    Ok(Figure {
        name: "friction_over_load".into(),
        title: "Friction over load".into(),
        form: Form::Cartesian,
        x: Axis::of("link torque", "Nm"),
        y: Axis::of("friction torque (motor)", "Nm"),
        series: series.collect(),
    })
}
