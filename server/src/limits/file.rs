//! A file with the limits of parts and revisions.

use super::requirement::Requirement;
use crate::view::Unit;
use jointbench_procedure::procedure;
use serde::Deserialize;
use toml::Spanned;

/// The file is kept with each run.
const LONGEST_FILE: usize = 64 << 10;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Content {
    #[serde(default)]
    limit: Vec<Spanned<Limit>>,
}

/// Limits of a quantity. Without part, revision or procedure it is valid for all of them.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Limit {
    part: Option<String>,
    revision: Option<String>,
    procedure: Option<String>,
    quantity: String,
    lower: Option<f64>,
    upper: Option<f64>,
    #[serde(default)]
    unit: String,
    #[serde(default)]
    guard_band: f64,
}

/// What is measured.
pub struct Measured<'a> {
    pub part: Option<&'a str>,
    pub revision: Option<&'a str>,
    pub procedure: &'a str,
}

impl<'a> Measured<'a> {
    pub fn new(unit: Option<&'a Unit>, procedure: &'a str) -> Self {
        let part = unit.and_then(|unit| unit.part.as_deref());
        let revision = unit.and_then(|unit| unit.revision.as_deref());
        Self { part, revision, procedure }
    }

    /// For a line of text: `friction of part P, revision B`.
    fn line(&self) -> String {
        let of = |what: &str, text: Option<&str>| text.map(|text| format!("{what} {text}"));
        let unit: Vec<String> = of("part", self.part).into_iter().chain(of("revision", self.revision)).collect();
        if unit.is_empty() {
            format!("{} without a part", self.procedure)
        } else {
            format!("{} of {}", self.procedure, unit.join(", "))
        }
    }
}

impl Limit {
    /// The number of properties that it names, if all of them apply.
    fn specificity(&self, measured: &Measured) -> Option<usize> {
        let named = [
            (&self.part, measured.part),
            (&self.revision, measured.revision),
            (&self.procedure, Some(measured.procedure)),
        ];
        let named: Vec<_> = named.into_iter().filter_map(|(own, there)| Some((own.as_deref()?, there))).collect();
        named.iter().all(|(own, there)| Some(*own) == *there).then_some(named.len())
    }

    fn fault(&self) -> Option<String> {
        let Self { quantity, lower, upper, guard_band, .. } = self;
        let is_bad = |value: &Option<f64>| value.is_some_and(|value| !value.is_finite());
        if is_bad(lower) || is_bad(upper) {
            return Some(format!("{quantity}: a limit has to be a finite number"));
        }
        if !(guard_band.is_finite() && *guard_band >= 0.0) {
            return Some(format!("{quantity}: guard_band = {guard_band}: expected 0 or more"));
        }
        match (lower, upper) {
            (None, None) => Some(format!("{quantity}: give lower, upper or both")),
            (Some(lower), Some(upper)) if lower + guard_band >= upper - guard_band => {
                Some(format!("{quantity}: lower {lower} and upper {upper} leave no value between their guard bands"))
            }
            _ => None,
        }
    }

    fn requirement(&self) -> Requirement {
        let Self { quantity, lower, upper, unit, guard_band, .. } = self;
        let range = match (lower, upper) {
            (Some(lower), Some(upper)) => format!("{quantity} {lower} … {upper} {unit}"),
            (Some(lower), None) => format!("{quantity} > {lower} {unit}"),
            (None, upper) => format!("{quantity} < {} {unit}", upper.unwrap_or(f64::INFINITY)),
        };
        let guard = if *guard_band > 0.0 { format!(", guard band {guard_band} {unit}") } else { String::new() };
        Requirement {
            text: format!("{}{}", range.trim_end(), guard.trim_end()),
            name: quantity.clone(),
            lower: *lower,
            upper: *upper,
            guard_band: *guard_band,
            unit: unit.clone(),
            needs_interval: true,
        }
    }
}

