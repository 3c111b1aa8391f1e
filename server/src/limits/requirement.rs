//! Limits on the quantities of a result: `tau_c < 0.035 Nm` of a script, or a line of a limits file.

use super::decision::Made;
use crate::view::{LimitDecision, LimitOutcome, LimitResult, Quantity, Shown};
use jointbench_instrument::spelling::nearest;
use jointbench_procedure::catalogue::Findable;
use std::str::FromStr;

/// A limit on one quantity of an identification.
#[derive(Debug, Clone, PartialEq)]
pub struct Requirement {
    pub text: String,
    pub name: String,
    pub lower: Option<f64>,
    pub upper: Option<f64>,
    /// Width by which the interval has to stay inside the limits.
    pub guard_band: f64,
    pub unit: String,
    /// Without an interval the value does not decide.
    pub needs_interval: bool,
}

/// Outcome of a requirement with its figures in a sentence, or why it cannot be checked: the result lacks the quantity or
/// has it in another unit.
pub type Outcome = Result<(LimitOutcome, String), String>;

/// An outcome with its figures in a sentence, and what would decide.
struct Judged {
    outcome: LimitOutcome,
    message: String,
    decision: Option<LimitDecision>,
}

impl FromStr for Requirement {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("{text:?}: expected NAME < VALUE UNIT or NAME > VALUE UNIT, such as 'tau_c < 0.035 Nm'");
        let place = text.find(['<', '>']).ok_or_else(wrong)?;
        let rest = text[place + 1..].trim_start_matches('=').trim();
        let (value, unit) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
        let limit = value.parse::<f64>().ok().filter(|limit| limit.is_finite()).ok_or_else(wrong)?;
        let name = text[..place].trim();
        if name.is_empty() {
            return Err(wrong());
        }
        let (lower, upper) = if text[place..].starts_with('<') { (None, Some(limit)) } else { (Some(limit), None) };
        Ok(Self {
            text: text.trim().to_owned(),
            name: name.to_owned(),
            lower,
            upper,
            guard_band: 0.0,
            unit: unit.trim().to_owned(),
            needs_interval: false,
        })
    }
}

impl Requirement {
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

    /// Lower and upper limit in the unit of the quantity. `None` if its unit is another one.
    pub fn bounds_in(&self, unit: &str) -> Option<[Option<f64>; 2]> {
        let factor = factor(&self.unit, unit)?;
        Some([self.lower, self.upper].map(|limit| limit.map(|limit| limit * factor)))
    }

    /// Compares the result of a run with the limit.
    pub fn outcome(self, made: Made, result: &Shown) -> LimitResult {
        let unchecked = |message| Judged { outcome: LimitOutcome::Inconclusive, message, decision: None };
        let Judged { outcome, message, decision } = self.judged(made, result).unwrap_or_else(unchecked);
        let Self { text, name, lower, upper, guard_band, unit, needs_interval: _ } = self;
        LimitResult { quantity: name, lower, upper, guard_band, unit, text, outcome, message, decision }
    }

    pub fn check(&self, made: Made, result: &Shown) -> Outcome {
        self.judged(made, result).map(|Judged { outcome, message, .. }| (outcome, message))
    }

    fn judged(&self, made: Made, result: &Shown) -> Result<Judged, String> {
        let quantities = &result.quantities;
        let Some(quantity) = quantities.iter().find(|quantity| quantity.name == self.name) else {
            let names: Vec<&str> = quantities.iter().map(|quantity| quantity.name.as_str()).collect();
            let there = if names.is_empty() { "it contains no quantities".to_owned() } else { self.instead(&names) };
            return Err(format!("'{}': the result does not contain {}; {there}", self.text, self.name));
        };
        let factor = factor(&self.unit, &quantity.unit).ok_or_else(|| self.in_unit(&quantity.unit))?;
        let (outcome, decision) = self.judge(quantity, factor, made, result);
        let (value, interval) = crate::report::with_interval(quantity.value, quantity.ci95, &quantity.unit);
        let mut message = match &interval {
            Some(ends) => format!("{}: {} = {value} [{ends}]", self.text, self.name),
            None => format!("{}: {} = {value}", self.text, self.name),
        };
        if let Some(decision) = &decision {
            message += &format!(": {decision}");
        }
        Ok(Judged { outcome, message, decision })
    }

    fn judge(
        &self,
        quantity: &Quantity,
        factor: f64,
        made: Made,
        result: &Shown,
    ) -> (LimitOutcome, Option<LimitDecision>) {
        // Distance to the nearer limit, negative beyond it.
        let margin = |value: f64| {
            let below = self.lower.map(|lower| value - lower * factor);
            let above = self.upper.map(|upper| upper * factor - value);
            below.into_iter().chain(above).fold(f64::INFINITY, f64::min)
        };
        let guard_band = self.guard_band * factor;
        let own = margin(quantity.value);
        if own < 0.0 {
            let [low, high] = quantity.ci95.unwrap_or([quantity.value; 2]);
            let is_above = self.upper.is_some_and(|upper| quantity.value > upper * factor);
            // Half width of the interval towards the limit that the value exceeds.
            let reach = if is_above { quantity.value - low } else { high - quantity.value };
            return match reach >= -own {
                true => (LimitOutcome::Marginal, Some(made.narrower_interval(result, -own, reach))),
                false => (LimitOutcome::Fail, None),
            };
        }
        if own < guard_band {
            return (LimitOutcome::Marginal, Some(made.other_value()));
        }
        let Some(ends) = quantity.ci95 else {
            return match self.needs_interval {
                true => (LimitOutcome::Inconclusive, Some(made.first_interval())),
                false => (LimitOutcome::Pass, None),
            };
        };
        let least = ends.into_iter().map(margin).fold(f64::INFINITY, f64::min);
        match least >= guard_band {
            true => (LimitOutcome::Pass, None),
            false => (LimitOutcome::Marginal, Some(made.narrower_interval(result, own - guard_band, own - least))),
        }
    }
}

