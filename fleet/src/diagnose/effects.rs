//! The diagnoses of the units, counted.

use super::unit::{Missing, UnitDiagnosis};
use crate::statistics::median;
use crate::statistics::proportion::Share;
use crate::units::Unit;
use jointbench_model::thresholds::ALPHA;
use jointbench_model::{Evidence, UndecidedReason};
use serde::Serialize;
use std::collections::BTreeMap;

/// An effect with the units in which it is missing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectShare {
    /// Id of the effect.
    pub effect: String,
    /// Share of the tested units.
    pub share: Share,
    /// The same for each batch.
    pub batches: Vec<GroupShare>,
    /// The same for each week of the runs.
    pub weeks: Vec<GroupShare>,
    /// The units, by part, batch and serial number.
    pub units: Vec<Found>,
}

/// A share in one batch or week.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroupShare {
    /// Part number; empty for runs without one.
    pub part: String,
    /// Batch, or ISO week such as `2026-W48`.
    pub group: String,
    /// Share of the tested units of the group.
    pub share: Share,
}

/// A unit in which an effect is missing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Found {
    /// The unit.
    #[serde(flatten)]
    pub unit: Unit,
    /// Family-wise p-value of the effect in this unit.
    pub p_value: f64,
    /// 1 − validation error with the effect / validation error of the model.
    pub error_reduction: f64,
    /// Class of the evidence, as in the diagnosis of the daemon.
    pub evidence: Evidence,
    /// Effects that explain the run of this unit as well.
    pub confounded_with: Vec<String>,
}

/// An effect that some runs cannot show.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NotTestable {
    /// Id of the effect.
    pub effect: String,
    /// Number of units.
    pub units: usize,
    /// The reason for one of them, in words.
    pub reason: String,
}

/// Detection limit of an effect that was tested and not found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Limit {
    /// Id of the effect.
    pub effect: String,
    /// Number of units.
    pub units: usize,
    /// Median over these units: RMS of the smallest effect that is found with 80 % power, in `unit`.
    pub median_rms: f64,
    /// `Nm`, or `N` for a sliding axis.
    pub unit: String,
}

/// Units without a decision.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Undecided {
    /// Category.
    pub reason: UndecidedReason,
    /// Number of units.
    pub units: usize,
    /// The reason for one of them, in words.
    pub example: String,
}

/// The decision on one unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnitResult {
    /// The unit.
    #[serde(flatten)]
    pub unit: Unit,
    /// Effects that the diagnosis of the daemon suggests for this unit alone, the most important first.
    pub missing: Vec<String>,
    /// Family-wise p-value of the unit; 1 without a suggested effect.
    pub p_value: f64,
    /// Whether the unit is named at the false discovery rate.
    pub is_named: bool,
}

/// The decision on each tested unit.
pub fn results(tested: &[&UnitDiagnosis], limit: f64) -> Vec<UnitResult> {
    let result = |unit: &&UnitDiagnosis| UnitResult {
        unit: unit.fit.unit.clone(),
        missing: unit.missing.iter().map(|missing| missing.effect.clone()).collect(),
        p_value: unit.p_value(),
        is_named: unit.p_value() <= limit,
    };
    tested.iter().map(result).collect()
}

/// Units in which structure remains that no effect of the library explains.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unexplained {
    /// Share of the tested units.
    pub share: Share,
    /// Whether there are more of them than the error probability of the test of one unit explains: the interval of the
    /// share is above it.
    pub is_significant: bool,
    /// The units. They have no p-value, so that the false discovery rate does not apply to them.
    pub units: Vec<Unit>,
}

/// Units in which structure remains.
pub fn unexplained(tested: &[&UnitDiagnosis]) -> Unexplained {
    let found = tested.iter().filter(|unit| unit.is_unexplained);
    let units: Vec<Unit> = found.map(|unit| unit.fit.unit.clone()).collect();
    let share = Share::new(units.len(), tested.len());
    Unexplained { share, is_significant: share.ci95[0] > ALPHA, units }
}

/// Shares of all missing effects whose p-value is at most the limit of the units, the most frequent first.
pub fn shares(tested: &[&UnitDiagnosis], limit: f64) -> Vec<EffectShare> {
    let mut found: BTreeMap<&str, Vec<(&UnitDiagnosis, &Missing)>> = BTreeMap::new();
    for unit in tested {
        let missing = unit.missing.iter().filter(|missing| missing.p_value <= limit);
        missing.for_each(|missing| found.entry(&missing.effect).or_default().push((unit, missing)));
    }
    let share = |(effect, units): (&str, Vec<(&UnitDiagnosis, &Missing)>)| EffectShare {
        effect: effect.to_owned(),
        share: Share::new(units.len(), tested.len()),
        batches: groups(tested, &units, |unit| Some(unit.batch.clone())),
        weeks: groups(tested, &units, |unit| week(&unit.created_at)),
        units: units.iter().map(|(diagnosis, missing)| of_unit(&diagnosis.fit.unit, missing)).collect(),
    };
    let mut shares: Vec<EffectShare> = found.into_iter().map(share).collect();
    shares.sort_by(|a, b| b.share.count.cmp(&a.share.count).then(a.effect.cmp(&b.effect)));
    shares
}