/// The limits of a file that apply, or its fault with the line. For each quantity the entry that names most of part,
/// revision and procedure applies.
pub fn applicable(text: &str, measured: &Measured) -> Result<Vec<Requirement>, String> {
    let file: Content = toml::from_str(text).map_err(|fault| fault.to_string())?;
    let line = |limit: &Spanned<Limit>| text[..limit.span().start].matches('\n').count() + 1;
    if let Some((limit, fault)) = file.limit.iter().find_map(|limit| Some((limit, limit.get_ref().fault()?))) {
        return Err(format!("line {}: {fault}", line(limit)));
    }
    let mut chosen: Vec<(&Spanned<Limit>, usize)> = Vec::new();
    for limit in &file.limit {
        let Some(specificity) = limit.get_ref().specificity(measured) else { continue };
        let same = chosen.iter_mut().find(|(other, _)| other.get_ref().quantity == limit.get_ref().quantity);
        match same {
            Some((other, least)) if *least == specificity => {
                let (first, second, quantity) = (line(other), line(limit), &limit.get_ref().quantity);
                return Err(format!(
                    "lines {first} and {second} both limit {quantity} of {}: keep one",
                    measured.line()
                ));
            }
            Some(kept) if kept.1 < specificity => *kept = (limit, specificity),
            Some(_) => {}
            None => chosen.push((limit, specificity)),
        }
    }
    match chosen.is_empty() {
        true => Err(format!("no limit applies to {}: add a [[limit]] with its quantity", measured.line())),
        false => Ok(chosen.iter().map(|(limit, _)| limit.get_ref().requirement()).collect()),
    }
}

/// Checks before a run that its procedure can meet the limits of a file.
pub fn checked(text: &str, measured: &Measured) -> Result<(), String> {
    if text.len() > LONGEST_FILE {
        return Err(format!("the file has {} bytes, at most {LONGEST_FILE} are allowed", text.len()));
    }
    let limits = applicable(text, measured)?;
    let Some(procedure) = procedure(measured.procedure) else { return Ok(()) };
    let finds = procedure.finds();
    limits.iter().try_for_each(|limit| {
        limit.can_be_met_by(measured.procedure, &finds).map_err(|why| format!("'{}': {why}", limit.text))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "\
[[limit]]
quantity = \"tau_c\"
upper = 0.04
unit = \"Nm\"

[[limit]]
part = \"JA\"
revision = \"B\"
quantity = \"tau_c\"
lower = 0.02
upper = 0.035
unit = \"Nm\"
guard_band = 0.001

[[limit]]
part = \"JB\"
quantity = \"c_v\"
upper = 1e-3
unit = \"Nm·s/rad\"
";

    fn of<'a>(part: Option<&'a str>, revision: Option<&'a str>) -> Measured<'a> {
        Measured { part, revision, procedure: "friction" }
    }

    #[test]
    fn the_most_specific_entry_of_a_quantity_applies() {
        let texts = |measured: &Measured| -> Vec<String> {
            applicable(FILE, measured).unwrap().into_iter().map(|requirement| requirement.text).collect()
        };
        assert_eq!(texts(&of(None, None)), ["tau_c < 0.04 Nm"]);
        assert_eq!(texts(&of(Some("JA"), Some("B"))), ["tau_c 0.02 … 0.035 Nm, guard band 0.001 Nm"]);
        assert_eq!(texts(&of(Some("JB"), None)), ["tau_c < 0.04 Nm", "c_v < 0.001 Nm·s/rad"]);
    }

    #[test]
    fn a_fault_names_its_line_and_the_cure() {
        let fault = |text: &str| applicable(text, &of(Some("JA"), None)).unwrap_err();
        assert!(fault("[[limit]]\nquantity = 1\n").contains("line 2"), "{}", fault("[[limit]]\nquantity = 1\n"));
        assert!(fault("[[limit]]\nquantity = \"x\"\nlow = 1\n").contains("unknown field `low`"));
        let twice = "[[limit]]\nquantity = \"x\"\nupper = 1\n\n[[limit]]\nquantity = \"x\"\nupper = 2\n";
        assert_eq!(fault(twice), "lines 1 and 5 both limit x of friction of part JA: keep one");
        assert_eq!(fault("[[limit]]\nquantity = \"x\"\n"), "line 1: x: give lower, upper or both");
        assert_eq!(fault(""), "no limit applies to friction of part JA: add a [[limit]] with its quantity");
    }
}
