//! The steps of an autopilot: measure, diagnose, then add a missing effect or make the recommended run, and repeat.
//!
//! Every run uses [`Lab::start_run`], so plan, limits and guard apply. After a further run the model restarts from the
//! given effects: effects that were added with less data must prove significant again.

use super::computation::with_retries;
use super::{Answer, Lab, LabError};
use crate::view::{
    AutopilotAction, AutopilotState, AutopilotStep, Experiment, Finding, LiveMessage, Model, NewAutopilot, NewModel,
    NewRun, Run, RunState, Suggestion, reread, word,
};
use jointbench_instrument::Meta;
use jointbench_procedure::Control;
use serde_json::{Map, Value};
use tokio::sync::watch;

pub(super) enum Goal {
    /// Until no effect is missing.
    Explain(NewAutopilot),
    /// One run that separates the candidate effects of a model.
    Decide { runs: Vec<i64>, model: i64, effects: Vec<String>, experiment: Experiment },
}

pub(super) struct AutopilotTask {
    lab: Lab,
    id: i64,
    bench: String,
    stop: watch::Receiver<Option<String>>,
    /// Author of its runs and models.
    by: String,
    /// Runs that the models are fitted to.
    runs: Vec<i64>,
    made: u32,
    bench_time_s: f64,
}

/// End of an autopilot without a fault.
struct End {
    state: AutopilotState,
    reason: String,
}

impl End {
    fn new(state: AutopilotState, reason: impl Into<String>) -> Self {
        Self { state, reason: reason.into() }
    }
}

/// Completed work, or an end by a person.
enum Through<T> {
    Done(T),
    Cut(End),
}

/// Returns the value, or ends the caller.
macro_rules! through {
    ($work:expr) => {
        match $work {
            Through::Done(value) => value,
            Through::Cut(end) => return Ok(end),
        }
    };
}

impl AutopilotTask {
    pub fn new(lab: Lab, id: i64, bench: String, stop: watch::Receiver<Option<String>>, by: String) -> Self {
        Self { lab, id, bench, stop, by, runs: Vec::new(), made: 0, bench_time_s: 0.0 }
    }

    pub async fn run(mut self, goal: Goal) {
        let end = match goal {
            Goal::Explain(request) => self.explain(&request).await,
            Goal::Decide { runs, model, effects, experiment } => {
                self.runs = runs;
                self.decide(model, &effects, experiment).await
            }
        };
        let End { state, reason } = end.unwrap_or_else(|fault| End::new(AutopilotState::Failed, fault.to_string()));
        tracing::info!(autopilot.id = self.id, ?state, reason, "autopilot ended");
        if let Err(fault) = self.lab.inner.store.end_autopilot(self.id, &word(state), &reason).await {
            tracing::error!(autopilot.id = self.id, %fault, "how the autopilot ended could not be kept");
        }
        self.publish(state, Some(reason), None);
    }

    async fn decide(&mut self, model: i64, effects: &[String], experiment: Experiment) -> Answer<End> {
        through!(self.measure(&experiment).await?);
        let (_, found) = self.fit(effects, Some(model)).await?;
        Ok(End::new(AutopilotState::Finished, found.summary))
    }

    async fn explain(&mut self, request: &NewAutopilot) -> Answer<End> {
        let mut next = Experiment {
            procedure: request.procedure.clone(),
            parameters: request.parameters.clone(),
            why: "initial run".into(),
            expected_z: None,
            expected_duration_s: None,
            separates: Vec::new(),
        };
        let mut root = None;
        let mut given = request.from_run;
        loop {
            let run = match given.take() {
                Some(run) => self.begin_with(run).await?,
                None => through!(self.measure(&next).await?),
            };
            let effects = match &request.effects {
                Some(effects) => effects.clone(),
                None => baseline(&run)?,
            };
            let (model, found) = self.fit(&effects, root).await?;
            root = Some(model.id);
            let found = through!(self.add_missing_effects(request, model, found).await?);
            match found.experiment {
                Some(experiment) if self.can_afford(request, &experiment) => next = experiment,
                Some(experiment) => {
                    let reason = format!(
                        "{} Recommended run not performed (budget): {} ({})",
                        found.summary, experiment.procedure, experiment.why
                    );
                    return Ok(End::new(AutopilotState::BudgetSpent, reason));
                }
                None => return Ok(End::new(AutopilotState::Finished, found.summary)),
            }
        }
    }

    /// Adds the best effect repeatedly until none is missing or a run can separate the candidate effects.
    async fn add_missing_effects(
        &mut self,
        request: &NewAutopilot,
        mut model: Model,
        mut found: Finding,
    ) -> Answer<Through<Finding>> {
        for _ in 0..request.max_effects {
            let Some(best) = found.suggestions.first() else { break };
            // A diagnosis with data problems is no basis for effects.
            if found.undecided.is_some() {
                break;
            }
            let decidable = found
                .experiment
                .as_ref()
                .is_some_and(|e| e.separates.contains(&best.effect) && self.can_afford(request, e));
            if !best.confounded_with.is_empty() && decidable {
                break;
            }
            if let Some(end) = self.is_stopped() {
                return Ok(Through::Cut(end));
            }
            (model, found) = self.add(&model, &best.clone()).await?;
        }
        Ok(Through::Done(found))
    }

    fn can_afford(&self, request: &NewAutopilot, experiment: &Experiment) -> bool {
        let left_s = request.bench_time_s.map_or(f64::INFINITY, |budget_s| budget_s - self.bench_time_s);
        self.made < request.runs && experiment.expected_duration_s.unwrap_or(0.0) <= left_s
    }

