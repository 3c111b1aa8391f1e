//! Plans steps again from the results of the run, on another thread while the steps in between are performed.

use super::ending::Ending;
use super::session::{Session, panic_text};
use crate::bench_facts::BenchFacts;
use crate::catalogue::{PlannedSteps, procedure};
use crate::deferred_plan::DeferredPlan;
use crate::plan::Step;
use crate::profile::Profile;
use crate::resume::joined;
use jointbench_instrument::{RunTable, TableFault};
use std::borrow::Cow;
use std::thread::JoinHandle;

/// Polling period while the shaft waits for the planning.
const POLL_S: f64 = 0.1;

impl Session<'_> {
    /// The final version of a step. `None`: it is omitted.
    pub(super) fn planned_step<'s>(&mut self, index: usize, step: &'s Step) -> Result<Option<Cow<'s, Step>>, Ending> {
        let plan = self.plan;
        let Some(deferred) = &plan.deferred else { return Ok(Some(Cow::Borrowed(step))) };
        let is_pending = plan.steps[index..].iter().any(|step| deferred.from.contains(&step.segment));
        if !is_pending && self.deferred.planning.is_none() && self.deferred.steps.is_none() {
            self.deferred.planning = Some(self.start_planning(deferred));
        }
        if !deferred.to.contains(&step.segment) {
            return Ok(Some(Cow::Borrowed(step)));
        }
        if let Some(planning) = self.deferred.planning.take() {
            while !planning.is_finished() {
                self.drive(&Profile::from(0.0).hold(POLL_S), &Profile::constant(self.commanded.brake_a))?;
            }
            let planned = planning.join().unwrap_or_else(|panic| Err(panic_text(&*panic)));
            let (message, steps) = match planned {
                Ok(planned) => (planned.message, planned.steps),
                Err(why) => (format!("Part not performed: {why}"), Vec::new()),
            };
            self.note(message);
            self.deferred.steps = Some(steps);
        }
        let known = self.deferred.steps.iter().flatten();
        Ok(known.clone().find(|known| known.segment == step.segment).map(|known| Cow::Owned(known.clone())))
    }

    fn start_planning(&mut self, deferred: &DeferredPlan) -> JoinHandle<Result<PlannedSteps, String>> {
        let (bench, rows, deferred) = (BenchFacts::of(self.bench), self.deferred.rows.take(), deferred.clone());
        let (id, meta) = (self.plan.procedure.clone(), self.plan.meta.clone());
        std::thread::spawn(move || {
            let run = measured(RunTable::new(meta, rows), &deferred).map_err(|fault| fault.to_string())?;
            procedure(&id).ok_or("unknown procedure")?.plan_deferred(&run, &bench)
        })
    }
}

/// The measurements of this run and of the one that it continues.
fn measured(now: Result<RunTable, TableFault>, deferred: &DeferredPlan) -> Result<RunTable, TableFault> {
    match (&deferred.earlier, now) {
        (None, now) => now,
        (Some(earlier), Err(TableFault::Empty)) => Ok(earlier.0.clone()),
        (Some(earlier), now) => joined(&earlier.0, &earlier.1, &now?, 0.0),
    }
}
