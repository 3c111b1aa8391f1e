//! The steady state of every leg as one point, for figures and lines.

use jointbench_instrument::RunTable;
use jointbench_model::preprocess::{Prepared, prepare};
use jointbench_model::signal::Signal;
use jointbench_model::{ModelError, Options, ResidualKind};

/// Means over the steady state of one segment, as preprocessed by the model.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Plateau {
    pub segment: i64,
    pub time_s: f64,
    pub velocity_rad_s: f64,
    /// Response of the models of this kind: motor torque, torsion, braking torque.
    pub target: f64,
    /// Friction: τ_link/N (Nm). Stiffness: τ_link (Nm).
    pub load_nm: f64,
    pub temperature_c: f64,
    pub link_rad: f64,
    chunks: f64,
}

/// Preprocesses a run for its steady states.
pub(crate) fn settled(run: &RunTable) -> Result<Prepared, ModelError> {
    prepare(run, &Options { residual: Some(ResidualKind::PlateauMean), ..Options::default() })
}

/// Steady states of a run preprocessed by [`settled`], in its order. A segment without a steady state has none.
pub(crate) fn plateaus(prepared: &Prepared) -> Vec<Plateau> {
    let (problem, view) = (&prepared.main, &prepared.main.view);
    let mut plateaus: Vec<Plateau> = Vec::new();
    for row in 0..problem.rows() {
        let segment = problem.segment[row];
        if plateaus.last().is_none_or(|last| last.segment != segment) {
            plateaus.push(Plateau { segment, ..Plateau::default() });
        }
        let last = plateaus.len() - 1;
        let point = &mut plateaus[last];
        point.chunks += 1.0;
        point.time_s += view.get(Signal::Time)[row];
        point.velocity_rad_s += view.get(Signal::Velocity)[row];
        point.target += problem.target[row];
        point.load_nm += view.get(Signal::Load)[row];
        point.temperature_c += view.get(Signal::Temperature)[row];
        point.link_rad += view.get(Signal::Link)[row];
    }
    for point in &mut plateaus {
        let Plateau { time_s, velocity_rad_s, target, load_nm, temperature_c, link_rad, chunks, .. } = point;
        for sum in [time_s, velocity_rad_s, target, load_nm, temperature_c, link_rad] {
            *sum /= *chunks;
        }
    }
    plateaus
}
