//! Brake runs: currents of all shapes on a rotating shaft.

mod laws;

use super::draw::Plan;
use super::recording::{Part, Recording, written};
use super::waves::{lag, lines, multisine, sine, stairs};
use crate::made::{Coloured, Dice, rounded};
use jointbench_instrument::{Kind, Meta};
use laws::{EFFECTS, OUTSIDE, torque};
use serde_json::json;
use std::collections::BTreeMap;

/// The truth at every row.
pub struct Run {
    pub time: Vec<f64>,
    pub current: Vec<f64>,
    pub velocity: Vec<f64>,
    pub angle: Vec<f64>,
    pub warmth: Vec<f64>,
    pub segment: Vec<f64>,
    pub repeat: Vec<f64>,
    pub fastest: f64,
    pub full_nm: f64,
    pub poles: u32,
    pub rated_a: f64,
}

const STYLES: &[&str] = &["triangle", "stairs", "nested_loops", "sine", "multisine", "random_levels"];
const SHAPES: usize = 5;

pub fn make(dice: &mut Dice) -> Recording {
    let style = *dice.pick(STYLES);
    let (rate_hz, repeats) = (*dice.pick(&[100.0, 200.0, 500.0]), *dice.pick(&[1, 2, 3, 4]));
    let run = run(style, rate_hz, repeats, dice);
    let plan = Plan::draw(dice, EFFECTS, OUTSIDE);
    let mut ids = vec!["torque_per_current"];
    ids.extend((!plan.hides("drag")).then_some("drag"));
    let more = dice.uniform(0.0, 1.0);
    ids.extend((more < 0.5 && !plan.hides("saturation")).then_some("saturation"));
    ids.extend((more < 0.3 && !plan.hides("hysteresis")).then_some("hysteresis"));
    let mut part = |id: &&'static str| Part { id, values: torque(id, &run, dice) };
    let base: Vec<Part> = ids.iter().map(&mut part).collect();
    let hidden: Vec<Part> = plan.hidden.iter().map(&mut part).collect();
    let outside = plan.outside.as_ref().map(&mut part);
    let shapes: Vec<&str> = EFFECTS.iter().flat_map(|id| [*id; SHAPES]).collect();
    let alternatives = if hidden.is_empty() { Vec::new() } else { shapes.iter().map(&mut part).collect() };
    let truth = truth(&base, &plan, &run);
    let (columns, response, meta) = shown(&run, base.iter().chain(&hidden).chain(&outside), repeats, dice);
    let facts = json!({"fs": rate_hz, "repeats": repeats, "duration_s": run.time.last()});
    Recording {
        meta: Meta { baseline: ids.iter().map(|id| (*id).to_owned()).collect(), sample_rate_hz: Some(rate_hz), ..meta },
        style,
        columns,
        response,
        base,
        hidden,
        outside,
        alternatives,
        truth,
        optional: if plan.hides("hysteresis") || ids.contains(&"hysteresis") { vec!["saturation"] } else { Vec::new() },
        facts: facts.as_object().cloned().unwrap_or_default(),
    }
}

fn profile(style: &str, rate_hz: f64, dice: &mut Dice) -> Vec<f64> {
    let slow = dice.uniform(4.0, 9.0);
    match style {
        "triangle" => lines(&[(0.02, 0.0), (slow, 1.0), (slow, 0.0), (slow, 1.0), (slow, 0.0)], rate_hz),
        "stairs" => {
            let count = dice.uniform(6.0, 10.0) as usize;
            let up: Vec<f64> = (0..=count).map(|i| i as f64 / count as f64).collect();
            let levels: Vec<f64> = up.iter().chain(up.iter().rev()).copied().collect();
            stairs(&levels, 0.2, dice.uniform(0.8, 1.6), rate_hz)
        }
        "nested_loops" => {
            let peaks = [1.0, 0.2, 0.8, 0.3, 0.65, 0.4, 0.55, 0.0];
            lines(
                &peaks
                    .iter()
                    .scan(0.0, |at, to| {
                        let way: f64 = to - *at;
                        *at = *to;
                        Some((slow * way.abs().max(0.01), *to))
                    })
                    .collect::<Vec<_>>(),
                rate_hz,
            )
        }
        "sine" => sine(0.4 / slow, 3.0, rate_hz).iter().map(|v| v.abs()).collect(),
        "multisine" => multisine(5.0 * slow, rate_hz, dice).iter().map(|v| 0.5 + 0.5 * v).collect(),
        _ => {
            let levels: Vec<f64> = (0..14).map(|_| dice.uniform(0.0, 1.0)).collect();
            stairs(&levels, 0.3, dice.uniform(0.8, 2.0), rate_hz)
        }
    }
}

