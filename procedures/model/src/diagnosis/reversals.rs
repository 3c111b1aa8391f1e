//! Residual of a steady-state model directly after a reversal.

use crate::regression::two_stage_model::TwoStageModel;
use crate::report::fit::Fit;
use crate::report::maps::Region;
use crate::residual_analysis::maps::regions::ReferenceMagnitude;
use crate::signal::Signal;
use crate::stats::{student, summary};
use crate::words::figure;

/// Difference between measured and predicted friction within `reach` of a reversal. The interval is Student's t over
/// the reversals. `None` with fewer than three.
pub fn region(model: &TwoStageModel, reach: f64, fit: &Fit, reference: Option<&ReferenceMagnitude>) -> Option<Region> {
    let problem = model.prepared.memory.as_ref()?;
    let samples = &problem.view.samples;
    let (position, direction) = (samples.find(Signal::Position)?, samples.find(Signal::Direction)?);
    let turns: Vec<usize> = (1..direction.len()).filter(|i| direction[*i] != direction[i - 1]).collect();
    let residual: Vec<f64> = problem.target.iter().zip(model.predict(problem)).map(|(y, p)| y - p).collect();
    let mut of_turn = vec![(0.0, 0usize); turns.len()];
    for (chunk, e) in problem.view.chunks.iter().zip(residual) {
        let Some(turn) = turns.partition_point(|t| *t <= chunk.start).checked_sub(1) else { continue };
        let way = (position[(chunk.start + chunk.end) / 2] - position[turns[turn]]).abs();
        if way < reach {
            let (sum, count) = &mut of_turn[turn];
            (*sum, *count) = (*sum + e * direction[chunk.start], *count + 1);
        }
    }
    let samples = of_turn.iter().map(|t| t.1).sum();
    let means: Vec<f64> = of_turn.iter().filter(|t| t.1 > 0).map(|(sum, count)| sum / *count as f64).collect();
    let mean = summary::mean(&means);
    let t = student::t95(means.len() as f64 - 1.0).filter(|_| means.len() >= 3)?;
    let half_width = t * summary::standard_error(&means);
    let side = if mean > 0.0 { "low" } else { "high" };
    let measure = reference.map_or_else(String::new, |y| format!(", {}", y.compare(mean.abs())));
    let angle = model.prepared.column_unit(Signal::Position);
    Some(Region {
        axis: "way_since_reversal_rad".into(),
        from: 0.0,
        to: reach,
        mean_residual: mean,
        ci95: [mean - half_width, mean + half_width],
        samples,
        direction: None,
        sentence: format!(
            "the friction of the model is {} too {side} within {} after a reversal{measure}",
            figure(mean.abs(), &fit.unit),
            figure(reach, &angle),
        ),
    })
}
