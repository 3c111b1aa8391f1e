//! Experiment design: of the runs that a bench offers, the one that separates the models that the data leaves open.
//!
//! This crate contains no benches and procedures. The caller offers a menu: each [`Choice`] is a possible run, given
//! as its steady-state stretches. The result is the shortest run that is expected to separate the models.

pub(crate) mod separation;
pub(crate) mod simulate;
pub(crate) mod unobserved;

use crate::experiment_design::separation::{Noise, Side};
use crate::experiment_design::simulate::simulate;
use crate::inference::confounding;
use crate::preprocess::{Prepared, Problem, prepare};
use crate::regression::two_stage_model::TwoStageModel;
use crate::report::diagnosis::{Diagnosis, Discovery, Experiment, Silent, Verdict};
use crate::signal::Signal;
use crate::stats::summary::peak;
use crate::thresholds::{NEARLY_COVERED, SEPARATED_Z, USELESS_Z, WORTH_SEEING};
use crate::words::list;
use crate::{Fit, ModelError, ModelSpec, Options, UserEffect};
use jointbench_instrument::{Motion, RunTable};
use serde_json::{Map, Value};
use std::cmp::Ordering;

/// A possible run.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Name of the procedure, returned in [`Experiment::procedure`].
    pub procedure: String,
    /// Parameters of the procedure by name, returned unchanged in [`Experiment::parameters`].
    pub parameters: Map<String, Value>,
    /// Infinite if unknown.
    pub duration_s: f64,
    /// Steady-state parts of the run in their order; transients are not predicted.
    pub stretches: Vec<Stretch>,
}

impl Choice {
    fn powers_anew(&self) -> bool {
        self.stretches.iter().any(|stretch| stretch.power_ups > 0)
    }

    /// Assumptions of the expectation in addition to the model, in words.
    fn provided(&self) -> String {
        let warmer_k = self.stretches.iter().map(|s| s.warmer_k).fold(0.0, f64::max);
        if warmer_k > 0.0 { format!(", if it warms the joint by {warmer_k:.0} K") } else { String::new() }
    }
}

/// Constant speed under constant load.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stretch {
    /// Time since the start of the run.
    pub start_s: f64,
    /// Length of the stretch [s].
    pub duration_s: f64,
    /// Motor side; for encoders the shaft.
    pub velocity_rad_s: f64,
    /// Motor position at the beginning, relative to the start of the run.
    pub from_rad: f64,
    /// Link torque that the joint delivers.
    pub load_nm: f64,
    /// Coil current of the brake.
    pub brake_current_a: f64,
    /// Number of power cycles of the encoder under test before this stretch.
    pub power_ups: u32,
    /// Temperature of the joint above that at the end of the measured run, if the choice warms it [K].
    pub warmer_k: f64,
}

/// Questions that a diagnosis leaves open.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Open {
    /// The model with all named effects.
    pub model: Vec<String>,
    /// Named effects, each with the effects that are confounded with it.
    pub ties: Vec<(String, Vec<String>)>,
    /// An effect that may be present as well.
    pub imitated: Option<String>,
    /// Whether repeats determine the noise floor. Without one, a run with repeats is recommended.
    pub has_noise_floor: bool,
    /// Unexplained structure remains in this data; a run for effects that it cannot show would not explain that.
    pub has_structure: bool,
    /// Effects that this data would have shown at a size that is worth a run.
    pub tested: Vec<String>,
    /// User effects that the model or its alternatives contain.
    pub user_effects: Vec<UserEffect>,
}

impl From<&Diagnosis> for Open {
    fn from(diagnosis: &Diagnosis) -> Self {
        let named = diagnosis.suggestions.iter().map(|s| s.effect.clone());
        let tied = diagnosis.suggestions.iter().filter(|s| !s.confounded_with.is_empty());
        Self {
            model: diagnosis.model.iter().cloned().chain(named).collect(),
            ties: tied.map(|s| (s.effect.clone(), s.confounded_with.clone())).collect(),
            imitated: diagnosis.imitated.as_ref().map(|open| open.effect.clone()),
            has_noise_floor: diagnosis.noise_floor_rms.is_some(),
            has_structure: diagnosis.structure_remains,
            tested: tested(&diagnosis.silent, &diagnosis.fit),
            user_effects: Vec::new(),
        }
    }
}

