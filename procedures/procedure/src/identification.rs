//! The result of a procedure from its run: a verdict in words, quantities with their intervals, figures. It is a pure
//! function of the stored run, so that newer code can repeat it.

mod quantity;

pub use quantity::{Direction, Quantity};

use crate::recorder::RunId;
use crate::state::RunState;
use jointbench_model::words;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

/// Whether the run has reached its purpose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The quantities are determined, with their intervals.
    Identified,
    /// The run is not sufficient; [`Identification::advice`] states what to measure.
    Inconclusive,
    /// The run cannot be used; [`Identification::summary`] states why.
    #[default]
    Failed,
}

/// Result of a run: verdict, quantities and figures.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Identification {
    /// Whether the run has reached its purpose.
    pub verdict: Verdict,
    /// One plain sentence, or a line for each part of a campaign. `RUN` in its commands is a placeholder for the
    /// number of the run, which [`Self::of_run`] inserts.
    pub summary: String,
    /// The summary without the outcome against a data sheet and without the lines of the parts, which `passes` and
    /// `parts` state separately. Absent: the summary contains neither.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lead: Option<String>,
    /// What to measure or correct next, with commands in the same form.
    pub advice: Option<String>,
    /// The figures of the result with their intervals, in the order of tables.
    pub quantities: Vec<Quantity>,
    /// The plots of the result.
    pub figures: Vec<Figure>,
    /// Whether it passes the limits of a data sheet.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub passes: Option<bool>,
    /// Parts of a campaign, in their order. The summary ends with a line for each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<Part>,
}

/// A part of a campaign.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// The procedure; names of its quantities and figures begin with it and a dot.
    pub id: String,
    /// Title of its procedure.
    pub title: String,
    /// Verdict on this part alone.
    pub verdict: Verdict,
    /// The result of this part in one sentence.
    pub summary: String,
    /// Names of its quantities.
    pub quantities: Vec<String>,
    /// Names of its figures.
    pub figures: Vec<String>,
}

impl Identification {
    /// The run cannot be used, with the reason and advice.
    pub fn failed(why: impl Into<String>, advice: impl Into<String>) -> Self {
        Self { verdict: Verdict::Failed, summary: why.into(), advice: Some(advice.into()), ..Self::default() }
    }

    /// The run does not decide, with the reason and advice.
    pub fn inconclusive(why: impl Into<String>, advice: impl Into<String>) -> Self {
        Self { verdict: Verdict::Inconclusive, ..Self::failed(why, advice) }
    }

    /// The result for a run and its state: an incomplete run has not reached its purpose, independent of its partial
    /// results. `can_resume`: the rest of the run may be measured later. `step`: where it ended, such as `step 3 of 41`.
    pub fn of_run(mut self, run: RunId, state: RunState, can_resume: bool, step: Option<&str>) -> Self {
        if state != RunState::Completed {
            let next = match (state.is_final(), can_resume) {
                (false, _) => "Let the run finish.",
                (true, false) => "Repeat the run.",
                (true, true) => {
                    "Resume the run (“Resume” on its page, or jointbench run --continue RUN), or repeat it."
                }
            };
            let introduction = introduction(self.verdict, state, step);
            self = self.introduced(&introduction);
            // Advice about the planning does not apply to an incomplete run.
            self.advice = Some(next.to_owned());
            if self.verdict == Verdict::Identified {
                self.verdict = Verdict::Inconclusive;
            }
        }
        // Commands are left unchanged, because users copy them.
        let numbered = |text: String| words::signed(&text.replace("RUN", &run.to_string()));
        self.parts.iter_mut().for_each(|part| part.summary = numbered(std::mem::take(&mut part.summary)));
        let lead = self.lead.map(numbered);
        Self { summary: numbered(self.summary), lead, advice: self.advice.map(numbered), ..self }
    }

    /// Puts text before the summary and the lead. Parts begin on a line of their own.
    pub fn introduced(self, text: &str) -> Self {
        let gap = if self.parts.is_empty() { ' ' } else { '\n' };
        let lead = self.lead.map(|lead| format!("{text} {lead}").trim_end().to_owned());
        Self { summary: format!("{text}{gap}{}", self.summary), lead, ..self }
    }

    /// The first quantity of that name.
    pub fn quantity(&self, name: &str) -> Option<&Quantity> {
        self.quantities.iter().find(|quantity| quantity.name == name)
    }
}

/// What the result of an incomplete run is about.
fn introduction(verdict: Verdict, state: RunState, step: Option<&str>) -> String {
    let at = step.map(|step| format!(" in {step}")).unwrap_or_default();
    match (verdict, state.is_final()) {
        // A run that still records has not failed.
        (Verdict::Failed, false) => "No result yet.".to_owned(),
        (Verdict::Failed, true) => {
            format!("The run did not complete ({state}{at}). The recorded part allows no identification.")
        }
        (_, false) => format!("The run is still in progress ({state}{at}). Result so far:"),
        (_, true) => format!("The run did not complete ({state}{at}). From the recorded part:"),
    }
}

