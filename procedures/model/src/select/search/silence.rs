//! What was looked for and not found, and how large it would have been.

use super::Search;
use crate::linear::dot;
use crate::select::ground::Ground;
use crate::select::library::Library;
use crate::select::rivals::Bar;
use crate::terms::Terms;

/// A candidate that was looked for and not found.
pub struct Silence<'p> {
    pub effect: &'p str,
    /// RMS of the smallest one that would have been found with 80 % probability.
    pub detectable_rms: f64,
}

impl<'p> Search<'_, 'p> {
    pub fn silences(&self) -> Vec<Silence<'p>> {
        silences(&self.now, self.library, &self.withdrawn, self.bar())
    }
}

/// For each effect that is not in the model, its best form and shape: what would have been seen.
fn silences<'p>(end: &Terms<'p>, library: &Library<'p>, withdrawn: &[&'p str], bar: Bar) -> Vec<Silence<'p>> {
    let ground = Ground::of(end);
    let n = end.problem.rows() as f64;
    let least = bar.least_share(end, ground.energy) * ground.energy;
    let mut out: Vec<Silence> = Vec::new();
    let is_out = |id| !end.contains(id) && !withdrawn.contains(&id);
    for candidate in library.candidates.iter().filter(|c| is_out(c.id())) {
        let own = ground.own(&candidate.columns);
        let sums = ground.sums(&candidate.columns, &own);
        // z₀.₉₇₅ + z₀.₈ standard errors of the amplitude, and never less than what is worth a name.
        let noise = sums.iter().zip(own.squares()).map(|(s, square)| 2.8 * (dot(s, s) / square).sqrt());
        let Some(noise) = noise.reduce(f64::max) else { continue };
        // Of the effect itself the model's own columns take their part.
        let detectable_rms = noise.max(least.sqrt()) / (own.visible * n).sqrt();
        match out.iter_mut().find(|s| s.effect == candidate.id()) {
            Some(s) => s.detectable_rms = s.detectable_rms.min(detectable_rms),
            None => out.push(Silence { effect: candidate.id(), detectable_rms }),
        }
    }
    out
}
