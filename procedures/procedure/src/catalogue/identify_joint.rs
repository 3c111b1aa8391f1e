//! Identification of a joint and its brake in one run, in the order that their physical history requires. First
//! friction over temperature from the cold joint on. Then, with the warm joint: friction, breakaway, presliding,
//! friction under load, the brake, stiffness, compensation.
//!
//! Each part is planned and identified by its own procedure, on its own rows. Every part begins and ends without
//! brake current and at the start position of the run, so that the parts only share the warm-up. Compensation also
//! needs the identified friction and presliding stiffness for its feedforward: it is planned when these are known.

mod deferred;
mod part;

use super::brake_hysteresis::BrakeHysteresis;
use super::brake_speed_independence::BrakeSpeedIndependence;
use super::breakaway::Breakaway;
use super::compensation::{Compensation, STIFFNESS};
use super::friction::Friction;
use super::friction_load::FrictionLoad;
use super::friction_temperature::FrictionTemperature;
use super::legs::sample_rate;
use super::presliding::Presliding;
use super::stiffness::Stiffness;
use super::{Findable, PlannedSteps, Procedure, ProcedureInfo, procedure};
use crate::bench_facts::BenchFacts;
use crate::findings::{Unusable, verdict};
use crate::identification::{Identification, Part, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{Phase, Plan, PlanFault, Step};
use jointbench_instrument::{Kind, Meta, RunTable};
use part::table_of;
use serde_json::{Map, Value, json};

pub(super) struct IdentifyJoint;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "identify_joint",
    title: "Identify a joint",
    summary: "Complete identification of a joint and its brake in one run and one report. Parts: friction over \
              temperature, friction, breakaway, presliding, friction under load, brake over speed, brake hysteresis, \
              stiffness, and compensation of the identified friction.",
    kind: Kind::Friction,
    schema: &[
        Parameter::number("top_speed_rad_s", "Maximum speed (motor)", "rad/s", 180.0, [5.0, 1000.0]),
        Parameter::number("stribeck_speed_rad_s", "Expected Stribeck velocity (link)", "rad/s", 0.07, [0.001, 10.0]),
        Parameter::number("heat_s", "Recorded warm-up and cool-down time, each (0: skip)", "s", 420.0, [0.0, 14400.0]),
        Parameter::number("warm_up_s", "Maximum warm-up time before the other parts", "s", 20.0, [1.0, 3600.0]),
        Parameter::number(
            "swing_nm",
            "Maximum presliding amplitude, below breakaway (motor)",
            "Nm",
            0.028,
            [1e-4, 100.0],
        ),
        Parameter::count("load_levels", "Load levels, including no load", 6, [3, 20]),
        Parameter::fraction("top_load", "Maximum brake current, relative to rated", 0.8, [0.05, 1.0]),
        Parameter::number("bearing_stiffness_nm_rad", "Bearing stiffness (0: unknown)", "Nm/rad", 0.0, [0.0, 1e9]),
        Parameter::count("repeats", "Repeats of the profiles", 2, [2, 50]),
        Parameter::count(
            "periods",
            "Periods with each compensation method, at least 2, if the drive supports it (0: skip)",
            2,
            [0, 100],
        ),
        sample_rate(250.0),
    ],
};

/// Presliding stiffness with which the dynamic compensation is planned before the run.
const EXPECTED_STIFFNESS_NM_RAD: f64 = 15.0;
/// Name of the fact that assigns rows to parts.
const PARTS: &str = "parts";

/// The parts of the campaign.
const PARTS_IN_ORDER: [&str; 9] = [
    "friction_temperature",
    "friction",
    "breakaway",
    "presliding",
    "friction_load",
    "brake_speed_independence",
    "brake_hysteresis",
    "stiffness",
    "compensation",
];

/// The procedures of the campaign with their parameters.
fn parts(values: &Values, bench: &BenchFacts) -> Vec<(&'static dyn Procedure, Value)> {
    let number = |name: &str| json!(values.number(name));
    let (rate, repeats) = (number("sample_rate_hz"), number("repeats"));
    let (top, stribeck, load) = (number("top_speed_rad_s"), number("stribeck_speed_rad_s"), number("top_load"));
    // The brake runs no faster than the joint, and no slower than its procedure permits.
    let link_rad_s = (values.number("top_speed_rad_s") / bench.constants.gear_ratio).clamp(0.2, 1.5);
    let mut parts: Vec<(&'static dyn Procedure, Value)> = vec![
        (
            &Friction,
            json!({
                "top_speed_rad_s": top, "stribeck_speed_rad_s": stribeck, "warm_up_s": number("warm_up_s"),
                "load_levels": 1, "repeats": repeats, "sample_rate_hz": rate,
            }),
        ),
        (&Breakaway, json!({"sample_rate_hz": rate})),
        (&Presliding, json!({"top_torque_nm": number("swing_nm"), "sample_rate_hz": rate})),
        (
            &FrictionLoad,
            json!({
                "top_speed_rad_s": 0.7 * values.number("top_speed_rad_s"), "load_levels": number("load_levels"),
                "stribeck_speed_rad_s": stribeck, "top_load": load, "warm_up_s": 1.0, "repeats": repeats,
                "sample_rate_hz": rate,
            }),
        ),
        (&BrakeSpeedIndependence, json!({"top_speed_rad_s": link_rad_s, "top_current": load, "sample_rate_hz": rate})),
        (&BrakeHysteresis, json!({"top_current": load, "sample_rate_hz": rate})),
        (
            &Stiffness,
            json!({
                "top_load": load, "bearing_stiffness_nm_rad": number("bearing_stiffness_nm_rad"), "repeats": repeats,
                "sample_rate_hz": rate,
            }),
        ),
    ];
    if values.number("heat_s") > 0.0 {
        let each = number("heat_s");
        let given = json!({"top_speed_rad_s": top, "heat_s": each, "cool_s": each, "sample_rate_hz": rate});
        parts.insert(0, (&FrictionTemperature, given));
    }
    if values.count("periods") > 0 && bench.feeds_forward {
        let periods = values.count("periods").max(2);
        let given = json!({"periods": periods, "sample_rate_hz": rate, STIFFNESS: EXPECTED_STIFFNESS_NM_RAD});
        parts.push((&Compensation, given));
    }
    parts
}

