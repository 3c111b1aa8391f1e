//! Residual maps: the residual over one or two axes, with bands that hold for all cells of all maps together.

pub(crate) mod binned_axis;
pub(crate) mod map;
pub(crate) mod public;
pub(crate) mod regions;

use crate::residual_analysis::maps::regions::ReferenceMagnitude;
use crate::thresholds::SAME_SHAPE;

use crate::Options;
use crate::preprocess::independent_blocks::independent_blocks;
use crate::preprocess::{Prepared, Problem};
use crate::report::maps::{PairMap, Region};
use crate::residual_analysis::maps::binned_axis::{BinnedAxis, scales};
use crate::residual_analysis::maps::map::{Cell, Map};
use jointbench_instrument::Kind;

/// All maps of one residual.
pub struct Maps {
    scales: Vec<BinnedAxis>,
    axes: Vec<Map>,
    /// Maps of position, load, temperature and unknown columns by direction. Friction changes its sign with the
    /// direction, so that structure can cancel in a map over both directions.
    by_direction: Vec<Map>,
    block: Vec<usize>,
    residual: Vec<f64>,
    alpha: f64,
    cells: usize,
    kind: Kind,
}

/// Bins of each axis of a map over two axes.
const PAIR_BINS: usize = 12;
/// Axes that are combined in pairs for the map of unexplained structure.
const PARTNERS: usize = 5;

impl Maps {
    /// `residual` is the residual of the model at the rows of the main problem.
    pub fn new(prepared: &Prepared, residual: Vec<f64>, options: &Options) -> Self {
        let problem = &prepared.main;
        let (block, _) = independent_blocks(problem, 1);
        let scales = scales(prepared);
        let map = |x: &BinnedAxis, y: Option<&BinnedAxis>| Map::new(x.clone(), y.cloned(), problem, &block, &residual);
        let axes: Vec<Map> = scales.iter().map(|s| map(s, None)).collect();
        let known = ["link_torque_nm", "brake_current_a", "temperature_c"];
        let unknown: Vec<&str> = problem.view.points.unknown().map(|s| prepared.column_name(s)).collect();
        let sides = |name: &str| name.contains("position_rad") || known.contains(&name) || unknown.contains(&name);
        let by_direction: Vec<Map> = match scales.iter().find(|s| s.name == "direction") {
            Some(direction) => scales.iter().filter(|s| sides(&s.name)).map(|s| map(s, Some(direction))).collect(),
            None => Vec::new(),
        };
        let cells = axes.iter().chain(&by_direction).map(|m| m.cells.len()).sum();
        Self { scales, axes, by_direction, block, residual, alpha: options.alpha, cells, kind: prepared.kind }
    }

    /// Cross-validated R² of the best map, with its axis.
    pub fn explained_share(&self) -> Option<(&str, f64)> {
        self.best().map(|m| (m.x.name.as_str(), m.explained_share))
    }

    /// The same with both axes of a map by direction.
    pub fn shows_over(&self) -> Option<(Vec<String>, f64)> {
        let names = |m: &Map| std::iter::once(&m.x).chain(&m.y).map(|scale| scale.name.clone()).collect();
        self.best().map(|m| (names(m), m.explained_share))
    }

    fn best(&self) -> Option<&Map> {
        self.axes.iter().chain(&self.by_direction).max_by(|a, b| a.ranking_score().total_cmp(&b.ranking_score()))
    }

    /// Cross-validated R² of a free function of an axis on this residual. `None` if `contribution` is not a function
    /// of that axis.
    pub fn any_function(&self, contribution: &Maps, axis: &str) -> Option<f64> {
        let own = contribution.axes.iter().chain(&contribution.by_direction);
        let pairs = own.zip(self.axes.iter().chain(&self.by_direction));
        let same = pairs.filter(|(own, _)| own.x.name == axis && own.explained_share > SAME_SHAPE);
        same.map(|(_, map)| map.explained_share).max_by(f64::total_cmp)
    }

