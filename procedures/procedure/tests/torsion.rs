//! Monitor of the torsion: a healthy joint passes, a damaged one ends its run.

use jointbench_devices::sim::{MockInstrument, PlannedTrouble, Trouble};
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_instrument::{Bench, TorsionLimit};
use jointbench_procedure::in_memory_run::run_in_memory;
use jointbench_procedure::procedure;
use serde_json::Map;

/// Compliance of the data sheet: bearing and joint in series.
const JOINT_A: TorsionLimit = TorsionLimit { compliance_rad_per_nm: 1.812e-4, tolerance_rad: 2e-3 };
const JOINT_B: TorsionLimit = TorsionLimit { compliance_rad_per_nm: 1.4746e-3, tolerance_rad: 4e-3 };

fn start(settings: MockSettings, torsion: TorsionLimit) -> (MockBench, Bench) {
    let mock = MockBench::start(settings).unwrap();
    let bench = Bench { torsion: Some(torsion), ..mock.open_bench("bench").unwrap() };
    (mock, bench)
}

/// Joint whose coupling slips 20 s after the start.
fn slipping(joint: Joint) -> MockSettings {
    let (instrument, trouble) = (MockInstrument::Joint, Trouble::CouplingSlips);
    let slip = PlannedTrouble { instrument, trouble, from_s: 20.0, until_s: None };
    MockSettings { troubles: vec![slip], ..MockSettings::new(joint, 3) }
}

/// The reason that ends the run, if one does.
fn reason(bench: &mut Bench, id: &str) -> Option<String> {
    run_in_memory(bench, procedure(id).unwrap(), &Map::new()).err().map(|fault| fault.to_string())
}

#[test]
fn a_healthy_joint_passes_loads_reversals_and_breakaway() {
    let ids = ["stiffness", "friction", "friction_load", "breakaway", "presliding", "brake_speed_independence"];
    std::thread::scope(|scope| {
        for (joint, torsion) in [(Joint::JointA, JOINT_A), (Joint::JointB, JOINT_B)] {
            scope.spawn(move || {
                let (_mock, mut bench) = start(MockSettings::new(joint, 3), torsion);
                for id in ids {
                    assert_eq!(reason(&mut bench, id), None, "{joint:?}: {id}");
                }
            });
        }
    });
}

#[test]
fn a_slipping_coupling_ends_the_run_before_a_tenth_of_a_radian() {
    for (joint, torsion) in [(Joint::JointA, JOINT_A), (Joint::JointB, JOINT_B)] {
        let (_mock, mut bench) = start(slipping(joint), torsion);
        let reason = reason(&mut bench, "stiffness").expect("the run ends");
        assert!(reason.contains("limit exceeded: the torsion of the joint has changed by"), "{reason}");
        let changed: f64 =
            reason.split(" mrad").next().and_then(|head| head.rsplit(' ').next()).unwrap().parse().unwrap();
        assert!(changed.abs() < 100.0, "{reason}");
        assert!(!bench.joint.health().unwrap().armed);
        assert!(bench.clock.now_s() < 60.0, "{} s", bench.clock.now_s());
    }
}

/// Without the monitor, a run over a slipping coupling goes on to its end.
#[test]
fn a_slipping_coupling_is_not_noticed_without_the_monitor() {
    let (_mock, mut bench) = start(slipping(Joint::JointB), JOINT_B);
    bench.torsion = None;
    assert_eq!(reason(&mut bench, "stiffness"), None);
}

/// A joint that has become twice as soft since its identification.
#[test]
fn a_changed_stiffness_ends_the_run_under_load() {
    let before = TorsionLimit { compliance_rad_per_nm: 0.5 * JOINT_B.compliance_rad_per_nm, ..JOINT_B };
    let (_mock, mut bench) = start(MockSettings::new(Joint::JointB, 3), before);
    let reason = reason(&mut bench, "stiffness").expect("the run ends");
    assert!(reason.contains("check the coupling, the gear and both encoders"), "{reason}");
}
