//! Effects with a memory on a run in steps: judged on slow samples and reversals, where plateaus say nothing.
//!
//! There the instruments are not aligned and static friction has its jump, so every candidate explains something: an
//! effect is named only where it explains most of what the rest of the model leaves. Measured on simulated joints: real
//! presliding over more than a few steps of the encoder takes 83 to 98 % of the squared error there, nothing else more
//! than 63 %.

use crate::Options;
use crate::assembly::Assembly;
use crate::effect::Stage;
use crate::linear::Basis;
use crate::select::{Ground, Library, Rival, significance};
use crate::terms::{Terms, polish};

/// An effect with a memory must take this share of the squared error around reversals.
const MOST: f64 = 0.72;

/// The memory effect that this run shows beyond the model, if one does.
pub fn memory<'p>(now: &Assembly<'p>, options: &Options) -> Option<Rival<'p>> {
    let prepared = now.prepared;
    let problem = prepared.memory.as_ref()?;
    let mut terms = Terms::new(problem);
    terms.given = now.predict(problem);
    let rest = terms.response();
    let mut library = Library::new(now.spec, problem, &[Stage::Memory]);
    library.candidates.retain(|c| !now.effects.iter().any(|e| e == c.id()));
    let ground = Ground::new(Basis::default(), rest, problem);
    let shares = library.candidates.iter().map(|c| ground.own(&c.columns).share);
    let (best, _) = shares.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let mut term = [library.candidates[best].term(problem)];
    let share = 1.0 - polish(&mut term, &ground.basis, &ground.residual, problem) / ground.energy;
    let [term] = term;
    let p_value = significance(&term, &library, &ground, options);
    (share >= MOST && p_value <= options.alpha).then(|| Rival::alone(term, share, p_value))
}
