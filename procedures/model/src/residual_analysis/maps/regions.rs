//! The worst regions of the maps, as sentences with figures.

use crate::effects::friction::coulomb;
use crate::report::diagnosis::NoiseFloor;
use crate::report::fit::{Fit, ParameterState};
use crate::report::maps::Region;
use crate::residual_analysis::maps::Maps;
use crate::residual_analysis::maps::binned_axis::BinnedAxis;
use crate::residual_analysis::maps::map::{Cell, Map};
use crate::thresholds::{AT_REST, AXIS_DOMINATES, AXIS_SHADOW, REGION_OVERLAP, REGION_WORSE};
use crate::words::{direction_text, figure, percent, spoken_axis};
use jointbench_instrument::Kind;

/// Largest number of reported regions.
const MOST: usize = 8;

/// The reference magnitude of an error in a sentence.
pub struct ReferenceMagnitude {
    value: f64,
    /// `the Coulomb friction`, `the noise`.
    what: &'static str,
}

impl ReferenceMagnitude {
    /// `18 % of the Coulomb friction`, `35 times the noise`.
    pub fn compare(&self, size: f64) -> String {
        match size / self.value {
            times if times >= 9.95 => format!("{times:.0} times {}", self.what),
            times if times >= 1.995 => format!("{times:.1} times {}", self.what),
            share => format!("{} of {}", percent(share), self.what),
        }
    }
}

/// Coulomb friction if the run identifies it, otherwise the noise floor.
pub fn reference(fit: &Fit, floor: Option<&NoiseFloor>) -> Option<ReferenceMagnitude> {
    let coulomb =
        fit.parameters.iter().find(|p| p.effect == coulomb::ID && p.value > 0.0 && p.state == ParameterState::Ok);
    let coulomb = coulomb.map(|p| ReferenceMagnitude { value: p.value, what: "the Coulomb friction" });
    coulomb.or_else(|| {
        let value = floor?.rms.filter(|rms| *rms > 0.0)?;
        Some(ReferenceMagnitude { value, what: "the noise" })
    })
}

/// Neighbouring cells of one sign that all exceed their bands.
struct Stretch<'m> {
    map: &'m Map,
    first: usize,
    last: usize,
    y: usize,
    mean: f64,
    half_width: f64,
    count: usize,
}

pub fn regions(maps: &Maps, unit: &str, reference: Option<&ReferenceMagnitude>) -> Vec<Region> {
    let mut stretches: Vec<Stretch> = maps.axes.iter().chain(&maps.by_direction).flat_map(|m| join(maps, m)).collect();
    if let Some(best) = unbanded(maps) {
        stretches.retain(|stretch| stretch.map.explained_share > AXIS_SHADOW * best.explained_share);
    }
    stretches.sort_by(|a, b| b.weight().total_cmp(&a.weight()));
    // A region over time usually follows from another axis, which is reported first.
    stretches.sort_by_key(|stretch| stretch.map.x.name == "time_s");
    let mut reported: Vec<(&Stretch, Vec<usize>)> = Vec::new();
    for stretch in &stretches {
        let rows = stretch.rows();
        let again = |(other, known): &(&Stretch, Vec<usize>)| {
            let no_worse = stretch.mean / other.mean < REGION_WORSE && stretch.mean * other.mean > 0.0;
            no_worse && inside(&rows, known) >= REGION_OVERLAP
        };
        if reported.len() < MOST && !reported.iter().any(again) {
            reported.push((stretch, rows));
        }
    }
    reported.sort_by(|(a, _), (b, _)| b.weight().total_cmp(&a.weight()));
    reported.iter().map(|(stretch, _)| stretch.region(maps.kind, unit, reference)).collect()
}

/// The dominating map, if none of the bins of its axis has enough blocks for a band. Regions over other axes are then
/// only a consequence of it.
fn unbanded(maps: &Maps) -> Option<&Map> {
    let best = maps.best().filter(|best| best.explained_share > AXIS_DOMINATES)?;
    let mut of_axis = maps.axes.iter().chain(&maps.by_direction).filter(|map| map.x.name == best.x.name);
    of_axis.all(|map| map.cells.iter().all(|cell| maps.half_width(cell).is_none())).then_some(best)
}

/// Why no region is reported, with the part of an axis that is closest to significance.
pub fn nowhere(maps: &Maps, unit: &str) -> String {
    let of = |map: &Map, cell: &Cell, half_width: f64| {
        let (mean, count) = (cell.mean, cell.rows);
        Stretch { map, first: cell.x, last: cell.x, y: cell.y, mean, half_width, count }.region(maps.kind, unit, None)
    };
    if let Some(best) = unbanded(maps) {
        let worst = best.cells.iter().max_by(|a, b| a.mean.abs().total_cmp(&b.mean.abs()));
        return format!(
            ", though a function of {} would remove {} of the squared error: fewer than three independent blocks cover each \
             part of it. The residual is largest where {}",
            spoken_axis(&best.x.name, maps.kind),
            percent(best.explained_share),
            worst.map(|cell| of(best, cell, 0.0).sentence).unwrap_or_default(),
        );
    }
    let cells =
        maps.axes.iter().chain(&maps.by_direction).flat_map(|map| map.cells.iter().map(move |cell| (map, cell)));
    let banded = cells.filter_map(|(map, cell)| Some((map, cell, maps.half_width(cell)?)));
    let beyond = |(_, cell, half_width): &(&Map, &Cell, f64)| cell.mean.abs() / half_width.max(f64::MIN_POSITIVE);
    let Some((map, cell, half_width)) = banded.max_by(|a, b| beyond(a).total_cmp(&beyond(b))) else {
        return ", because no part is covered by three independent blocks".into();
    };
    format!(
        "; closest to significance, {} (±{} from {} independent blocks)",
        of(map, cell, half_width).sentence,
        figure(half_width, unit),
        cell.blocks,
    )
}

