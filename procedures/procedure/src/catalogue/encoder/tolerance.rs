//! Whether the sensor tolerates the mounting errors of the data sheet, and advice if it does not.

use super::edges::{Direction, Found};
use super::tested::Tested;
use crate::identification::{Axis, Figure, Form, Mark, Series, Verdict};

/// The outcome against the data sheet, with the directions that cause it.
pub struct Judgement {
    pub verdict: Verdict,
    /// The outcome as the first word of a summary.
    pub outcome: &'static str,
    /// `None` if the range of the stage does not decide it.
    pub passes: Option<bool>,
    pub text: String,
    pub advice: Option<String>,
}

impl Judgement {
    pub fn of(found: &[(&Direction, Found)]) -> Self {
        let those = |holds: Option<bool>| -> Vec<&(&Direction, Found)> {
            found.iter().filter(|(direction, found)| direction.holds(found) == holds).collect()
        };
        let (out, unsure) = (those(Some(false)), those(None));
        let each = |directions: &[&(&Direction, Found)], describe: &dyn Fn(&(&Direction, Found)) -> String| {
            directions.iter().map(|one| describe(one)).collect::<Vec<_>>().join("; ")
        };
        let allowed = |direction: &Direction| format!("tolerance {}", direction.length(direction.manufacturing));
        if !out.is_empty() {
            let lost = |(direction, found): &(&Direction, Found)| {
                let bad = direction.length(found.bad.unwrap_or(found.good));
                format!("{}: period count lost at {bad} ({})", direction.title, allowed(direction))
            };
            let cure = each(&out, &|(direction, Found { good, .. })| {
                let other = found.iter().find(|(other, _)| other.is_opposite(direction)).map(|(_, other)| other.good);
                match other {
                    Some(other) if (other - good).abs() >= 2.0 * direction.manufacturing => {
                        format!(
                            "{}: move the sensor by {} in the opposite direction, to the centre of the range",
                            direction.title,
                            direction.length(0.5 * (other + good))
                        )
                    }
                    Some(other) => format!(
                        "{}: the range is only {}. Check air gap, ring and mounting",
                        direction.title,
                        direction.length(other - good)
                    ),
                    None => format!("{}: mount the sensor closer to the ring", direction.title),
                }
            });
            let text = format!("{}.", each(&out, &lost));
            return Self {
                verdict: Verdict::Identified,
                outcome: "OUT OF TOLERANCE",
                passes: Some(false),
                text,
                advice: Some(format!("{cure}. Then align and repeat the run.")),
            };
        }
        if !unsure.is_empty() {
            let far = |(direction, found): &(&Direction, Found)| {
                format!(
                    "{}: consistent up to {} ({})",
                    direction.title,
                    direction.length(found.good),
                    allowed(direction)
                )
            };
            let further = each(&unsure, &|(direction, _)| {
                format!("--set {}={:.2e}", direction.reach, 1.2 * direction.manufacturing)
            });
            return Self {
                verdict: Verdict::Inconclusive,
                outcome: "UNDECIDED",
                passes: None,
                text: format!("{}.", each(&unsure, &far)),
                advice: Some(format!("Increase the travel and the bisection steps: {further} --set halvings=6.")),
            };
        }
        let text = "consistent within the data sheet tolerance in all directions.".into();
        Self { verdict: Verdict::Identified, outcome: "PASS", passes: Some(true), text, advice: None }
    }
}

/// The last consistent position of each direction relative to the data sheet's tolerance, and the positions where the
/// periods are lost.
pub fn figure(found: &[(&Direction, Found)]) -> Figure {
    let share = |direction: &Direction, at: f64| at.abs() / direction.manufacturing;
    let places: Vec<f64> = (0..found.len()).map(|i| i as f64).collect();
    let [mut lost, mut kept] = [
        Series::new("range until period loss", Mark::Bars, Vec::new(), Vec::new()),
        Series::new("no period loss within the travel", Mark::Points, Vec::new(), Vec::new()),
    ];
    for (place, (direction, found)) in places.iter().zip(found) {
        let last = share(direction, found.good);
        let of = if found.bad.is_some() { &mut lost } else { &mut kept };
        of.x.push(*place);
        of.y.push(last);
        lost.band.extend(found.bad.map(|bad| [last, share(direction, bad)]));
    }
    let (at, symmetric) = places
        .iter()
        .zip(found)
        .filter_map(|(place, (direction, _))| Some((*place, share(direction, Tested::of(found, direction)?.good))))
        .unzip();
    let tested = Series::new("tested tolerance of the axis", Mark::Points, at, symmetric);
    Figure {
        name: "tolerance".into(),
        title: "Usable range / data sheet tolerance (whisker: period loss)".into(),
        form: Form::Cartesian,
        x: Axis::names("Direction", found.iter().map(|(direction, _)| direction.title)),
        y: Axis::of("Fraction of the manufacturing tolerance", ""),
        series: [lost, kept, tested]
            .into_iter()
            .filter(|series| !series.x.is_empty())
            .chain([Series::new("data sheet", Mark::Line, places, vec![1.0; found.len()])])
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::edges::DIRECTIONS;
    use super::*;

    /// The directions of the radial shift, consistent up to and lost at these positions, in millimetres.
    fn judged(places_mm: [(f64, Option<f64>); 2]) -> Judgement {
        let found = |i: usize| {
            let (good, bad) = places_mm[i];
            (&DIRECTIONS[i], Found { good: 1e-3 * good, bad: bad.map(|bad| 1e-3 * bad) })
        };
        Judgement::of(&[found(0), found(1)])
    }

    #[test]
    fn a_sensor_is_held_against_its_data_sheet() {
        let pass = judged([(-0.24, Some(-0.26)), (0.3, None)]);
        assert!(pass.outcome == "PASS" && pass.advice.is_none(), "{}", pass.text);

        let aside = judged([(-0.40, Some(-0.42)), (0.10, Some(0.12))]);
        assert!(
            aside.outcome == "OUT OF TOLERANCE"
                && aside.text.starts_with("Radial shift +")
                && aside.text.contains("120 µm"),
            "{}",
            aside.text
        );
        assert!(aside.advice.unwrap().contains("move the sensor by 150 µm in the opposite direction"));

        let narrow = judged([(-0.10, Some(-0.12)), (0.10, Some(0.12))]);
        assert!(narrow.advice.unwrap().contains("the range is only 200 µm"));
    }

    #[test]
    fn what_was_not_tried_is_not_sure() {
        for radial in [(0.10, None), (0.14, Some(0.16))] {
            let short = judged([(-0.24, Some(-0.26)), radial]);
            assert_eq!(short.verdict, Verdict::Inconclusive);
            assert!(short.text.starts_with("Radial shift +"), "{}", short.text);
            assert_eq!(short.outcome, "UNDECIDED");
            assert!(short.advice.unwrap().contains("--set radial_reach_m=1.80e-4"));
        }
    }
}
