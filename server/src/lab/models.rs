//! Effects, model versions and diagnoses.

use super::blocking::blocking;
use super::computation::{Turn, json, parsed};
use super::exclusions;
use super::{Answer, Lab, LabError, Offer, next_run};
use crate::job::Job;
use crate::store::{ModelRecord, NewModel, Subject, packed, unpacked};
use crate::view::{
    self, Diagnosis, Effect, EffectDefinition, Exclusion, LiveMessage, Model, ParameterSetting, ResidualSet,
    diagnosis_view, finite, model_view, reread, residual_set, word,
};
use jointbench_instrument::{Kind, RunTable};
use jointbench_model::{Fit, ModelError, ModelSpec, Open, Options, UserEffect};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Cache key of the residuals of a version.
const RESIDUALS: &str = "residuals";

/// Result of a fit, to be stored. The packed residuals follow, if any.
#[derive(Debug, Serialize, Deserialize)]
struct Fitted {
    fit: Fit,
    diagnosis: Option<Value>,
    noise_floor_rms: Option<f64>,
}

/// A version with this fit, without parent, exclusions and further runs.
pub(super) fn version(run: i64, fit: &Fit, by: &str) -> Answer<NewModel> {
    Ok(NewModel {
        run,
        more_runs: Vec::new(),
        excluded: Value::Array(Vec::new()),
        parent: None,
        kind: fit.kind.to_string(),
        effects: fit.effects.clone(),
        residual: word(fit.residual),
        rms: fit.rms,
        validation_rms: fit.validation_rms,
        noise_floor_rms: None,
        options: reread(&Options::default())?,
        tried: false,
        fit: reread(fit)?,
        by: by.to_owned(),
    })
}

impl Lab {
    /// Fits effects to runs of one joint together and stores the fit, with its diagnosis, as a version of the first
    /// run. The default exclusions are those of the parent.
    pub async fn create_model(&self, asked: view::NewModel, by: &str) -> Answer<Model> {
        let (run, runs, parent, effects) = (asked.run, asked.runs(), asked.parent, asked.effects);
        let more_runs = asked.more_runs.as_slice();
        let excluded = self.exclusions(run, parent, asked.exclude).await?;
        let spec = self.spec(self.kind_of_ended(&runs).await?, &effects, Some(run)).await?;
        let settings = self.settings(parent, &effects, asked.parameters).await?;
        let spec = spec.with_settings(settings.clone())?;
        let _turn = match parent {
            None => Some(self.inner.turns.of(Turn::First(run)).await),
            Some(_) => None,
        };
        if parent.is_none()
            && let Some(there) = self.first_version(run, more_runs, &spec, &excluded).await?
        {
            return Ok(model_view(there)?);
        }
        let offer = self.offer(&runs, None).await?;
        let job = Job::Fit { runs, effects, excluded: excluded.clone(), settings, offer };
        let answer = self.compute_json(job).await?;
        let end = answer.iter().position(|byte| *byte == b'\n').unwrap_or(answer.len());
        let (fitted, residuals) = (parsed::<Fitted>(&answer[..end])?, answer.get(end + 1..).unwrap_or_default());
        let Fitted { fit, diagnosis, noise_floor_rms } = fitted;
        let new = NewModel {
            more_runs: more_runs.to_vec(),
            excluded: reread(&excluded)?,
            parent,
            noise_floor_rms,
            tried: asked.tried,
            ..version(run, &fit, by)?
        };
        // A version is valid without residuals; a request for them returns the reason.
        let residuals = Some((RESIDUALS, residuals)).filter(|(_, packed)| !packed.is_empty());
        let record = self.inner.store.save_fitted(&new, residuals, diagnosis.as_ref()).await?;
        tracing::info!(
            run.id = run,
            model.id = record.id,
            validation_rms = record.validation_rms,
            effects = record.effects.join(","),
            "model fitted"
        );
        self.hub().publish(LiveMessage::Model { run, model: record.id });
        Ok(model_view(record)?)
    }

