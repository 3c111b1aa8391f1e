//! The units of a fleet: one run for each unit under test.

use crate::Fault;
use crate::archive::{ArchiveFile, Damaged, Inventory, Source, run_tables};
use jointbench_instrument::{Kind, RunTable};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;

/// A unit under test, with the run that represents it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Unit {
    /// Part number; empty if the run has none.
    pub part: String,
    /// Production batch; empty if the run has none.
    pub batch: String,
    /// Serial number.
    pub serial: String,
    /// Name of the bench.
    pub bench: String,
    /// Id of the store of the daemon.
    pub store: String,
    /// Number of the run in its store.
    pub run: String,
    /// Time of the run, RFC 3339.
    pub created_at: String,
}

/// Numbers of runs that represent no unit.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Omitted {
    /// Runs without a serial number.
    pub without_serial: usize,
    /// Runs that did not end as `completed`.
    pub not_completed: usize,
    /// Runs of another kind than friction: their means are no operating points.
    pub other_kind: usize,
    /// Earlier runs of a unit.
    pub earlier_runs: usize,
    /// Objects that are in the archive a second time.
    pub duplicates: usize,
    /// Omitted damaged files.
    pub damaged: Vec<Damaged>,
}

/// Id of a run: its store, and its number there.
pub type RunId = (String, String);

/// The runs that represent the units.
#[derive(Debug, Clone)]
pub struct Units {
    /// Each unit, by its run.
    pub by_run: BTreeMap<RunId, Unit>,
    /// All other runs.
    pub omitted: Omitted,
}

impl Units {
    /// Chooses the latest completed friction run of each serial number of a part.
    ///
    /// # Errors
    /// [`Fault::Input`] for test conditions that are no JSON, and without a unit.
    pub fn choose(inventory: &Inventory) -> Result<Self, Fault> {
        let damaged = inventory.damaged.clone();
        let mut omitted = Omitted { duplicates: inventory.duplicates, damaged, ..Omitted::default() };
        let mut latest: BTreeMap<(String, String), Unit> = BTreeMap::new();
        for (file, source) in inventory.files.iter().flat_map(|file| file.sources.iter().map(move |s| (file, s))) {
            let fault = |why: String| Fault::Input(format!("{}: {why}", file.path.display()));
            let Some(unit) = unit(source) else {
                omitted.without_serial += 1;
                continue;
            };
            if source.state() != "completed" {
                omitted.not_completed += 1;
            } else if source.conditions().map_err(fault)?.kind != Some(Kind::Friction) {
                omitted.other_kind += 1;
            } else {
                let same = (unit.part.clone(), unit.serial.clone());
                let later = latest.get(&same).is_none_or(|known| order(known) < order(&unit));
                let replaced = if later { latest.insert(same, unit) } else { Some(unit) };
                omitted.earlier_runs += usize::from(replaced.is_some());
            }
        }
        if latest.is_empty() {
            return Err(Fault::Input(no_unit(&omitted)));
        }
        let by_run = latest.into_values().map(|unit| ((unit.store.clone(), unit.run.clone()), unit)).collect();
        Ok(Self { by_run, omitted })
    }

    /// The unit that a run represents.
    pub fn of(&self, source: &Source) -> Option<&Unit> {
        self.by_run.get(&(source.store().to_owned(), source.run().to_owned()))
    }

    /// Calls a function for each unit with its run table, on all threads. The results have the order of the files.
    ///
    /// # Errors
    /// [`Fault::Input`] for a file that cannot be read, which names it.
    pub fn map<T: Send>(
        &self,
        inventory: &Inventory,
        each: impl Fn(&Unit, Result<RunTable, String>) -> T + Sync,
    ) -> Result<Vec<T>, Damaged> {
        let of_file = |file: &ArchiveFile| {
            if file.sources.iter().all(|source| self.of(source).is_none()) {
                return Ok(Vec::new());
            }
            let tables = run_tables(file)?;
            let units = tables.into_par_iter().filter_map(|(source, table)| Some(each(self.of(source)?, table)));
            Ok(units.collect())
        };
        let all: Result<Vec<Vec<T>>, Damaged> = inventory.files.par_iter().map(of_file).collect();
        Ok(all?.into_iter().flatten().collect())
    }
}

fn no_unit(omitted: &Omitted) -> String {
    let Omitted { without_serial, not_completed, other_kind, .. } = omitted;
    format!(
        "no completed friction run of a unit in the selected part of the archive ({without_serial} runs without a serial \
         number, {not_completed} not completed, {other_kind} of another kind): check --archive and --part"
    )
}

fn unit(source: &Source) -> Option<Unit> {
    let text = |value: Option<&str>| value.unwrap_or_default().to_owned();
    Some(Unit {
        part: text(source.part()),
        batch: text(source.batch()),
        serial: source.serial()?.to_owned(),
        bench: source.bench().to_owned(),
        store: source.store().to_owned(),
        run: source.run().to_owned(),
        created_at: source.created_at().to_owned(),
    })
}

/// By time; the store and the number of the run decide between equal times.
fn order(unit: &Unit) -> (&str, &str, usize, &str) {
    (&unit.created_at, &unit.store, unit.run.len(), &unit.run)
}
