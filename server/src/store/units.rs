//! The unit under test of each run.

use super::seal::{RUN_UNITS, UNIT_REFERENCES, intact_records};
use super::search::Search;
use super::values::{now, word};
use super::{Store, StoreError, Unit, UnitRunRecord};
use jointbench_procedure::RunId;
use sqlx::sqlite::SqliteRow;
use sqlx::{QueryBuilder, Row, SqliteConnection};

const UNIT_RUN: &str = "SELECT id, serial, part, revision, batch, operator, unit_checksum, procedure, state, created_at, \
    (SELECT verdict FROM verdicts WHERE run = runs_told.id) AS verdict, \
    (SELECT limits FROM verdicts WHERE run = runs_told.id) AS limits, \
    (SELECT is_reference FROM unit_references WHERE unit_references.serial = runs_told.serial ORDER BY unit_references.id DESC LIMIT 1) \
    AS is_reference \
    FROM runs_told WHERE serial ";

impl Store {
    /// All runs of one unit, in order.
    pub async fn runs_of_unit(&self, serial: &str) -> Result<Vec<UnitRunRecord>, StoreError> {
        let mut query = QueryBuilder::new(UNIT_RUN);
        query.push("= ").push_bind(serial).push(" ORDER BY id");
        Ok(intact_records(&query.build().fetch_all(&self.readers).await?, unit_run).into_iter().flatten().collect())
    }

    /// All runs of the units that have a run that matches the search, in order.
    pub async fn unit_runs(&self, search: &str) -> Result<Vec<UnitRunRecord>, StoreError> {
        let search = Search::parse(search)?;
        let mut query = QueryBuilder::new(UNIT_RUN);
        query.push("IN (SELECT serial FROM runs_told");
        search.push(&mut query);
        query.push(") ORDER BY id");
        Ok(intact_records(&query.build().fetch_all(&self.readers).await?, unit_run).into_iter().flatten().collect())
    }

    /// Marks a unit as a reference, or ends that.
    pub async fn set_unit_reference(&self, serial: &str, is_reference: bool, by: &str) -> Result<(), StoreError> {
        let at = now();
        let cells = [serial.into(), i64::from(is_reference).into(), by.into(), (&at).into()];
        UNIT_REFERENCES.insert(&cells).execute(&self.writer).await?;
        Ok(())
    }
}

fn unit_run(row: &SqliteRow) -> Result<Option<UnitRunRecord>, StoreError> {
    let Some(unit) = unit(row)? else { return Ok(None) };
    Ok(Some(UnitRunRecord {
        run: row.try_get("id")?,
        unit,
        procedure: row.try_get("procedure")?,
        state: word(row.try_get("state")?)?,
        created_at: row.try_get("created_at")?,
        verdict: row.try_get("verdict")?,
        limits: row.try_get("limits")?,
        is_reference: row.try_get::<Option<bool>, _>("is_reference")?.unwrap_or_default(),
    }))
}

/// The unit of a row of `runs_told`.
pub(super) fn unit(row: &SqliteRow) -> Result<Option<Unit>, StoreError> {
    RUN_UNITS.check(row)?;
    let Some(serial) = row.try_get("serial")? else { return Ok(None) };
    let (part, revision, batch) = (row.try_get("part")?, row.try_get("revision")?, row.try_get("batch")?);
    Ok(Some(Unit { serial, part, revision, batch }))
}

/// Stores the unit and the operator of a new run; no row if the run has neither.
pub(super) async fn insert_unit(
    writer: &mut SqliteConnection,
    run: RunId,
    unit: Option<&Unit>,
    operator: Option<&str>,
) -> Result<(), StoreError> {
    if unit.is_none() && operator.is_none() {
        return Ok(());
    }
    let serial = unit.map(|unit| unit.serial.as_str());
    let [part, revision, batch] = match unit {
        Some(unit) => [&unit.part, &unit.revision, &unit.batch].map(Option::as_deref),
        None => [None; 3],
    };
    let texts = [serial, part, revision, batch, operator];
    let cells = std::iter::once(run.into()).chain(texts.map(Into::into)).collect::<Vec<_>>();
    RUN_UNITS.insert(&cells).execute(writer).await?;
    Ok(())
}
