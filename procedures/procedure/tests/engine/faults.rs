//! Instruments that miss a reply, are lost or panic.

use crate::fakes::{Call, Fakes, Role, World};
use crate::ledger::{FinishedRun, loaded_plan, play};
use jointbench_instrument::FaultKind;
use jointbench_procedure::*;

fn silent() -> FaultKind {
    FaultKind::Silent { request: "f 0".into(), deadline_ms: 20 }
}

fn lost() -> FaultKind {
    FaultKind::Disconnected { what: "input/output error".into() }
}

fn scripted(script: impl FnMut(Call, &mut World) -> Result<(), FaultKind> + Send + 'static) -> FinishedRun {
    let (fakes, mut bench) = Fakes::new(script);
    play(&fakes, &mut bench, &loaded_plan(), |_| {})
}

/// From two seconds into the run, while `when` returns true, the instrument of a role does not answer.
fn failing(role: Role, kind: fn() -> FaultKind, when: fn(&Call) -> bool) -> FinishedRun {
    scripted(
        move |call, world| {
            if world.now_s >= 102.0 && call.role() == role && when(&call) { Err(kind()) } else { Ok(()) }
        },
    )
}

#[test]
fn one_missed_reply_is_asked_for_again() {
    for role in [Role::Joint, Role::Torque, Role::Brake] {
        let mut missed = false;
        let done = scripted(move |call, world| {
            if world.now_s >= 102.0 && call.role() == role && !missed {
                missed = true;
                return Err(silent());
            }
            Ok(())
        });
        done.check_safe(RunState::Completed).check_no_cogging();
        let faults: Vec<_> = done
            .ledger
            .events()
            .filter_map(|event| match &event.kind {
                EventKind::Fault { fault, recovered } => Some((fault.instrument.clone(), *recovered)),
                _ => None,
            })
            .collect();
        assert!(matches!(&faults[..], [(_, true)]), "{faults:?}");
        assert_eq!(done.world.commands(|call| *call == Call::Recover(role)).len(), 1);
    }
}

#[test]
fn a_link_that_keeps_missing_is_given_up() {
    let mut odd = false;
    let done = scripted(move |call, world| {
        if world.now_s >= 102.0 && world.armed && call == Call::ReadJoint {
            odd = !odd;
            if odd {
                return Err(silent());
            }
        }
        Ok(())
    });
    done.check_safe(RunState::Failed);
    assert!(done.end.reason.as_ref().unwrap().contains("replies missing within one step"), "{:?}", done.end.reason);
}

#[test]
fn a_lost_sensor_ends_the_run_safely() {
    let done = failing(Role::Torque, lost, |_| true);
    done.check_safe(RunState::Failed).check_no_cogging();
    assert!(done.end.reason.as_ref().unwrap().contains("torque_sensor on pty1"));
    // The joint still obeys: it stops with its ramp.
    let setpoints = done.world.commands(|call| matches!(call, Call::SetVelocity(_)));
    assert!(setpoints.last().is_some_and(|(at_s, call)| *call == Call::SetVelocity(0.0) && *at_s < 102.5));
    assert!(!done.ledger.notes().iter().any(|note| note.contains("harder")));
}

/// A supply that receives and performs commands, but does not answer any more.
#[test]
fn a_silent_supply_is_switched_off_blindly_while_the_joint_comes_to_rest() {
    let (fakes, mut bench) = Fakes::new(|call, world| {
        if world.now_s >= 102.0 && call.role() == Role::Brake {
            if call == Call::OutputOff {
                world.brake_on = false;
            }
            return Err(silent());
        }
        Ok(())
    });
    let done = play(&fakes, &mut bench, &loaded_plan(), |_| {});
    assert_eq!((done.end.state, done.end.safe), (RunState::Failed, Safe::UnsafeUnknown));
    assert!(done.world.is_safe());
    let setpoints = done.world.commands(|call| matches!(call, Call::SetVelocity(_)));
    assert_eq!(setpoints.last().map(|(_, call)| *call), Some(Call::SetVelocity(0.0)));
}

#[test]
fn with_the_joint_lost_the_brake_is_still_ramped_down() {
    for kind in [silent as fn() -> FaultKind, lost] {
        let done = failing(Role::Joint, kind, |_| true);
        assert_eq!((done.end.state, done.end.safe), (RunState::Failed, Safe::UnsafeUnknown));
        let currents = done.world.commands(|call| matches!(call, Call::SetCurrent(_)));
        let ramp = &currents[currents.len() - 5..];
        assert!(ramp.windows(2).all(|pair| pair[1].0 > pair[0].0), "{ramp:?}");
        assert_eq!(ramp[4].1, Call::SetCurrent(0.0));
        assert!(!done.world.brake_on);
    }
}

#[test]
fn with_the_brake_lost_the_drive_is_still_switched_off() {
    let done = failing(Role::Brake, lost, |_| true);
    assert_eq!((done.end.state, done.end.safe), (RunState::Failed, Safe::UnsafeUnknown));
    assert!(!done.world.armed);
}

