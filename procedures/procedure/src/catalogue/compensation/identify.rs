//! The result of a run: the best method, or why none helps, with the figures of all methods.

use super::cause;
use super::followed::{FIGURES, Followed};
use super::method::Method;
use crate::findings::{Mean, Unusable, quantity};
use crate::identification::{Axis, Figure, Form, Identification, Mark, Series, Verdict};
use jointbench_instrument::RunTable;
use jointbench_model::words;

/// Largest number of samples in a figure.
const SHOWN: usize = 1500;

pub(super) fn identify(period_s: f64, run: &RunTable) -> Result<Identification, Unusable> {
    let followed: Vec<Followed> =
        Method::ALL.into_iter().filter_map(|method| Followed::all(period_s, run, method)).collect();
    let is_there = |method: &Method| followed.iter().any(|one| one.method == *method);
    if ![Method::None, Method::Full, Method::Observer].iter().all(is_there) {
        return Err(Unusable::InsufficientData("Not all compensation methods were completed.", "Repeat the run."));
    }
    let none = &followed[0];
    let mut quantities = Vec::new();
    for one in &followed {
        let [suffix, title_of_method] = one.method.words();
        for ([name, symbol, title, unit], Mean { value, ci95 }) in FIGURES.into_iter().zip(one.figures(none)) {
            let words = [&format!("{name}_{suffix}"), symbol, title, unit];
            let ci95 = Some(ci95).filter(|[low, high]| low < high);
            quantities.push(quantity(words, value, ci95).in_configuration(title_of_method));
        }
    }
    let conclusion = Conclusion::of(&followed);
    Ok(Identification {
        verdict: if conclusion.is_clear() { Verdict::Identified } else { Verdict::Inconclusive },
        summary: conclusion.summary(none),
        advice: conclusion.advice(),
        quantities,
        figures: vec![bars(&followed), trajectories(none, conclusion.best, period_s), errors(&followed)],
        ..Identification::default()
    })
}

/// What the comparison of the methods shows.
struct Conclusion<'f> {
    /// The method with the smallest sum of absolute errors, apart from none and from one that chatters.
    best: &'f Followed,
    /// Whether its error is significantly smaller than without compensation.
    helps: bool,
    /// Methods that feed more than the friction.
    active: Vec<&'static str>,
    /// The ideal Coulomb method, if it changes its sign more often than the reference.
    chatters: Option<Mean>,
}

impl<'f> Conclusion<'f> {
    /// `followed` begins with the method without compensation.
    fn of(followed: &'f [Followed]) -> Self {
        let none = &followed[0];
        // The reference changes its direction twice in a period.
        let ideal = followed.iter().find(|one| one.method == Method::IdealCoulomb).map(Followed::sign_changes);
        let chatters = ideal.filter(|changes| changes.ci95[0] > 2.0);
        let usable = followed[1..].iter().filter(|one| chatters.is_none() || one.method != Method::IdealCoulomb);
        let best = usable.min_by(|a, b| a.rho()[0].total_cmp(&b.rho()[0])).unwrap_or(none);
        Self {
            best,
            helps: best.ratio(none).ci95[1] < 1.0,
            active: followed.iter().filter(|one| one.over_nm > 0.0).map(|one| one.method.words()[1]).collect(),
            chatters,
        }
    }

    fn is_clear(&self) -> bool {
        self.helps && self.active.is_empty()
    }

    fn summary(&self, none: &Followed) -> String {
        let mut sentences = Vec::new();
        if self.helps {
            sentences.push(gain(self.best, none));
        } else {
            sentences.push(format!(
                "No method reduces the error significantly. The best, {}, has {} of the sum of absolute errors \
                 without compensation. {}",
                self.best.method.words()[1],
                words::percent(self.best.ratio(none).value),
                cause::sentences(self.best)
            ));
        }
        if let Some(changes) = self.chatters {
            sentences.push(format!(
                "Ideal Coulomb is unstable at standstill: its feed-forward changes sign {:.0} times in a period.",
                changes.value
            ));
        }
        sentences.push(match &self.active[..] {
            [] => "No method over-compensates.".to_owned(),
            methods => format!("Over-compensating methods: {}.", methods.join(", ")),
        });
        if none.rounds.len() > 1 {
            sentences.push("The intervals are the scatter between rounds, at the temperature of this run.".to_owned());
        }
        sentences.join(" ")
    }

