//! Confounding with temperature: signals that change with the temperature in a run can be the cause of a temperature
//! effect.

use crate::linear::basis::dot;
use crate::preprocess::Prepared;
use crate::signal::Signal;
use crate::thresholds::{COLUMN_CORRELATION, TRADE_OFF_CORRELATION};
use crate::{Effect, UserEffect};

/// The column of the temperature effects.
const TEMPERATURE: &str = "temperature_c";

/// Alternative causes of a temperature effect, in sentences.
pub fn instead(effect: &dyn Effect, prepared: &Prepared) -> Vec<String> {
    if !is_of_temperature(effect) {
        return Vec::new();
    }
    let unknown = prepared.main.view.points.unknown();
    let columns = unknown.filter_map(|column| Some((prepared.column_name(column), correlation(column, prepared)?)));
    let columns = columns.filter(|(_, r)| r.abs() > COLUMN_CORRELATION).map(|(column, r)| {
        format!("{column} moves with {TEMPERATURE} in this data (r = {r:.2}), and may be the cause as well")
    });
    let time = drift(prepared).map(|r| {
        format!("{TEMPERATURE} moves with time in this data (r = {r:.2}): a drift over time looks almost the same")
    });
    columns.chain(time).collect()
}

/// The same effect over time instead of temperature, as a formula, if this run cannot distinguish them.
pub fn over_time(effect: &dyn Effect, prepared: &Prepared) -> Option<UserEffect> {
    drift(prepared)?;
    UserEffect::inline(prepared.kind, effect.traits().over_time?).ok()
}

fn is_of_temperature(effect: &dyn Effect) -> bool {
    effect.info().needs.contains(&TEMPERATURE)
}

fn drift(prepared: &Prepared) -> Option<f64> {
    correlation(Signal::Time, prepared).filter(|r| r.abs() > TRADE_OFF_CORRELATION)
}

/// Correlation with the temperature at the points. `None` if one of the two is constant.
fn correlation(signal: Signal, prepared: &Prepared) -> Option<f64> {
    let problem = &prepared.main;
    let about_mean = |signal| -> Option<Vec<f64>> {
        let values = problem.reduce.apply(problem.view.find(signal)?.to_vec());
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        Some(values.into_iter().map(|v| v - mean).collect())
    };
    let (one, other) = (about_mean(Signal::Temperature)?, about_mean(signal)?);
    let r = dot(&one, &other) / (dot(&one, &one) * dot(&other, &other)).sqrt();
    r.is_finite().then_some(r)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects;
    use jointbench_instrument::Kind;

    #[test]
    fn every_formula_over_time_is_one() {
        let of_temperature = |kind: Kind| effects(kind).iter().filter(|effect| is_of_temperature(**effect));
        let all = [Kind::Friction, Kind::Encoder, Kind::Stiffness].map(|kind| {
            let effects: Vec<_> = of_temperature(kind).collect();
            for effect in &effects {
                let user_effect = UserEffect::inline(kind, effect.traits().over_time.unwrap()).unwrap();
                assert_eq!(user_effect.unit_warnings(None), []);
            }
            effects.len()
        });
        assert_eq!(all, [2, 1, 1]);
    }
}
