//! Prints results for a person.

mod advice;
mod excluded;
mod maps;
mod parameter_cells;

use super::exit::{Done, Exit};
use jointbench_instrument::Kind;
use jointbench_model::{
    Comparison, Diagnosis, Discovery, Evaluation, Evidence, Fit, NoiseFloor, Parameter, ParameterPair, ParameterState,
    Region, ResidualKind, Suggestion, words,
};
pub use maps::print as maps;
use parameter_cells::{Cells, cells};
use serde::Serialize;
use std::path::Path;

/// Prints a result as JSON.
pub fn json_out(value: &impl Serialize) -> Done {
    let text = serde_json::to_string_pretty(value).map_err(|fault| Exit::failed(fault.to_string()))?;
    println!("{text}");
    Ok(())
}

const BAR_WIDTH: f64 = 40.0;

pub fn fit(fit: &Fit) {
    println!("model     {}", fit.effects.join(" + "));
    println!("data      {}", prepared(fit));
    if let Some(scope) = fit.scope.as_ref().filter(|scope| scope.load_scale != 1.0) {
        println!("side      motor (gear ratio {})", figure(scope.load_scale));
    }
    println!();
    parameters(&fit.parameters);
    println!();
    println!(
        "error     validation {} (cross-validated RMS of {})",
        words::figure(fit.validation_rms, &fit.unit),
        of(fit)
    );
    println!(
        "          training   {}, {:.2} % of the measured RMS",
        words::figure(fit.rms, &fit.unit),
        100.0 * fit.relative_error
    );
    if let Some(rms) = fit.effects_rms {
        println!(
            "          effects    {} without nuisance terms, as an exported model predicts the fitted data",
            words::figure(rms, &fit.unit)
        );
    }
    for jointbench_model::TradeOff { first, second, correlation } in &fit.trade_offs {
        println!("note      parameter trade-off: {first} and {second} (correlation {correlation:.2})");
    }
    for note in &fit.notes {
        println!("note      {note}");
    }
}

pub fn evaluation(file: &Path, evaluation: &Evaluation) {
    println!(
        "on {}: error {}, {:.2} % of the measured RMS",
        file.display(),
        words::figure(evaluation.rms, &evaluation.unit),
        100.0 * evaluation.relative_error,
    );
    if let Some(rms) = evaluation.effects_rms {
        println!(
            "effects   {} without nuisance terms, as an exported model predicts",
            words::figure(rms, &evaluation.unit)
        );
    }
    println!("basis     {}", judged(evaluation));
    for note in &evaluation.notes {
        println!("note      {note}");
    }
}

/// The data of the validation error.
fn judged(evaluation: &Evaluation) -> String {
    let Evaluation { rows, samples, .. } = evaluation;
    match evaluation.settled_share {
        Some(share) => format!(
            "{rows} steady-state means, {} of this run ({samples} samples); transients are not evaluated",
            words::percent(share)
        ),
        None => format!("{rows} filtered points of {samples} samples"),
    }
}

pub fn comparison(file: &Path, comparison: &Comparison) {
    let list = |ids: &[String]| if ids.is_empty() { "nothing".to_owned() } else { ids.join(", ") };
    println!("only in second  {}", list(&comparison.added));
    println!("only in first   {}", list(&comparison.removed));
    println!();
    let wide = |of: fn(&ParameterPair) -> &str| comparison.parameters.iter().map(|p| of(p).chars().count()).max();
    let (effect, name) = (wide(|p| &p.effect).unwrap_or(0), wide(|p| &p.name).unwrap_or(0));
    let side = |p: &Option<Parameter>| match p {
        Some(p) => {
            let Cells { value, unit, interval } = cells(p.value, p.ci95, &p.unit);
            format!("{value} {unit} [{interval}]")
        }
        None => "–".to_owned(),
    };
    for p in &comparison.parameters {
        let (first, second) = (side(&p.first), side(&p.second));
        let differ = match p.differ {
            Some(true) => "  differ",
            _ => "",
        };
        println!("{:effect$}  {:name$}  {first:>38}  {second:>38}{differ}", p.effect, p.name);
    }
    println!();
    let (first, second) = (&comparison.first, &comparison.second);
    println!(
        "on {}: error {} and {} ({:+.1} %)",
        file.display(),
        words::figure(first.rms, &first.unit),
        words::figure(second.rms, &second.unit),
        100.0 * (second.rms / first.rms - 1.0)
    );
}

