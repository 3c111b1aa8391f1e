//! The query language of the list of runs.
//!
//! Terms are separated by blanks, and all must match. A word matches in bench, procedure, kind, state, reason, unit,
//! part, batch, operator, tags and notes. `key:value` matches one field; a prefix is enough if no run has the exact
//! value. `rows>1000` and `duration>2min` compare. `-` before a term negates it; `"two words"` are one term.

use super::StoreError;
use jointbench_instrument::Kind;
use jointbench_instrument::spelling::instead;
use jointbench_procedure::{RunState, Safe};
use sqlx::{QueryBuilder, Sqlite};

/// Fields with their column; a prefix of the value is enough.
const FIELDS: [(&str, &str); 11] = [
    ("bench", "bench"),
    ("procedure", "procedure"),
    ("kind", "kind"),
    ("state", "state"),
    ("safe", "safe"),
    ("unit", "serial"),
    ("part", "part"),
    ("batch", "batch"),
    ("operator", "operator"),
    ("verdict", "(SELECT verdict FROM verdicts WHERE run = runs_told.id)"),
    ("limits", "(SELECT limits FROM verdicts WHERE run = runs_told.id)"),
];
/// Numeric fields with their column.
const NUMBERS: [(&str, &str); 3] = [("id", "id"), ("rows", "rows"), ("duration", "duration_s")];
const KEYS: &str = "bench: procedure: kind: state: safe: unit: part: batch: operator: verdict: limits: tag: note: simulated:yes \
    after:2026-01-31 before: id> rows> duration>2min";
/// Units of a duration in seconds; the default is seconds.
const DURATIONS: [(&str, f64); 4] = [("min", 60.0), ("h", 3600.0), ("m", 60.0), ("s", 1.0)];

