//! A fitted model as a C99 header for a controller: one function, without static memory, and no library except
//! math.h.

pub(crate) mod body;
pub(crate) mod expression;

use crate::ModelError;
use crate::export::c::body::{Body, DEAD_BAND, dead_band_of};
use crate::export::c::expression::number;
use crate::export::parts::{Part, Parts};
use crate::export::{load_noise, suffix};
use crate::report::fit::{Fit, Parameter};
use crate::signal::Signal;
use std::fmt::Write;

/// The header. Its first comment names the effects that a controller cannot compute.
pub fn header(fit: &Fit) -> Result<String, ModelError> {
    let parts = Parts::of(fit)?;
    let body = Body::new(fit, &parts);
    let name = format!("joint_{}", fit.kind);
    let guard = format!("{}_H", name.to_uppercase());
    let mut text = String::new();
    let mut line = |words: &str| {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{words}");
    };
    line("/*");
    let errors = [crate::export::of_model(fit, &parts.left_out)].into_iter().chain(fed(fit, &parts)).collect();
    crate::export::about(fit, &parts, &parts.left_out, errors)
        .iter()
        .for_each(|words| line(&format!(" * {}", suffix::ascii(words))));
    line(" * SI units; the unit is the suffix of a name. C99; link with -lm.");
    line(" */");
    line(&format!("#ifndef {guard}\n#define {guard}\n\n#include <math.h>\n"));

    line("typedef struct {");
    for signal in &body.inputs {
        line(&format!("    double {}; /* {} */", body.field(signal), suffix::ascii(signal.meaning)));
    }
    if body.uses_step {
        line("    double sample_s; /* time since the last call */");
    }
    line(&format!("}} {name}_input;\n"));

    line("typedef struct {");
    for (field, _, comment) in parameters(fit, &parts) {
        line(&format!("    double {field};{comment}"));
    }
    line(&format!("}} {name}_parameters;\n"));
    line(&format!("static const {name}_parameters {name}_fitted = {{"));
    for (field, value, _) in parameters(fit, &parts) {
        line(&format!("    .{field} = {},", number(value)));
    }
    line("};\n");

    if !body.states.is_empty() {
        line("/* Begin with all zero: = {0}. One for each joint; the function keeps it. */\ntypedef struct {");
        line("    int started;");
        body.states.iter().for_each(|state| line(&format!("    {state}")));
        line(&format!("}} {name}_state;\n"));
    }
    let state = if body.states.is_empty() { String::new() } else { format!("{name}_state *s, ") };
    line(&format!("/* {} */", suffix::ascii(&crate::export::predicted(fit))));
    line(&format!(
        "static inline double {name}_{}(const {name}_parameters *p, {state}const {name}_input *u)\n{{",
        suffix::of(&fit.unit)
    ));
    line("    double sum = 0.0;\n    (void)p;\n    (void)u;");
    body.statements.iter().for_each(|statement| line(&format!("    {statement}")));
    if !body.states.is_empty() {
        line("    s->started = 1;");
    }
    line("    return sum;\n}\n");
    line(&format!("#endif /* {guard} */"));
    Ok(text)
}

/// Field, value and note of the fit. An empty struct is not allowed in C.
fn parameters(fit: &Fit, parts: &Parts) -> Vec<(String, f64, String)> {
    let mut all = Vec::new();
    for part in &parts.parts {
        let effect = part.effect;
        for (name, value) in part.coefficients.iter().chain(&part.shape) {
            let parameter = fit.parameters.iter().find(|p| p.effect == effect && p.name == *name);
            all.push((format!("{effect}_{name}"), *value, parameter.map(comment).unwrap_or_default()));
        }
        if let Some(band) = dead_band_of(fit, part) {
            let words = format!(
                " /* changes beyond it are followed: {} times the noise of the signal, rms */",
                load_noise::NOISES
            );
            all.push((format!("{effect}_{DEAD_BAND}"), band, words));
        }
    }
    if all.is_empty() {
        all.push(("nothing".to_owned(), 0.0, String::new()));
    }
    all
}

/// Requirements on the signal of a hysteresis state, if the fit used a smoother signal than a controller measures.
fn fed(fit: &Fit, parts: &Parts) -> Vec<String> {
    let of_load = |part: &&Part| load_noise::remembered(part) == Some(Signal::Load);
    let effects: Vec<&str> = parts.parts.iter().filter(of_load).map(|part| part.effect).collect();
    let scope = fit.scope.as_ref();
    let load = scope.and_then(|scope| scope.signals.iter().find(|range| range.name == "load"));
    let noise = load.and_then(|load| Some((load.noise?, &load.unit)));
    let list = effects.join(", ");
    match (noise, scope.and_then(|scope| scope.fed_rms)) {
        _ if effects.is_empty() => Vec::new(),
        (Some((noise, unit)), Some(rms)) => vec![
            format!("Error with the measured load of that run, sample by sample: {rms:.4e} {} rms", fit.unit),
            format!(
                "The fit smoothed the load, which had {noise:.4e} {unit} rms of noise; {list} follows it beyond a dead band \
                 of {} times that. Feed it unfiltered, and set {DEAD_BAND} where your signal has another noise.",
                load_noise::NOISES
            ),
        ],
        _ => vec![format!(
            "The fit smoothed the load, and {list} remembers every swing of its noise: feed it without noise and without lag, \
             or fit again with this version, which measures the noise."
        )],
    }
}

fn comment(parameter: &Parameter) -> String {
    let [low, high] = parameter.ci95;
    let note: String = parameter.note.iter().map(|note| format!("; {note}")).collect();
    format!(" /* {} */", suffix::ascii(&format!("[{}] 95 %: {low:.4e} to {high:.4e}{note}", parameter.unit)))
}
