//! Findings of a selection: the evidence for each effect, the effects that were not found, and the verdict.

use crate::diagnosis::evidence;
use crate::diagnosis::excluded_effects::ExcludedEffects;
use crate::effects::brake::hysteresis;
use crate::preprocess::Prepared;
use crate::regression::cross_validation::validation_rms;
use crate::regression::linear_model::LinearModel;
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::diagnosis::{Imitated, NoiseFloor, Silent, Verdict};
use crate::report::reasons::{Invisible, LeftOut};
use crate::residual_analysis::events::{Event, Events};
use crate::residual_analysis::maps::Maps;
use crate::residual_analysis::{lack_of_fit, noise_floor};
use crate::selection::model_selection::ModelSelection;
use crate::selection::path::SelectionStep;
use crate::selection::refused::EvidenceResult;
use crate::selection::removal::Withdrawn;
use crate::thresholds::{FLOOR_RATIO, LARGER_PART, LEFT_SHARE};
use crate::{ModelError, ModelSpec, Options};
use jointbench_instrument::Kind;

pub struct Findings<'p> {
    pub start: TwoStageModel<'p>,
    pub steps: Vec<SelectionStep<'p>>,
    pub withdrawn: Vec<Withdrawn<'p>>,
    others: ExcludedEffects,
    /// Residual maps of the last model.
    pub maps: Maps,
    /// The structure in the maps is only scatter between stretches of motion.
    scatters: bool,
    /// Events that do not repeat.
    pub events: Vec<Event>,
    pub floor: NoiseFloor,
    pub end_validation_rms: f64,
    /// Effects of the last model with the effects that are confounded with them.
    ties: Vec<(&'p str, &'p str)>,
    /// Effects of the last model that hardly reduce the error, but prevent biased coefficients.
    pub retained: Vec<Imitated>,
    /// An effect that may be present as well.
    pub open: Option<Imitated>,
    /// Result of the evidence search, for runs that are judged sample by sample.
    pub decided: Option<EvidenceResult<'p>>,
}

impl<'p> Findings<'p> {
    /// Judges the last model of a selection.
    pub fn of(prepared: &'p Prepared, selected: ModelSelection<'p>, options: &Options) -> Self {
        let others = ExcludedEffects::of(&selected);
        // The reversals of a joint would be events of every repeat.
        let events = match prepared.kind {
            Kind::Friction => Vec::new(),
            _ => Events::of(&prepared.main, &selected.residual).without_jumps(&selected.now).find(),
        };
        let remembers = selected.now.contains(hysteresis::ID);
        let floor = noise_floor::noise_floor(prepared, &selected.residual, remembers, &events);
        let scatters = selected.decided.is_none()
            && lack_of_fit::is_scatter(&selected.now, &selected.maps, &selected.residual, &floor, prepared, options);
        let end_validation_rms = validation_rms(&selected.end().main);
        let ModelSelection { start, steps, withdrawn, maps, ties, retained, open, decided, .. } = selected;
        Self {
            start,
            steps,
            withdrawn,
            others,
            maps,
            scatters,
            events,
            floor,
            end_validation_rms,
            ties,
            retained,
            open,
            decided,
        }
    }

