//! Confounding with temperature: a temperature effect may be one of time, or of an unknown column.

mod common;

use common::bench::Staircase;
use jointbench_instrument::{Channel, RunTable, Trace};
use jointbench_model::{Choice, Diagnosis, ModelSpec, Next, Open, Options, Stretch, diagnose, discover, next_run};

/// The staircase takes about 72 s.
fn waving_c(time_s: f64) -> f64 {
    25.0 + 6.0 * (0.5 * time_s).sin()
}

fn warming_c(time_s: f64) -> f64 {
    22.0 + 0.15 * time_s
}

/// Coulomb friction that falls with the temperature, which a column contains, and additional pressure columns.
fn run(temperature_c: fn(f64) -> f64, pressures: &[(&str, &dyn Fn(f64) -> f64)]) -> RunTable {
    let steps = Staircase { noise_nm: 2e-3, scatter_nm: 1e-4, seed: 3 }.run(|m| {
        let tau_c = 0.03 - 8e-4 * (temperature_c(m.time) - 25.0);
        tau_c * m.velocity.signum() + 2e-4 * m.velocity
    });
    let (meta, trace) = steps.into_parts();
    let more = std::iter::once("temperature_c").chain(pressures.iter().map(|(name, _)| *name));
    let names = trace.channels().iter().map(|c| c.name.clone()).chain(more.map(String::from));
    let mut with = Trace::new(names.map(Channel::new).collect());
    for (row, time_s) in trace.column("time_s").unwrap().iter().enumerate() {
        let known = trace.channels().iter().map(|c| trace.column(&c.name).unwrap()[row]);
        let more = std::iter::once(temperature_c(*time_s)).chain(pressures.iter().map(|(_, of)| of(*time_s)));
        with.push_row(&known.chain(more).collect::<Vec<_>>());
    }
    RunTable::new(meta, with).unwrap()
}

fn diagnosed(run: &RunTable) -> Diagnosis {
    let found = diagnose(run, &ModelSpec::baseline(run).unwrap(), &Options::default()).unwrap();
    assert_eq!(found.suggestions[0].effect, "temperature_coulomb", "{}", found.summary);
    found
}

#[test]
fn a_column_that_moves_with_the_temperature_is_reported_with_it() {
    let oil = |time_s: f64| 1e5 - 2e3 * (waving_c(time_s) - 25.0) + 2e3 * (3.0 * time_s).sin();
    let air = |time_s: f64| 1e5 + 2e3 * (0.31 * time_s).sin();
    let run = run(waving_c, &[("oil_pressure_pa", &oil), ("air_pressure_pa", &air)]);
    let why = &diagnosed(&run).suggestions[0].why;
    assert!(why.contains("oil_pressure_pa moves with temperature_c in this data (r = -0.9"), "{why}");
    assert!(!why.contains("air_pressure_pa") && !why.contains("drift over time"), "{why}");
    let found = discover(&run, &ModelSpec::baseline(&run).unwrap(), &Options::default(), 4).unwrap();
    let reported = found.fit.notes.iter().filter(|note| note.starts_with("oil_pressure_pa moves with")).count();
    assert_eq!(reported, 1, "{:?}", found.fit.notes);
}

/// Speeds up and down, at the temperature of the end of the run.
fn strokes(duration_s: f64) -> Choice {
    let stretch = |i: u32| Stretch {
        start_s: f64::from(i) * duration_s,
        duration_s,
        velocity_rad_s: [20.0, -20.0, 60.0, -60.0][i as usize % 4],
        ..Stretch::default()
    };
    let stretches: Vec<Stretch> = (0..16).map(stretch).collect();
    let duration_s = 16.0 * duration_s;
    Choice { procedure: "friction".into(), parameters: serde_json::Map::new(), duration_s, stretches }
}

#[test]
fn a_temperature_that_only_rose_with_time_is_no_drift_until_a_run_decides() {
    let run = run(warming_c, &[]);
    let found = diagnosed(&run);
    let why = &found.suggestions[0].why;
    assert!(
        why.contains("temperature_c moves with time in this data (r = 1.00): a drift over time looks almost the same"),
        "{why}"
    );
    let ask = |run: &RunTable, found: &Diagnosis, menu: &[Choice]| -> Next {
        next_run(run, &Open::from(found), menu, &Options::default()).unwrap()
    };
    let next = ask(&run, &found, &[strokes(2.0)]).experiment.unwrap();
    assert!(next.why.starts_with("it would distinguish temperature_coulomb from a drift over time ("), "{}", next.why);
    assert!(next.expected_z.unwrap() > 4.0 && next.separates == ["temperature_coulomb"], "{next:?}");
    assert_eq!(ask(&run, &found, &[]), Next::default());
    let run = self::run(waving_c, &[]);
    let found = diagnosed(&run);
    let next = ask(&run, &found, &[strokes(2.0)]);
    assert!(next.experiment.is_none_or(|next| !next.why.contains("drift over time")));
}
