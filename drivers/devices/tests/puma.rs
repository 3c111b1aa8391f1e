//! The Puma axis through its driver: its readings, its motion and its troubles.

use jointbench_devices::protocol::puma::memory;
use jointbench_devices::sim::{MockInstrument, Transport, Trouble};

use jointbench_devices::{Joint, MockBench, MockSettings, PumaGains};
use jointbench_instrument::units::{Amperes, RadPerSec};
use jointbench_instrument::{Bench, Fault, FaultKind};

const TICK_S: f64 = 0.01;

fn start(transport: Transport, effects: &[&str]) -> (MockBench, Bench) {
    let settings = MockSettings { transport, deadline_ms: 400, ..MockSettings::new(Joint::Puma, 3) };
    let mock = MockBench::start(settings.hiding(effects)).unwrap();
    let mut bench = mock.open_bench("puma").unwrap();
    bench.joint.arm(RadPerSec(120.0), Amperes(5.0)).unwrap();
    (mock, bench)
}

fn wait(bench: &Bench, seconds: f64) {
    bench.clock.sleep_until_s(bench.clock.now_s() + seconds);
}

/// Means over the second half of a stretch at constant speed: velocity, current, position.
fn hold(bench: &mut Bench, velocity_rad_s: f64, seconds: f64) -> [f64; 3] {
    let ticks = (seconds / TICK_S) as usize;
    let mut sums = [0.0; 3];
    for tick in 0..ticks {
        bench.joint.set_velocity(RadPerSec(velocity_rad_s)).unwrap();
        wait(bench, TICK_S);
        let reading = bench.joint.read().unwrap();
        if tick >= ticks / 2 {
            let read = [reading.motor_velocity.0, reading.motor_current.0, reading.motor_position.0];
            sums.iter_mut().zip(read).for_each(|(sum, value)| *sum += value);
        }
    }
    sums.map(|sum| sum / (ticks - ticks / 2) as f64)
}

/// The lines of figure 3.2 with the values of this specimen, upright, where the arm has no gravity torque.
#[test]
fn upright_the_current_is_the_friction_of_its_direction() {
    let (mock, mut bench) = start(Transport::Terminal, &[]);
    let truth = mock.truth().clone();
    let hidden = |effect: &str, figure: &str| {
        truth.hidden.iter().find(|h| h.effect == effect).expect("the arm is told of").parameters[figure]
    };
    let (offset, share) = (hidden("direction_offset", "offset_nm"), hidden("viscous_asymmetry", "relative"));
    for speed_rad_s in [10.0, 30.0, 60.0] {
        // Out, then back over the upright position: the mean over the same arc contains no gravity torque.
        hold(&mut bench, -speed_rad_s, 10.0 / speed_rad_s);
        for sign in [1.0, -1.0] {
            let [velocity, current, at_rad] = hold(&mut bench, sign * speed_rad_s, 40.0 / speed_rad_s);
            assert!((velocity / speed_rad_s - sign).abs() < 0.02, "{velocity} at {speed_rad_s}");
            let weight_nm = hidden("gravity", "link_nm") * (at_rad / truth.gear_ratio).sin() / truth.gear_ratio;
            let measured_nm = current * truth.torque_constant_nm_per_a + weight_nm;
            let viscous_nm = truth.viscous_nm_s * (1.0 + sign * share) * speed_rad_s;
            let expected = sign * (truth.coulomb_nm + sign * offset + viscous_nm);
            assert!((measured_nm - expected).abs() < 3e-3, "{measured_nm} Nm at {velocity} rad/s: expected {expected}");
            hold(&mut bench, -sign * speed_rad_s, 15.0 / speed_rad_s);
        }
    }
}

