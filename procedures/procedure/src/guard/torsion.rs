//! Detection of faults from the identified flexibility: the torsion of a joint has to follow its
//! torque.

use super::Refusal;
use jointbench_instrument::TorsionLimit;

/// Compares the changes of torsion and torque since the first sample, so that the zero of neither encoder and the zero
/// of the torque sensor matter.
#[derive(Debug, Clone)]
pub struct TorsionWatch {
    limit: TorsionLimit,
    /// Torsion and torque of the first sample.
    start: Option<[f64; 2]>,
}

impl TorsionWatch {
    pub fn new(limit: TorsionLimit) -> Self {
        Self { limit, start: None }
    }

    pub fn check(&mut self, torsion_rad: f64, torque_nm: f64) -> Result<(), Refusal> {
        let [torsion_start_rad, torque_start_nm] = *self.start.get_or_insert([torsion_rad, torque_nm]);
        let TorsionLimit { compliance_rad_per_nm, tolerance_rad } = self.limit;
        let (torsion_rad, torque_nm) = (torsion_rad - torsion_start_rad, torque_nm - torque_start_nm);
        let expected_rad = compliance_rad_per_nm * torque_nm;
        // A value of NaN does not follow, either.
        let follows = (torsion_rad - expected_rad).abs() <= tolerance_rad;
        if follows { Ok(()) } else { Err(Refusal::Torsion { torsion_rad, expected_rad, torque_nm, tolerance_rad }) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: TorsionLimit = TorsionLimit { compliance_rad_per_nm: 1e-3, tolerance_rad: 2e-3 };

    /// Number of the sample that trips.
    fn tripped(samples: impl IntoIterator<Item = (f64, f64)>) -> Option<usize> {
        let mut watch = TorsionWatch::new(LIMIT);
        samples.into_iter().position(|(torsion_rad, torque_nm)| watch.check(torsion_rad, torque_nm).is_err())
    }

    #[test]
    fn a_joint_that_follows_its_torque_may_have_any_zero() {
        let swing = (0..200).map(|i| 10.0 * (0.1 * f64::from(i)).sin());
        assert_eq!(tripped(swing.map(|torque_nm| (7.0 + 1e-3 * torque_nm, 3.0 + torque_nm))), None);
    }

    #[test]
    fn a_coupling_that_slips_trips_in_both_directions() {
        let slipping = |by_rad: f64| (0..200).map(move |i| (if i < 100 { 0.01 } else { 0.01 + by_rad }, 10.0));
        assert_eq!(tripped(slipping(0.0021)), Some(100));
        assert_eq!(tripped(slipping(-0.0021)), Some(100));
        assert_eq!(tripped(slipping(0.0019)), None);
        assert_eq!(tripped(slipping(f64::NAN)), Some(100));
    }

    #[test]
    fn a_joint_that_has_become_softer_trips_at_its_load() {
        let loaded = |softer: f64| (0..200).map(move |i| (softer * 1e-4 * f64::from(i), 0.1 * f64::from(i)));
        assert_eq!(tripped(loaded(1.1)), None, "1.98 mrad at the top");
        assert_eq!(tripped(loaded(1.5)), Some(41), "2 mrad at 4 Nm");
    }
}
