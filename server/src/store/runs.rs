//! Runs and their journal.

use super::commit::append;
use super::search::Search;
use super::{EventRecord, NewRun, RunFilter, RunRecord, Store, StoreError};
use jiff::Timestamp;
use jointbench_instrument::{Channel, Trace};
use jointbench_procedure::{Event, EventKind, RunId, RunState, Safe};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use sqlx::sqlite::SqliteRow;
use sqlx::{QueryBuilder, Row, SqliteConnection};

/// Runs as they are told, with their tags, their last note, what came of them and the last version of their model that is not idle and not only tried.
const TOLD: &str = "SELECT runs_told.*, \
    (SELECT json_group_array(tag) FROM (SELECT tag FROM tags WHERE run = runs_told.id ORDER BY tag)) AS tags, \
    (SELECT verdict FROM verdicts WHERE run = runs_told.id) AS verdict, \
    (SELECT text FROM notes WHERE run = runs_told.id ORDER BY id DESC LIMIT 1) AS note, \
    (SELECT json_object('id', id, 'validation_rms', validation_rms, 'noise_floor_rms', noise_floor_rms, \
        'unit', json_extract(fit, '$.unit'), \
        'coulomb', (SELECT json(p.value) FROM json_each(models_told.fit, '$.parameters') AS p WHERE p.value ->> '$.effect' = 'coulomb')) \
        FROM models_told WHERE run = runs_told.id AND NOT idle AND NOT tried ORDER BY id DESC LIMIT 1) AS model \
    FROM runs_told";

/// Now, as it is written in the store.
pub(super) fn now() -> String {
    format!("{:.3}", Timestamp::now())
}

/// A word of the store (`"safe_verified"`) as its type.
fn word<T: DeserializeOwned>(text: &str) -> Result<T, StoreError> {
    Ok(serde_json::from_value(Value::from(text))?)
}

fn record(row: &SqliteRow, channels: Vec<Channel>) -> Result<RunRecord, StoreError> {
    Ok(RunRecord {
        id: row.try_get("id")?,
        bench: row.try_get("bench")?,
        procedure: row.try_get("procedure")?,
        kind: row.try_get("kind")?,
        simulated: row.try_get("simulated")?,
        state: word(row.try_get("state")?)?,
        safe: row.try_get::<Option<&str>, _>("safe")?.map(word).transpose()?,
        reason: row.try_get("reason")?,
        created_at: row.try_get("created_at")?,
        started_at: row.try_get("started_at")?,
        finished_at: row.try_get("finished_at")?,
        rows: row.try_get::<i64, _>("rows")? as u64,
        duration_s: row.try_get("duration_s")?,
        parameters: json(row, "parameters")?,
        provenance: json(row, "provenance")?,
        meta: json(row, "meta")?,
        tags: json(row, "tags")?,
        note: row.try_get("note")?,
        verdict: row.try_get("verdict")?,
        model: row.try_get::<Option<&str>, _>("model")?.map(serde_json::from_str).transpose()?,
        channels,
    })
}

/// A column that holds JSON.
pub(super) fn json<T: DeserializeOwned>(row: &SqliteRow, column: &str) -> Result<T, StoreError> {
    Ok(serde_json::from_str(row.try_get(column)?)?)
}

impl Store {
    /// A run that is queued.
    pub async fn create_run(&self, new: &NewRun) -> Result<RunId, StoreError> {
        insert_run(&mut *self.writer.acquire().await?, new).await
    }

    /// What the procedure makes of a run that is over, in a word.
    pub async fn keep_verdict(&self, run: RunId, verdict: &str) -> Result<(), StoreError> {
        let keep = sqlx::query("INSERT OR REPLACE INTO verdicts (run, verdict) VALUES (?, ?)");
        keep.bind(run).bind(verdict).execute(&self.writer).await?;
        Ok(())
    }

    /// Runs of a bench that are over and of which no verdict is kept, newest first.
    pub async fn unjudged(&self, limit: u32) -> Result<Vec<RunId>, StoreError> {
        let query = "SELECT id FROM runs_told WHERE finished_at IS NOT NULL AND rows > 0 AND procedure <> 'import' \
            AND id NOT IN (SELECT run FROM verdicts) ORDER BY id DESC LIMIT ?";
        Ok(sqlx::query_scalar(query).bind(limit).fetch_all(&self.readers).await?)
    }

