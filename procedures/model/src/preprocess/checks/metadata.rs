//! Test conditions that are missing or contradict the columns, without making the results wrong.

use crate::thresholds::CLASH_RATIO;
use jointbench_instrument::{Kind, Motion, RunTable};

/// The doubts about the test conditions, each in a sentence.
pub fn warnings(run: &RunTable) -> Vec<String> {
    [rate(run), gear(run), segments(run), crate::preprocess::checks::sensor_faults::spikes(run)]
        .into_iter()
        .flatten()
        .collect()
}

fn rate(run: &RunTable) -> Option<String> {
    let stated_hz = run.meta().sample_rate_hz?;
    let found_hz = 1.0 / crate::preprocess::sample_s(run.column("time_s")?);
    let agree = (1.0 / CLASH_RATIO..=CLASH_RATIO).contains(&(found_hz / stated_hz));
    (!agree).then(|| {
        format!(
            "sample_rate_hz is {stated_hz}, and column time_s has {found_hz:.3} samples in a second: one of them is wrong; time_s is used"
        )
    })
}

/// Warns about a missing gear ratio. A joint without a gear cannot be distinguished from a joint whose gear ratio is
/// missing.
fn gear(run: &RunTable) -> Option<String> {
    let meta = run.meta();
    let asked = run.kind() == Kind::Friction && meta.motion != Motion::Linear && meta.gear_ratio.is_none();
    let column = ["link_torque_nm", "link_position_rad"].into_iter().find(|column| run.column(column).is_some());
    column.filter(|_| asked).map(|column| {
        format!("gear_ratio is not among the facts: {column} is taken as it is on the motor's side (a ratio of 1)")
    })
}

fn segments(run: &RunTable) -> Option<String> {
    (run.column("segment").is_some() && crate::preprocess::design::segments::numbered(run).is_none())
        .then(|| "column segment does not number segments: they are detected instead".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_instrument::{Channel, Meta, Trace};

    fn reported(meta: Meta) -> String {
        let names = ["time_s", "motor_position_rad", "motor_current_a", "link_torque_nm"];
        let mut trace = Trace::new(names.map(Channel::new).to_vec());
        (0..40).for_each(|i| trace.push_row(&[0.004 * f64::from(i), 0.0, 0.0, 0.0]));
        warnings(&RunTable::new(Meta { kind: Some(Kind::Friction), ..meta }, trace).unwrap()).join("; ")
    }

    #[test]
    fn a_contradicting_rate_and_a_missing_gear_are_reported() {
        let right = Meta { sample_rate_hz: Some(245.0), gear_ratio: Some(50.0), ..Meta::default() };
        assert_eq!(reported(right.clone()), "");
        let wrong = reported(Meta { sample_rate_hz: Some(1000.0), ..right.clone() });
        assert!(wrong.starts_with("sample_rate_hz is 1000, and column time_s has 250.000 samples"), "{wrong}");
        assert!(reported(Meta { gear_ratio: None, ..right.clone() }).starts_with("gear_ratio is not among the facts"));
        assert_eq!(reported(Meta { gear_ratio: None, motion: Motion::Linear, ..right }), "");
    }
}
