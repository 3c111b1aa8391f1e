//! Checksums of stored rows: a CRC-32 over the columns, written with the row and compared at each read.
//!
//! CRC-32 (ISO-HDLC, as in zlib and gzip) detects every error burst of up to 32 bits and every odd number of flipped
//! bits. It misses other damage in one of 4·10⁹ cases. Standard tools can compute it, and the build already contains
//! the crate.
//!
//! Covered bytes: the name of the table, then each column in the order of [`Sealed::columns`]. A column is one tag byte
//! and its value: `0` NULL; `1` integer, `2` real, 8 bytes little endian; `3` text, `4` blob, each with an 8-byte
//! length first.

use super::StoreError;
use sqlx::query::Query;
use sqlx::sqlite::{SqliteArguments, SqliteRow};
use sqlx::{AssertSqlSafe, Decode, Row, Sqlite, TypeInfo, ValueRef};

/// The columns that a checksum covers, and the columns that identify a row in messages.
#[derive(Debug)]
pub struct Sealed {
    pub table: &'static str,
    pub columns: &'static [&'static str],
    /// Column of the checksum.
    pub checksum: &'static str,
    pub names: &'static [&'static str],
    /// A number that identifies a row of its owner.
    pub key: &'static str,
    pub owner: Owner,
}

/// What a row belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Owner {
    /// No run.
    Store,
    /// The run of the same number.
    SameRun,
    Run,
    /// A model of a run.
    Model,
    /// The samples of a run, which are checked block by block.
    Samples,
}

impl Owner {
    /// Condition that selects the rows of run `?1`, or the rows of no run without a number.
    pub fn condition(self) -> &'static str {
        match self {
            Owner::Store => "?1 IS NULL",
            Owner::SameRun => "id = ?1",
            Owner::Run | Owner::Samples => "run = ?1",
            Owner::Model => "model IN (SELECT id FROM models WHERE run = ?1)",
        }
    }
}

const fn sealed(
    owner: Owner,
    table: &'static str,
    columns: &'static [&'static str],
    names: &'static [&'static str],
) -> Sealed {
    Sealed { table, columns, checksum: "checksum", names, key: "id", owner }
}

/// The constant data of a run.
pub const RUNS: Sealed = sealed(
    Owner::SameRun,
    "runs",
    &["bench", "procedure", "kind", "simulated", "created_at", "parameters", "provenance", "meta"],
    &["id"],
);
/// The progress of a run.
pub const RUN_STATES: Sealed = Sealed {
    checksum: "state_checksum",
    ..sealed(Owner::SameRun, "runs", &["id", "state", "safe", "reason", "started_at", "finished_at", "rows"], &["id"])
};
/// The unit under test of a run, and its operator.
pub const RUN_UNITS: Sealed = Sealed {
    checksum: "unit_checksum",
    ..sealed(Owner::SameRun, "run_units", &["id", "serial", "part", "revision", "batch", "operator"], &["id"])
};
pub const EVENTS: Sealed =
    sealed(Owner::Run, "events", &["run", "sequence", "at_s", "kind", "data"], &["run", "sequence"]);
pub const CHANNELS: Sealed = Sealed {
    key: "place",
    ..sealed(Owner::Run, "channels", &["run", "place", "name", "resolution"], &["run", "place"])
};
pub const BLOCKS: Sealed = sealed(
    Owner::Samples,
    "blocks",
    &["run", "channel", "first_row", "rows", "data"],
    &["run", "channel", "first_row", "rows"],
);
pub const SPANS: Sealed =
    sealed(Owner::Samples, "spans", &["run", "first_row", "rows", "from_s", "to_s"], &["run", "first_row", "rows"]);
pub const COARSE: Sealed = Sealed {
    checksum: "coarse_checksum",
    ..sealed(Owner::Samples, "spans", &["run", "first_row", "rows", "coarse"], &["run", "first_row", "rows"])
};
pub const FINE: Sealed = Sealed {
    checksum: "fine_checksum",
    ..sealed(Owner::Samples, "spans", &["run", "first_row", "rows", "fine"], &["run", "first_row", "rows"])
};
pub const TAIL: Sealed = sealed(
    Owner::Samples,
    "tail",
    &["run", "first_row", "rows", "from_s", "to_s", "data"],
    &["run", "first_row", "rows"],
);
pub const MODELS: Sealed = sealed(
    Owner::Run,
    "models",
    &[
        "run",
        "parent",
        "kind",
        "effects",
        "added",
        "removed",
        "fit",
        "residual",
        "rms",
        "validation_rms",
        "noise_floor_rms",
        "options",
        "created_at",
        "more_runs",
        "excluded",
        "who",
        "made_to_try",
    ],
    &["run", "id"],
);
pub const DIAGNOSES: Sealed =
    sealed(Owner::Model, "diagnoses", &["model", "diagnosis", "created_at"], &["model", "id"]);
