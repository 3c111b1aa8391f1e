//! Tables of a few rows for the unit tests of the rules.

use crate::preprocess::checks::unit_mismatch::DataErrors;
use crate::preprocess::memo::Memo;
use crate::preprocess::{Prepared, Problem, Reduce};
use crate::regression::candidates::CandidateSet;
use crate::regression::linear_model::{LinearModel, Term};
use crate::regression::partial_regression::PartialRegression;
use crate::report::fit::Preparation;
use crate::selection::acceptance::Candidate;
use crate::selection::acceptance::formula_error::AcceptanceThreshold;
use crate::selection::floating_search::FloatingSearch;
use crate::signal::{Signal, Signals};
use crate::view::View;
use crate::{ModelSpec, Options, ResidualKind};
use jointbench_instrument::{Channel, Kind, Meta, Motion, RunTable, Trace};
use std::collections::HashSet;
use std::f64::consts::TAU;

/// Legs of a table. Each has one speed, and is one block.
const LEGS: usize = 32;
/// Rows of a leg.
const ROWS: usize = 6;

/// One row of a table.
#[derive(Clone, Copy)]
pub struct Row {
    /// Number of its leg.
    pub leg: usize,
    /// 2, 4, …, 16 rad/s, in both directions.
    pub velocity: f64,
    pub direction: f64,
    /// Angle of motor and link [rad]; every leg covers a turn.
    pub angle: f64,
    /// Scatter of about ±1 that no effect explains.
    pub scatter: f64,
    /// The same for a whole leg.
    pub leg_scatter: f64,
    /// An offset that wanders over the legs.
    pub walk: f64,
}

fn scatter(of: usize) -> f64 {
    (12.9898 * of as f64 + 1.0).sin() * (78.233 * of as f64).cos()
}

fn row(at: usize) -> Row {
    let leg = at / ROWS;
    let direction = if leg.is_multiple_of(2) { 1.0 } else { -1.0 };
    let speed = 2.0 * (leg / 2 % 8 + 1) as f64;
    let angle = TAU * ((at % ROWS) as f64 + leg as f64 / LEGS as f64) / ROWS as f64;
    Row {
        leg,
        velocity: direction * speed,
        direction,
        angle,
        scatter: scatter(at),
        leg_scatter: scatter(1000 + leg),
        walk: 2.0 * (0.45 * leg as f64).sin(),
    }
}

fn prepared(kind: Kind, main: Problem) -> Prepared {
    let about = Preparation {
        residual: ResidualKind::PlateauMean,
        sample_rate_hz: 2.0,
        cutoff_hz: None,
        velocity_lag_s: None,
        decimation: 1,
        bristles: None,
        chunk_s: None,
        samples: main.rows(),
        rows: main.rows(),
        blocks: LEGS,
        segments_from: "column".into(),
        repeats_from: "none".into(),
    };
    Prepared {
        kind,
        motion: Motion::Rotary,
        baseline: Vec::new(),
        main,
        bristled: None,
        moving: None,
        memory: None,
        load_scale: 1.0,
        constants: Vec::new(),
        data_errors: DataErrors::default(),
        warnings: Vec::new(),
        about,
        excluded: Vec::new(),
    }
}

/// A table with its model and options.
pub struct Tiny {
    pub prepared: Prepared,
    pub options: Options,
    spec: ModelSpec,
}

impl Tiny {
    /// A table in legs of constant speed, at 25 °C, with the effects of its model.
    pub fn new(kind: Kind, effects: &[&str], target: impl Fn(Row) -> f64) -> Self {
        Self::warmed(kind, effects, |_| 25.0, target)
    }

    /// The same with a temperature [°C].
    pub fn warmed(kind: Kind, effects: &[&str], temperature: impl Fn(Row) -> f64, target: impl Fn(Row) -> f64) -> Self {
        Self::with(kind, effects, 1.0, temperature, target)
    }

    /// The same at 25 °C, where every leg covers this part of a turn.
    pub fn over(turns: f64, kind: Kind, effects: &[&str], target: impl Fn(Row) -> f64) -> Self {
        Self::with(kind, effects, turns, |_| 25.0, target)
    }