pub fn diagnosis(diagnosis: &Diagnosis) {
    fit(&diagnosis.fit);
    floor(&diagnosis.noise_floor, &diagnosis.fit.unit);
    println!();
    println!("{}", diagnosis.summary);
    regions(&diagnosis.regions, &diagnosis.fit.unit);
    suggestions(&diagnosis.suggestions, diagnosis.fit.validation_rms, &diagnosis.fit.unit);
    if advice::is_any(diagnosis.undecided.as_ref(), diagnosis.verdict) {
        // A missing effect of the library is tried first.
        if diagnosis.suggestions.is_empty() {
            advice::user_formula(&diagnosis.shows_over, &diagnosis.fit);
        }
        advice::next_run(diagnosis.experiment.as_ref());
    }
    excluded::print(&diagnosis.silent, &diagnosis.not_visible, &diagnosis.left_out, &diagnosis.fit.unit);
}

pub fn discovery(discovery: &Discovery) {
    let mut last_rms = f64::NAN;
    let steps: Vec<(String, f64)> = discovery
        .steps
        .iter()
        .map(|step| {
            let name = match (&step.added, &step.removed) {
                (Some(added), Some(removed)) => format!("+ {added} − {removed}"),
                // Effects at reversals or on ramps are evaluated there.
                (Some(added), None) if step.validation_rms == last_rms => format!("+ {added} (transients only)"),
                (Some(added), None) => format!("+ {added}"),
                (None, Some(removed)) => format!("− {removed}"),
                (None, None) => "start".to_owned(),
            };
            last_rms = step.validation_rms;
            (name, last_rms)
        })
        .collect();
    fall(&steps, discovery.noise_floor_rms, &discovery.fit.unit);
    println!();
    fit(&discovery.fit);
    floor(&discovery.noise_floor, &discovery.fit.unit);
    println!();
    println!("{}", discovery.summary);
    for (added, rivals) in discovery.steps.iter().filter_map(|step| Some((step.added.as_ref()?, &step.confounded_with)))
    {
        if !rivals.is_empty() {
            println!("confounded: this run cannot distinguish {added} from {}", words::list(rivals));
        }
    }
    regions(&discovery.regions, &discovery.fit.unit);
    if advice::is_any(discovery.undecided.as_ref(), discovery.verdict) {
        advice::user_formula(&discovery.shows_over, &discovery.fit);
        advice::next_run(discovery.experiment.as_ref());
    }
    excluded::print(&discovery.silent, &discovery.not_visible, &discovery.left_out, &discovery.fit.unit);
}

pub fn parameters(parameters: &[Parameter]) {
    let wide = |of: fn(&Parameter) -> &str| parameters.iter().map(|p| of(p).chars().count()).max().unwrap_or(0);
    let (effect, name) = (wide(|p| &p.effect), wide(|p| &p.name));
    let rows: Vec<Cells> = parameters.iter().map(|p| cells(p.value, p.ci95, &p.unit)).collect();
    let unit = rows.iter().map(|row| row.unit.chars().count()).max().unwrap_or(0);
    println!("{:effect$}  {:name$}  {:>11}  {:unit$}  95 % interval", "effect", "parameter", "value", "unit");
    for (parameter, Cells { value, unit: prefixed, interval }) in parameters.iter().zip(rows) {
        let interval = fixed_or(parameter, interval);
        println!(
            "{:effect$}  {:name$}  {value:>11}  {prefixed:unit$}  {interval}{}",
            parameter.effect,
            parameter.name,
            state(parameter)
        );
    }
}

/// A fixed value has no interval.
fn fixed_or(parameter: &Parameter, interval: String) -> String {
    if parameter.state == ParameterState::Fixed { "fixed".to_owned() } else { interval }
}

