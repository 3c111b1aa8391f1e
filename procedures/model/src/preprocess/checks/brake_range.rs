//! Plausibility of brake data: currents and torques beyond the range of all brakes have a wrong unit.

use crate::linear::basis::dot;
use crate::stats::summary::peak;
use crate::thresholds::{
    BRAKE_MARGIN, CURRENT_IN_COMMON, LARGEST_CURRENT, LARGEST_CURRENT_A, LARGEST_TORQUE_PER_CURRENT,
    LEAST_TORQUE_PER_CURRENT, SMALL_CURRENT, VARYING_CURRENT,
};
use crate::words::figure;
use jointbench_instrument::{Kind, Motion, RunTable};

/// A current or torque beyond the plausible range, in a sentence.
pub fn beyond(run: &RunTable) -> Option<String> {
    let current = run.column("brake_current_a")?;
    let largest = peak(current);
    let rated_a = run.meta().rated_current_a;
    let most_a = rated_a.map_or(LARGEST_CURRENT_A, |rated_a| LARGEST_CURRENT * rated_a);
    if largest > most_a {
        return Some(match rated_a {
            Some(rated_a) => format!(
                "brake_current_a reaches {largest:.0} A, and the brake is rated for {rated_a} A: one of them has another \
                 unit (mA?)"
            ),
            None => format!(
                "brake_current_a reaches {largest:.0} A, and hysteresis brakes take about one: either it has another unit (mA?), \
                 or it is a brake of another kind, whose rated_current_a the meta file has to state"
            ),
        });
    }
    // The figures of rotating hysteresis brakes say nothing of a force.
    if run.kind() != Kind::Brake || run.meta().motion == Motion::Linear {
        return None;
    }
    let held = held(current, run.column("brake_torque_nm")?)?;
    if let Some(rated_a) = rated_a.filter(|rated_a| largest < SMALL_CURRENT * rated_a) {
        return Some(format!(
            "brake_current_a reaches {} only, the torque follows it, and the brake is rated for {rated_a} A: one of them has \
             another unit",
            figure(largest, "A")
        ));
    }
    let (least, most) = (LEAST_TORQUE_PER_CURRENT, LARGEST_TORQUE_PER_CURRENT);
    (!(least / BRAKE_MARGIN..=most * BRAKE_MARGIN).contains(&held)).then(|| {
        format!(
            "brake_torque_nm rises by {} for each A of brake_current_a, and hysteresis brakes hold {least} to {most} Nm for \
             each: one of the two has another unit (mA, mNm?)",
            figure(held, "Nm")
        )
    })
}

/// Torque for each ampere, from the absolute values of both. `None` if the torque does not rise with the current, or
/// the current is constant: the torque then changes for other reasons, such as temperature.
fn held(current: &[f64], torque: &[f64]) -> Option<f64> {
    let about_mean = |values: &[f64]| -> Vec<f64> {
        let mean = values.iter().map(|v| v.abs()).sum::<f64>() / values.len() as f64;
        values.iter().map(|v| v.abs() - mean).collect()
    };
    let largest = peak(current);
    let (current, torque) = (about_mean(current), about_mean(torque));
    let (ii, it, tt) = (dot(&current, &current), dot(&current, &torque), dot(&torque, &torque));
    let varies = ii > (VARYING_CURRENT * largest).powi(2) * current.len() as f64;
    (varies && it > 0.0 && it * it > CURRENT_IN_COMMON * ii * tt).then_some(it / ii)
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_instrument::{Channel, Meta, Trace};

    /// A brake with the torque `nm` at its rated current, with columns in other units.
    fn reported(nm: f64, rated_a: f64, current: f64, torque: f64, is_rated: bool) -> Option<String> {
        let names = ["time_s", "position_rad", "brake_current_a", "brake_torque_nm"];
        let mut trace = Trace::new(names.map(Channel::new).to_vec());
        for i in 0..800 {
            let t = 0.01 * f64::from(i);
            let level = t.sin().abs();
            trace.push_row(&[t, t, current * rated_a * level, torque * nm * level.powi(2)]);
        }
        let meta = Meta { kind: Some(Kind::Brake), rated_current_a: is_rated.then_some(rated_a), ..Meta::default() };
        beyond(&RunTable::new(meta, trace).unwrap())
    }

    #[test]
    fn only_values_beyond_all_brakes_are_reported() {
        // HB-140M, HB-3500M, and the latter behind a gear of 1:10.
        for (nm, rated_a) in [(1.0, 0.253), (26.0, 1.2), (260.0, 1.2)] {
            for is_rated in [true, false] {
                let reported = |current, torque| reported(nm, rated_a, current, torque, is_rated);
                assert_eq!(reported(1.0, 1.0), None);
                for slip in [1e3, 1e-3] {
                    assert!(reported(slip, 1.0).is_some(), "{nm} Nm, a current {slip} times as large");
                }
                assert!(
                    reported(1.0, 1e3).is_some_and(|text| text.contains("hysteresis brakes hold 0.1 to 220 Nm")),
                    "{nm} Nm"
                );
            }
        }
        assert!(reported(13.0, 0.6, 1.0, 1e-3, false).is_some(), "a torque in kNm");
        let text = reported(13.0, 0.6, 1e3, 1.0, true).unwrap();
        assert!(text.starts_with("brake_current_a reaches 600 A, and the brake is rated for 0.6 A"), "{text}");
        let text = reported(13.0, 0.6, 1e3, 1.0, false).unwrap();
        assert!(text.starts_with("brake_current_a reaches 600 A, and hysteresis brakes take about one"), "{text}");
    }

    #[test]
    fn a_drag_without_current_does_not_determine_units() {
        let names = ["time_s", "brake_current_a", "brake_torque_nm"];
        let mut trace = Trace::new(names.map(Channel::new).to_vec());
        let mut warming = trace.clone();
        for i in 0..800 {
            let t = 0.01 * f64::from(i);
            trace.push_row(&[t, 1e-4 * (37.0 * t).sin(), 0.09 + 0.002 * (3.1 * t).sin()]);
            warming.push_row(&[t, 0.3 + 1e-5 * t, 4.0 + 0.05 * t]);
        }
        for trace in [trace, warming] {
            let meta = Meta { kind: Some(Kind::Brake), rated_current_a: Some(0.6), ..Meta::default() };
            assert_eq!(beyond(&RunTable::new(meta, trace).unwrap()), None);
        }
    }
}