    fn with(
        kind: Kind,
        effects: &[&str],
        turns: f64,
        temperature: impl Fn(Row) -> f64,
        target: impl Fn(Row) -> f64,
    ) -> Self {
        let of_turn = |row: Row| Row { angle: turns * row.angle, ..row };
        let rows: Vec<Row> = (0..LEGS * ROWS).map(|at| of_turn(row(at))).collect();
        let mut signals = Signals::new(rows.len());
        signals.set(Signal::Time, (0..rows.len()).map(|at| 0.5 * at as f64).collect());
        signals.set(Signal::Velocity, rows.iter().map(|row| row.velocity).collect());
        signals.set(Signal::Direction, rows.iter().map(|row| row.direction).collect());
        signals.set(Signal::Position, rows.iter().map(|row| row.angle).collect());
        signals.set(Signal::Link, rows.iter().map(|row| row.angle).collect());
        signals.set(Signal::Temperature, rows.iter().map(|row| temperature(*row)).collect());
        let main = Problem {
            view: View::new(signals.clone(), signals, (0..rows.len()).map(|at| at..at + 1).collect(), vec![0], 0.5),
            target: rows.iter().map(|row| target(*row)).collect(),
            sampled: Vec::new().into(),
            reduce: Reduce::Same,
            block: rows.iter().map(|row| row.leg).collect(),
            blocks: LEGS,
            fold: rows.iter().map(|row| row.leg % 8).collect(),
            folds: 8,
            replicate_pairs: Vec::new(),
            different_history: HashSet::new(),
            different_angle: HashSet::new(),
            different_motion: None,
            segment: rows.iter().map(|row| row.leg as i64).collect(),
            repeat: vec![0; rows.len()],
            settled: kind == Kind::Friction,
            form_error: None,
            bandwidths: Vec::new(),
            memo: Memo::default(),
        };
        let prepared = prepared(kind, main);
        let spec = ModelSpec::new(kind, effects.iter().copied()).expect("known effects");
        Self { prepared, options: Options::default(), spec }
    }

    /// Whether a rule accepts an effect in its first form, with these nonlinear parameters.
    pub fn passes(&self, rule: fn(&Candidate) -> bool, id: &str, shape: Vec<f64>) -> bool {
        let (now, term, partial) = (self.model(), self.term(id, shape), self.partial());
        let own = partial.orthogonalized(&term.columns).share;
        let threshold = AcceptanceThreshold { plain: partial.sse, kind: self.prepared.kind, options: &self.options };
        rule(&Candidate { term: &term, share: own, now: &now, partial: &partial, threshold })
    }

    /// The effect that a rule removes from the model with these added effects.
    pub fn removed(
        &self,
        added: &[&str],
        rule: impl for<'l, 'p> FnOnce(&FloatingSearch<'l, 'p>) -> Option<&'p str>,
    ) -> Option<String> {
        let library = CandidateSet::new(&self.spec, &self.prepared.main, self.prepared.regimes());
        let mut search = FloatingSearch::new(self.model(), &library, &self.prepared, 4, &self.options);
        for id in added {
            search.now = search.model_with(self.spec.find(id).expect("a known effect").info().id);
        }
        rule(&search).map(str::to_owned)
    }

    /// The model.
    pub fn model(&self) -> LinearModel<'_> {
        let mut model = LinearModel::new(&self.prepared.main);
        model.terms = self.spec.effects.iter().map(|id| self.term(id, Vec::new())).collect();
        model
    }

    /// An effect in its first form, with these nonlinear parameters.
    pub fn term(&self, id: &str, shape: Vec<f64>) -> Term<'_> {
        let effect = self.spec.find(id).expect("a known effect");
        let form = effect.forms(&self.prepared.main.view).into_iter().next().expect("a form");
        Term::new(effect, form, shape, &self.prepared.main)
    }

    /// What the model leaves.
    pub fn partial(&self) -> PartialRegression {
        PartialRegression::of(&self.model())
    }
}

/// A run in steps of 2 to 16 rad/s in both directions at 250 Hz, with Coulomb, viscous and inertia torque. The torque is
/// late by some rows, and the direction of friction follows the motion over a displacement [rad].
pub fn staircase(coulomb_nm: f64, late: usize, displacement: f64) -> RunTable {
    const STEP_S: f64 = 0.004;
    let speed_of = |leg: usize| 2.0 * (leg / 2 % 8 + 1) as f64 * if leg.is_multiple_of(2) { 1.0 } else { -1.0 };
    let (mut motion, mut torques) = (Vec::new(), Vec::new());
    let (mut position, mut velocity, mut direction) = (0.0, 0.0, 0.0_f64);
    for leg in 0..32 {
        let from = velocity;
        for at in 0..500 {
            let target = from + (speed_of(leg) - from) * (f64::from(at) * STEP_S / 0.4).min(1.0);
            let acceleration = (target - velocity) / STEP_S;
            velocity = target;
            position += velocity * STEP_S;
            direction += velocity * STEP_S / displacement.max(1e-3) * (1.0 - direction * velocity.signum());
            direction = if displacement > 0.0 { direction } else { velocity.signum() };
            motion.push(position);
            let noise = 1e-3 * scatter(motion.len());
            torques.push(coulomb_nm * direction + 0.001 * velocity + 2e-4 * acceleration + noise);
        }
    }
    let mut trace = Trace::new(["time_s", "motor_position_rad", "motor_current_a"].map(Channel::new).to_vec());
    for (at, position) in motion.iter().enumerate() {
        trace.push_row(&[STEP_S * at as f64, *position, torques[at.saturating_sub(late)] / 0.08]);
    }
    let kind = Some(Kind::Friction);
    RunTable::new(Meta { kind, torque_constant_nm_per_a: Some(0.08), ..Meta::default() }, trace).expect("a valid run")
}