    pub async fn run(&self, run: RunId) -> Result<RunRecord, StoreError> {
        let mut reader = self.readers.begin().await?;
        let mut query = QueryBuilder::new(TOLD);
        query.push(" WHERE id = ").push_bind(run);
        let row = query.build().fetch_optional(&mut *reader).await?;
        record(&row.ok_or(StoreError::NoRun(run))?, channels(&mut reader, run).await?)
    }

    /// A page of the runs that match, and how many match. The page's runs come without their channels.
    pub async fn runs(&self, filter: &RunFilter) -> Result<(u64, Vec<RunRecord>), StoreError> {
        let search = Search::parse(filter.search.as_deref().unwrap_or_default())?;
        let mut reader = self.readers.begin().await?;
        let mut count = QueryBuilder::new("SELECT COUNT(*) FROM runs_told");
        search.push(&mut count);
        let total: i64 = count.build_query_scalar().fetch_one(&mut *reader).await?;
        let mut page = QueryBuilder::new(TOLD);
        search.push(&mut page);
        filter.order.push(&mut page);
        page.push(" LIMIT ").push_bind(filter.limit).push(" OFFSET ").push_bind(filter.offset);
        let rows = page.build().fetch_all(&mut *reader).await?;
        let runs = rows.iter().map(|row| record(row, Vec::new())).collect::<Result<_, _>>()?;
        Ok((total as u64, runs))
    }

    /// Complete runs of the same bench and procedure before this one, newest first. A mock bench and a real one of the same
    /// name are two. One that has to be `among` them is, however old it is.
    pub async fn earlier(
        &self,
        run: RunId,
        among: Option<RunId>,
        limit: u32,
    ) -> Result<Vec<(RunId, String)>, StoreError> {
        let query = "SELECT r.id, r.created_at FROM runs AS r JOIN runs AS this ON this.id = ? \
            WHERE r.bench = this.bench AND r.procedure = this.procedure AND r.simulated = this.simulated \
            AND r.id < this.id AND r.state = 'completed' ORDER BY r.id IS ? DESC, r.id DESC LIMIT ?";
        let mut found: Vec<(RunId, String)> =
            sqlx::query_as(query).bind(run).bind(among).bind(limit).fetch_all(&self.readers).await?;
        found.sort_by_key(|(run, _)| std::cmp::Reverse(*run));
        Ok(found)
    }

    /// The last run that went on with this one.
    pub async fn continued_by(&self, run: RunId) -> Result<Option<RunId>, StoreError> {
        let query = "SELECT MAX(id) FROM runs WHERE json_extract(meta, '$.continues.run') = ?";
        Ok(sqlx::query_scalar(query).bind(run).fetch_one(&self.readers).await?)
    }

    /// The journal behind `after`, in order.
    pub async fn events(&self, run: RunId, after: u64) -> Result<Vec<EventRecord>, StoreError> {
        let mut reader = self.readers.begin().await?;
        exists(&mut reader, run).await?;
        let rows: Vec<(i64, f64, String, String)> = sqlx::query_as(
            "SELECT sequence, at_s, kind, data FROM events WHERE run = ? AND sequence > ? ORDER BY sequence",
        )
        .bind(run)
        .bind(after as i64)
        .fetch_all(&mut *reader)
        .await?;
        rows.into_iter()
            .map(|(sequence, at_s, kind, data)| {
                Ok(EventRecord { sequence: sequence as u64, at_s, kind, data: serde_json::from_str(&data)? })
            })
            .collect()
    }

    /// Says of a run that is over how it ended, how it was secured, and why, where its own last commit could not say so.
    pub async fn end_run(
        &self,
        run: RunId,
        state: RunState,
        safe: Safe,
        reason: Option<&str>,
    ) -> Result<(), StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        let told: Option<(String, Option<String>)> =
            sqlx::query_as("SELECT state, safe FROM runs WHERE id = ?").bind(run).fetch_optional(&mut *writer).await?;
        let (before, secured) = told.ok_or(StoreError::NoRun(run))?;
        let at_s: f64 = sqlx::query_scalar("SELECT COALESCE(MAX(at_s), 0.0) FROM events WHERE run = ?")
            .bind(run)
            .fetch_one(&mut *writer)
            .await?;
        if secured.is_none() {
            insert_events(&mut writer, run, &[Event { at_s, kind: EventKind::Safe { safe } }]).await?;
        }
        if !word::<RunState>(&before)?.is_final() {
            let end = Event { at_s, kind: EventKind::State { state, reason: reason.map(str::to_owned) } };
            append(&mut writer, run, state, &[end], Trace::default()).await?;
        } else {
            keep_reason(&mut writer, run, reason).await?;
        }
        Ok(writer.commit().await?)
    }

    /// Ends the runs that a daemon left open when it died, and returns them. Their committed samples stay readable.
    ///
    /// The bench was not secured by this: do so, then [`Store::end_run`].
    pub async fn interrupt_open_runs(&self) -> Result<Vec<RunRecord>, StoreError> {
        let open: Vec<RunId> = sqlx::query_scalar("SELECT id FROM runs WHERE finished_at IS NULL ORDER BY id")
            .fetch_all(&self.writer)
            .await?;
        let mut interrupted = Vec::new();
        for run in open {
            let at_s: f64 = sqlx::query_scalar("SELECT COALESCE(MAX(at_s), 0.0) FROM events WHERE run = ?")
                .bind(run)
                .fetch_one(&self.writer)
                .await?;
            let event = Event { at_s, kind: EventKind::State { state: RunState::Interrupted, reason: None } };
            self.commit(run, RunState::Interrupted, &[event], Default::default()).await?;
            interrupted.push(self.run(run).await?);
        }
        Ok(interrupted)
    }
}

