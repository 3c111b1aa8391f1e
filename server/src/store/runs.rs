//! Runs and their journal.

use super::seal::{CHANNELS, EVENTS, RUN_STATES, RUNS};
use super::search::Search;
use super::units::{insert_unit, unit};
use super::values::{json, now, word};
use super::{EventRecord, NewRun, RunFilter, RunRecord, Store, StoreError};
use jointbench_instrument::Channel;
use jointbench_procedure::{Event, EventKind, RunId, RunState};
use serde_json::{Map, Value};
use sqlx::sqlite::SqliteRow;
use sqlx::{QueryBuilder, Row, SqliteConnection};

/// Runs with their tags, last note and verdict, and the last model version that is not idle and not only tried.
pub(super) const LISTED: &str = "SELECT runs_told.*, \
    (SELECT json_group_array(tag) FROM (SELECT tag FROM tags WHERE run = runs_told.id ORDER BY tag)) AS tags, \
    (SELECT verdict FROM verdicts WHERE run = runs_told.id) AS verdict, \
    (SELECT limits FROM verdicts WHERE run = runs_told.id) AS limits, \
    (SELECT text FROM notes WHERE run = runs_told.id ORDER BY id DESC LIMIT 1) AS note, \
    (SELECT json_object('id', id, 'validation_rms', validation_rms, 'noise_floor_rms', noise_floor_rms, \
        'unit', json_extract(fit, '$.unit'), \
        'coulomb', (SELECT json(p.value) FROM json_each(models_told.fit, '$.parameters') AS p WHERE p.value ->> '$.effect' = 'coulomb')) \
        FROM models_told WHERE run = runs_told.id AND NOT idle AND NOT tried AND json_valid(fit) ORDER BY id DESC LIMIT 1) AS model \
    FROM runs_told";

fn record(row: &SqliteRow, channels: Vec<Channel>) -> Result<RunRecord, StoreError> {
    RUNS.check(row)?;
    RUN_STATES.check(row)?;
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
        unit: unit(row)?,
        operator: row.try_get("operator")?,
        tags: json(row, "tags")?,
        note: row.try_get("note")?,
        verdict: row.try_get("verdict")?,
        limits: row.try_get("limits")?,
        model: row.try_get::<Option<&str>, _>("model")?.map(serde_json::from_str).transpose()?,
        channels,
        damaged: None,
    })
}

/// The readable data of a damaged run.
fn damaged(row: &SqliteRow, fault: StoreError) -> RunRecord {
    let text = |column| row.try_get(column).unwrap_or_default();
    let state = row.try_get::<&str, _>("state").map_err(StoreError::from).and_then(word);
    RunRecord {
        id: row.try_get("id").unwrap_or_default(),
        bench: text("bench"),
        procedure: text("procedure"),
        kind: text("kind"),
        simulated: row.try_get("simulated").unwrap_or_default(),
        state: state.unwrap_or(RunState::Interrupted),
        reason: row.try_get("reason").unwrap_or_default(),
        created_at: text("created_at"),
        finished_at: row.try_get("finished_at").unwrap_or_default(),
        rows: row.try_get::<i64, _>("rows").unwrap_or_default() as u64,
        damaged: Some(fault.to_string()),
        ..RunRecord::unreadable(0, String::new())
    }
}

impl Store {
    /// Creates a queued run.
    pub async fn create_run(&self, new: &NewRun) -> Result<RunId, StoreError> {
        insert_run(&mut *self.writer.acquire().await?, new).await
    }

    /// Stores the verdict of the procedure on an ended run, the outcome of its limits, and the values of its quantities.
    pub async fn keep_verdict(
        &self,
        run: RunId,
        verdict: &str,
        limits: Option<&str>,
        quantities: &[(String, f64)],
    ) -> Result<(), StoreError> {
        let mut writer = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        let keep =
            sqlx::query("INSERT OR REPLACE INTO verdicts (run, verdict, limits, with_quantities) VALUES (?, ?, ?, 1)");
        keep.bind(run).bind(verdict).bind(limits).execute(&mut *writer).await?;
        sqlx::query("DELETE FROM run_quantities WHERE run = ?").bind(run).execute(&mut *writer).await?;
        for (name, value) in quantities {
            let keep = sqlx::query("INSERT OR IGNORE INTO run_quantities (run, name, value) VALUES (?, ?, ?)");
            keep.bind(run).bind(name).bind(value).execute(&mut *writer).await?;
        }
        Ok(writer.commit().await?)
    }

    /// The stored values of the quantities of a run by name. `None` if they were never stored.
    pub async fn quantities_kept(&self, run: RunId) -> Result<Option<Vec<(String, f64)>>, StoreError> {
        let query = "SELECT with_quantities FROM verdicts WHERE run = ?";
        let with_quantities: Option<bool> = sqlx::query_scalar(query).bind(run).fetch_optional(&self.readers).await?;
        if with_quantities != Some(true) {
            return Ok(None);
        }
        let query = "SELECT name, value FROM run_quantities WHERE run = ? ORDER BY name";
        Ok(Some(sqlx::query_as(query).bind(run).fetch_all(&self.readers).await?))
    }

