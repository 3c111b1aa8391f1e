//! Stiffness of three thirds of the torque, as in catalogues of gears: K₁, K₂ and K₃.

use crate::findings::{Line, quantity};
use crate::identification::Quantity;

/// From means of holds (torque and torsion) of both signs, each relative to its own offset, without the compliance of
/// the bearing. A third that the loads do not determine is omitted.
pub(super) fn zones(points: &[(f64, f64)], bearing: f64) -> Vec<Quantity> {
    let top = points.iter().map(|p| p.0.abs()).fold(0.0, f64::max);
    let zone = |number: usize| {
        let (low, high) = (number as f64 / 3.0 * top, (number + 1) as f64 / 3.0 * top);
        // A load at a border belongs to both thirds.
        let inside = |torque: f64| (0.98 * low..=1.02 * high).contains(&torque.abs());
        let side = |sign: f64| centred(points.iter().filter(|p| inside(p.0) && p.0 * sign > 0.0));
        let line = Line::through(&[side(1.0), side(-1.0)].concat())?;
        let stiffness = |compliance: f64| 1.0 / (compliance - bearing);
        let [least, most] = line.slope_ci95;
        let name = format!("k_{}", number + 1);
        let symbol = format!("K{}", ["₁", "₂", "₃"][number]);
        let title = format!("Stiffness from {low:.0} to {high:.0} Nm");
        (least > bearing).then(|| {
            let ci95 = [stiffness(most), stiffness(least)];
            quantity([&name, &symbol, &title, "Nm/rad"], stiffness(line.slope), Some(ci95))
        })
    };
    (0..3).filter_map(zone).collect()
}

/// Points relative to their mean.
fn centred<'p>(points: impl Iterator<Item = &'p (f64, f64)>) -> Vec<(f64, f64)> {
    let points: Vec<(f64, f64)> = points.copied().collect();
    let n = points.len() as f64;
    let (x0, y0) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    points.into_iter().map(|(x, y)| (x - x0, y - y0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_that_stiffens_has_a_stiffness_for_each_third() {
        // 100, 200 and 400 Nm/rad between 0, 10, 20 and 30 Nm, both signs about an offset.
        let torsion = |t: f64| t.min(10.0) / 100.0 + (t - 10.0).clamp(0.0, 10.0) / 200.0 + (t - 20.0).max(0.0) / 400.0;
        let torques = (1..=12).map(|i| f64::from(i) * 2.5);
        let points: Vec<(f64, f64)> = torques
            .flat_map(|t| [(t, torsion(t)), (-t, -torsion(t)), (t, torsion(t) + 1e-5), (-t, -torsion(t) - 1e-5)])
            .collect();
        let found = zones(&points, 0.0);
        for (quantity, wanted) in found.iter().zip([100.0, 200.0, 400.0]) {
            assert!((quantity.value / wanted - 1.0).abs() < 0.02, "{} is {}", quantity.name, quantity.value);
        }
        assert_eq!(found.len(), 3);
    }

    #[test]
    fn two_loads_decide_no_third() {
        assert!(zones(&[(10.0, 0.1), (-10.0, -0.1)], 0.0).is_empty());
    }
}
