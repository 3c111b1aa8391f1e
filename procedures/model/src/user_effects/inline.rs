//! The short form: `rub: tau = a * tanh(velocity / w0); a [Nm] 0..1; w0 [rad/s] 0.1..10 start 1..5`.

use crate::formula::fault::{FormulaFault, Mistake};
use crate::formula::syntax::{Input, expected, name, number, whole};
use crate::user_effects::UserEffect;
use crate::user_effects::definition::{Definition, UserParameter};
use jointbench_instrument::Kind;
use std::ops::Range;
use winnow::ascii::multispace0;
use winnow::combinator::{alt, cut_err, delimited, opt, preceded, repeat, separated_pair, terminated};
use winnow::token::take_while;
use winnow::{ModalResult, Parser};

/// What may follow a complete parameter.
const NEXT: &str =
    "a unit in square brackets, a range such as 0..1, start 0.2..0.5, whole, a semicolon or the end was expected";

pub fn read(kind: Kind, text: &str) -> Result<UserEffect, FormulaFault> {
    let at_text = |mistake: Mistake| mistake.found(text.split(':').next().unwrap_or_default().trim(), "inline", text);
    let parts = (head, take_while(1.., |c| c != ';').with_span(), repeat(0.., preceded(';', cut_err(parameter))));
    let ((id, id_at), (formula, formula_at), parameters): (_, _, Vec<_>) = whole(parts, text, NEXT).map_err(at_text)?;
    let (parameters, places): (Vec<UserParameter>, Vec<Range<usize>>) = parameters.into_iter().unzip();
    let names: Vec<String> = parameters.iter().map(|p| p.name.clone()).collect();
    let definition =
        Definition { id, kind, formula: formula.to_owned(), parameters, title: String::new(), sentence: String::new() };
    UserEffect::try_from(definition).map_err(|fault| {
        // The last of several equal names is the error.
        let parameter = || names.iter().rposition(|n| *n == fault.text).map_or(0, |p| places[p].start);
        let start = match fault.field {
            "formula" => formula_at.start,
            "id" => id_at.start,
            _ => parameter(),
        };
        let characters = text[..start].chars().count();
        FormulaFault { field: "inline", ..fault }.within(text, characters)
    })
}

fn head(input: &mut Input<'_>) -> ModalResult<(String, Range<usize>)> {
    let id = preceded(multispace0, name.with_span()).context(expected("the id of the effect"));
    let colon = preceded(multispace0, ':').context(expected("a colon after the id"));
    terminated(id, (colon, multispace0)).parse_next(input)
}

/// `name [unit] min..max start low..high whole`, all but the name optional.
fn parameter(input: &mut Input<'_>) -> ModalResult<(UserParameter, Range<usize>)> {
    let unit = delimited('[', take_while(1.., |c| c != ']' && c != ';'), ']');
    let (name, at) =
        preceded(multispace0, name.with_span()).context(expected("the name of a parameter")).parse_next(input)?;
    let unit = opt(preceded(multispace0, unit)).parse_next(input)?;
    let bounds = opt(preceded(multispace0, range)).parse_next(input)?;
    let start = opt(preceded((multispace0, "start", multispace0), limits)).parse_next(input)?;
    let whole = opt(preceded(multispace0, "whole")).parse_next(input)?.is_some();
    multispace0.parse_next(input)?;
    let (min, max) = bounds.unwrap_or_default();
    let unit = unit.map_or("1", str::trim).to_owned();
    Ok((UserParameter { name, unit, min, max, start: start.map(Into::into), whole }, at))
}

/// `0..1`, `0..` or `..1`.
fn range(input: &mut Input<'_>) -> ModalResult<(Option<f64>, Option<f64>)> {
    alt((separated_pair(bound.map(Some), "..", opt(bound)), separated_pair(opt(bound), "..", bound.map(Some))))
        .parse_next(input)
}

fn limits(input: &mut Input<'_>) -> ModalResult<(f64, f64)> {
    separated_pair(bound, "..", bound).parse_next(input)
}

fn bound(input: &mut Input<'_>) -> ModalResult<f64> {
    (opt(alt(('-', '+'))), number).map(|(sign, value)| if sign == Some('-') { -value } else { value }).parse_next(input)
}
