//! Plans steps again from the results of the run, on another thread while the steps in between are performed.

use super::ending::Ending;
use super::session::{Session, panic_text};
use crate::catalogue::{Learnt, procedure};
use crate::continuing::joined;
use crate::plan::{BenchFacts, Lesson, Step};
use crate::profile::Profile;
use jointbench_instrument::{RunTable, TableFault, Trace};
use std::borrow::Cow;
use std::thread::JoinHandle;

/// Polling period while the shaft waits for the planning.
const LOOK_EVERY_S: f64 = 0.1;

#[derive(Default)]
pub(super) struct Learning {
    /// Rows that the planning uses.
    rows: Trace,
    begun: Option<JoinHandle<Result<Learnt, String>>>,
    /// `None` if the steps are omitted.
    steps: Option<Vec<Step>>,
}

impl Learning {
    pub fn set_columns(&mut self, empty: Trace) {
        self.rows = empty;
    }

    /// A step that was repeated after a pause has a number above all others.
    pub fn keep(&mut self, lesson: Option<&Lesson>, segment: u32, row: &[f64]) {
        if lesson.is_some_and(|lesson| segment >= lesson.from.start) && self.begun.is_none() && self.steps.is_none() {
            self.rows.push_row(row);
        }
    }
}

impl Session<'_> {
    /// The final version of a step. `None`: it is omitted.
    pub(super) fn learnt<'s>(&mut self, index: usize, step: &'s Step) -> Result<Option<Cow<'s, Step>>, Ending> {
        let plan = self.plan;
        let Some(lesson) = &plan.lesson else { return Ok(Some(Cow::Borrowed(step))) };
        let comes = plan.steps[index..].iter().any(|step| lesson.from.contains(&step.segment));
        if !comes && self.learning.begun.is_none() && self.learning.steps.is_none() {
            self.learning.begun = Some(self.begin_to_learn(lesson));
        }
        if !lesson.to.contains(&step.segment) {
            return Ok(Some(Cow::Borrowed(step)));
        }
        if let Some(begun) = self.learning.begun.take() {
            while !begun.is_finished() {
                self.drive(&Profile::from(0.0).hold(LOOK_EVERY_S), &Profile::constant(self.commanded.brake_a))?;
            }
            let learnt = begun.join().unwrap_or_else(|panic| Err(panic_text(&*panic)));
            let (said, steps) = match learnt {
                Ok(learnt) => (learnt.said, learnt.steps),
                Err(why) => (format!("Part not performed: {why}"), Vec::new()),
            };
            self.note(said);
            self.learning.steps = Some(steps);
        }
        let known = self.learning.steps.iter().flatten();
        Ok(known.clone().find(|known| known.segment == step.segment).map(|known| Cow::Owned(known.clone())))
    }

    fn begin_to_learn(&mut self, lesson: &Lesson) -> JoinHandle<Result<Learnt, String>> {
        let (bench, rows, lesson) = (BenchFacts::of(self.bench), self.learning.rows.take(), lesson.clone());
        let (id, meta) = (self.plan.procedure, self.plan.meta.clone());
        std::thread::spawn(move || {
            let run = measured(RunTable::new(meta, rows), &lesson).map_err(|fault| fault.to_string())?;
            procedure(id).ok_or("unknown procedure")?.learn(&run, &bench)
        })
    }
}

/// The measurements of this run and of the one that it continues.
fn measured(now: Result<RunTable, TableFault>, lesson: &Lesson) -> Result<RunTable, TableFault> {
    match (&lesson.earlier, now) {
        (None, now) => now,
        (Some(earlier), Err(TableFault::Empty)) => Ok(earlier.0.clone()),
        (Some(earlier), now) => joined(&earlier.0, &earlier.1, &now?, 0.0),
    }
}