impl Procedure for IdentifyJoint {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let mut whole: Option<Plan> = None;
        let mut facts = Vec::new();
        for (procedure, given) in parts(values, bench) {
            let mut part = procedure.plan(&given.as_object().cloned().unwrap_or_default(), bench)?;
            let steps = std::mem::take(&mut part.steps);
            let whole = whole.get_or_insert_with(|| Plan {
                procedure: self.id().to_owned(),
                parameters: values.to_json(),
                kind: self.kind(),
                meta: Meta { other: Map::new(), ..part.meta.clone() },
                ..part.clone()
            });
            // One warm-up is sufficient, because the joint stays warm.
            let is_warm = whole.steps.iter().any(|step| step.phase == Phase::WarmUp);
            whole.steady = whole.steady.or(part.steady);
            let first = whole.steps.len();
            let steps = steps.into_iter().filter(|step| !is_warm || step.phase != Phase::WarmUp);
            whole.steps.extend(numbered(steps, procedure, first));
            let steps = &whole.steps[first..];
            if let Some(warm_up) = part.meta.other.get_mut("warm_up_segments") {
                *warm_up = json!(first + steps.iter().filter(|step| step.phase == Phase::WarmUp).count());
            }
            // The feedforward is identified, not chosen.
            let parameters = if waits(procedure) { given } else { Value::Object(part.parameters) };
            facts.push(json!({
                "procedure": procedure.id(), "parameters": parameters, "meta": part.meta,
                "first_segment": first, "segments": steps.len(),
            }));
        }
        let cure = "report it";
        let mut plan = whole.ok_or(PlanFault::Contradiction { what: "a campaign without parts".into(), cure })?;
        plan.deferred = deferred::deferred_plan(&facts);
        plan.meta.other.insert(PARTS.into(), Value::Array(facts));
        Ok(plan)
    }

    fn finds(&self) -> Vec<Findable> {
        let of_part = |part: &'static dyn Procedure| {
            let named = |found: Findable| Findable { name: format!("{}.{}", part.id(), found.name), ..found };
            part.finds().into_iter().map(named).collect::<Vec<_>>()
        };
        PARTS_IN_ORDER.into_iter().filter_map(procedure).flat_map(of_part).collect()
    }

    fn identify(&self, _: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify(run))
    }

    fn plan_deferred(&self, run: &RunTable, bench: &BenchFacts) -> Result<PlannedSteps, String> {
        deferred::compensation(run, bench)
    }
}

/// The steps of a part with their names and numbers in the campaign.
fn numbered(
    steps: impl IntoIterator<Item = Step>,
    procedure: &dyn Procedure,
    first: usize,
) -> impl Iterator<Item = Step> {
    let title = procedure.title().to_lowercase();
    steps.into_iter().zip(first as u32..).map(move |(step, segment)| Step {
        label: format!("{title}: {}", step.label),
        segment,
        ..step
    })
}

/// Whether the steps of a part depend on the result of another part.
fn waits(procedure: &dyn Procedure) -> bool {
    procedure.id() == Compensation.id()
}

const FOREIGN: Unusable =
    Unusable::InsufficientData("The parts of the campaign are not stored with the run.", "Run identify_joint.");

fn parts_of(run: &RunTable) -> Result<&[Value], Unusable> {
    Ok(run.meta().other.get(PARTS).and_then(Value::as_array).ok_or(FOREIGN)?)
}

/// A part's procedure and its result from its rows. `None`: it has no identification.
fn found(
    run: &RunTable,
    facts: &[Value],
    number: usize,
) -> Result<(&'static dyn Procedure, Option<Identification>), Unusable> {
    let procedure = facts[number]["procedure"].as_str().and_then(procedure).ok_or(FOREIGN)?;
    let given = facts[number]["parameters"].as_object().ok_or(FOREIGN)?;
    let values = Values::parse(procedure.schema(), given).map_err(|_| FOREIGN)?;
    Ok((procedure, table_of(run, facts, number).ok().and_then(|table| procedure.identify(&values, &table))))
}