    /// Begins with an existing run.
    async fn begin_with(&mut self, id: i64) -> Answer<Run> {
        self.runs.push(id);
        self.lab.run(id).await
    }

    /// Starts a run and waits for its end.
    async fn measure(&mut self, experiment: &Experiment) -> Answer<Through<Run>> {
        if let Some(end) = self.is_stopped() {
            return Ok(Through::Cut(end));
        }
        let handle = self.lab.handle(&self.bench)?.clone();
        let new = NewRun {
            bench: self.bench.clone(),
            procedure: experiment.procedure.clone(),
            parameters: experiment.parameters.clone(),
            ..NewRun::default()
        };
        let run = self.lab.start_run(&new, &self.by).await?;
        let id = run.summary.id;
        self.made += 1;
        let step = AutopilotStep::new(
            AutopilotAction::Measure,
            format!("run {id}: {}, {}", experiment.procedure, experiment.why),
        );
        self.keep(AutopilotStep { run: Some(id), experiment: Some(experiment.clone()), ..step }).await?;

        let cut = tokio::select! {
            () = handle.until_free() => None,
            by = self.stop.wait_for(Option::is_some) => by.ok().and_then(|by| by.clone()),
        };
        if let Some(by) = cut {
            // The run may have ended in the meantime.
            let _ = self.lab.control(id, Control::Stop, &by).await;
            handle.until_free().await;
        }
        let run = self.lab.run(id).await?;
        let summary = &run.summary;
        let duration_s = summary.duration_s.unwrap_or(0.0);
        self.bench_time_s += duration_s;
        let text = format!("run {id} {}: {} rows in {duration_s:.0} s of bench time", summary.state, summary.rows);
        let step = AutopilotStep::new(AutopilotAction::Measured, text.clone());
        self.keep(AutopilotStep { run: Some(id), bench_time_s: Some(duration_s), ..step }).await?;
        if let Some(end) = self.is_stopped() {
            return Ok(Through::Cut(end));
        }
        match summary.state {
            RunState::Completed => {
                self.runs.push(id);
                Ok(Through::Done(run))
            }
            RunState::Stopped | RunState::Aborted => Ok(Through::Cut(End::new(
                AutopilotState::Stopped,
                format!("run {id} was {} by the operator", summary.state),
            ))),
            _ => Err(LabError::Bench(match &summary.reason {
                Some(reason) => format!("{text}: {reason}"),
                None => text,
            })),
        }
    }

    async fn fit(&mut self, effects: &[String], parent: Option<i64>) -> Answer<(Model, Finding)> {
        let before_rms = match parent {
            Some(parent) => Some(self.lab.model(parent).await?.validation_rms),
            None => None,
        };
        let fit = || self.lab.create_model(NewModel::free(&self.runs, effects, parent), &self.by);
        let model = with_retries(fit).await?;
        let step = AutopilotStep { before_rms, ..AutopilotStep::new(AutopilotAction::Fit, "") };
        let found = self.diagnosed(&model, step).await?;
        Ok((model, found))
    }

    async fn add(&mut self, before: &Model, best: &Suggestion) -> Answer<(Model, Finding)> {
        let effects: Vec<String> = before.effects.iter().cloned().chain([best.effect.clone()]).collect();
        let fit = || self.lab.create_model(NewModel::free(&self.runs, &effects, Some(before.id)), &self.by);
        let model = with_retries(fit).await?;
        let tied = match best.confounded_with.as_slice() {
            [] => String::new(),
            rivals => format!(" (confounded with {})", rivals.join(", ")),
        };
        let step = AutopilotStep::new(AutopilotAction::Add, format!("added {}{tied}. ", best.effect));
        let step = AutopilotStep { effect: Some(best.effect.clone()), before_rms: Some(before.validation_rms), ..step };
        let found = self.diagnosed(&model, step).await?;
        Ok((model, found))
    }

    /// Stores a step about a model with the summary of its diagnosis.
    async fn diagnosed(&mut self, model: &Model, step: AutopilotStep) -> Answer<Finding> {
        let kept = with_retries(|| self.lab.diagnose(model.id)).await?;
        let step = AutopilotStep {
            text: step.text.clone() + &kept.finding.summary,
            model: Some(model.id),
            diagnosis: Some(kept.id),
            verdict: Some(kept.finding.verdict),
            experiment: kept.finding.experiment.clone(),
            after_rms: Some(model.validation_rms),
            ..step
        };
        self.keep(step).await?;
        Ok(kept.finding)
    }

    fn is_stopped(&self) -> Option<End> {
        let by = self.stop.borrow().clone()?;
        Some(End::new(AutopilotState::Stopped, format!("stopped by the operator ({by})")))
    }

    async fn keep(&self, step: AutopilotStep) -> Answer<()> {
        let kept = self.lab.inner.store.append_autopilot_step(self.id, reread(&step)?).await?;
        self.publish(AutopilotState::Running, None, Some(reread(&kept)?));
        Ok(())
    }

    fn publish(&self, state: AutopilotState, reason: Option<String>, step: Option<Box<AutopilotStep>>) {
        let bench = self.bench.clone();
        self.lab.hub().publish(LiveMessage::Autopilot { autopilot: self.id, bench, state, reason, step });
    }
}

/// The initial effects from the metadata of the run.
fn baseline(run: &Run) -> Answer<Vec<String>> {
    let meta: Meta = reread::<Map<String, Value>, _>(&run.meta)?;
    Ok(meta.baseline)
}
