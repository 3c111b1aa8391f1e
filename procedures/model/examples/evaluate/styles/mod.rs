//! Runs of a second generator, written from the specification of run tables and from physics. It shares no formula
//! and no code with the library, and its laws differ from the library's where physics permits.

mod answer;
mod brake;
mod draw;
mod encoder;
mod friction;
mod identify;
mod least_squares;
mod measure;
mod recording;
mod score;
mod stiffness;
mod waves;
mod write;

use crate::made::Dice;
use answer::Answer;
use jointbench_instrument::{Kind, RunTable};
pub use measure::{evaluate, measure};
use recording::Recording;
use std::path::Path;

/// A run with its truth.
pub struct Case {
    pub name: String,
    pub run: RunTable,
    pub answer: Answer,
}

type Make = fn(&mut Dice) -> Recording;

/// Kinds with their generators.
const MAKERS: [(Kind, Make); 4] = [
    (Kind::Friction, friction::make),
    (Kind::Encoder, encoder::make),
    (Kind::Stiffness, stiffness::make),
    (Kind::Brake, brake::make),
];

/// The case of a number: other numbers have other machines, excitations, effects and noise.
pub fn case(kind: Kind, seed: u64) -> Option<Case> {
    let (_, make) = MAKERS.iter().find(|(made, _)| *made == kind)?;
    let recording = make(&mut Dice::new(seed));
    let answer = identify::answer(&recording);
    let name = format!("{kind}-{seed}-{}-{}", recording.style, answer.label());
    Some(Case { name, run: recording.table(), answer })
}

/// A folder of cases that `--write` made, or of the same format.
pub fn is_written(folder: &Path) -> bool {
    let answers =
        std::fs::read_dir(folder).into_iter().flatten().filter_map(|e| Some(e.ok()?.path().join("answer.json")));
    answers.filter_map(|a| std::fs::read_to_string(a).ok()).take(1).any(|text| text.contains("\"acceptable\""))
}