impl From<&Discovery> for Open {
    fn from(discovery: &Discovery) -> Self {
        let tied = discovery.steps.iter().filter(|s| !s.confounded_with.is_empty());
        let tied = tied.filter_map(|s| Some((s.added.clone()?, s.confounded_with.clone())));
        Self {
            model: discovery.model.clone(),
            ties: tied.filter(|(effect, _)| discovery.model.contains(effect)).collect(),
            imitated: discovery.imitated.as_ref().map(|open| open.effect.clone()),
            has_noise_floor: discovery.noise_floor_rms.is_some(),
            has_structure: discovery.verdict == Verdict::UnexplainedStructure,
            tested: tested(&discovery.silent, &discovery.fit),
            user_effects: Vec::new(),
        }
    }
}

/// The recommended next run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Next {
    /// The run to perform, `None` if no run of the menu answers an open question.
    pub experiment: Option<Experiment>,
    /// Confounded pairs that no run of the menu separates, in a sentence.
    pub in_vain: Option<String>,
}

/// Effects that were not found, although this data shows a size of [`WORTH_SEEING`].
fn tested(silent: &[Silent], fit: &Fit) -> Vec<String> {
    let least = WORTH_SEEING * fit.rms / fit.relative_error;
    let shown = silent.iter().filter(|one| one.minimum_detectable_rms <= least);
    shown.map(|one| one.effect.clone()).collect()
}

/// The recommended next run. None is recommended for contradicting columns, which have to be corrected first.
///
/// Confounded effects have priority, then an effect that may be present as well. After these come a temperature
/// effect confounded with time, missing repeats, and effects that this run could not show.
pub fn next_run(run: &RunTable, open: &Open, menu: &[Choice], options: &Options) -> Result<Next, ModelError> {
    let mut next = choose(run, open, menu, options)?;
    if let (Some(next), Motion::Linear) = (&mut next.experiment, run.meta().motion) {
        next.why.push_str("; the axis slides: rad in the names of the parameters is m");
    }
    Ok(next)
}

fn choose(run: &RunTable, open: &Open, menu: &[Choice], options: &Options) -> Result<Next, ModelError> {
    let prepared = prepare(run, options)?;
    if !prepared.data_errors.is_empty() {
        return Ok(Next::default());
    }
    let spec = ModelSpec::with_user_effects(run.kind(), &open.model, open.user_effects.clone())?;
    let model = TwoStageModel::new(&prepared, &spec, options)?;
    let noise = Noise::of(&model.main);
    let gear = run.meta().gear_ratio.unwrap_or(1.0);
    let known = menu.iter().filter(|choice| !choice.stretches.is_empty());
    let simulated: Vec<_> = known.map(|choice| (choice, simulate(choice, &prepared, &model, gear))).collect();
    let has_choices = !simulated.is_empty();
    let side = Side::new(&model.main, &noise);
    let offer = RunPlanner { menu, simulated, prepared: &prepared, model: &model, side, noise, options };
    let mut in_vain = Vec::new();
    for (effect, alternatives) in &open.ties {
        let (experiment, vain) = offer.distinguish(effect, alternatives, open)?;
        let vain = vain.filter(|_| has_choices);
        if let Some(mut next) = experiment {
            next.why
                .extend(vain.map(|vain| format!("; no run within the given limits is expected to distinguish {vain}")));
            return Ok(next.into());
        }
        in_vain.extend(vain);
    }
    let next = offer.without_ties(open)?;
    let in_vain = (!in_vain.is_empty()).then(|| {
        let ties = list(&in_vain);
        format!("run within the given limits is expected to distinguish {ties}")
    });
    Ok(match (next, in_vain) {
        (Some(next), Some(vain)) => Experiment { why: format!("{}; no {vain}", next.why), ..next }.into(),
        (Some(next), None) => next.into(),
        (None, vain) => Next { experiment: None, in_vain: vain.map(|vain| format!("No {vain}.")) },
    })
}