/// The state of a parameter in words.
fn state(parameter: &Parameter) -> String {
    match (parameter.state, &parameter.note) {
        (ParameterState::Ok | ParameterState::Fixed, _) => String::new(),
        (_, Some(note)) => format!("  {note}"),
        (ParameterState::AtBound, None) => "  at bound".to_owned(),
        (ParameterState::Impossible, None) => "  impossible".to_owned(),
        (ParameterState::Unidentified, None) => "  not identified".to_owned(),
    }
}

pub fn regions(regions: &[Region], unit: &str) {
    if regions.is_empty() {
        return;
    }
    println!();
    println!("regions with significant residual of this model (simultaneous 95 % intervals):");
    for region in regions {
        let [low, high] = region.ci95.map(f64::abs);
        let (low, high) = (words::figure(low.min(high), unit), words::figure(low.max(high), unit));
        println!("  {}  [{low} … {high}]", region.sentence);
    }
}

/// `present_rms`: validation error of the current model.
pub fn suggestions(suggestions: &[Suggestion], present_rms: f64, unit: &str) {
    if suggestions.is_empty() {
        return;
    }
    println!();
    let several = suggestions.len() > 1;
    let with_all = if several { " (parameters and ΔBIC with all of these in the model)" } else { "" };
    println!("missing effects{with_all}; ΔBIC over independent blocks, below 0 favours an effect:");
    for (i, suggestion) in suggestions.iter().enumerate() {
        let (share, rms) = (suggestion.error_reduction, suggestion.validation_rms);
        // Effects of reversals and ramps are evaluated there, and do not change the error in steady state.
        let elsewhere = (1.0 - rms / present_rms - share).abs() > 0.01;
        let gain = match elsewhere {
            true => {
                format!("validation error {} % in transients, unchanged in steady state", signed(-100.0 * share, 1))
            }
            false => {
                let ci95 = suggestion.error_reduction_ci95;
                let ci95 =
                    ci95.map(|[low, high]| format!(" [{} … {}]", signed(-100.0 * high, 1), signed(-100.0 * low, 1)));
                format!(
                    "validation error {} %{}, to {}",
                    signed(-100.0 * share, 1),
                    ci95.unwrap_or_default(),
                    words::figure(rms, unit)
                )
            }
        };
        let together = suggestion.error_reduction_together;
        let jointly = format!("{} % together with the others", signed(-100.0 * together, 1));
        // An effect that other effects mask shows only together with them.
        let gain = match several {
            true if together > share => format!("{jointly}; alone: {gain}"),
            true => format!("{gain} alone; {jointly}"),
            false => gain,
        };
        println!("  {}. {}: {gain}, {}", i + 1, suggestion.effect, chance(suggestion));
        println!("     {}", suggestion.why);
        for parameter in &suggestion.parameters {
            let Cells { value, unit, interval } = cells(parameter.value, parameter.ci95, &parameter.unit);
            let (state, interval) = (state(parameter), fixed_or(parameter, interval));
            println!("     {} = {value} {unit}  [{interval}]{state}", parameter.name);
        }
    }
}

/// A number with its sign; zero has none.
fn signed(value: f64, decimals: usize) -> String {
    let text = format!("{value:+.decimals$}");
    if text.parse() == Ok(0.0) { text[1..].to_owned() } else { words::with_minus(&text) }
}

fn chance(suggestion: &Suggestion) -> String {
    let bic = suggestion.bic_change.map(|change| format!(", ΔBIC {}", signed(change, 0)));
    let sign = if suggestion.p_at_most { '≤' } else { '=' };
    let class = match suggestion.evidence {
        Evidence::Strong => "",
        Evidence::Small => ", small effect",
        Evidence::Weak => ", weak evidence",
    };
    let p_value = match suggestion.p_value {
        p if p < 0.001 => "p < 0.001".to_owned(),
        p => format!("p {sign} {p:.3}"),
    };
    format!("{p_value}{}{class}", bic.unwrap_or_default())
}