    /// Number of ended runs for each bench, procedure and state.
    pub async fn run_counts(&self) -> Result<Vec<([String; 3], u64)>, StoreError> {
        let query = "SELECT bench, procedure, state, COUNT(*) FROM runs WHERE finished_at IS NOT NULL GROUP BY 1, 2, 3 ORDER BY 1, 2, 3";
        let rows: Vec<(String, String, String, i64)> = sqlx::query_as(query).fetch_all(&self.readers).await?;
        Ok(rows.into_iter().map(|(bench, procedure, state, n)| ([bench, procedure, state], n as u64)).collect())
    }

    /// Ended runs without a stored verdict or without stored quantities, newest first.
    pub async fn unjudged(&self, limit: u32) -> Result<Vec<RunId>, StoreError> {
        let query = "SELECT id FROM runs_told WHERE finished_at IS NOT NULL AND rows > 0 AND procedure <> 'import' \
            AND id NOT IN (SELECT run FROM verdicts WHERE with_quantities) ORDER BY id DESC LIMIT ?";
        Ok(sqlx::query_scalar(query).bind(limit).fetch_all(&self.readers).await?)
    }

    pub async fn run(&self, run: RunId) -> Result<RunRecord, StoreError> {
        let mut reader = self.readers.begin().await?;
        let mut query = QueryBuilder::new(LISTED);
        query.push(" WHERE id = ").push_bind(run);
        let row = query.build().fetch_optional(&mut *reader).await?;
        let row = row.ok_or(StoreError::NoRun(run))?;
        record(&row, channels(&mut reader, run).await?).map_err(|fault| fault.at(|| RUNS.place_of(&row)))
    }

    /// A page of the matching runs, without their channels, and the number of all matches. A damaged run is listed with
    /// its readable data.
    pub async fn runs(&self, filter: &RunFilter) -> Result<(u64, Vec<RunRecord>), StoreError> {
        let search = Search::parse(filter.search.as_deref().unwrap_or_default())?;
        match self.page(&search, filter).await {
            Err(StoreError::Damaged(_)) => self.list_individually(&search, filter).await,
            page => page,
        }
    }

    async fn page(&self, search: &Search, filter: &RunFilter) -> Result<(u64, Vec<RunRecord>), StoreError> {
        let mut reader = self.readers.begin().await?;
        let mut count = QueryBuilder::new("SELECT COUNT(*) FROM runs_told");
        search.push(&mut count);
        let total: i64 = count.build_query_scalar().fetch_one(&mut *reader).await?;
        let mut page = QueryBuilder::new(LISTED);
        search.push(&mut page);
        filter.order.push(&mut page);
        page.push(" LIMIT ").push_bind(filter.limit).push(" OFFSET ").push_bind(filter.offset);
        let rows = page.build().fetch_all(&mut *reader).await?;
        Ok((total as u64, rows.iter().map(listed).collect()))
    }

    /// The same, newest first, if SQLite cannot scan the table: reads each run by its id.
    pub(super) async fn list_individually(
        &self,
        search: &Search,
        filter: &RunFilter,
    ) -> Result<(u64, Vec<RunRecord>), StoreError> {
        let last: Option<i64> = sqlx::query_scalar("SELECT seq FROM sqlite_sequence WHERE name = 'runs'")
            .fetch_optional(&self.readers)
            .await?;
        let mut runs = Vec::new();
        for run in (1..=last.unwrap_or_default()).rev() {
            let mut query = QueryBuilder::new(LISTED);
            search.push(&mut query);
            query.push(if search.is_empty() { " WHERE id = " } else { " AND id = " }).push_bind(run);
            match query.build().fetch_optional(&self.readers).await.map_err(StoreError::from) {
                Ok(row) => runs.extend(row.as_ref().map(listed)),
                Err(fault @ StoreError::Damaged(_)) => {
                    runs.push(RunRecord::unreadable(run, fault.within(run, "runs").to_string()));
                }
                Err(fault) => return Err(fault),
            }
        }
        let total = runs.len() as u64;
        Ok((total, runs.into_iter().skip(filter.offset as usize).take(filter.limit as usize).collect()))
    }

    /// Earlier complete runs of the same bench and procedure, newest first. A mock bench and a real bench of the same
    /// name are different benches. The limit never removes the run `among`.
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

    /// The last run that continued this one.
    pub async fn continued_by(&self, run: RunId) -> Result<Option<RunId>, StoreError> {
        let query = "SELECT MAX(id) FROM runs WHERE IIF(json_valid(meta), meta, '{}') ->> '$.continues.run' = ?";
        Ok(sqlx::query_scalar(query).bind(run).fetch_one(&self.readers).await?)
    }

