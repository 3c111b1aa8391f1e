//! Contradictions between columns of the same motion or torque, in unit or sign. A fit to such columns is wrong, even
//! with a small residual.

use crate::preprocess::checks::blocks::{Block, blocks};
use crate::preprocess::held_side::is_held;
use crate::stats::summary::{mean, range};
use crate::thresholds::{
    ALIKE_BLOCKS, ALIKE_RATIO, CHECK_BLOCK_S, CLAMPED_RAD, CLASH_RATIO, COMPUTED_COLUMN, DRIVEN_WORK, FINE_ANGLES,
    GEAR_ERROR, GEAR_SPEED, GEAR_TRAVEL_RAD, IN_COMMON, NOISE_BLOCKS, NOISE_ERRORS,
};
use jointbench_instrument::{Kind, Motion, RunTable};
use std::f64::consts::TAU;
use std::ops::Range;

/// Contradictions, each in a sentence.
#[derive(Debug, Clone, Default)]
pub struct DataErrors {
    /// Fatal contradictions: every fit to these columns is meaningless, so that no effect is named.
    pub fatal: Vec<String>,
    pub others: Vec<String>,
}

impl DataErrors {
    pub fn all(&self) -> impl Iterator<Item = &String> {
        self.fatal.iter().chain(&self.others)
    }

    pub fn is_empty(&self) -> bool {
        self.all().next().is_none()
    }
}

/// Two columns that contradict each other.
struct Contradiction {
    is_fatal: bool,
    text: String,
}

impl Contradiction {
    fn fatal(text: String) -> Self {
        Self { is_fatal: true, text }
    }
}

pub fn data_errors(run: &RunTable) -> DataErrors {
    let gear_ratio = run.meta().gear_ratio.filter(|_| run.meta().motion != Motion::Linear);
    let gear = gear_ratio.unwrap_or(f64::NAN);
    let pairs: &[(&str, &str, f64)] = match run.kind() {
        Kind::Friction => {
            &[("motor_velocity_rad_s", "motor_position_rad", 1.0), ("link_position_rad", "motor_position_rad", gear)]
        }
        Kind::Stiffness => {
            &[("link_velocity_rad_s", "link_position_rad", 1.0), ("link_position_rad", "motor_position_rad", gear)]
        }
        Kind::Encoder => {
            &[("velocity_rad_s", "reference_position_rad", 1.0), ("test_position_rad", "reference_position_rad", 1.0)]
        }
        Kind::Brake => &[("velocity_rad_s", "position_rad", 1.0)],
    };
    let blocks = blocks(run.column("time_s").unwrap_or_default());
    let motions = pairs.iter().filter_map(|(one, other, ratio)| clash(run, &blocks, one, other, *ratio));
    let torques =
        (run.kind() == Kind::Friction).then(|| crate::preprocess::checks::torque_sign::clash(run, &blocks)).flatten();
    let (fatal, gears): (Vec<Contradiction>, Vec<Contradiction>) = motions.partition(|clash| clash.is_fatal);
    let text = |found: Vec<Contradiction>| found.into_iter().map(|one| one.text);
    DataErrors {
        fatal: text(fatal)
            .chain(torques)
            .chain(driven(run, &blocks))
            .chain(crate::preprocess::checks::unsigned_current::unsigned(run, &blocks))
            .chain(noise(run, &blocks))
            .chain(computed_load(run))
            .chain(too_fast(run))
            .collect(),
        others: text(gears)
            .chain(dead_load(run))
            .chain(crate::preprocess::checks::brake_range::beyond(run))
            .chain(crate::preprocess::checks::sensor_faults::failed(run))
            .collect(),
    }
}

/// A load torque that is a straight line of the motor current to the digits of the file was computed from it. Every
/// sensor has more noise, and every joint has friction.
fn computed_load(run: &RunTable) -> Option<String> {
    let load = run.column("link_torque_nm").filter(|_| run.kind() == Kind::Friction)?;
    let current = run.column("motor_current_a")?;
    let (load_mean, current_mean) = (mean(load), mean(current));
    let sum = |f: fn(f64, f64) -> f64| -> f64 {
        load.iter().zip(current).map(|(load, current)| f(load - load_mean, current - current_mean)).sum()
    };
    let (of_load, of_both, of_current) = (sum(|l, _| l * l), sum(|l, c| l * c), sum(|_, c| c * c));
    let rest = of_load - of_both * of_both / of_current;
    (of_load > 0.0 && of_current > 0.0 && rest < COMPUTED_COLUMN * COMPUTED_COLUMN * of_load).then(|| {
        "link_torque_nm is a multiple of motor_current_a: it was computed from the current, not measured; remove the column"
            .to_owned()
    })
}

