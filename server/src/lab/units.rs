//! Units under test: the unit of a new run, the list of units and their first-pass yield.

use super::names::{LONGEST_UNIT_TEXT, checked};
use super::trends::has_result;
use super::{Answer, Lab, LabError};
use crate::limits::{self, LimitsFile, Measured};
use crate::store::{Search, UnitRunRecord};
use crate::view::{FirstPassYield, Identified, LimitOutcome, NewRun, Unit, UnitList, UnitSummary, YieldGroup, reread};
use jointbench_instrument::Meta;
use jointbench_model::stats::proportion::wilson_interval;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// Limit of the listed units.
const MOST: usize = 1000;
/// Keys of the metadata of exported runs.
const UNIT: &str = "unit";
const OPERATOR: &str = "operator";

/// The unit under test of a new run, the person who starts it, and the limits of the unit.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct TestedUnit {
    pub unit: Option<Unit>,
    pub operator: Option<String>,
    pub limits: Option<LimitsFile>,
}

impl TestedUnit {
    /// Checks the texts of a user.
    pub fn checked(unit: Option<&Unit>, operator: Option<&str>) -> Answer<Self> {
        Ok(Self { unit: unit.map(checked_unit).transpose()?, operator: optional("operator", operator)?, limits: None })
    }

    /// Of a new run; the procedure has to be able to meet the limits.
    pub fn of(new: &NewRun) -> Answer<Self> {
        let checked = |text: &String| match limits::checked(text, &Measured::new(new.unit.as_ref(), &new.procedure)) {
            Ok(()) => Ok(LimitsFile::of(text)),
            Err(fault) => Err(LabError::Invalid(format!("limits: {fault}"))),
        };
        let limits = new.limits.as_ref().map(checked).transpose()?;
        Ok(Self { limits, ..Self::checked(new.unit.as_ref(), new.operator.as_deref())? })
    }

    /// Moves the unit of an exported run from the metadata of its file. Other values of these keys stay there.
    pub fn taken_from(meta: &mut Meta) -> Self {
        let unit: Option<Unit> = meta.other.get(UNIT).and_then(|unit| reread(unit).ok());
        let operator: Option<String> = meta.other.get(OPERATOR).and_then(|operator| reread(operator).ok());
        let Ok(tested) = Self::checked(unit.as_ref(), operator.as_deref()) else { return Self::default() };
        for (key, there) in [(UNIT, tested.unit.is_some()), (OPERATOR, tested.operator.is_some())] {
            if there {
                meta.other.remove(key);
            }
        }
        tested
    }

    /// Adds the unit to the metadata of an export.
    pub fn add_to(self, meta: &mut Meta) -> Answer<()> {
        if let Some(unit) = self.unit {
            meta.other.insert(UNIT.to_owned(), reread(&unit)?);
        }
        if let Some(operator) = self.operator {
            meta.other.insert(OPERATOR.to_owned(), operator.into());
        }
        Ok(())
    }
}

fn checked_unit(unit: &Unit) -> Answer<Unit> {
    if unit.serial.trim().is_empty() {
        let missing = "unit: the serial number is missing: enter it, or omit part, revision and batch";
        return Err(LabError::Invalid(missing.to_owned()));
    }
    Ok(Unit {
        serial: checked("serial", &unit.serial, LONGEST_UNIT_TEXT)?.to_owned(),
        part: optional("part", unit.part.as_deref())?,
        revision: optional("revision", unit.revision.as_deref())?,
        batch: optional("batch", unit.batch.as_deref())?,
    })
}

/// An empty text is no text.
fn optional(what: &str, text: Option<&str>) -> Answer<Option<String>> {
    let text = text.filter(|text| !text.trim().is_empty());
    text.map(|text| checked(what, text, LONGEST_UNIT_TEXT).map(str::to_owned)).transpose()
}

impl Lab {
    /// The units that have a run that matches the search, and the first-pass yield of these units.
    pub async fn units(&self, search: &str) -> Answer<UnitList> {
        Ok(unit_list(&self.inner.store.unit_runs(search).await?))
    }

    /// The same for an incomplete search: its unknown terms are ignored and reported.
    pub async fn units_while_typing(&self, search: &str) -> Answer<UnitList> {
        let (understood, refused) = Search::understood(search);
        Ok(UnitList { unclear: refused.map(|fault| fault.to_string()), ..self.units(&understood).await? })
    }

