//! One term after the other as statements, with the signals and states that they use.

use super::expression::{c, number};
use crate::formula::{NamedSignal, signals};
use crate::report::Fit;
use crate::transfer::parts::{Part, PartColumn, Parts};
use crate::transfer::suffix;
use crate::transfer::written::Rule;
use crate::view::Signal;
use jointbench_instrument::{Kind, Motion};

#[derive(Debug)]
pub struct Body {
    kind: Kind,
    motion: Motion,
    pub inputs: Vec<&'static NamedSignal>,
    /// Declarations of the states.
    pub states: Vec<String>,
    pub statements: Vec<String>,
    /// A state follows time.
    pub uses_step: bool,
}

impl Body {
    pub fn new(fit: &Fit, parts: &Parts) -> Self {
        let mut inputs: Vec<_> = signals(fit.kind).iter().filter(|s| parts.uses(s.signal)).collect();
        if inputs.is_empty() {
            // A struct must not be empty.
            inputs.extend(signals(fit.kind).first());
        }
        let motion = fit.scope.as_ref().map_or(Motion::default(), |s| s.motion);
        let mut body =
            Self { kind: fit.kind, motion, inputs, states: Vec::new(), statements: Vec::new(), uses_step: false };
        for part in &parts.parts {
            body.statements
                .push(format!("/* {} */", suffix::ascii(if part.title.is_empty() { part.effect } else { part.title })));
            for (i, column) in part.columns.iter().enumerate() {
                match part.factors.get(i) {
                    Some((name, _)) => body.column(part, &format!("p->{}_{name}", part.effect), column),
                    None if part.factors.is_empty() => body.column(part, "1.0", column),
                    None => {}
                }
            }
        }
        body
    }

    /// The input's field.
    pub fn field(&self, signal: &NamedSignal) -> String {
        suffix::named(signal.name, &self.motion.label(signal.unit))
    }

    fn input(&self, signal: Signal) -> String {
        let named = signals(self.kind).iter().find(|s| s.signal == signal);
        named.map_or_else(String::new, |s| format!("u->{}", self.field(s)))
    }

    fn column(&mut self, part: &Part, factor: &str, column: &PartColumn) {
        let state = format!("s->{}_z", part.effect);
        let parameter = |p: usize| match part.shape.get(p) {
            Some((name, _)) => format!("p->{}_{name}", part.effect),
            None => state.clone(),
        };
        let text = |body: &Self, formula| c(formula, &|signal| body.input(signal), &parameter);
        match column {
            PartColumn::Formula(formula) => {
                let formula = text(self, formula);
                self.statements.push(format!("sum += {factor} * {formula};"));
            }
            PartColumn::Memory { rule, signal, formula } => {
                self.remember(part, *rule, *signal, &state, &parameter(0));
                let formula = text(self, formula);
                self.statements.push(format!("sum += {factor} * {formula};"));
            }
            PartColumn::Band { stops, bands, band } => {
                if *band == 0 {
                    self.stops(part, *stops, &parameter(0));
                }
                self.statements.push(format!("for (int k = 1; k <= {stops}; k++) {{"));
                let place = format!("fabs(k * {} / {} - {})", number(*bands as f64), number(*stops as f64), band + 1);
                self.statements
                    .push(format!("    sum += {factor} * fmax(0.0, 1.0 - {place}) * ({state}[k - 1] + 1.0);"));
                self.statements.push("}".into());
            }
        }
    }

    /// The state follows its signal.
    fn remember(&mut self, part: &Part, rule: Rule, signal: Signal, z: &str, reach: &str) {
        let x = self.input(signal);
        let effect = part.effect;
        self.states.push(format!("double {effect}_z;"));
        if rule == Rule::Lag {
            self.uses_step = true;
            self.statements.push(format!("{z} = s->started ? {x} + ({z} - {x}) * exp(-u->sample_s / {reach}) : {x};"));
            return;
        }
        self.step(effect, &x);
        self.statements.push(match rule {
            Rule::Dahl => {
                let end = format!("({effect}_step < 0.0 ? -1.0 : 1.0)");
                format!("{z} = {end} + ({z} - {end}) * exp(-fabs({effect}_step) / {reach});")
            }
            Rule::Stop | Rule::Lag => format!("{z} = fmin(1.0, fmax(-1.0, {z} + {effect}_step / {reach}));"),
        });
    }

    /// Stops with reaches evenly up to the largest.
    fn stops(&mut self, part: &Part, stops: usize, largest: &str) {
        let effect = part.effect;
        self.states.push(format!("double {effect}_z[{stops}];"));
        let current = self.input(Signal::Current);
        self.step(effect, &current);
        let reach = format!("({largest} * k / {})", number(stops as f64));
        let z = format!("s->{effect}_z[k - 1]");
        self.statements.push(format!("for (int k = 1; k <= {stops}; k++) {{"));
        self.statements.push(format!("    {z} = fmin(1.0, fmax(-1.0, {z} + {effect}_step / {reach}));"));
        self.statements.push("}".into());
    }

    /// How far a signal has come since the last call.
    fn step(&mut self, effect: &str, x: &str) {
        self.states.push(format!("double {effect}_last;"));
        self.statements.push(format!("double {effect}_step = s->started ? {x} - s->{effect}_last : 0.0;"));
        self.statements.push(format!("s->{effect}_last = {x};"));
    }
}
