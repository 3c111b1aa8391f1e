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
use crate::prepare::Problem;
use crate::select::{Ground, Library, Rival, Silence, significance};
use crate::terms::{Term, Terms, polish};

/// An effect with a memory must take this share of the squared error around reversals.
const MOST: f64 = 0.72;

/// What the rest of the model leaves around reversals, and the effects with a memory that may explain it.
struct Reversals<'p> {
    problem: &'p Problem,
    ground: Ground,
    library: Library<'p>,
}

impl<'p> Reversals<'p> {
    fn new(now: &Assembly<'p>, wanted: impl Fn(&str) -> bool) -> Option<Self> {
        let problem = now.prepared.memory.as_ref()?;
        let mut terms = Terms::new(problem);
        terms.given = now.predict(problem);
        let mut library = Library::new(now.spec, problem, &[Stage::Memory]);
        library.candidates.retain(|c| wanted(c.id()));
        Some(Self { problem, ground: Ground::new(Basis::default(), terms.response(), problem), library })
    }

    /// The effect in the form that explains most, and its share.
    fn best(&self) -> Option<(Term<'p>, f64)> {
        let shares = self.library.candidates.iter().map(|c| self.ground.own(&c.columns).share);
        let (best, _) = shares.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let mut term = [self.library.candidates[best].term(self.problem)];
        let left = polish(&mut term, &self.ground.basis, &self.ground.residual, self.problem);
        let [term] = term;
        Some((term, 1.0 - left / self.ground.energy))
    }
}

/// The memory effect that this run shows beyond the model, if one does.
pub fn memory<'p>(now: &Assembly<'p>, options: &Options) -> Option<Rival<'p>> {
    let reversals = Reversals::new(now, |id| !now.effects.iter().any(|e| e == id))?;
    let (term, share) = reversals.best()?;
    let p_value = significance(&term, &reversals.library, &reversals.ground, options);
    (share >= MOST && p_value <= options.alpha).then(|| Rival::alone(term, share, p_value))
}

/// Effects with a memory that are not in the model, with the smallest that would have taken enough beside what is left
/// around reversals.
pub fn silences<'p>(now: &Assembly<'p>) -> Vec<Silence<'p>> {
    let is_meant = |id: &str| now.spec.find(id).is_ok_and(|e| now.is_apart(e)) && !now.effects.iter().any(|e| e == id);
    let Some(Reversals { problem, ground, library }) = Reversals::new(now, is_meant) else { return Vec::new() };
    let detectable_rms = (MOST / (1.0 - MOST) * ground.energy / problem.rows() as f64).sqrt();
    let mut seen: Vec<&str> = library.candidates.iter().map(|c| c.id()).collect();
    seen.dedup();
    seen.into_iter().map(|effect| Silence { effect, detectable_rms }).collect()
}

/// A memory effect of the model in its best form. `None` where there is nothing to choose it by.
pub fn form_of<'p>(now: &Assembly<'p>, id: &str) -> Option<Term<'p>> {
    Some(Reversals::new(now, |other| other == id)?.best()?.0)
}
