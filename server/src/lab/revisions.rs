//! Model versions: comparison, evaluation on other runs, export and import.

use super::blocking::blocking;
use super::computation::Turn;
use super::models::version;
use super::{Answer, Lab, LabError};
use crate::job::Job;
use crate::store::{NewModel, Subject};
use crate::view::{
    Comparison, Evaluation, ImportedModel, LiveMessage, ModelImport, Worth, finite, model_view, reread, word,
};
use jointbench_model::export::{Format, ModelFile, export};
use jointbench_model::{Fit, ModelSpec, Options, UserEffect};

/// Cache key.
const WORTH: &str = "worth";

impl Lab {
    /// `run`: the run for the evaluation; default: the run of the first version.
    pub async fn compare(&self, first: i64, second: i64, run: Option<i64>) -> Answer<Comparison> {
        let run = match run {
            Some(run) => run,
            None => self.inner.store.model(first).await?.run,
        };
        self.compute(Job::CompareModels { first, second, run }).await
    }

    pub(super) async fn compare_here(&self, first: i64, second: i64, run: i64) -> Answer<Comparison> {
        let (first, second) = (self.fit(first).await?, self.fit(second).await?);
        let table = self.measurement(run).await?;
        blocking(move || jointbench_model::compare(&first, &second, &table)).await
    }

    /// The validation error without each effect in turn; the order of addition has no influence. Cached, and computed
    /// once for simultaneous requests.
    pub async fn worth(&self, model: i64) -> Answer<Vec<Worth>> {
        let _turn = self.inner.turns.of(Turn::Worth(model)).await;
        if let Some(kept) = self.cached(Subject::Model(model), WORTH).await? {
            return Ok(kept);
        }
        let worth: Vec<Worth> = self.compute(Job::Worth { model }).await?;
        self.cache(Subject::Model(model), WORTH, &worth).await?;
        Ok(worth)
    }

    pub(super) async fn worth_here(&self, model: i64) -> Answer<Vec<Worth>> {
        let record = self.inner.store.model(model).await?;
        let fit: Fit = reread(&record.fit)?;
        let table = self.fitted_table(&record).await?;
        let refit = move |effect: &str| {
            let others = record.effects.iter().filter(|one| *one != effect);
            let spec = ModelSpec::with_user_effects(table.kind(), others, fit.user_effects.clone())?;
            let settings = fit.settings.iter().filter(|setting| setting.effect != effect).cloned().collect();
            let spec = spec.with_settings(settings)?;
            jointbench_model::fit(&table, &spec, &Options::default())
        };
        let effects = fit.effects.clone();
        let worth = move |effect: String| {
            let (without_rms, reason) = match refit(&effect) {
                Ok(fit) => (finite(fit.validation_rms), None),
                Err(fault) => (None, Some(fault.to_string())),
            };
            Worth { effect, without_rms, reason }
        };
        blocking(move || Ok(effects.into_iter().map(worth).collect())).await
    }

    /// Change of the prediction at each point of the residuals if an effect is added and the model is fitted again.
    /// Cached, except for users' effects, whose formula may change.
    pub async fn with_effect(&self, model: i64, effect: String) -> Answer<Vec<f64>> {
        let kept_as = format!("with {effect}");
        if let Some(kept) = self.cached(Subject::Model(model), &kept_as).await? {
            return Ok(kept);
        }
        let record = self.inner.store.model(model).await?;
        let changes =
            self.user_effects_with(&reread(&record.fit)?, &effect).await?.iter().any(|one| one.id() == effect);
        let added: Vec<f64> = self.compute(Job::WithEffect { model, effect }).await?;
        if !changes {
            self.cache(Subject::Model(model), &kept_as, &added).await?;
        }
        Ok(added)
    }

    /// Users' effects of a fit, and the requested effect if a user wrote it.
    async fn user_effects_with(&self, fit: &Fit, effect: &str) -> Answer<Vec<UserEffect>> {
        let mut user_effects = fit.user_effects.clone();
        let theirs = self.user_effects(fit.kind).await?;
        user_effects.extend(
            theirs.into_iter().filter(|one| one.id() == effect && !fit.user_effects.iter().any(|o| o.id() == effect)),
        );
        Ok(user_effects)
    }

