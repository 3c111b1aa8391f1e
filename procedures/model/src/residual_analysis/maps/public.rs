//! All maps of a fit on a run, for display.

use crate::prediction::{predict, prepare_alike};
use crate::report::fit::Fit;
use crate::report::maps::{AxisMap, MapBin, MapCell, PairMap, ResidualMaps};
use crate::residual_analysis::maps::Maps;
use crate::residual_analysis::maps::map::Map;
use crate::residual_analysis::maps::regions::reference;
use crate::{ModelError, Options};
use jointbench_instrument::RunTable;

/// The residual of a fit on a run over every axis of the run, and over selected pairs of axes.
///
/// The run is preprocessed as for the fit, so that a fit can be mapped on any run of its kind. Only `alpha` of
/// `options` is used: the bands hold for all bins of all maps together with that error probability.
pub fn maps(run: &RunTable, fit: &Fit, options: &Options) -> Result<ResidualMaps, ModelError> {
    options.check()?;
    let prepared = prepare_alike(fit, run)?;
    let predicted = predict(fit, prepared.judged(&fit.effects))?;
    let residual: Vec<f64> = prepared.main.target.iter().zip(predicted).map(|(y, p)| y - p).collect();
    let mut maps = Maps::new(&prepared, residual, options);
    let axis = |part: &str| maps.scales.iter().find(|s| s.name.contains(part));
    let speed = axis("velocity").map(|v| v.size("speed"));
    let mut chosen = vec![(speed.as_ref(), axis("direction"))];
    chosen.extend(["link_torque", "temperature", "brake_current"].map(|x| (axis(x), axis("velocity"))));
    let chosen_pairs: Vec<Map> =
        chosen.into_iter().filter_map(|(x, y)| Some(maps.pair(x?, y?, &prepared.main))).collect();
    maps.cells += chosen_pairs.iter().map(|m| m.cells.len()).sum::<usize>();
    let unit = prepared.unit();
    Ok(ResidualMaps {
        residual: prepared.about.residual,
        axes: maps.axes.iter().map(|m| maps.public_axis(m)).collect(),
        pairs: maps.by_direction.iter().chain(&chosen_pairs).map(|m| maps.public_pair(m, maps.cells)).collect(),
        regions: maps.regions(&unit, reference(fit, None).as_ref()),
        unit,
    })
}

impl Maps {
    fn public_axis(&self, map: &Map) -> AxisMap {
        let bin = |c: &crate::residual_analysis::maps::map::Cell| {
            let b = map.x.bins[c.x];
            MapBin {
                from: b.from,
                to: b.to,
                centre: b.centre,
                mean: c.mean,
                half_width: self.half_width(c),
                rows: c.rows,
            }
        };
        AxisMap {
            axis: map.x.name.clone(),
            unit: map.x.unit.clone(),
            bins: map.cells.iter().map(bin).collect(),
            removable_share: map.explained_share,
        }
    }

    /// With bands that hold for `many` cells together.
    pub(crate) fn public_pair(&self, map: &Map, many: usize) -> PairMap {
        let ranges = |scale: &crate::residual_analysis::maps::binned_axis::BinnedAxis| {
            scale.bins.iter().map(|b| [b.from, b.to]).collect::<Vec<_>>()
        };
        let y = map.y.as_ref();
        PairMap {
            x: map.x.name.clone(),
            x_unit: map.x.unit.clone(),
            y: y.map(|y| y.name.clone()).unwrap_or_default(),
            y_unit: y.map(|y| y.unit.clone()).unwrap_or_default(),
            x_bins: ranges(&map.x),
            y_bins: y.map(ranges).unwrap_or_default(),
            cells: map
                .cells
                .iter()
                .map(|c| MapCell {
                    x: c.x,
                    y: c.y,
                    mean: c.mean,
                    half_width: c.half_width(self.alpha, many),
                    rows: c.rows,
                })
                .collect(),
            removable_share: map.explained_share,
        }
    }
}
