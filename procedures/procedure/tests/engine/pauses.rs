//! Pause and resume at every step.

use crate::fakes::{Call, Fakes, RATIO};
use crate::ledger::{loaded_plan, middles_s, play_controlled, play_with};
use jointbench_procedure::plan::InitialState;
use jointbench_procedure::profile::Profile;
use jointbench_procedure::*;
use std::sync::mpsc::channel;

#[test]
fn every_step_survives_a_pause() {
    let plan = loaded_plan();
    for (step, at_s) in middles_s(&plan).into_iter().enumerate() {
        let done = play_controlled(&[(at_s, Control::Pause), (at_s + 3.0, Control::Resume)]);
        done.check_safe(RunState::Completed).check_no_cogging();
        let paused = [RunState::Running, RunState::Paused, RunState::Running];
        assert!(done.ledger.states().windows(3).any(|states| states == paused));

        // The interrupted attempt keeps its number, the repeated one has a new number and is complete.
        let table = done.ledger.table();
        let rows = |segment: usize| {
            table.column("segment").unwrap().iter().filter(|found| **found == segment as f64).count() as f64
        };
        let whole = plan.steps[step].duration_s() * plan.rate_hz;
        let repeated = plan.steps.len();
        assert!((rows(repeated) - whole).abs() <= 2.0, "step {step}: {} of {whole} rows", rows(repeated));
        assert!((rows(step) - 0.5 * whole).abs() <= 4.0, "step {step}: {} of half {whole} rows", rows(step));

        // It begins at the start of the step, so that the run ends at the planned position.
        let segments = table.column("segment").unwrap();
        let first_of = |number: usize| segments.iter().position(|found| *found == number as f64).unwrap();
        let position_rad = table.column("motor_position_rad").unwrap();
        let off_rad = position_rad[first_of(repeated)] - position_rad[first_of(step)];
        assert!(off_rad.abs() < 0.5, "step {step} begins {off_rad} rad off");
        assert!(done.world.position_rad.abs() < 0.1 * RATIO, "ends at {}", done.world.position_rad);
    }
}

#[test]
fn a_pause_holds_still_and_keeps_the_brake() {
    let at_s = middles_s(&loaded_plan())[2];
    let done = play_controlled(&[(at_s, Control::Pause), (at_s + 5.0, Control::Resume)]);
    let during = |at_s: f64, from_s: f64| (100.0 + from_s + 0.5..100.0 + from_s + 4.9).contains(&at_s);
    for (moment_s, call) in &done.world.log {
        if during(*moment_s, at_s) {
            assert!(matches!(call, Call::SetVelocity(0.0)), "{call:?} at {moment_s}");
        }
    }
    let seen = done.ledger.table();
    let gap_s = seen.column("time_s").unwrap().windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    assert!(gap_s > 4.5, "rows of the pause are not kept: {gap_s}");
}

#[test]
fn a_paused_run_can_be_stopped_or_aborted() {
    for (control, state) in
        [(Control::Stop, RunState::Stopped), (Control::Abort, RunState::Aborted), (Control::EStop, RunState::Aborted)]
    {
        let at_s = middles_s(&loaded_plan())[1];
        let done = play_controlled(&[(at_s, Control::Pause), (at_s + 2.0, control)]);
        done.check_safe(state);
        assert_eq!(done.ledger.states()[2], RunState::Paused);
    }
}

#[test]
fn the_estimate_of_the_rest_leaves_the_pause_out() {
    let plan = loaded_plan();
    let at_s = middles_s(&plan)[1];
    let done = play_controlled(&[(at_s, Control::Pause), (at_s + 60.0, Control::Resume)]);
    let most_s = done.ledger.progress.iter().map(|progress| progress.remaining_s).fold(0.0, f64::max);
    assert!(most_s <= plan.duration_s() + 0.1, "{most_s} s remaining of {} s", plan.duration_s());
}

#[test]
fn every_attempt_is_one_unbroken_segment() {
    // The second pause occurs during the return of the first.
    let controls = [0.5, 2.0, 7.0, 12.0].map(|at_s| [(at_s, Control::Pause), (at_s + 0.8, Control::Resume)]);
    let done = play_controlled(controls.as_flattened());
    done.check_safe(RunState::Completed).check_no_cogging();
    let table = done.ledger.table();
    let mut stretches = table.column("segment").unwrap().to_vec();
    stretches.dedup();
    let count = stretches.len();
    stretches.sort_by(f64::total_cmp);
    stretches.dedup();
    let pauses = done.ledger.states().iter().filter(|state| **state == RunState::Paused).count();
    assert_eq!(pauses, 4);
    assert_eq!((stretches.len(), count), (8, 8), "{stretches:?}");
}

#[test]
fn a_resume_takes_back_a_pause_that_was_not_yet_granted() {
    let done = play_controlled(&[(1.0, Control::Pause), (1.0, Control::Resume)]);
    done.check_safe(RunState::Completed);
    assert!(!done.ledger.states().contains(&RunState::Paused));
    assert!(done.end.duration_s < loaded_plan().duration_s() + 0.5, "{} s", done.end.duration_s);
}

/// A sweep requires a brake without history: resuming demagnetises it before the sweep begins again at zero current.
#[test]
fn a_sweep_begins_again_with_a_demagnetised_brake() {
    let mut plan = loaded_plan();
    plan.steps.truncate(1);
    plan.steps[0].before = InitialState::Demagnetised;
    plan.steps[0].velocity = Profile::plateau(100.0, 400.0, 5.0);
    plan.steps[0].brake = Profile::from(0.0).hold(0.3).to(0.5, 0.0).hold(1.5).to(0.2, 0.0).hold(1.5).to(0.0, 0.0);
    let (sender, controls) = channel();
    let held = sender.clone();
    let mut due = vec![(3.0, Control::Resume), (1.2, Control::Pause)];
    let (fakes, mut bench) = Fakes::new(move |_, world| {
        while let Some((_, control)) = due.pop_if(|(at_s, _)| world.now_s >= 100.0 + *at_s) {
            // A run that has ended ignores controls.
            let _ = sender.send(control.into());
        }
        Ok(())
    });
    let done = play_with(&fakes, &mut bench, &plan, &controls, |_| {});
    drop(held);
    done.check_safe(RunState::Completed).check_no_cogging();
    let table = done.ledger.table();
    let column = |name: &str| table.column(name).unwrap();
    let (segment, command) = (column("segment"), column("brake_torque_command_nm"));
    let second = segment.iter().position(|s| *s != segment[0]).unwrap();
    assert!(command[second - 1] > 1.0 && command[second] == 0.0, "{} {}", command[second - 1], command[second]);
    // Before that the current fell in many small steps, not at once.
    let falls = done.world.commands(|call| matches!(call, Call::SetCurrent(a) if *a > 0.0 && *a < 0.5 && *a != 0.2));
    assert!(falls.len() >= 5, "{falls:?}");
}
