//! Encoder runs: two encoders on one shaft that sweeps, stops, and moves back and forth.

mod laws;

use super::draw::Plan;
use super::recording::{Part, Recording, written};
use super::waves::{lag, lines, sine, stairs};
use crate::made::{Coloured, Dice, rounded};
use jointbench_instrument::{Kind, Meta};
use laws::{EFFECTS, OUTSIDE, error};
use serde_json::json;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// The truth at every row.
pub struct Run {
    pub time: Vec<f64>,
    pub velocity: Vec<f64>,
    pub angle: Vec<f64>,
    pub warmth: Vec<f64>,
    pub segment: Vec<f64>,
    pub repeat: Vec<f64>,
    pub rate_hz: f64,
    pub fastest: f64,
    pub pole_pairs: u32,
    pub noise: f64,
}

const STYLES: &[&str] = &["sweep", "trapezoid", "stair_random", "pick_place", "sine"];
const SHAPES: usize = 4;

pub fn make(dice: &mut Dice) -> Recording {
    let style = *dice.pick(STYLES);
    let (rate_hz, repeats) = (*dice.pick(&[100.0, 200.0, 500.0]), *dice.pick(&[1, 2, 3]));
    let run = run(style, rate_hz, repeats, dice);
    let effects: Vec<&str> = EFFECTS.iter().copied().filter(|id| *id != "startup_offset" || repeats > 1).collect();
    let plan = Plan::draw(dice, &effects, OUTSIDE);
    let zero = dice.uniform(-0.9, 0.9);
    let base = vec![Part { id: "offset", values: vec![zero; run.time.len()] }];
    let mut part = |id: &&'static str| Part { id, values: error(id, &run, dice) };
    let hidden: Vec<Part> = plan.hidden.iter().map(&mut part).collect();
    let outside = plan.outside.as_ref().map(&mut part);
    let shapes: Vec<&str> = effects.iter().flat_map(|id| [*id; SHAPES]).collect();
    let mut alternatives: Vec<Part> =
        if hidden.is_empty() { Vec::new() } else { shapes.iter().map(&mut part).collect() };
    // A step between two repeats is a start-up offset as well.
    if repeats == 2 && !alternatives.is_empty() {
        alternatives.push(Part { id: "slip", values: run.repeat.clone() });
    }
    let mut truth = BTreeMap::new();
    if !["slip", "startup_offset", "temperature_drift"].iter().any(|id| plan.hides(id)) {
        truth.insert("offset.xi".to_owned(), zero);
    }
    let (columns, response, meta) = shown(&run, base.iter().chain(&hidden).chain(&outside), repeats, dice);
    let mut optional = Vec::new();
    optional.extend(plan.hides("harmonic_1").then_some("harmonic_2"));
    optional.extend(plan.hides("pole_period").then_some("harmonic_n"));
    let facts = json!({"fs": rate_hz, "repeats": repeats, "duration_s": run.time.last()});
    Recording {
        meta: Meta { baseline: vec!["offset".into()], sample_rate_hz: Some(rate_hz), ..meta },
        style,
        columns,
        response,
        base,
        hidden,
        outside,
        alternatives,
        truth,
        optional,
        facts: facts.as_object().cloned().unwrap_or_default(),
    }
}

fn speeds(style: &str, rate_hz: f64, dice: &mut Dice) -> Vec<f64> {
    match style {
        "sweep" => lines(&[(3.0, 1.0), (12.0, 1.0), (2.0, 0.0), (3.0, -1.0), (12.0, -1.0), (2.0, 0.0)], rate_hz),
        "trapezoid" => {
            let levels: Vec<f64> = (0..5)
                .flat_map(|_| {
                    let speed = dice.uniform(0.2, 1.0);
                    [speed, -speed]
                })
                .collect();
            stairs(&levels, 0.4, dice.uniform(1.5, 3.0), rate_hz)
        }
        "stair_random" => {
            let mut levels: Vec<f64> = (1..=6).flat_map(|i| [f64::from(i) / 6.0, -f64::from(i) / 6.0]).collect();
            dice.shuffle(&mut levels);
            stairs(&levels, 0.3, dice.uniform(1.5, 3.0), rate_hz)
        }
        "pick_place" => {
            let mut moves = Vec::new();
            for _ in 0..14 {
                let speed = dice.uniform(0.2, 1.0) * dice.sign();
                moves.extend([(0.4, speed), (dice.uniform(0.2, 1.5), speed), (0.4, 0.0), (0.4, 0.0)]);
            }
            lines(&moves, rate_hz)
        }
        _ => sine(dice.size(0.05, 0.2), 3.0, rate_hz),
    }
}

