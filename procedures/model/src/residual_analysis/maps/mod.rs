//! Residual maps: where the model fails, with bands that hold for all cells of all maps together.

pub(crate) mod binned_axis;
pub(crate) mod map;
pub(crate) mod public;
pub(crate) mod regions;

use crate::residual_analysis::maps::regions::ReferenceMagnitude;
use crate::thresholds::{AXIS_FUNCTION, SCATTER_BAND};

use crate::Options;
use crate::preprocess::independent_blocks::pieces;
use crate::preprocess::{Prepared, Problem};
use crate::report::maps::{PairMap, Region};
use crate::residual_analysis::maps::binned_axis::{BinnedAxis, scales};
use crate::residual_analysis::maps::map::{Cell, Map};
use jointbench_instrument::Kind;

/// All maps of one residual.
pub struct Maps {
    scales: Vec<BinnedAxis>,
    axes: Vec<Map>,
    /// Position, load, temperature and what no effect knows by direction: friction changes its sign with the motion, and what a
    /// direction hides from the other is seen here.
    by_direction: Vec<Map>,
    piece: Vec<usize>,
    residual: Vec<f64>,
    alpha: f64,
    cells: usize,
    kind: Kind,
}

/// Bins of each axis of a map over two.
const PAIR_BINS: usize = 12;
/// Axes that are tried against each other for the picture of what no effect explains.
const PARTNERS: usize = 5;

impl Maps {
    /// `residual` is what the model leaves at the rows of the main problem.
    pub fn new(prepared: &Prepared, residual: Vec<f64>, options: &Options) -> Self {
        let problem = &prepared.main;
        let (piece, _) = pieces(problem, 1);
        let scales = scales(prepared);
        let map = |x: &BinnedAxis, y: Option<&BinnedAxis>| Map::new(x.clone(), y.cloned(), problem, &piece, &residual);
        let axes: Vec<Map> = scales.iter().map(|s| map(s, None)).collect();
        let known = ["link_torque_nm", "brake_current_a", "temperature_c"];
        let unknown: Vec<&str> = problem.view.points.unknown().map(|s| prepared.column_name(s)).collect();
        let sides = |name: &str| name.contains("position_rad") || known.contains(&name) || unknown.contains(&name);
        let by_direction: Vec<Map> = match scales.iter().find(|s| s.name == "direction") {
            Some(direction) => scales.iter().filter(|s| sides(&s.name)).map(|s| map(s, Some(direction))).collect(),
            None => Vec::new(),
        };
        let cells = axes.iter().chain(&by_direction).map(|m| m.cells.len()).sum();
        Self { scales, axes, by_direction, piece, residual, alpha: options.alpha, cells, kind: prepared.kind }
    }

    /// Share of the squared error that the best map would take off held-out data, with its axis.
    pub fn removable(&self) -> Option<(&str, f64)> {
        self.best().map(|m| (m.x.name.as_str(), m.removable))
    }

    /// The same with both axes of a map by direction.
    pub fn shows_over(&self) -> Option<(Vec<String>, f64)> {
        let names = |m: &Map| std::iter::once(&m.x).chain(&m.y).map(|scale| scale.name.clone()).collect();
        self.best().map(|m| (names(m), m.removable))
    }

    fn best(&self) -> Option<&Map> {
        self.axes.iter().chain(&self.by_direction).max_by(|a, b| a.telling().total_cmp(&b.telling()))
    }

    /// What any function of an axis would take off this residual. `None` where `contribution` is no function of that axis.
    pub fn any_function(&self, contribution: &Maps, axis: &str) -> Option<f64> {
        let own = contribution.axes.iter().chain(&contribution.by_direction);
        let pairs = own.zip(self.axes.iter().chain(&self.by_direction));
        let same = pairs.filter(|(own, _)| own.x.name == axis && own.removable > AXIS_FUNCTION);
        same.map(|(_, map)| map.removable).max_by(f64::total_cmp)
    }

