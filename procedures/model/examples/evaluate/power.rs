//! Effects that are weaker than the noise of one sample: their detection rate, and other named effects.

use crate::made::{Coloured, Dice};
use crate::options::Asked;
use crate::score::Count;
use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
use jointbench_model::{ModelSpec, Options, diagnose, discover};
use std::error::Error;

pub const EFFECTS: [&str; 7] = [
    "stribeck",
    "direction_offset",
    "viscous_asymmetry",
    "viscous_quadratic",
    "load_linear",
    "temperature_viscous",
    "gravity",
];

#[derive(Default)]
struct Power {
    top1: Count,
    silent: usize,
    extras: usize,
    in_tie_set: Count,
    exact: Count,
}

pub fn measure(asked: &Asked) -> Result<(), Box<dyn Error>> {
    println!("\nWeak effects: RMS in addition to the baseline, as a fraction of the RMS of the noise of one sample\n");
    println!(
        "| size | first suggestion right | nothing named | wrong effects per run | truth among the confounded | exact |\n|{}",
        " --- |".repeat(6)
    );
    for size in [0.4, 0.2] {
        let mut power = Power::default();
        for (e, effect) in EFFECTS.iter().enumerate() {
            for i in (asked.first..).take(asked.count as usize / 10) {
                let run =
                    run(effect, Rms::AugmentedGrams(size * NOISE_NM), &mut Dice::new(700_000 + 1000 * e as u64 + i));
                let found = one(effect, &run, &mut power)?;
                if !asked.quiet && found != [*effect] {
                    println!("{effect} {i} at {size}: {}", found.join("+"));
                }
            }
        }
        let runs = power.top1.1;
        println!(
            "| {size} | {} | {:.2} | {:.2} | {} | {} |",
            power.top1.show(),
            power.silent as f64 / runs as f64,
            power.extras as f64 / runs as f64,
            power.in_tie_set.show(),
            power.exact.show()
        );
    }
    println!();
    Ok(())
}

/// Effects that `discover` adds.
fn one(effect: &str, run: &RunTable, power: &mut Power) -> Result<Vec<String>, Box<dyn Error>> {
    let spec = ModelSpec::baseline(run)?;
    let first = diagnose(run, &spec, &Options::default())?;
    let whole = discover(run, &spec, &Options::default(), 6)?;
    let added: Vec<String> = whole.model.into_iter().filter(|e| !spec.contains(e)).collect();
    let top = first.suggestions.first();
    power.top1.add(top.is_some_and(|s| s.effect == effect));
    power.silent += usize::from(top.is_none());
    power.in_tie_set.add(top.is_some_and(|s| s.effect == effect || s.confounded_with.iter().any(|e| e == effect)));
    power.extras += added.iter().filter(|e| *e != effect).count();
    power.exact.add(added == [effect]);
    Ok(added)
}

const NOISE_NM: f64 = 2e-3;
const ROWS: usize = 200;
const STEP_S: f64 = 0.004;
const GEAR: f64 = 60.0;

/// Size of an effect in a run [Nm].
#[derive(Clone, Copy)]
pub enum Rms {
    /// RMS of the part that is orthogonal to dry and viscous friction.
    AugmentedGrams(f64),
    Whole(f64),
}