#[derive(Debug, Clone, PartialEq)]
enum Condition {
    Word(String),
    Field(&'static str, String),
    Tag(String),
    Note(String),
    Simulated(bool),
    /// Column, SQL operator and value.
    Number(&'static str, &'static str, f64),
    Day(&'static str, String),
}

/// Conditions of a search, each with a negation flag.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Search(Vec<(bool, Condition)>);

impl Search {
    pub fn parse(text: &str) -> Result<Self, StoreError> {
        Ok(Self(terms(text).iter().map(|term| read(term)).collect::<Result<_, _>>()?))
    }

    /// The valid part of a search, and the error of the first invalid term.
    pub fn understood(text: &str) -> (String, Option<StoreError>) {
        let (mut kept, mut refused) = (Vec::new(), None);
        for term in terms(text) {
            match read(&term) {
                Ok(_) => kept.push(format!("\"{term}\"")),
                Err(fault) => refused = refused.or(Some(fault)),
            }
        }
        (kept.join(" "), refused)
    }

    /// A search without its last word if that word is the beginning of a key, and a message with the keys.
    pub fn before_key(text: &str) -> Option<(String, StoreError)> {
        let mut terms = terms(text);
        let term = terms.pop()?;
        let begins = term.trim_start_matches('-');
        let key = KEYS.split(' ').find(|key| !begins.is_empty() && key.starts_with(begins))?;
        let what = format!("no run has that word; {key} may follow");
        Some((
            terms.iter().map(|term| format!("\"{term}\"")).collect::<Vec<_>>().join(" "),
            StoreError::Search { term, what },
        ))
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// ` WHERE …`, with every value bound.
    pub fn push(&self, query: &mut QueryBuilder<Sqlite>) {
        for (i, (without, condition)) in self.0.iter().enumerate() {
            query.push(if i == 0 { " WHERE " } else { " AND " });
            query.push(if *without { "NOT COALESCE((" } else { "COALESCE((" });
            condition.push(query);
            query.push("), 0)");
        }
    }
}

impl Condition {
    fn push(&self, query: &mut QueryBuilder<Sqlite>) {
        match self {
            Condition::Word(word) => {
                query.push("instr(words, ").push_bind(word.clone());
                query.push(") > 0 OR EXISTS (SELECT 1 FROM tags WHERE run = runs_told.id AND instr(lower(tag), ");
                query.push_bind(word.clone()).push(") > 0) OR ");
                push_note(query, word);
            }
            Condition::Field(column, value) => {
                let column = format!("lower({column})");
                query.push("CASE WHEN EXISTS (SELECT 1 FROM runs_told WHERE ").push(&column).push(" = ");
                query.push_bind(value.clone()).push(") THEN ").push(&column).push(" = ").push_bind(value.clone());
                query.push(" ELSE instr(").push(&column).push(", ").push_bind(value.clone()).push(") = 1 END");
            }
            Condition::Tag(tag) => {
                query.push("EXISTS (SELECT 1 FROM tags WHERE run = runs_told.id AND lower(tag) = ");
                query.push_bind(tag.clone()).push(")");
            }
            Condition::Note(word) => push_note(query, word),
            Condition::Simulated(yes) => {
                query.push("simulated = ").push_bind(*yes);
            }
            Condition::Number(column, operator, value) => {
                query.push(*column).push(*operator).push_bind(*value);
            }
            // The text order of stored times is their time order.
            Condition::Day(operator, day) => {
                query.push("created_at").push(*operator).push_bind(day.clone());
            }
        }
    }
}

fn push_note(query: &mut QueryBuilder<Sqlite>, word: &str) {
    query.push("EXISTS (SELECT 1 FROM notes WHERE run = runs_told.id AND instr(lower(text), ");
    query.push_bind(word.to_owned()).push(") > 0)");
}

/// A condition with its negation flag.
fn read(term: &str) -> Result<(bool, Condition), StoreError> {
    let (without, rest) = match term.strip_prefix('-') {
        Some(rest) if !rest.is_empty() => (true, rest),
        _ => (false, term),
    };
    Ok((without, condition(rest)?))
}

fn condition(term: &str) -> Result<Condition, StoreError> {
    let refuse = |what: String| StoreError::Search { term: term.to_owned(), what };
    for (name, column) in NUMBERS {
        let Some(rest) = term.strip_prefix(name) else { continue };
        let operators = [(">=", " >= "), ("<=", " <= "), (">", " > "), ("<", " < "), ("=", " = "), (":", " = ")];
        if let Some((value, operator)) = operators.iter().find_map(|(sign, sql)| Some((rest.strip_prefix(sign)?, *sql)))
        {
            let units = DURATIONS.iter().filter(|_| name == "duration");
            let with_unit = units.filter_map(|(unit, s)| Some((value.strip_suffix(unit)?.trim_end(), *s))).next();
            let (figure, factor) = with_unit.unwrap_or((value, 1.0));
            let number = figure.parse::<f64>().ok().map(|number| number * factor).filter(|number| number.is_finite());
            let number = number.ok_or_else(|| refuse(format!("{value:?} is no number")))?;
            return Ok(Condition::Number(column, operator, number));
        }
    }
    if let Some((key, _)) = term.split_once(['<', '>']).filter(|(_, value)| value.parse::<f64>().is_ok()) {
        return Err(refuse(format!("{key} cannot be compared; there are {KEYS}")));
    }
    let Some((key, value)) = term.split_once(':') else { return Ok(Condition::Word(term.to_owned())) };
    if let Some((_, column)) = FIELDS.iter().find(|(name, _)| *name == key) {
        // The dashboard uses `done` for this state.
        let value = if (key, value) == ("state", "done") { "completed" } else { value };
        let known = match key {
            "kind" => Kind::ALL.map(Kind::name).to_vec(),
            "state" => RunState::ALL.map(RunState::name).to_vec(),
            "safe" => Safe::ALL.map(Safe::name).to_vec(),
            _ => Vec::new(),
        };
        if !known.is_empty() && !known.iter().any(|name| name.starts_with(value)) {
            return Err(refuse(format!("unknown value {value}: {}", instead(value, &known))));
        }
        return Ok(Condition::Field(column, value.to_owned()));
    }
    match (key, value) {
        (_, "") => Err(refuse("a value is missing behind the colon".to_owned())),
        ("tag", tag) => Ok(Condition::Tag(tag.to_owned())),
        ("note", word) => Ok(Condition::Note(word.to_owned())),
        ("simulated", "yes") => Ok(Condition::Simulated(true)),
        ("simulated", "no") => Ok(Condition::Simulated(false)),
        ("simulated", _) => Err(refuse("write simulated:yes or simulated:no".to_owned())),
        ("after" | "before", day) => {
            let day: jiff::civil::Date = day.parse().map_err(|_| refuse("write the day as 2026-01-31".to_owned()))?;
            Ok(Condition::Day(if key == "after" { " >= " } else { " < " }, day.to_string()))
        }
        _ => Err(refuse(format!("there is no field {key}; there are {KEYS}"))),
    }
}

/// Splits at blanks outside quotation marks, in lower case.
fn terms(text: &str) -> Vec<String> {
    let (mut terms, mut term, mut quoted) = (Vec::new(), String::new(), false);
    for c in text.to_lowercase().chars() {
        match c {
            '"' => quoted = !quoted,
            c if c.is_whitespace() && !quoted => terms.push(std::mem::take(&mut term)),
            c => term.push(c),
        }
    }
    terms.push(term);
    terms.retain(|term| !term.is_empty());
    terms
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_split_outside_quotation_marks() {
        assert_eq!(
            terms("  kind:Friction \"warm oil\" note:\"two words\""),
            ["kind:friction", "warm oil", "note:two words"]
        );
    }

    #[test]
    fn an_incomplete_term_is_ignored_and_reported() {
        let (understood, refused) = Search::understood("oil rows> \"note:two words\" colour:r");
        assert_eq!(understood, "\"oil\" \"note:two words\"");
        assert!(refused.unwrap().to_string().contains("rows>"));
        assert_eq!(Search::parse(&understood).unwrap(), Search::parse("oil note:\"two words\"").unwrap());
        assert!(Search::understood("state: procedure: state:comp").1.is_none());
    }

    #[test]
    fn a_word_that_may_become_a_key_can_be_left_out() {
        let (before, message) = Search::before_key("\"note:two words\" -pro").unwrap();
        assert_eq!(before, "\"note:two words\"");
        assert!(message.to_string().contains("procedure: may follow"), "{message}");
        assert!(Search::before_key("oil tag:x").is_none() && Search::before_key("").is_none());
    }

    #[test]
    fn a_wrong_term_is_named_with_what_there_is() {
        for (text, expected) in [
            ("colour:red", "there is no field colour; there are bench:"),
            ("temp<30", "temp cannot be compared; there are bench:"),
            ("rows>many", "\"many\" is no number"),
            ("tag:", "a value is missing"),
            ("after:tomorrow", "2026-01-31"),
            ("state:bogus", "unknown value bogus: there are queued, arming"),
            ("state:compelted", "did you mean completed?"),
            ("kind:motor", "there are friction"),
            ("-safe:yes", "there are safe_verified"),
            ("simulated:perhaps", "simulated:yes or simulated:no"),
        ] {
            let refused = Search::parse(text).unwrap_err().to_string();
            assert!(refused.contains(expected), "{refused}");
        }
    }
}
