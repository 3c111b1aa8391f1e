//! Definition of a user effect: the same object in TOML, in JSON and inside a fit.

use crate::effects;
use crate::formula::fault::{FormulaFault, Mistake};
use crate::formula::function::Function;
use crate::formula::signals::left_hand_side;
use crate::formula::{Formula, is_bare, signals};
use jointbench_instrument::Kind;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Largest number of parameters: data cannot separate more, and every subset is tested for linearity.
const MOST_PARAMETERS: usize = 8;
/// Largest number of tested integers, including all combinations of several integer parameters.
const MOST_WHOLE: f64 = 512.0;

/// A user effect as written, not yet checked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = EffectDefinition)]
pub struct Definition {
    /// Lower case letters, digits and underscores; not an id of the library.
    pub id: String,
    /// Kind of run whose response the formula is a part of.
    #[schema(value_type = String)]
    pub kind: Kind,
    /// `tau = …` for friction and brake, `error = …` for encoder, `torsion = …` for stiffness, over signals and
    /// parameters; the right-hand side alone is sufficient.
    pub formula: String,
    /// Parameters of the formula, at most eight; each must occur in it.
    pub parameters: Vec<UserParameter>,
    /// Name for users; may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub title: String,
    /// One sentence for users.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub sentence: String,
}

/// A parameter of a user effect. Linear parameters are solved for; nonlinear ones are searched for in their range.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = DefinedParameter)]
pub struct UserParameter {
    /// Name in the formula: a letter, then letters, digits and underscores; not a signal, constant or function.
    pub name: String,
    /// Unit in results, `1` if not given; contradictions with the formula are warnings.
    #[serde(default = "one")]
    pub unit: String,
    /// Smallest possible value. Absent: unbounded, for a nonlinear parameter a bound that follows from the data.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// Largest possible value. Absent: as for `min`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// Range of the starting points, inside the bounds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Vec<f64>>, min_items = 2, max_items = 2)]
    pub start: Option<[f64; 2]>,
    /// An integer parameter, such as waves in a turn: every value of the range is tested.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub whole: bool,
}

fn one() -> String {
    "1".to_owned()
}

impl Definition {
    /// Adds the left-hand side if it is missing, because files, exports and pages show the complete formula.
    pub(crate) fn whole(mut self) -> Self {
        let (left, names) = (left_hand_side(self.kind), self.parameters.iter().map(|p| p.name.as_str()));
        if is_bare(&self.formula, left, &names.collect::<Vec<_>>()) {
            self.formula = format!("{left} = {}", self.formula.trim());
        }
        self
    }

    /// The formula, if the definition is valid.
    pub(crate) fn check(&self) -> Result<Formula, FormulaFault> {
        self.check_id().map_err(|m| m.found(&self.id, "id", &self.id))?;
        for (i, parameter) in self.parameters.iter().enumerate() {
            let twice = self.parameters[..i].iter().any(|p| p.name == parameter.name);
            parameter.check(self.kind, twice).map_err(|m| m.found(&self.id, "parameters", &parameter.name))?;
        }
        let names: Vec<&str> = self.parameters.iter().map(|p| p.name.as_str()).collect();
        let in_formula = |mistake: Mistake| mistake.found(&self.id, "formula", &self.formula);
        if names.len() > MOST_PARAMETERS {
            let message = format!("an effect has at most {MOST_PARAMETERS} parameters; make two effects of it");
            return Err(in_formula(Mistake::new(0..0, message)));
        }
        let units: Vec<&str> = self.parameters.iter().map(|p| p.unit.as_str()).collect();
        let formula = Formula::parse(self.kind, &self.formula, &names, &units).map_err(in_formula)?;
        if let Some(unused) = (0..names.len()).find(|p| !formula.uses(*p)) {
            let message = format!("{} does not occur in the formula; leave it out", names[unused]);
            return Err(Mistake::new(0..names[unused].len(), message).found(&self.id, "parameters", names[unused]));
        }
        let whole = |p: &&usize| self.parameters[**p].whole;
        if let Some((linear, _)) = formula.columns.iter().find(|(p, _)| whole(&p)) {
            let message = format!("{} enters linearly and is solved for; it cannot be whole", names[*linear]);
            return Err(Mistake::new(0..names[*linear].len(), message).found(&self.id, "parameters", names[*linear]));
        }
        let tried: f64 = formula.shape.iter().filter(whole).map(|p| self.parameters[*p].whole_numbers()).product();
        if tried > MOST_WHOLE {
            let message = format!("{tried} combinations of whole numbers are too many: at most {MOST_WHOLE}");
            return Err(in_formula(Mistake::new(0..0, message)));
        }
        Ok(formula)
    }

    fn check_id(&self) -> Result<(), Mistake> {
        let all = 0..self.id.len();
        check_name(&self.id)?;
        if self.id.chars().any(char::is_uppercase) {
            return Err(Mistake::new(all, "an id is written in lower case"));
        }
        if effects::find(self.kind, &self.id).is_ok() {
            let message = format!("the library has an effect {} already; choose another id", self.id);
            return Err(Mistake::new(all, message));
        }
        Ok(())
    }
}

impl UserParameter {
    fn check(&self, kind: Kind, twice: bool) -> Result<(), Mistake> {
        let all = || 0..self.name.len();
        check_name(&self.name)?;
        let refuse = |message: String| Err(Mistake::new(all(), message));
        if twice {
            return refuse(format!("{} is declared twice", self.name));
        }
        let is_signal = signals(kind).iter().any(|s| s.name == self.name);
        if is_signal || self.name == "pi" || Function::find(&self.name).is_some() {
            return refuse(format!("{} is a signal, a constant or a function; choose another name", self.name));
        }
        let bounds = [self.min, self.max].into_iter().chain(self.start.into_iter().flatten().map(Some));
        if bounds.flatten().any(|b| !b.is_finite()) {
            return refuse(format!("the bounds of {} must be finite; leave out one that is not there", self.name));
        }
        let (min, max) = (self.min.unwrap_or(f64::NEG_INFINITY), self.max.unwrap_or(f64::INFINITY));
        if min >= max {
            return refuse(format!("the range of {} is empty: {min} to {max}", self.name));
        }
        if let Some([low, high]) = self.start
            && !(low <= high && low >= min && high <= max)
        {
            return refuse(format!("the search for {} begins outside its bounds: {low} to {high}", self.name));
        }
        if self.whole && !(min.fract() == 0.0 && max.fract() == 0.0) {
            return refuse(format!("{} is a whole number: it needs whole bounds on both sides", self.name));
        }
        Ok(())
    }

    /// Number of integers in the range.
    fn whole_numbers(&self) -> f64 {
        self.max.unwrap_or_default() - self.min.unwrap_or_default() + 1.0
    }
}

/// A name that is valid in formulas and in C.
fn check_name(name: &str) -> Result<(), Mistake> {
    let wrong =
        name.char_indices().find(|(i, c)| !(c.is_ascii_alphabetic() || *i > 0 && (c.is_ascii_digit() || *c == '_')));
    match wrong {
        Some((at, c)) => {
            let message = "a name begins with a letter; letters, digits and underscores follow";
            Err(Mistake::new(at..at + c.len_utf8(), message))
        }
        None if name.is_empty() => Err(Mistake::new(0..0, "a name is missing")),
        None if name.len() > 40 => Err(Mistake::new(40..name.len(), "a name has at most 40 characters")),
        None => Ok(()),
    }
}