fn run(style: &str, rate_hz: f64, repeats: usize, dice: &mut Dice) -> Run {
    let one = profile(style, rate_hz, dice);
    let one = lag(&one, 1.0 - (-1.0 / (0.02 * rate_hz)).exp());
    let (rows, fastest) = (one.len() * repeats, dice.uniform(4.0, 25.0));
    // The drive uses a few speeds, each for a while.
    let speeds: Vec<f64> = (0..3 * repeats).map(|_| fastest * dice.size(0.15, 1.0)).collect();
    let wished: Vec<f64> = (0..rows).map(|i| speeds[i * speeds.len() / rows]).collect();
    let velocity = lag(&wished, 1.0 - (-1.0 / (0.2 * rate_hz)).exp());
    let mut angle = dice.phase();
    let turn = |v: &f64| {
        angle += v / rate_hz;
        angle
    };
    let angles: Vec<f64> = velocity.iter().map(turn).collect();
    let heat = (dice.uniform(-4.0, 2.0), dice.uniform(5.0, 20.0), dice.uniform(20.0, 80.0));
    let time: Vec<f64> = (0..rows).map(|i| i as f64 / rate_hz).collect();
    Run {
        current: one.iter().cycle().take(rows).copied().collect(),
        velocity,
        angle: angles,
        warmth: time.iter().map(|t| heat.0 + heat.1 * (1.0 - (-t / heat.2).exp())).collect(),
        segment: (0..rows).map(|i| (i * speeds.len() / rows) as f64).collect(),
        repeat: (0..rows).map(|i| (i / one.len()) as f64).collect(),
        time,
        fastest,
        full_nm: dice.size(0.4, 15.0),
        poles: *dice.pick(&[6, 8, 12, 16]),
        rated_a: dice.size(0.2, 2.0),
    }
}

fn truth(base: &[Part], plan: &Plan, run: &Run) -> BTreeMap<String, f64> {
    let shared = ["saturation", "hysteresis", "temperature_dependence", "velocity_dependence"];
    let is_shared = shared.iter().any(|id| plan.hides(id) || base.iter().any(|p| p.id == *id));
    let mut truth = BTreeMap::new();
    if !is_shared && plan.outside.is_none() {
        truth.insert("torque_per_current.k_b".to_owned(), run.full_nm / run.rated_a);
        truth.extend(base.iter().find(|p| p.id == "drag").map(|d| ("drag.tau_0".to_owned(), d.values[0])));
    }
    truth
}

type Shown = (Vec<(&'static str, Vec<f64>)>, Vec<f64>, Meta);

fn shown<'p>(run: &Run, parts: impl Iterator<Item = &'p Part>, repeats: usize, dice: &mut Dice) -> Shown {
    let rated = run.rated_a;
    let mut noise = Coloured::new(run.full_nm * dice.size(2e-3, 8e-3), dice.uniform(0.0, 0.5), dice.uniform(0.5, 0.9));
    let mut torque: Vec<f64> = run.time.iter().map(|_| noise.next(dice)).collect();
    parts.for_each(|p| torque.iter_mut().zip(&p.values).for_each(|(t, v)| *t += v));
    let mut columns = vec![
        ("time_s", run.time.clone()),
        ("brake_current_a", run.current.iter().map(|i| rated * (i + 5e-4 * dice.normal())).collect::<Vec<f64>>()),
        ("brake_torque_nm", torque.clone()),
        ("velocity_rad_s", run.velocity.iter().map(|v| v + 2e-3 * run.fastest * dice.normal()).collect()),
        ("position_rad", run.angle.iter().map(|a| rounded(*a, std::f64::consts::TAU / 65_536.0)).collect()),
        ("temperature_c", run.warmth.iter().map(|w| rounded(25.0 + w, 0.1)).collect()),
    ];
    if dice.coin() {
        columns.push(("segment", run.segment.clone()));
    }
    if repeats > 1 && dice.uniform(0.0, 1.0) < 0.8 {
        columns.push(("repeat", run.repeat.clone()));
    }
    columns.iter_mut().flat_map(|(_, c)| c).for_each(|v| *v = written(*v));
    let meta = Meta {
        kind: Some(Kind::Brake),
        rated_current_a: Some(rated),
        poles: dice.coin().then_some(run.poles),
        ..Meta::default()
    };
    (columns, torque, meta)
}
