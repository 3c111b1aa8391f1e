//! Stiffness runs: a joint with a locked or a turning link under torques of all shapes.

mod excitation;
mod laws;

use super::draw::Plan;
use super::recording::{Part, Recording, written};
use crate::made::{Coloured, Dice, rounded};
use jointbench_instrument::{Kind, Meta};
use laws::{OF_MOTION, OF_TORQUE, OUTSIDE, OUTSIDE_OF_MOTION, twist};
use serde_json::json;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// The truth at every row.
pub struct Run {
    pub time: Vec<f64>,
    pub torque: Vec<f64>,
    pub link: Vec<f64>,
    pub velocity: Vec<f64>,
    pub warmth: Vec<f64>,
    pub segment: Vec<f64>,
    pub repeat: Vec<f64>,
    pub rate_hz: f64,
    pub full_nm: f64,
    pub full_twist: f64,
    /// Speed of a turning link [rad/s].
    pub speed: f64,
}

const SHAPES: usize = 5;

pub fn make(dice: &mut Dice) -> Recording {
    let style = *dice.pick(excitation::STYLES);
    let repeats = *dice.pick(&[1, 1, 2, 3, 4]);
    let run = run(style, repeats, dice);
    let turns = excitation::is_turning(style);
    let effects: Vec<&str> = if turns { [OF_TORQUE, OF_MOTION].concat() } else { OF_TORQUE.to_vec() };
    let plan = Plan::draw(dice, &effects, if turns { OUTSIDE_OF_MOTION } else { OUTSIDE });
    // A joint that always slips a little, as its model states.
    let slips = !plan.hides("torsional_hysteresis") && dice.uniform(0.0, 1.0) < 0.3;
    let full = run.full_twist;
    let base = |id, values| Part { id, values };
    let mut parts = vec![
        base("offset", vec![dice.uniform(-1e-3, 1e-3); run.time.len()]),
        base("compliance", run.torque.iter().map(|t| full * t / run.full_nm).collect()),
    ];
    if slips {
        parts.push(base("torsional_hysteresis", twist("torsional_hysteresis", &run, dice)));
    }
    let hidden: Vec<Part> = plan.hidden.iter().map(|id| base(id, twist(id, &run, dice))).collect();
    let outside = plan.outside.map(|id| base(id, twist(id, &run, dice)));
    let alternatives = OF_TORQUE.iter().chain(OF_MOTION).flat_map(|id| [*id; SHAPES]);
    let mut alternatives: Vec<Part> =
        alternatives.filter(|id| turns || !OF_MOTION.contains(id)).map(|id| base(id, twist(id, &run, dice))).collect();
    if hidden.is_empty() {
        alternatives.clear();
    }
    let truth = truth(&parts, &plan, &run);
    let (columns, response, meta) = shown(&run, &parts, hidden.iter().chain(&outside), repeats, dice);
    let optional = if plan.hides("torsional_hysteresis") { vec!["hardening"] } else { Vec::new() };
    let facts = json!({"fs": run.rate_hz, "repeats": repeats, "duration_s": run.time.last()});
    Recording {
        meta: Meta { baseline: parts.iter().map(|p| p.id.to_owned()).collect(), ..meta },
        style,
        columns,
        response,
        base: parts,
        hidden,
        outside,
        alternatives,
        truth,
        optional,
        facts: facts.as_object().cloned().unwrap_or_default(),
    }
}

fn run(style: &str, repeats: usize, dice: &mut Dice) -> Run {
    let rate_hz = *dice.pick(&[100.0, 250.0, 500.0]);
    let (full_nm, speed) = (dice.size(8.0, 120.0), dice.uniform(0.15, 0.8));
    let program = excitation::draw(style, rate_hz, dice);
    let rows = program.torque.len();
    let (start, heat) = (dice.phase(), (dice.uniform(-4.0, 1.0), dice.uniform(4.0, 14.0), dice.uniform(15.0, 60.0)));
    let (mut at, mut link) = (start, Vec::new());
    for (i, speed_share) in program.speed.iter().cycle().take(rows * repeats).enumerate() {
        let next = *program.speed.get((i + 1) % rows).unwrap_or(speed_share);
        at += 0.5 * (speed_share + next) * speed / rate_hz;
        link.push(at);
    }
    let time: Vec<f64> = (0..rows * repeats).map(|i| i as f64 / rate_hz).collect();
    let again = |values: &[f64]| values.iter().cycle().take(rows * repeats).copied().collect::<Vec<f64>>();
    Run {
        torque: again(&program.torque).iter().map(|s| s * full_nm).collect(),
        velocity: again(&program.speed).iter().map(|s| s * speed).collect(),
        warmth: time.iter().map(|t| heat.0 + heat.1 * (1.0 - (-t / heat.2).exp())).collect(),
        segment: again(&program.segment),
        repeat: (0..rows * repeats).map(|i| (i / rows) as f64).collect(),
        time,
        link,
        rate_hz,
        full_nm,
        full_twist: full_nm * dice.size(1e-5, 4e-4),
        speed,
    }
}