    pub fn end(&self) -> &TwoStageModel<'p> {
        self.steps.last().map_or(&self.start, |a| &a.after)
    }

    /// Effects that this run cannot show, those of the model first.
    pub fn not_visible(&self) -> Vec<Invisible> {
        self.start.hidden.iter().chain(&self.others.invisible).cloned().collect()
    }

    /// Effects that were tested and not found.
    pub fn silent(&self) -> Vec<Silent> {
        self.others.silent.clone()
    }

    /// Effects that were tested and rejected.
    pub fn left_out(&self) -> Vec<LeftOut> {
        self.others.left_out.clone()
    }

    /// Effects that are confounded with an effect of the last model: the model is as good with them in its place.
    pub fn ties_of(&self, effect: &str) -> Vec<String> {
        self.ties.iter().filter(|(e, _)| *e == effect).map(|(_, scored)| (*scored).into()).collect()
    }

    /// Whether the effect is confounded with an effect of the last model.
    pub fn is_confounded(&self, effect: &str) -> bool {
        self.ties.iter().any(|(_, scored)| *scored == effect)
    }

    /// Verdict on the last model.
    pub fn end_verdict(&self) -> Verdict {
        if let Some(decided) = &self.decided {
            let shows = decided.left.is_some() && !self.is_negligible();
            return if shows { Verdict::UnexplainedStructure } else { Verdict::Adequate };
        }
        let shows = lack_of_fit::structured(&self.maps).is_some() && !self.scatters;
        if (shows || self.repeats_itself() || !self.events.is_empty()) && !self.is_negligible() && !self.is_rounding() {
            Verdict::UnexplainedStructure
        } else {
            Verdict::Adequate
        }
    }

    /// Whether most of the residual is repeatable, or the validation error is far above the noise floor: then it is
    /// not noise, even if no map shows its origin. A noise floor without an interval is too uncertain for this.
    fn repeats_itself(&self) -> bool {
        let surely = self.floor.repeatable_ci95.is_some_and(|[least, _]| least > LEFT_SHARE);
        self.floor.repeatable_share.is_some_and(|share| share > LARGER_PART) && surely
            || self.floor.ci95.is_some() && self.exceeds_floor()
    }

    /// Whether the validation error is far above the noise floor.
    pub fn exceeds_floor(&self) -> bool {
        let rounding = self.start.prepared.main.view.constants.rounding;
        self.floor.rms.is_some_and(|floor| self.end_validation_rms > FLOOR_RATIO * floor.hypot(rounding))
    }

    /// Whether the residual is encoder quantization, even if it is repeatable.
    pub fn is_rounding(&self) -> bool {
        let rounding = self.start.prepared.main.view.constants.rounding;
        self.floor.rms.is_some_and(|floor| floor < rounding) && !self.exceeds_floor()
    }

    /// RMS between stretches of motion, if it is the cause of the structure over an axis.
    pub fn scatter_rms(&self) -> Option<f64> {
        self.scatters.then(|| self.maps.between_rms())
    }

    /// Whether the residual is small relative to the measured signal, even if it is repeatable.
    pub fn is_negligible(&self) -> bool {
        self.end().main.is_negligible(self.end_validation_rms, self.start.prepared.kind)
    }

    /// Added effects of the last model by decreasing importance: the loss without each of them. This order is right
    /// even for effects that mask each other.
    pub fn ranking(&self) -> Vec<(&SelectionStep<'p>, f64)> {
        let end = self.end();
        let mut seen: Vec<&str> = Vec::new();
        let mut ranked: Vec<(&SelectionStep, f64)> = Vec::new();
        // In reverse order: for an effect that was removed and added again, the last step has its evidence.
        for step in self.steps.iter().rev() {
            let Some(id) = step.added.as_ref().map(|r| r.term.id()) else { continue };
            if !seen.contains(&id) && end.effects.iter().any(|e| e == id) {
                seen.push(id);
                ranked.push((step, importance(end, id)));
            }
        }
        if self.decided.is_some() {
            // In the order of addition, each with its error reduction at that time.
            let taken = |step: &SelectionStep| step.added.as_ref().map_or(0.0, |scored| scored.share);
            return ranked.into_iter().rev().map(|(step, _)| (step, taken(step))).collect();
        }
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
        ranked
    }
}

impl Findings<'_> {
    /// Reduction of the squared validation error at the last addition of an effect, relative to the model before, and
    /// that model in words.
    pub fn reduction_when_added(&self, id: &str) -> (f64, &'static str) {
        let is_meant = |step: &SelectionStep| step.added.as_ref().is_some_and(|scored| scored.term.id() == id);
        let Some(at) = self.steps.iter().rposition(is_meant) else { return (0.0, "the model") };
        let (before, words) = match at.checked_sub(1) {
            None => (&self.start, "the model"),
            Some(at) => (&self.steps[at].after, "the effects before it"),
        };
        let ratio = validation_rms(&self.steps[at].after.main) / validation_rms(&before.main);
        (1.0 - ratio.powi(2), words)
    }

    /// What an effect of the last model does in it.
    ///
    /// # Errors
    /// As [`crate::fit()`].
    pub fn in_last_model(&self, id: &str, options: &Options) -> Result<InLastModel, ModelError> {
        let end = self.end();
        if let Some((part, without)) = parts_without(end, id).first() {
            return Ok(InLastModel::of(without, part));
        }
        // Presliding is the friction direction of its model, not a term of it.
        let others = ModelSpec { effects: end.effects.clone(), ..end.spec.clone() }.without(id);
        let without = TwoStageModel::new(end.prepared, &others, options)?;
        Ok(InLastModel::of(&without.main, &end.main))
    }
}

/// The last model compared with the same model without one effect.
pub struct InLastModel {
    /// Relative reduction of the validation error.
    pub error_reduction: f64,
    /// Change of the Bayesian information criterion.
    pub bic_change: f64,
}

impl InLastModel {
    fn of(without: &LinearModel, with: &LinearModel) -> Self {
        let error_reduction = 1.0 - validation_rms(with) / validation_rms(without);
        Self { error_reduction, bic_change: evidence::bic_change(without, with) }
    }
}

/// Partial R² of an effect in the last model.
fn importance(end: &TwoStageModel, id: &str) -> f64 {
    let loss = |(part, without): &(&LinearModel, LinearModel)| 1.0 - part.linear().sse / without.linear().sse;
    parts_without(end, id).iter().map(loss).fold(0.0, f64::max)
}

/// The parts of a model that contain an effect, each with the part without it.
fn parts_without<'a, 'p>(end: &'a TwoStageModel<'p>, id: &str) -> Vec<(&'a LinearModel<'p>, LinearModel<'p>)> {
    if let Ok(effect) = end.spec.find(id)
        && effect.traits().is_offset
    {
        return vec![(&end.main, end.main.without_given(effect))];
    }
    let parts = std::iter::once(&end.main).chain(&end.moving).filter(|part| part.contains(id));
    parts.map(|part| (part, part.without(id))).collect()
}
