//! The safe state for a server that finds a bench in the middle of another process's run.

use crate::fakes::{Call, Fakes};
use jointbench_procedure::{Safe, secure};

#[test]
fn a_bench_left_behind_is_secured_without_moving() {
    let (fakes, mut bench) = Fakes::quiet();
    fakes.change(|world| (world.brake_a, world.brake_on) = (0.4, true));
    let secured = secure(&mut bench);
    assert_eq!(secured.safe, Safe::SafeVerified);
    assert!(secured.notes.iter().any(|note| note.contains("fell from 0.400 A")), "{:?}", secured.notes);
    let world = fakes.world();
    assert!(world.is_safe());
    assert!(world.commands(|call| matches!(call, Call::SetVelocity(_) | Call::Arm)).is_empty());
    assert_eq!(world.log[0].1, Call::Disarm, "drive torque off first");
}

#[test]
fn a_resting_bench_needs_no_note() {
    let (_, mut bench) = Fakes::quiet();
    assert_eq!(secure(&mut bench).notes, Vec::<String>::new());
}

#[test]
fn a_bench_without_brake_or_sensor_can_be_secured() {
    let (_, mut bench) = Fakes::quiet();
    (bench.brake, bench.torque_sensor) = (None, None);
    assert_eq!(secure(&mut bench).safe, Safe::SafeVerified);
}

#[test]
fn a_supply_that_keeps_its_current_is_not_safe() {
    let (fakes, mut bench) = Fakes::new(|call, world| {
        if matches!(call, Call::ReadBrake) {
            (world.brake_on, world.brake_a) = (true, 0.3);
        }
        Ok(())
    });
    assert_eq!(secure(&mut bench).safe, Safe::UnsafeUnknown);
    assert!(!fakes.world().armed);
}
