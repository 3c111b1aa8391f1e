//! User effects: a formula with parameters, used like an effect of the library.

pub(crate) mod definition;
pub(crate) mod inline;
pub(crate) mod ranges;

pub use crate::user_effects::definition::{Definition, UserParameter};

use crate::ModelError;
use crate::effect::{Columns, Effect, EffectInfo, Form, ParameterInfo, Regime, Shape, Traits};
use crate::effects;
use crate::formula::fault::{FormulaFault, Mistake};
use crate::formula::signals::NamedSignal;
use crate::formula::{Formula, signals};
use crate::signal::Signal;
use crate::view::View;
use crate::words::list;
use jointbench_instrument::spelling::instead;
use jointbench_instrument::{Kind, Motion};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Warning for a formula that contains the motor torque.
const OF_RESPONSE: &str = "motor_torque is the response that a friction model predicts: an effect of it absorbs every residual, and predicts nothing from motion and load; name the cause instead";

/// A user effect with a valid definition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Definition", into = "Definition")]
pub struct UserEffect {
    definition: Definition,
    formula: Formula,
    parameters: Vec<ParameterInfo>,
    needs: Vec<&'static str>,
    /// The sentence of the user, or a generated one that names the formula.
    sentence: String,
    looks: String,
}

impl UserEffect {
    /// Reads the short form `id: formula; parameter [unit] min..max; …`.
    ///
    /// ```
    /// use jointbench_instrument::Kind;
    /// use jointbench_model::UserEffect;
    ///
    /// let text = "rub: tau = a * tanh(velocity / w0) * abs(load); a [1] 0..1; w0 [rad/s] 0.1..10";
    /// assert_eq!(UserEffect::inline(Kind::Friction, text).unwrap().id(), "rub");
    /// let fault = UserEffect::inline(Kind::Friction, "rub: tau = a * velocty; a [Nm]").unwrap_err();
    /// assert_eq!((fault.position, fault.length), (15, 7));
    /// ```
    pub fn inline(kind: Kind, text: &str) -> Result<Self, FormulaFault> {
        inline::read(kind, text)
    }

    /// Id, unique within the library and the model.
    pub fn id(&self) -> &str {
        &self.definition.id
    }

    /// Kind of run whose response the formula is a part of.
    pub fn kind(&self) -> Kind {
        self.definition.kind
    }

    /// The definition with the complete formula, including its left-hand side.
    pub fn definition(&self) -> &Definition {
        &self.definition
    }

    /// The parsed formula.
    pub fn formula(&self) -> &Formula {
        &self.formula
    }

    /// Warnings that do not change results: contradicting units for this motion (or for both motions if it is
    /// unknown), and a formula of the response itself.
    pub fn unit_warnings(&self, motion: Option<Motion>) -> Vec<FormulaFault> {
        let response = self.formula.columns.iter().find_map(|(_, e)| e.place_of(Signal::Drive));
        let response = response.map(|at| Mistake::new(at, OF_RESPONSE));
        let found = |mistake: Mistake| mistake.found(self.id(), "formula", &self.definition.formula);
        self.formula.unit_fault(motion).cloned().into_iter().chain(response).map(found).collect()
    }

    /// The first column of the formula that is not among `columns`.
    pub fn missing(&self, columns: &[&str]) -> Option<FormulaFault> {
        let others = self.formula.signals.iter().filter(|s| matches!(s.signal, Signal::Column(_)));
        let missing = others.into_iter().find(|s| !columns.contains(&s.column))?;
        let place = self.formula.columns.iter().find_map(|(_, e)| e.place_of(missing.signal))?;
        let message = format!("the run has no column {}; {}", missing.column, instead(missing.column, columns));
        Some(Mistake::new(place, message).found(self.id(), "formula", &self.definition.formula))
    }

    /// [`ModelError::NotFinite`] if a signal of this data makes the formula fail for all nonlinear parameters.
    pub(crate) fn check(&self, view: &View) -> Result<(), ModelError> {
        let present = self.formula.signals.iter().all(|s| view.find(s.signal).is_some());
        let tried: Vec<Columns> = self.grid(&self.shapes(view)).iter().map(|s| self.evaluate(s, view)).collect();
        if !present || tried.iter().any(is_finite) {
            return Ok(());
        }
        let bad = |column: &Vec<f64>| column.iter().position(|x| !x.is_finite());
        let point = tried.iter().flatten().find_map(bad).unwrap_or(0);
        let bad_points = tried.iter().flatten().map(|c| c.iter().filter(|x| !x.is_finite()).count()).min().unwrap_or(0);
        let values: Vec<String> = self
            .formula
            .signals
            .iter()
            .map(|s| format!("{} = {:.4} {}", s.name, view.get(s.signal)[point], s.unit))
            .collect();
        let first = match values.as_slice() {
            [] => "for it names no signal and has no finite value".to_owned(),
            values => format!("first where {}", values.join(", ")),
        };
        Err(ModelError::NotFinite { effect: self.id().to_owned(), points: bad_points.max(1), first })
    }

