//! Model versions, a tree that only grows, and the diagnoses of the versions.

use super::runs::exists;
use super::seal::{DIAGNOSES, MODELS, intact_records};
use super::values::{json, now};
use super::{DiagnosisRecord, ModelRecord, NewModel, Store, StoreError, Subject, VersionRecord, result_cache};
use jointbench_procedure::RunId;
use serde_json::Value;
use sqlx::sqlite::SqliteRow;
use sqlx::{Row, SqliteConnection};

fn record(row: &SqliteRow) -> Result<ModelRecord, StoreError> {
    MODELS.check(row)?;
    Ok(ModelRecord {
        id: row.try_get("id")?,
        run: row.try_get("run")?,
        more_runs: json(row, "more_runs")?,
        excluded: json(row, "excluded")?,
        parent: row.try_get("parent")?,
        kind: row.try_get("kind")?,
        effects: json(row, "effects")?,
        added: json(row, "added")?,
        removed: json(row, "removed")?,
        fit: json(row, "fit")?,
        residual: row.try_get("residual")?,
        rms: row.try_get("rms")?,
        validation_rms: row.try_get("validation_rms")?,
        noise_floor_rms: row.try_get("noise_floor_rms")?,
        idle: row.try_get("idle")?,
        tried: row.try_get("tried")?,
        options: json(row, "options")?,
        by: row.try_get("who")?,
        created_at: row.try_get("created_at")?,
    })
}

impl Store {
    /// Stores a fit as a version. Added and removed effects follow from the effects of the parent.
    pub async fn save_model(&self, new: &NewModel) -> Result<ModelRecord, StoreError> {
        self.save_fitted(new, None, None).await
    }

    /// The same together with a packed result under its name and the diagnosis, in one transaction.
    pub async fn save_fitted(
        &self,
        new: &NewModel,
        kept: Option<(&str, &[u8])>,
        diagnosis: Option<&Value>,
    ) -> Result<ModelRecord, StoreError> {
        let before = self.effects_before(new).await?;
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        let id = insert_model(&mut writer, new, &before).await?;
        if let Some((what, packed)) = kept {
            result_cache::insert(&mut writer, Subject::Model(id), what, packed).await?;
        }
        if let Some(diagnosis) = diagnosis {
            insert_diagnosis(&mut writer, id, diagnosis, &now()).await?;
        }
        writer.commit().await?;
        self.model(id).await
    }

    /// The effects of the parent; empty without a parent.
    async fn effects_before(&self, new: &NewModel) -> Result<Vec<String>, StoreError> {
        for run in std::iter::once(new.run).chain(new.more_runs.iter().copied()) {
            exists(&mut *self.readers.acquire().await?, run).await?;
        }
        let parent = match new.parent {
            Some(parent) => self.model(parent).await?,
            None => return Ok(Vec::new()),
        };
        if parent.run != new.run {
            return Err(StoreError::OtherRun { parent: parent.id, run: new.run });
        }
        Ok(parent.effects)
    }

    /// Keeps a version that was tried or is idle: it counts as a version of the run from now on.
    pub async fn keep_model(&self, id: i64, by: &str) -> Result<ModelRecord, StoreError> {
        self.model(id).await?;
        let keep = sqlx::query("INSERT OR IGNORE INTO models_kept (model, who, created_at) VALUES (?, ?, ?)");
        keep.bind(id).bind(by).bind(now()).execute(&self.writer).await?;
        self.model(id).await
    }

    pub async fn model(&self, id: i64) -> Result<ModelRecord, StoreError> {
        let row = sqlx::query("SELECT * FROM models_told WHERE id = ?").bind(id).fetch_optional(&self.readers).await?;
        record(&row.ok_or(StoreError::NoModel(id))?)
    }

    /// The last version of a kind that was fitted to another run of a bench, without idle and tried versions.
    pub async fn last_model(&self, bench: &str, kind: &str, but: RunId) -> Result<Option<ModelRecord>, StoreError> {
        let asked = "SELECT model.* FROM models_told AS model JOIN runs ON runs.id = model.run \
            WHERE runs.bench = ? AND model.kind = ? AND model.run <> ? AND NOT idle AND NOT tried ORDER BY model.id DESC LIMIT 1";
        let row = sqlx::query(asked).bind(bench).bind(kind).bind(but).fetch_optional(&self.readers).await?;
        row.as_ref().map(record).transpose()
    }

