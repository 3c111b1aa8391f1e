//! The simulated benches with exactly the values of the documents.

use super::{SUBJECTS, bench_of};
use jointbench_devices::{Joint, MockSettings};
use jointbench_procedure::reproduce::Subject;

/// Load behind the gear as a fraction of 150 Nm: joint A ends at 70 Nm.
const GEAR_SHARE: f64 = 0.4;
/// Axes of the Puma in addition to that of [`SUBJECTS`].
const AXES: [(&str, usize); 5] =
    [("Puma, axis 1", 1), ("Puma, axis 3", 3), ("Puma, axis 4", 4), ("Puma, axis 5", 5), ("Puma, axis 6", 6)];
/// Between the name of a bench and the effect that it hides.
const HIDING: &str = " hiding ";

pub fn subjects() -> impl Iterator<Item = (&'static str, Joint, Subject)> {
    let named = SUBJECTS.into_iter().map(|(bench, joint, subject)| match subject {
        Subject::GearAndBrakeB { .. } => (bench, joint, Subject::GearAndBrakeB { share: GEAR_SHARE }),
        _ => (bench, joint, subject),
    });
    named.chain(AXES.map(|(bench, axis)| (bench, Joint::Puma, Subject::Puma { axis })))
}

/// The bench of a subject.
pub fn exact(joint: Joint, subject: Subject, seed: u64) -> MockSettings {
    MockSettings { documents: true, ..bench_of(joint, subject, seed) }
}

/// The bench with a name of [`subjects`], which may end in `hiding EFFECT`.
pub fn named(name: &str, seed: u64) -> Option<MockSettings> {
    let (bench, effects) = match name.split_once(HIDING) {
        Some((bench, effect)) => (bench, vec![effect]),
        None => (name, Vec::new()),
    };
    let (_, joint, subject) = subjects().find(|(subject, ..)| *subject == bench)?;
    let is_known = effects.iter().all(|effect| joint.hides().contains(effect));
    is_known.then(|| exact(joint, subject, seed).hiding(&effects))
}
