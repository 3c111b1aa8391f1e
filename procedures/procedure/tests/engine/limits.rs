//! Limits in the engine: no command that violates a limit is sent, and no measured violation continues.

use crate::fakes::{Call, Fakes, World};
use crate::ledger::{loaded_plan, play};
use jointbench_instrument::limits::Limited;
use jointbench_instrument::roles::Regulation;
use jointbench_procedure::profile::Profile;
use jointbench_procedure::*;

/// Two seconds into the run the world shows a forbidden state.
fn check_trips(what: &str, show: fn(&mut World)) -> crate::ledger::FinishedRun {
    let (fakes, mut bench) = Fakes::new(move |_, world| {
        if (102.0..103.0).contains(&world.now_s) {
            show(world);
        }
        Ok(())
    });
    let done = play(&fakes, &mut bench, &loaded_plan(), |_| {});
    assert_eq!(done.end.state, RunState::Failed, "{what}");
    let reason = done.end.reason.as_deref().unwrap();
    assert!(reason.contains(what), "{what}: {reason}");
    assert!(done.end.duration_s < 8.0, "{what}: {} s", done.end.duration_s);
    assert_eq!(done.end.safe, Safe::SafeVerified, "{what}: {:?}", done.ledger.notes());
    done
}

#[test]
fn every_limit_trips_in_mid_run() {
    type Show = fn(&mut World);
    let cases: [(Limited, Show); 4] = [
        (Limited::MotorVelocity, |world| world.velocity_rad_s = 210.0),
        (Limited::MotorCurrent, |world| world.current_a = -8.1),
        (Limited::LinkTorque, |world| world.torque_nm = f64::NAN),
        (Limited::Temperature, |world| world.temperature_c = Some(81.0)),
    ];
    for (quantity, show) in cases {
        let done = check_trips(quantity.name(), show);
        let reported = done
            .ledger
            .events()
            .any(|event| matches!(event.kind, EventKind::Breach { breach } if breach.quantity == quantity));
        assert!(reported, "{}", quantity.name());
        // Drive torque off first: no set-point between the violation and the disarming.
        let last = done.world.commands(|call| matches!(call, Call::SetVelocity(_) | Call::Disarm));
        let disarmed_s = last.iter().find(|(_, call)| *call == Call::Disarm).map(|(at_s, _)| *at_s);
        let breach = done.ledger.events().find(|event| matches!(event.kind, EventKind::Breach { .. }));
        assert_eq!(disarmed_s, breach.map(|event| 100.0 + event.at_s), "{}", quantity.name());
    }
}

#[test]
fn a_joint_that_leaves_its_range_is_stopped() {
    check_trips("beyond the range", |world| world.position_rad = 31.0 * crate::fakes::RATIO);
}

#[test]
fn a_supply_that_cannot_hold_the_current_is_noticed() {
    let (fakes, mut bench) = Fakes::new(|_, world| {
        world.regulation = if world.now_s > 101.0 { Regulation::ConstantVoltage } else { Regulation::ConstantCurrent };
        Ok(())
    });
    let done = play(&fakes, &mut bench, &loaded_plan(), |_| {});
    done.check_safe(RunState::Failed);
    assert!(done.end.reason.unwrap().contains("does not reach 0.400 A"));
}

#[test]
fn a_plan_beyond_a_limit_never_arms() {
    let too_fast = |plan: &mut Plan| plan.steps[3].velocity = Profile::plateau(201.0, 400.0, 1.0);
    let too_strong = |plan: &mut Plan| plan.steps[1].brake = Profile::constant(0.61);
    let too_far = |plan: &mut Plan| plan.steps[3].velocity = Profile::plateau(150.0, 400.0, 11.0);
    let from_speed = |plan: &mut Plan| plan.steps[0].velocity = Profile::constant(10.0);
    for (spoil, text) in [
        (&too_fast as &dyn Fn(&mut Plan), "motor velocity 201 rad/s exceeds the limit of 200 rad/s"),
        (&too_strong, "brake current 0.61 A exceeds the limit of 0.6 A"),
        (&too_far, "link travel"),
        (&from_speed, "rest"),
    ] {
        let mut plan = loaded_plan();
        spoil(&mut plan);
        let (fakes, mut bench) = Fakes::quiet();
        let done = play(&fakes, &mut bench, &plan, |_| {});
        done.check_safe(RunState::Failed);
        let reason = done.end.reason.unwrap();
        assert!(reason.starts_with("not started") && reason.contains(text), "{reason}");
        assert!(done.world.commands(|call| matches!(call, Call::Arm)).is_empty());
    }
}

#[test]
fn a_start_too_near_the_stop_is_refused() {
    let (fakes, mut bench) = Fakes::quiet();
    fakes.change(|world| world.position_rad = 25.0 * crate::fakes::RATIO);
    let done = play(&fakes, &mut bench, &loaded_plan(), |_| {});
    assert!(done.end.reason.unwrap().contains("towards the centre of the range"));
}

/// The plan lets the brake current fall before the shaft turns: the guard refuses, and the command is never sent.
#[test]
fn the_brake_does_not_fall_at_standstill() {
    let mut plan = loaded_plan();
    plan.steps[2].brake = Profile::constant(0.1);
    let (fakes, mut bench) = Fakes::quiet();
    let done = play(&fakes, &mut bench, &plan, |_| {});
    done.check_safe(RunState::Failed).check_no_cogging();
    assert!(done.end.reason.unwrap().contains("cogging"));
    assert!(done.world.commands(|call| *call == Call::SetCurrent(0.1)).is_empty());
}

/// The guard rejects, before it is sent, what the dry run cannot predict.
#[test]
fn a_set_point_that_is_not_a_number_is_never_sent() {
    let mut plan = loaded_plan();
    plan.steps[1].velocity = Profile::from(0.0).hold(0.5).to(f64::NAN, 1.0).to(0.0, 1.0);
    let (fakes, mut bench) = Fakes::quiet();
    bench.constants.link_range_rad = None;
    let done = play(&fakes, &mut bench, &plan, |_| {});
    done.check_safe(RunState::Failed);
    let reason = done.end.reason.unwrap();
    assert!(reason.starts_with("command refused: motor velocity NaN"), "{reason}");
    assert!(done.world.commands(|call| matches!(call, Call::SetVelocity(v) if v.is_nan())).is_empty());
}