/// The menu with its simulated runs, and the model on the measured run.
struct RunPlanner<'a> {
    menu: &'a [Choice],
    simulated: Vec<(&'a Choice, Problem)>,
    prepared: &'a Prepared,
    model: &'a TwoStageModel<'a>,
    side: Side<'a>,
    noise: Noise,
    options: &'a Options,
}

impl<'a> RunPlanner<'a> {
    /// The run that separates the model from all these alternatives.
    fn decided(&self, alternatives: &[ModelSpec]) -> Result<Option<ScoredRun<'a>>, ModelError> {
        let others = alternatives.iter().map(|spec| TwoStageModel::new(self.prepared, spec, self.options));
        let others: Vec<TwoStageModel> = others.collect::<Result<_, _>>()?;
        let others: Vec<Side> = others.iter().map(|other| Side::new(&other.main, &self.noise)).collect();
        // An encoder is power-cycled only for effects that depend on it.
        let asks_for_power_ups = self.side.changes_by_run() || others.iter().any(Side::changes_by_run);
        let useful = self.simulated.iter().filter(|(choice, _)| asks_for_power_ups || !choice.powers_anew());
        Ok(decide(useful.map(|(choice, problem)| {
            let apart = others.iter().map(|other| self.side.separation(other, problem, &self.noise));
            ScoredRun { choice, z: apart.fold(f64::INFINITY, f64::min) }
        })))
    }

    /// The run that distinguishes an effect from its alternatives, and the pairs that no run distinguishes, in words.
    fn distinguish(
        &self,
        effect: &String,
        alternatives: &[String],
        open: &Open,
    ) -> Result<(Option<Experiment>, Option<String>), ModelError> {
        let instead = |alternative: &String| {
            let effects: Vec<String> =
                open.model.iter().map(|e| if e == effect { alternative } else { e }.clone()).collect();
            ModelSpec::with_user_effects(self.prepared.kind, effects, open.user_effects.clone())
        };
        // A candidate that no run separates does not prevent the separation of the others.
        let (mut apart, mut specs, mut alike, mut first) = (Vec::new(), Vec::new(), Vec::new(), None);
        for alternative in alternatives.iter().filter(|alternative| !open.model.contains(alternative)) {
            let other = [instead(alternative)?];
            match self.decided(&other)? {
                Some(bid) => {
                    first.get_or_insert(bid);
                    apart.push(alternative.clone());
                    specs.extend(other);
                }
                None => alike.push(alternative.clone()),
            }
        }
        let vain = (!alike.is_empty()).then(|| format!("{effect} from {}", list(&alike)));
        // One run for all of them, or one for the first.
        let together = if apart.len() > 1 { self.decided(&specs)? } else { None };
        if together.is_none() {
            apart.truncate(1);
        }
        let experiment = together.or(first).map(|bid| {
            let question = format!("distinguish {effect} from {}", list(&apart));
            experiment(bid, &question, std::iter::once(effect).chain(&apart))
        });
        Ok((experiment, vain))
    }

    /// The run for the other open questions, in the order of their priority.
    fn without_ties(mut self, open: &Open) -> Result<Option<Experiment>, ModelError> {
        let spec = self.model.spec;
        if let Some(effect) = &open.imitated
            && let Some(bid) = self.decided(&[spec.with(effect)?])?
        {
            Ok(Some(experiment(bid, &format!("decide whether {effect} is present"), [effect])))
        } else if let Some((effect, spec)) = over_time(spec, self.prepared)?
            && let Some(bid) = self.decided(&[spec])?
        {
            Ok(Some(experiment(bid, &format!("distinguish {effect} from a drift over time"), [&effect])))
        } else if !open.has_noise_floor
            && let Some(choice) = nearest(self.menu, self.prepared)
        {
            Ok(Some(again(choice)))
        } else if open.has_structure {
            Ok(None)
        } else {
            self.simulated.retain(|(choice, _)| !choice.powers_anew());
            Ok(unobserved::unseen(self.model, &self.noise, &self.simulated, &open.tested))
        }
    }
}

impl From<Experiment> for Next {
    fn from(experiment: Experiment) -> Self {
        Self { experiment: Some(experiment), in_vain: None }
    }
}

