//! A joint in one run: friction from the warm-up on, friction under load, breakaway, stiffness.
//!
//! Each part is planned by its own procedure and identified by it, on its own rows. Every part begins and ends without
//! brake current and where the run began, so that the parts need nothing of each other but the warm-up.

use super::breakaway::Breakaway;
use super::friction::Friction;
use super::friction_load::FrictionLoad;
use super::legs::sample_rate;
use super::stiffness::Stiffness;
use super::{Procedure, procedure};
use crate::findings::{Unusable, keep_rows, verdict};
use crate::identification::{Identification, Verdict};
use crate::parameter::{Parameter, Values};
use crate::plan::{BenchFacts, Plan, PlanFault, Step};
use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
use serde_json::{Map, Value, json};

pub(super) struct IdentifyJoint;

const SCHEMA: &[Parameter] = &[
    Parameter::number("top_speed_rad_s", "Highest speed (motor)", "rad/s", 180.0, [5.0, 1000.0]),
    Parameter::number("stribeck_speed_rad_s", "Expected Stribeck velocity (link)", "rad/s", 0.07, [0.001, 10.0]),
    Parameter::number("warm_up_s", "Longest warm-up", "s", 20.0, [1.0, 3600.0]),
    Parameter::count("load_levels", "Load levels, no load included", 6, [3, 20]),
    Parameter::number("top_load", "Highest brake current, share of rated", "", 0.8, [0.05, 1.0]),
    Parameter::number("bearing_stiffness_nm_rad", "Stiffness of the bearing, 0: none known", "Nm/rad", 0.0, [0.0, 1e9]),
    Parameter::count("repeats", "Repeats of the profiles", 2, [2, 50]),
    sample_rate(250.0),
];

/// Name of the fact that tells which rows are whose.
const PARTS: &str = "parts";

/// What the campaign consists of.
pub(super) const PARTS_IN_ORDER: [&str; 4] = ["friction", "breakaway", "friction_load", "stiffness"];

/// One procedure of the campaign with the choices that it gets.
fn parts(values: &Values) -> Vec<(&'static dyn Procedure, Value)> {
    let number = |name: &str| json!(values.number(name));
    let (rate, repeats) = (number("sample_rate_hz"), number("repeats"));
    vec![
        (
            &Friction,
            json!({
                "top_speed_rad_s": number("top_speed_rad_s"), "stribeck_speed_rad_s": number("stribeck_speed_rad_s"),
                "warm_up_s": number("warm_up_s"), "load_levels": 1, "repeats": repeats, "sample_rate_hz": rate,
            }),
        ),
        (&Breakaway, json!({"sample_rate_hz": rate})),
        (
            &FrictionLoad,
            json!({
                "top_speed_rad_s": 0.7 * values.number("top_speed_rad_s"), "load_levels": number("load_levels"),
                "stribeck_speed_rad_s": number("stribeck_speed_rad_s"), "top_load": number("top_load"),
                "warm_up_s": 1.0, "repeats": repeats, "sample_rate_hz": rate,
            }),
        ),
        (
            &Stiffness,
            json!({
                "top_load": number("top_load"), "bearing_stiffness_nm_rad": number("bearing_stiffness_nm_rad"),
                "repeats": repeats, "sample_rate_hz": rate,
            }),
        ),
    ]
}

impl Procedure for IdentifyJoint {
    fn id(&self) -> &'static str {
        "identify_joint"
    }

    fn title(&self) -> &'static str {
        "Identify a joint"
    }

    fn summary(&self) -> &'static str {
        "The whole campaign of a joint in one run: friction, breakaway, friction under load, stiffness, in this order and ending in one report."
    }

    fn kind(&self) -> Kind {
        Kind::Friction
    }

    fn schema(&self) -> &'static [Parameter] {
        SCHEMA
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let mut whole: Option<Plan> = None;
        let mut facts = Vec::new();
        for (number, (procedure, given)) in parts(values).into_iter().enumerate() {
            let given = given.as_object().cloned().unwrap_or_default();
            let part = procedure.plan(&given, bench)?;
            let first = whole.as_ref().map_or(0, |plan| plan.steps.len());
            let fact = json!({
                "procedure": procedure.id(), "parameters": Value::Object(part.parameters), "meta": part.meta,
                "first_segment": first, "segments": part.steps.len(),
            });
            facts.push(fact);
            let whole = whole.get_or_insert_with(|| Plan {
                procedure: self.id(),
                parameters: values.to_json(),
                kind: self.kind(),
                meta: Meta { other: Map::new(), ..part.meta.clone() },
                steps: Vec::new(),
                ..part
            });
            // Only the first part is warmed up for: what the joint has once it keeps.
            let steps = part.steps.into_iter().filter(|step| number == 0 || step.phase != crate::plan::Phase::WarmUp);
            let before = whole.steps.len() as u32;
            whole.steps.extend(steps.zip(before..).map(|(step, segment)| Step {
                label: format!("{}: {}", procedure.title().to_lowercase(), step.label),
                segment,
                ..step
            }));
            if let Some(fact) = facts.last_mut() {
                fact["segments"] = json!(whole.steps.len() - first);
                if number > 0
                    && let Some(other) = fact["meta"].as_object_mut()
                {
                    other.insert("warm_up_segments".into(), json!(0));
                }
            }
        }
        let cure = "report it";
        let mut plan = whole.ok_or(PlanFault::Contradiction { what: "a campaign without parts".into(), cure })?;
        plan.meta.other.insert(PARTS.into(), Value::Array(facts));
        Ok(plan)
    }

    fn identify(&self, _: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify(run))
    }
}

