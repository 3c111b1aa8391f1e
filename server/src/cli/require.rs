//! Requirements of a script on a result: `tau_c < 0.035 Nm`.

use crate::view::{Identification, Quantity};
use jointbench_instrument::spelling::nearest;
use jointbench_procedure::catalogue::Findable;
use std::str::FromStr;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Below,
    Above,
}

/// A limit on one quantity of an identification.
#[derive(Debug, Clone, PartialEq)]
pub struct Requirement {
    text: String,
    name: String,
    side: Side,
    limit: f64,
    unit: String,
}

/// Result of a requirement.
#[derive(Debug, Clone, PartialEq)]
pub enum RequirementResult {
    Yes(String),
    /// The value exceeds the limit.
    No(String),
    /// The value is within the limit, but its interval is not.
    Unsure(String),
    /// The quantity is missing, or has another unit.
    Unknown(String),
}

impl FromStr for Requirement {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("{text:?}: expected NAME < VALUE UNIT or NAME > VALUE UNIT, such as 'tau_c < 0.035 Nm'");
        let place = text.find(['<', '>']).ok_or_else(wrong)?;
        let side = if text[place..].starts_with('<') { Side::Below } else { Side::Above };
        let rest = text[place + 1..].trim_start_matches('=').trim();
        let (value, unit) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
        let limit = value.parse::<f64>().ok().filter(|limit| limit.is_finite()).ok_or_else(wrong)?;
        let name = text[..place].trim();
        if name.is_empty() {
            return Err(wrong());
        }
        let (text, name, unit) = (text.trim().to_owned(), name.to_owned(), unit.trim().to_owned());
        Ok(Self { text, name, side, limit, unit })
    }
}

impl Requirement {
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether a procedure with these results can meet the requirement, or why not.
    pub fn can_be_met_by(&self, procedure: &str, finds: &[Findable]) -> Result<(), String> {
        match finds.iter().find(|findable| findable.is(&self.name)) {
            Some(findable) => factor(&self.unit, findable.unit).map(drop).ok_or_else(|| self.in_unit(findable.unit)),
            None => {
                let names: Vec<&str> = finds.iter().map(|findable| findable.name.as_str()).collect();
                Err(format!("{procedure} does not determine {}; {}", self.name, self.instead(&names)))
            }
        }
    }

    /// Suggests existing quantities.
    fn instead(&self, names: &[&str]) -> String {
        let meant = nearest(&self.name, names.iter().copied());
        let meant = meant.map(|near| format!("did you mean {near}? ")).unwrap_or_default();
        format!("{meant}available: {}", names.join(", "))
    }

    fn in_unit(&self, unit: &str) -> String {
        let unit = if unit.is_empty() { "no unit" } else { unit };
        format!("{} is in {unit}: write the limit so", self.name)
    }

    pub fn check(&self, found: &Identification) -> RequirementResult {
        let quantities = &found.result.quantities;
        let Some(quantity) = quantities.iter().find(|quantity| quantity.name == self.name) else {
            let names: Vec<&str> = quantities.iter().map(|quantity| quantity.name.as_str()).collect();
            let there = if names.is_empty() { "it contains no quantities".to_owned() } else { self.instead(&names) };
            return RequirementResult::Unknown(format!(
                "--require '{}': the result does not contain {}; {there}",
                self.text, self.name
            ));
        };
        let Some(factor) = factor(&self.unit, &quantity.unit) else {
            return RequirementResult::Unknown(self.in_unit(&quantity.unit));
        };
        self.judge(quantity, self.limit * factor)
    }

    fn judge(&self, quantity: &Quantity, limit: f64) -> RequirementResult {
        let keeps = |value: f64| match self.side {
            Side::Below => value <= limit,
            Side::Above => value >= limit,
        };
        let (value, interval) = crate::report::with_interval(quantity.value, quantity.ci95, &quantity.unit);
        let message = match &interval {
            Some(ends) => format!("{}: {} = {value} [{ends}]", self.text, self.name),
            None => format!("{}: {} = {value}", self.text, self.name),
        };
        if !keeps(quantity.value) {
            RequirementResult::No(message)
        } else if quantity.ci95.is_some_and(|ends| !ends.into_iter().all(keeps)) {
            RequirementResult::Unsure(format!("{message}: the interval exceeds the limit"))
        } else {
            RequirementResult::Yes(message)
        }
    }
}

/// Factor from the written unit to the unit of the quantity: the same unit, or with a prefix.
fn factor(written: &str, own: &str) -> Option<f64> {
    if written == own || (written.is_empty() && own == "1") {
        return Some(1.0);
    }
    [("k", 1e3), ("m", 1e-3), ("µ", 1e-6), ("u", 1e-6), ("n", 1e-9)]
        .into_iter()
        .find(|(prefix, _)| written.strip_prefix(prefix) == Some(own) && !own.is_empty())
        .map(|(_, factor)| factor)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::view::{Applies, Identified, Shown};

    /// A friction result of 30.6 mNm ± 0.4 mNm.
    pub fn found() -> Identification {
        let quantity = Quantity {
            name: "tau_c".to_owned(),
            symbol: "τ_c".to_owned(),
            title: "Coulomb friction".to_owned(),
            base_title: None,
            configuration: None,
            unit: "Nm".to_owned(),
            value: 0.0306,
            ci95: Some([0.0302, 0.0310]),
        };
        let result = Shown {
            verdict: Identified::Identified,
            summary: String::new(),
            lead: None,
            warnings: Vec::new(),
            advice: None,
            quantities: vec![quantity],
            figures: Vec::new(),
            passes: None,
            parts: Vec::new(),
        };
        let applies = Applies { can: false, what: String::new() };
        let procedure = "friction".to_owned();
        Identification { run: 1, procedure, software: String::new(), result, follow_up: None, applies }
    }

    #[test]
    fn the_whole_interval_must_keep_the_limit() {
        let check = |text: &str| text.parse::<Requirement>().unwrap().check(&found());
        assert!(matches!(check("tau_c < 0.035 Nm"), RequirementResult::Yes(_)));
        assert!(matches!(check("tau_c<=35 mNm"), RequirementResult::Yes(_)));
        assert!(matches!(check("tau_c > 0.02 Nm"), RequirementResult::Yes(_)));
        assert!(matches!(check("tau_c < 0.030 Nm"), RequirementResult::No(_)));
        assert!(
            matches!(check("tau_c < 0.0308 Nm"), RequirementResult::Unsure(message) if message.contains("30.60 mNm [30.20 … 31.00]"))
        );
    }

    #[test]
    fn an_unknown_requirement_has_a_reason() {
        let check = |text: &str| text.parse::<Requirement>().unwrap().check(&found());
        let why = "--require 'tau_x < 1 Nm': the result does not contain tau_x; did you mean tau_c? available: tau_c";
        assert_eq!(check("tau_x < 1 Nm"), RequirementResult::Unknown(why.to_owned()));
        assert_eq!(check("tau_c < 1 A"), RequirementResult::Unknown("tau_c is in Nm: write the limit so".to_owned()));
        assert_eq!(check("tau_c < 1"), RequirementResult::Unknown("tau_c is in Nm: write the limit so".to_owned()));
        for text in ["tau_c", "< 3 Nm", "tau_c < much", "tau_c < NaN Nm"] {
            assert!(text.parse::<Requirement>().unwrap_err().contains("NAME < VALUE UNIT"), "{text}");
        }
    }
}