    fn shapes(&self, view: &View) -> Vec<Shape<'_>> {
        let range = |p: &usize| ranges::shape(&self.definition.parameters[*p], &self.formula.signals, view);
        self.formula.shape.iter().map(range).collect()
    }

    /// The only form of the effect, without starting points.
    pub(crate) fn form(&self, view: &View) -> Form<'_> {
        let name = |p: usize| self.definition.parameters[p].name.as_str();
        let linear = self.formula.columns.iter().map(|(p, _)| name(*p)).collect();
        Form { name: "formula", linear, shape: self.shapes(view), grid: Vec::new() }
    }

    fn grid(&self, shapes: &[Shape]) -> Vec<Vec<f64>> {
        ranges::grid(shapes, self.formula.shape.iter().map(|p| self.definition.parameters[*p].start))
    }

    fn evaluate(&self, shape: &[f64], view: &View) -> Columns {
        let mut parameters = vec![f64::NAN; self.parameters.len()];
        self.formula.shape.iter().zip(shape).for_each(|(p, value)| parameters[*p] = *value);
        let on_samples = self.formula.is_periodic
            && !view.chunks.is_empty()
            && self.formula.signals.iter().all(|s| view.samples.find(s.signal).is_some());
        let signals = if on_samples { &view.samples } else { &view.points };
        let columns = self.formula.columns.iter().map(|(_, e)| e.column(&parameters, signals));
        if on_samples { columns.map(|c| view.average(c)).collect() } else { columns.collect() }
    }
}

impl Effect for UserEffect {
    fn info(&self) -> EffectInfo<'_> {
        EffectInfo {
            id: &self.definition.id,
            kind: self.definition.kind,
            title: &self.definition.title,
            sentence: &self.sentence,
            formula: &self.definition.formula,
            source: "written by a user",
            looks: &self.looks,
            parameters: &self.parameters,
            needs: &self.needs,
        }
    }

    /// Starting points at which the formula is finite and not zero.
    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        let is_usable = |columns: &Columns| is_finite(columns) && columns.iter().all(|c| c.iter().any(|x| *x != 0.0));
        let mut grid = self.grid(&self.shapes(view));
        grid.retain(|start| is_usable(&self.evaluate(start, view)));
        if grid.is_empty() {
            return Vec::new();
        }
        vec![Form { grid, ..self.form(view) }]
    }

    fn columns(&self, _: &str, shape: &[f64], view: &View) -> Columns {
        self.evaluate(shape, view)
    }

    fn traits(&self) -> Traits {
        let of_ramps = |s: Signal| matches!(s, Signal::Acceleration | Signal::Jerk);
        let is_transient = self.formula.signals.iter().any(|s| of_ramps(s.signal));
        Traits {
            regime: if is_transient { Regime::Transient } else { Regime::SteadyState },
            unseen: Some("its formula is zero or not finite on this data"),
            is_user_defined: true,
            ..Traits::default()
        }
    }
}

/// The signals of a kind, and the additional columns of these effects.
pub fn signals_with(kind: Kind, user_effects: &[UserEffect]) -> Vec<NamedSignal> {
    let mut all = signals(kind).to_vec();
    for other in user_effects.iter().flat_map(|user_effect| &user_effect.formula.signals) {
        if !all.contains(other) {
            all.push(*other);
        }
    }
    all
}

impl TryFrom<Definition> for UserEffect {
    type Error = FormulaFault;

    fn try_from(definition: Definition) -> Result<Self, FormulaFault> {
        // An error has its position in the original text.
        definition.check()?;
        let definition = definition.whole();
        let formula = definition.check()?;
        let parameters = definition.parameters.iter().map(UserParameter::info).collect();
        let optional = |s: &&NamedSignal| {
            definition.kind.optional_columns().contains(&s.column) || matches!(s.signal, Signal::Column(_))
        };
        let needs = formula.signals.iter().filter(optional).map(|s| s.column).collect();
        let sentence = match definition.sentence.trim() {
            "" => format!("What a user suspects: {}.", definition.formula.trim()),
            written => written.to_owned(),
        };
        let over: Vec<&str> = formula.signals.iter().map(|s| s.name).collect();
        let looks = match over.as_slice() {
            [] => "what is left is the same everywhere".to_owned(),
            over => format!("what is left follows its formula over {}", list(over)),
        };
        Ok(Self { definition, formula, parameters, needs, sentence, looks })
    }
}

impl From<UserEffect> for Definition {
    fn from(effect: UserEffect) -> Self {
        effect.definition
    }
}

impl UserParameter {
    fn info(&self) -> ParameterInfo {
        ParameterInfo {
            name: Cow::Owned(self.name.clone()),
            unit: Cow::Owned(self.unit.clone()),
            min: self.min.unwrap_or(f64::NEG_INFINITY),
            max: self.max.unwrap_or(f64::INFINITY),
        }
    }
}

fn is_finite(columns: &Columns) -> bool {
    columns.iter().flatten().all(|x| x.is_finite())
}

/// The library, followed by the user effects.
pub(crate) fn with_user_effects(kind: Kind, user_effects: &[UserEffect]) -> impl Iterator<Item = &dyn Effect> {
    effects::effects(kind).iter().copied().chain(user_effects.iter().map(|effect| effect as &dyn Effect))
}

pub(crate) fn find_with_user_effects<'e>(
    kind: Kind,
    user_effects: &'e [UserEffect],
    id: &str,
) -> Result<&'e dyn Effect, ModelError> {
    with_user_effects(kind, user_effects).find(|e| e.info().id == id).ok_or_else(|| ModelError::UnknownEffect {
        id: id.to_owned(),
        kind,
        known: with_user_effects(kind, user_effects).map(|e| e.info().id.to_owned()).collect(),
    })
}

#[cfg(test)]
mod tests;
