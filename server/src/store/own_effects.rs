//! Effects that users write: the latest version of each is what new models may hold.

use super::runs::now;
use super::{OwnEffectRecord, Store, StoreError};
use serde_json::Value;

const LATEST: &str = "SELECT kind, effect, version, definition, created_at FROM own_effects AS own \
                      WHERE version = (SELECT max(version) FROM own_effects WHERE kind = own.kind AND effect = own.effect)";

type Row = (String, String, i64, String, String);

impl Store {
    /// In the order in which they were first written.
    pub async fn own_effects(&self) -> Result<Vec<OwnEffectRecord>, StoreError> {
        let rows: Vec<Row> = sqlx::query_as(LATEST).fetch_all(&self.readers).await?;
        let mut records: Vec<OwnEffectRecord> = rows.into_iter().map(record).collect::<Result<_, _>>()?;
        records.sort_by(|a, b| (&a.kind, &a.effect).cmp(&(&b.kind, &b.effect)));
        Ok(records)
    }

    /// Keeps a definition as the next version of its id. What is there already stays as it is.
    pub async fn save_own_effect(
        &self,
        kind: &str,
        effect: &str,
        definition: &Value,
    ) -> Result<OwnEffectRecord, StoreError> {
        let latest = self.own_effects().await?.into_iter().find(|own| own.kind == kind && own.effect == effect);
        if let Some(latest) = latest.filter(|latest| latest.definition == *definition) {
            return Ok(latest);
        }
        let row: Row = sqlx::query_as(
            "INSERT INTO own_effects (kind, effect, version, definition, created_at) \
             SELECT ?1, ?2, coalesce(max(version), 0) + 1, ?3, ?4 FROM own_effects WHERE kind = ?1 AND effect = ?2 \
             RETURNING kind, effect, version, definition, created_at",
        )
        .bind(kind)
        .bind(effect)
        .bind(serde_json::to_string(definition)?)
        .bind(now())
        .fetch_one(&self.writer)
        .await?;
        record(row)
    }

    /// Forgets an effect with all its versions; refused while a model uses it.
    pub async fn delete_own_effect(&self, kind: &str, effect: &str) -> Result<(), StoreError> {
        let user: Option<(i64,)> = sqlx::query_as(
            "SELECT models.id FROM models, json_each(models.fit, '$.own') AS own \
             WHERE models.kind = ? AND json_extract(own.value, '$.id') = ? ORDER BY models.id LIMIT 1",
        )
        .bind(kind)
        .bind(effect)
        .fetch_optional(&self.writer)
        .await?;
        if let Some((model,)) = user {
            return Err(StoreError::EffectUsed { effect: effect.to_owned(), model });
        }
        let deleted = sqlx::query("DELETE FROM own_effects WHERE kind = ? AND effect = ?")
            .bind(kind)
            .bind(effect)
            .execute(&self.writer)
            .await?;
        match deleted.rows_affected() {
            0 => Err(StoreError::NoEffect(effect.to_owned())),
            _ => Ok(()),
        }
    }
}

fn record((kind, effect, version, definition, created_at): Row) -> Result<OwnEffectRecord, StoreError> {
    Ok(OwnEffectRecord { kind, effect, version, definition: serde_json::from_str(&definition)?, created_at })
}
