//! Effects: from the library, and defined by users.

use super::EffectDefinition;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// One physical effect that a model can contain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Effect {
    pub id: String,
    pub kind: String,
    pub title: String,
    /// One sentence for a technician.
    pub sentence: String,
    pub formula: String,
    /// Published source.
    #[serde(default)]
    pub source: String,
    /// Shape of the residual if the effect is missing.
    #[serde(default)]
    pub looks: String,
    pub parameters: Vec<EffectParameter>,
    /// Columns required for the effect.
    pub needs: Vec<String>,
    /// User definition; `null` for a library effect.
    #[serde(default)]
    pub definition: Option<EffectDefinition>,
    /// Version of the user definition, from 1.
    #[serde(default)]
    pub version: Option<i64>,
    /// Runs whose diagnosis may suggest this user-defined effect; empty for a library effect, which every run uses.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub runs: Vec<i64>,
}

impl Effect {
    /// Symbol of a fitted parameter, also of a member of a family: `xi_2` becomes `ξ_2`.
    pub fn symbol(&self, name: &str) -> String {
        if self.definition.is_some() { name.to_owned() } else { parameter_symbol(name) }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct EffectParameter {
    pub name: String,
    /// Symbol as printed, with `_` before the index: `τ_c`. A parameter of a user definition has its name.
    pub symbol: String,
    pub unit: String,
    pub min: Option<f64>,
    pub max: Option<f64>,
}

/// Symbol of a parameter of the library, as in the formula of its effect. An index `t` is the temperature, except in the
/// time constants `t_…`.
pub fn parameter_symbol(name: &str) -> String {
    match name {
        "j" => return "J".to_owned(),
        "inverse_k" => return "k'⁻¹".to_owned(),
        "harmonic" => return "h".to_owned(),
        "pole_pairs" => return "p".to_owned(),
        _ => {}
    }
    let mut parts = name.split('_');
    let base = parts.next().map(|base| greek(base).unwrap_or(base)).unwrap_or_default();
    let index: String = parts.map(|part| greek(part).unwrap_or(if part == "t" { "T" } else { part })).collect();
    if index.is_empty() { base.to_owned() } else { format!("{base}_{index}") }
}

fn greek(name: &str) -> Option<&'static str> {
    Some(match name {
        "alpha" => "α",
        "beta" => "β",
        "delta" => "δ",
        "eta" => "η",
        "kappa" => "κ",
        "mu" => "μ",
        "omega" => "ω",
        "phi" => "φ",
        "rho" => "ρ",
        "tau" => "τ",
        "theta" => "θ",
        "xi" => "ξ",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::parameter_symbol;

    #[test]
    fn a_parameter_is_written_as_in_the_formula_of_its_effect() {
        for (name, symbol) in [
            ("tau_c", "τ_c"),
            ("c_v", "c_v"),
            ("j", "J"),
            ("inverse_k", "k'⁻¹"),
            ("beta_0", "β_0"),
            ("xi", "ξ"),
            ("xi_2", "ξ_2"),
            ("omega_s", "ω_s"),
            ("c_t", "c_T"),
            ("t_d", "t_d"),
            ("c_t_tau", "c_Tτ"),
            ("c_alpha", "c_α"),
            ("a", "a"),
        ] {
            assert_eq!(parameter_symbol(name), symbol);
        }
    }
}
