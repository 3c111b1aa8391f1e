//! `jointbench demo`: the main job without a further word.

use crate::program::{run, stderr, stdout};

fn demo(more: &[&str]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().display().to_string();
    let arguments = [&["demo", "--exit", "--listen", "127.0.0.1:0", "--data", &data], more].concat();
    let output = run(&arguments);
    let said = stdout(&output);
    assert!(output.status.success(), "{said}\n{}", stderr(&output));
    said
}

#[test]
fn the_hidden_effect_is_found() {
    let said = demo(&["--effect", "load_linear"]);
    assert!(said.contains("Missing effect found: load_linear."), "{said}");
}

#[test]
fn an_unknown_effect_is_refused_with_what_there_is() {
    let output = run(&["demo", "--exit", "--effect", "magic"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("stribeck"), "{}", stderr(&output));
}
