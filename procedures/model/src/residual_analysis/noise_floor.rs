//! Noise floor (pure error) from pairs of rows of the same condition in different repeats.

use crate::preprocess::friction::operating_points::OPERATING_POINTS;
use crate::preprocess::independent_blocks::independent_blocks;
use crate::preprocess::{Prepared, Problem};
use crate::report::diagnosis::NoiseFloor;
use crate::residual_analysis::events::Event;
use crate::stats::jackknife::half_width_95;
use crate::thresholds::{PERIOD_CORRELATION, WIDE_INTERVAL};
use crate::words::{figure, spoken};
use jointbench_instrument::Kind;

/// Fewer pairs than these do not estimate a scatter.
const FEWEST: usize = 8;

/// Computed from the residual, not from the response, so that small differences of speed or load between repeats
/// cancel.
///
/// The pure error of the pairs is σ² = Σ (e_a − e_b)²/2 over their number. The mean product of the same pairs is the
/// repeatable part, for any correlation of the noise within a repeat. Pairs with a different loading history count
/// only if the model `remembers`. `events` do not repeat, so that they do not count for the repeatability.
pub fn noise_floor(prepared: &Prepared, residual: &[f64], remembers: bool, events: &[Event]) -> NoiseFloor {
    let problem = &prepared.main;
    let is_equal = |replicate_pairs: &(usize, usize)| remembers || !problem.different_history.contains(replicate_pairs);
    let is_quiet = |row: usize| !events.iter().any(|event| event.rows.contains(&row));
    let counts = |pair: &(usize, usize)| is_equal(pair) && is_quiet(pair.0) && is_quiet(pair.1);
    let replicate_pairs: Vec<(usize, usize)> = problem.replicate_pairs.iter().copied().filter(counts).collect();
    if replicate_pairs.len() < FEWEST {
        return NoiseFloor { source: unknown(prepared), ..NoiseFloor::default() };
    }
    let (all, of_block) = Pairs::sums(problem, residual, &replicate_pairs);
    // Structure over an angle repeats only at the same angle.
    let met: Vec<_> = replicate_pairs.iter().copied().filter(|pair| !problem.different_angle.contains(pair)).collect();
    let elsewhere = replicate_pairs.len() - met.len();
    let of_met = (elsewhere > 0 && met.len() >= FEWEST).then(|| Pairs::sums(problem, residual, &met));
    let (again, again_of) = of_met.as_ref().map_or((&all, &of_block), |(again, of)| (again, of));
    NoiseFloor {
        rms: Some((all.noise / all.count).sqrt()),
        ci95: interval(&all, &of_block),
        source: format!(
            "residuals of the complete model in {} pairs of the same condition and phase in different repeats ({}{})",
            replicate_pairs.len(),
            match (prepared.about.repeats_from.as_str(), prepared.main.settled || prepared.kind == Kind::Friction) {
                _ if prepared.about.segments_from == OPERATING_POINTS => "operating points of equal conditions",
                ("column", _) => "repeats as numbered",
                (_, true) => "repeats by the period of the motion",
                (_, false) => "sections with the same profile",
            },
            if elsewhere > 0 { format!(", {elsewhere} of them at other angles") } else { String::new() }
        ),
        repeatable_share: Some(again.share().max(0.0)),
        repeatable_ci95: Some(share_interval(again, again_of)),
    }
}

/// Sums over pairs of rows.
#[derive(Clone, Default)]
struct Pairs {
    /// Half squared differences.
    noise: f64,
    /// Products.
    common: f64,
    count: f64,
}

