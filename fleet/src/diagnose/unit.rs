//! The diagnosis of one unit, reduced to what the fleet needs.

use crate::fit::{UnitFit, unit_fit};
use crate::units::Unit;
use jointbench_instrument::RunTable;
use jointbench_model::{
    Evidence, Fit, Invisible, ModelSpec, Options, Silent, Suggestion, UndecidedReason, Verdict, diagnose, fit,
};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// A missing effect of a unit.
#[derive(Debug, Clone)]
pub struct Missing {
    pub effect: String,
    /// Family-wise over the candidates of the unit.
    pub p_value: f64,
    /// No flip reached its score.
    pub is_at_floor: bool,
    pub evidence: Evidence,
    /// 1 − validation error with the effect / validation error without it.
    pub error_reduction: f64,
    pub confounded_with: Vec<String>,
}

impl Missing {
    /// The p-value is the larger one of the permutation test, which permits errors of any distribution, and the
    /// F-test, which has no smallest value and is corrected for all tested effects (Bonferroni).
    fn new(suggestion: Suggestion, f_test: f64) -> Self {
        Self {
            effect: suggestion.effect,
            p_value: suggestion.p_value.max(f_test),
            is_at_floor: suggestion.p_at_most,
            evidence: suggestion.evidence,
            error_reduction: suggestion.error_reduction,
            confounded_with: suggestion.confounded_with,
        }
    }
}

/// p-value of the F-test of an effect in addition to the model. Each coefficient and each nonlinear parameter is one
/// degree of freedom.
fn f_test(without: &Fit, table: &RunTable, model: &ModelSpec, effect: &str, options: &Options) -> Result<f64, String> {
    let with = model.with(effect).and_then(|model| fit(table, &model, options)).map_err(|fault| fault.to_string())?;
    let added = with.parameters.len().saturating_sub(without.parameters.len()) as f64;
    let freedom = with.preparation.rows as f64 - with.parameters.len() as f64;
    let ratio = ((without.rms / with.rms).powi(2) - 1.0) * freedom / added;
    Ok(FisherSnedecor::new(added, freedom).map_or(1.0, |law| law.sf(ratio)))
}

pub struct UnitDiagnosis {
    pub fit: UnitFit,
    /// The most important first.
    pub missing: Vec<Missing>,
    pub is_unexplained: bool,
    pub undecided: Option<(UndecidedReason, String)>,
    pub silent: Vec<Silent>,
    pub not_visible: Vec<Invisible>,
}

impl UnitDiagnosis {
    /// # Errors
    /// Why the daemon refuses the run, in words.
    pub fn new(unit: &Unit, table: &RunTable, model: &ModelSpec, options: &Options) -> Result<Self, String> {
        let found = diagnose(table, model, options).map_err(|fault| fault.to_string())?;
        let candidates = found.suggestions.len() + found.silent.len() + found.left_out.len();
        let mut missing = Vec::new();
        for suggestion in found.suggestions {
            let p_value = f_test(&found.fit, table, model, &suggestion.effect, options)?;
            missing.push(Missing::new(suggestion, (candidates as f64 * p_value).min(1.0)));
        }
        Ok(Self {
            fit: unit_fit(unit, found.fit),
            missing,
            is_unexplained: found.verdict == Verdict::UnexplainedStructure,
            undecided: found.undecided_reason.map(|reason| (reason, found.undecided.unwrap_or_default())),
            silent: found.silent,
            not_visible: found.not_visible,
        })
    }

    /// Whether its data permits a test. Without a noise floor effects are tested, but nothing shows that none remains.
    pub fn is_tested(&self) -> bool {
        use UndecidedReason::{ContradictoryColumns, TooFewBlocks};
        !matches!(self.undecided, Some((ContradictoryColumns | TooFewBlocks, _)))
    }

    /// The smallest p-value of its effects; 1 without a missing effect.
    pub fn p_value(&self) -> f64 {
        self.missing.iter().map(|missing| missing.p_value).fold(1.0, f64::min)
    }

    pub fn is_at_floor(&self) -> bool {
        self.missing.iter().any(|missing| missing.is_at_floor)
    }
}
