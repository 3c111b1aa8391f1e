//! Steps that are planned anew from what the run has measured, on another thread while the steps in between are made.

use super::ending::Ending;
use super::session::{Session, panic_text};
use crate::catalogue::{Learnt, procedure};
use crate::continuing::joined;
use crate::plan::{BenchFacts, Lesson, Step};
use crate::profile::Profile;
use jointbench_instrument::{RunTable, TableFault, Trace};
use std::borrow::Cow;
use std::thread::JoinHandle;

/// The shaft stands for so long between two looks whether the planning is done.
const LOOK_EVERY_S: f64 = 0.1;

#[derive(Default)]
pub(super) struct Learning {
    /// What is learnt from.
    rows: Trace,
    begun: Option<JoinHandle<Result<Learnt, String>>>,
    /// None where they are left out.
    steps: Option<Vec<Step>>,
}

impl Learning {
    pub fn set_columns(&mut self, empty: Trace) {
        self.rows = empty;
    }

    /// A step that was made again after a pause has a number behind all others.
    pub fn keep(&mut self, lesson: Option<&Lesson>, segment: u32, row: &[f64]) {
        if lesson.is_some_and(|lesson| segment >= lesson.from.start) && self.begun.is_none() && self.steps.is_none() {
            self.rows.push_row(row);
        }
    }
}

impl Session<'_> {
    /// The step as it is to be made. `None`: it is left out.
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

/// What this run and the one before it have measured together.
fn measured(now: Result<RunTable, TableFault>, lesson: &Lesson) -> Result<RunTable, TableFault> {
    match (&lesson.earlier, now) {
        (None, now) => now,
        (Some(earlier), Err(TableFault::Empty)) => Ok(earlier.0.clone()),
        (Some(earlier), now) => joined(&earlier.0, &earlier.1, &now?, 0.0),
    }
}
