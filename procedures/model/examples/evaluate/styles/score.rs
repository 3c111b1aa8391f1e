//! Compares results with the correct answers.

use super::Case;
use super::answer::Answer;
use jointbench_model::{Discovery, ModelSpec, Options, Verdict, diagnose, discover};
use std::error::Error;

/// A true parameter and its 95 % interval.
pub struct Covered {
    pub name: String,
    pub truth: f64,
    pub ci95: [f64; 2],
}

impl Covered {
    pub fn is_inside(&self) -> bool {
        (self.ci95[0]..=self.ci95[1]).contains(&self.truth)
    }

    /// Distance of the middle of the interval from the truth, in its half widths.
    pub fn distance(&self) -> f64 {
        let [low, high] = self.ci95;
        (low + high - 2.0 * self.truth) / (high - low)
    }
}

/// Score of one case. `None` if a question does not apply.
#[derive(Default)]
pub struct Score {
    /// The first suggestion is hidden.
    pub first: Option<bool>,
    /// Everything hidden was added, and nothing else.
    pub exact: Option<bool>,
    /// Nothing hidden, nothing named.
    pub silent: Option<bool>,
    /// Nothing hidden, and the verdict is adequate.
    pub adequate: Option<bool>,
    /// Outside the library, and reported as unexplained.
    pub unknown: Option<bool>,
    /// Not identifiable, and nothing wrong named.
    pub modest: Option<bool>,
    /// True parameters that were compared with their 95 % intervals.
    pub covered: Vec<Covered>,
    pub found: String,
}

pub fn score(case: &Case) -> Result<Score, Box<dyn Error>> {
    let Case { run, answer, .. } = case;
    let spec = ModelSpec::baseline(run)?;
    let (first, whole) = match diagnose(run, &spec, &Options::default())
        .and_then(|first| Ok((first, discover(run, &spec, &Options::default(), 6)?)))
    {
        Ok(found) => found,
        Err(refused) => return Ok(refusal(answer, &refused.to_string())),
    };
    let named: Vec<&str> = first.suggestions.iter().map(|s| s.effect.as_str()).collect();
    let added: Vec<&str> = whole.model.iter().map(String::as_str).filter(|e| !spec.contains(e)).collect();
    let is_optional = |id: &&str| answer.optional.iter().any(|o| o == id);
    let is_hidden = |id: &&str| answer.acceptable.values().flatten().any(|a| a == id);
    let (missed, extra) = matched(answer, &added);
    let is_exact = missed == 0 && extra.iter().all(is_optional);
    let mut score = Score {
        found: format!(
            "{} | {} | {}",
            named.join(","),
            added.join("+"),
            serde_json::to_value(first.verdict)?.as_str().unwrap_or_default()
        ),
        ..Score::default()
    };
    match answer.category.as_str() {
        "null" => {
            let is_silent = named.is_empty() && added.iter().all(is_optional);
            score.silent = Some(is_silent);
            score.adequate = Some(is_silent && first.verdict == Verdict::Adequate);
            score.covered = covered(answer, &whole);
        }
        "unknown" if answer.identifiable => score.unknown = Some(first.verdict == Verdict::UnexplainedStructure),
        _ if answer.identifiable => {
            score.first = Some(named.first().is_some_and(is_hidden));
            score.exact = Some(is_exact);
            if is_exact {
                score.covered = covered(answer, &whole);
            }
        }
        _ => score.modest = Some(named.iter().all(|id| is_hidden(id) || is_optional(id))),
    }
    Ok(score)
}

/// A refused run has no answer.
fn refusal(answer: &Answer, why: &str) -> Score {
    let no = |category: &str| (answer.identifiable && answer.category == category).then_some(false);
    let hidden = no("one").or(no("two")).or(no("three"));
    let null = no("null");
    Score {
        first: hidden,
        exact: hidden,
        adequate: null,
        unknown: no("unknown"),
        found: format!("REFUSED {why}"),
        ..Score::default()
    }
}

/// Matches hidden and added effects one to one: the number of missed ones, and the additional ones.
fn matched<'a>(answer: &Answer, added: &[&'a str]) -> (usize, Vec<&'a str>) {
    fn best<'a>(groups: &[&Vec<String>], left: &[&'a str]) -> (usize, Vec<&'a str>) {
        let Some((group, rest)) = groups.split_first() else { return (0, left.to_vec()) };
        let (missed, extra) = best(rest, left);
        let without = |id: &str| left.iter().copied().filter(|l| *l != id).collect::<Vec<_>>();
        let taken = group.iter().filter(|id| left.contains(&id.as_str())).map(|id| best(rest, &without(id)));
        taken.chain([(missed + 1, extra)]).min_by_key(|(missed, extra)| (*missed, extra.len())).unwrap_or_default()
    }
    best(&answer.acceptable.values().collect::<Vec<_>>(), added)
}

fn covered(answer: &Answer, whole: &Discovery) -> Vec<Covered> {
    let of = |(name, truth): (&String, &f64)| {
        let (effect, parameter) = name.split_once('.')?;
        let found = whole.fit.parameters.iter().find(|p| p.effect == effect && p.name == parameter)?;
        Some(Covered { name: name.clone(), truth: *truth, ci95: found.ci95 })
    };
    answer.truth.iter().filter_map(of).collect()
}
