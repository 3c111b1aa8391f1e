//! Validates the terms of a model file against their effects.

use crate::effect::{Effect, Form, ShapeSearch};
use crate::effects::find;
use crate::report::fit::{Fit, FormErrorTerm, ParameterState, Term};
use crate::signal::{Signal, Signals};
use crate::view::View;
use crate::words::list;
use crate::{ModelError, UserEffect};
use std::f64::consts::TAU;

/// Every effect of the model has exactly the terms that it needs.
pub fn check(fit: &Fit, effects: &[&dyn Effect]) -> Result<(), ModelError> {
    for effect in effects {
        let id = effect.info().id;
        let fault = |what: String| Err(ModelError::BadFile(format!("{id} {what}")));
        let terms: Vec<&Term> = fit.terms.iter().filter(|t| t.effect == id).collect();
        match terms[..] {
            [] if effect.traits().is_offset || is_hidden(fit, id) => {}
            [] => return fault("has no term, but the run that was fitted shows it: a term for it is expected".into()),
            [_] if effect.traits().is_offset => {
                return fault("has a term, but it enters as it is: no term is expected".into());
            }
            [term] => {
                if let Err(why) =
                    check_term(term, *effect, fit.user_effects.iter().find(|user_effect| user_effect.id() == id))
                {
                    return fault(why);
                }
            }
            _ => return fault(format!("has {} terms: one is expected", terms.len())),
        }
    }
    fit.form_error.iter().try_for_each(|term| check_form_error(fit, term))
}

/// A form-error column. Another form of an effect has as many values as that form.
fn check_form_error(fit: &Fit, term: &FormErrorTerm) -> Result<(), ModelError> {
    let fault = |what: &str| Err(ModelError::BadFile(format!("form_error {} {what}", term.name)));
    if !term.linear.iter().chain(&term.shape).all(|value| value.is_finite()) {
        return fault("has a value that is not finite");
    }
    let user_effect = fit.user_effects.iter().find(|user_effect| user_effect.id() == term.name);
    let forms: Vec<Form> = match (user_effect, find(fit.kind, &term.name)) {
        (Some(user_effect), _) => vec![user_effect.form(&View::default())],
        (None, Ok(effect)) => forms(effect, term.linear.len()),
        (None, Err(_)) => return Ok(()),
    };
    let counts = (term.linear.len(), term.shape.len());
    let is_of = |form: &Form| form.name == term.form && (form.linear.len(), form.shape.len()) == counts;
    if forms.iter().any(is_of) {
        Ok(())
    } else {
        fault("has a form or a number of values that the effect does not have")
    }
}

/// Whether the fitted run could not show the effect: all its parameters are zero, with empty intervals.
fn is_hidden(fit: &Fit, id: &str) -> bool {
    let mut parameters = fit.parameters.iter().filter(|p| p.effect == id).peekable();
    parameters.peek().is_some()
        && parameters.all(|p| p.state == ParameterState::Unidentified && p.value == 0.0 && p.ci95 == [0.0, 0.0])
}

fn check_term(term: &Term, effect: &dyn Effect, user_effect: Option<&UserEffect>) -> Result<(), String> {
    let forms: Vec<Form> = match user_effect {
        Some(user_effect) => vec![user_effect.form(&View::default())],
        None => forms(effect, term.linear.len()),
    };
    let named: Vec<&Form> = forms.iter().filter(|form| form.name == term.form).collect();
    if named.is_empty() {
        let mut known: Vec<String> = forms.iter().map(|form| form.name.to_owned()).collect();
        known.dedup();
        return Err(format!("has the form {}: expected is {}", term.form, list(&known)));
    }
    let counts = |form: &Form| (form.linear.len(), form.shape.len());
    let is_of = |form: &&&Form| counts(form) == (term.linear.len(), term.shape.len()) && names(form) == term.names;
    let Some(form) = named.iter().find(is_of) else {
        let (coefficients, shape) = counts(named[0]);
        return Err(format!(
            "has {} factors, {} shape values and the names {} in the form {}: expected are {coefficients} and {shape}, {}",
            term.linear.len(),
            term.shape.len(),
            list(&term.names),
            term.form,
            list(&names(named[0]))
        ));
    };
    let values = || term.linear.iter().chain(&term.shape).zip(&term.names);
    if let Some((_, name)) = values().find(|(value, _)| !value.is_finite()) {
        return Err(format!("has a {name} that is not finite"));
    }
    for (shape, value) in form.shape.iter().zip(&term.shape) {
        let (min, max) = effect.info().bounds(shape.name);
        // A value at a bound is rounded there. Zero has no logarithm.
        let rounding = 1e-9 * value.abs();
        let is_within = value + rounding >= min && value - rounding <= max;
        let is_possible = is_within && (user_effect.is_some() || shape.search == ShapeSearch::Signed || *value > 0.0);
        if !is_possible {
            return Err(format!("has {} = {value}: expected is {} to {max}", shape.name, min.max(0.0)));
        }
    }
    Ok(())
}

