//! The safe state itself: drive torque off, brake current gone, both read back.

use super::ask::ask;
use super::session::panic_text;
use crate::event::Safe;
use jointbench_instrument::roles::{AlignmentStage, CurrentSource, JointController};
use jointbench_instrument::units::Amperes;
use jointbench_instrument::{Bench, Clock};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Motor-side speed that counts as rest.
const REST_RAD_S: f64 = 1.0;
/// Share of the rated brake current that counts as none.
const NO_CURRENT: f64 = 0.02;
/// A current that is still there at the end is taken away over this time.
const RAMP_S: f64 = 0.5;
const RAMP_STEPS: u32 = 5;
/// An unloaded supply may take 0.8 s to fall, and a shaft some time to run out: read back for this long.
const SETTLE_S: f64 = 3.0;
const POLL_S: f64 = 0.05;

/// What securing has reached, and what a person should know about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Secured {
    pub safe: Safe,
    pub notes: Vec<String>,
}

/// Takes the drive torque away at once, then the brake current, and reads both back. Starts no movement.
///
/// The last act of every run, and the first of a server that finds a run it did not end. Works on any bench in any
/// state; a lost joint does not keep the brake from being ramped down, nor a panic in one driver the other instrument
/// from being secured.
pub fn secure(bench: &mut Bench) -> Secured {
    let clock = bench.clock.clone();
    let rated_a = bench.constants.brake_rated_current_a;
    let mut notes = Vec::new();
    // Both are commanded before either is read back: a brake must not wait for a shaft that runs out.
    let disarmed = survive(&mut notes, |notes| disarm(bench.joint.as_mut(), notes)).unwrap_or(false);
    let unloaded = bench.brake.as_mut().map(|brake| {
        survive(&mut notes, |notes| take_current_away(brake.as_mut(), &*clock, rated_a, notes)).unwrap_or(false)
    });
    if let Some(stage) = &mut bench.stage {
        survive(&mut notes, |notes| hold_stage(stage.as_mut(), notes));
    }
    let mut safe = survive(&mut notes, |notes| verify_joint(bench.joint.as_mut(), &*clock, disarmed, notes))
        .unwrap_or(Safe::UnsafeUnknown);
    if let (Some(brake), Some(unloaded)) = (&mut bench.brake, unloaded) {
        let brake = survive(&mut notes, |notes| verify_brake(brake.as_mut(), &*clock, rated_a, unloaded, notes));
        safe = safe.max(brake.unwrap_or(Safe::UnsafeUnknown));
    }
    tracing::info!(bench = bench.name, %safe, "bench secured");
    Secured { safe, notes }
}

fn survive<T>(notes: &mut Vec<String>, work: impl FnOnce(&mut Vec<String>) -> T) -> Option<T> {
    let worked = catch_unwind(AssertUnwindSafe(|| work(notes)));
    worked
        .map_err(|panic| {
            notes.push(format!("internal error while securing, please report it: {}", panic_text(&*panic)));
        })
        .ok()
}

/// Whether the command was accepted.
fn disarm(joint: &mut dyn JointController, notes: &mut Vec<String>) -> bool {
    let disarmed = ask(joint, |joint| joint.disarm(), |_| {});
    if let Err(fault) = &disarmed {
        notes.push(format!("Drive torque could not be switched off: {fault}"));
    }
    disarmed.is_ok()
}

/// Whether the commands were accepted.
fn take_current_away(brake: &mut dyn CurrentSource, clock: &dyn Clock, rated_a: f64, notes: &mut Vec<String>) -> bool {
    let before = ask(brake, |brake| brake.read(), |_| {}).map(|reading| reading.current.0);
    if before.is_err() {
        notes.push(
            "The brake current could not be read and was switched off immediately. Demagnetise the brake before \
                    the next run."
                .into(),
        );
    }
    if let Ok(before_a) = before
        && before_a > NO_CURRENT * rated_a
    {
        notes.push(format!(
            "The brake current fell from {before_a:.3} A with the drive off. Demagnetise the brake before the next run."
        ));
        for step in (0..RAMP_STEPS).rev() {
            let current_a = before_a * f64::from(step) / f64::from(RAMP_STEPS);
            if ask(brake, |brake| brake.set_current(Amperes(current_a)), |_| {}).is_err() {
                break;
            }
            clock.sleep_until_s(clock.now_s() + RAMP_S / f64::from(RAMP_STEPS));
        }
    }
    let off = ask(brake, |brake| brake.output_off(), |_| {});
    if let Err(fault) = &off {
        notes.push(format!("The brake supply could not be switched off: {fault}"));
    }
    off.is_ok()
}

/// A stage on its way stops where it is.
fn hold_stage(stage: &mut dyn AlignmentStage, notes: &mut Vec<String>) {
    let held = match ask(stage, |stage| stage.is_settled(), |_| {}) {
        Ok(true) => Ok(()),
        _ => ask(stage, |stage| stage.stop(), |_| {}),
    };
    if let Err(fault) = held {
        notes.push(format!("The stage could not be stopped: {fault}"));
    }
}

fn verify_joint(joint: &mut dyn JointController, clock: &dyn Clock, disarmed: bool, notes: &mut Vec<String>) -> Safe {
    let deadline_s = clock.now_s() + SETTLE_S;
    loop {
        let health = ask(joint, |joint| joint.health(), |_| {});
        let speed = ask(joint, |joint| joint.read(), |_| {}).map(|reading| reading.motor_velocity.0.abs());
        let (what, reached) = match (&health, &speed) {
            (Ok(health), Ok(speed_rad_s)) if !health.armed && *speed_rad_s <= REST_RAD_S => return Safe::SafeVerified,
            (Ok(health), _) if health.armed => ("The drive still reports torque.".to_owned(), Safe::UnsafeUnknown),
            (Ok(_), Ok(speed_rad_s)) => {
                (format!("The shaft still turns at {speed_rad_s:.1} rad/s (motor)."), Safe::UnsafeUnknown)
            }
            (Ok(_), Err(fault)) => (format!("The speed of the shaft could not be read: {fault}"), Safe::SafeCommanded),
            (Err(fault), _) if disarmed => (format!("The drive could not be read back: {fault}"), Safe::SafeCommanded),
            (Err(fault), _) => (format!("The drive does not answer: {fault}"), Safe::UnsafeUnknown),
        };
        // A silent instrument had its second chance in `ask`.
        if health.is_err() || speed.is_err() || clock.now_s() >= deadline_s {
            notes.push(what);
            return reached;
        }
        clock.sleep_until_s(clock.now_s() + POLL_S);
    }
}

fn verify_brake(
    brake: &mut dyn CurrentSource,
    clock: &dyn Clock,
    rated_a: f64,
    unloaded: bool,
    notes: &mut Vec<String>,
) -> Safe {
    let deadline_s = clock.now_s() + SETTLE_S;
    loop {
        match ask(brake, |brake| brake.read(), |_| {}) {
            Ok(reading) if reading.current.0.abs() <= NO_CURRENT * rated_a => return Safe::SafeVerified,
            Ok(reading) if clock.now_s() >= deadline_s => {
                let current_a = reading.current.0;
                notes.push(format!("The brake supply still delivers {current_a:.3} A ({:?}).", reading.regulation));
                return Safe::UnsafeUnknown;
            }
            Ok(_) => clock.sleep_until_s(clock.now_s() + POLL_S),
            Err(fault) => {
                notes.push(format!("The brake supply could not be read back: {fault}"));
                return if unloaded { Safe::SafeCommanded } else { Safe::UnsafeUnknown };
            }
        }
    }
}
