//! Terms of a model as C statements, with the signals and states that they use.

use crate::export::c::expression::{c, number};
use crate::export::parts::{Part, PartColumn, Parts};
use crate::export::{load_noise, suffix};
use crate::formula::signals::NamedSignal;
use crate::hysteresis_operators;
use crate::report::fit::Fit;
use crate::signal::Signal;
use crate::symbolic::Rule;
use crate::user_effects::signals_with;
use jointbench_instrument::Motion;

#[derive(Debug)]
pub struct Body {
    motion: Motion,
    pub inputs: Vec<NamedSignal>,
    /// Declarations of the states.
    pub states: Vec<String>,
    pub statements: Vec<String>,
    /// Whether a state depends on the time step.
    pub uses_step: bool,
    /// Effects that follow their signal through a dead band.
    banded: Vec<String>,
}

impl Body {
    pub fn new(fit: &Fit, parts: &Parts) -> Self {
        let mut inputs = signals_with(fit.kind, &fit.user_effects);
        let first = inputs.first().copied();
        inputs.retain(|s| parts.uses(s.signal));
        if inputs.is_empty() {
            // An empty struct is not allowed in C.
            inputs.extend(first);
        }
        let motion = fit.scope.as_ref().map_or(Motion::default(), |s| s.motion);
        let banded =
            parts.parts.iter().filter(|p| dead_band_of(fit, p).is_some()).map(|p| p.effect.to_owned()).collect();
        let mut body = Self { motion, inputs, states: Vec::new(), statements: Vec::new(), uses_step: false, banded };
        for part in &parts.parts {
            body.statements
                .push(format!("/* {} */", suffix::ascii(if part.title.is_empty() { part.effect } else { part.title })));
            for (i, column) in part.columns.iter().enumerate() {
                match part.coefficients.get(i) {
                    Some((name, _)) => body.column(part, i, &format!("p->{}_{name}", part.effect), column),
                    None if part.coefficients.is_empty() => body.column(part, i, "1.0", column),
                    None => {}
                }
            }
        }
        body
    }

    /// The name of the input field.
    pub fn field(&self, signal: &NamedSignal) -> String {
        match signal.signal {
            // Such a column already contains its unit, and may contain characters that C does not allow.
            Signal::Column(column) => suffix::of(column),
            _ => suffix::named(signal.name, &self.motion.label(signal.unit)),
        }
    }

    fn input(&self, signal: Signal) -> String {
        let named = self.inputs.iter().find(|s| s.signal == signal);
        named.map_or_else(String::new, |s| format!("u->{}", self.field(s)))
    }

    fn column(&mut self, part: &Part, place: usize, coefficient: &str, column: &PartColumn) {
        let effect = part.effect;
        let parameter = |p: usize| part.shape.get(p).map(|(name, _)| format!("p->{effect}_{name}"));
        let shape = |p: usize| parameter(p).unwrap_or_default();
        match column {
            PartColumn::Formula(formula) => {
                let formula = c(formula, &|signal| self.input(signal), &shape);
                self.statements.push(format!("sum += {coefficient} * {formula};"));
            }
            PartColumn::Memory { rule, signal, reach, end, formula } => {
                let state = if place == 0 { format!("{effect}_z") } else { format!("{effect}_z_{}", place + 1) };
                if place == 0 && *rule != Rule::Lag {
                    self.step(effect, *signal);
                }
                let end = c(end, &|signal| self.input(signal), &shape);
                let z = self.remember(effect, *rule, *signal, &state, &shape(*reach), &end);
                let of = |p: usize| parameter(p).unwrap_or_else(|| z.clone());
                let formula = c(formula, &|signal| self.input(signal), &of);
                self.statements.push(format!("sum += {coefficient} * {formula};"));
            }
            PartColumn::Band { stops, bands, band } => {
                let state = format!("{effect}_z");
                if *band == 0 {
                    self.step(effect, Signal::Current);
                    self.stops(effect, &state, *stops, &shape(0));
                }
                self.statements.push(format!("for (int k = 1; k <= {stops}; k++) {{"));
                let place = format!("fabs(k * {} / {} - {})", number(*bands as f64), number(*stops as f64), band + 1);
                self.statements
                    .push(format!("    sum += {coefficient} * fmax(0.0, 1.0 - {place}) * (s->{state}[k - 1] + 1.0);"));
                self.statements.push("}".into());
            }
        }
    }

    /// Declares a state that follows its signal. Returns the expression of the state.
    fn remember(&mut self, effect: &str, rule: Rule, signal: Signal, state: &str, reach: &str, end: &str) -> String {
        if rule == Rule::MaxwellSlip {
            const ELEMENTS: usize = hysteresis_operators::MAXWELL_ELEMENTS;
            self.stops(effect, state, ELEMENTS, reach);
            let each: Vec<String> = (0..ELEMENTS).map(|k| format!("s->{state}[{k}]")).collect();
            return format!("(({}) / {})", each.join(" + "), number(ELEMENTS as f64));
        }
        let z = format!("s->{state}");
        self.states.push(format!("double {state};"));
        let next = match rule {
            Rule::Lag => {
                self.uses_step = true;
                let x = self.input(signal);
                format!("s->started ? {x} + ({z} - {x}) * exp(-u->sample_s / {reach}) : {x}")
            }
            Rule::Dahl => {
                self.statements.push(format!("double {state}_end = {effect}_step < 0.0 ? -{end} : {end};"));
                let share = format!("exp(-fabs({effect}_step) / ({reach} * fabs({state}_end)))");
                format!("{state}_end + ({z} - {state}_end) * {share}")
            }
            Rule::Stop | Rule::MaxwellSlip => format!("fmin(1.0, fmax(-1.0, {z} + {effect}_step / {reach}))"),
        };
        self.statements.push(format!("{z} = {next};"));
        z
    }

    /// Stop operators with reaches evenly spaced up to the largest.
    fn stops(&mut self, effect: &str, state: &str, stops: usize, largest: &str) {
        self.states.push(format!("double {state}[{stops}];"));
        let reach = format!("({largest} * k / {})", number(stops as f64));
        let z = format!("s->{state}[k - 1]");
        self.statements.push(format!("for (int k = 1; k <= {stops}; k++) {{"));
        self.statements.push(format!("    {z} = fmin(1.0, fmax(-1.0, {z} + {effect}_step / {reach}));"));
        self.statements.push("}".into());
    }

    /// Displacement of a signal since the last call.
    fn step(&mut self, effect: &str, signal: Signal) {
        let x = self.input(signal);
        self.states.push(format!("double {effect}_last;"));
        self.statements.push(format!("double {effect}_step = s->started ? {x} - s->{effect}_last : 0.0;"));
        if self.banded.iter().any(|banded| banded == effect) {
            let band = format!("p->{effect}_{DEAD_BAND}");
            self.statements.push(format!(
                "{effect}_step = fmax(0.0, {effect}_step - {band}) + fmin(0.0, {effect}_step + {band});"
            ));
            self.statements.push(format!("s->{effect}_last = s->started ? s->{effect}_last + {effect}_step : {x};"));
        } else {
            self.statements.push(format!("s->{effect}_last = {x};"));
        }
    }
}

/// Name of the parameter of the dead band.
pub const DEAD_BAND: &str = "dead_band";

/// Dead band of the signal that a part follows.
pub fn dead_band_of(fit: &Fit, part: &Part) -> Option<f64> {
    load_noise::dead_band(fit, load_noise::remembered(part)?)
}
