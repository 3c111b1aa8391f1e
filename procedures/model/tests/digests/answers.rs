//! The answers to one run, each as the first digits of the SHA-256 of its JSON.

use super::cases::{Case, menu};
use jointbench_model::{Discovery, ModelError, ModelSpec, Open, diagnose, discover, fit, next_run, residuals};
use serde::Serialize;
use serde_json::json;
use sha2::{Digest, Sha256};

/// Hexadecimal digits of each digest.
const DIGITS: usize = 12;
/// Effects that `discover` may add.
const MOST_EFFECTS: usize = 6;

pub fn answers(case: &Case) -> String {
    let Case { run, spec, options, .. } = case;
    let diagnosis = diagnose(run, spec, options);
    let discovery = discover(run, spec, options, MOST_EFFECTS);
    let fitted = discovery.as_ref().map_err(ToString::to_string).and_then(|found| {
        let end = complete(found, spec).map_err(|e| e.to_string())?;
        fit(run, &end, options).map_err(|e| e.to_string())
    });
    let left =
        fitted.as_ref().map_err(Clone::clone).and_then(|fit| residuals(run, fit, options).map_err(|e| e.to_string()));
    let next = diagnosis.as_ref().map_err(ToString::to_string).and_then(|found| {
        let open = Open { user_effects: spec.user_effects.clone(), ..Open::from(found) };
        let next = next_run(run, &open, &menu(run), options).map_err(|e| e.to_string())?;
        Ok(json!({ "experiment": next.experiment, "in_vain": next.in_vain }))
    });
    [
        ("diagnose", of(diagnosis.as_ref())),
        ("discover", of(discovery.as_ref())),
        ("fit", of(fitted.as_ref())),
        ("residuals", of(left.as_ref())),
        ("next_run", of(next.as_ref())),
    ]
    .map(|(verb, digest)| format!("{verb}={digest}"))
    .join(" ")
}

/// The final model of `discover`.
fn complete(found: &Discovery, spec: &ModelSpec) -> Result<ModelSpec, ModelError> {
    ModelSpec::with_user_effects(spec.kind, &found.model, spec.user_effects.clone())
}

fn of<T: Serialize, E: ToString>(answer: Result<&T, E>) -> String {
    match answer {
        Ok(answer) => digest(&serde_json::to_string_pretty(answer).unwrap()),
        Err(error) => digest(&error.to_string()),
    }
}

pub fn digest(text: &str) -> String {
    let bytes = Sha256::digest(text.as_bytes());
    let mut digits: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    digits.truncate(DIGITS);
    digits
}
