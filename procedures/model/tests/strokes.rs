//! A stiffness run over an eighth of a turn: structure over the link angle there does not determine the rest of the
//! turn.

mod common;

use common::tables::{meta, scatter, stiffness};
use jointbench_instrument::{Kind, RunTable};
use jointbench_model::{Discovery, ModelSpec, Options, ParameterState, Verdict, discover};

const STEP_S: f64 = 0.01;
const GEAR: f64 = 50.0;
const SPEED: f64 = 0.5;

/// Strokes back and forth under a torque that rises from leg to leg; `error` is the additional twist of the teeth.
fn run(error: impl Fn(f64) -> f64) -> RunTable {
    noisy(7e-5, 1, error)
}

/// The same with scatter of the twist.
fn noisy(scatter_rad: f64, mix: u64, error: impl Fn(f64) -> f64) -> RunTable {
    let mut trace = stiffness();
    let mut link = 0.2;
    for i in 0..4800 {
        let leg = i / 150;
        let side = if leg % 2 == 0 { 1.0 } else { -1.0 };
        link += side * SPEED * STEP_S;
        let torque = side * [0.0, 2.0, 4.0, 7.0, 10.0, 15.0, 20.0, 30.0][leg / 2 % 8];
        let twist = 1e-3 + torque / 9000.0 + error(link) + scatter_rad * scatter(i, mix);
        let (time, leg, repeat) = (i as f64 * STEP_S, leg as f64, (leg / 16) as f64);
        trace.push_row(&[time, GEAR * (link + twist), link, side * SPEED, torque + 0.03 * scatter(i, 2), leg, repeat]);
    }
    RunTable::new(meta(Kind::Stiffness), trace).unwrap()
}

fn end(run: &RunTable) -> Discovery {
    discover(run, &ModelSpec::baseline(run).unwrap(), &Options::default(), 4).unwrap()
}

#[test]
fn a_bump_is_no_wave_over_the_turn() {
    for (middle, width) in [(0.5, 0.1), (0.6, 0.08), (0.4, 0.12)] {
        let found = end(&run(|link: f64| 5e-4 * (-((link - middle) / width).powi(2)).exp()));
        assert_eq!(found.model, ["offset", "compliance"], "{}", found.summary);
        assert_eq!(found.verdict, Verdict::UnexplainedStructure, "{}", found.summary);
        assert!(found.summary.contains("link position"), "{}", found.summary);
    }
}

/// Two to three times the noise of a sample (60 µrad): with a fitted wave of one period, the remaining bump is below
/// the threshold of structure.
#[test]
fn a_weak_bump_is_no_wave_either() {
    for (mix, (middle, width, size)) in
        [(0.66, 0.16, 1.6e-4), (0.72, 0.18, 1.5e-4), (0.73, 0.18, 1.4e-4), (0.5, 0.15, 1.5e-4)].into_iter().enumerate()
    {
        let bump = |link: f64| size * (-((link - middle) / width).powi(2)).exp();
        let found = end(&noisy(2.1e-4, 10 + mix as u64, bump));
        assert_eq!(found.model, ["offset", "compliance"], "{middle}: {}", found.summary);
        assert_eq!(found.verdict, Verdict::UnexplainedStructure, "{}", found.summary);
    }
    // An equally weak wave of one period and a half is one.
    for mix in 20..24 {
        let found = end(&noisy(2.1e-4, mix, |link| 1e-4 * (12.0 * link + 0.3).sin()));
        assert_eq!(found.model.last().map(String::as_str), Some("transmission_error"), "{}", found.summary);
    }
}

/// A quarter of a period, which a slower and a faster wave fit as well, and one and a half periods, which none does.
#[test]
fn a_number_of_waves_that_the_run_does_not_determine_stays_open() {
    for (waves, size, is_open) in [(2.0, 3e-4, true), (12.0, 3e-4, false)] {
        let found = end(&run(|link: f64| size * (waves * link + 0.3).sin()));
        assert_eq!(found.model.last().map(String::as_str), Some("transmission_error"), "{}", found.summary);
        let number = found.fit.parameters.iter().find(|p| p.name == "harmonic").unwrap();
        assert!((number.ci95[0]..=number.ci95[1]).contains(&waves), "{number:?}");
        assert_eq!(number.state != ParameterState::Ok, is_open, "{number:?}");
        assert_eq!(number.note.as_ref().is_some_and(|n| n.contains("over more of the turn")), is_open, "{number:?}");
        let of_truth = |name: &str, value: f64| {
            let coefficient = found.fit.parameters.iter().find(|p| p.effect == "transmission_error" && p.name == name);
            let [low, high] = coefficient.unwrap().ci95;
            assert!(low <= value && value <= high, "{name}: {low} to {high} around {value}");
        };
        of_truth("a", size * 0.3f64.sin());
        of_truth("b", size * 0.3f64.cos());
    }
}
