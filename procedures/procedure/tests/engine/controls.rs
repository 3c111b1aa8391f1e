//! Stop, abort and software stop at every step and at any time.

use crate::fakes::Call;
use crate::ledger::{FinishedRun, loaded_plan, middles_s, play_controlled, play_controlled_at};
use jointbench_procedure::profile::Profile;
use jointbench_procedure::*;
use proptest::prelude::*;

/// Bench time from the control to the last non-zero set-point.
fn moved_on_s(done: &FinishedRun, from_s: f64) -> f64 {
    let moving = done.world.commands(|call| matches!(call, Call::SetVelocity(v) if *v != 0.0));
    moving.last().map_or(0.0, |(at_s, _)| at_s - 100.0 - from_s)
}

#[test]
fn stop_unloads_the_brake_while_turning() {
    for at_s in middles_s(&loaded_plan()) {
        let done = play_controlled(&[(at_s, Control::Stop)]);
        done.check_safe(RunState::Stopped).check_no_cogging();
        assert_eq!(done.end.reason.as_deref(), Some("stopped by the operator"));
        assert!(!done.ledger.notes().iter().any(|note| note.contains("Demagnetise")), "{:?}", done.ledger.notes());
    }
}

#[test]
fn abort_comes_to_rest_within_its_ramp() {
    for (step, at_s) in middles_s(&loaded_plan()).into_iter().enumerate() {
        let done = play_controlled(&[(at_s, Control::Abort)]);
        done.check_safe(RunState::Aborted).check_no_cogging();
        assert!(moved_on_s(&done, at_s) <= 0.5, "{} s", moved_on_s(&done, at_s));
        let setpoints = done.world.commands(|call| matches!(call, Call::SetVelocity(_)));
        let values: Vec<f64> = setpoints.iter().map(|(_, call)| speed_of(call)).collect();
        let jump = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        // A step may end one and a half ticks before its last set-point, at rest.
        assert!(jump <= 2.41, "a ramp of 400 rad/s² moves 1.6 rad/s in a tick, not {jump}");
        assert_eq!(values.last(), Some(&0.0));
        // No supply answers in time for a fall during rotation: the remanence of the brake is reported.
        let brake = done.world.commands(|call| matches!(call, Call::SetCurrent(_) | Call::Disarm));
        let held = brake.iter().take_while(|(_, call)| *call != Call::Disarm).last();
        let reported = match held {
            Some((_, Call::SetCurrent(a))) if *a > 0.0 => format!("fell from {a:.3} A with the drive off. Demagnetise"),
            _ => String::new(),
        };
        let falls = brake.iter().filter(|(sent_s, call)| *sent_s > 100.0 + at_s + 0.1 && *call != Call::Disarm).count();
        let notes = done.ledger.notes().join("; ");
        assert!(
            notes.contains(&reported) && reported.is_empty() != notes.contains("Demagnetise"),
            "step {step}: {notes}"
        );
        assert_eq!(falls, if reported.is_empty() { 0 } else { 5 }, "step {step}: {brake:?}");
    }
}

#[test]
fn a_daemon_that_is_terminated_aborts_and_reports_it() {
    let at_s = middles_s(&loaded_plan())[2];
    let [reported, asked] = [Control::Quit, Control::Abort].map(|control| play_controlled(&[(at_s, control)]));
    reported.check_safe(RunState::Aborted).check_no_cogging();
    assert_eq!(moved_on_s(&reported, at_s), moved_on_s(&asked, at_s));
    assert_eq!(reported.end.reason.as_deref(), Some("aborted because the daemon was shut down"));
}

fn speed_of(call: &Call) -> f64 {
    match call {
        Call::SetVelocity(velocity_rad_s) => *velocity_rad_s,
        other => panic!("{other:?} sets no velocity"),
    }
}

#[test]
fn the_software_stop_disarms_at_once() {
    for at_s in middles_s(&loaded_plan()) {
        let done = play_controlled(&[(at_s, Control::EStop)]);
        done.check_safe(RunState::Aborted);
        let disarmed = done.world.commands(|call| *call == Call::Disarm);
        assert!(disarmed[0].0 - 100.0 - at_s <= 0.01, "{disarmed:?} after {at_s}");
    }
}