#[test]
fn it_moves_to_the_commanded_position_and_stays_there() {
    let (_mock, mut bench) = start(Transport::Tcp, &["stribeck"]);
    hold(&mut bench, 25.0, 1.0);
    let [velocity, _, at_rad] = hold(&mut bench, 0.0, 1.0);
    assert!((at_rad - 25.0).abs() < 0.5 && velocity.abs() < 0.1, "{at_rad} rad, {velocity} rad/s");
    bench.joint.disarm().unwrap();
    wait(&bench, 2.0);
    assert!(!bench.joint.health().unwrap().armed);
    let held = bench.joint.read().unwrap().motor_position.0;
    assert!((held - at_rad).abs() < 0.1, "its brake holds the leaning arm: {held} rad");
}

#[test]
fn a_current_alone_breaks_it_away_and_the_position_loop_catches_it() {
    let (mock, mut bench) = start(Transport::Terminal, &["stribeck"]);
    let km = mock.truth().torque_constant_nm_per_a;
    let mut at_nm = 0.0;
    for tick in 0..1000 {
        at_nm = 1e-4 * f64::from(tick) * 2.0;
        bench.joint.set_motor_current(Amperes(at_nm / km)).unwrap();
        wait(&bench, TICK_S);
        if bench.joint.read().unwrap().motor_velocity.0 > 2.0 {
            break;
        }
    }
    let rise_nm = mock.truth().hidden.iter().find(|h| h.effect == "stribeck").unwrap().parameters["rise_nm"];
    assert!(at_nm > mock.truth().coulomb_nm + rise_nm, "{at_nm} Nm");
    let [velocity, ..] = hold(&mut bench, 0.0, 1.0);
    assert!(velocity.abs() < 0.1, "{velocity} rad/s");
    let fault = bench.joint.set_velocity_fed(RadPerSec(1.0), Amperes(0.1)).unwrap_err();
    assert!(matches!(fault.kind, FaultKind::Refused { .. }), "{fault}");
}

#[test]
fn without_a_host_arm_power_goes() {
    let (_mock, mut bench) = start(Transport::Terminal, &[]);
    bench.joint.set_velocity(RadPerSec(20.0)).unwrap();
    wait(&bench, 1.0);
    let health = bench.joint.health().unwrap();
    assert!(!health.armed && health.errors[0].contains("no request for 0.25 s"), "{health:?}");
    assert!(bench.joint.set_velocity(RadPerSec(0.0)).unwrap_err().to_string().contains("arm power is off"));
    bench.joint.arm(RadPerSec(120.0), Amperes(5.0)).unwrap();
    assert!(bench.joint.health().unwrap().armed, "usable again");
}

#[test]
fn a_passing_trouble_is_seen_and_over_when_it_is() {
    let check = |transport, trouble| {
        let (mock, mut bench) = start(transport, &[]);
        bench.joint.read().unwrap();
        mock.trouble(MockInstrument::Joint, trouble);
        let fault =
            (0..2).find_map(|_| bench.joint.read().err()).expect("noticed at the second question at the latest");
        let expected = match trouble {
            Trouble::Garbled | Trouble::Truncated | Trouble::Doubled => matches!(fault.kind, FaultKind::Garbled { .. }),
            _ => matches!(fault.kind, FaultKind::Silent { .. }),
        };
        assert!(expected && fault.is_retryable(), "{trouble:?}: {fault}");
        mock.trouble(MockInstrument::Joint, Trouble::None);
        bench.joint.read().unwrap_or_else(|fault| panic!("it does not recover from {trouble:?}: {fault}"));
    };
    // In parallel, because most of the time is spent waiting for deadlines.
    std::thread::scope(|scope| {
        for (transport, trouble) in [
            (Transport::Terminal, Trouble::Silent),
            (Transport::Tcp, Trouble::Late),
            (Transport::Terminal, Trouble::Garbled),
            (Transport::Tcp, Trouble::Truncated),
            (Transport::Terminal, Trouble::Doubled),
            (Transport::Tcp, Trouble::Stale),
        ] {
            scope.spawn(move || check(transport, trouble));
        }
    });
}

