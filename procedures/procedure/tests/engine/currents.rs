//! Steps with a motor current: stopped after a breakaway, checked by the guard, and ended safely by every ending.

use crate::fakes::{Call, FRICTION_A, Fakes};
use crate::ledger::{FinishedRun, loaded_plan, play, play_with};
use jointbench_procedure::plan::{Drive, EndCondition, Feedforward};
use jointbench_procedure::profile::Profile;
use jointbench_procedure::*;
use std::sync::mpsc::channel;

/// One step: 0.5 s of rest, then a current that rises by 0.2 A/s.
fn ramp_plan(top_a: f64) -> Plan {
    let mut plan = loaded_plan();
    plan.steps.truncate(1);
    let step = &mut plan.steps[0];
    (step.velocity, step.brake) = (Profile::from(0.0).hold(0.5), Profile::constant(0.0));
    let current_a = Profile::from(0.0).to(top_a, top_a / 0.2);
    step.drive = Drive::Current { from_s: 0.5, current_a, until: EndCondition { increases: 5, speed_rad_s: 10.0 } };
    plan
}

fn largest_a(done: &FinishedRun) -> f64 {
    let currents = done.world.commands(|call| matches!(call, Call::SetMotorCurrent(_)));
    let value = |(_, call): &(f64, Call)| if let Call::SetMotorCurrent(a) = call { *a } else { 0.0 };
    currents.iter().map(value).fold(0.0, f64::max)
}

#[test]
fn a_joint_that_breaks_away_is_caught() {
    let (fakes, mut bench) = Fakes::new(|_, _| Ok(()));
    let done = play(&fakes, &mut bench, &ramp_plan(2.0), |_| {});
    done.check_safe(RunState::Completed);
    let top_a = largest_a(&done);
    assert!((FRICTION_A..FRICTION_A + 0.02).contains(&top_a), "up to {top_a} A");
    let table = done.ledger.table();
    let setpoint = table.column("motor_current_setpoint_a").unwrap();
    assert_eq!(setpoint.iter().copied().fold(0.0, f64::max), top_a);
    // The velocity loop controls the joint again at once.
    let last = done.world.commands(|call| matches!(call, Call::SetVelocity(_) | Call::SetMotorCurrent(_)));
    assert_eq!(last.last().map(|(_, call)| *call), Some(Call::SetVelocity(0.0)));
}

#[test]
fn a_ramp_that_is_too_weak_ends_by_itself() {
    let (fakes, mut bench) = Fakes::new(|_, _| Ok(()));
    let done = play(&fakes, &mut bench, &ramp_plan(0.4), |_| {});
    done.check_safe(RunState::Completed);
    assert!((largest_a(&done) - 0.4).abs() < 1e-3);
    assert!(done.world.position_rad.abs() < 1e-9);
}

#[test]
fn a_current_beyond_the_limit_never_arms() {
    let (fakes, mut bench) = Fakes::new(|_, _| Ok(()));
    let done = play(&fakes, &mut bench, &ramp_plan(9.0), |_| {});
    assert_eq!(done.end.state, RunState::Failed);
    assert!(done.world.commands(|call| matches!(call, Call::Arm)).is_empty());
}

#[test]
fn a_ramp_is_made_again_from_its_rest_after_a_pause_and_left_by_an_abort() {
    for (control, state) in [(Control::Pause, RunState::Completed), (Control::Abort, RunState::Aborted)] {
        let (sender, controls) = channel();
        let mut due = vec![(4.5, Control::Resume), (1.5, control)];
        let held = sender.clone();
        let (fakes, mut bench) = Fakes::new(move |_, world| {
            while let Some((_, control)) = due.pop_if(|(at_s, _)| world.now_s >= 100.0 + *at_s) {
                // A run that has ended ignores controls.
                let _ = sender.send(control.into());
            }
            Ok(())
        });
        let done = play_with(&fakes, &mut bench, &ramp_plan(2.0), &controls, |_| {});
        drop(held);
        done.check_safe(state);
        if state == RunState::Completed {
            let table = done.ledger.table();
            let (segment, current) =
                (table.column("segment").unwrap(), table.column("motor_current_setpoint_a").unwrap());
            let second = segment.iter().position(|s| *s != segment[0]).unwrap();
            assert!(current[second] == 0.0 && current[second - 1] > 0.1, "again from no current");
        }
    }
}

#[test]
fn feedforward_current_is_recorded_with_the_velocity() {
    let (fakes, mut bench) = Fakes::new(|_, _| Ok(()));
    let mut plan = loaded_plan();
    plan.steps.truncate(1);
    plan.steps[0].brake = Profile::constant(0.0);
    plan.steps[0].drive = Drive::Fed(Feedforward::Planned(Profile::from(0.0).to(0.8, 0.5)));
    let done = play(&fakes, &mut bench, &plan, |_| {});
    done.check_safe(RunState::Completed);
    let table = done.ledger.table();
    let last = table.column("motor_current_setpoint_a").unwrap().last().copied();
    assert_eq!(last, Some(0.8));
    assert!(table.column("velocity_setpoint_rad_s").unwrap().contains(&100.0));
}
