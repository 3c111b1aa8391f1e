//! Effects that users write. New models use the latest version of each effect.

use super::seal::{EFFECT_USES, OWN_EFFECTS, intact_records};
use super::values::{json, now};
use super::{EffectUse, Store, StoreError, UserEffectRecord};
use jointbench_procedure::RunId;
use serde_json::Value;
use sqlx::sqlite::SqliteRow;
use sqlx::{AssertSqlSafe, Row};

const LATEST: &str = "SELECT * FROM own_effects AS own \
                      WHERE version = (SELECT max(version) FROM own_effects WHERE kind = own.kind AND effect = own.effect)";

impl Store {
    /// Sorted by kind and id. A damaged one is omitted and logged.
    pub async fn user_effects(&self) -> Result<Vec<UserEffectRecord>, StoreError> {
        let rows = sqlx::query(LATEST).fetch_all(&self.readers).await?;
        let mut records = intact_records(&rows, record);
        records.sort_by(|a, b| (&a.kind, &a.effect).cmp(&(&b.kind, &b.effect)));
        Ok(records)
    }

    /// Stores a definition as the next version of its id. Existing versions do not change.
    pub async fn save_user_effect(
        &self,
        kind: &str,
        effect: &str,
        definition: &Value,
    ) -> Result<UserEffectRecord, StoreError> {
        let latest = self.user_effects().await?.into_iter().find(|own| own.kind == kind && own.effect == effect);
        if let Some(latest) = latest.filter(|latest| latest.definition == *definition) {
            return Ok(latest);
        }
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        let version: i64 =
            sqlx::query_scalar("SELECT COALESCE(MAX(version), 0) + 1 FROM own_effects WHERE kind = ? AND effect = ?")
                .bind(kind)
                .bind(effect)
                .fetch_one(&mut *writer)
                .await?;
        let (text, created_at) = (serde_json::to_string(definition)?, now());
        let cells = [kind.into(), effect.into(), version.into(), (&text).into(), (&created_at).into()];
        let row = OWN_EFFECTS.insert(&cells).fetch_one(&mut *writer).await?;
        writer.commit().await?;
        record(&row)
    }

    /// Whether the diagnosis of a run may suggest an effect of its kind, from now on.
    pub async fn use_effect(
        &self,
        run: RunId,
        kind: &str,
        effect: &str,
        used: bool,
        by: &str,
    ) -> Result<(), StoreError> {
        let at = now();
        let cells = [run.into(), kind.into(), effect.into(), used.into(), by.into(), (&at).into()];
        EFFECT_USES.insert(&cells).execute(&self.writer).await?;
        Ok(())
    }

    /// Kind and id of each effect that is in use, with the run whose diagnosis may suggest it. A damaged row uses none.
    pub async fn effect_uses(&self) -> Result<Vec<EffectUse>, StoreError> {
        let latest = "SELECT * FROM effect_uses AS one WHERE used AND id = \
                      (SELECT max(id) FROM effect_uses WHERE run = one.run AND kind = one.kind AND effect = one.effect) \
                      ORDER BY run";
        let rows = sqlx::query(latest).fetch_all(&self.readers).await?;
        Ok(intact_records(&rows, |row| {
            EFFECT_USES.check(row)?;
            Ok(EffectUse { run: row.try_get("run")?, kind: row.try_get("kind")?, effect: row.try_get("effect")? })
        }))
    }

    /// Deletes an effect with all its versions and uses. Refused while a model uses it.
    pub async fn delete_user_effect(&self, kind: &str, effect: &str) -> Result<(), StoreError> {
        let user: Option<(i64,)> = sqlx::query_as(
            "SELECT models.id FROM models, json_each(IIF(json_valid(models.fit), models.fit, '{}'), '$.own') AS own \
             WHERE models.kind = ? AND json_extract(own.value, '$.id') = ? ORDER BY models.id LIMIT 1",
        )
        .bind(kind)
        .bind(effect)
        .fetch_optional(&self.writer)
        .await?;
        if let Some((model,)) = user {
            return Err(StoreError::EffectUsed { effect: effect.to_owned(), model });
        }
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        let mut deleted = 0;
        for table in ["own_effects", "effect_uses"] {
            let sql = format!("DELETE FROM {table} WHERE kind = ? AND effect = ?");
            let gone = sqlx::query(AssertSqlSafe(sql)).bind(kind).bind(effect).execute(&mut *writer).await?;
            deleted += gone.rows_affected();
        }
        writer.commit().await?;
        if deleted == 0 { Err(StoreError::NoEffect(effect.to_owned())) } else { Ok(()) }
    }
}

fn record(row: &SqliteRow) -> Result<UserEffectRecord, StoreError> {
    OWN_EFFECTS.check(row)?;
    Ok(UserEffectRecord {
        kind: row.try_get("kind")?,
        effect: row.try_get("effect")?,
        version: row.try_get("version")?,
        definition: json(row, "definition")?,
        created_at: row.try_get("created_at")?,
    })
}
