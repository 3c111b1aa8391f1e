//! Simulates a joint and records the readings of its instruments.

use super::excitation::{self, Program, TICK_S};
use super::joint::{Joint, Load};
use super::laws::{Law, Moment, moves_the_joint};
use super::plant::{Drive, Observer};
use crate::made::{Coloured, Dice, rounded};
use std::rc::Rc;

/// Columns, with the truth at every row.
pub struct Rows {
    pub columns: Vec<(&'static str, Vec<f64>)>,
    pub moments: Vec<Moment>,
    /// Motor torque as measured.
    pub torque: Vec<f64>,
    pub laws: Vec<(&'static str, Law)>,
    pub lag_s: f64,
}

/// Definition of the run of a joint.
pub struct Setup {
    /// Speed set-point, brake, segment and repeat by ticks.
    speed: Vec<f64>,
    brake: Vec<f64>,
    segment: Vec<f64>,
    repeat: Vec<f64>,
}

pub fn setup(joint: &Joint, dice: &mut Dice) -> Setup {
    let program = Program::draw(joint.style, dice);
    let aligned = dice.coin();
    let (mut speed, mut segment, mut repeat) = (Vec::new(), Vec::new(), Vec::new());
    for number in 0..joint.repeats {
        speed.extend(&program.speed);
        segment.extend(&program.segment);
        // The next repeat begins at another angle.
        let away = if aligned { 0 } else { (dice.uniform(0.1, 0.6) / TICK_S) as usize };
        let shape = |i: usize| (std::f64::consts::PI * i as f64 / away as f64).sin();
        speed.extend((0..away).map(|i| 0.3 * shape(i)));
        segment.extend(vec![segment.last().copied().unwrap_or(0.0); away]);
        repeat.resize(speed.len(), number as f64);
    }
    let brake = excitation::brake(joint.load == Load::BrakeWave, speed.len(), dice);
    Setup { speed, brake, segment, repeat }
}

impl Setup {
    pub fn lasts_s(&self) -> f64 {
        self.speed.len() as f64 * TICK_S
    }
}

pub fn run(joint: &Joint, asked: &Setup, laws: Vec<(&'static str, Law)>, dice: &mut Dice) -> Rows {
    let mut plant = joint.plant(dice.uniform(-3.0, 3.0), dice.uniform(0.03, 0.1));
    let laws = Rc::new(laws);
    let pushing = Rc::clone(&laws);
    plant.laws = vec![Box::new(move |m| pushing.iter().filter(|l| moves_the_joint(l.0)).map(|l| (l.1)(m)).sum())];
    let mut drive = Drive::new(&plant, joint.bits, dice);
    let mut seen = Observer::new(dice.uniform(150.0, 600.0), plant.state.motor);
    let substeps = (1e4 / joint.rate_hz) as usize;
    let dt = 1.0 / (joint.rate_hz * substeps as f64);
    let heat = (dice.uniform(-4.0, 2.0), dice.uniform(6.0, 25.0), dice.uniform(15.0, 60.0));
    let lasts = asked.lasts_s();
    let (mut at, mut step) = (Moment::default(), 0usize);
    let mut rows = Vec::new();
    while at.time < lasts - 2.0 * TICK_S {
        let tick = ((at.time / TICK_S) as usize).min(asked.speed.len() - 1);
        at.warmth = heat.0 + heat.1 * (1.0 - (-at.time / heat.2).exp());
        if step.is_multiple_of(substeps) && step > 0 {
            rows.push((at.clone(), seen.velocity, tick));
        }
        // Set-point steps in phase with the samples would show another torque than the mean.
        let next = asked.speed[(tick + 1).min(asked.speed.len() - 1)];
        let wanted = asked.speed[tick] + (next - asked.speed[tick]) * (at.time / TICK_S).fract();
        let torque = drive.torque(wanted * joint.fastest, plant.state.motor, dt);
        plant.step(torque, asked.brake[tick], &mut at, dt);
        seen.follow(drive.reading(plant.state.motor), dt);
        step += 1;
    }
    drop(plant);
    let laws = Rc::into_inner(laws).unwrap_or_default();
    shown(joint, asked, rows, laws, (drive.count, 1.6 / seen.bandwidth), dice)
}

/// Readings of the instruments for the truth.
fn shown(
    joint: &Joint,
    asked: &Setup,
    rows: Vec<(Moment, f64, usize)>,
    laws: Vec<(&'static str, Law)>,
    (count, lag_s): (f64, f64),
    dice: &mut Dice,
) -> Rows {
    let reading = |m: &Moment| -> f64 { laws.iter().filter(|l| !moves_the_joint(l.0)).map(|l| (l.1)(m)).sum() };
    let mut noise = Coloured::new(joint.dry * dice.size(0.005, 0.03), dice.uniform(0.0, 0.5), dice.uniform(0.5, 0.9));
    let torque: Vec<f64> = rows.iter().map(|(m, ..)| m.torque + reading(m) + noise.next(dice)).collect();
    let velocity = *dice.pick(&["clean", "observer", "absent"]);
    let kept = |dice: &mut Dice| dice.uniform(0.0, 1.0) < 0.6;
    let (keeps_segment, keeps_temperature, has_repeats) = (kept(dice), kept(dice), joint.repeats > 1);
    // Without a temperature column a temperature effect is not identifiable.
    let keeps_temperature = keeps_temperature || laws.iter().any(|law| law.0.starts_with("temperature"));
    let quiet = 1e-3 * joint.fastest;
    let load_noise = joint.scale().heaviest * joint.gear * dice.size(5e-4, 3e-3);
    let mut columns: Vec<(&'static str, Vec<f64>)> = Vec::new();
    let mut add = |name, of: &mut dyn FnMut(&Moment, f64, usize) -> f64| {
        columns.push((name, rows.iter().map(|(m, seen, tick)| of(m, *seen, *tick)).collect()));
    };
    let first = rows.first().map_or(0.0, |r| r.0.time);
    add("time_s", &mut |m, _, _| m.time - first);
    add("motor_position_rad", &mut |m, _, _| rounded(m.motor, count));
    let mut torques = torque.iter();
    add("motor_current_a", &mut |_, _, _| torques.next().copied().unwrap_or(0.0) / joint.torque_constant);
    match velocity {
        "clean" => add("motor_velocity_rad_s", &mut |m, _, _| m.velocity + quiet * dice.normal()),
        "observer" => add("motor_velocity_rad_s", &mut |_, seen, _| seen),
        _ => {}
    }
    add("link_position_rad", &mut |m, _, _| rounded(m.link, std::f64::consts::TAU / 1_048_576.0));
    if joint.load != Load::None {
        add("link_torque_nm", &mut |m, _, _| m.load * joint.gear + load_noise * dice.normal());
    }
    if keeps_temperature {
        add("temperature_c", &mut |m, _, _| rounded(25.0 + m.warmth, 0.05));
    }
    if joint.load == Load::BrakeSteps {
        add("brake_torque_command_nm", &mut |_, _, tick| asked.brake[tick] * joint.brake * joint.gear);
    }
    if keeps_segment {
        add("segment", &mut |_, _, tick| asked.segment[tick]);
    }
    if has_repeats {
        add("repeat", &mut |_, _, tick| asked.repeat[tick]);
    }
    let moments = rows.into_iter().map(|(m, ..)| m).collect();
    Rows { columns, moments, torque, laws, lag_s: if velocity == "observer" { lag_s } else { 0.0 } }
}
