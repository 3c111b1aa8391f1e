//! Differences between runs.

use crate::daemon::TestDaemon;
use crate::import::upload;
use serde_json::Value;
use std::f64::consts::TAU;

const META: &str = r#"{"kind": "friction", "torque_constant_nm_per_a": 0.04}"#;
/// Additional current in the second run, only forwards.
const MORE_A: f64 = 0.05;

/// Slow strokes in both directions, each with its own error, and faster noise.
fn strokes(more_a: f64, mut seed: u64) -> String {
    let mut noise = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as f64 / (1u64 << 23) as f64 - 1.0
    };
    let mut table = "time_s,motor_position_rad,motor_velocity_rad_s,motor_current_a\n".to_owned();
    let mut own = 0.0;
    for i in 0..8000 {
        if i % 250 == 0 {
            own = 0.01 * noise();
        }
        let phase = TAU * f64::from(i) / 500.0;
        let velocity = 3.0 * phase.cos();
        let current = 0.4 * velocity.signum() + if velocity > 0.0 { more_a } else { 0.0 } + own + 0.01 * noise();
        let position = 3.0 * 500.0 * 0.004 / TAU * phase.sin();
        table += &format!("{},{position},{velocity},{current}\n", 0.004 * f64::from(i));
    }
    table
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

/// Mean of a series, and the share of its bands that contain `truth`.
fn held(series: &Value, truth: f64) -> (f64, f64) {
    let y = numbers(&series["y"]);
    let bands: Vec<Vec<f64>> = series["band"].as_array().unwrap().iter().map(numbers).collect();
    assert!(y.len() > 20 && bands.len() == y.len(), "{} points", y.len());
    let inside = bands.iter().filter(|band| band[0] <= truth && truth <= band[1]).count();
    (y.iter().sum::<f64>() / y.len() as f64, inside as f64 / bands.len() as f64)
}

#[test]
fn a_difference_has_two_standard_errors() {
    let daemon = TestDaemon::start();
    let add = |table: String| upload(&daemon, &table, &[("meta", META)]).1["id"].as_i64().unwrap();
    let (base, other) = (add(strokes(0.0, 1)), add(strokes(MORE_A, 2)));
    let ask =
        |by: &str| daemon.get(&format!("/api/v1/runs/{base}/differences?channel=motor_current_a&others={other}{by}"));

    let (status, figures) = ask("&by=motor_position_rad");
    assert_eq!(status, 200, "{figures}");
    assert_eq!(figures[0]["name"], "mean");
    assert_eq!(figures[1]["x"], serde_json::json!({"label": "motor position", "unit": "rad"}));
    for (series, way, truth) in [(0, "forwards", MORE_A), (1, "backwards", 0.0)] {
        let series = &figures[1]["series"][series];
        assert_eq!(series["label"], format!("#{other} − #{base}, {way}"));
        let (mean, inside) = held(series, truth);
        assert!((mean - truth).abs() < 0.01 && inside > 0.8, "{way}: {mean}, {inside}");
    }
    // The sign of the velocity contains the direction.
    let (_, figures) = ask("&by=motor_velocity_rad_s");
    assert_eq!(figures[1]["series"].as_array().unwrap().len(), 1);
    // Over time, each place occurs once: the noise is the scatter within it.
    let (_, figures) = ask("");
    assert_eq!((figures.as_array().unwrap().len(), &figures[0]["name"]), (1, &"difference".into()));
    let mean = held(&figures[0]["series"][0], 0.0).0;
    assert!((mean - MORE_A / 2.0).abs() < 0.01, "{mean}");
    // A short run has its own time range and does not limit the other run.
    let short = add(strokes(0.0, 3).lines().take(1001).map(|line| format!("{line}\n")).collect());
    let (_, both) = ask(&format!(",{short}"));
    assert_eq!(both[0]["series"][0], figures[0]["series"][0]);
    held(&both[0]["series"][1], 0.0);
    assert!(numbers(&both[0]["series"][1]["x"]).iter().all(|at_s| (0.0..4.0).contains(at_s)));

    for (query, refused, why) in [("&by=oil", 404, "no channel oil"), ("&from=the%20end", 422, "no event “the end”")]
    {
        let (status, problem) = ask(query);
        assert!(status == refused && problem["detail"].as_str().unwrap().contains(why), "{query}: {problem}");
    }
    let (status, problem) = daemon.get(&format!("/api/v1/runs/{base}/differences?others=x&channel=motor_current_a"));
    assert!(status == 400 && problem["detail"].as_str().unwrap().contains("others = x"), "{problem}");
}

/// The same under four loads. The current differs much more between loads than between runs.
fn loaded(more_a: f64, seed: u64) -> String {
    let mut table = String::new();
    for (i, line) in strokes(more_a, seed).lines().enumerate() {
        let (row, current) = line.rsplit_once(',').unwrap();
        let load = i / 1000 % 4;
        table += &match current.parse::<f64>() {
            Ok(current) => format!("{row},{},{load}\n", current + load as f64 * current.signum()),
            Err(_) => format!("{line},link_torque_nm\n"),
        };
    }
    table
}

#[test]
fn runs_are_held_against_each_other_under_the_same_load() {
    let daemon = TestDaemon::start();
    let add = |table: String| upload(&daemon, &table, &[("meta", META)]).1["id"].as_i64().unwrap();
    let (base, other) = (add(loaded(0.0, 1)), add(loaded(MORE_A, 2)));
    for by in ["motor_position_rad", "motor_velocity_rad_s"] {
        let (_, figures) =
            daemon.get(&format!("/api/v1/runs/{base}/differences?channel=motor_current_a&others={other}&by={by}"));
        let bands: Vec<Vec<f64>> = figures[1]["series"][0]["band"].as_array().unwrap().iter().map(numbers).collect();
        let wide = bands.iter().filter(|band| band[1] - band[0] > MORE_A).count();
        assert!(bands.len() > 20 && wide * 5 < bands.len(), "{by}: {wide} of {} bands tell nothing", bands.len());
    }
}
