//! Possible next runs of a bench for the model: plans within its limits, as steady-state stretches.

mod friction;
mod from_run;
mod segments;

use crate::bench_facts::BenchFacts;
use crate::catalogue::procedure;
use crate::parameter::Parameter;
use jointbench_instrument::{Kind, RunTable};
use jointbench_model::Choice;
use segments::choice;
use serde_json::{Map, Value, json};

/// Margin to the limits.
const SHARE_OF_LIMIT: f64 = 0.95;

/// Possible next runs, the standard one first. `run`: the measured run, which defines the sample rate; `parameters`:
/// its parameters, if it came from a procedure.
pub fn menu(bench: &BenchFacts, run: &RunTable, parameters: &Map<String, Value>) -> Vec<Choice> {
    let mut menu = Menu { bench, parameters, rate_hz: run.rate_hz().round(), choices: Vec::new() };
    match run.kind() {
        Kind::Friction => friction::offer(&mut menu, run),
        Kind::Encoder => encoder(&mut menu),
        Kind::Stiffness => stiffness(&mut menu),
        Kind::Brake => brake(&mut menu),
    }
    menu.choices
}

struct Menu<'m> {
    bench: &'m BenchFacts,
    parameters: &'m Map<String, Value>,
    /// Sample rate of the measured run.
    rate_hz: f64,
    choices: Vec<Choice>,
}

impl Menu<'_> {
    /// Adds a run that the bench may perform.
    fn offer(&mut self, id: &str, parameters: Value) {
        self.offer_warmed(id, parameters, &|_| 0.0);
    }

    /// The same for a run that warms the joint, by an amount that depends on the time.
    fn offer_warmed(&mut self, id: &str, parameters: Value, warmer_k: &dyn Fn(f64) -> f64) {
        let Value::Object(parameters) = parameters else { return };
        let parameters = self.at_rate(id, parameters);
        if let Some(Ok(plan)) = procedure(id).map(|p| p.plan(&parameters, self.bench))
            && plan.preview(self.bench).is_allowed()
        {
            self.choices.push(choice(&plan, &parameters, self.bench, warmer_k));
        }
    }

    /// The standard run with its previous parameters except for `changes`. A bench that is only known from a run may
    /// not be known well enough for a plan: the run is nevertheless offered, for its repeats.
    fn ordinary(&mut self, id: &str, changes: Value) {
        let parameters = self.before(id, changes);
        self.offer(id, Value::Object(parameters.clone()));
        if self.choices.is_empty() {
            let (procedure, parameters) = (id.to_owned(), self.at_rate(id, parameters));
            self.choices.push(Choice { procedure, parameters, duration_s: f64::INFINITY, stretches: Vec::new() });
        }
    }

    /// The parameters of the measured run that this procedure has, except for `changes`.
    fn before(&self, id: &str, changes: Value) -> Map<String, Value> {
        let mut parameters = self.parameters.clone();
        parameters.retain(|name, _| procedure(id).is_some_and(|p| p.schema().iter().any(|s| s.name == name)));
        parameters.extend(changes.as_object().cloned().unwrap_or_default());
        parameters
    }

    /// With the sample rate of the measured run, so that both can be evaluated together.
    fn at_rate(&self, id: &str, mut parameters: Map<String, Value>) -> Map<String, Value> {
        let fits = |p: &Parameter| p.name == "sample_rate_hz" && (p.min..=p.max).contains(&self.rate_hz);
        if procedure(id).is_some_and(|p| p.schema().iter().any(fits)) {
            parameters.insert("sample_rate_hz".into(), json!(self.rate_hz));
        }
        parameters
    }

    /// Another order than in the previous run, so that a drift over time is not correlated with the same conditions.
    fn next_seed(&self) -> f64 {
        self.parameters.get("order_seed").and_then(Value::as_f64).unwrap_or(1.0) + 1.0
    }

    /// Highest offered speed (motor).
    fn top_rad_s(&self) -> f64 {
        SHARE_OF_LIMIT * self.bench.limits.motor_velocity_rad_s
    }
}