    /// All versions of a run, oldest first: parents before their children. A damaged one is omitted and logged.
    pub async fn models(&self, run: RunId) -> Result<Vec<ModelRecord>, StoreError> {
        exists(&mut *self.readers.acquire().await?, run).await?;
        let rows = sqlx::query("SELECT * FROM models_told WHERE run = ? ORDER BY id")
            .bind(run)
            .fetch_all(&self.readers)
            .await?;
        Ok(intact_records(&rows, record))
    }

    /// The changes in the versions of a run, oldest first, without their fits.
    pub async fn versions(&self, run: RunId) -> Result<Vec<VersionRecord>, StoreError> {
        let query = "SELECT * FROM models WHERE run = ? ORDER BY id";
        let rows = sqlx::query(query).bind(run).fetch_all(&self.readers).await?;
        let version = |row: &SqliteRow| {
            MODELS.check(row)?;
            Ok(VersionRecord {
                id: row.try_get("id")?,
                parent: row.try_get("parent")?,
                added: json(row, "added")?,
                removed: json(row, "removed")?,
                by: row.try_get("who")?,
                created_at: row.try_get("created_at")?,
            })
        };
        Ok(intact_records(&rows, version))
    }

    pub async fn save_diagnosis(&self, model: i64, diagnosis: &Value) -> Result<DiagnosisRecord, StoreError> {
        self.model(model).await?;
        let created_at = now();
        let id = insert_diagnosis(&mut *self.writer.acquire().await?, model, diagnosis, &created_at).await?;
        Ok(DiagnosisRecord { id, model, diagnosis: diagnosis.clone(), created_at })
    }

    pub async fn diagnosis(&self, id: i64) -> Result<DiagnosisRecord, StoreError> {
        let row = sqlx::query("SELECT * FROM diagnoses WHERE id = ?").bind(id).fetch_optional(&self.readers).await?;
        diagnosis_record(&row.ok_or(StoreError::NoDiagnosis(id))?)
    }

    /// The diagnoses of a model version, oldest first. A damaged one is omitted and logged.
    pub async fn diagnoses(&self, model: i64) -> Result<Vec<DiagnosisRecord>, StoreError> {
        self.model(model).await?;
        let rows = sqlx::query("SELECT * FROM diagnoses WHERE model = ? ORDER BY id")
            .bind(model)
            .fetch_all(&self.readers)
            .await?;
        Ok(intact_records(&rows, diagnosis_record))
    }
}

async fn insert_model(writer: &mut SqliteConnection, new: &NewModel, before: &[String]) -> Result<i64, StoreError> {
    let without = |these: &[String], those: &[String]| {
        these.iter().filter(|effect| !those.contains(effect)).cloned().collect::<Vec<String>>()
    };
    let more_runs = serde_json::to_string(&new.more_runs)?;
    let excluded = serde_json::to_string(&new.excluded)?;
    let effects = serde_json::to_string(&new.effects)?;
    let added = serde_json::to_string(&without(&new.effects, before))?;
    let removed = serde_json::to_string(&without(before, &new.effects))?;
    let fit = serde_json::to_string(&new.fit)?;
    let options = serde_json::to_string(&new.options)?;
    let created_at = now();
    let cells = [
        new.run.into(),
        new.parent.into(),
        (&new.kind).into(),
        (&effects).into(),
        (&added).into(),
        (&removed).into(),
        (&fit).into(),
        (&new.residual).into(),
        new.rms.into(),
        new.validation_rms.into(),
        new.noise_floor_rms.into(),
        (&options).into(),
        (&created_at).into(),
        (&more_runs).into(),
        (&excluded).into(),
        (&new.by).into(),
        new.tried.into(),
    ];
    let row = MODELS.insert(&cells).fetch_one(writer).await?;
    Ok(row.try_get("id")?)
}

async fn insert_diagnosis(
    writer: &mut SqliteConnection,
    model: i64,
    diagnosis: &Value,
    created_at: &str,
) -> Result<i64, StoreError> {
    let text = serde_json::to_string(diagnosis)?;
    let cells = [model.into(), (&text).into(), created_at.into()];
    let row = DIAGNOSES.insert(&cells).fetch_one(writer).await?;
    Ok(row.try_get("id")?)
}

fn diagnosis_record(row: &SqliteRow) -> Result<DiagnosisRecord, StoreError> {
    DIAGNOSES.check(row)?;
    Ok(DiagnosisRecord {
        id: row.try_get("id")?,
        model: row.try_get("model")?,
        diagnosis: json(row, "diagnosis")?,
        created_at: row.try_get("created_at")?,
    })
}
