//! Fits from Gram matrices: one for each operating point of each run, computed by SQL.

use super::{UnitFit, UnitParameter};
use crate::Fault;
use crate::archive::{Inventory, Source};
use crate::gram::ROW_WISE;
use crate::statistics::student_95;
use crate::units::{Unit, Units};
use datafusion::arrow::array::{Array, AsArray, Float64Array, ListArray, RecordBatch, StringArray};
use datafusion::arrow::datatypes::Float64Type;
use jointbench_instrument::Motion;
use jointbench_model::ModelSpec;
use jointbench_model::linear::{BlockGrams, Cholesky, moments};
use rayon::prelude::*;
use std::collections::HashMap;

/// The daemon fits no shorter table.
const FEWEST_ROWS: usize = 16;
/// The daemon fits no fewer operating points in motion.
const FEWEST_MOVING: usize = 12;
/// A point below this share of the fastest speed counts as at rest, as in the daemon.
const AT_REST: f64 = 1e-3;
/// Relative scatter of a constant response, as in the daemon.
const CONSTANT: f64 = 1e-9;

/// The query of all Gram matrices. `None` if an effect of the model needs more than the velocity.
///
/// Each row of the means is one steady state, and steady states are the blocks of the jackknife.
pub fn query(model: &ModelSpec) -> Option<String> {
    model.effects.iter().all(|effect| ROW_WISE.contains(&effect.as_str())).then(|| {
        let column = |effect: &String| format!("regressor('{effect}', motor_velocity_rad_s)");
        let columns: Vec<String> = model.effects.iter().map(column).collect();
        format!(
            "SELECT store, run, min(motor_velocity_rad_s) AS slowest, max(motor_velocity_rad_s) AS fastest, \
             gram(torque_constant_nm_per_a * motor_current_a, {}) AS gram FROM means GROUP BY store, run, time_s",
            columns.join(", ")
        )
    })
}

/// One operating point: extreme velocities and the Gram matrix, if all of its values are present.
struct Block<'b> {
    velocity: [f64; 2],
    gram: Option<&'b [f64]>,
}

impl Block<'_> {
    fn speed(&self) -> f64 {
        self.velocity.iter().fold(0.0f64, |fastest, v| fastest.max(v.abs()))
    }
}

/// The fits of all units whose Gram matrices are sufficient. Others are fitted from their rows.
///
/// # Errors
/// [`Fault::Failed`] if the answer has other columns than the query.
pub fn fits(
    batches: &[RecordBatch],
    inventory: &Inventory,
    units: &Units,
    model: &ModelSpec,
) -> Result<Vec<UnitFit>, Fault> {
    let of_run = blocks(batches)?;
    let of_unit = |source: &Source| {
        let unit = units.of(source)?;
        let blocks = of_run.get(&(source.store(), source.run()))?;
        unit_fit(unit, source.conditions().ok()?.motion, blocks, model)
    };
    let sources: Vec<&Source> = inventory.sources().collect();
    Ok(sources.into_par_iter().filter_map(of_unit).collect())
}

type Blocks<'b> = HashMap<(&'b str, &'b str), Vec<Block<'b>>>;

fn blocks(batches: &[RecordBatch]) -> Result<Blocks<'_>, Fault> {
    let mut of_run: Blocks = HashMap::new();
    for batch in batches {
        let column = |name: &str| {
            batch.column_by_name(name).ok_or_else(|| Fault::Failed(format!("the answer has no column {name}")))
        };
        let (stores, runs): (&StringArray, &StringArray) = (column("store")?.as_string(), column("run")?.as_string());
        let (slowest, fastest) = (column("slowest")?.as_primitive::<Float64Type>(), column("fastest")?.as_primitive());
        let grams: &ListArray = column("gram")?.as_list();
        for row in 0..batch.num_rows() {
            let block = block(grams, slowest, fastest, row);
            of_run.entry((stores.value(row), runs.value(row))).or_default().push(block);
        }
    }
    Ok(of_run)
}