    pub(super) async fn with_effect_here(&self, model: i64, effect: &str) -> Answer<Vec<f64>> {
        let record = self.inner.store.model(model).await?;
        let before: Fit = reread(&record.fit)?;
        let whole = self.tables(&record.runs()).await?;
        let fitted = self.fitted_table(&record).await?;
        let user_effects = self.user_effects_with(&before, effect).await?;
        let effects = record.effects.iter().map(String::as_str).chain([effect]);
        let spec =
            ModelSpec::with_user_effects(before.kind, effects, user_effects)?.with_settings(before.settings.clone())?;
        blocking(move || {
            let options = Options::default();
            let after = jointbench_model::fit(&fitted, &spec, &options)?;
            let [before, after] = [before, after].map(|fit| jointbench_model::residuals(&whole, &fit, &options));
            Ok(after?.predicted.iter().zip(before?.predicted).map(|(after, before)| after - before).collect())
        })
        .await
    }

    pub async fn evaluate(&self, model: i64, run: i64) -> Answer<Evaluation> {
        self.compute(Job::Evaluate { model, run }).await
    }

    pub(super) async fn evaluate_here(&self, model: i64, run: i64) -> Answer<Evaluation> {
        let fit = self.fit(model).await?;
        let table = self.measurement(run).await?;
        blocking(move || jointbench_model::evaluate(&fit, &table)).await
    }

    /// The exported model and the run that it was fitted to.
    pub async fn export_model(&self, model: i64, format: Format) -> Answer<(i64, String)> {
        let record = self.inner.store.model(model).await?;
        Ok((record.run, export(&reread(&record.fit)?, format)?))
    }

    /// Stores an exported model as a version of a run. Its parameters remain; its errors are computed on the run.
    pub async fn import_model(&self, import: ModelImport, by: &str) -> Answer<ImportedModel> {
        let file: serde_json::Value = import.model.into();
        let kept = exported(file.clone())?;
        let (run, kind) = (import.run, self.inner.store.run(import.run).await?.kind);
        if kept.kind.name() != kind.as_str() {
            return Err(LabError::Invalid(format!(
                "the model is of kind {}, run {run} of kind {kind}: choose a run of the same kind as the model \
                 (jointbench runs kind:{})",
                kept.kind, kept.kind
            )));
        }
        let held: Evaluation = self.compute(Job::EvaluateFile { file, run }).await?;
        self.import_effects(&kept.user_effects, run, by).await?;
        let new = NewModel {
            residual: word(held.residual),
            rms: held.rms,
            validation_rms: held.rms,
            ..version(import.run, &kept, by)?
        };
        let record = self.inner.store.save_model(&new).await?;
        tracing::info!(run.id = import.run, model.id = record.id, "model imported");
        self.hub().publish(LiveMessage::Model { run: import.run, model: record.id });
        Ok(ImportedModel { model: model_view(record)?, notes: held.notes })
    }

    pub(super) async fn evaluate_file_here(&self, file: serde_json::Value, run: i64) -> Answer<Evaluation> {
        let fit = exported(file)?;
        let table = self.measurement(run).await?;
        let held = blocking(move || jointbench_model::evaluate(&fit, &table)).await?;
        if !held.rms.is_finite() {
            let why = "predictions of this model on the run are not finite: check its parameters";
            return Err(LabError::Invalid(why.to_owned()));
        }
        Ok(held)
    }

    async fn fit(&self, model: i64) -> Answer<Fit> {
        Ok(reread(&self.inner.store.model(model).await?.fit)?)
    }
}

fn exported(file: serde_json::Value) -> Answer<Fit> {
    let file: ModelFile =
        serde_json::from_value(file).map_err(|fault| LabError::Invalid(format!("not an exported model: {fault}")))?;
    Ok(file.check()?)
}