#[test]
fn an_abort_hurries_a_stop() {
    let at_s = middles_s(&loaded_plan())[2];
    let done = play_controlled(&[(at_s, Control::Stop), (at_s + 0.5, Control::Abort)]);
    done.check_safe(RunState::Stopped).check_no_cogging();
    assert!(moved_on_s(&done, at_s) <= 1.2, "{} s", moved_on_s(&done, at_s));
}

/// The supply accepts ten commands in a second: if the last one would find the shaft at rest, the current stays.
#[test]
fn an_abort_on_the_way_to_rest_drops_no_current_at_standstill() {
    for rate_hz in [50.0, 250.0] {
        for later in 0..60 {
            let at_s = 0.84 + 0.01 * f64::from(later);
            let done = play_controlled_at(rate_hz, &[(0.84, Control::Pause), (at_s, Control::Abort)]);
            done.check_safe(RunState::Aborted).check_no_cogging();
        }
    }
}

#[test]
fn a_control_that_does_not_fit_is_reported_and_changes_nothing() {
    let done = play_controlled(&[(0.5, Control::Resume)]);
    done.check_safe(RunState::Completed);
    assert!(done.ledger.notes().contains(&"a run that is running cannot resume"));
}

#[test]
fn a_dropped_sender_of_controls_is_a_stop() {
    let (fakes, mut bench) = crate::fakes::Fakes::quiet();
    let (sender, controls) = std::sync::mpsc::channel();
    drop(sender);
    let done = crate::ledger::play_with(&fakes, &mut bench, &loaded_plan(), &controls, |_| {});
    done.check_safe(RunState::Stopped);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any sequence of controls at any times and any rate: the run ends, secured, its states legal and its table
    /// valid.
    #[test]
    fn any_history_ends_safely(
        history in prop::collection::vec((0.0..20.0, 0usize..6), 0..8),
        rate_hz in prop::sample::select(vec![50.0, 250.0, 1000.0]),
    ) {
        let all = [Control::Pause, Control::Resume, Control::Stop, Control::Abort, Control::Quit, Control::EStop];
        let mut controls: Vec<_> = history.iter().map(|(at_s, pick)| (*at_s, all[*pick])).collect();
        // The run must not stay paused.
        controls.push((21.0, Control::Resume));
        controls.push((60.0, Control::Abort));
        let done = play_controlled_at(rate_hz, &controls);
        prop_assert!(done.end.state.is_final());
        prop_assert_eq!(done.end.safe, Safe::SafeVerified);
        prop_assert!(done.world.is_safe());
        if !controls.iter().any(|(_, control)| *control == Control::EStop) {
            done.check_no_cogging();
        }
        if done.end.rows > 0 {
            prop_assert_eq!(done.ledger.table().len() as u64, done.end.rows);
        }
    }
}

/// Too slow to demagnetise: the brake current is not removed at standstill while the drive could still turn the
/// shaft, and no time is spent on a turn that never ends.
#[test]
fn a_creeping_plan_is_stopped_without_speeding_up() {
    let (fakes, mut bench) = crate::fakes::Fakes::quiet();
    let mut plan = loaded_plan();
    plan.steps.truncate(1);
    plan.steps[0].velocity = Profile::plateau(4.0, 400.0, 3.0);
    plan.steps[0].brake = Profile::from(0.0).to(0.3, 1.0);
    let done = crate::ledger::play(&fakes, &mut bench, &plan, |_| {});
    done.check_safe(RunState::Completed).check_no_cogging();
    assert!(done.end.duration_s < 6.0, "{} s", done.end.duration_s);
    let fastest = done.world.commands(|call| matches!(call, Call::SetVelocity(v) if v.abs() > 4.0));
    assert!(fastest.is_empty(), "{fastest:?}");
    assert!(done.ledger.notes().iter().any(|note| note.contains("Demagnetise")));
}
