//! Parser of formulas to a tree of names and operators with their positions, based on winnow's Pratt parser.

use crate::formula::fault::Mistake;
use std::ops::Range;
use winnow::ascii::{digit1, multispace0};
use winnow::combinator::{
    Infix, Prefix, alt, cut_err, delimited, expression, fail, not, opt, preceded, separated, terminated,
};
use winnow::error::{ContextError, ErrMode, StrContext, StrContextValue};
use winnow::stream::LocatingSlice;
use winnow::token::take_while;
use winnow::{ModalResult, Parser};

/// Longest allowed formula. A limited length also limits the nesting.
const LONGEST: usize = 400;

pub(crate) type Input<'i> = LocatingSlice<&'i str>;

#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Bytes of the text.
    pub at: Range<usize>,
    pub what: Syntax,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Syntax {
    Number(f64),
    Name(String),
    Negate(Box<Node>),
    Binary(Operator, Box<Node>, Box<Node>),
    Call(String, Vec<Node>),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
}

/// `left = expression`: the left-hand side with its position, and the tree of the right-hand side.
pub fn equation(text: &str) -> Result<((String, Range<usize>), Node), Mistake> {
    check_length(text)?;
    let left = preceded(multispace0, name.with_span().context(expected("the left-hand side, such as tau")));
    let equals = preceded(multispace0, '=').context(expected("= after the left-hand side"));
    whole((terminated(left, equals), tree), text, "an operator or the end was expected")
}

/// The right-hand side only.
pub fn right_hand_side(text: &str) -> Result<Node, Mistake> {
    check_length(text)?;
    tree_of(text)
}

fn check_length(text: &str) -> Result<(), Mistake> {
    match text.len() > LONGEST {
        true => Err(Mistake::new(LONGEST..text.len(), format!("a formula has at most {LONGEST} characters"))),
        false => Ok(()),
    }
}

/// An expression only, such as a unit.
pub fn tree_of(text: &str) -> Result<Node, Mistake> {
    whole(tree, text, "an operator or the end was expected")
}

/// Parses a whole text, or reports where it ends to be valid. `otherwise` is what could have followed the valid part.
pub(crate) fn whole<'i, O>(
    mut parser: impl Parser<Input<'i>, O, ErrMode<ContextError>>,
    text: &'i str,
    otherwise: &str,
) -> Result<O, Mistake> {
    terminated(parser.by_ref(), multispace0).parse(LocatingSlice::new(text)).map_err(|error| {
        let at = error.offset();
        let found = match text[at..].chars().next() {
            Some(c) => format!("{c:?} stands here"),
            None => "the text ends here".to_owned(),
        };
        let wanted: Vec<String> = error.inner().context().map(ToString::to_string).collect();
        let wanted = wanted.first().map_or(otherwise, String::as_str);
        let length = text[at..].chars().next().map_or(0, char::len_utf8);
        Mistake::new(at..at + length, format!("{found}, {wanted}"))
    })
}

pub(crate) fn expected(what: &'static str) -> StrContext {
    StrContext::Expected(StrContextValue::Description(what))
}

/// A letter, then letters, digits and underscores.
pub(crate) fn name(input: &mut Input<'_>) -> ModalResult<String> {
    (take_while(1, |c: char| c.is_alphabetic()), take_while(0.., |c: char| c.is_alphanumeric() || c == '_'))
        .take()
        .map(str::to_owned)
        .parse_next(input)
}

/// Digits with an optional fraction and exponent.
pub(crate) fn number(input: &mut Input<'_>) -> ModalResult<f64> {
    let exponent = (alt(('e', 'E')), opt(alt(('+', '-'))), digit1);
    // Two dots are a range.
    let fraction = ('.', not('.'), opt(digit1));
    (alt(((digit1, opt(fraction)).void(), ('.', digit1).void())), opt(exponent)).take().parse_to().parse_next(input)
}

const OPERAND: &str = "a number, a signal, a parameter, a function or a bracket";

fn tree(input: &mut Input<'_>) -> ModalResult<Node> {
    expression(preceded(multispace0, operand))
        .prefix(preceded(multispace0, alt(('-'.value(Prefix(30, negate as _)), fail))).context(expected(OPERAND)))
        .infix(preceded(
            multispace0,
            alt((
                alt(("**", "^")).value(Infix::Right(40, power as _)),
                '*'.value(Infix::Left(20, multiply as _)),
                '/'.value(Infix::Left(20, divide as _)),
                '+'.value(Infix::Left(10, add as _)),
                '-'.value(Infix::Left(10, subtract as _)),
            )),
        ))
        .parse_next(input)
}

fn operand(input: &mut Input<'_>) -> ModalResult<Node> {
    let bracket =
        delimited('(', cut_err(tree), cut_err(preceded(multispace0, ')')).context(expected("a closing bracket")));
    alt((bracket, number.map(Syntax::Number).with_span().map(node), named)).parse_next(input)
}

/// A name, or a function with its arguments.
fn named(input: &mut Input<'_>) -> ModalResult<Node> {
    let ((name, at), opened) = (name.with_span(), opt(preceded(multispace0, '('))).parse_next(input)?;
    if opened.is_none() {
        return Ok(node((Syntax::Name(name), at)));
    }
    let arguments = separated(1.., cut_err(tree), preceded(multispace0, ','));
    let close = preceded(multispace0, ')').context(expected("a comma or a closing bracket"));
    let (arguments, end) = cut_err((arguments, close.span())).parse_next(input)?;
    Ok(node((Syntax::Call(name, arguments), at.start..end.end)))
}

fn node((what, at): (Syntax, Range<usize>)) -> Node {
    Node { at, what }
}

fn binary(operator: Operator, a: Node, b: Node) -> ModalResult<Node> {
    Ok(Node { at: a.at.start..b.at.end, what: Syntax::Binary(operator, a.into(), b.into()) })
}

fn negate(_: &mut Input<'_>, a: Node) -> ModalResult<Node> {
    Ok(Node { at: a.at.clone(), what: Syntax::Negate(a.into()) })
}

fn add(_: &mut Input<'_>, a: Node, b: Node) -> ModalResult<Node> {
    binary(Operator::Add, a, b)
}

fn subtract(_: &mut Input<'_>, a: Node, b: Node) -> ModalResult<Node> {
    binary(Operator::Subtract, a, b)
}

fn multiply(_: &mut Input<'_>, a: Node, b: Node) -> ModalResult<Node> {
    binary(Operator::Multiply, a, b)
}

fn divide(_: &mut Input<'_>, a: Node, b: Node) -> ModalResult<Node> {
    binary(Operator::Divide, a, b)
}

fn power(_: &mut Input<'_>, a: Node, b: Node) -> ModalResult<Node> {
    binary(Operator::Power, a, b)
}
