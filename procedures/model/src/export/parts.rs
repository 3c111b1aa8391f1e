//! A fit divided into parts: every term as formulas, for library and user effects alike.

use crate::formula::expression::Expression;
use crate::formula::signals::left_hand_side;
use crate::formula::syntax;
use crate::report::fit::{Fit, Term};
use crate::signal::Signal;
use crate::symbolic::{Column, FittedForm, Rule};
use crate::user_effects::find_with_user_effects;
use crate::{Effect, ModelError};

/// One effect of the model as a controller computes it.
#[derive(Debug)]
pub struct Part<'f> {
    pub effect: &'f str,
    pub title: &'f str,
    pub columns: Vec<PartColumn>,
    /// Name and value of every coefficient. Empty for an offset term.
    pub coefficients: Vec<(&'f str, f64)>,
    /// Name and value of every nonlinear parameter, in the order of the formula's parameter numbers.
    pub shape: Vec<(&'f str, f64)>,
}

#[derive(Debug)]
pub enum PartColumn {
    Formula(Expression),
    /// The parameter after the nonlinear ones is the state.
    Memory {
        rule: Rule,
        signal: Signal,
        reach: usize,
        end: Expression,
        formula: Expression,
    },
    Band {
        stops: usize,
        bands: usize,
        band: usize,
    },
}

/// The parts that an export contains, and those that it cannot contain.
#[derive(Debug)]
pub struct Parts<'f> {
    pub parts: Vec<Part<'f>>,
    /// Omitted effects with the reason.
    pub left_out: Vec<(&'f str, String)>,
}

impl<'f> Parts<'f> {
    pub fn of(fit: &'f Fit) -> Result<Self, ModelError> {
        let mut parts = Self { parts: Vec::new(), left_out: Vec::new() };
        for id in &fit.effects {
            let effect = find_with_user_effects(fit.kind, &fit.user_effects, id)?;
            let title = effect.info().title;
            if effect.traits().is_offset {
                let columns = vec![PartColumn::Formula(formula(fit, "load", &[])?)];
                parts.parts.push(Part { effect: id, title, columns, coefficients: Vec::new(), shape: Vec::new() });
                continue;
            }
            let Some(term) = fit.terms.iter().find(|t| t.effect == *id) else {
                parts.left_out.push((id, "the run that was fitted could not show it".into()));
                continue;
            };
            match columns(fit, effect, term)? {
                Ok(columns) => parts.parts.push(part(id, title, term, columns)?),
                Err(why) => parts.left_out.push((id, why.into())),
            }
        }
        Ok(parts)
    }

    /// Whether any part depends on a signal.
    pub fn uses(&self, signal: Signal) -> bool {
        self.parts.iter().any(|part| part.uses(signal))
    }
}

impl Part<'_> {
    pub fn uses(&self, signal: Signal) -> bool {
        self.columns.iter().any(|column| match column {
            PartColumn::Formula(formula) => formula.uses_signal(signal),
            PartColumn::Memory { signal: of, end, formula, .. } => {
                *of == signal || end.uses_signal(signal) || formula.uses_signal(signal)
            }
            PartColumn::Band { .. } => signal == Signal::Current,
        })
    }
}

fn part<'f>(effect: &'f str, title: &'f str, term: &'f Term, columns: Vec<PartColumn>) -> Result<Part<'f>, ModelError> {
    let count = term.linear.len() + term.shape.len();
    if term.names.len() != count || columns.len() < term.linear.len() {
        return Err(ModelError::UnknownForm { effect: effect.into(), form: term.form.clone() });
    }
    let mut names = term.names.iter().map(String::as_str);
    let coefficients = names.by_ref().zip(term.linear.iter().copied()).take(term.linear.len()).collect();
    let shape = term.names[term.linear.len()..].iter().map(String::as_str).zip(term.shape.iter().copied()).collect();
    Ok(Part { effect, title, columns, coefficients, shape })
}

/// The columns, or why a controller cannot compute them.
fn columns(fit: &Fit, effect: &dyn Effect, term: &Term) -> Result<Result<Vec<PartColumn>, &'static str>, ModelError> {
    if let Some(user_effect) = fit.user_effects.iter().find(|user_effect| user_effect.id() == term.effect) {
        // The definition numbers all parameters, the part only the nonlinear ones.
        let formula = user_effect.formula();
        let number = |p: usize| formula.shape.iter().position(|s| *s == p).unwrap_or(usize::MAX);
        return Ok(Ok(formula.columns.iter().map(|(_, e)| PartColumn::Formula(e.renumbered(&number))).collect()));
    }
    let form = FittedForm { name: &term.form, linear: term.linear.len(), shape: term.shape.len() };
    let columns = match effect.symbolic(&form) {
        Ok(columns) => columns,
        Err(why) => return Ok(Err(why)),
    };
    let names: Vec<&str> = term.names.iter().skip(term.linear.len()).map(String::as_str).collect();
    let with_state: Vec<&str> = names.iter().copied().chain(["z"]).collect();
    let resolved = columns.into_iter().map(|column| {
        Ok(match column {
            Column::Formula(text) => PartColumn::Formula(formula(fit, &text, &names)?),
            Column::Memory { rule, signal, reach, end, formula: text } => PartColumn::Memory {
                rule,
                reach,
                end: formula(fit, end, &names)?,
                signal: crate::formula::signals(fit.kind)
                    .iter()
                    .find(|s| s.name == signal)
                    .map_or(Signal::Time, |s| s.signal),
                formula: formula(fit, text, &with_state)?,
            },
            Column::Band { stops, bands, band } => PartColumn::Band { stops, bands, band },
        })
    });
    resolved.collect::<Result<_, ModelError>>().map(Ok)
}

fn formula(fit: &Fit, text: &str, names: &[&str]) -> Result<Expression, ModelError> {
    let whole = format!("{} = {text}", left_hand_side(fit.kind));
    let resolved = syntax::equation(&whole).and_then(|(_, tree)| Expression::resolve(tree, fit.kind, names));
    resolved.map_err(|mistake| Box::new(mistake.found("library", "formula", &whole)).into())
}
