//! Results of a check.

use super::super::health::DamagedRecord;
use super::super::keeper::Loss;
use super::super::seal::Sealed;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Result of a check of the store. The store is intact if `damaged` is empty.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
pub struct VerifyReport {
    #[schema(format = DateTime)]
    pub checked_at: String,
    pub runs: u64,
    /// Rows of samples.
    pub rows: u64,
    /// Stored records, including the blocks of samples.
    pub records: u64,
    /// Records of an older release without a checksum.
    pub without_checksum: u64,
    pub damaged: Vec<DamagedRecord>,
    /// For runs with damage: the readable part of each table.
    pub readable: Vec<Readable>,
    /// Acknowledged changes that are missing.
    pub lost: Vec<Loss>,
}

/// The readable part of a table, for one run or, if `run` is `null`, for all.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Readable {
    pub run: Option<i64>,
    pub table: String,
    pub readable: u64,
    pub of: u64,
}

impl VerifyReport {
    pub fn is_whole(&self) -> bool {
        self.damaged.is_empty()
    }

    pub(super) fn add(&mut self, run: Option<i64>, table: &str, what: String) {
        self.damaged.push(DamagedRecord { run, table: table.to_owned(), what });
    }

    /// Adds the numbers of readable and damaged records of a table.
    pub(super) fn count(&mut self, run: Option<i64>, sealed: &Sealed, whole: u64, damaged: u64) {
        self.records += whole + damaged;
        if damaged > 0 {
            let table = sealed.table.to_owned();
            self.readable.push(Readable { run, table, readable: whole, of: whole + damaged });
        }
    }
}