fn block<'b>(grams: &'b ListArray, slowest: &Float64Array, fastest: &Float64Array, row: usize) -> Block<'b> {
    let offsets = grams.value_offsets();
    let range = offsets[row] as usize..offsets[row + 1] as usize;
    let gram = grams.is_valid(row).then(|| &grams.values().as_primitive::<Float64Type>().values()[range]);
    Block { velocity: [slowest.value(row), fastest.value(row)], gram }
}

/// `None` where only the fit of the daemon decides: absent values, few points, one direction, dependent columns.
fn unit_fit(unit: &Unit, motion: Motion, blocks: &[Block], model: &ModelSpec) -> Option<UnitFit> {
    let fastest = blocks.iter().map(Block::speed).fold(0.0, f64::max);
    let is_moving = |block: &&Block| block.speed() > AT_REST * fastest;
    let mut moving: Vec<&Block> = blocks.iter().filter(is_moving).collect();
    let directions = [1.0, -1.0].map(|sign| moving.iter().any(|b| b.velocity.iter().any(|v| v * sign > 0.0)));
    if blocks.len() < FEWEST_ROWS || moving.len() < FEWEST_MOVING || directions != [true, true] {
        return None;
    }
    // The order of the groups depends on threads; sums are reproducible in the order of the velocity.
    let key = |block: &Block| (block.velocity[0], block.gram.map_or(0.0, |gram| gram[1]));
    moving.sort_by(|a, b| key(a).0.total_cmp(&key(b).0).then(key(a).1.total_cmp(&key(b).1)));
    let states: Vec<&[f64]> = moving.iter().map(|block| block.gram).collect::<Option<_>>()?;
    let p = model.effects.len();
    if is_constant(&states, p) {
        return None;
    }
    let grams = BlockGrams::of_moments(states.iter().copied(), p);
    let (values, half_widths, squares) = solve(&grams, p)?;
    let parameter = |(k, id): (usize, &String)| {
        let info = model.find(id).ok()?.info();
        let known = info.parameters.first()?;
        Some(UnitParameter {
            effect: id.clone(),
            name: known.name.to_string(),
            unit: motion.label(&known.unit),
            value: values[k],
            ci95: [values[k] - half_widths[k], values[k] + half_widths[k]],
        })
    };
    let parameters = model.effects.iter().enumerate().map(parameter).collect::<Option<_>>()?;
    let rms = (squares / states.len() as f64).sqrt();
    Some(UnitFit { unit: unit.clone(), rows: states.len(), rms, rms_unit: motion.label("Nm"), parameters })
}

fn is_constant(states: &[&[f64]], columns: usize) -> bool {
    let mut whole = vec![0.0; moments::length(1 + columns)];
    states.iter().for_each(|state| moments::merge(&mut whole, state, 1 + columns));
    let (rows, mean, scatter) = (whole[0], whole[1], whole[2 + columns]);
    (scatter / rows).sqrt() <= CONSTANT * mean.abs()
}

/// Coefficients, half widths of their 95 % intervals and the sum of squared residuals. `None` for dependent columns.
///
/// Delete-one-block jackknife about the full estimate with Student's t over the effective number of blocks, as in the
/// daemon (MacKinnon, Nielsen, Webb 2023; Carter, Schnepel, Steigerwald 2017).
fn solve(grams: &BlockGrams, p: usize) -> Option<(Vec<f64>, Vec<f64>, f64)> {
    let (xx, xy) = grams.total();
    let whole = Cholesky::new(&xx, p, 0.0);
    if (0..p).any(|k| whole.is_dependent(k)) {
        return None;
    }
    let values = whole.solve(&xy);
    let replicates = grams.jackknife();
    let groups = replicates.len() as f64;
    let effective = grams.effective_groups(&whole);
    let half_width = |k: usize| {
        let squares: f64 = replicates.iter().map(|replicate| (replicate[k] - values[k]).powi(2)).sum();
        student_95((effective[k] - 1.0).max(1.0)) * ((groups - 1.0) / groups * squares).sqrt()
    };
    let explained: f64 = values.iter().zip(&xy).map(|(value, side)| value * side).sum();
    let squares = (grams.squares() - explained).max(0.0);
    let half_widths = (0..p).map(half_width).collect();
    Some((values, half_widths, squares))
}