/// Where nothing else drives the joint, a torque that brakes it in both directions has the wrong sign.
fn driven(run: &RunTable, blocks: &[Block]) -> Option<String> {
    let is_alone = run.kind() == Kind::Friction && run.column("link_torque_nm").is_none();
    let column = |name: &str| run.column(name).filter(|_| is_alone);
    let (position, current) = (column("motor_position_rad")?, column("motor_current_a")?);
    let (mut work, mut moved) = ([0.0; 2], [0.0; 2]);
    for (block, _) in blocks {
        let way = position[block.end] - position[block.start];
        let done = way * mean(&current[block.clone()]);
        work[usize::from(way < 0.0)] += done;
        moved[usize::from(way < 0.0)] += done.abs();
    }
    let brakes = work.iter().zip(&moved).all(|(work, moved)| *work < -DRIVEN_WORK * moved);
    brakes.then(|| {
        "motor_current_a opposes the motion in both directions: it or the motion has the wrong sign, or something else drives the \
         joint (then record its torque as link_torque_nm)"
            .to_owned()
    })
}

/// A contradiction unless `ratio · one` moves like `other`.
fn clash(run: &RunTable, blocks: &[Block], one: &str, other: &str, ratio: f64) -> Option<Contradiction> {
    let (a, b) = (run.column(one)?, run.column(other)?);
    let is_speed = one.ends_with("_rad_s");
    if is_held(run) {
        return None;
    }
    if !is_speed && run.kind() != Kind::Friction {
        let one_rests = rests(one, a, other, b, ratio);
        if let Some(reported) = one_rests.or_else(|| rests(other, b, one, a, 1.0 / ratio)) {
            return Some(Contradiction::fatal(reported));
        }
    }
    let travels = travels(blocks, a, b, is_speed, ratio);
    let times = alike(&travels).or_else(|| mostly(&travels))?;
    if (1.0 / CLASH_RATIO..=CLASH_RATIO).contains(&times) {
        let is_geared = !is_speed && ratio != 1.0;
        return is_geared
            .then(|| other_gear(&travels, ratio))
            .flatten()
            .map(|text| Contradiction { is_fatal: false, text });
    }
    let what = if ratio == 1.0 { String::new() } else { format!(" with the gear ratio of {ratio}") };
    let text =
        format!("{one} is {times:.3} times what {other} gives{what}: one of them has another unit, sign or scale");
    Some(Contradiction::fatal(text))
}

/// Travel of `ratio · one` and of `other` in each block of a run.
fn travels(blocks: &[Block], a: &[f64], b: &[f64], is_speed: bool, ratio: f64) -> Vec<(f64, f64)> {
    blocks
        .iter()
        .map(|&(Range { start, end }, passed_s)| {
            let travel = match is_speed {
                // By the trapezoidal rule.
                true => {
                    a[start..=end].windows(2).map(|v| 0.5 * (v[0] + v[1])).sum::<f64>() * passed_s
                        / (end - start) as f64
                }
                false => ratio * (a[end] - a[start]),
            };
            (travel, b[end] - b[start])
        })
        .collect()
}

/// A gear ratio that is wrong by a tooth or two: the wrong share of the load looks like an effect.
fn other_gear(travels: &[(f64, f64)], ratio: f64) -> Option<String> {
    let fast = GEAR_SPEED * travels.iter().fold(0.0f64, |most, w| most.max(w.1.abs()));
    let sum = |f: fn(&(f64, f64)) -> f64| travels.iter().filter(|w| w.1.abs() >= fast).map(f).sum::<f64>();
    let (aa, ab, bb) = (sum(|w| w.0 * w.0), sum(|w| w.0 * w.1), sum(|w| w.1 * w.1));
    // The motor angle is much finer than the link angle, so that its noise does not bias this ratio.
    let found = ratio * bb / ab;
    let turned = sum(|w| w.1.abs()) / ratio.abs();
    let contradicts =
        ab * ab > FINE_ANGLES * aa * bb && turned > GEAR_TRAVEL_RAD && (found / ratio - 1.0).abs() > GEAR_ERROR;
    contradicts.then(|| {
        format!(
            "gear_ratio is {ratio}, and motor_position_rad moves {found:.2} times as far as link_position_rad: one of them is wrong"
        )
    })
}

/// An angle that never changes while the other one moves.
fn rests(one: &str, a: &[f64], other: &str, b: &[f64], ratio: f64) -> Option<String> {
    let (low, high) = range(b);
    let moved = (high - low) / ratio;
    (moved > CLAMPED_RAD && a.iter().all(|v| *v == a[0])).then(|| {
        format!("{one} never changes, while {other} says that it moved by {moved:.3} rad: it was not connected")
    })
}

