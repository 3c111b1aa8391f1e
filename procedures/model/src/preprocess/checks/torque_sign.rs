//! Contradiction between motor and link torque: one of them has a wrong unit or sign.

use crate::linear::basis::{Basis, dot};
use crate::preprocess::checks::blocks;
use crate::stats::summary::mean;
use crate::thresholds::{IN_COMMON, LOAD_SHARE, SLIPPED_IN_COMMON, STEADY_CHANGE, TORQUE_RATIO};
use jointbench_instrument::RunTable;
use std::ops::Range;

/// The motor torque without friction and inertia has to match the link torque divided by the gear ratio.
pub fn clash(run: &RunTable, blocks: &[blocks::Block]) -> Option<String> {
    let column = |name: &str| run.column(name);
    let (position, current) = (column("motor_position_rad")?, column("motor_current_a")?);
    let load = column("link_torque_nm")?;
    let per_link = run.meta().torque_constant_nm_per_a? * run.meta().gear_ratio.unwrap_or(1.0);
    let (ranges, velocity): (Vec<_>, Vec<f64>) = blocks
        .iter()
        .map(|(block, passed_s)| (block.clone(), (position[block.end] - position[block.start]) / passed_s))
        .unzip();
    let last = velocity.len().saturating_sub(1);
    let block = |(i, range): (usize, Range<usize>)| {
        let mean = |values: &[f64]| mean(&values[range.clone()]);
        Block {
            velocity: velocity[i],
            change: velocity[(i + 1).min(last)] - velocity[i.saturating_sub(1)],
            motor_nm: per_link * mean(current),
            link_nm: mean(load),
        }
    };
    let all: Vec<Block> = ranges.into_iter().enumerate().map(block).collect();
    let (torque, link) = without_motion(&all);
    let (tt, tl, ll) = (dot(&torque, &torque), dot(&torque, &link), dot(&link, &link));
    // This ratio is not biased by the noise of either side.
    let times = (tt / ll).sqrt().copysign(tl);
    let near = |unit: f64| (1.0 / TORQUE_RATIO..=TORQUE_RATIO).contains(&(times.abs() / unit));
    let agree = times > 0.0 && near(1.0);
    // At rest a motor works against its own friction, and an unloaded sensor follows that loosely with about a
    // hundredth of it.
    let slips = [1e3, 1e-3].into_iter().any(near) || times < 0.0 && near(1.0);
    let common = tl * tl / (tt * ll);
    let contradicts = !agree && if slips { common > SLIPPED_IN_COMMON } else { common > IN_COMMON && is_loaded(all) };
    contradicts.then(|| {
        format!(
            "motor_current_a with the torque constant and the gear ratio is {times:.3} times what link_torque_nm asks \
             for: one of these has another unit or sign"
        )
    })
}

/// Means over a block, and the change of velocity around it.
struct Block {
    velocity: f64,
    change: f64,
    motor_nm: f64,
    link_nm: f64,
}

/// Both torques without the parts that friction and inertia explain.
fn without_motion(blocks: &[Block]) -> (Vec<f64>, Vec<f64>) {
    let each = |value: fn(&Block) -> f64| blocks.iter().map(value).collect::<Vec<f64>>();
    let motion = Basis::of(&[each(|_| 1.0), each(|p| p.velocity.signum()), each(|p| p.change), each(|p| p.velocity)]);
    (motion.rest(&each(|p| p.motor_nm)), motion.rest(&each(|p| p.link_nm)))
}

/// Whether the motor torque varies at steady speed. Ramps and reversals share inertia on both sides of the sensor.
fn is_loaded(mut blocks: Vec<Block>) -> bool {
    blocks.retain(|p| p.change.abs() < STEADY_CHANGE * p.velocity.abs());
    let (without_motion_nm, _) = without_motion(&blocks);
    let middle = blocks.iter().map(|p| p.motor_nm).sum::<f64>() / blocks.len() as f64;
    let varies: f64 = blocks.iter().map(|p| (p.motor_nm - middle).powi(2)).sum();
    dot(&without_motion_nm, &without_motion_nm) > LOAD_SHARE * LOAD_SHARE * varies
}