/// Several speeds in both directions separate a delay, which grows with speed, from an effect that only changes its
/// sign.
fn encoder(menu: &mut Menu) {
    let top_rad_s = menu.top_rad_s();
    let mut changes = json!({"repeats": 3});
    if top_rad_s < 50.0 {
        changes["fast_rad_s"] = json!(rounded(top_rad_s.max(1.0)));
        changes["speed_rad_s"] = json!(rounded((top_rad_s / 8.0).max(0.5)));
    }
    menu.ordinary("encoder_linearity", changes);
    for top_rad_s in [top_rad_s, top_rad_s / 4.0] {
        menu.offer("encoder_delay", json!({"top_speed_rad_s": rounded(top_rad_s), "speeds": 4, "repeats": 2}));
    }
    // A zero that changes with every power-up differs from a slip, which occurs once.
    for power_ups in [6, 12] {
        menu.offer("encoder_startup", json!({"power_ups": power_ups, "speed_rad_s": rounded(top_rad_s.min(4.0))}));
    }
}

/// Other speeds and loads than before.
fn stiffness(menu: &mut Menu) {
    menu.ordinary("stiffness", json!({"repeats": 3}));
    let gear = menu.bench.constants.gear_ratio;
    let room_rad = menu.bench.constants.link_range_rad.unwrap_or(f64::INFINITY);
    for part in [1.0, 2.0, 4.0, 8.0] {
        let speed_rad_s = rounded(menu.top_rad_s() / gear / part);
        let dwell_s = rounded((0.5 * room_rad / speed_rad_s).min(1.5));
        for (load_levels, top_load) in [(3, 1.0), (8, 1.0), (8, 0.5)] {
            menu.offer(
                "stiffness",
                json!({
                    "speed_rad_s": speed_rad_s, "dwell_s": dwell_s, "load_levels": load_levels, "top_load": top_load,
                    "repeats": 2,
                }),
            );
        }
    }
}

/// The whole history of the current, or constant currents over speed.
fn brake(menu: &mut Menu) {
    // It has no repeats: it is evaluated together with the measured run. The menu knows no other brake.
    let seed = menu.next_seed();
    menu.ordinary("brake_hysteresis", json!({"order_seed": seed, "compare_run": 0}));
    let top_rad_s = (menu.top_rad_s() / menu.bench.constants.gear_ratio).min(1.5);
    menu.offer(
        "brake_speed_independence",
        json!({
            "low_speed_rad_s": rounded((top_rad_s / 10.0).max(0.11)), "top_speed_rad_s": rounded(top_rad_s),
            "order_seed": seed,
        }),
    );
}

/// Rounded down to two digits, so that it does not exceed a limit.
fn rounded(value: f64) -> f64 {
    let unit = 10f64.powf(value.log10().floor() - 1.0);
    let whole = (value / unit * (1.0 + 1e-9)).floor();
    // Dividing by an integer power gives 0.12, while multiplying by 0.01 gives 0.12000000000000001.
    if unit < 1.0 { whole / unit.recip().round() } else { whole * unit }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameter::Values;
    use jointbench_instrument::{Channel, Meta, Trace};

    #[test]
    fn what_is_offered_for_any_kind_can_be_started() {
        for kind in Kind::ALL {
            let columns = kind.required_columns();
            let mut trace = Trace::new(columns.iter().copied().map(Channel::new).collect());
            for row in 0..100 {
                trace.push_row(&vec![0.02 * f64::from(row); columns.len()]);
            }
            let run = RunTable::new(Meta { kind: Some(kind), ..Meta::default() }, trace).unwrap();
            let offered = menu(&BenchFacts::shown_by(&run), &run, &Map::new());
            assert!(kind == Kind::Friction || !offered.is_empty(), "{kind}");
            for choice in offered {
                let known = procedure(&choice.procedure).unwrap_or_else(|| panic!("{kind}: {}", choice.procedure));
                assert_eq!(known.kind(), kind);
                assert_eq!(choice.parameters.get("sample_rate_hz"), Some(&json!(50.0)), "{}", choice.procedure);
                Values::parse(known.schema(), &choice.parameters).unwrap();
            }
        }
    }
}