/// Ratio of the first to the second travel, if both are correlated.
fn alike(travels: &[(f64, f64)]) -> Option<f64> {
    let sum = |f: fn(&(f64, f64)) -> f64| travels.iter().map(f).sum::<f64>();
    let (aa, ab, bb) = (sum(|w| w.0 * w.0), sum(|w| w.0 * w.1), sum(|w| w.1 * w.1));
    (ab * ab > IN_COMMON * aa * bb).then_some(aa / ab)
}

/// The same by the median over the blocks: an angle within one turn jumps in the others.
fn mostly(travels: &[(f64, f64)]) -> Option<f64> {
    let times: Vec<f64> = travels.iter().filter(|w| w.1 != 0.0).map(|w| w.0 / w.1).collect();
    let middle = crate::preprocess::median(times.iter().copied());
    let near = times.iter().filter(|t| (*t / middle - 1.0).abs() < ALIKE_RATIO).count();
    (near as f64 > ALIKE_BLOCKS * travels.len() as f64).then_some(middle)
}

/// An encoder that moves by more than a turn between two samples: its position is ambiguous.
fn too_fast(run: &RunTable) -> Option<String> {
    let angle = run.column("reference_position_rad").filter(|_| run.kind() == Kind::Encoder)?;
    let step = crate::preprocess::median(angle.windows(2).map(|pair| (pair[1] - pair[0]).abs()));
    (step > TAU).then(|| {
        format!(
            "reference_position_rad advances by {:.3} turns from one sample to the next: it has another unit, or was sampled too slowly",
            step / TAU
        )
    })
}

/// A load that is constant and not zero: a connected sensor has noise.
fn dead_load(run: &RunTable) -> Option<String> {
    let load = run.column("link_torque_nm").filter(|_| run.kind() == Kind::Friction)?;
    let is_dependent = load[0] != 0.0 && load.iter().all(|v| *v == load[0]);
    is_dependent.then(|| format!("link_torque_nm is {} Nm in every sample: the sensor was not connected", load[0]))
}