/// A run whose parameters were determined by this one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FollowUp {
    /// Id of the procedure.
    pub procedure: String,
    /// Its parameters; the others keep their defaults.
    #[schema(value_type = Object)]
    pub parameters: Map<String, Value>,
    /// Its purpose, in a few words.
    pub why: String,
}

/// A plot of a result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Figure {
    /// Stable and unique in its identification.
    pub name: String,
    /// Heading of the plot.
    pub title: String,
    /// Coordinates in which it is drawn.
    pub form: Form,
    /// Horizontal axis, or the angle.
    pub x: Axis,
    /// Vertical axis, or the radius.
    pub y: Axis,
    /// The data, in drawing order.
    pub series: Vec<Series>,
}

/// Coordinates of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = FigureForm)]
pub enum Form {
    /// x to the right, y upwards.
    Cartesian,
    /// x is the angle (rad), y the radius.
    Polar,
}

/// An axis of a figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = FigureAxis)]
pub struct Axis {
    /// The quantity, in words.
    pub label: String,
    /// SI symbol; empty for a share or a count.
    pub unit: String,
    /// Names of the items if the axis counts items instead of a quantity: 0 is the first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub names: Vec<String>,
}

impl Axis {
    /// An axis of a quantity in the given unit.
    pub fn of(label: &str, unit: &str) -> Self {
        Self { label: label.to_owned(), unit: unit.to_owned(), names: Vec::new() }
    }

    /// An axis that counts items with these names.
    pub fn names(label: &str, names: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self { label: label.to_owned(), unit: String::new(), names: names.into_iter().map(Into::into).collect() }
    }
}

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mark {
    /// Separate points.
    Points,
    /// A line from point to point.
    Line,
    /// A bar for each point.
    Bars,
}

/// What a series means in its figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum SeriesRole {
    /// An error before it is compensated.
    Before,
    /// The same error after compensation.
    After,
    /// A hysteresis loop during a reversal, while the points are steady motion.
    Loop,
}

/// One data set of a figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = FigureSeries)]
pub struct Series {
    /// Its name in the legend.
    pub label: String,
    /// Series that belong together, such as points and their model, have the same group. Absent: its label.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<String>,
    /// Its meaning, if the figure or its page depends on it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub role: Option<SeriesRole>,
    /// How it is drawn.
    pub mark: Mark,
    /// Values on the x axis, in its unit.
    pub x: Vec<f64>,
    /// Values on the y axis, in its unit; as many as x.
    pub y: Vec<f64>,
    /// Lower and upper end of the 95 % band at each point; empty without a band.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(value_type = Vec<Vec<f64>>)]
    pub band: Vec<[f64; 2]>,
}

impl Series {
    /// # Panics
    /// If x and y differ in length.
    pub fn new(label: &str, mark: Mark, x: Vec<f64>, y: Vec<f64>) -> Self {
        assert_eq!(x.len(), y.len(), "series {label}");
        Self { label: label.to_owned(), group: None, role: None, mark, x, y, band: Vec::new() }
    }

    /// The series in a group.
    pub fn in_group(self, group: &str) -> Self {
        Self { group: Some(group.to_owned()), ..self }
    }

    /// The series with a role.
    pub fn with_role(self, role: SeriesRole) -> Self {
        Self { role: Some(role), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_to_do_next_can_be_typed() {
        let advice = |state, can_resume| {
            let made = Identification::failed("Too few steps.", "look closer (jointbench export RUN)");
            made.of_run(12, state, can_resume, None).advice.unwrap()
        };
        assert_eq!(advice(RunState::Completed, true), "look closer (jointbench export 12)");
        assert!(advice(RunState::Stopped, true).contains("jointbench run --continue 12"));
        assert_eq!(advice(RunState::Failed, false), "Repeat the run.");
        assert_eq!(advice(RunState::Paused, true), "Let the run finish.");
    }

    #[test]
    fn what_is_lacking_is_no_failure_while_the_run_is_on() {
        let summary = |lacking: &str, state| {
            Identification::failed(lacking, "Record a longer run.")
                .of_run(12, state, true, Some("step 3 of 41"))
                .summary
        };
        let few = "Too few samples: 12 usable in motion, at least 40 are needed.";
        assert_eq!(summary(few, RunState::Running), format!("No result yet. {few}"));
        assert_eq!(
            summary(few, RunState::Aborted),
            format!(
                "The run did not complete (aborted in step 3 of 41). The recorded part allows no identification. {few}"
            )
        );
    }

    #[test]
    fn a_number_below_zero_has_a_minus_and_a_command_stays_as_it_is() {
        let text = "A shift of -0.150 mm (-3 to -1), in run-12.csv: jointbench run x --set shift=-2 from 5-7.";
        let expected = "A shift of −0.150 mm (−3 to −1), in run-12.csv: jointbench run x --set shift=-2 from 5-7.";
        assert_eq!(Identification::failed(text, "").of_run(12, RunState::Completed, true, None).summary, expected);
    }
}
