//! Search ranges of nonlinear parameters that the user did not define.

use crate::effect::{Shape, ShapeSearch};
use crate::formula::signals::NamedSignal;
use crate::user_effects::definition::UserParameter;
use crate::view::View;

/// Starting points for one, two and more parameters of an effect.
const POINTS: [usize; 3] = [10, 5, 3];

/// The range of a parameter. A missing bound is derived from the largest value of a signal in the same unit, or from
/// 1: three decades below it and one above. Negative values require a negative bound.
pub fn shape<'e>(parameter: &'e UserParameter, signals: &[NamedSignal], view: &View) -> Shape<'e> {
    let same = signals.iter().filter(|s| s.unit == parameter.unit).map(|s| view.peak(s.signal));
    let size = Some(same.fold(0.0, f64::max)).filter(|peak| *peak > 0.0).unwrap_or(1.0);
    let signed = parameter.min.is_some_and(|min| min < 0.0) || parameter.max.is_some_and(|max| max <= 0.0);
    let search = match (parameter.whole, signed) {
        (true, _) => ShapeSearch::Whole,
        (false, true) => ShapeSearch::Signed,
        (false, false) => ShapeSearch::Smooth,
    };
    let (min, max) = match (parameter.min, parameter.max) {
        (Some(min), Some(max)) => (min, max),
        (Some(min), None) => (min, min.abs().max(size) * 10.0),
        (None, Some(max)) if max > 0.0 => (1e-4 * max, max),
        (None, Some(max)) => (max - 10.0 * max.abs().max(size), max),
        (None, None) => (1e-3 * size, 10.0 * size),
    };
    // Zero has no logarithm.
    let min = if search == ShapeSearch::Smooth { min.max(1e-4 * max) } else { min };
    Shape { name: &parameter.name, min, max, search }
}

/// Starting points of all nonlinear parameters together. `starts` is the user's range of starting points for each.
pub fn grid(shapes: &[Shape], starts: impl Iterator<Item = Option<[f64; 2]>>) -> Vec<Vec<f64>> {
    let each = POINTS[shapes.len().clamp(1, POINTS.len()) - 1];
    shapes.iter().zip(starts).fold(vec![Vec::new()], |grid, (shape, start)| {
        let values = points(shape, start, each);
        grid.iter().flat_map(|start| values.iter().map(move |v| [start.as_slice(), &[*v]].concat())).collect()
    })
}

fn points(shape: &Shape, start: Option<[f64; 2]>, count: usize) -> Vec<f64> {
    let [low, high] = start.unwrap_or([shape.min, shape.max]).map(|v| v.clamp(shape.min, shape.max));
    match shape.search {
        ShapeSearch::Whole => (low.ceil() as i64..=high as i64).map(|i| i as f64).collect(),
        _ if low == high => vec![low],
        ShapeSearch::Smooth => crate::effects::log_grid(low, high, count),
        _ => (0..count).map(|i| low + (high - low) * i as f64 / (count - 1) as f64).collect(),
    }
}
