//! Inputs of fits and diagnoses: a model as a kind and a set of effects, and the options.

use crate::effect::Effect;
use crate::report::setting::ParameterSetting;
use crate::set_effect::SetEffect;
use crate::thresholds::{ALPHA, FLIPS, PRACTICAL_SHARE};
use crate::user_effects;
use crate::words::list;
use crate::{ModelError, UserEffect};
use jointbench_instrument::{Kind, RunTable};
use serde::{Deserialize, Serialize};

/// A model: a kind and the effects whose sum it is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelSpec {
    /// Kind of run that the model describes.
    pub kind: Kind,
    /// Stable effect ids, in the order in which they were added.
    pub effects: Vec<String>,
    /// User effects: the model may contain them, and a diagnosis may suggest them.
    #[serde(default, rename = "own", skip_serializing_if = "Vec::is_empty")]
    pub user_effects: Vec<UserEffect>,
    /// Fixed values, bounds and start values of parameters.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub settings: Vec<ParameterSetting>,
    /// The effects whose parameters are set, in the form of one fit.
    #[serde(skip)]
    pub(crate) set: Vec<SetEffect>,
}

impl ModelSpec {
    /// Checks that every effect is known for the kind and named once.
    pub fn new(kind: Kind, effects: impl IntoIterator<Item = impl Into<String>>) -> Result<Self, ModelError> {
        Self::with_user_effects(kind, effects, Vec::new())
    }

    /// The same with user effects; those of other kinds are ignored.
    pub fn with_user_effects(
        kind: Kind,
        effects: impl IntoIterator<Item = impl Into<String>>,
        mut user_effects: Vec<UserEffect>,
    ) -> Result<Self, ModelError> {
        user_effects.retain(|effect| effect.kind() == kind);
        let effects = effects.into_iter().map(Into::into).collect();
        let spec = Self { kind, effects, user_effects, settings: Vec::new(), set: Vec::new() };
        if spec.effects.is_empty() {
            return Err(ModelError::EmptyModel);
        }
        let mut users = spec.user_effects.iter().enumerate();
        if let Some((_, twice)) =
            users.find(|(i, one)| spec.user_effects[..*i].iter().any(|other| other.id() == one.id()))
        {
            return Err(ModelError::TwiceNamed(twice.id().to_owned()));
        }
        for (i, id) in spec.effects.iter().enumerate() {
            spec.find(id)?;
            if spec.effects[..i].contains(id) {
                return Err(ModelError::TwiceNamed(id.clone()));
            }
        }
        Ok(spec)
    }

    /// The `baseline` of the run's meta file.
    pub fn baseline(run: &RunTable) -> Result<Self, ModelError> {
        Self::new(run.kind(), run.meta().baseline.iter())
    }

    /// Effects separated by commas, as on the command line.
    pub fn parse(kind: Kind, list: &str) -> Result<Self, ModelError> {
        Self::new(kind, list.split(',').map(str::trim).filter(|id| !id.is_empty()))
    }

    /// The same model with fixed values, bounds and start values of parameters.
    ///
    /// # Errors
    /// [`ModelError::BadSetting`] for a setting that no fit can follow.
    pub fn with_settings(mut self, settings: Vec<ParameterSetting>) -> Result<Self, ModelError> {
        for (i, setting) in settings.iter().enumerate() {
            let refused = |why: String| ModelError::BadSetting {
                effect: setting.effect.clone(),
                name: setting.name.clone(),
                why,
            };
            if !self.contains(&setting.effect) {
                return Err(refused("the model does not contain the effect; add it, or remove the setting".into()));
            }
            let info = self.find(&setting.effect)?.info();
            let Some(parameter) = info.parameter(&setting.name) else {
                let names: Vec<String> = info.parameters.iter().map(|p| p.name.to_string()).collect();
                return Err(refused(match names.is_empty() {
                    true => "the effect has no parameters".into(),
                    false => format!("the effect has no such parameter; it has {}", list(&names)),
                }));
            };
            let twice = |other: &&ParameterSetting| other.effect == setting.effect && other.name == setting.name;
            if settings[..i].iter().any(|other| twice(&other)) {
                return Err(refused("it is set twice; give all its settings once".into()));
            }
            setting.check((parameter.min, parameter.max)).map_err(refused)?;
        }
        self.settings = settings;
        Ok(self)
    }