/// Names of the coefficients, then of the nonlinear parameters.
fn names<'e>(form: &Form<'e>) -> Vec<&'e str> {
    form.linear.iter().copied().chain(form.shape.iter().map(|s| s.name)).collect()
}

/// Every form of a library effect, with as many coefficients as `coefficients` if their number depends on the run.
fn forms(effect: &dyn Effect, coefficients: usize) -> Vec<Form<'_>> {
    let mut forms = effect.forms(&shown(coefficients + 1));
    let longer = forms.iter().flat_map(|form| {
        let next = |form: &Form<'static>| effect.extended(form).map(|(_, longer)| longer);
        std::iter::successors(effect.extended(form).map(|(_, longer)| longer), next).collect::<Vec<_>>()
    });
    let longer: Vec<Form> = longer.collect();
    forms.extend(longer);
    forms
}

/// Signals in which every effect is visible: steady state, several turns, slow and fast motion.
fn shown(repeats: usize) -> View {
    const ROWS: usize = 2048;
    let rows = ROWS.max(repeats);
    let wave = |waves: f64, phase: f64| {
        (0..rows).map(|i| (TAU * waves * i as f64 / ROWS as f64 + phase).sin()).collect::<Vec<f64>>()
    };
    let mut signals = Signals::new(rows);
    for (place, signal) in Signal::ALL.into_iter().enumerate() {
        let values = match signal {
            Signal::Time => (0..rows).map(|i| i as f64).collect(),
            Signal::Repeat => (0..rows).map(|i| (i * repeats / rows) as f64).collect(),
            Signal::Position => wave(1.0, 0.0).iter().map(|x| 7.0 * x).collect(),
            Signal::Link => wave(1.0, 0.2).iter().map(|x| 6.5 * x).collect(),
            Signal::Velocity => wave(1.0, TAU / 4.0),
            Signal::Direction => wave(1.0, TAU / 4.0).iter().map(|x| x.signum()).collect(),
            _ => wave(1.0 + place as f64, 0.1),
        };
        signals.set(signal, values);
    }
    let mut view = View::new(signals.clone(), signals, (0..rows).map(|i| i..i + 1).collect(), vec![0], 1.0);
    view.constants.weight = Some([1.0, 1.0]);
    view
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::effects;
    use jointbench_instrument::Kind;

    #[test]
    fn every_effect_of_the_library_shows() {
        for effect in Kind::ALL.into_iter().flat_map(effects).filter(|e| !e.traits().is_offset) {
            let info = effect.info();
            let forms = forms(*effect, 3);
            assert!(!forms.is_empty(), "{}", info.id);
            for shape in forms.iter().flat_map(|f| &f.shape) {
                let (min, max) = info.bounds(shape.name);
                assert!(min < max && shape.min >= min, "{} {}", info.id, shape.name);
            }
        }
        let names = |kind: Kind, id: &str| {
            let forms = forms(crate::effects::find(kind, id).unwrap(), 3);
            forms.iter().map(|f| format!("{} {}", f.name, f.linear.len())).collect::<Vec<_>>()
        };
        assert_eq!(names(Kind::Friction, "presliding"), ["dahl 1", "stop 1", "maxwell_slip 1", "lugre 1"]);
        assert_eq!(names(Kind::Friction, "cogging").last().unwrap(), "harmonics 16");
        assert_eq!(names(Kind::Encoder, "startup_offset"), ["linear 3"]);
        assert_eq!(names(Kind::Stiffness, "torsional_hysteresis").len(), 9);
        assert_eq!(names(Kind::Brake, "hysteresis").len(), 5);
    }
}