/// A temperature effect of the model that is confounded with time, and the model with the same effect over time.
fn over_time(model: &ModelSpec, prepared: &Prepared) -> Result<Option<(String, ModelSpec)>, ModelError> {
    for id in &model.effects {
        let Some(over_time) = confounding::over_time(model.find(id)?, prepared) else { continue };
        if model.user_effects.iter().any(|user_effect| user_effect.id() == over_time.id()) {
            continue;
        }
        let effects = model.effects.iter().map(|e| if e == id { over_time.id() } else { e }.to_owned());
        let effects: Vec<String> = effects.collect();
        let user_effects = model.user_effects.iter().cloned().chain([over_time.clone()]).collect();
        return Ok(Some((id.clone(), ModelSpec::with_user_effects(model.kind, effects, user_effects)?)));
    }
    Ok(None)
}

/// A choice with its expected separation.
#[derive(Clone, Copy)]
struct ScoredRun<'m> {
    choice: &'m Choice,
    z: f64,
}

/// The shortest run that separates the models, otherwise the run with the largest separation.
fn decide<'m>(bids: impl Iterator<Item = ScoredRun<'m>>) -> Option<ScoredRun<'m>> {
    let bids: Vec<ScoredRun> = bids.filter(|bid| bid.z.is_finite() && bid.z >= USELESS_Z).collect();
    let enough = bids.iter().filter(|bid| bid.z >= SEPARATED_Z);
    let shortest = enough.min_by(|a, b| a.choice.duration_s.total_cmp(&b.choice.duration_s));
    shortest.or_else(|| bids.iter().max_by(|a, b| a.z.total_cmp(&b.z))).copied()
}

fn experiment<'e>(bid: ScoredRun, what: &str, separates: impl IntoIterator<Item = &'e String>) -> Experiment {
    let times = (SEPARATED_Z / bid.z).powi(2).ceil();
    let enough = if bid.z >= SEPARATED_Z {
        String::new()
    } else {
        format!("; about {times:.0} such runs are needed for {SEPARATED_Z:.0} standard deviations")
    };
    Experiment {
        procedure: bid.choice.procedure.clone(),
        parameters: bid.choice.parameters.clone(),
        why: format!(
            "it would {what} (expected separation {} standard deviations{}){enough}",
            in_words(bid.z),
            bid.choice.provided(),
        ),
        expected_z: Some(bid.z),
        expected_duration_s: Some(bid.choice.duration_s),
        separates: separates.into_iter().cloned().collect(),
    }
}

/// A separation above a hundred needs no exact figure.
fn in_words(z: f64) -> String {
    if z < 100.0 { format!("{z:.1}") } else { "more than 100".to_owned() }
}

/// The choice that covers the largest speed of the measured run best, then its largest load; among equals the first,
/// which is the default.
fn nearest<'m>(menu: &'m [Choice], prepared: &Prepared) -> Option<&'m Choice> {
    let points = &prepared.main.view.points;
    let largest = |signal| points.find(signal).map_or(0.0, peak);
    let (fastest, heaviest) = (largest(Signal::Velocity), prepared.load_scale * largest(Signal::Load));
    let share = |choice: &Choice, of: fn(&Stretch) -> f64, all: f64| {
        let most = choice.stretches.iter().fold(0.0f64, |most, stretch| most.max(of(stretch).abs()));
        if all > 0.0 { (most / (NEARLY_COVERED * all)).min(1.0) } else { 1.0 }
    };
    let covered =
        |choice: &Choice| (share(choice, |s| s.velocity_rad_s, fastest), share(choice, |s| s.load_nm, heaviest));
    menu.iter().rev().max_by(|a, b| covered(a).partial_cmp(&covered(b)).unwrap_or(Ordering::Equal))
}

/// A run with the same profile again, for its repeats.
fn again(choice: &Choice) -> Experiment {
    Experiment {
        procedure: choice.procedure.clone(),
        parameters: choice.parameters.clone(),
        why: "without repeats of the same motion the noise floor is not known; repeat this run with equal, numbered \
              repeats, or perform the proposed run"
            .into(),
        expected_z: None,
        expected_duration_s: choice.duration_s.is_finite().then_some(choice.duration_s),
        separates: Vec::new(),
    }
}
