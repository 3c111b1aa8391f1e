//! Parameters of a fit as quantities of a result.

use crate::identification::Quantity;
use jointbench_model::words::{self, Scale};
use jointbench_model::{Fit, Parameter, ParameterState};

/// A parameter that the run identifies.
pub(crate) fn parameter<'f>(fit: &'f Fit, effect: &str, name: &str) -> Option<&'f Parameter> {
    fit.parameters.iter().find(|p| p.effect == effect && p.name == name && p.state != ParameterState::Unidentified)
}

/// A figure with its interval, in the unit times `scale`.
pub(crate) fn interval_of(parameter: &Parameter, scale: f64) -> (f64, [f64; 2]) {
    let ends = parameter.ci95.map(|end| end * scale);
    (parameter.value * scale, [ends[0].min(ends[1]), ends[0].max(ends[1])])
}

/// The sum of two figures. Their estimates share the noise of the same points with opposite signs. The interval
/// assumes independent estimates, so that it is rather too wide than too narrow.
pub(crate) fn combined(a: (f64, [f64; 2]), b: (f64, [f64; 2]), sign: f64) -> (f64, [f64; 2]) {
    let value = a.0 + sign * b.0;
    let reach = (0.5 * (a.1[1] - a.1[0])).hypot(0.5 * (b.1[1] - b.1[0]));
    (value, [value - reach, value + reach])
}

/// A figure with its interval in the same unit: `0.120 mNm [-0.200 … 0.440]`. An interval that is narrower than the digits of
/// the figure is given by its half width: `779 mNm ± 20.0 µNm`.
pub(crate) fn bounded((value, [low, high]): (f64, [f64; 2]), unit: &str) -> String {
    let scale = Scale::of(value.abs().max(low.abs()).max(high.abs()), unit);
    let [from, to] = [low, high].map(|end| scale.number(end));
    if from == to {
        return format!("{} ± {}", scale.figure(value), words::figure(0.5 * (high - low), unit));
    }
    format!("{} [{from} … {to}]", scale.figure(value))
}

/// Whether two directions differ at 95 %, with their difference `what` and its interval.
pub(crate) fn directions(what: &str, difference: (f64, [f64; 2]), unit: &str) -> String {
    let [low, high] = difference.1;
    let word = if low > 0.0 || high < 0.0 { "differs" } else { "does not differ significantly" };
    format!("{what} {word} between directions (95 %): {}", bounded(difference, unit))
}

/// Named figure: `[name, symbol, title, unit]`.
pub(crate) fn quantity([name, symbol, title, unit]: [&str; 4], value: f64, ci95: Option<[f64; 2]>) -> Quantity {
    Quantity {
        name: name.into(),
        symbol: symbol.into(),
        title: title.into(),
        base_title: None,
        base_symbol: None,
        configuration: None,
        direction: None,
        unit: unit.into(),
        value,
        ci95,
    }
}

/// Named figure in percent, from a fraction: `[name, symbol, title]`. The title names the reference.
pub(crate) fn percentage([name, symbol, title]: [&str; 3], fraction: f64, ci95: Option<[f64; 2]>) -> Quantity {
    quantity([name, symbol, title, "%"], 100.0 * fraction, ci95.map(|ends| ends.map(|end| 100.0 * end)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_narrow_interval_is_given_by_its_half_width() {
        assert_eq!(bounded((1.2e-4, [-2e-4, 4.4e-4]), "Nm"), "120 µNm [−200 … 440]");
        assert_eq!(bounded((0.779_41, [0.779_39, 0.779_43]), "Nm"), "779 mNm ± 20.0 µNm");
    }
}
