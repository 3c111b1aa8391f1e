//! The safe state: drive torque off and brake current zero, both verified by reading.

use super::ask::ask;
use super::session::panic_text;
use crate::event::Safe;
use jointbench_instrument::roles::{AlignmentStage, CurrentSource, JointController};
use jointbench_instrument::units::Amperes;
use jointbench_instrument::{Bench, Clock};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Motor speed that counts as rest.
const REST_RAD_S: f64 = 1.0;
/// Share of the rated brake current that counts as zero.
const NO_CURRENT: f64 = 0.02;
/// A remaining current is removed over this time.
const RAMP_S: f64 = 0.5;
const RAMP_STEPS: u32 = 5;
/// Longest time of verification: an unloaded supply may take 0.8 s to fall, and a shaft some time to stop.
const SETTLE_S: f64 = 3.0;
const POLL_S: f64 = 0.05;

/// Result of securing, with notes for users.
#[derive(Debug, Clone, PartialEq)]
pub struct Secured {
    /// What was verified.
    pub safe: Safe,
    /// What was commanded and what could not be verified, in sentences for the journal.
    pub notes: Vec<String>,
}

/// Removes the drive torque at once, then the brake current, and verifies both. Starts no motion.
///
/// It is the last act of every run, and the first of a server that finds a run without an end. It works on any bench
/// in any state. A lost joint does not prevent the ramp of the brake, and a panic in one driver does not prevent
/// securing the other instrument.
pub fn secure(bench: &mut Bench) -> Secured {
    let clock = bench.clock.clone();
    let rated_a = bench.constants.brake_rated_current_a;
    let mut notes = Vec::new();
    // Both are commanded before either is verified, because the brake must not wait until the shaft has stopped.
    let disarmed = catch_panic(&mut notes, |notes| disarm(bench.joint.as_mut(), notes)).unwrap_or(false);
    let unloaded = bench.brake.as_mut().map(|brake| {
        catch_panic(&mut notes, |notes| remove_current(brake.as_mut(), &*clock, rated_a, notes)).unwrap_or(false)
    });
    if let Some(stage) = &mut bench.stage {
        catch_panic(&mut notes, |notes| hold_stage(stage.as_mut(), notes));
    }
    let mut safe = catch_panic(&mut notes, |notes| verify_joint(bench.joint.as_mut(), &*clock, disarmed, notes))
        .unwrap_or(Safe::UnsafeUnknown);
    if let (Some(brake), Some(unloaded)) = (&mut bench.brake, unloaded) {
        let brake = catch_panic(&mut notes, |notes| verify_brake(brake.as_mut(), &*clock, rated_a, unloaded, notes));
        safe = safe.max(brake.unwrap_or(Safe::UnsafeUnknown));
    }
    tracing::info!(bench = bench.name, %safe, "bench secured");
    Secured { safe, notes }
}

fn catch_panic<T>(notes: &mut Vec<String>, work: impl FnOnce(&mut Vec<String>) -> T) -> Option<T> {
    let worked = catch_unwind(AssertUnwindSafe(|| work(notes)));
    worked
        .map_err(|panic| {
            notes.push(format!("internal error while securing, please report it: {}", panic_text(&*panic)));
        })
        .ok()
}

/// Returns whether the command was accepted.
fn disarm(joint: &mut dyn JointController, notes: &mut Vec<String>) -> bool {
    let disarmed = ask(joint, |joint| joint.disarm(), |_| {});
    if let Err(fault) = &disarmed {
        notes.push(format!("Drive torque could not be switched off: {fault}"));
    }
    disarmed.is_ok()
}

/// Returns whether the commands were accepted.
fn remove_current(brake: &mut dyn CurrentSource, clock: &dyn Clock, rated_a: f64, notes: &mut Vec<String>) -> bool {
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

/// Stops a moving stage at its position.
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
        // A silent instrument already had its second request in `ask`.
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
