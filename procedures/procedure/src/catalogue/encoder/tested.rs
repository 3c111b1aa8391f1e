//! Tested tolerance: how far the sensor may be from its nominal position in any direction of an
//! axis.

use super::edges::{DIRECTIONS, Direction, Found};
use crate::findings::quantity;
use crate::identification::Quantity;

/// The largest distance up to which the periods were consistent at each position of the search, in all directions of
/// one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tested {
    pub good: f64,
    /// Nearest distance with inconsistent periods; `None` if the search met none.
    bad: Option<f64>,
}

impl Tested {
    /// `None` if the run lacks a direction of this axis.
    pub fn of(found: &[(&Direction, Found)], axis: &Direction) -> Option<Self> {
        let is_of_axis = |direction: &Direction| direction.is_opposite(axis) || direction.title == axis.title;
        let searched: Vec<&Found> =
            found.iter().filter(|(direction, _)| is_of_axis(direction)).map(|(_, found)| found).collect();
        if searched.len() < DIRECTIONS.iter().filter(|direction| is_of_axis(direction)).count() {
            return None;
        }
        let good = searched.iter().map(|found| found.good.abs()).fold(f64::INFINITY, f64::min);
        let bad = searched.iter().filter_map(|found| found.bad).map(f64::abs).min_by(f64::total_cmp);
        Some(Self { good, bad })
    }
}

/// One for each axis, with the tolerance of the data sheet in its title. The limit lies between the tested tolerance and
/// the nearest inconsistent position.
pub fn quantities(found: &[(&Direction, Found)]) -> Vec<Quantity> {
    let of = |(i, axis): (usize, &Direction)| {
        if DIRECTIONS[..i].iter().any(|earlier| earlier.is_opposite(axis)) {
            return None;
        }
        let tested = Tested::of(found, axis)?;
        let (name, title) = axis.axis();
        let title = format!("{title}: tested tolerance (data sheet: {})", axis.length(axis.manufacturing));
        let ends = tested.bad.map(|bad| [tested.good, bad]);
        Some(quantity([&format!("tested_{name}"), "", &title, axis.unit()], tested.good, ends))
    };
    DIRECTIONS.iter().enumerate().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(places: &[(usize, f64, Option<f64>)]) -> Vec<(&'static Direction, Found)> {
        places.iter().map(|(i, good, bad)| (&DIRECTIONS[*i], Found { good: *good, bad: *bad })).collect()
    }

    #[test]
    fn the_nearer_direction_limits_the_tested_tolerance() {
        let both = found(&[(0, -0.248e-3, Some(-0.252e-3)), (1, 0.299e-3, Some(0.301e-3)), (2, 0.649e-3, None)]);
        let quantities = quantities(&both);
        let [radial, axial] = &quantities[..] else { panic!("{quantities:?}") };
        assert_eq!(
            (radial.name.as_str(), radial.value, radial.ci95),
            ("tested_radial", 0.248e-3, Some([0.248e-3, 0.252e-3]))
        );
        assert_eq!(radial.title, "Radial shift: tested tolerance (data sheet: 150 µm)");
        assert_eq!((axial.name.as_str(), axial.value, axial.ci95), ("tested_axial", 0.649e-3, None));
    }

    #[test]
    fn one_direction_of_two_is_no_tolerance() {
        assert!(quantities(&found(&[(0, -0.2e-3, None), (4, 0.01, None)])).is_empty());
    }

    #[test]
    fn every_axis_of_the_search_has_a_tested_tolerance() {
        let all: Vec<_> = DIRECTIONS.iter().map(|direction| (direction, Found { good: 1e-3, bad: None })).collect();
        let names: Vec<String> = quantities(&all).into_iter().map(|quantity| quantity.name).collect();
        assert_eq!(names, ["tested_radial", "tested_axial", "tested_rotation", "tested_tilt", "tested_vertical"]);
    }
}