    /// The events after number `after`, in order. A damaged event has the kind `damaged`.
    pub async fn events(&self, run: RunId, after: u64) -> Result<Vec<EventRecord>, StoreError> {
        let mut reader = self.readers.begin().await?;
        exists(&mut reader, run).await?;
        let rows = sqlx::query("SELECT * FROM events WHERE run = ? AND sequence > ? ORDER BY sequence")
            .bind(run)
            .bind(after as i64)
            .fetch_all(&mut *reader);
        let rows = rows.await.map_err(|fault| StoreError::from(fault).within(run, "events"))?;
        Ok(rows.iter().map(|row| event(row).unwrap_or_else(|fault| damaged_event(row, fault))).collect())
    }
}

pub(super) async fn insert_run(writer: &mut SqliteConnection, new: &NewRun) -> Result<RunId, StoreError> {
    let created_at = now();
    let parameters = serde_json::to_string(&new.parameters)?;
    let provenance = serde_json::to_string(&new.provenance)?;
    let meta = serde_json::to_string(&new.meta)?;
    let checksum = RUNS.seal(&[
        (&new.bench).into(),
        (&new.procedure).into(),
        (&new.kind).into(),
        new.simulated.into(),
        (&created_at).into(),
        (&parameters).into(),
        (&provenance).into(),
        (&meta).into(),
    ]);
    let inserted = sqlx::query(
        "INSERT INTO runs (bench, procedure, kind, simulated, state, created_at, parameters, provenance, meta, checksum) \
         VALUES (?, ?, ?, ?, 'queued', ?, ?, ?, ?, ?)",
    )
    .bind(&new.bench)
    .bind(&new.procedure)
    .bind(&new.kind)
    .bind(new.simulated)
    .bind(created_at)
    .bind(parameters)
    .bind(provenance)
    .bind(meta)
    .bind(checksum)
    .execute(&mut *writer)
    .await?;
    let run = inserted.last_insert_rowid();
    insert_unit(writer, run, new.unit.as_ref(), new.operator.as_deref()).await?;
    Ok(run)
}

/// Call it at the end of each transaction that changes the state of a run.
pub(super) async fn seal_state(writer: &mut SqliteConnection, run: RunId) -> Result<(), StoreError> {
    let row = sqlx::query("SELECT id, state, safe, reason, started_at, finished_at, rows FROM runs WHERE id = ?")
        .bind(run)
        .fetch_one(&mut *writer)
        .await?;
    let seal = sqlx::query("UPDATE runs SET state_checksum = ? WHERE id = ?");
    seal.bind(RUN_STATES.of_row(&row)?).bind(run).execute(writer).await?;
    Ok(())
}

/// Appends events to the journal. Safety events also update the run and the bench, and the run keeps the reason of its
/// end.
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
        let data = serde_json::to_string(&data)?;
        let cells = [run.into(), sequence.into(), event.at_s.into(), (&kind).into(), (&data).into()];
        EVENTS.insert(&cells).execute(&mut *writer).await?;
        match &event.kind {
            EventKind::Safe { safe } => super::safety::keep_safe(writer, run, *safe).await?,
            EventKind::State { reason: Some(reason), .. } => keep_reason(writer, run, Some(reason)).await?,
            _ => {}
        }
    }
    Ok(())
}

/// Keeps the first reason.
pub(super) async fn keep_reason(
    writer: &mut SqliteConnection,
    run: RunId,
    reason: Option<&str>,
) -> Result<(), StoreError> {
    let update = sqlx::query("UPDATE runs SET reason = COALESCE(reason, ?) WHERE id = ?");
    update.bind(reason).bind(run).execute(writer).await?;
    Ok(())
}

pub(super) async fn channels(reader: &mut SqliteConnection, run: RunId) -> Result<Vec<Channel>, StoreError> {
    let rows = sqlx::query("SELECT * FROM channels WHERE run = ? ORDER BY place").bind(run).fetch_all(reader).await?;
    let channel = |row: &SqliteRow| {
        CHANNELS.check(row)?;
        Ok(Channel { name: row.try_get("name")?, resolution: row.try_get("resolution")? })
    };
    rows.iter().map(channel).collect()
}

pub(super) fn listed(row: &SqliteRow) -> RunRecord {
    record(row, Vec::new()).unwrap_or_else(|fault| damaged(row, fault))
}

fn event(row: &SqliteRow) -> Result<EventRecord, StoreError> {
    EVENTS.check(row)?;
    let sequence = row.try_get::<i64, _>("sequence")? as u64;
    Ok(EventRecord { sequence, at_s: row.try_get("at_s")?, kind: row.try_get("kind")?, data: json(row, "data")? })
}

fn damaged_event(row: &SqliteRow, fault: StoreError) -> EventRecord {
    EventRecord {
        sequence: row.try_get::<i64, _>("sequence").unwrap_or_default() as u64,
        at_s: row.try_get("at_s").unwrap_or_default(),
        kind: "damaged".to_owned(),
        data: Map::from_iter([("text".to_owned(), fault.to_string().into())]),
    }
}

pub(super) async fn exists(reader: &mut SqliteConnection, run: RunId) -> Result<(), StoreError> {
    let there: bool =
        sqlx::query_scalar("SELECT EXISTS (SELECT 1 FROM runs WHERE id = ?)").bind(run).fetch_one(reader).await?;
    if there { Ok(()) } else { Err(StoreError::NoRun(run)) }
}