/// Factor from the written unit to the unit of the quantity: the same unit, with a prefix, or a fraction in percent.
fn factor(written: &str, own: &str) -> Option<f64> {
    if written == own || (written.is_empty() && own == "1") {
        return Some(1.0);
    }
    // A limit without a unit on a percentage is a fraction.
    if written.is_empty() && own == "%" {
        return Some(100.0);
    }
    [("k", 1e3), ("m", 1e-3), ("µ", 1e-6), ("u", 1e-6), ("n", 1e-9)]
        .into_iter()
        .find(|(prefix, _)| written.strip_prefix(prefix) == Some(own) && !own.is_empty())
        .map(|(_, factor)| factor)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::view::{Applies, Identification, Identified};
    use serde_json::{Map, Value};
    use std::sync::LazyLock;

    /// A friction result of 30.6 mNm ± 0.4 mNm.
    pub fn found() -> Identification {
        let quantity = Quantity {
            name: "tau_c".to_owned(),
            symbol: "τ_c".to_owned(),
            title: "Coulomb friction".to_owned(),
            base_title: None,
            base_symbol: None,
            configuration: None,
            direction: None,
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
        Identification { run: 1, procedure, software: String::new(), result, follow_up: None, applies, limits: None }
    }

    /// With the default of two repeats.
    fn made() -> Made<'static> {
        static NONE: LazyLock<Map<String, Value>> = LazyLock::new(Map::new);
        Made { procedure: "friction", parameters: &NONE }
    }

    #[test]
    fn the_whole_interval_must_keep_the_limit() {
        let check = |text: &str| text.parse::<Requirement>().unwrap().check(made(), &found().result);
        assert!(matches!(check("tau_c < 0.035 Nm"), Ok((LimitOutcome::Pass, _))));
        assert!(matches!(check("tau_c<=35 mNm"), Ok((LimitOutcome::Pass, _))));
        assert!(matches!(check("tau_c > 0.02 Nm"), Ok((LimitOutcome::Pass, _))));
        assert!(matches!(check("tau_c < 0.030 Nm"), Ok((LimitOutcome::Fail, _))));
        assert!(
            matches!(check("tau_c < 0.0308 Nm"), Ok((LimitOutcome::Marginal, message)) if message.contains("30.60 mNm [30.20 … 31.00]"))
        );
    }

    #[test]
    fn a_marginal_result_says_what_would_decide() {
        let limit = |upper: f64, guard_band: f64| Requirement {
            text: "tau_c".to_owned(),
            name: "tau_c".to_owned(),
            lower: Some(20.0),
            upper: Some(upper),
            guard_band,
            unit: "mNm".to_owned(),
            needs_interval: true,
        };
        assert!(matches!(limit(32.0, 0.5).check(made(), &found().result), Ok((LimitOutcome::Pass, _))));
        let Ok((LimitOutcome::Marginal, why)) = limit(30.8, 0.0).check(made(), &found().result) else {
            panic!("the interval ends at 31.0")
        };
        assert!(
            why.ends_with("[30.20 … 31.00]: a run of friction with repeats=8 would decide if the value stays"),
            "{why}"
        );
        let Ok((LimitOutcome::Marginal, why)) = limit(31.0, 0.5).check(made(), &found().result) else {
            panic!("30.6 is above 30.5")
        };
        assert!(why.ends_with("the value itself is in the guard band"), "{why}");
        let Ok((LimitOutcome::Marginal, why)) = limit(30.5, 0.0).check(made(), &found().result) else {
            panic!("the interval begins at 30.2")
        };
        assert!(why.ends_with("a run of friction with repeats=32 would decide if the value stays"), "{why}");
        assert!(matches!(limit(30.1, 0.0).check(made(), &found().result), Ok((LimitOutcome::Fail, _))));
        let mut bare = found();
        bare.result.quantities[0].ci95 = None;
        assert!(matches!(limit(32.0, 0.0).check(made(), &bare.result), Ok((LimitOutcome::Inconclusive, _))));
    }

    #[test]
    fn a_limit_on_a_percentage_is_in_percent_or_a_fraction() {
        let mut found = found();
        let quantity = &mut found.result.quantities[0];
        (quantity.unit, quantity.value, quantity.ci95) = ("%".to_owned(), 1.5, None);
        let outcome = |text: &str| text.parse::<Requirement>().unwrap().check(made(), &found.result).unwrap().0;
        assert_eq!(outcome("tau_c < 2 %"), LimitOutcome::Pass);
        assert_eq!(outcome("tau_c < 0.02"), LimitOutcome::Pass);
        assert_eq!(outcome("tau_c < 0.01"), LimitOutcome::Fail);
    }

    #[test]
    fn an_unknown_requirement_has_a_reason() {
        let check = |text: &str| text.parse::<Requirement>().unwrap().check(made(), &found().result);
        let why = "'tau_x < 1 Nm': the result does not contain tau_x; did you mean tau_c? available: tau_c";
        assert_eq!(check("tau_x < 1 Nm"), Err(why.to_owned()));
        assert_eq!(check("tau_c < 1 A"), Err("tau_c is in Nm: write the limit so".to_owned()));
        assert_eq!(check("tau_c < 1"), Err("tau_c is in Nm: write the limit so".to_owned()));
        for text in ["tau_c", "< 3 Nm", "tau_c < much", "tau_c < NaN Nm"] {
            assert!(text.parse::<Requirement>().unwrap_err().contains("NAME < VALUE UNIT"), "{text}");
        }
    }
}