    /// Marks a unit as a reference, or ends that.
    pub async fn set_unit_reference(&self, serial: &str, reference: bool, by: &str) -> Answer<UnitSummary> {
        let (store, serial) = (&self.inner.store, serial.trim());
        let none = || LabError::NotFound(format!("no run has the unit {serial}"));
        if store.runs_of_unit(serial).await?.is_empty() {
            return Err(none());
        }
        store.set_unit_reference(serial, reference, by).await?;
        let runs = store.runs_of_unit(serial).await?;
        summary(&runs.iter().collect::<Vec<_>>()).ok_or_else(none)
    }
}

fn unit_list(runs: &[UnitRunRecord]) -> UnitList {
    let mut by_serial: BTreeMap<&str, Vec<&UnitRunRecord>> = BTreeMap::new();
    for run in runs {
        by_serial.entry(&run.unit.serial).or_default().push(run);
    }
    let mut units: Vec<UnitSummary> = by_serial.values().filter_map(|runs| summary(runs)).collect();
    units.sort_by_key(|unit| Reverse(unit.newest_run));
    let total = units.len() as u64;
    units.truncate(MOST);
    let counted = by_serial.values().filter(|runs| !runs.iter().any(|run| run.is_reference));
    UnitList { total, units, yields: yields(counted), unclear: None }
}

/// `runs`: all runs of one unit, in order.
fn summary(runs: &[&UnitRunRecord]) -> Option<UnitSummary> {
    let newest = runs.last()?;
    let named = |text: fn(&Unit) -> &Option<String>| runs.iter().rev().find_map(|run| text(&run.unit).clone());
    let mut complete = runs.iter().filter(|run| is_complete(run));
    let first_verdict = complete.clone().next().and_then(|run| verdict(run));
    let newest_complete = complete.next_back();
    Some(UnitSummary {
        serial: newest.unit.serial.clone(),
        part: named(|unit| &unit.part),
        revision: named(|unit| &unit.revision),
        batch: named(|unit| &unit.batch),
        reference: newest.is_reference,
        runs: runs.len() as u64,
        first_verdict,
        newest_verdict: newest_complete.and_then(|run| verdict(run)),
        newest_limits: newest_complete.and_then(|run| limit_outcome(run)),
        newest_run: newest.run,
        newest_at: newest.created_at.clone(),
    })
}

fn is_complete(run: &UnitRunRecord) -> bool {
    has_result(run.state, &run.procedure)
}

fn verdict(run: &UnitRunRecord) -> Option<Identified> {
    run.verdict.as_ref().and_then(|verdict| reread(verdict).ok())
}

fn limit_outcome(run: &UnitRunRecord) -> Option<LimitOutcome> {
    run.limits.as_ref().and_then(|outcome| reread(outcome).ok())
}

/// Identified, and within its limits if it has some.
fn passes(run: &UnitRunRecord, verdict: Identified) -> bool {
    verdict.is_identified() && limit_outcome(run).is_none_or(|outcome| outcome == LimitOutcome::Pass)
}

