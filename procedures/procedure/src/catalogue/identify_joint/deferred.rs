//! Compensation of the friction that the campaign itself identified.

use super::super::compensation::{self, Compensation, STIFFNESS};
use super::super::{PlannedSteps, Procedure};
use super::{Friction, Presliding, found, numbered, parts_of};
use crate::bench_facts::BenchFacts;
use crate::deferred_plan::DeferredPlan;
use crate::identification::Verdict;
use jointbench_instrument::RunTable;
use serde_json::Value;
use std::ops::Range;

/// The part that waits, and the parts that it depends on.
pub(super) fn deferred_plan(facts: &[Value]) -> Option<DeferredPlan> {
    let of = |part: &dyn Procedure| Some(segments(&facts[place(facts, part)?]));
    let from = of(&Friction)?.start..of(&Presliding)?.end;
    Some(DeferredPlan { from, to: of(&Compensation)?, earlier: None })
}

/// The steps of compensation with the friction and the presliding stiffness identified from the earlier rows.
pub(super) fn compensation(run: &RunTable, bench: &BenchFacts) -> Result<PlannedSteps, String> {
    let facts = parts_of(run).map_err(|why| why.to_string())?;
    let result = |part: &dyn Procedure| {
        let number = place(facts, part).ok_or("the campaign does not contain all parts")?;
        found(run, facts, number).map(|(_, found)| found).map_err(|why| why.to_string())
    };
    let to = place(facts, &Compensation).ok_or("the campaign does not contain all parts")?;
    let friction = result(&Friction)?.ok_or("the friction part has no samples")?;
    if friction.verdict != Verdict::Identified {
        return Err(format!("friction is not determined well enough for feed-forward. {}", friction.summary));
    }
    let next = compensation::of_friction(&friction).ok_or("the identified friction cannot be used for feed-forward")?;
    let dynamic = result(&Presliding)?.and_then(|presliding| compensation::of_presliding(&presliding));
    let mut identified = next.parameters;
    identified.insert(STIFFNESS.into(), 0.0.into());
    identified.extend(dynamic.map(|next| next.parameters).unwrap_or_default());
    let mut parameters = facts[to]["parameters"].as_object().cloned().unwrap_or_default();
    parameters.extend(identified.clone());
    let plan = Compensation.plan(&parameters, bench).map_err(|fault| fault.to_string())?;
    if let Some(broken) = plan.preview(bench).checks.into_iter().find(|check| !check.ok) {
        return Err(broken.detail);
    }
    let fed: Vec<String> = identified.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    let first = segments(&facts[to]).start as usize;
    Ok(PlannedSteps {
        steps: numbered(plan.steps, &Compensation, first).collect(),
        message: format!("Compensation uses the identified friction: {}", fed.join(", ")),
    })
}

fn place(facts: &[Value], part: &dyn Procedure) -> Option<usize> {
    facts.iter().position(|fact| fact["procedure"] == part.id())
}

fn segments(fact: &Value) -> Range<u32> {
    let number = |name: &str| fact[name].as_u64().unwrap_or(0) as u32;
    let first = number("first_segment");
    first..first + number("segments")
}
