//! Measurements with a hidden effect from a simulator that is independent of the library.

mod common;

use common::{read, shared};
use jointbench_instrument::RunTable;
use jointbench_model::{Fit, ModelSpec, Options, Parameter, ParameterState, Verdict, diagnose, discover, fit};
use serde_json::Value;

fn check_family(family: &str) {
    let Some(folder) = shared("hidden-effects") else { return };
    let mut cases: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    cases.retain(|c| c.is_dir() && c.file_name().unwrap().to_string_lossy().starts_with(family));
    for case in cases {
        let answer: Value = serde_json::from_str(&std::fs::read_to_string(case.join("answer.json")).unwrap()).unwrap();
        let accept: Vec<Vec<String>> = serde_json::from_value(answer["accept"].clone()).unwrap();
        let run = read(&case);
        let spec = ModelSpec::baseline(&run).unwrap();
        let first = diagnose(&run, &spec, &Options::default()).unwrap();
        assert!(!first.summary.contains("Attention"), "{}: {}", case.display(), first.summary);
        let whole = discover(&run, &spec, &Options::default(), 6).unwrap();
        let added: Vec<&String> = whole.model.iter().filter(|e| !spec.contains(e)).collect();
        let name = case.file_name().unwrap().to_string_lossy().into_owned();
        let same = fit(&run, &ModelSpec::new(spec.kind, &whole.model).unwrap(), &Options::default()).unwrap();
        assert_eq!(same.parameters, whole.fit.parameters, "{name}: a fit of the same effects is the same model");
        if whole.verdict == Verdict::Adequate {
            check_removed(&name, &run, &whole.fit);
        }
        match answer["verdict"].as_str().unwrap() {
            "adequate" => {
                assert_eq!(first.verdict, Verdict::Adequate, "{name}: {}", first.summary);
                assert!(first.suggestions.is_empty() && added.is_empty(), "{name}: {added:?}");
            }
            "unexplained_structure" => {
                assert_eq!(first.verdict, Verdict::UnexplainedStructure, "{name}: {}", first.summary);
                assert_eq!(whole.verdict, Verdict::UnexplainedStructure, "{name}: {}", whole.summary);
                assert!(first.suggestions.is_empty() && added.is_empty(), "{name}: {added:?}");
                // Structure that cancels between the directions is shown by direction.
                let map = first.structure.unwrap();
                assert!(answer["notes"].get(&map.x).is_some() && map.y == "direction", "{name}: {}", first.summary);
            }
            _ => {
                assert!(accept.iter().any(|g| g.contains(&first.suggestions[0].effect)), "{name}: {}", first.summary);
                assert_eq!(added.len(), accept.len(), "{name}: {added:?}");
                assert!(accept.iter().all(|g| added.iter().any(|a| g.contains(a))), "{name}: {added:?}");
                let (end, floor) = (whole.steps.last().unwrap().validation_rms, whole.noise_floor_rms.unwrap());
                assert!(end <= 1.1 * floor, "{name}: {end} over the floor {floor}");
            }
        }
    }
}

/// The effect that was removed from a complete model is named, if its absence clearly increases the error.
fn check_removed(name: &str, run: &RunTable, complete: &Fit) {
    for removed in &complete.effects {
        let rest = complete.effects.iter().filter(|e| *e != removed);
        let Ok(spec) = ModelSpec::new(run.kind(), rest) else { continue };
        let found = diagnose(run, &spec, &Options::default()).unwrap();
        if found.fit.validation_rms < 1.15 * complete.validation_rms {
            continue;
        }
        let first = found.suggestions.first().map(|s| (&s.effect, &s.confounded_with));
        let is_named = first.is_some_and(|(effect, ties)| effect == removed || ties.contains(removed));
        assert!(is_named, "{name} without {removed}: {}", found.summary);
    }
}

#[test]
fn friction() {
    check_family("friction");
}

#[test]
fn encoder() {
    check_family("encoder");
}

#[test]
fn stiffness() {
    check_family("stiffness");
}

#[test]
fn brake() {
    check_family("brake");
}

/// As few bands as the loops need: bands up to the largest current were mostly not identified.
#[test]
fn a_brake_decides_the_bands_of_its_hysteresis() {
    let Some(folder) = shared("hidden-effects") else { return };
    let run = read(&folder.join("brake-hysteresis"));
    let spec = ModelSpec::new(run.kind(), ["drag", "torque_per_current", "hysteresis"]).unwrap();
    let found = fit(&run, &spec, &Options::default()).unwrap();
    let bands = found.parameters.iter().filter(|p| p.effect == "hysteresis");
    // The largest current is known, not estimated.
    let is_open = |p: &&Parameter| !matches!(p.state, ParameterState::Ok | ParameterState::Fixed);
    let open: Vec<&str> = bands.filter(is_open).map(|p| p.name.as_str()).collect();
    assert!(open.len() <= 1, "{open:?}");
}

#[test]
fn an_inertia_that_settled_motion_hardly_shows_is_the_set_ups() {
    let Some(folder) = shared("hidden-effects") else { return };
    let run = read(&folder.join("friction-load_linear"));
    let reported = |run: &RunTable| fit(run, &ModelSpec::baseline(run).unwrap(), &Options::default()).unwrap();
    let found = reported(&run);
    let note = found.notes.iter().find(|note| note.contains("the set-up states")).unwrap();
    assert!(note.starts_with("the run does not determine the inertia") && note.contains("4.48·10⁻⁵ kg·m²"), "{note}");
    let inertia = found.parameters.iter().find(|p| p.effect == "inertia").unwrap();
    assert_eq!((inertia.state, Some(inertia.value)), (ParameterState::Unidentified, run.meta().rotor_inertia_kg_m2));
    assert!(inertia.ci95[0] < 4e-5 && inertia.ci95[1] > 5e-5, "{inertia:?}");
    let with = |stated: Option<f64>| {
        let meta = jointbench_instrument::Meta { rotor_inertia_kg_m2: stated, ..run.meta().clone() };
        reported(&RunTable::new(meta, run.trace().clone()).unwrap())
    };
    let unstated = with(None).parameters.into_iter().find(|p| p.effect == "inertia").unwrap().value;
    assert!(unstated < 4e-5, "{unstated}");
    // An agreement with the set-up may be chance.
    let agreed = with(Some(unstated)).parameters.into_iter().find(|p| p.effect == "inertia").unwrap();
    assert_eq!((agreed.state, agreed.value), (ParameterState::Unidentified, unstated));
}