pub const BENCH_SAFETY: Sealed = sealed(
    Owner::Store,
    "bench_safety",
    &["bench", "blocked", "stopped", "reason", "run", "who", "at"],
    &["bench", "id"],
);
pub const NOTES: Sealed = sealed(Owner::Run, "notes", &["run", "at_s", "text", "created_at"], &["run", "id"]);
pub const CALIBRATIONS: Sealed =
    sealed(Owner::Store, "calibrations", &["bench", "procedure", "run", "who", "at"], &["bench", "procedure", "id"]);
pub const INSTRUMENT_FAULTS: Sealed =
    sealed(Owner::Store, "instrument_faults", &["bench", "instrument", "text", "at"], &["bench", "instrument", "id"]);
pub const OWN_EFFECTS: Sealed = sealed(
    Owner::Store,
    "own_effects",
    &["kind", "effect", "version", "definition", "created_at"],
    &["effect", "version"],
);
/// Which users' effects the diagnosis of a run may suggest.
pub const EFFECT_USES: Sealed =
    sealed(Owner::Run, "effect_uses", &["run", "kind", "effect", "used", "who", "at"], &["run", "id"]);
pub const UNIT_REFERENCES: Sealed =
    sealed(Owner::Store, "unit_references", &["serial", "is_reference", "who", "at"], &["serial", "id"]);
pub const AUTOPILOT_STEPS: Sealed = Sealed {
    // The only key of two numbers.
    key: "(autopilot << 32) + sequence",
    ..sealed(Owner::Store, "autopilot_steps", &["autopilot", "sequence", "step"], &["autopilot", "sequence"])
};
pub const KEPT: Sealed =
    sealed(Owner::Store, "kept", &["subject", "id", "what", "software", "packed"], &["subject", "id", "what"]);

/// Every checksum that [`super::verify`] compares, in this order. The cache (`kept`) is excluded: its results are
/// computed again.
pub const ALL: [&Sealed; 20] = [
    &RUNS,
    &RUN_STATES,
    &RUN_UNITS,
    &CHANNELS,
    &EVENTS,
    &BLOCKS,
    &SPANS,
    &COARSE,
    &FINE,
    &TAIL,
    &NOTES,
    &EFFECT_USES,
    &MODELS,
    &DIAGNOSES,
    &BENCH_SAFETY,
    &CALIBRATIONS,
    &INSTRUMENT_FAULTS,
    &OWN_EFFECTS,
    &UNIT_REFERENCES,
    &AUTOPILOT_STEPS,
];

