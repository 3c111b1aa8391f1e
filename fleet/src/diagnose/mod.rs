//! Which effect is missing in which share of the units: the diagnosis of the daemon for each unit, and control of the
//! false discovery rate over units.

mod effects;
mod text;
mod unit;

pub use effects::{EffectShare, Found, GroupShare, Limit, NotTestable, Undecided, Unexplained, UnitResult};
pub(crate) use text::share;
pub use text::text;

use crate::Fault;
use crate::archive::{Archive, Inventory, Selection};
use crate::fit::{FleetFit, Refused, chosen, combine};
use crate::query::refusal;
use crate::statistics::false_discovery::{RATE, limit};
use crate::units::{Unit, Units};
use jointbench_model::{ModelSpec, Options};
use serde::Serialize;
use std::collections::BTreeSet;
use unit::UnitDiagnosis;

/// Result of `jointbench-fleet diagnose`.
#[derive(Debug, Clone, Serialize)]
pub struct FleetDiagnosis {
    /// Effects of the diagnosed model.
    pub model: Vec<String>,
    /// Units with a test: all diagnosed units except those whose diagnosis is undecided for their data.
    pub tested: usize,
    /// Expected share of wrong units among the named units, at most.
    pub false_discovery_rate: f64,
    /// Effects that are missing in at least one unit, the most frequent first.
    pub effects: Vec<EffectShare>,
    /// Units in which structure remains that no effect of the library explains.
    pub unexplained: Unexplained,
    /// Effects that the runs of some units cannot show.
    pub not_testable: Vec<NotTestable>,
    /// Median detection limit of each effect that was tested and not found.
    pub detection_limits: Vec<Limit>,
    /// Units without a decision.
    pub undecided: Vec<Undecided>,
    /// Each tested unit, by part, batch and serial number.
    pub units: Vec<UnitResult>,
    /// The diagnosed model, fitted to each unit: populations, shifted batches and outliers.
    pub fit: FleetFit,
}

/// Share of the critical p-value that the smallest possible p-value of a permutation test has at most. With a tenth, up
/// to nine flips may exceed the score of a unit with the effect.
const RESOLUTION: f64 = 0.1;

/// Diagnoses each unit with the daemon's own decision, and names the units at the false discovery rate [`RATE`].
///
/// The p-value of a unit is family-wise over its candidate effects (max-T), and 1 for a unit without a missing effect.
/// Over units the rate is controlled by Benjamini and Hochberg. Where the permutation test of a unit has too few flips
/// for this, it is repeated with more.
///
/// # Errors
/// [`Fault::Input`] for damaged files.
pub fn diagnose(archive: &Archive, selection: &Selection, model: &ModelSpec) -> Result<FleetDiagnosis, Fault> {
    let (inventory, units) = chosen(archive, selection)?;
    let mut diagnosed = each(&inventory, &units, model, &Options::default())?;
    refine(&mut diagnosed, &inventory, &units, model)?;
    diagnosed.sort_by(|a, b| a.unit().cmp(b.unit()));
    let mut refused: Vec<Refused> = Vec::new();
    let mut decided: Vec<UnitDiagnosis> = Vec::new();
    for found in diagnosed {
        match found.result {
            Ok(diagnosis) => decided.push(diagnosis),
            Err(reason) => refused.push(Refused { unit: found.unit, reason }),
        }
    }
    let tested: Vec<&UnitDiagnosis> = decided.iter().filter(|unit| unit.is_tested()).collect();
    let p_values: Vec<f64> = tested.iter().map(|unit| unit.p_value()).collect();
    let limit = limit(&p_values, RATE);
    let fits = decided.iter().map(|unit| unit.fit.clone()).collect();
    Ok(FleetDiagnosis {
        model: model.effects.clone(),
        tested: tested.len(),
        false_discovery_rate: RATE,
        effects: effects::shares(&tested, limit),
        unexplained: effects::unexplained(&tested),
        not_testable: effects::not_testable(&decided),
        detection_limits: effects::limits(&tested),
        undecided: effects::undecided(&decided),
        units: effects::results(&tested, limit),
        fit: combine(model, fits, refused, units.omitted),
    })
}

/// A unit with its diagnosis, or why it is refused.
struct Diagnosed {
    unit: Unit,
    result: Result<UnitDiagnosis, String>,
}

impl Diagnosed {
    fn unit(&self) -> &Unit {
        &self.unit
    }

    /// Whether no flip reached the score of its first effect.
    fn is_at_floor(&self) -> bool {
        self.result.as_ref().is_ok_and(UnitDiagnosis::is_at_floor)
    }
}

fn each(inventory: &Inventory, units: &Units, model: &ModelSpec, options: &Options) -> Result<Vec<Diagnosed>, Fault> {
    let diagnosed = units.map(inventory, |unit, table| {
        let result = table.and_then(|table| UnitDiagnosis::new(unit, &table, model, options));
        Diagnosed { unit: unit.clone(), result }
    });
    diagnosed.map_err(|damaged| refusal(&damaged))
}

/// Repeats the tests whose p-value is only bounded by their number of flips, if the bound is too large for a decision
/// over all units.
fn refine(diagnosed: &mut [Diagnosed], inventory: &Inventory, units: &Units, model: &ModelSpec) -> Result<(), Fault> {
    let at_floor = diagnosed.iter().filter(|found| found.is_at_floor()).count();
    let critical = RATE * at_floor as f64 / diagnosed.len().max(1) as f64;
    let options = Options::default();
    let flips = (1.0 / (RESOLUTION * critical)).ceil() as usize;
    if at_floor == 0 || flips <= options.flips {
        return Ok(());
    }
    let mut few = units.clone();
    let again: BTreeSet<Unit> =
        diagnosed.iter().filter(|found| found.is_at_floor()).map(|found| found.unit.clone()).collect();
    few.by_run.retain(|_, unit| again.contains(unit));
    for found in each(inventory, &few, model, &Options { flips, ..options })? {
        if let Some(known) = diagnosed.iter_mut().find(|known| known.unit == found.unit) {
            *known = found;
        }
    }
    Ok(())
}
