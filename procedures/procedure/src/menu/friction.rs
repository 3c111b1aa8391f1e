//! Menu of friction runs: the standard run, short strokes at specific speeds and loads, and a warm-up.

use super::{Menu, rounded};
use jointbench_instrument::RunTable;
use serde_json::{Value, json};

/// Shares of the brake's rated current. Uneven, so that they differ from the loads of the measured run.
const LOADS: [f64; 4] = [0.0, 0.3, 0.5, 0.8];
/// Link side: speeds at which the Stribeck rise is present, and at which it has decayed.
const SLOW_RAD_S: [f64; 2] = [0.008, 0.07];
const FASTEST_RATIO: f64 = 8.0;
const ACCELERATION_RAD_S2: f64 = 400.0;
/// Least dwell time of a stroke.
const HELD_S: f64 = 0.6;
/// Assumed warming of the joint by an hour of work, because it is unknown beforehand (K).
const WARMS_BY_K: f64 = 10.0;
/// Warm-up and cool-down (s).
const WARMING_S: f64 = 240.0;
/// Highest speed without an explicit request (motor).
const USUAL_RAD_S: f64 = 180.0;

pub fn offer(menu: &mut Menu, run: &RunTable) {
    let bench = menu.bench;
    let seed = menu.next_seed();
    let loads = bench.has_brake && bench.has_torque_sensor;
    let mut ordinary = menu.before("friction", json!({"order_seed": seed}));
    ordinary.entry("repeats").or_insert(json!(2));
    ordinary.entry("top_speed_rad_s").or_insert(json!(rounded(menu.top_rad_s().min(USUAL_RAD_S))));
    if !loads {
        ordinary.insert("load_levels".into(), json!(1));
    }
    menu.offer("friction", Value::Object(ordinary));

    let gear = bench.constants.gear_ratio;
    let room_rad = bench.constants.link_range_rad.unwrap_or(0.6).min(0.6);
    let top_rad_s = menu.top_rad_s().min(super::SHARE_OF_LIMIT * fastest_rad_s(room_rad * gear));
    let slow = SLOW_RAD_S.map(|v| (v * gear).min(top_rad_s));
    let ranges = [
        (slow[0], slow[1], 5.0),
        (top_rad_s / FASTEST_RATIO / 2.0, top_rad_s / 2.0, 2.0),
        (top_rad_s / FASTEST_RATIO, top_rad_s, 2.0),
    ];
    for repeats in [2, 4] {
        for load in LOADS.iter().filter(|load| **load == 0.0 || loads) {
            // Under load the wind-up of joint and brake lasts longer than a slow stroke.
            for (low_rad_s, high_rad_s, dwell_s) in ranges.into_iter().skip(usize::from(*load > 0.0)) {
                let acceleration_rad_s2 = if *load > 0.0 {
                    ACCELERATION_RAD_S2
                } else {
                    rounded((high_rad_s / 0.2).min(ACCELERATION_RAD_S2))
                };
                menu.offer(
                    "strokes",
                    json!({
                        "low_speed_rad_s": rounded(low_rad_s), "top_speed_rad_s": rounded(high_rad_s), "speeds": 4, "load": load,
                        "repeats": repeats, "dwell_s": dwell_s, "travel_rad": rounded(room_rad),
                        "acceleration_rad_s2": acceleration_rad_s2, "order_seed": seed,
                    }),
                );
            }
        }
    }
    if run.column("temperature_c").is_some() {
        // As fast as the range of the bench permits.
        let before = menu.choices.len();
        for top_rad_s in [1.0, 0.5, 0.25].map(|part| rounded(part * menu.top_rad_s().min(USUAL_RAD_S))) {
            if menu.choices.len() == before {
                let warming = json!({"top_speed_rad_s": top_rad_s, "heat_s": WARMING_S, "cool_s": WARMING_S});
                menu.offer_warmed("friction_temperature", warming, &warmer_k);
            }
        }
    }
}

/// Three time constants up, and three down.
fn warmer_k(t_s: f64) -> f64 {
    let risen = |t_s: f64| 1.0 - (-3.0 * t_s / WARMING_S).exp();
    WARMS_BY_K * (risen(t_s) - risen((t_s - WARMING_S).max(0.0)))
}

/// The highest speed that a stroke of this length reaches, holds and leaves: `v·t + v²/a = way`.
fn fastest_rad_s(way_rad: f64) -> f64 {
    let half = 0.5 * ACCELERATION_RAD_S2 * HELD_S;
    (half * half + ACCELERATION_RAD_S2 * way_rad).sqrt() - half
}
