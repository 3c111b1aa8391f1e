//! Measurements in steps: steady-state stretches of constant speed and load, divided into chunks.
//!
//! The response and every signal are averaged over chunks of about 40 ms. This reduces noise, excludes hysteresis,
//! and attenuates a periodic effect at speed exactly as its data. Ramps and reversals are kept separate, because
//! signals of different instruments are not aligned there and friction has hysteresis.

use crate::preprocess::chunks::{CHUNK_S, Layout, MOST_ROWS, Source, problem};
use crate::preprocess::design::{blocks, segments};
use crate::preprocess::friction::unmeasured_gravity;
use crate::preprocess::{Prepared, Problem};
use crate::signal::Signal;
use crate::stats::summary::{mean, median, peak};
use crate::thresholds::{KEPT_SHARE, NOISE_ERRORS, SAME_LENGTH, SAME_LEVEL, SETTLED_SHARE, SMALL_LEVEL, STEADY_SPEED};
use crate::{ModelError, Options};
use jointbench_instrument::RunTable;
use rayon::prelude::*;
use std::ops::Range;

/// Length of a chunk where the speed changes [s].
const MOVING_CHUNK_S: f64 = 0.02;
/// Chunks around a reversal in which the jerk is set to zero.
const REACH: usize = 3;
/// Largest number of rows around reversals; of a longer run only some pairs of segments are used.
const MOST_MOVING_ROWS: usize = 8_000;
/// Least number of crossings of the median for an oscillation; the arc of a swing has fewer.
const WAVERS: usize = 4;

/// The steady-state stretch of every segment that has one.
pub fn find(samples: &Source, gear_ratio: f64, options: &Options) -> Vec<Range<usize>> {
    let n = samples.chunk(options.chunk_s.unwrap_or(CHUNK_S));
    let velocity = samples.signals.find(Signal::Velocity).unwrap_or_default();
    let load = samples.signals.find(Signal::Load);
    let heaviest = load.map_or(0.0, peak);
    let link_s = n as f64 * samples.step_s / gear_ratio.abs();
    samples.legs().into_par_iter().filter_map(|leg| settled(leg, velocity, load, heaviest, (n, link_s))).collect()
}

/// Rejects a stretch whose load changes by more than the link motion can cause (`link_s` for each rad/s of the
/// motor). Such a load twists the joint without sliding.
fn settled(
    leg: Range<usize>,
    velocity: &[f64],
    load: Option<&[f64]>,
    heaviest: f64,
    (n, link_s): (usize, f64),
) -> Option<Range<usize>> {
    let means = |signal: &[f64]| -> Vec<f64> {
        signal[leg.clone()].chunks_exact(n).map(|c| c.iter().sum::<f64>() / n as f64).collect()
    };
    let speed = means(velocity);
    if speed.len() < 6 {
        return None;
    }
    let second_half = speed.len() / 2..speed.len() - 1;
    let target = median(speed[second_half.clone()].iter().copied());
    let scatter = 1.5 * median(speed[second_half.clone()].iter().map(|v| (v - target).abs()));
    let crossings = speed[second_half.clone()].windows(2).filter(|w| (w[0] > target) != (w[1] > target)).count();
    let steady = if crossings >= WAVERS { STEADY_SPEED / 2.0 } else { STEADY_SPEED };
    if target.abs() < steady * scatter || target == 0.0 {
        return None;
    }
    let within = (SETTLED_SHARE * target.abs()).max(5.0 * scatter);
    let mut steady: Vec<bool> = speed.iter().map(|v| (v - target).abs() <= within).collect();
    let load = load.map(means);
    if let Some(load) = &load {
        let held = median(load[second_half.clone()].iter().copied());
        let scatter = 1.5 * median(load[second_half.clone()].iter().map(|v| (v - held).abs()));
        let within = (SETTLED_SHARE * heaviest).max(5.0 * scatter);
        steady.iter_mut().zip(load).for_each(|(s, l)| *s &= (l - held).abs() <= within);
    }
    let longest = segments::stretches(&steady).into_iter().filter(|r| steady[r.start]).max_by_key(Range::len)?;
    // Before that the speed may still approach its set point.
    let kept = longest.start.max(second_half.start).min(longest.end)..longest.end;
    let changes = |of: &[f64]| {
        let (first, second) = of[kept.clone()].split_at(kept.len() / 2);
        (mean(second) - mean(first)).abs()
    };
    let by_chance = NOISE_ERRORS * scatter * (4.0 / kept.len() as f64).sqrt();
    let way_rad = target.abs() * link_s * kept.len() as f64 / 2.0;
    let winds_up = load.is_some_and(|load| changes(&load) > (SETTLED_SHARE + way_rad) * heaviest);
    if winds_up || changes(&speed) > KEPT_SHARE * target.abs() + by_chance {
        return None;
    }
    // The start is skipped, because hysteresis from the ramp persists there.
    let skip = 2 + longest.len() / 20;
    let (start, end) = (longest.start + skip, longest.end.min(speed.len()));
    (end >= start + 3).then(|| leg.start + start * n..leg.start + end * n)
}