    /// A column for every bin of an axis in each direction: any function of it is a sum of these.
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

    /// Half of the band of a cell, where it has one, together with the cells of all axes.
    fn half_width(&self, cell: &Cell) -> Option<f64> {
        cell.half_width(self.alpha, self.cells)
    }

    /// Some part of an axis stands out of what the pieces of the run scatter by.
    pub fn stand_out(&self) -> bool {
        self.axes.iter().chain(&self.by_direction).any(|map| self.stands_out(map))
    }

    /// The same of an axis that is not the time and does not grow with it: there the pieces of one part are neighbours, which may
    /// resemble each other.
    pub fn stand_out_beside_time(&self) -> bool {
        let maps = self.axes.iter().chain(&self.by_direction);
        maps.filter(|map| !map.x.goes_with_time()).any(|map| self.stands_out(map))
    }

    fn stands_out(&self, map: &Map) -> bool {
        let half_width = |cell: &Cell| cell.half_width(SCATTER_BAND * self.alpha, self.cells);
        map.cells.iter().any(|cell| half_width(cell).is_some_and(|half_width| cell.mean.abs() > half_width))
    }

    /// RMS of the means of the pieces, each counted with its rows.
    pub fn between_rms(&self) -> f64 {
        let mut at = 0;
        let squares = self.piece.chunk_by(|a, b| a == b).map(|rows| {
            at += rows.len();
            self.residual[at - rows.len()..at].iter().sum::<f64>().powi(2) / rows.len() as f64
        });
        (squares.sum::<f64>() / self.residual.len() as f64).sqrt()
    }

    /// Regions in which the residual is not noise, the worst first.
    pub fn regions(&self, unit: &str, yardstick: Option<&ReferenceMagnitude>) -> Vec<Region> {
        regions::regions(self, unit, yardstick)
    }

    /// Why there is none.
    pub fn nowhere(&self, unit: &str) -> String {
        regions::nowhere(self, unit)
    }

    /// The residual over the two axes where it shows most: of the pairs among the most telling axes, the one whose
    /// means take most off held-out rows.
    pub fn structure(&self, problem: &Problem) -> Option<PairMap> {
        // An axis is as telling as its map, or as its map by direction: what one direction hides from the other cancels alone.
        let telling = |axis: &Map| {
            let sides = self.by_direction.iter().filter(|m| m.x.name == axis.x.name);
            sides.map(Map::telling).fold(axis.telling(), f64::max)
        };
        let mut ranked: Vec<&Map> = self.axes.iter().filter(|m| m.x.name != "direction").collect();
        ranked.sort_by(|a, b| telling(b).total_cmp(&telling(a)));
        ranked.truncate(PARTNERS);
        let direction = self.scales.iter().find(|s| s.name == "direction");
        let (mut best, mut cells): (Option<Map>, usize) = (None, self.cells);
        for (i, a) in ranked.iter().enumerate() {
            let partners = ranked[i + 1..].iter().map(|m| &m.x);
            // The sign of the velocity is no second axis beside the velocity.
            for y in partners.chain(direction.filter(|_| !a.x.name.contains("velocity"))) {
                let pair = self.pair(&a.x, y, problem);
                cells += pair.cells.len();
                if best.as_ref().is_none_or(|b| pair.telling() > b.telling()) {
                    best = Some(pair);
                }
            }
        }
        best.map(|m| self.public_pair(&m, cells))
    }

    fn pair(&self, x: &BinnedAxis, y: &BinnedAxis, problem: &Problem) -> Map {
        // An angle keeps its fine bins beside two directions: what it hides is narrow.
        let x = if y.bins.len() > 2 { x.coarse(PAIR_BINS) } else { x.clone() };
        Map::new(x, Some(y.coarse(PAIR_BINS)), problem, &self.piece, &self.residual)
    }
}