    fn advice(&self) -> Option<String> {
        if !self.active.is_empty() {
            return Some("Reduce share, or identify friction again because the joint may be warmer.".into());
        }
        (!self.helps).then(|| "Use a slower reference, or improve the velocity loop of the drive.".into())
    }
}

/// The best method with its gain, and errors before and after.
fn gain(best: &Followed, none: &Followed) -> String {
    let errors = [none, best].map(|one| [one.rms(), one.rho()[2]].map(|rad| words::figure(rad, "rad")));
    format!(
        "Best method: {}. It reduces the sum of absolute errors by {}, the RMS error from {} to {} and the maximum error \
         from {} to {}.",
        best.method.words()[1],
        words::percent(1.0 - best.ratio(none).value),
        errors[0][0],
        errors[1][0],
        errors[0][1],
        errors[1][1]
    )
}

fn errors(followed: &[Followed]) -> Figure {
    let series = followed.iter().map(|one| {
        let every = one.time_s.len().div_ceil(SHOWN);
        let pick = |values: &[f64]| values.iter().copied().step_by(every).collect();
        Series::new(one.method.words()[1], Mark::Line, pick(&one.time_s), pick(&one.error_rad))
    });
    Figure {
        name: "error_over_time".into(),
        title: "Tracking error".into(),
        form: Form::Cartesian,
        x: Axis::of("time", "s"),
        y: Axis::of("error (link)", "rad"),
        series: series.collect(),
    }
}

/// Table 4.7 as bars: each figure relative to that without compensation.
fn bars(followed: &[Followed]) -> Figure {
    let none = followed[0].rho();
    let places: Vec<f64> = (0..followed.len()).map(|i| i as f64).collect();
    let series = |i: usize| {
        let [_, _, title, _] = FIGURES[i];
        let shares = followed.iter().map(|one| one.rho()[i] / none[i]).collect();
        Series::new(&title.to_lowercase(), Mark::Bars, places.clone(), shares)
    };
    Figure {
        name: "ratio".into(),
        title: "Errors relative to no compensation".into(),
        form: Form::Cartesian,
        x: Axis::names("compensation", followed.iter().map(|one| one.method.words()[1])),
        y: Axis::of("fraction of uncompensated", ""),
        series: vec![series(0), series(1), series(2)],
    }
}

/// The reference, and its tracking without compensation and with the best method, over one period. The errors are
/// magnified by a power of ten, because they would not be visible otherwise.
fn trajectories(none: &Followed, best: &Followed, period_s: f64) -> Figure {
    let most_rad = none.reference_rad.iter().fold(0.0, |most: f64, at| most.max(at.abs()));
    let larger = 10f64.powf((0.5 * most_rad / none.rho()[2]).log10().floor()).clamp(1.0, 1e4);
    let shown = |label: &str, one: &Followed, at: &dyn Fn(usize) -> f64| {
        let end = one.time_s.partition_point(|t_s| *t_s <= period_s);
        let rows = || (0..end).step_by(end.div_ceil(SHOWN).max(1));
        Series::new(label, Mark::Line, rows().map(|i| one.time_s[i]).collect(), rows().map(at).collect())
    };
    let mut series = vec![shown("reference", none, &|i| none.reference_rad[i])];
    for one in [none, best] {
        let label = format!("{} (error × {larger})", one.method.words()[1]);
        series.push(shown(&label, one, &|i| one.reference_rad[i] - larger * one.error_rad[i]));
    }
    Figure {
        name: "trajectory".into(),
        title: "Trajectory, one period".into(),
        form: Form::Cartesian,
        x: Axis::of("time", "s"),
        y: Axis::of("angle (link)", "rad"),
        series,
    }
}