pub fn prepare(
    run: &RunTable,
    samples: Source,
    plateaus: Vec<Range<usize>>,
    options: &Options,
) -> Result<Prepared, ModelError> {
    let n = samples.chunk(options.chunk_s.unwrap_or(CHUNK_S));
    let layout = layout(&samples, &plateaus, run, n)?;
    let speed = |p: &Range<usize>| {
        median(samples.signals.find(Signal::Velocity).unwrap_or_default()[p.clone()].iter().map(|v| v.abs()))
    };
    let slowest = plateaus.iter().map(speed).fold(f64::INFINITY, f64::min);
    let settled = || {
        let mut main = problem(&samples, layout);
        set_drive(&mut main);
        main.view.constants.weight = unmeasured_gravity::unmeasured(&main.view.points, &main.target);
        main
    };
    let apart = |fastest| apart(&samples, &plateaus, fastest);
    let checks = || {
        (crate::preprocess::checks::unit_mismatch::data_errors(run), crate::preprocess::checks::metadata::warnings(run))
    };
    let ((main, (data_errors, warnings)), (moving, memory)) =
        rayon::join(|| rayon::join(settled, checks), || rayon::join(|| apart(f64::INFINITY), || apart(slowest)));
    let repeats = main.repeat.iter().max().copied().unwrap_or(0) > main.repeat.iter().min().copied().unwrap_or(0);
    let about = samples.preparation_of_chunks(n, run, &main, if repeats { "column" } else { "none" });
    Ok(Prepared { data_errors, warnings, moving, memory, ..Prepared::of(run, main, about) })
}

/// The chunks of all steady states, of `n` samples each or of several times that in a long run.
fn layout(
    samples: &Source,
    plateaus: &[Range<usize>],
    run: &RunTable,
    n: usize,
) -> Result<Layout<'static>, ModelError> {
    let legs = samples.legs();
    let mut chunks = Vec::new();
    let mut group = Vec::new();
    let mut phase = Vec::new();
    let merge = plateaus.iter().map(|p| p.len() / n).sum::<usize>().div_ceil(MOST_ROWS);
    for (number, plateau) in plateaus.iter().enumerate() {
        let leg = legs.partition_point(|l| l.start <= plateau.start).saturating_sub(1);
        let before = (plateau.start - legs.get(leg).map_or(plateau.start, |l| l.start)) / n;
        // At least two, so that neighbours in different repeats can be compared.
        let parts = (plateau.len() / n).div_ceil(merge).max(2);
        for part in 0..parts {
            let edge = |part: usize| plateau.start + plateau.len() / n * part / parts * n;
            chunks.push(edge(part)..edge(part + 1));
            group.push(number);
            phase.push(before / merge + part);
        }
    }
    if chunks.len() < 12 {
        return Err(ModelError::TooFewSamples { usable: chunks.len(), needed: 12, what: "chunks at steady speed" });
    }
    let condition = conditions(samples, plateaus, run.column("brake_torque_command_nm"));
    let condition: Vec<usize> = group.iter().map(|g| condition[*g]).collect();
    Ok(Layout { chunks, group, condition, phase: Some(phase), settled: true, inputs: &[] })
}

/// Sets the drive torque of steady-state or moving rows.
pub fn set_drive(problem: &mut Problem) {
    let drive = crate::preprocess::friction::drive(&problem.view.points, &problem.target);
    problem.view.points.set(Signal::Drive, drive);
}