fn identify(run: &RunTable) -> Result<Identification, Unusable> {
    const FOREIGN: Unusable =
        Unusable::TooLittle("the run does not say which of its rows are whose: it is of another procedure");
    let facts = run.meta().other.get(PARTS).and_then(Value::as_array).ok_or(FOREIGN)?;
    let mut whole = Identification {
        verdict: Verdict::Identified,
        summary: String::new(),
        advice: None,
        quantities: Vec::new(),
        figures: Vec::new(),
    };
    for (number, fact) in facts.iter().enumerate() {
        let procedure = fact["procedure"].as_str().and_then(procedure).ok_or(FOREIGN)?;
        let given = fact["parameters"].as_object().ok_or(FOREIGN)?;
        let values = Values::parse(procedure.schema(), given).map_err(|_| FOREIGN)?;
        let found = match table_of(run, facts, number) {
            Ok(table) => procedure.identify(&values, &table),
            Err(_) => Some(Identification::failed("The run ended before this part.", "Make the run again.")),
        };
        let Some(found) = found else { continue };
        let id = procedure.id();
        let words = |text: &str| format!("{}: {text}", procedure.title());
        if found.verdict != Verdict::Identified && whole.verdict != Verdict::Failed {
            whole.verdict = found.verdict;
        }
        whole.summary = [whole.summary.as_str(), &words(&found.summary)].join(" ").trim().to_owned();
        if let Some(advice) = found.advice {
            let before = whole.advice.take().unwrap_or_default();
            whole.advice = Some([before.as_str(), &words(&advice)].join(" ").trim().to_owned());
        }
        whole.quantities.extend(found.quantities.into_iter().map(|mut quantity| {
            quantity.name = format!("{id}.{}", quantity.name);
            quantity
        }));
        whole.figures.extend(found.figures.into_iter().map(|mut figure| {
            figure.name = format!("{id}.{}", figure.name);
            figure
        }));
    }
    Ok(whole)
}

/// The rows of one part as a table of its own kind. A step that was made again after a pause has a number of its own: it
/// belongs to the part that the rows before it belong to.
fn table_of(run: &RunTable, facts: &[Value], number: usize) -> Result<RunTable, Unusable> {
    const NONE: Unusable = Unusable::TooLittle("the run ended before this part: make it again");
    let ranges: Vec<_> = facts
        .iter()
        .map(|fact| {
            let first = fact["first_segment"].as_i64().unwrap_or(0);
            first..first + fact["segments"].as_i64().unwrap_or(0)
        })
        .collect();
    let segment = run.column("segment").unwrap_or_default();
    let (mut part, mut first, mut last) = (0, None, 0);
    for (row, segment) in segment.iter().enumerate() {
        part = ranges.iter().position(|range| range.contains(&(*segment as i64))).unwrap_or(part);
        if part == number {
            first = first.or(Some(row));
            last = row;
        }
    }
    let rows = first.ok_or(NONE)?..last + 1;
    let (_, trace) = keep_rows(run, &[rows])?.into_parts();
    let meta: Meta = serde_json::from_value(facts[number]["meta"].clone()).map_err(|_| NONE)?;
    let (mut channels, mut columns) = (trace.channels().to_vec(), trace.columns().to_vec());
    if meta.kind == Some(Kind::Stiffness)
        && let (Some(velocity), Some(gear)) = (trace.column("motor_velocity_rad_s"), meta.gear_ratio)
    {
        channels.push(Channel::new("link_velocity_rad_s"));
        columns.push(velocity.iter().map(|v| v / gear).collect());
    }
    Ok(RunTable::new(meta, Trace::from_columns(channels, columns))?)
}

#[cfg(test)]
mod tests {
    use super::super::legs::testing::{joint_a, joint_b};
    use super::*;

    #[test]
    fn the_parts_follow_each_other_in_one_plan() {
        for facts in [joint_a(), joint_b()] {
            let plan = IdentifyJoint.plan(&Map::new(), &facts).unwrap();
            assert!(plan.preview(&facts).is_allowed(), "{:?}", plan.preview(&facts).checks);
            assert!(plan.steps.iter().enumerate().all(|(i, step)| step.segment as usize == i));
            let parts = plan.meta.other[PARTS].as_array().unwrap();
            let ids: Vec<&str> = parts.iter().filter_map(|part| part["procedure"].as_str()).collect();
            assert_eq!(ids, PARTS_IN_ORDER);
            let steps: i64 = parts.iter().filter_map(|part| part["segments"].as_i64()).sum();
            assert_eq!(steps as usize, plan.steps.len());
            // Every part leaves the brake without current.
            for part in parts {
                let last = part["first_segment"].as_u64().unwrap() + part["segments"].as_u64().unwrap() - 1;
                assert_eq!(plan.steps[last as usize].brake.end(), 0.0, "{}", part["procedure"]);
            }
        }
    }

    #[test]
    fn a_run_of_another_procedure_is_told_apart() {
        let mut trace = Trace::new(["time_s", "motor_position_rad", "motor_current_a"].map(Channel::new).into());
        (0..20).for_each(|i| trace.push_row(&[f64::from(i), 0.0, 0.0]));
        let run = RunTable::new(Meta { kind: Some(Kind::Friction), ..Meta::default() }, trace).unwrap();
        let found = IdentifyJoint.identify(&Values::parse(SCHEMA, &Map::new()).unwrap(), &run).unwrap();
        assert_eq!(found.verdict, Verdict::Failed);
    }
}
