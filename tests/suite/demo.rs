//! `jointbench demo`: the main workflow without further arguments.

use crate::program::{run, stderr, stdout};

fn demo(more: &[&str]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().display().to_string();
    let arguments = [&["demo", "--exit", "--listen", "127.0.0.1:0", "--data", &data], more].concat();
    let output = run(&arguments);
    let text = stdout(&output);
    assert!(output.status.success(), "{text}\n{}", stderr(&output));
    text
}

#[test]
fn the_hidden_effect_is_found() {
    let text = demo(&["--effect", "load_linear"]);
    assert!(text.contains("Missing effect found: load_linear."), "{text}");
}

fn assert_found(kind: &str, effect: &str) {
    let text = demo(&["--kind", kind, "--effect", effect]);
    let found = text.lines().find_map(|line| line.strip_prefix("Missing effect found: ")).expect("the conclusion");
    let (names, hidden) = found.split_once(". Hidden effect: ").expect("both");
    assert!(names == effect && hidden.starts_with(effect), "{text}");
}

#[test]
fn an_encoder_bench_shows_what_it_hides() {
    assert_found("encoder", "slip");
}

#[test]
fn a_gear_shows_what_it_hides() {
    assert_found("stiffness", "creep");
}

#[test]
fn a_brake_shows_what_it_hides() {
    assert_found("brake", "velocity_dependence");
}

#[test]
fn an_unknown_effect_is_refused_with_what_there_is() {
    let output = run(&["demo", "--exit", "--effect", "magic"]);
    assert_eq!(output.status.code(), Some(2));
    for known in ["friction: stribeck", "encoder: harmonic_n", "stiffness: hardening", "brake: "] {
        assert!(stderr(&output).contains(known), "{}", stderr(&output));
    }
    let output = run(&["demo", "--exit", "--kind", "encoder", "--effect", "stribeck"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("slip") && !stderr(&output).contains("gravity"), "{}", stderr(&output));
}