/// Steady states of the same speed, direction and load are one condition.
pub fn conditions(samples: &Source, plateaus: &[Range<usize>], command: Option<&[f64]>) -> Vec<usize> {
    let middle = |signal: &[f64], p: &Range<usize>| median(signal[p.clone()].iter().copied());
    let velocity = samples.signals.find(Signal::Velocity).unwrap_or_default();
    let speeds: Vec<f64> = plateaus.iter().map(|p| middle(velocity, p)).collect();
    let lengths: Vec<f64> = plateaus.iter().map(|p| p.len() as f64).collect();
    let middles = |signal: &[f64]| -> Vec<f64> { plateaus.iter().map(|p| middle(signal, p)).collect() };
    let measured = samples.signals.find(Signal::Load);
    let loads = command.or(measured).map_or_else(|| vec![0.0; plateaus.len()], middles);
    // Without a load, the load signal is noise and small compared with the torque.
    let peak = match command {
        Some(_) => peak(&loads),
        None => peak(&loads).max(peak(&middles(&samples.target))),
    };
    let speed = blocks::clusters(&speeds, |v| SAME_LEVEL * v.abs());
    let load = blocks::clusters(&loads, |l| SAME_LEVEL * l.abs() + SMALL_LEVEL * peak);
    // Short steps and long turns at one speed are different conditions, because they start at different positions.
    let length = blocks::clusters(&lengths, |l| SAME_LENGTH * l);
    let mut known: Vec<(usize, usize, usize)> = (0..plateaus.len()).map(|i| (length[i], load[i], speed[i])).collect();
    let each = known.clone();
    known.sort_unstable();
    known.dedup();
    each.iter().map(|c| known.binary_search(c).unwrap_or(0)).collect()
}

/// Short chunks of motion that is not steady and not faster than `fastest`.
fn apart(samples: &Source, plateaus: &[Range<usize>], fastest: f64) -> Option<Problem> {
    let n = samples.chunk(MOVING_CHUNK_S);
    let velocity = samples.signals.find(Signal::Velocity).unwrap_or_default();
    let mut settled = vec![false; samples.time_s.len()];
    plateaus.iter().for_each(|p| settled[p.clone()].fill(true));
    let mut chunks = Vec::new();
    for (number, leg) in samples.legs().into_iter().enumerate() {
        for start in (leg.start..(leg.end + 1).saturating_sub(n)).step_by(n) {
            let mean = velocity[start..start + n].iter().sum::<f64>() / n as f64;
            if mean.abs() <= fastest && !settled[start..start + n].iter().any(|s| *s) {
                chunks.push((number, start..start + n));
            }
        }
    }
    // Multiples of the golden ratio are spread evenly, independent of the order of the profile.
    let share = MOST_MOVING_ROWS as f64 / chunks.len() as f64;
    chunks.retain(|(leg, _)| ((leg / 2) as f64 * 0.618_033_988_749_895).fract() < share);
    let (group, chunks): (Vec<usize>, Vec<Range<usize>>) = chunks.into_iter().unzip();
    if chunks.len() < 50 {
        return None;
    }
    let (samples, chunks) = samples.around(chunks);
    let layout = Layout { chunks, condition: group.clone(), group, phase: None, settled: false, inputs: &[] };
    let mut moving = problem(&samples, layout);
    set_drive(&mut moving);
    still_at_turns(&mut moving, REACH * n);
    Some(moving)
}

/// Sets the jerk to zero around reversals. A delayed friction torque jumps there, by far more than the jerk explains.
/// The jerk counts only if no reversal is within some samples.
fn still_at_turns(moving: &mut Problem, reach: usize) {
    let view = &mut moving.view;
    let direction = view.samples.find(Signal::Direction).unwrap_or_default();
    let mut turns = vec![0u32];
    turns.extend(direction.windows(2).scan(0, |turns, d| {
        *turns += u32::from(d[0] != d[1]);
        Some(*turns)
    }));
    let at = |sample: usize| turns[sample.min(direction.len().saturating_sub(1))];
    let turning = |c: &Range<usize>| at(c.start.saturating_sub(reach)) != at(c.end + reach);
    let jerk = view.get(Signal::Jerk).iter().zip(&view.chunks);
    let still = jerk.map(|(jerk, chunk)| if turning(chunk) { 0.0 } else { *jerk }).collect();
    view.points.set(Signal::Jerk, still);
}
