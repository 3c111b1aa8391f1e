//! The fit of the daemon for one unit.

use super::{UnitFit, UnitParameter};
use crate::units::Unit;
use jointbench_instrument::RunTable;
use jointbench_model::{Fit, ModelSpec, Options, Parameter};

/// # Errors
/// Why the daemon refuses the run, in words.
pub fn fit(unit: &Unit, table: Result<RunTable, String>, model: &ModelSpec) -> Result<UnitFit, String> {
    let fit = jointbench_model::fit(&table?, model, &Options::default()).map_err(|why| why.to_string())?;
    Ok(unit_fit(unit, fit))
}

/// What the fleet needs of a fit.
pub(crate) fn unit_fit(unit: &Unit, fit: Fit) -> UnitFit {
    let parameter =
        |p: Parameter| UnitParameter { effect: p.effect, name: p.name, unit: p.unit, value: p.value, ci95: p.ci95 };
    UnitFit {
        unit: unit.clone(),
        rows: fit.preparation.rows,
        rms: fit.rms,
        rms_unit: fit.unit,
        parameters: fit.parameters.into_iter().map(parameter).collect(),
    }
}