    /// Indicator columns of every bin of an axis in each direction; their sums represent any function of the axis.
    pub fn functions(&self, axis: &str) -> Vec<Vec<f64>> {
        let scale = |name: &str| self.scales.iter().find(|s| s.name == name);
        let Some(of) = scale(axis) else { return Vec::new() };
        let direction = scale("direction").filter(|d| d.name != axis);
        let sides = direction.map_or(1, |d| d.bins.len());
        let mut columns = vec![vec![0.0; self.residual.len()]; of.bins.len() * sides];
        for (row, bin) in of.bin.iter().enumerate() {
            columns[bin * sides + direction.map_or(0, |d| d.bin[row])][row] = 1.0;
        }
        columns
    }

    /// Half width of the band of a cell, simultaneous for the cells of all axes.
    fn half_width(&self, cell: &Cell) -> Option<f64> {
        cell.half_width(self.alpha, self.cells)
    }

    /// Whether a part of an axis is significant against the scatter of the blocks.
    pub fn is_significant(&self) -> bool {
        self.axes.iter().chain(&self.by_direction).any(|map| self.map_is_significant(map))
    }

    /// The same for axes that do not correlate with time. Along time the blocks of one bin are neighbours and may be
    /// correlated.
    pub fn is_significant_beyond_time(&self) -> bool {
        let maps = self.axes.iter().chain(&self.by_direction);
        maps.filter(|map| !map.x.correlates_with_time()).any(|map| self.map_is_significant(map))
    }

    fn map_is_significant(&self, map: &Map) -> bool {
        map.cells.iter().any(|cell| self.half_width(cell).is_some_and(|half_width| cell.mean.abs() > half_width))
    }

    /// RMS of the block means, weighted by their rows.
    pub fn between_rms(&self) -> f64 {
        let mut at = 0;
        let squares = self.block.chunk_by(|a, b| a == b).map(|rows| {
            at += rows.len();
            self.residual[at - rows.len()..at].iter().sum::<f64>().powi(2) / rows.len() as f64
        });
        (squares.sum::<f64>() / self.residual.len() as f64).sqrt()
    }

    /// Regions with a significant residual, the worst first.
    pub fn regions(&self, unit: &str, reference: Option<&ReferenceMagnitude>) -> Vec<Region> {
        regions::regions(self, unit, reference)
    }

    /// Why there is no such region.
    pub fn nowhere(&self, unit: &str) -> String {
        regions::nowhere(self, unit)
    }

    /// The residual over the two axes with most structure: of the pairs of the best-ranked axes, the one with the
    /// largest cross-validated R².
    pub fn structure(&self, problem: &Problem) -> Option<PairMap> {
        // An axis is ranked by its map or by its map by direction, because structure of both directions can cancel.
        let ranking_score = |axis: &Map| {
            let sides = self.by_direction.iter().filter(|m| m.x.name == axis.x.name);
            sides.map(Map::ranking_score).fold(axis.ranking_score(), f64::max)
        };
        let mut ranked: Vec<&Map> = self.axes.iter().filter(|m| m.x.name != "direction").collect();
        ranked.sort_by(|a, b| ranking_score(b).total_cmp(&ranking_score(a)));
        ranked.truncate(PARTNERS);
        let direction = self.scales.iter().find(|s| s.name == "direction");
        let (mut best, mut cells): (Option<Map>, usize) = (None, self.cells);
        for (i, a) in ranked.iter().enumerate() {
            let partners = ranked[i + 1..].iter().map(|m| &m.x);
            // The direction is not combined with the velocity, because it is the sign of the velocity.
            for y in partners.chain(direction.filter(|_| !a.x.name.contains("velocity"))) {
                let pair = self.pair(&a.x, y, problem);
                cells += pair.cells.len();
                if best.as_ref().is_none_or(|b| pair.ranking_score() > b.ranking_score()) {
                    best = Some(pair);
                }
            }
        }
        best.map(|m| self.public_pair(&m, cells))
    }

    fn pair(&self, x: &BinnedAxis, y: &BinnedAxis, problem: &Problem) -> Map {
        // An angle keeps its fine bins if the second axis is the direction: structure over an angle can be narrow.
        let x = if y.bins.len() > 2 { x.coarse(PAIR_BINS) } else { x.clone() };
        Map::new(x, Some(y.coarse(PAIR_BINS)), problem, &self.block, &self.residual)
    }
}
