//! `diagnose --maps`: the residual over each quantity that the verdict uses.

use super::json;
use super::user_effects::{run_in, write_run};
use crate::program::{run, stdout};
use crate::shared::shared;
use std::path::Path;

#[test]
fn the_error_is_drawn_over_each_quantity_and_only_where_it_is_asked_for() {
    let Some(case) = shared("hidden-effects/friction-stribeck") else { return };
    let case = case.to_str().expect("a path");
    let drawn = String::from_utf8(run(&["diagnose", case, "--maps"]).stdout).expect("UTF-8");
    let (_, maps) = drawn.split_once("residual maps: ").expect("maps");
    assert!(maps.contains("motor_velocity_rad_s [rad/s]: explains ") && maps.contains('●'), "{maps}");
    assert!(maps.contains("\nno structure over ") && maps.contains("temperature_c"), "{maps}");
    let diagnosis = |more: &[&str]| json("diagnose", Path::new(case), more);
    assert!(diagnosis(&["--maps"])["maps"]["pairs"].as_array().is_some_and(|pairs| !pairs.is_empty()));
    assert!(diagnosis(&[]).get("maps").is_none());
}

/// Pressure of a step, independent of load and speed.
fn pressure_pa(segment: u64) -> f64 {
    1e5 + 2e4 * (segment.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 61) as f64
}

#[test]
fn an_axis_that_the_verdict_names_by_direction_is_not_called_flat() {
    let folder = tempfile::tempdir().expect("a folder");
    write_run(folder.path());
    let table = std::fs::read_to_string(folder.path().join("run.csv")).expect("a table");
    let rubbing = table.lines().enumerate().map(|(i, line)| {
        let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
        if i == 0 {
            fields.push("oil_pressure_pa".to_owned());
        } else {
            let velocity: f64 = fields[2].parse().expect("a velocity");
            let current: f64 = fields[3].parse().expect("a current");
            let pressure_pa = pressure_pa(fields[5].parse().expect("a segment"));
            // More friction at medium pressure: over the pressure alone, the two directions cancel.
            let rub = 0.1 * velocity.signum() * f64::from(u8::from((1.5e5..1.9e5).contains(&pressure_pa)));
            fields[3] = format!("{}", current + rub);
            fields.push(pressure_pa.to_string());
        }
        fields.join(",")
    });
    let rubbing: Vec<String> = rubbing.collect();
    std::fs::write(folder.path().join("run.csv"), rubbing.join("\n")).expect("a table");
    let rub = "rub: tau = a * tanh(velocity / 12) * abs(load); a [1] 0..1";
    let model = "load_transmission,coulomb,viscous,rub";
    let text = stdout(&run_in(folder.path(), &["diagnose", "run.csv", "--own", rub, "--model", model, "--maps"]));
    assert!(text.contains("it is largest over oil pressure and direction, and a function"), "{text}");
    let (_, maps) = text.split_once("mean residual (measured − model)").expect("maps");
    let (drawn, flat) = maps.split_once("\nno structure over ").unwrap_or((maps, ""));
    assert!(!flat.contains("oil_pressure_pa"), "{text}");
    let (_, drawn) = drawn.split_once("oil_pressure_pa [Pa]: explains ").expect("the pressure");
    assert!(drawn.contains(" % by direction"), "{text}");
    let (negative, positive) = drawn.split_once("in positive motion:").expect("both directions");
    assert!(negative.contains("in negative motion:") && positive.contains('●'), "{text}");
}