/// Compliance is shared with other effects that follow the torque.
fn truth(base: &[Part], plan: &Plan, run: &Run) -> BTreeMap<String, f64> {
    let shared = ["torsional_hysteresis", "hardening", "creep", "backlash", "temperature_compliance", "soft_window"];
    let mut truth = BTreeMap::new();
    if base.len() == 2 && !shared.iter().any(|id| plan.hides(id)) {
        truth.insert("compliance.inverse_k".to_owned(), run.full_twist / run.full_nm);
        if plan.outside.is_none() && !plan.hides("transmission_error") {
            truth.insert("offset.xi".into(), base[0].values[0]);
        }
    }
    truth
}

type Shown = (Vec<(&'static str, Vec<f64>)>, Vec<f64>, Meta);

fn shown<'p>(
    run: &Run,
    base: &'p [Part],
    more: impl Iterator<Item = &'p Part>,
    repeats: usize,
    dice: &mut Dice,
) -> Shown {
    let gear = *dice.pick(&[9.0, 25.0, 50.0, 80.0, 100.0, 160.0]);
    let (motor_step, link_step) = (TAU / 65_536.0, TAU / 16_777_216.0);
    let mut noise =
        Coloured::new(run.full_twist * dice.size(1e-3, 1e-2), dice.uniform(0.0, 0.5), dice.uniform(0.5, 0.9));
    let mut twist = vec![0.0; run.time.len()];
    let parts: Vec<&Part> = base.iter().chain(more).collect();
    parts.iter().for_each(|p| twist.iter_mut().zip(&p.values).for_each(|(t, v)| *t += v));
    // A locked link still yields a little, in its bearing.
    let gives = run.full_twist / run.full_nm * dice.size(1e-3, 1e-2);
    let link: Vec<f64> = run.link.iter().zip(&run.torque).map(|(q, t)| rounded(q - gives * t, link_step)).collect();
    let motor: Vec<f64> = (0..twist.len())
        .map(|i| rounded(gear * (run.link[i] - gives * run.torque[i] + twist[i] + noise.next(dice)), motor_step))
        .collect();
    let response = motor.iter().zip(&link).map(|(m, q)| m / gear - q).collect();
    let quiet = run.full_nm * dice.size(3e-4, 2e-3);
    let mut columns = vec![
        ("time_s", run.time.clone()),
        ("motor_position_rad", motor),
        ("link_position_rad", link),
        ("link_torque_nm", run.torque.iter().map(|t| t + quiet * dice.normal()).collect()),
    ];
    if dice.coin() {
        columns.push(("link_velocity_rad_s", run.velocity.iter().map(|v| v + 2e-4 * dice.normal()).collect()));
    }
    if dice.uniform(0.0, 1.0) < 0.8 {
        columns.push(("temperature_c", run.warmth.iter().map(|w| rounded(25.0 + w, 0.05)).collect()));
    }
    if dice.coin() {
        columns.push(("segment", run.segment.clone()));
    }
    if repeats > 1 && dice.uniform(0.0, 1.0) < 0.8 {
        columns.push(("repeat", run.repeat.clone()));
    }
    columns.iter_mut().flat_map(|(_, c)| c).for_each(|v| *v = written(*v));
    let meta = Meta {
        kind: Some(Kind::Stiffness),
        gear_ratio: Some(gear),
        sample_rate_hz: Some(run.rate_hz),
        ..Meta::default()
    };
    (columns, response, meta)
}
