//! A motor current that was recorded as a magnitude. Friction opposes both directions of motion, so a joint that moves
//! in both needs a current of both signs, unless a constant load exceeds its friction.

use crate::preprocess::checks::blocks::Block;
use crate::stats::summary::mean;
use crate::thresholds::{CANCELLED_WORK, MAGNITUDE_DIP};
use jointbench_instrument::{Kind, RunTable};

pub fn unsigned(run: &RunTable, blocks: &[Block]) -> Option<String> {
    if run.kind() != Kind::Friction {
        return None;
    }
    let (position, current) = (run.column("motor_position_rad")?, run.column("motor_current_a")?);
    let middle = mean(current);
    let least = current.iter().copied().fold(f64::INFINITY, f64::min);
    if !(0.0..MAGNITUDE_DIP * middle).contains(&least) {
        return None;
    }
    let of_block = |(block, _): &Block| {
        let moved = position[block.end] - position[block.start];
        moved * mean(&current[block.clone()])
    };
    let work = blocks.iter().map(of_block);
    let (net, both) = work.fold((0.0, 0.0), |(net, both), work| (net + work, both + work.abs()));
    (net.abs() < CANCELLED_WORK * both).then(|| {
        "motor_current_a is never negative, but as large in one direction of motion as in the other, as a magnitude: \
         export it with its sign"
            .to_owned()
    })
}

#[cfg(test)]
mod tests {
    use crate::preprocess::checks::unit_mismatch;
    use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};

    #[test]
    fn a_magnitude_is_reported_and_a_constant_load_is_not() {
        let reported = |of: fn(f64) -> f64, load_a: f64| {
            let names = ["time_s", "motor_position_rad", "motor_current_a"];
            let mut trace = Trace::new(names.map(Channel::new).to_vec());
            for i in 0..8000 {
                let t = 0.005 * f64::from(i);
                let (q, v) = (30.0 * (0.5 * t).sin(), 15.0 * (0.5 * t).cos());
                let current = 0.3 * (v / 0.5).tanh() + 0.02 * v + load_a + 0.002 * (913.0 * t).sin();
                trace.push_row(&[t, q, of(current)]);
            }
            let meta = Meta { kind: Some(Kind::Friction), ..Meta::default() };
            let data_errors = unit_mismatch::data_errors(&RunTable::new(meta, trace).unwrap());
            data_errors.fatal.iter().any(|text| text.contains("as a magnitude"))
        };
        assert!(reported(f64::abs, 0.0));
        assert!(!reported(|signed| signed, 0.0));
        assert!(!reported(f64::abs, 5.0), "a load that exceeds the friction");
        assert!(!reported(|signed| signed, 5.0));
    }
}
