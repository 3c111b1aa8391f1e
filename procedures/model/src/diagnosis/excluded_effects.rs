//! Effects that are not in the last model: each is below its detection limit, not testable, or rejected. No tested
//! effect is omitted.

use crate::effect::{Effect, Form, Regime, ShapeSearch};
use crate::effects::excitation;
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::diagnosis::Silent;
use crate::report::reasons::{Invisible, InvisibleReason, LeftOut, LeftOutReason, RejectionReason};
use crate::selection::detection_limit::DetectionLimit;
use crate::selection::model_selection::ModelSelection;
use crate::selection::{hysteresis_stage, ramp_stage};
use crate::stats::summary::rms;
use crate::words::list;

#[derive(Default)]
pub struct ExcludedEffects {
    /// Not found, with the detection limit.
    pub silent: Vec<Silent>,
    pub invisible: Vec<Invisible>,
    /// Tested and rejected, with the reason.
    pub left_out: Vec<LeftOut>,
}

impl ExcludedEffects {
    pub fn of(selected: &ModelSelection) -> Self {
        let ModelSelection { withdrawn, ties, detection_limits, .. } = selected;
        let end = selected.end();
        // Contradicting columns end the test of effects.
        if !end.prepared.data_errors.fatal.is_empty() {
            return Self::default();
        }
        let on_ramps = ramp_stage::detection_limit(end);
        let around_reversals = hysteresis_stage::detection_limits(end);
        let detection_limits: Vec<&DetectionLimit> =
            detection_limits.iter().chain(&around_reversals).chain(&on_ramps).collect();
        let signal = rms(&end.prepared.main.target);
        let mut others = Self::default();
        let is_out = |effect: &&dyn Effect| !end.effects.iter().any(|e| e == effect.info().id);
        for effect in end.spec.known().filter(is_out) {
            let id = effect.info().id;
            let tied = ties.iter().find(|(_, scored)| *scored == id).map(|(named, _)| {
                let why = format!("{named} is in the model, and this run cannot distinguish them");
                (RejectionReason::Confounded, why)
            });
            let removed = withdrawn.iter().find(|w| w.effect == id);
            let removed = removed.map(|w| (LeftOutReason::Removed(w.why), w.why.words().to_owned()));
            let refused = selected.decided.iter().flat_map(|decided| &decided.refused).find(|one| one.effect == id);
            let refused = refused.map(|one| (one.reason, one.words())).or_else(|| given(effect, end));
            let rejected = |(reason, why)| (LeftOutReason::Rejected(reason), why);
            let left_out = tied.map(rejected).or(removed).or(refused.map(rejected));
            let detection_limit = detection_limits.iter().find(|s| s.effect == id && s.detectable_rms.is_finite());
            match (left_out, detection_limit) {
                (Some((reason, why)), _) => others.left_out.push(LeftOut { effect: id.into(), reason, why }),
                // No noise is larger than the signal: only effects of the model can hide so much.
                (None, Some(limit)) if limit.detectable_rms <= signal => others.silent.push(Silent {
                    effect: id.into(),
                    minimum_detectable_rms: limit.detectable_rms,
                    upper_rms: None,
                    sought: sought(effect, end),
                }),
                (None, limit) => {
                    let (reason, why) = if limit.is_some() { alike(effect, end) } else { invisible(effect, end) };
                    others.invisible.push(Invisible { effect: id.into(), reason, why });
                }
            }
        }
        others
    }
}

/// An offset term has a fixed size, so that it has no detection limit.
fn given(effect: &dyn Effect, end: &TwoStageModel) -> Option<(RejectionReason, String)> {
    let is_tried = effect.traits().is_offset && effect.hidden(&end.prepared.main.view).is_none();
    is_tried
        .then(|| (RejectionReason::NoReduction, "it is used as measured, and does not clearly reduce the error".into()))
}

/// The tested numbers of waves.
fn sought(effect: &dyn Effect, end: &TwoStageModel) -> Option<String> {
    let forms = effect.forms(&end.prepared.main.view);
    let a_turn = |name: &str| effect.info().parameters.iter().any(|p| p.name == name && p.unit == "1/turn");
    let whole =
        |form: &&Form| form.shape.first().is_some_and(|shape| shape.search == ShapeSearch::Whole && a_turn(shape.name));
    let numbers = forms.iter().filter(whole).flat_map(|form| &form.grid).map(|shape| shape[0]);
    let (least, most) = numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), n| (l.min(n), m.max(n)));
    let waves = if most == 1.0 { "wave" } else { "waves" };
    match least < most {
        true => Some(format!("{least} to {most} {waves} a turn")),
        false => least.is_finite().then(|| format!("{least} {waves} a turn")),
    }
}

fn alike(effect: &dyn Effect, end: &TwoStageModel) -> (InvisibleReason, String) {
    let added: Vec<&String> = end.effects.iter().filter(|id| !end.spec.contains(id)).collect();
    let with = if added.is_empty() { String::new() } else { format!(" with {}", list(&added)) };
    let with = with + if end.main.problem.form_error.is_some() { " or of its nuisance terms" } else { "" };
    let why = format!(
        "indistinguishable in this data from effects of the model{with}; to distinguish them, measure {}",
        excitation(effect)
    );
    (InvisibleReason::Confounded, why)
}

fn invisible(effect: &dyn Effect, end: &TwoStageModel) -> (InvisibleReason, String) {
    const RAMP: &str = "no action at steady state. Ramps, where signals of different instruments are not aligned, are \
                        tested for a delay only, with an inertia in the model; add the effect to the model, or record a \
                        trajectory without steps";
    let prepared = end.prepared;
    let not_excited = |why: String| (InvisibleReason::NotExcited, why);
    let view = match (end.is_apart(effect), effect.traits().regime) {
        (true, Regime::Hysteresis) => match &prepared.memory {
            Some(problem) => &problem.view,
            None => return not_excited("the run has no slow reversals".into()),
        },
        (true, _) => {
            let why = effect.hidden(&prepared.main.view);
            return why.map_or_else(|| (InvisibleReason::RampsOnly, RAMP.into()), not_excited);
        }
        _ => &prepared.main.view,
    };
    effect.hidden(view).map_or_else(|| alike(effect, end), not_excited)
}