#[test]
fn nothing_answers() {
    let done = scripted(|_, world| if world.now_s >= 102.0 { Err(lost()) } else { Ok(()) });
    assert_eq!((done.end.state, done.end.safe), (RunState::Failed, Safe::UnsafeUnknown));
    assert!(done.end.duration_s < 10.0, "{} s", done.end.duration_s);
    let reported = done.ledger.events().any(|event| event.kind == EventKind::Safe { safe: Safe::UnsafeUnknown });
    assert!(reported);
}

#[test]
fn commands_that_cannot_be_read_back_are_only_commanded() {
    let done = scripted(|call, world| {
        let ended = !world.armed && world.now_s > 105.0;
        if ended && matches!(call, Call::Health) { Err(silent()) } else { Ok(()) }
    });
    assert_eq!((done.end.state, done.end.safe), (RunState::Completed, Safe::SafeCommanded));
}

#[test]
fn a_drive_that_contradicts_is_not_safe() {
    let done = scripted(|call, world| {
        // The command is accepted, but the drive stays armed.
        if call == Call::SetVelocity(0.0) && world.now_s > 110.0 {
            world.errors.clear();
        }
        if call == Call::Health && world.now_s > 110.0 {
            world.armed = true;
        }
        Ok(())
    });
    assert_eq!(done.end.safe, Safe::UnsafeUnknown);
    assert!(done.ledger.notes().contains(&"The drive still reports torque."));
}

#[test]
fn a_drive_that_gave_up_is_noticed() {
    let done = scripted(|_, world| {
        if (102.0..102.01).contains(&world.now_s) {
            world.armed = false;
            world.errors = vec!["WATCHDOG_TIMER_EXPIRED".into()];
        }
        Ok(())
    });
    done.check_safe(RunState::Failed);
    assert!(done.end.reason.unwrap().contains("WATCHDOG_TIMER_EXPIRED"));
}

#[test]
fn a_joint_with_an_old_error_does_not_start() {
    let (fakes, mut bench) = Fakes::quiet();
    fakes.change(|world| world.errors = vec!["ENCODER_FAILED".into()]);
    let done = play(&fakes, &mut bench, &loaded_plan(), |_| {});
    done.check_safe(RunState::Failed);
    assert!(done.world.commands(|call| *call == Call::Arm).is_empty());
}

#[test]
fn a_fault_while_arming_fails_the_run() {
    for role in [Role::Joint, Role::Torque, Role::Brake] {
        let done = scripted(move |call, _| if call == Call::Identify(role) { Err(lost()) } else { Ok(()) });
        assert_eq!((done.end.state, done.end.rows), (RunState::Failed, 0));
        assert!(done.world.commands(|call| *call == Call::Arm).is_empty());
    }
}

#[test]
fn a_position_that_is_not_a_number_fails_the_run() {
    let done = scripted(|call, world| {
        if call == Call::ReadJoint && (102.0..102.01).contains(&world.now_s) {
            world.position_rad = f64::NAN;
        }
        Ok(())
    });
    assert_eq!(done.end.state, RunState::Failed);
    assert_eq!(done.ledger.table().len() as u64, done.end.rows);
}

/// A panic may occur in any call of any driver.
#[test]
fn a_panic_passes_the_safe_state() {
    let quiet = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let mut ends = Vec::new();
    for pick in [
        (|call| matches!(call, Call::ReadJoint)) as fn(&Call) -> bool,
        |call| matches!(call, Call::SetVelocity(_)),
        |call| matches!(call, Call::ReadTorque),
        |call| matches!(call, Call::ReadBrake),
        |call| matches!(call, Call::Health),
    ] {
        let mut struck = false;
        ends.push(scripted(move |call, world| {
            if world.now_s >= 102.0 && pick(&call) && !struck {
                struck = true;
                panic!("a driver bug");
            }
            Ok(())
        }));
    }
    let in_disarm = scripted(|call, _| if call == Call::Disarm { panic!("a driver bug") } else { Ok(()) });
    std::panic::set_hook(quiet);

    for done in ends {
        done.check_safe(RunState::Failed);
        assert!(done.end.reason.unwrap().contains("a driver bug"));
    }
    assert_eq!(in_disarm.end.safe, Safe::UnsafeUnknown);
    assert!(!in_disarm.world.brake_on, "the brake is secured all the same");
}

#[test]
fn an_instrument_that_was_exchanged_during_a_run_is_named_at_its_end() {
    let another = || FaultKind::WrongInstrument { expected: "fake 1".into(), found: "fake 2".into() };
    for role in [Role::Joint, Role::Torque, Role::Brake] {
        let done = scripted(move |call, world| match call {
            Call::Identify(asked) if asked == role && world.now_s >= 102.0 => Err(another()),
            _ => Ok(()),
        });
        done.check_safe(RunState::Failed);
        assert!(done.end.reason.as_ref().unwrap().contains("expected fake 1, found fake 2"), "{:?}", done.end.reason);
        let is_noted = |kind: &EventKind| matches!(kind, EventKind::Warning { text } if text.contains("was exchanged during the run"));
        assert_eq!(done.ledger.events().filter(|event| is_noted(&event.kind)).count(), 1, "{role:?}");
    }
}
