//! One model fitted to all units: parameters of each unit, and their population for each part.

mod by_gram;
mod part;
mod single;
mod text;

pub use part::{BatchFit, Outlier, PartFit, PartParameter};
pub(crate) use single::unit_fit;
pub use text::text;
pub(crate) use text::{named, omitted, populations};

use crate::Fault;
use crate::archive::{Archive, Inventory, Selection};
use crate::query::{Answer, answer, refusal};
use crate::statistics::Z95;
use crate::statistics::random_effects::Estimate;
use crate::units::{Omitted, RunId, Unit, Units};
use jointbench_instrument::Kind;
use jointbench_model::ModelSpec;
use serde::Serialize;

/// One parameter of one unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnitParameter {
    /// Id of the effect.
    pub effect: String,
    /// Name within the effect.
    pub name: String,
    /// Unit of value and interval.
    pub unit: String,
    /// Estimate.
    pub value: f64,
    /// 95 % interval (delete-block jackknife), as the daemon computes it.
    pub ci95: [f64; 2],
}

impl UnitParameter {
    /// The estimate with the standard error of a normal interval of the same width, so that few effective blocks count
    /// as a larger error.
    pub fn estimate(&self) -> Estimate {
        Estimate { value: self.value, standard_error: (self.ci95[1] - self.ci95[0]) / (2.0 * Z95) }
    }
}

/// The model fitted to one unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnitFit {
    /// The unit.
    #[serde(flatten)]
    pub unit: Unit,
    /// Operating points of the fit.
    pub rows: usize,
    /// RMS of the residual, in `rms_unit`.
    pub rms: f64,
    /// `Nm`, or `N` for a sliding axis.
    pub rms_unit: String,
    /// Parameters, in the order of the model.
    pub parameters: Vec<UnitParameter>,
}

/// A unit without a fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Refused {
    /// The unit.
    #[serde(flatten)]
    pub unit: Unit,
    /// Why, in words.
    pub reason: String,
}

/// The model fitted to a fleet.
#[derive(Debug, Clone, Serialize)]
pub struct FleetFit {
    /// Effects of the model.
    pub model: Vec<String>,
    /// Population of the parameters for each part.
    pub parts: Vec<PartFit>,
    /// Each unit, by part, batch and serial number.
    pub units: Vec<UnitFit>,
    /// Units without a fit.
    pub refused: Vec<Refused>,
    /// Runs that represent no unit.
    pub omitted: Omitted,
}

/// A model as people write it: effects separated by `+` or commas.
///
/// # Errors
/// [`Fault::Input`] for an unknown effect, with the known ones.
pub fn model(text: &str) -> Result<ModelSpec, Fault> {
    ModelSpec::parse(Kind::Friction, &text.replace('+', ",")).map_err(|fault| Fault::Input(fault.to_string()))
}

/// Fits a model to the means of each unit.
///
/// Effects whose column depends only on the velocity are fitted from Gram matrices, which SQL computes in one pass.
/// Other models, and units that need a closer examination, are fitted one by one with the fit of the daemon. Both give
/// the same figures.
///
/// # Errors
/// [`Fault::Input`] for damaged files, [`Fault::Failed`] if the query fails.
pub fn fit(archive: &Archive, selection: &Selection, model: &ModelSpec, threads: usize) -> Result<FleetFit, Fault> {
    let (inventory, units, mut fitted) = match by_gram::query(model) {
        Some(sql) => {
            let Answer { batches, session } = answer(archive, selection, threads, &sql)?;
            let units = Units::choose(&session.means)?;
            let fitted = by_gram::fits(&batches, &session.means, &units, model)?;
            (session.means, units, fitted)
        }
        None => {
            let (inventory, units) = chosen(archive, selection)?;
            (inventory, units, Vec::new())
        }
    };
    let done: std::collections::HashSet<RunId> = fitted.iter().map(|fit| id(&fit.unit)).collect();
    let mut rest = units.clone();
    rest.by_run.retain(|run, _| !done.contains(run));
    let single = |unit: &Unit, table| (unit.clone(), single::fit(unit, table, model));
    let mut refused = Vec::new();
    for (unit, found) in rest.map(&inventory, single).map_err(|damaged| refusal(&damaged))? {
        match found {
            Ok(fit) => fitted.push(fit),
            Err(reason) => refused.push(Refused { unit, reason }),
        }
    }
    Ok(combine(model, fitted, refused, units.omitted))
}

/// The fits of all units with their populations.
pub(crate) fn combine(
    model: &ModelSpec,
    mut units: Vec<UnitFit>,
    mut refused: Vec<Refused>,
    omitted: Omitted,
) -> FleetFit {
    units.sort_by(|a, b| a.unit.cmp(&b.unit));
    refused.sort_by(|a, b| a.unit.cmp(&b.unit));
    FleetFit { model: model.effects.clone(), parts: part::parts(&units), units, refused, omitted }
}

/// The files of the means and their units. Damaged files are found while they are read later, too.
///
/// # Errors
/// As [`Inventory::read`].
pub(crate) fn chosen(archive: &Archive, selection: &Selection) -> Result<(Inventory, Units), Fault> {
    let mut selection = selection.clone();
    loop {
        let inventory = Inventory::read(archive, crate::archive::Content::Means, &selection)?;
        if !selection.skip_damaged {
            let units = Units::choose(&inventory)?;
            return Ok((inventory, units));
        }
        let damaged = crate::query::unreadable([&inventory]);
        if damaged.is_empty() {
            let units = Units::choose(&inventory)?;
            return Ok((inventory, units));
        }
        selection.omitted.extend(damaged);
    }
}

fn id(unit: &Unit) -> RunId {
    (unit.store.clone(), unit.run.clone())
}