#[cfg(test)]
mod tests {
    use crate::preprocess::checks::unit_mismatch;
    use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};

    fn messages(run: &RunTable) -> Vec<String> {
        unit_mismatch::data_errors(run).all().cloned().collect()
    }

    #[test]
    fn a_load_that_the_motor_does_not_carry_is_reported() {
        let rubbing = |current_scale: f64, load_scale: f64, rub_nm: f64| {
            let names = ["time_s", "motor_position_rad", "motor_current_a", "link_torque_nm"];
            let mut trace = Trace::new(names.map(Channel::new).to_vec());
            for i in 0..4000 {
                let t = 0.01 * f64::from(i);
                let (q, v) = (30.0 * (0.5 * t).sin(), (0.5 * t).cos());
                let link = 40.0 * (0.31 * t).sin();
                let torque = 0.02 * v.signum() + 0.03 * v + link / 50.0 * (1.0 + 0.3 * (v * link).signum());
                let torque = torque + rub_nm * v.signum() * (7.0 * q).sin();
                trace.push_row(&[t, q, current_scale * torque / 0.05, load_scale * link]);
            }
            let meta = Meta {
                kind: Some(Kind::Friction),
                gear_ratio: Some(50.0),
                torque_constant_nm_per_a: Some(0.05),
                ..Meta::default()
            };
            messages(&RunTable::new(meta, trace).unwrap())
        };
        let loaded = |current_scale, load_scale| rubbing(current_scale, load_scale, 0.0);
        assert_eq!(loaded(1.0, 1.0), Vec::<String>::new(), "a gear that loses three tenths");
        assert_eq!(loaded(1.0, 0.0), Vec::<String>::new(), "a sensor that shows nothing");
        let reported =
            |scale, load| matches!(&loaded(scale, load)[..], [one] if one.starts_with("motor_current_a with"));
        assert!(reported(1000.0, 1.0) && reported(-1.0, 1.0) && reported(1.0, 1000.0) && reported(1.0, -1.0));
        assert!(reported(20.0, 1.0), "another gear ratio");
        assert_eq!(
            rubbing(1.0, 0.01, 1.2),
            Vec::<String>::new(),
            "a sensor without a load, which shows what shakes it"
        );
        assert_eq!(
            rubbing(1.0, 1.0, 1.2),
            Vec::<String>::new(),
            "a fifth of the torque is friction that the link cannot know"
        );
        assert_eq!((rubbing(1000.0, 1.0, 1.2).len(), rubbing(-1.0, 1.0, 1.2).len()), (1, 1));
    }

    #[test]
    fn an_arm_that_is_only_sped_up_and_slowed_down_asks_no_other_unit() {
        let names = ["time_s", "motor_position_rad", "motor_current_a", "link_torque_nm"];
        let mut trace = Trace::new(names.map(Channel::new).to_vec());
        let (mut q, mut v) = (0.0, 0.0);
        for i in 0..20_000 {
            // Back and forth in steps of 4 s, faster each time; the drive reaches its speed within a tenth of a
            // second.
            let step = i / 400;
            let to = f64::from(1 + step / 2) * if step % 2 == 0 { 2.0 } else { -2.0 };
            let speeds_up = (to - v) / 0.1;
            v += 0.01 * speeds_up;
            q += 0.01 * v;
            let friction = 0.02 * f64::signum(v) + 0.01 * v + 1e-4 * f64::from(i).sin();
            let link = 0.05 * speeds_up + 0.02 * v + 1e-4 * f64::from(i).cos();
            trace.push_row(&[0.01 * f64::from(i), q, (friction + 0.003 * speeds_up) / 0.05, link]);
        }
        let meta = Meta {
            kind: Some(Kind::Friction),
            gear_ratio: Some(50.0),
            torque_constant_nm_per_a: Some(0.05),
            ..Meta::default()
        };
        assert_eq!(messages(&RunTable::new(meta, trace).unwrap()), Vec::<String>::new());
    }
}