    /// Every effect that a model of this kind may contain.
    pub fn known(&self) -> impl Iterator<Item = &dyn Effect> {
        let as_set = |id: &str| self.set.iter().find(|set| set.info().id == id).map(|set| set as &dyn Effect);
        user_effects::with_user_effects(self.kind, &self.user_effects)
            .map(move |effect| as_set(effect.info().id).unwrap_or(effect))
    }

    /// The effect with an id. [`ModelError::UnknownEffect`] lists the known ids.
    pub fn find(&self, id: &str) -> Result<&dyn Effect, ModelError> {
        match self.set.iter().find(|set| set.info().id == id) {
            Some(set) => Ok(set),
            None => user_effects::find_with_user_effects(self.kind, &self.user_effects, id),
        }
    }

    /// Whether the effect is in the model.
    pub fn contains(&self, id: &str) -> bool {
        self.effects.iter().any(|e| e == id)
    }

    /// The model with one more effect, added last.
    ///
    /// # Errors
    /// [`ModelError::UnknownEffect`] for an unknown id, [`ModelError::TwiceNamed`] if the model contains it already.
    pub fn with(&self, id: &str) -> Result<Self, ModelError> {
        Self::with_user_effects(
            self.kind,
            self.effects.iter().map(String::as_str).chain([id]),
            self.user_effects.clone(),
        )
    }

    /// The model without an effect; unchanged if it does not contain it.
    pub fn without(&self, id: &str) -> Self {
        let effects = self.effects.iter().filter(|e| *e != id).cloned().collect();
        Self { effects, ..self.clone() }
    }
}

/// Options of preprocessing and significance. `None` selects a value from the data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// The data of the residual. `None`: steady-state means if the run has steady states, otherwise filtered samples.
    pub residual: Option<crate::ResidualKind>,
    /// Corner frequency of the zero-phase Butterworth filter, 4th order, on positions [Hz].
    pub cutoff_hz: Option<f64>,
    /// Decimation: keeps every n-th sample after the low-pass filter.
    pub decimation: Option<usize>,
    /// Length of the chunks of steady-state means [s].
    pub chunk_s: Option<f64>,
    /// Family-wise error probability over everything that is reported.
    pub alpha: f64,
    /// Least partial R² of a named effect.
    pub practical_share: f64,
    /// Number of sign flips in permutation tests.
    pub flips: usize,
    /// Seed of the sign flips: the same run, options and seed give the same p-values.
    pub seed: u64,
}

impl Options {
    /// Rejects values that no run can be preprocessed or judged with.
    pub(crate) fn check(&self) -> Result<(), ModelError> {
        let positive = |value: Option<f64>| value.is_none_or(|v| v.is_finite() && v > 0.0);
        let share = |value: f64| value > 0.0 && value < 1.0;
        let (option, why) = match self {
            _ if !positive(self.cutoff_hz) => ("cutoff_hz", "expected a positive frequency"),
            _ if self.decimation == Some(0) => ("decimation", "expected 1 or more"),
            _ if !positive(self.chunk_s) => ("chunk_s", "expected a positive time"),
            _ if !share(self.alpha) => ("alpha", "expected a share between 0 and 1"),
            _ if !share(self.practical_share) => ("practical_share", "expected a share between 0 and 1"),
            _ => return Ok(()),
        };
        Err(ModelError::BadOption { option, why: why.into() })
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            residual: None,
            cutoff_hz: None,
            decimation: None,
            chunk_s: None,
            alpha: ALPHA,
            practical_share: PRACTICAL_SHARE,
            flips: FLIPS as usize,
            seed: 1,
        }
    }
}