#[derive(Debug, Clone, Copy)]
pub enum Cell<'a> {
    Null,
    Integer(i64),
    Real(f64),
    Text(&'a [u8]),
    Blob(&'a [u8]),
}

impl Sealed {
    /// Checksum of the values, in the order of [`Self::columns`].
    pub fn seal(&self, cells: &[Cell<'_>]) -> i64 {
        debug_assert_eq!(cells.len(), self.columns.len(), "{}", self.table);
        let mut hasher = crc32fast::Hasher::new();
        hasher.update(self.table.as_bytes());
        for cell in cells {
            match *cell {
                Cell::Null => hasher.update(&[0]),
                Cell::Integer(value) => {
                    hasher.update(&[1]);
                    hasher.update(&value.to_le_bytes());
                }
                Cell::Real(value) => {
                    hasher.update(&[2]);
                    hasher.update(&value.to_le_bytes());
                }
                Cell::Text(bytes) | Cell::Blob(bytes) => {
                    hasher.update(&[if matches!(cell, Cell::Text(_)) { 3 } else { 4 }]);
                    hasher.update(&(bytes.len() as u64).to_le_bytes());
                    hasher.update(bytes);
                }
            }
        }
        i64::from(hasher.finalize())
    }

    /// The statement that inserts a row with its checksum and returns it. Values in the order of [`Self::columns`].
    pub fn insert(&self, cells: &[Cell<'_>]) -> Query<'static, Sqlite, SqliteArguments> {
        let Sealed { table, columns, checksum, .. } = self;
        let places = vec!["?"; columns.len() + 1].join(", ");
        let sql = format!("INSERT INTO {table} ({}, {checksum}) VALUES ({places}) RETURNING *", columns.join(", "));
        let bound = cells.iter().fold(sqlx::query(AssertSqlSafe(sql)), |query, cell| match *cell {
            Cell::Null => query.bind(None::<i64>),
            Cell::Integer(value) => query.bind(value),
            Cell::Real(value) => query.bind(value),
            Cell::Text(bytes) => query.bind(String::from_utf8_lossy(bytes)),
            Cell::Blob(bytes) => query.bind(bytes),
        });
        bound.bind(self.seal(cells))
    }

    /// The expected checksum of a row.
    pub fn of_row(&self, row: &SqliteRow) -> Result<i64, StoreError> {
        let cells = self.columns.iter().map(|column| cell(row, column)).collect::<Result<Vec<_>, _>>();
        Ok(self.seal(&cells.map_err(|fault| self.damaged(row, &fault.to_string()))?))
    }

    /// Compares a row with its checksum; `false` if it has none (rows of an older release).
    ///
    /// # Errors
    /// [`StoreError::Damaged`] names run, table and row.
    pub fn check(&self, row: &SqliteRow) -> Result<bool, StoreError> {
        let Ok(Some(kept)) = row.try_get::<Option<i64>, _>(self.checksum) else { return Ok(false) };
        if kept == self.of_row(row)? { Ok(true) } else { Err(self.damaged(row, "its checksum differs")) }
    }

    /// The error of a damaged row.
    pub fn damaged(&self, row: &SqliteRow, what: &str) -> StoreError {
        StoreError::damaged(what).at(|| self.place_of(row))
    }

    /// Table and keys of a row.
    pub fn place_of(&self, row: &SqliteRow) -> String {
        let name = |column: &&str| {
            let value = match cell(row, column) {
                Ok(Cell::Integer(value)) => value.to_string(),
                Ok(Cell::Text(bytes)) => String::from_utf8_lossy(bytes).into_owned(),
                _ => "unreadable".to_owned(),
            };
            format!("{column} {value}")
        };
        let place: Vec<String> = self.names.iter().map(name).collect();
        format!("table {}, {}", self.table, place.join(", "))
    }
}

/// The readable rows: a damaged row does not hide the others.
pub fn intact_records<T>(rows: &[SqliteRow], record: impl Fn(&SqliteRow) -> Result<T, StoreError>) -> Vec<T> {
    let intact = |row| record(row).inspect_err(|fault| tracing::error!(%fault, "a record is left out of a list")).ok();
    rows.iter().filter_map(intact).collect()
}

fn cell<'r>(row: &'r SqliteRow, column: &str) -> Result<Cell<'r>, sqlx::Error> {
    let value = row.try_get_raw(column)?;
    if value.is_null() {
        return Ok(Cell::Null);
    }
    let kind = value.type_info().into_owned();
    let read = match kind.name() {
        "INTEGER" => <i64 as Decode<Sqlite>>::decode(value).map(Cell::Integer),
        "REAL" => <f64 as Decode<Sqlite>>::decode(value).map(Cell::real),
        "TEXT" => <&[u8] as Decode<Sqlite>>::decode(value).map(Cell::Text),
        _ => <&[u8] as Decode<Sqlite>>::decode(value).map(Cell::Blob),
    };
    read.map_err(sqlx::Error::Decode)
}

impl Cell<'_> {
    /// SQLite stores NaN as NULL and −0 as 0.
    fn real(value: f64) -> Self {
        if value.is_nan() { Cell::Null } else { Cell::Real(value + 0.0) }
    }
}

impl From<i64> for Cell<'_> {
    fn from(value: i64) -> Self {
        Cell::Integer(value)
    }
}

impl From<bool> for Cell<'_> {
    fn from(value: bool) -> Self {
        Cell::Integer(value.into())
    }
}

impl From<f64> for Cell<'_> {
    fn from(value: f64) -> Self {
        Cell::real(value)
    }
}

impl<'a> From<&'a str> for Cell<'a> {
    fn from(text: &'a str) -> Self {
        Cell::Text(text.as_bytes())
    }
}

impl<'a> From<&'a String> for Cell<'a> {
    fn from(text: &'a String) -> Self {
        Cell::Text(text.as_bytes())
    }
}

impl<'a> From<&'a [u8]> for Cell<'a> {
    fn from(bytes: &'a [u8]) -> Self {
        Cell::Blob(bytes)
    }
}

impl<'a, T: Into<Cell<'a>>> From<Option<T>> for Cell<'a> {
    fn from(value: Option<T>) -> Self {
        value.map_or(Cell::Null, Into::into)
    }
}