impl Pairs {
    /// Sums over all pairs, and over the pairs that include each block of the run.
    fn sums(problem: &Problem, residual: &[f64], replicate_pairs: &[(usize, usize)]) -> (Self, Vec<Self>) {
        let (block, count) = independent_blocks(problem, 1);
        let (mut all, mut of_block) = (Pairs::default(), vec![Pairs::default(); count]);
        for (a, b) in replicate_pairs {
            let half = (residual[*a] - residual[*b]).powi(2) / 2.0;
            let pair = Pairs { noise: half, common: residual[*a] * residual[*b], count: 1.0 };
            all.add(&pair, 1.0);
            [a, b].into_iter().for_each(|row| of_block[block[*row]].add(&pair, 1.0));
        }
        of_block.retain(|pairs| pairs.count > 0.0);
        (all, of_block)
    }

    fn add(&mut self, other: &Pairs, times: f64) {
        self.noise += times * other.noise;
        self.common += times * other.common;
        self.count += times * other.count;
    }

    fn without(&self, block: &Pairs) -> Pairs {
        let mut rest = self.clone();
        rest.add(block, -1.0);
        rest
    }

    /// Share of the squared residual that both rows of the pairs have in common.
    fn share(&self) -> f64 {
        let total = self.common.max(0.0) + self.noise;
        if total > 0.0 { self.common / total } else { 0.0 }
    }
}

/// 95 % interval of the common share, by a jackknife over blocks.
fn share_interval(all: &Pairs, of_block: &[Pairs]) -> [f64; 2] {
    let whole = all.share();
    let reach = half_width_95(of_block.iter().map(|block| all.without(block).share() - whole));
    [(whole - reach).max(0.0), (whole.max(0.0) + reach).min(1.0)]
}

/// Why there is no noise floor.
fn unknown(prepared: &Prepared) -> String {
    let problem = &prepared.main;
    if let Some(different_motion) = problem.different_motion {
        let (column, unit) =
            (prepared.column_name(different_motion.signal), prepared.column_unit(different_motion.signal));
        let say = |value: f64| figure(prepared.column_scale(different_motion.signal) * value, &unit);
        return format!(
            "no noise floor, because the repeats are different motions; their {} differs by {} RMS at the same moment \
             (standard deviation in the whole run: {})",
            spoken(column),
            say(different_motion.apart),
            say(different_motion.spread)
        );
    }
    if !problem.different_history.is_empty() {
        return "no noise floor, because the brake passed no state twice on the same branch; repeat its loops in the same order"
            .into();
    }
    let source = match problem.repeat.iter().any(|r| *r != problem.repeat[0]) {
        true => {
            "no noise floor, because the repeats share no condition and phase; use the same steps in every repeat, in any order"
        }
        // A period is sought in the motion of friction runs only.
        false if prepared.kind == Kind::Friction => {
            return format!(
                "no noise floor, because no repeats were found: no column numbers them, and no shift in time repeats the \
                 velocity with a correlation above {PERIOD_CORRELATION}"
            );
        }
        false => "no noise floor, because no column numbers repeats",
    };
    source.to_owned()
}

/// 95 % interval of the RMS, by a jackknife over blocks, because the pairs of one block are not independent. It is
/// computed on the logarithm, because a variance has a skewed distribution. It is at least as wide as for so many
/// independent pairs of normal noise, whose log variance scatters by 2/n: a few blocks can agree by chance. `None` if
/// a few blocks contain all the noise, because then its accuracy is unknown.
fn interval(all: &Pairs, of_block: &[Pairs]) -> Option<[f64; 2]> {
    let whole = all.noise / all.count;
    let without = |block: &Pairs| {
        let rest = all.without(block);
        (rest.noise.max(0.0) / rest.count.max(1.0)).max(1e-12 * whole)
    };
    let reach =
        half_width_95(of_block.iter().map(|block| (without(block) / whole).ln())).max(1.96 * (2.0 / all.count).sqrt());
    let ratio = if whole > 0.0 { (0.5 * reach).min(50.0).exp() } else { 1.0 };
    (ratio.powi(2) <= WIDE_INTERVAL).then(|| [whole.sqrt() / ratio, whole.sqrt() * ratio])
}