fn run(style: &str, rate_hz: f64, repeats: usize, dice: &mut Dice) -> Run {
    let mut one = speeds(style, rate_hz, dice);
    one.extend(lines(&[(0.3, 0.0)], rate_hz));
    let (rows, fastest) = (one.len() * repeats, dice.uniform(2.0, 12.0));
    let wished: Vec<f64> = one.iter().cycle().take(rows).map(|v| v * fastest).collect();
    let velocity = lag(&wished, 1.0 - (-1.0 / (0.05 * rate_hz)).exp());
    let mut angle = dice.phase();
    let turn = |v: &f64| {
        angle += v / rate_hz;
        angle
    };
    let angles: Vec<f64> = velocity.iter().map(turn).collect();
    let heat = (dice.uniform(-4.0, 2.0), dice.uniform(4.0, 12.0), dice.uniform(15.0, 60.0));
    let time: Vec<f64> = (0..rows).map(|i| i as f64 / rate_hz).collect();
    Run {
        velocity,
        angle: angles,
        warmth: time.iter().map(|t| heat.0 + heat.1 * (1.0 - (-t / heat.2).exp())).collect(),
        segment: (0..rows).map(|i| (8 * (i % one.len()) / one.len()) as f64).collect(),
        repeat: (0..rows).map(|i| (i / one.len()) as f64).collect(),
        time,
        rate_hz,
        fastest,
        pole_pairs: *dice.pick(&[8, 16, 32]),
        noise: dice.size(4e-6, 6e-5),
    }
}

type Shown = (Vec<(&'static str, Vec<f64>)>, Vec<f64>, Meta);

fn shown<'p>(run: &Run, parts: impl Iterator<Item = &'p Part>, repeats: usize, dice: &mut Dice) -> Shown {
    let (test_bits, reference_bits) = (*dice.pick(&[16u32, 19, 21]), *dice.pick(&[20u32, 22, 24]));
    let step = |bits: u32| TAU / f64::from(1u32 << bits);
    let mut noise = Coloured::new(run.noise, dice.uniform(0.0, 0.5), dice.uniform(0.5, 0.9));
    let mut wrong: Vec<f64> = run.time.iter().map(|_| noise.next(dice)).collect();
    parts.for_each(|p| wrong.iter_mut().zip(&p.values).for_each(|(w, v)| *w += v));
    let wrap = |a: f64| (a + PI).rem_euclid(TAU) - PI;
    let reference: Vec<f64> = run.angle.iter().map(|a| wrap(rounded(*a, step(reference_bits)))).collect();
    let test: Vec<f64> = run.angle.iter().zip(&wrong).map(|(a, w)| wrap(rounded(a + w, step(test_bits)))).collect();
    let response = test.iter().zip(&reference).map(|(t, r)| wrap(t - r)).collect();
    let mut columns =
        vec![("time_s", run.time.clone()), ("reference_position_rad", reference), ("test_position_rad", test)];
    match dice.uniform(0.0, 3.0) as u32 {
        0 => columns
            .push(("velocity_rad_s", run.velocity.iter().map(|v| v + 2e-3 * run.fastest * dice.normal()).collect())),
        1 => columns.push(("velocity_rad_s", lag(&run.velocity, 1.0 - (-1.0 / (0.01 * run.rate_hz)).exp()))),
        _ => {}
    }
    if dice.uniform(0.0, 1.0) < 0.8 {
        columns.push(("temperature_c", run.warmth.iter().map(|w| rounded(25.0 + w, 0.05)).collect()));
    }
    if dice.coin() {
        columns.push(("segment", run.segment.clone()));
    }
    if repeats > 1 {
        columns.push(("repeat", run.repeat.clone()));
    }
    columns.iter_mut().flat_map(|(_, c)| c).for_each(|v| *v = written(*v));
    let meta = Meta {
        kind: Some(Kind::Encoder),
        reference_bits: Some(reference_bits),
        test_bits: Some(test_bits),
        pole_pairs: dice.coin().then_some(run.pole_pairs),
        ..Meta::default()
    };
    (columns, response, meta)
}