fn of_unit(unit: &Unit, missing: &Missing) -> Found {
    Found {
        unit: unit.clone(),
        p_value: missing.p_value,
        error_reduction: missing.error_reduction,
        evidence: missing.evidence,
        confounded_with: missing.confounded_with.clone(),
    }
}

fn groups(
    tested: &[&UnitDiagnosis],
    with: &[(&UnitDiagnosis, &Missing)],
    group: impl Fn(&Unit) -> Option<String>,
) -> Vec<GroupShare> {
    let key = |unit: &Unit| Some((unit.part.clone(), group(unit)?));
    let mut counts: BTreeMap<(String, String), (usize, usize)> = BTreeMap::new();
    for key in tested.iter().filter_map(|unit| key(&unit.fit.unit)) {
        counts.entry(key).or_default().1 += 1;
    }
    for key in with.iter().filter_map(|(unit, _)| key(&unit.fit.unit)) {
        counts.entry(key).or_default().0 += 1;
    }
    let share = |((part, group), (count, of))| GroupShare { part, group, share: Share::new(count, of) };
    counts.into_iter().map(share).collect()
}

/// ISO week of a time in RFC 3339, in UTC: `2026-W48`.
pub(super) fn week(time: &str) -> Option<String> {
    let time: jiff::Timestamp = time.parse().ok()?;
    let week = time.to_zoned(jiff::tz::TimeZone::UTC).date().iso_week_date();
    Some(format!("{}-W{:02}", week.year(), week.week()))
}

/// Effects that the runs of some units cannot show, the most frequent first.
pub fn not_testable(decided: &[UnitDiagnosis]) -> Vec<NotTestable> {
    let mut found: BTreeMap<&str, (usize, &str)> = BTreeMap::new();
    for invisible in decided.iter().flat_map(|unit| &unit.not_visible) {
        found.entry(&invisible.effect).or_insert((0, &invisible.why)).0 += 1;
    }
    let listed = |(effect, (units, reason)): (&str, (usize, &str))| NotTestable {
        effect: effect.to_owned(),
        units,
        reason: reason.to_owned(),
    };
    let mut all: Vec<NotTestable> = found.into_iter().map(listed).collect();
    all.sort_by(|a, b| b.units.cmp(&a.units).then(a.effect.cmp(&b.effect)));
    all
}

/// Median detection limits, the smallest first.
pub fn limits(tested: &[&UnitDiagnosis]) -> Vec<Limit> {
    let mut found: BTreeMap<(&str, &str), Vec<f64>> = BTreeMap::new();
    for unit in tested {
        for silent in unit.silent.iter().filter(|silent| silent.minimum_detectable_rms.is_finite()) {
            let key = (silent.effect.as_str(), unit.fit.rms_unit.as_str());
            found.entry(key).or_default().push(silent.minimum_detectable_rms);
        }
    }
    let limit = |((effect, unit), values): ((&str, &str), Vec<f64>)| {
        let units = values.len();
        Some(Limit { effect: effect.to_owned(), units, median_rms: median(values)?, unit: unit.to_owned() })
    };
    let mut limits: Vec<Limit> = found.into_iter().filter_map(limit).collect();
    limits.sort_by(|a, b| a.median_rms.total_cmp(&b.median_rms));
    limits
}

/// Numbers of units without a decision, by reason.
pub fn undecided(decided: &[UnitDiagnosis]) -> Vec<Undecided> {
    let mut found: Vec<Undecided> = Vec::new();
    for (reason, text) in decided.iter().filter_map(|unit| unit.undecided.as_ref()) {
        match found.iter_mut().find(|known| known.reason == *reason) {
            Some(known) => known.units += 1,
            None => found.push(Undecided { reason: *reason, units: 1, example: text.clone() }),
        }
    }
    found.sort_by_key(|undecided| std::cmp::Reverse(undecided.units));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weeks_are_those_of_iso_8601() {
        assert_eq!(week("2026-11-29T08:00:00Z").as_deref(), Some("2026-W48"));
        assert_eq!(week("2027-01-01T00:00:00Z").as_deref(), Some("2026-W53"), "a week belongs to one year");
        assert_eq!(week("2026-11-30T00:30:00+01:00").as_deref(), Some("2026-W48"), "in UTC it is Sunday");
        assert_eq!(week("yesterday"), None);
    }
}