    /// What a new version leaves out: the given exclusions, otherwise those of its parent.
    async fn exclusions(&self, run: i64, parent: Option<i64>, given: Option<Vec<Exclusion>>) -> Answer<Vec<Exclusion>> {
        let mut excluded = given;
        if let Some(parent) = parent {
            let before = self.inner.store.model(parent).await?;
            if before.run != run {
                return Err(LabError::Invalid(format!("model version {parent} belongs to another run than {run}")));
            }
            excluded = Some(excluded.map_or_else(|| reread(&before.excluded), Ok)?);
        }
        let excluded = excluded.unwrap_or_default();
        exclusions::check(&excluded)?;
        Ok(excluded)
    }

    /// Kind of the first run, if all of them have ended.
    async fn kind_of_ended(&self, runs: &[i64]) -> Answer<Kind> {
        let mut kind = None;
        for run in runs {
            let record = self.inner.store.run(*run).await?;
            if !record.state.is_final() {
                return Err(LabError::Conflict(format!("run {run} is still in progress: fit a model after its end")));
            }
            kind.get_or_insert(record.kind);
        }
        find_kind(&kind.unwrap_or_default())
    }

    /// Fits and diagnoses: [`Fitted`] as one line, then the packed residuals.
    pub(super) async fn fit_here(
        &self,
        runs: &[i64],
        effects: &[String],
        excluded: &[Exclusion],
        settings: &[ParameterSetting],
        offer: Option<Offer>,
    ) -> Answer<Vec<u8>> {
        let whole = self.tables(runs).await?;
        let table = exclusions::without(whole.clone(), excluded)?;
        let spec = self.spec(table.kind(), effects, runs.first().copied()).await?;
        let spec = spec.with_settings(settings.to_vec())?;
        let offer = offer.unwrap_or_else(|| Offer::shown_by(&table));
        let options = Options::default();
        let (fit, diagnosis, left) = blocking(move || {
            let (fit, diagnosis) = fit_and_diagnose(&table, &spec, &options, &offer)?;
            let left = jointbench_model::residuals(&whole, &fit, &options).ok();
            Ok((fit, diagnosis, left))
        })
        .await?;
        let noise_floor_rms = diagnosis.as_ref().and_then(|diagnosis| diagnosis.noise_floor_rms).and_then(finite);
        let diagnosis = diagnosis.as_ref().map(reread).transpose()?;
        let mut answer = json(&Fitted { fit, diagnosis, noise_floor_rms })?;
        if let Some(json) = left.and_then(|left| written(left, excluded).ok()) {
            answer.push(b'\n');
            answer.extend(packed(&json)?);
        }
        Ok(answer)
    }

    /// Keeps a version that was tried or is idle: it counts as a version of the run from now on.
    pub async fn keep_model(&self, id: i64, by: &str) -> Answer<Model> {
        let record = self.inner.store.keep_model(id, by).await?;
        self.hub().publish(LiveMessage::Model { run: record.run, model: id });
        Ok(model_view(record)?)
    }

    /// An existing version of the same effects, runs and exclusions without a parent. Pages that open a run at the same
    /// time share it, also with an autopilot.
    async fn first_version(
        &self,
        run: i64,
        more_runs: &[i64],
        spec: &ModelSpec,
        excluded: &[Exclusion],
    ) -> Answer<Option<ModelRecord>> {
        for version in self.inner.store.models(run).await?.into_iter().rev() {
            let is_alike =
                version.parent.is_none() && version.more_runs == more_runs && version.effects == spec.effects;
            if is_alike && reread::<_, Vec<Exclusion>>(&version.excluded)? == excluded {
                let fit: Fit = reread(&version.fit)?;
                if fit.settings == spec.settings
                    && fit.user_effects.iter().all(|user_effect| spec.user_effects.contains(user_effect))
                {
                    return Ok(Some(version));
                }
            }
        }
        Ok(None)
    }