fn identify(run: &RunTable) -> Result<Identification, Unusable> {
    let facts = parts_of(run)?;
    let mut whole =
        Identification { verdict: Verdict::Identified, lead: Some(String::new()), ..Identification::default() };
    for number in 0..facts.len() {
        let (procedure, found) = found(run, facts, number)?;
        let found = found.unwrap_or_else(|| none_of(procedure, &whole));
        let id = procedure.id();
        let words = |text: &str| format!("{}: {text}", procedure.title());
        let below = |above: &str, line: String| [above, &line].join("\n").trim_start().to_owned();
        if found.verdict != Verdict::Identified && whole.verdict != Verdict::Failed {
            whole.verdict = found.verdict;
        }
        let conclusion = match found.verdict {
            Verdict::Identified => words(&found.summary),
            Verdict::Inconclusive => format!("{} (inconclusive): {}", procedure.title(), found.summary),
            Verdict::Failed => format!("{} (failed): {}", procedure.title(), found.summary),
        };
        whole.summary = below(&whole.summary, conclusion);
        whole.parts.push(Part {
            id: id.to_owned(),
            title: procedure.title().to_owned(),
            verdict: found.verdict,
            summary: found.summary,
            quantities: found.quantities.iter().map(|quantity| format!("{id}.{}", quantity.name)).collect(),
            figures: found.figures.iter().map(|figure| format!("{id}.{}", figure.name)).collect(),
        });
        if let Some(advice) = found.advice {
            whole.advice = Some(below(&whole.advice.take().unwrap_or_default(), words(&advice)));
        }
        whole.quantities.extend(found.quantities.into_iter().map(|quantity| quantity.in_part(id, procedure.title())));
        whole.figures.extend(found.figures.into_iter().map(|mut figure| {
            figure.name = format!("{id}.{}", figure.name);
            figure
        }));
    }
    Ok(whole)
}

/// A part without rows, after the earlier ones.
fn none_of(part: &dyn Procedure, before: &Identification) -> Identification {
    match before.verdict {
        Verdict::Inconclusive if waits(part) => Identification::inconclusive(
            "Not performed, because friction is not determined well enough for feed-forward.",
            "Follow the advice of the friction part, then repeat the run.",
        ),
        _ => Identification::failed("The run ended before this part.", "Repeat the run."),
    }
}

#[cfg(test)]
mod tests {
    use super::super::legs::testing::{joint_a, joint_b};
    use super::*;
    use jointbench_instrument::{Channel, Trace};

    #[test]
    fn the_parts_follow_each_other_in_one_plan() {
        for facts in [joint_a(), joint_b()] {
            let plan = IdentifyJoint.plan(&Map::new(), &facts).unwrap();
            assert!(plan.preview(&facts).is_allowed(), "{:?}", plan.preview(&facts).checks);
            assert!(plan.steps.iter().enumerate().all(|(i, step)| step.segment as usize == i));
            let parts = plan.meta.other[PARTS].as_array().unwrap();
            let ids: Vec<&str> = parts.iter().filter_map(|part| part["procedure"].as_str()).collect();
            assert_eq!(ids, PARTS_IN_ORDER);
            assert!(plan.steady.is_some(), "the warm-up ends when the joint is warm");
            let steps: i64 = parts.iter().filter_map(|part| part["segments"].as_i64()).sum();
            assert_eq!(steps as usize, plan.steps.len());
            // Every part ends without brake current.
            for part in parts {
                let last = part["first_segment"].as_u64().unwrap() + part["segments"].as_u64().unwrap() - 1;
                assert_eq!(plan.steps[last as usize].brake.end(), 0.0, "{}", part["procedure"]);
            }
        }
    }

    #[test]
    fn compensation_waits_for_friction_and_is_left_out_where_the_drive_cannot() {
        let plan = IdentifyJoint.plan(&Map::new(), &joint_a()).unwrap();
        let deferred = plan.deferred.unwrap();
        assert_eq!(deferred.to.end as usize, plan.steps.len());
        assert!(
            deferred.from.end < deferred.to.start
                && plan.steps[deferred.from.start as usize].label.starts_with("friction:")
        );
        let cannot = BenchFacts { feeds_forward: false, ..joint_a() };
        let shorter = IdentifyJoint.plan(&Map::new(), &cannot).unwrap();
        assert!(shorter.deferred.is_none() && shorter.steps.len() == deferred.to.start as usize);
        assert!(shorter.preview(&cannot).is_allowed());
    }

    #[test]
    fn a_run_of_another_procedure_is_recognised() {
        let mut trace = Trace::new(["time_s", "motor_position_rad", "motor_current_a"].map(Channel::new).into());
        (0..20).for_each(|i| trace.push_row(&[f64::from(i), 0.0, 0.0]));
        let run = RunTable::new(Meta { kind: Some(Kind::Friction), ..Meta::default() }, trace).unwrap();
        let found = IdentifyJoint.identify(&Values::parse(INFO.schema, &Map::new()).unwrap(), &run).unwrap();
        assert_eq!(found.verdict, Verdict::Failed);
    }
}