fn floor(floor: &NoiseFloor, unit: &str) {
    match floor.rms {
        Some(rms) => {
            let interval = match floor.ci95.map(|ends| ends.map(|edge| words::figure(edge, unit))) {
                Some([low, high]) => format!("[{low} … {high}]"),
                None => "(no interval: a few blocks contain most of the scatter)".into(),
            };
            println!("noise     floor {} {interval}: {}", words::figure(rms, unit), floor.source);
        }
        None => println!("noise     {}", floor.source),
    }
}

/// The validation error of each step as a table and a bar chart, with the noise floor.
pub fn fall(steps: &[(String, f64)], floor: Option<f64>, unit: &str) {
    let top = steps.iter().map(|(_, rms)| *rms).fold(floor.unwrap_or(0.0), f64::max);
    let wide = steps.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0).max("noise floor".len());
    let at = |rms: f64| if top > 0.0 { (BAR_WIDTH * rms / top).round() as usize } else { 0 };
    println!("{:wide$}  {:>11}", "", format!("[{unit}]"));
    for (name, rms) in steps {
        let mut bar: Vec<char> = vec!['█'; at(*rms)];
        if let Some(floor) = floor.map(at) {
            bar.resize(bar.len().max(floor + 1), ' ');
            bar[floor] = '│';
        }
        println!("{name:wide$}  {:>11}  {}", figure(*rms), bar.into_iter().collect::<String>());
    }
    if let Some(floor) = floor {
        println!("{:wide$}  {:>11}  {}│", "noise floor", figure(floor), " ".repeat(at(floor)));
    }
}

fn prepared(fit: &Fit) -> String {
    let prepared = &fit.preparation;
    let rate_hz = (1e3 * prepared.sample_rate_hz).round() / 1e3;
    // Only interpolation over gaps gives more rows than samples.
    let mut text = match prepared.rows * prepared.decimation > prepared.samples {
        true => format!("{} samples with uneven time stamps, resampled at {rate_hz} Hz", prepared.samples),
        false => format!("{} samples at {rate_hz} Hz", prepared.samples),
    };
    if let Some(cutoff_hz) = prepared.cutoff_hz {
        text += &format!(", low-pass {cutoff_hz:.1} Hz");
    }
    if let Some(lag_s) = prepared.velocity_lag_s.filter(|lag_s| lag_s.abs() * prepared.sample_rate_hz > 0.01) {
        text += &format!(", velocity delay of {:.1} ms corrected", 1e3 * lag_s);
    }
    if prepared.decimation > 1 {
        text += &format!(", decimated by {}", prepared.decimation);
    }
    if let Some(chunk_s) = prepared.chunk_s {
        text += &format!(", means over {chunk_s:.3} s");
    }
    text + &format!("; {} points in {} independent blocks", prepared.rows, prepared.blocks)
}

fn of(fit: &Fit) -> &'static str {
    match (fit.residual, fit.kind) {
        (ResidualKind::Raw, _) => "filtered samples",
        (ResidualKind::PlateauMean, Kind::Friction) => "steady-state means",
        // Runs in legs have no steady states.
        (ResidualKind::PlateauMean, _) => "short means",
    }
}

/// Four significant digits, without an exponent if that is short.
pub fn figure(value: f64) -> String {
    const DIGITS: i32 = 3;
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return if value.is_nan() {
            "–".to_owned()
        } else if value > 0.0 {
            "∞".to_owned()
        } else {
            "−∞".to_owned()
        };
    }
    let exponent = value.abs().log10().floor() as i32;
    match exponent {
        -4..=5 => words::with_minus(&format!("{value:.*}", (DIGITS - exponent).max(0) as usize)),
        _ => words::scientific(value, DIGITS as usize),
    }
}

#[cfg(test)]
mod tests {
    use super::figure;

    #[test]
    fn figures_have_four_digits() {
        for (value, text) in [
            (0.0, "0"),
            (0.030612, "0.03061"),
            (-203.5034, "−203.5"),
            (95108.9, "95109"),
            (1.512e-4, "0.0001512"),
            (8.2e-6, "8.200·10⁻⁶"),
            (1e9, "1.000·10⁹"),
            (f64::INFINITY, "∞"),
        ] {
            assert_eq!(figure(value), text);
        }
    }
}