    pub async fn models(&self, run: i64) -> Answer<Vec<Model>> {
        self.inner.store.models(run).await?.into_iter().map(|record| Ok(model_view(record)?)).collect()
    }

    pub async fn model(&self, id: i64) -> Answer<Model> {
        Ok(model_view(self.inner.store.model(id).await?)?)
    }

    /// The data that a version was fitted to.
    pub(super) async fn fitted_table(&self, record: &ModelRecord) -> Answer<RunTable> {
        exclusions::without(self.tables(&record.runs()).await?, &reread::<_, Vec<Exclusion>>(&record.excluded)?)
    }

    /// The residuals of the version as JSON ([`ResidualSet`]), from the cache if they are there.
    pub async fn residuals(&self, id: i64) -> Answer<Vec<u8>> {
        let subject = Subject::Model(id);
        if let Some(kept) = self.inner.store.cached_result(subject, RESIDUALS).await? {
            return Ok(kept);
        }
        let _turn = self.inner.turns.of(Turn::Residuals(id)).await;
        if let Some(kept) = self.inner.store.cached_result(subject, RESIDUALS).await? {
            return Ok(kept);
        }
        let packed = self.compute_json(Job::Residuals { model: id }).await?;
        self.inner.store.cache_packed_result(subject, RESIDUALS, &packed).await?;
        Ok(unpacked(&packed)?)
    }

    /// The residuals, packed.
    pub(super) async fn residuals_here(&self, id: i64) -> Answer<Vec<u8>> {
        let model = self.inner.store.model(id).await?;
        let fit: Fit = reread(&model.fit)?;
        let table = self.tables(&model.runs()).await?;
        let left = blocking(move || jointbench_model::residuals(&table, &fit, &Options::default())).await?;
        Ok(packed(&written(left, &reread::<_, Vec<Exclusion>>(&model.excluded)?)?)?)
    }

    /// The diagnosis of a version. Data and version never change: it is computed once, and again after a change of the
    /// users' effects that the run uses.
    pub async fn diagnose(&self, model: i64) -> Answer<Diagnosis> {
        let record = self.inner.store.model(model).await?;
        if !reread::<_, Fit>(&record.fit)?.settings.is_empty() {
            return Err(ModelError::NotDiagnosed.into());
        }
        if let Some(kept) = self.diagnosis_kept(&record).await? {
            return Ok(kept);
        }
        let _turn = self.inner.turns.of(Turn::Diagnosis(model)).await;
        if let Some(kept) = self.diagnosis_kept(&record).await? {
            return Ok(kept);
        }
        let offer = self.offer(&record.runs(), None).await?;
        let diagnosis: Value = self.compute(Job::Diagnose { model, offer }).await?;
        let kept = self.inner.store.save_diagnosis(model, &diagnosis).await?;
        Ok(diagnosis_view(kept, record.run)?)
    }

    /// The last diagnosis, if it is based on the current effects.
    async fn diagnosis_kept(&self, record: &ModelRecord) -> Answer<Option<Diagnosis>> {
        let Some(kept) = self.inner.store.diagnoses(record.id).await?.pop() else { return Ok(None) };
        let known: view::Finding = reread(&kept.diagnosis)?;
        if known.user_effects != self.user_effects_of(record).await? {
            return Ok(None);
        }
        Ok(Some(diagnosis_view(kept, record.run)?))
    }

    pub(super) async fn diagnose_here(&self, model: i64, offer: Option<Offer>) -> Answer<Value> {
        let record = self.inner.store.model(model).await?;
        let user_effects = self.user_effects_of(&record).await?;
        let table = self.fitted_table(&record).await?;
        let spec = ModelSpec::with_user_effects(table.kind(), &record.effects, user_effects)?;
        let offer = offer.unwrap_or_else(|| Offer::shown_by(&table));
        let diagnosis = blocking(move || diagnose(&table, &spec, &Options::default(), &offer)).await?;
        Ok(reread(&diagnosis)?)
    }