/// A current without correlation between neighbouring samples and between neighbouring blocks: an open input. A
/// constant current with noise has a mean and does not count.
fn noise(run: &RunTable, blocks: &[Block]) -> Option<String> {
    let column = match run.kind() {
        Kind::Friction => "motor_current_a",
        Kind::Brake => "brake_current_a",
        Kind::Encoder | Kind::Stiffness => return None,
    };
    let current = run.column(column)?;
    let variance = |values: &[f64]| {
        let middle = mean(values);
        values.iter().map(|i| (i - middle).powi(2)).sum::<f64>() / values.len() as f64
    };
    let is_white = |values: &[f64]| {
        let middle = mean(values);
        let next: f64 = values.windows(2).map(|i| (i[0] - middle) * (i[1] - middle)).sum();
        next.abs() < NOISE_ERRORS * variance(values) * (values.len() as f64).sqrt()
    };
    let means: Vec<f64> = blocks.iter().map(|(block, _)| mean(&current[block.clone()])).collect();
    let swings = variance(current) > mean(current).powi(2);
    (means.len() >= NOISE_BLOCKS as usize && swings && is_white(current) && is_white(&means)).then(|| {
        format!(
            "{column} is white noise, from sample to sample and over {CHECK_BLOCK_S} s: it was not connected, or is another signal"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_instrument::{Channel, Meta, Trace};

    fn messages(run: &RunTable) -> Vec<String> {
        data_errors(run).all().cloned().collect()
    }

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
    fn an_unconnected_angle_and_jumps_in_degrees_are_reported() {
        let reported = |kind: Kind, names: [&str; 4], row: &dyn Fn(f64) -> [f64; 3]| {
            let mut trace = Trace::new(names.map(Channel::new).to_vec());
            for i in 0..4000 {
                let t = 0.004 * f64::from(i);
                let [a, b, c] = row(t);
                trace.push_row(&[t, a, b, c]);
            }
            messages(
                &RunTable::new(Meta { kind: Some(kind), gear_ratio: Some(50.0), ..Meta::default() }, trace).unwrap(),
            )
        };
        let encoder = ["time_s", "reference_position_rad", "test_position_rad", "temperature_c"];
        let turn = |a: f64| (a + 3.0).rem_euclid(std::f64::consts::TAU) - 3.0;
        let of = |scale: f64| reported(Kind::Encoder, encoder, &|t| [turn(2.0 * t), scale * turn(2.0 * t), 20.0]);
        assert_eq!(of(1.0), Vec::<String>::new());
        assert!(matches!(&of(57.296)[..], [one] if one.contains("57.296 times")), "{:?}", of(57.296));
        let dead = reported(Kind::Encoder, encoder, &|t| [turn(2.0 * t), 0.7, 20.0]);
        assert!(dead.len() == 1 && dead[0].starts_with("test_position_rad never changes"), "{dead:?}");
        let stiffness = ["time_s", "motor_position_rad", "link_position_rad", "link_torque_nm"];
        let held = |way: f64| reported(Kind::Stiffness, stiffness, &|t| [way * t.sin(), 0.7, (3.0 * t).sin()]);
        assert_eq!(held(0.2), Vec::<String>::new(), "the link was held fast, and the joint gives way");
        assert!(held(30.0)[0].starts_with("link_position_rad never changes"), "{:?}", held(30.0));
    }

    #[test]
    fn a_load_that_was_computed_from_the_current_is_reported() {
        let reported = |friction_nm: f64, digits: f64| {
            let names = ["time_s", "motor_position_rad", "motor_current_a", "link_torque_nm"];
            let mut trace = Trace::new(names.map(Channel::new).to_vec());
            for i in 0..4000 {
                let t = 0.004 * f64::from(i);
                let (q, current) = (30.0 * (0.5 * t).sin(), (0.5 * t).cos().signum() + 0.3 * (0.5 * t).cos());
                let load = 0.0458 * current - friction_nm * (0.5 * t).cos().signum();
                trace.push_row(&[t, q, current, (load / digits).round() * digits]);
            }
            let meta = Meta { kind: Some(Kind::Friction), gear_ratio: Some(1.0), ..Meta::default() };
            messages(&RunTable::new(meta, trace).unwrap())
        };
        let computed = |found: Vec<String>| found.iter().any(|text| text.contains("was computed from the current"));
        assert!(computed(reported(0.0, 1e-9)));
        assert!(!computed(reported(0.0, 1e-4)), "an ideal sensor of 500 steps");
        assert!(!computed(reported(1e-3, 1e-9)), "friction of 2 %");
    }

    #[test]
    fn a_current_that_is_noise_is_reported() {
        // Uniform scatter in ±0.5 (SplitMix64).
        let scatter = |i: u64| {
            let z = (i + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let reported = |friction_a: f64, gravity_a: f64, held_a: f64| {
            let names = ["time_s", "motor_position_rad", "motor_current_a"];
            let mut trace = Trace::new(names.map(Channel::new).to_vec());
            for i in 0..20_000u64 {
                let t = 0.004 * i as f64;
                let (q, v) = (30.0 * (0.5 * t).sin(), (0.5 * t).cos());
                trace.push_row(&[t, q, friction_a * v.signum() + gravity_a * q.cos() + held_a + scatter(i)]);
            }
            let meta = Meta { kind: Some(Kind::Friction), gear_ratio: Some(1.0), ..Meta::default() };
            messages(&RunTable::new(meta, trace).unwrap())
        };
        let found = reported(0.0, 0.0, 0.0);
        assert!(matches!(&found[..], [one] if one.starts_with("motor_current_a is white noise")), "{found:?}");
        assert_eq!(reported(0.03, 0.0, 0.0), Vec::<String>::new(), "friction of a tenth of the noise");
        let turned = reported(-1.0, 0.5, 0.2);
        assert!(matches!(&turned[..], [one] if one.starts_with("motor_current_a opposes the motion")), "{turned:?}");
        assert_eq!(reported(0.2, 1.0, 0.5), Vec::<String>::new(), "a weight that drives now and then");
        assert_eq!(reported(0.0, 0.2, 0.0), Vec::<String>::new(), "a wave that comes and goes");
        assert_eq!(reported(0.0, 0.0, 0.4), Vec::<String>::new(), "a current that is held");
    }

    #[test]
    fn columns_of_one_motion_agree_or_are_reported() {
        assert_eq!(messages(&run(1.0, 1.0)), Vec::<String>::new());
        assert_eq!(messages(&run(1.1, 0.995)), Vec::<String>::new(), "late or filtered");
        let gear = messages(&run(1.0, 50.0 / 51.0));
        assert!(gear.len() == 1 && gear[0].contains("moves 51.00 times as far"), "{gear:?}");
        let rpm = messages(&run(9.549, 1.0));
        assert!(rpm.len() == 1 && rpm[0].starts_with("motor_velocity_rad_s is 9.5"), "{rpm:?}");
        let degrees = messages(&run(-1.0, 57.296));
        assert!(
            degrees.len() == 2 && degrees[0].contains("is -1.00") && degrees[1].contains("57.296 times"),
            "{degrees:?}"
        );
    }
}