pub(super) async fn insert_run(writer: &mut SqliteConnection, new: &NewRun) -> Result<RunId, StoreError> {
    let inserted = sqlx::query(
        "INSERT INTO runs (bench, procedure, kind, simulated, state, created_at, parameters, provenance, meta) \
         VALUES (?, ?, ?, ?, 'queued', ?, ?, ?, ?)",
    )
    .bind(&new.bench)
    .bind(&new.procedure)
    .bind(&new.kind)
    .bind(new.simulated)
    .bind(now())
    .bind(serde_json::to_string(&new.parameters)?)
    .bind(serde_json::to_string(&new.provenance)?)
    .bind(serde_json::to_string(&new.meta)?)
    .execute(writer)
    .await?;
    Ok(inserted.last_insert_rowid())
}

/// Appends to the journal; what an event says about safety is taken over into the run and the bench, and why a run ended
/// into the run: whoever finds it over finds its reason.
pub(super) async fn insert_events(
    writer: &mut SqliteConnection,
    run: RunId,
    events: &[Event],
) -> Result<(), StoreError> {
    let last: i64 = sqlx::query_scalar("SELECT COALESCE(MAX(sequence), 0) FROM events WHERE run = ?")
        .bind(run)
        .fetch_one(&mut *writer)
        .await?;
    for (sequence, event) in (last + 1..).zip(events) {
        let mut data: Map<String, Value> = match serde_json::to_value(&event.kind)? {
            Value::Object(data) => data,
            other => Map::from_iter([("kind".to_owned(), other)]),
        };
        let kind = data.remove("kind").and_then(|kind| Some(kind.as_str()?.to_owned())).unwrap_or_default();
        sqlx::query("INSERT INTO events (run, sequence, at_s, kind, data) VALUES (?, ?, ?, ?, ?)")
            .bind(run)
            .bind(sequence)
            .bind(event.at_s)
            .bind(kind)
            .bind(serde_json::to_string(&data)?)
            .execute(&mut *writer)
            .await?;
        match &event.kind {
            EventKind::Safe { safe } => super::safety::keep_safe(writer, run, *safe).await?,
            EventKind::State { reason: Some(reason), .. } => keep_reason(writer, run, Some(reason)).await?,
            _ => {}
        }
    }
    Ok(())
}

/// The first reason that is told stays.
async fn keep_reason(writer: &mut SqliteConnection, run: RunId, reason: Option<&str>) -> Result<(), StoreError> {
    let update = sqlx::query("UPDATE runs SET reason = COALESCE(reason, ?) WHERE id = ?");
    update.bind(reason).bind(run).execute(writer).await?;
    Ok(())
}

pub(super) async fn channels(reader: &mut SqliteConnection, run: RunId) -> Result<Vec<Channel>, StoreError> {
    let rows: Vec<(String, Option<f64>)> =
        sqlx::query_as("SELECT name, resolution FROM channels WHERE run = ? ORDER BY place")
            .bind(run)
            .fetch_all(reader)
            .await?;
    Ok(rows.into_iter().map(|(name, resolution)| Channel { name, resolution }).collect())
}

pub(super) async fn exists(reader: &mut SqliteConnection, run: RunId) -> Result<(), StoreError> {
    let there: bool =
        sqlx::query_scalar("SELECT EXISTS (SELECT 1 FROM runs WHERE id = ?)").bind(run).fetch_one(reader).await?;
    if there { Ok(()) } else { Err(StoreError::NoRun(run)) }
}