    /// Users' effects in their version of the fit, and the others that the run uses.
    async fn user_effects_of(&self, record: &ModelRecord) -> Answer<Vec<UserEffect>> {
        let fit: Fit = reread(&record.fit)?;
        let used = self.used_effects(fit.kind, record.run).await?;
        let mut user_effects = fit.user_effects;
        let others: Vec<UserEffect> =
            used.into_iter().filter(|one| !user_effects.iter().any(|o| o.id() == one.id())).collect();
        user_effects.extend(others);
        Ok(user_effects)
    }

    pub async fn diagnosis(&self, id: i64) -> Answer<Diagnosis> {
        let record = self.inner.store.diagnosis(id).await?;
        let run = self.inner.store.model(record.model).await?.run;
        Ok(diagnosis_view(record, run)?)
    }

    pub async fn diagnoses(&self, model: i64) -> Answer<Vec<Diagnosis>> {
        let run = self.inner.store.model(model).await?.run;
        let records = self.inner.store.diagnoses(model).await?;
        records.into_iter().map(|record| Ok(diagnosis_view(record, run)?)).collect()
    }
}

/// The residuals in the format of the API.
fn written(left: jointbench_model::ResidualSet, excluded: &[Exclusion]) -> Answer<Vec<u8>> {
    let mut set: ResidualSet = residual_set(left)?;
    if !excluded.is_empty()
        && let Some(time) = set.axes.iter().find(|axis| axis.name == "time_s")
    {
        set.excluded = exclusions::marked(&time.values, excluded);
    }
    json(&set)
}

/// The diagnosis with the recommended next run.
pub fn diagnose(
    table: &RunTable,
    spec: &ModelSpec,
    options: &Options,
    offer: &Offer,
) -> Result<jointbench_model::Diagnosis, ModelError> {
    let mut diagnosis = jointbench_model::diagnose(table, spec, options)?;
    let open = Open { user_effects: spec.user_effects.clone(), ..Open::from(&diagnosis) };
    let next = next_run(table, &open, offer, options);
    diagnosis.experiment = next.experiment;
    diagnosis.summary.extend(next.in_vain.map(|reason| format!(" {reason}")));
    Ok(diagnosis)
}

/// A run that can be fitted but not diagnosed still gets a model.
fn fit_and_diagnose(
    table: &RunTable,
    spec: &ModelSpec,
    options: &Options,
    offer: &Offer,
) -> Result<(Fit, Option<jointbench_model::Diagnosis>), ModelError> {
    match diagnose(table, spec, options, offer) {
        Ok(diagnosis) => Ok((diagnosis.fit.clone(), Some(diagnosis))),
        Err(_) => Ok((jointbench_model::fit(table, spec, options)?, None)),
    }
}

pub(super) fn find_kind(name: &str) -> Answer<Kind> {
    Kind::ALL
        .into_iter()
        .find(|kind| kind.name() == name)
        .ok_or_else(|| LabError::Invalid(format!("kind {name:?}: write friction, encoder, stiffness or brake")))
}

pub(super) fn effect_view(info: &jointbench_model::EffectInfo, definition: Option<EffectDefinition>) -> Effect {
    let symbol = |name: &str| if definition.is_some() { name.to_owned() } else { view::parameter_symbol(name) };
    Effect {
        id: info.id.to_owned(),
        kind: info.kind.to_string(),
        title: info.title.to_owned(),
        sentence: info.sentence.to_owned(),
        formula: info.formula.to_owned(),
        source: info.source.to_owned(),
        looks: info.looks.to_owned(),
        parameters: info
            .parameters
            .iter()
            .map(|parameter| view::EffectParameter {
                name: parameter.name.to_string(),
                symbol: symbol(&parameter.name),
                unit: parameter.unit.to_string(),
                // An infinite bound is omitted.
                min: finite(parameter.min),
                max: finite(parameter.max),
            })
            .collect(),
        needs: info.needs.iter().map(|need| (*need).to_owned()).collect(),
        definition,
        version: None,
        runs: Vec::new(),
    }
}