/// Share of the rows that are in `others`, which are in rising order.
fn inside(rows: &[usize], others: &[usize]) -> f64 {
    let shared = rows.iter().filter(|row| others.binary_search(row).is_ok()).count();
    shared as f64 / rows.len().max(1) as f64
}

/// Joins neighbouring cells: the mean of the means lies within the mean of their bands.
fn join<'m>(maps: &Maps, map: &'m Map) -> Vec<Stretch<'m>> {
    let mut out: Vec<Stretch> = Vec::new();
    let mut cells: Vec<&Cell> = map.cells.iter().collect();
    cells.sort_by_key(|c| (c.y, c.x));
    for cell in cells {
        let Some(half_width) = maps.half_width(cell).filter(|h| cell.mean.abs() > *h) else { continue };
        let adjacent = |s: &&mut Stretch| s.y == cell.y && s.last + 1 == cell.x && s.mean * cell.mean > 0.0;
        match out.last_mut().filter(adjacent) {
            Some(s) => {
                let (n, more) = (s.count as f64, cell.rows as f64);
                s.mean = (s.mean * n + cell.mean * more) / (n + more);
                s.half_width = (s.half_width * n + half_width * more) / (n + more);
                s.count += cell.rows;
                s.last = cell.x;
            }
            None => {
                let (mean, count) = (cell.mean, cell.rows);
                out.push(Stretch { map, first: cell.x, last: cell.x, y: cell.y, mean, half_width, count });
            }
        }
    }
    out
}

impl Stretch<'_> {
    /// Squared error that the region explains.
    fn weight(&self) -> f64 {
        self.mean.powi(2) * self.count as f64
    }

    fn rows(&self) -> Vec<usize> {
        let inside = |row: &usize| {
            let side = self.map.y.as_ref().is_none_or(|y| y.bin[*row] == self.y);
            side && (self.first..=self.last).contains(&self.map.x.bin[*row])
        };
        (0..self.map.x.bin.len()).filter(inside).collect()
    }

    fn region(&self, kind: Kind, unit: &str, reference: Option<&ReferenceMagnitude>) -> Region {
        let x = &self.map.x;
        let (from, to) = (x.bins[self.first].from, x.bins[self.last].to);
        let direction = self.map.y.as_ref().map(|y| if y.bins[self.y].centre > 0.0 { "positive" } else { "negative" });
        let side = if self.mean > 0.0 { "low" } else { "high" };
        let measure = reference.map_or_else(String::new, |y| format!(", {}", y.compare(self.mean.abs())));
        let motion = direction.map_or_else(String::new, |d| format!(" {}", direction_text(kind, d == "positive")));
        Region {
            axis: x.name.clone(),
            from,
            to,
            mean_residual: self.mean,
            ci95: [self.mean - self.half_width, self.mean + self.half_width],
            samples: self.count,
            direction: direction.map(Into::into),
            sentence: format!(
                "the model is {} too {side} {}{motion}{measure}",
                figure(self.mean.abs(), unit),
                self.place(kind, x)
            ),
        }
    }

    /// `at rest`, `below 9.0 rad/s`, `near 2.4 Nm`, `between a link position of 1.1 rad and 1.3 rad`.
    fn place(&self, kind: Kind, x: &BinnedAxis) -> String {
        if x.name == "direction" {
            return direction_text(kind, x.bins[self.first].centre > 0.0).into();
        }
        let (from, to) = (x.bins[self.first].from, x.bins[self.last].to);
        if x.name == "repeat" {
            return if from == to { format!("in repeat {from}") } else { format!("in repeats {from} to {to}") };
        }
        // Rounding of a computed signal is zero.
        let widest = x.bins.iter().flat_map(|bin| [bin.from.abs(), bin.to.abs()]).fold(0.0, f64::max);
        if x.name.ends_with("velocity_rad_s") && from.abs().max(to.abs()) < AT_REST * widest {
            return "at rest".into();
        }
        let say = |value: f64| figure(if value.abs() < f64::EPSILON * widest { 0.0 } else { value }, &x.unit);
        let quantity = spoken_axis(&x.name, kind);
        let article = if quantity.starts_with(['a', 'e', 'i', 'o']) { "an" } else { "a" };
        let one = format!("{article} {quantity}");
        let end = x.bins.len() - 1;
        let is_narrow = self.first == self.last && (to - from).abs() < 0.03 * (to + from).abs() / 2.0;
        if is_narrow || say(from) == say(to) {
            return format!("at {one} of about {}", say(x.bins[self.first].centre));
        }
        match (self.first == 0, self.last == end) {
            (true, true) => format!("on average over the {quantity}"),
            (true, false) => format!("at {one} below {}", say(to)),
            (false, true) => format!("at {one} above {}", say(from)),
            (false, false) => format!("at {one} between {} and {}", say(from), say(to)),
        }
    }
}
