//! Friction runs in a closed loop: two masses, a flexible gear, bristles, quantised encoders, observers.

mod bristle;
mod excitation;
mod joint;
mod laws;
mod plant;
mod record;

use super::draw::Plan;
use super::recording::{Part, Recording, written};
use crate::made::Dice;
use joint::{Joint, Load};
use laws::{EFFECTS, Law, Moment, OF_LOAD, OUTSIDE, law};
use record::Rows;
use serde_json::json;

/// Shapes of each candidate that are compared with a hidden effect.
const SHAPES: usize = 5;
const RATES_HZ: [f64; 5] = [100.0, 200.0, 250.0, 500.0, 1000.0];
/// A run is recorded at a rate that gives no more rows.
const MOST_ROWS: f64 = 60_000.0;

pub fn make(dice: &mut Dice) -> Recording {
    let load = Load::draw(dice);
    let effects: Vec<&str> = if load == Load::None { EFFECTS.to_vec() } else { [EFFECTS, OF_LOAD].concat() };
    let plan = Plan::draw(dice, &effects, OUTSIDE);
    let mut joint = Joint::draw(load, &plan, dice);
    let setup = record::setup(&joint, dice);
    joint.last_s = setup.lasts_s();
    let rates: Vec<f64> = RATES_HZ.into_iter().filter(|rate| rate * joint.last_s <= MOST_ROWS).collect();
    joint.rate_hz = *dice.pick(&rates);
    let scale = joint.scale();
    let named: Vec<(&str, Law)> =
        plan.hidden.iter().chain(&plan.outside).map(|id| (*id, law(id, &scale, dice))).collect();
    let offset = (!plan.hides("direction_offset") && !plan.hides("drift") && dice.coin())
        .then(|| law("direction_offset", &scale, dice));
    let always = offset.into_iter().map(|law| ("direction_offset", law));
    let laws: Vec<(&str, Law)> = always.chain(named).collect();
    let rows = record::run(&joint, &setup, laws, dice);
    let alternatives = alternatives(&joint, &plan, &rows.moments, dice);
    recording(&joint, &plan, rows, alternatives)
}

fn alternatives(joint: &Joint, plan: &Plan, moments: &[Moment], dice: &mut Dice) -> Vec<Part> {
    if plan.hidden.is_empty() {
        return Vec::new();
    }
    let scale = joint.scale();
    let shapes = EFFECTS.iter().chain(OF_LOAD).flat_map(|id| [*id; SHAPES]);
    let part = |id| {
        let law = law(id, &scale, dice);
        Part { id, values: moments.iter().map(law).collect() }
    };
    shapes.map(part).filter(|part| part.values.iter().any(|v| *v != 0.0)).collect()
}

fn recording(joint: &Joint, plan: &Plan, rows: Rows, alternatives: Vec<Part>) -> Recording {
    let Rows { columns, moments, torque, laws, lag_s } = rows;
    let part = |id, of: &dyn Fn(&Moment) -> f64| Part { id, values: moments.iter().map(of).collect() };
    let mut base =
        vec![part("inertia", &|m| joint.inertia() * m.acceleration), part("viscous", &|m| joint.oil * m.velocity)];
    let can_absorb = Part { id: "presliding", values: moments.iter().map(|m| m.dry).collect() };
    let has_load = joint.load != Load::None;
    if has_load {
        base.push(part("load_transmission", &|m| m.load));
    }
    let mut ids = vec!["inertia", "coulomb", "viscous"];
    ids.extend(has_load.then_some("load_transmission"));
    let (mut hidden, mut outside) = (Vec::new(), None);
    // Presliding is identified by its difference from instantaneous dry friction.
    if plan.hides("presliding") {
        let jumps = part("coulomb", &|m| joint.dry * m.velocity.signum());
        let values = can_absorb.values.iter().zip(&jumps.values).map(|(b, j)| b - j).collect();
        hidden.push(Part { id: "presliding", values });
        base.push(jumps);
    } else {
        ids.push("presliding");
        base.push(can_absorb);
    }
    for (id, law) in laws.iter().filter(|(id, _)| *id != "presliding") {
        let part = part(id, law);
        match plan.hides(id) {
            true if plan.outside == Some(*id) => outside = Some(part),
            true => hidden.push(part),
            false => {
                ids.push("direction_offset");
                base.push(part);
            }
        }
    }
    let is_delayed = lag_s > 0.0;
    ids.extend(is_delayed.then_some("signal_delay"));
    let facts = json!({"joint": joint.name, "load": joint.load.name(), "repeats": joint.repeats, "bristle": joint.bristle.name(),
        "fs": joint.rate_hz, "duration_s": moments.last().map_or(0.0, |m| m.time), "velocity_lag_ms": 1e3 * lag_s,
        "encoder_bits": joint.bits});
    Recording {
        meta: joint.meta(ids.into_iter().map(String::from).collect()),
        style: joint.style,
        truth: joint.truth(plan, laws.iter().find(|l| l.0 == "direction_offset").map(|l| (l.1)(&Moment::default()))),
        columns: columns.into_iter().map(|(name, c)| (name, c.into_iter().map(written).collect())).collect(),
        response: torque,
        base,
        hidden,
        outside,
        alternatives,
        optional: if is_delayed { Vec::new() } else { vec!["signal_delay"] },
        facts: facts.as_object().cloned().unwrap_or_default(),
    }
}