#[test]
fn a_pulled_cable_is_named_and_another_unit_is_not_ours() {
    let (mock, mut bench) = start(Transport::Tcp, &[]);
    let mut ask = || bench.joint.read().map(drop);
    mock.trouble(MockInstrument::Joint, Trouble::Unplugged);
    let fault = std::iter::repeat_with(&mut ask).find_map(Result::err).unwrap();
    assert!(matches!(fault.kind, FaultKind::Disconnected { .. }), "{fault}");
    mock.trouble(MockInstrument::Joint, Trouble::Exchanged);
    let fault = ask().unwrap_err();
    assert!(matches!(fault.kind, FaultKind::WrongInstrument { .. }), "{fault}");
    mock.trouble(MockInstrument::Joint, Trouble::Refusing);
    let fault = ask().unwrap_err();
    assert!(fault.to_string().contains("not ready"), "{fault}");
    mock.trouble(MockInstrument::Joint, Trouble::None);
    ask().unwrap();
}

#[test]
fn positions_from_before_a_power_cycle_are_never_mixed_with_those_after() {
    let check_power_fault = |fault: Fault| {
        assert!(matches!(fault.kind, FaultKind::Reported { .. }) && !fault.is_retryable(), "{fault}");
        assert!(fault.to_string().contains("its power was interrupted"), "{fault}");
    };
    // Too short to miss a request: the next reply shows the power cycle.
    let (mock, mut bench) = start(Transport::Terminal, &[]);
    hold(&mut bench, 20.0, 1.0);
    mock.trouble(MockInstrument::Joint, Trouble::PowerCycled);
    mock.trouble(MockInstrument::Joint, Trouble::None);
    wait(&bench, 1.0);
    check_power_fault(bench.joint.read().unwrap_err());
    assert!(!bench.joint.health().unwrap().armed);
    assert!(bench.joint.read().unwrap().motor_position.0.abs() < 0.1, "counts from where it stands");

    // And one that was noticed as silence.
    let (mock, mut bench) = start(Transport::Tcp, &[]);
    mock.trouble(MockInstrument::Joint, Trouble::PowerCycled);
    assert!(matches!(bench.joint.read().unwrap_err().kind, FaultKind::Silent { .. }));
    mock.trouble(MockInstrument::Joint, Trouble::None);
    wait(&bench, 1.0);
    check_power_fault(bench.joint.read().unwrap_err());
    bench.joint.arm(RadPerSec(120.0), Amperes(5.0)).unwrap();
    assert!(bench.joint.health().unwrap().armed, "usable again");
}

#[test]
fn the_memory_is_read_and_gains_are_in_it_from_arming_on() {
    let gains = PumaGains { velgan: Some(8), postol: Some(300), ..PumaGains::default() };
    let mock = MockBench::start(MockSettings { gains, ninter: 16, ..MockSettings::new(Joint::Puma, 3) }).unwrap();
    let mut bench = mock.open_bench("puma").unwrap();
    let read = |bench: &mut Bench, addresses: &[u8]| -> Vec<u8> {
        let memory = bench.joint.servo_memory().expect("a Puma's servo");
        addresses.iter().map(|address| memory.read_byte(*address).unwrap()).collect()
    };
    let addresses = [memory::PROPORTIONAL_GAIN, memory::VELOCITY_GAIN, memory::VELOCITY_GAIN_OF_MANUAL, 0x52, 0x53];
    assert_eq!(read(&mut bench, &addresses), [1, 0, 0, 0, 0], "as at power-up");
    bench.joint.arm(RadPerSec(120.0), Amperes(5.0)).unwrap();
    assert_eq!(read(&mut bench, &addresses), [1, 8, 0, 300_u16 as u8, 1]);
    assert_eq!(read(&mut bench, &[0x06, 0x07]), [16, 4], "14 ms, and the scale factor of 16 ticks");
    let fault = bench.joint.servo_memory().unwrap().read_byte(0x80).unwrap_err();
    assert!(fault.to_string().contains("out of range"), "{fault}");
}

#[test]
fn the_same_seed_gives_the_same_readings() {
    let run = || {
        let (_mock, mut bench) = start(Transport::Terminal, &["stribeck"]);
        hold(&mut bench, 15.0, 0.5)
    };
    assert_eq!(run(), run());
}