fn yields<'r>(units: impl Iterator<Item = &'r Vec<&'r UnitRunRecord>>) -> Vec<FirstPassYield> {
    /// Group, part, revision, batch and procedure.
    type Key<'r> = (YieldGroup, Option<&'r str>, Option<&'r str>, Option<&'r str>, &'r str);
    let mut counts: BTreeMap<Key<'_>, (u64, u64)> = BTreeMap::new();
    for runs in units {
        let mut begun = BTreeSet::new();
        let first_runs = runs.iter().filter(|run| is_complete(run) && begun.insert(run.procedure.as_str()));
        // A verdict is available shortly after the end of its run.
        for (run, verdict) in first_runs.filter_map(|run| Some((run, verdict(run)?))) {
            let [part, revision, batch] =
                [&run.unit.part, &run.unit.revision, &run.unit.batch].map(|text| text.as_deref());
            for (group, revision, batch) in [
                (YieldGroup::Part, None, None),
                (YieldGroup::Revision, revision, None),
                (YieldGroup::Batch, revision, batch),
            ] {
                let (units, passed) = counts.entry((group, part, revision, batch, &run.procedure)).or_default();
                *units += 1;
                *passed += u64::from(passes(run, verdict));
            }
        }
    }
    let owned = |text: Option<&str>| text.map(str::to_owned);
    let row = |((group, part, revision, batch, procedure), (units, passed)): (Key<'_>, (u64, u64))| FirstPassYield {
        group,
        part: owned(part),
        revision: owned(revision),
        batch: owned(batch),
        procedure: procedure.to_owned(),
        units,
        passed,
        fraction: passed as f64 / units as f64,
        ci95: wilson_interval(passed, units),
    };
    counts.into_iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_procedure::RunState;

    fn run(run: i64, serial: &str, batch: Option<&str>, state: RunState, verdict: Option<&str>) -> UnitRunRecord {
        UnitRunRecord {
            run,
            unit: Unit {
                serial: serial.into(),
                part: Some("P".into()),
                revision: None,
                batch: batch.map(str::to_owned),
            },
            procedure: "friction".into(),
            state,
            created_at: "2026-01-31T00:00:00Z".into(),
            verdict: verdict.map(str::to_owned),
            limits: None,
            is_reference: false,
        }
    }

    #[test]
    fn the_first_complete_run_of_a_unit_decides() {
        use RunState::{Aborted, Completed};
        let list = unit_list(&[
            run(1, "A", Some("7"), Aborted, Some("failed")),
            run(2, "A", Some("7"), Completed, Some("identified_with_warning")),
            run(3, "B", Some("7"), Completed, Some("inconclusive")),
            run(4, "B", None, Completed, Some("identified")),
            run(5, "C", Some("8"), Completed, None),
            UnitRunRecord { limits: Some("fail".into()), ..run(6, "D", Some("9"), Completed, Some("identified")) },
        ]);
        let serials: Vec<_> = list.units.iter().map(|unit| unit.serial.as_str()).collect();
        assert_eq!((list.total, serials), (4, vec!["D", "C", "B", "A"]), "newest first");
        assert_eq!(list.units[0].newest_limits, Some(LimitOutcome::Fail));
        let b = &list.units[2];
        assert_eq!((b.runs, b.newest_run, b.batch.as_deref()), (2, 4, Some("7")));
        assert_eq!((b.first_verdict, b.newest_verdict), (Some(Identified::Inconclusive), Some(Identified::Identified)));
        let one = &list.units[3];
        assert_eq!(
            (one.first_verdict, one.first_verdict),
            (one.newest_verdict, Some(Identified::IdentifiedWithWarning))
        );
        let figures: Vec<_> =
            list.yields.iter().map(|one| (one.group, one.batch.as_deref(), one.passed, one.units)).collect();
        let expected = [
            (YieldGroup::Part, None, 1, 3),
            (YieldGroup::Revision, None, 1, 3),
            (YieldGroup::Batch, Some("7"), 1, 2),
            (YieldGroup::Batch, Some("9"), 0, 1),
        ];
        assert_eq!(figures, expected, "C has no verdict yet, D exceeds a limit");
    }

    #[test]
    fn yields_exclude_reference_units() {
        let measured = |number, serial| run(number, serial, None, RunState::Completed, Some("inconclusive"));
        let list = unit_list(&[measured(1, "A"), UnitRunRecord { is_reference: true, ..measured(2, "REF") }]);
        assert_eq!((list.total, list.units[0].reference, list.units[1].reference), (2, true, false));
        assert!(list.yields.iter().all(|one| (one.units, one.passed) == (1, 0)), "{:?}", list.yields);
    }

    #[test]
    fn a_part_needs_a_serial_number() {
        let unit = |serial: &str| Unit { serial: serial.into(), part: Some(" ".into()), ..Unit::default() };
        let refused = TestedUnit::checked(Some(&unit(" ")), None).unwrap_err().to_string();
        assert!(refused.contains("the serial number is missing: enter it"), "{refused}");
        let tested = TestedUnit::checked(Some(&unit(" SN1 ")), Some("")).unwrap();
        let unit = tested.unit.unwrap();
        assert_eq!(
            (unit.serial.as_str(), unit.part, tested.operator),
            ("SN1", None, None),
            "trimmed, and empty is none"
        );
    }

    #[test]
    fn a_unit_returns_from_the_metadata_of_an_export() {
        let unit = Unit { serial: "SN1".into(), batch: Some("7".into()), ..Unit::default() };
        let tested = TestedUnit::checked(Some(&unit), Some("A. Smith")).unwrap();
        let mut meta = Meta::default();
        tested.clone().add_to(&mut meta).unwrap();
        assert_eq!(meta.other["unit"], serde_json::json!({"serial": "SN1", "batch": "7"}));
        assert_eq!(TestedUnit::taken_from(&mut meta), tested);
        assert!(meta.other.is_empty());
        meta.other.insert("unit".into(), "Nm".into());
        assert_eq!(TestedUnit::taken_from(&mut meta), TestedUnit::default());
        assert_eq!(meta.other["unit"], "Nm", "another meaning of the key stays in the metadata");
    }
}
