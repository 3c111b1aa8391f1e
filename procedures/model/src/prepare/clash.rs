//! Columns that tell the same motion in different units or signs: what is fitted to them is wrong, however well it fits.

use jointbench_instrument::{Kind, Motion, RunTable};

/// Ways are taken over pieces of this length: short enough for a reversal, long enough for coarse encoders.
const PIECE_S: f64 = 0.2;
/// Columns that differ by less may be filtered, late, or have a joint that winds up between them.
const CLASH: f64 = 1.2;
/// Share of the variance in common, below which the columns do not tell the same motion at all.
const SAME_MOTION: f64 = 0.9;

/// Each in a sentence.
pub fn clashes(run: &RunTable) -> Vec<String> {
    let gear_ratio = run.meta().gear_ratio.filter(|_| run.meta().motion != Motion::Linear);
    let pairs: &[(&str, &str, f64)] = match run.kind() {
        Kind::Friction => &[
            ("motor_velocity_rad_s", "motor_position_rad", 1.0),
            ("link_position_rad", "motor_position_rad", gear_ratio.unwrap_or(f64::NAN)),
        ],
        Kind::Stiffness => &[
            ("link_velocity_rad_s", "link_position_rad", 1.0),
            ("link_position_rad", "motor_position_rad", gear_ratio.unwrap_or(f64::NAN)),
        ],
        Kind::Encoder => {
            &[("velocity_rad_s", "reference_position_rad", 1.0), ("test_position_rad", "reference_position_rad", 1.0)]
        }
        Kind::Brake => &[("velocity_rad_s", "position_rad", 1.0)],
    };
    pairs.iter().filter_map(|(one, other, factor)| clash(run, one, other, *factor)).collect()
}

/// `factor · one` should move as `other` does.
fn clash(run: &RunTable, one: &str, other: &str, factor: f64) -> Option<String> {
    let (time_s, a, b) = (run.column("time_s")?, run.column(one)?, run.column(other)?);
    let is_speed = one.ends_with("_rad_s");
    let step_s = super::sample_s(time_s);
    let n = ((PIECE_S / step_s) as usize).max(1);
    let (mut aa, mut ab, mut bb) = (0.0, 0.0, 0.0);
    for start in (0..time_s.len().saturating_sub(n)).step_by(n) {
        let end = start + n;
        let passed_s = time_s[end] - time_s[start];
        // Not over the end of a recording.
        if !(passed_s > 0.0 && passed_s < 2.0 * n as f64 * step_s) {
            continue;
        }
        let way = match is_speed {
            // By the trapezoidal rule.
            true => a[start..=end].windows(2).map(|v| 0.5 * (v[0] + v[1])).sum::<f64>() * passed_s / n as f64,
            false => factor * (a[end] - a[start]),
        };
        let turned = b[end] - b[start];
        (aa, ab, bb) = (aa + way * way, ab + way * turned, bb + turned * turned);
    }
    let times = aa / ab;
    let tells = ab * ab > SAME_MOTION * aa * bb && !(1.0 / CLASH..=CLASH).contains(&times);
    tells.then(|| {
        let what = if factor == 1.0 { String::new() } else { format!(" with the gear ratio of {factor}") };
        format!("{one} is {times:.3} times what {other} gives{what}: one of them has another unit or sign")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_instrument::{Channel, Meta, Trace};

    fn run(velocity_scale: f64, link_scale: f64) -> RunTable {
        let names = ["time_s", "motor_position_rad", "motor_velocity_rad_s", "link_position_rad", "motor_current_a"];
        let mut trace = Trace::new(names.map(Channel::new).to_vec());
        for i in 0..2000 {
            let t = 0.01 * f64::from(i);
            let (q, v) = (30.0 * (0.5 * t).sin(), 15.0 * (0.5 * t).cos());
            trace.push_row(&[t, q, velocity_scale * v, link_scale * q / 50.0, 0.1 * v.signum()]);
        }
        let meta = Meta { kind: Some(Kind::Friction), gear_ratio: Some(50.0), ..Meta::default() };
        RunTable::new(meta, trace).unwrap()
    }

    #[test]
    fn columns_of_one_motion_agree_or_are_told() {
        assert_eq!(clashes(&run(1.0, 1.0)), Vec::<String>::new());
        assert_eq!(clashes(&run(1.1, 0.95)), Vec::<String>::new(), "late or filtered");
        let rpm = clashes(&run(9.549, 1.0));
        assert!(rpm.len() == 1 && rpm[0].starts_with("motor_velocity_rad_s is 9.5"), "{rpm:?}");
        let degrees = clashes(&run(-1.0, 57.296));
        assert!(
            degrees.len() == 2 && degrees[0].contains("is -1.00") && degrees[1].contains("57.296 times"),
            "{degrees:?}"
        );
    }
}