/// Nine speeds in both directions at three loads, twice, in random order: 108 steps of 200 samples. AR(1) noise with
/// a correlation of 0.85. Every step has a separate offset, tilt and dry friction, each a tenth of the noise.
pub fn run(effect: &str, size: Rms, dice: &mut Dice) -> RunTable {
    let speeds: Vec<f64> = (0..9).map(|i| 2.5 * 1.6f64.powi(i)).collect();
    let fastest = speeds[8];
    let slow = fastest * dice.size(0.03, 0.08);
    let mut noise = Coloured::new(NOISE_NM, 1.0, 0.85);
    let mut columns = vec![Vec::new(); 8];
    let (mut torque, mut shape) = (Vec::new(), Vec::new());
    let (mut time, mut angle, mut segment, mut warmth) = (0.0f64, dice.phase(), 0.0, 0.0);
    for repeat in [0.0, 1.0] {
        let mut steps: Vec<(f64, f64)> = speeds.iter().flat_map(|v| [0.0, 4.0, 12.0].map(|l| (*v, l))).collect();
        dice.shuffle(&mut steps);
        for (speed, load, side) in steps.into_iter().flat_map(|(v, l)| [(v, l, 1.0), (v, l, -1.0)]) {
            // Every pair of steps starts at another angle of the turn.
            if side > 0.0 {
                angle = dice.phase() * GEAR;
            }
            let [offset, tilt, grip] = [(); 3].map(|()| 0.1 * NOISE_NM * dice.normal());
            for row in 0..ROWS {
                time += STEP_S;
                angle += side * speed * STEP_S;
                warmth += (40.0 * speed / fastest - warmth) * STEP_S / 30.0;
                let along = row as f64 / ROWS as f64 - 0.5;
                let dry = side * (0.03 + grip) + offset + 3.5 * tilt * along;
                torque.push(dry + side * (1.5e-4 * speed + load / GEAR) + noise.next(dice));
                shape.push(match effect {
                    "stribeck" => side / (speed / slow).cosh(),
                    "direction_offset" => 1.0,
                    "viscous_asymmetry" => speed,
                    "viscous_quadratic" => side * speed * speed,
                    "load_linear" => side * load,
                    "temperature_viscous" => side * speed * (-0.01 * warmth).exp_m1(),
                    _ => (angle / GEAR).cos(),
                });
                let values = [time, angle, side * speed, angle / GEAR, side * load, 25.0 + warmth, segment, repeat];
                columns.iter_mut().zip(values).for_each(|(c, v)| c.push(v));
            }
            segment += 1.0;
        }
    }
    let (size, counts) = match size {
        Rms::AugmentedGrams(size) => (size, &left_over(shape.clone(), &columns[2])),
        Rms::Whole(size) => (size, &shape),
    };
    let coefficient = size / (counts.iter().map(|b| b * b).sum::<f64>() / counts.len() as f64).sqrt();
    // More friction near standstill and under load; the others have either sign.
    let sign = if ["stribeck", "load_linear"].contains(&effect) { 1.0 } else { dice.sign() };
    let current = torque.iter().zip(&shape).map(|(t, s)| (t + sign * coefficient * s) / 0.08).collect();
    table(columns, current)
}

/// Part of an effect that is orthogonal to dry and viscous friction.
fn left_over(mut shape: Vec<f64>, velocity: &[f64]) -> Vec<f64> {
    let dry: Vec<f64> = velocity.iter().map(|v| v.signum()).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let along = dot(&dry, velocity) / dot(&dry, &dry);
    let oil: Vec<f64> = velocity.iter().zip(&dry).map(|(v, d)| v - along * d).collect();
    for column in [&dry, &oil] {
        let share = dot(&shape, column) / dot(column, column);
        shape.iter_mut().zip(column).for_each(|(s, c)| *s -= share * c);
    }
    shape
}

fn table(mut columns: Vec<Vec<f64>>, current: Vec<f64>) -> RunTable {
    let mut names = vec![
        "time_s",
        "motor_position_rad",
        "motor_velocity_rad_s",
        "link_position_rad",
        "link_torque_nm",
        "temperature_c",
        "segment",
        "repeat",
    ];
    names.push("motor_current_a");
    columns.push(current);
    let meta = Meta {
        kind: Some(Kind::Friction),
        torque_constant_nm_per_a: Some(0.08),
        gear_ratio: Some(GEAR),
        baseline: ["load_transmission", "coulomb", "viscous"].map(String::from).into(),
        ..Meta::default()
    };
    let channels = names.into_iter().map(Channel::new).collect();
    RunTable::new(meta, Trace::from_columns(channels, columns)).expect("a simulated run is a valid table")
}
