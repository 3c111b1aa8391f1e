//! Steady-state stretches of a plan for the model.

use crate::bench_facts::BenchFacts;
use crate::plan::{InitialState, Phase, Plan, Step};
use jointbench_instrument::Kind;
use jointbench_model::{Choice, Stretch};
use serde_json::{Map, Value};

/// The steady-state stretches of a plan, without the warm-up, which may end early.
///
/// `warmer_k`: warming of the joint after a number of seconds.
pub fn choice(
    plan: &Plan,
    parameters: &Map<String, Value>,
    bench: &BenchFacts,
    warmer_k: &dyn Fn(f64) -> f64,
) -> Choice {
    let constants = &bench.constants;
    let (mut start_s, mut at_rad, mut power_ups) = (0.0, 0.0, 0);
    let mut stretches = Vec::new();
    for step in &plan.steps {
        power_ups += u32::from(step.before == InitialState::PoweredAnew);
        let way = step.velocity.integral();
        for (pair, from_rad) in step.velocity.knots().windows(2).zip(&way) {
            let [(held_s, velocity_rad_s), (to_s, end_rad_s)] = [pair[0], pair[1]];
            if velocity_rad_s != end_rad_s || velocity_rad_s == 0.0 || step.phase != Phase::Measure {
                continue;
            }
            for (from_s, to_s) in constant_current(step, held_s, to_s, plan.kind) {
                let brake_current_a = step.brake.at(from_s);
                let brake_nm = constants.brake_rated_torque_nm * brake_current_a / constants.brake_rated_current_a;
                stretches.push(Stretch {
                    start_s: start_s + from_s,
                    duration_s: to_s - from_s,
                    velocity_rad_s,
                    from_rad: at_rad + from_rad + velocity_rad_s * (from_s - held_s),
                    load_nm: brake_nm * velocity_rad_s.signum(),
                    brake_current_a,
                    power_ups,
                    warmer_k: warmer_k(start_s + from_s),
                });
            }
        }
        start_s += step.duration_s();
        at_rad += way.last().unwrap_or(&0.0);
    }
    Choice {
        procedure: plan.procedure.clone(),
        parameters: parameters.clone(),
        duration_s: plan.duration_s(),
        stretches,
    }
}

/// Intervals of a step with a constant brake current. After a change of load a joint is not at steady state before
/// its next step.
fn constant_current(step: &Step, from_s: f64, to_s: f64, kind: Kind) -> Vec<(f64, f64)> {
    let within = step.brake.knots().iter().map(|(t_s, _)| *t_s).filter(|t_s| from_s < *t_s && *t_s < to_s);
    let edges: Vec<f64> = std::iter::once(from_s).chain(within).chain([to_s]).collect();
    let intervals = edges.windows(2).map(|edge| (edge[0], edge[1]));
    let still =
        |(from_s, to_s): &(f64, f64)| to_s > from_s && step.brake.at(*from_s) == step.brake.at(0.5 * (from_s + to_s));
    let still: Vec<_> = intervals.filter(still).collect();
    if kind != Kind::Brake && edges.len() > 2 { Vec::new() } else { still }
}
