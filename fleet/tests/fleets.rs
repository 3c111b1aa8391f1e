//! What is planted in simulated fleets is recovered, and nothing is found where nothing is planted. The demo has the
//! same with larger fleets.

mod common;

use common::{Fleet, write};
use jointbench_fleet::archive::{Archive, Selection};
use jointbench_fleet::diagnose::{FleetDiagnosis, diagnose, text};
use jointbench_fleet::fit::model;
use jointbench_fleet::report::page;
use std::collections::BTreeSet;

fn diagnosed(fleet: &Fleet) -> (FleetDiagnosis, BTreeSet<String>) {
    let folder = tempfile::tempdir().unwrap();
    let truth = write(folder.path(), fleet);
    let archive = Archive::open(&folder.path().display().to_string()).unwrap();
    let found = diagnose(&archive, &Selection::default(), &model("coulomb + viscous").unwrap()).unwrap();
    (found, truth.planted)
}

#[test]
fn share_list_and_shifted_batch_are_recovered() {
    let fleet = Fleet { units_per_batch: 80, stribeck_share: 0.03, shift: Some((3, 0.0015)), ..Fleet::default() };
    let (found, planted) = diagnosed(&fleet);
    assert_eq!((found.tested, planted.len()), (400, 12));
    let effect = &found.effects[0];
    let listed: BTreeSet<String> = effect.units.iter().map(|found| found.unit.serial.clone()).collect();
    assert_eq!((effect.effect.as_str(), &listed), ("stribeck", &planted));
    assert!(effect.share.ci95[0] < 0.03 && 0.03 < effect.share.ci95[1], "{:?}", effect.share);
    assert_eq!(effect.batches.iter().map(|batch| batch.share.of).collect::<Vec<_>>(), [80; 5]);
    assert_eq!(effect.weeks.len(), 5);
    let named = found.units.iter().filter(|unit| unit.is_named).count();
    assert!(named <= 13, "{named} units are named, 12 are planted");

    let coulomb = &found.fit.parts[0].parameters[0];
    assert_eq!((coulomb.effect.as_str(), coulomb.batches.len()), ("coulomb", 5));
    let shifted: Vec<&str> = coulomb.batches.iter().filter(|b| b.is_shifted).map(|b| b.batch.as_str()).collect();
    assert_eq!(shifted, ["B4"]);
    let [low, high] = coulomb.batches[3].difference_ci95;
    assert!(low < 0.0015 && 0.0015 < high, "{low} {high}");
    let between = coulomb.population.unwrap().between_sd;
    assert!(between > 0.0014 && between < 0.0026, "1.5 mNm, with the shift and the planted units: {between}");

    let html = page(&found);
    let words = text(&found);
    for shown in ["stribeck", "SN00033", "by batch", "by week", "What to measure next"] {
        assert!(html.contains(shown), "{shown}");
    }
    assert!(!html.contains("http") && !html.contains("NaN") && !html.contains("inf,"), "self-contained");
    assert!(words.contains("Missing effect: stribeck in 3.0 %") && words.contains("batch B4 differs by"), "{words}");
}

#[test]
fn null_fleets_have_no_discoveries() {
    let wrong = (0..20).filter(|seed| {
        let fleet = Fleet { batches: 3, units_per_batch: 10, seed: 100 + seed, ..Fleet::default() };
        let (found, _) = diagnosed(&fleet);
        let batches = found.fit.parts[0].parameters.iter().flat_map(|parameter| &parameter.batches);
        !found.effects.is_empty() || batches.filter(|batch| batch.is_shifted).count() > 0
    });
    // With 5 % of the fleets, three or more of 20 have a probability of 8 %; the seeds are fixed.
    assert!(wrong.count() <= 2);
}
