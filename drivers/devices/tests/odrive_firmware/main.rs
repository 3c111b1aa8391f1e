//! The joint's driver with the parser of an ODrive's own firmware (0.5.6), which answers on a pseudo-terminal. The
//! firmware sources are not part of this project. They are compiled from the folder `Firmware` of a checkout that
//! `JOINTBENCH_ODRIVE_FIRMWARE` names, together with our own model of the drive. Without it the tests report that they
//! are skipped.
#![cfg(unix)]

use jointbench_devices::driver::{OdriveSettings, Thermistor};
use jointbench_devices::sim::{MockInstrument, Transport};
use jointbench_devices::{Joint, MockBench, MockSettings, OdriveJoint, PortSettings};
use jointbench_instrument::roles::{Instrument, JointController};
use jointbench_instrument::units::{Amperes, RadPerSec};
use jointbench_instrument::{Clock, SystemClock};
use std::fs::OpenOptions;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, LazyLock};
use std::time::Duration;

const OURS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/odrive_firmware");
const BUILT: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/odrive_firmware");
const PARSER: [&str; 2] = ["ascii_protocol.cpp", "ascii_protocol.hpp"];

/// The program, or the reason why it is missing.
static PROGRAM: LazyLock<Result<PathBuf, String>> = LazyLock::new(|| {
    let firmware = std::env::var_os("JOINTBENCH_ODRIVE_FIRMWARE").ok_or("JOINTBENCH_ODRIVE_FIRMWARE is not set")?;
    let firmware = Path::new(&firmware);
    let built = Path::new(BUILT);
    // Copied, because the original folder contains headers of the firmware that only the drive itself can compile.
    std::fs::create_dir_all(built).unwrap();
    for name in PARSER {
        let source = firmware.join("communication").join(name);
        std::fs::copy(&source, built.join(name)).map_err(|error| format!("{}: {error}", source.display()))?;
    }
    let program = built.join("drive");
    let mut compiler = Command::new(std::env::var("CXX").unwrap_or_else(|_| "c++".into()));
    compiler.args(["-std=gnu++17", "-O1", "-w", "-o"]).arg(&program);
    for folder in [Path::new(OURS).join("around"), built.to_owned(), firmware.join("fibre-cpp/include")] {
        compiler.arg("-I").arg(folder);
    }
    compiler.arg(Path::new(OURS).join("drive.cpp")).arg(built.join(PARSER[0]));
    let output = compiler.output().map_err(|error| format!("no C++ compiler: {error}"))?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(program)
});

/// Answers until it is dropped.
struct Drive {
    program: Child,
    port: String,
}

impl Drive {
    fn start() -> Option<Self> {
        let program = match &*PROGRAM {
            Ok(program) => program,
            Err(why) => {
                eprintln!("SKIPPED: {why}");
                return None;
            }
        };
        let mut program = Command::new(program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let mut port = String::new();
        BufReader::new(program.stdout.as_mut().unwrap()).read_line(&mut port).unwrap();
        Some(Self { program, port: port.trim().to_owned() })
    }

    fn open(&self) -> (OdriveJoint, Arc<dyn Clock>) {
        let clock: Arc<dyn Clock> = Arc::new(SystemClock::start());
        let settings = OdriveSettings {
            name: "joint".into(),
            port: PortSettings::new(self.port.as_str(), 921_600),
            deadline_ms: 300,
            link_encoder: true,
            thermistor: Some(Thermistor::Motor),
        };
        (OdriveJoint::open(settings, Arc::clone(&clock)).unwrap(), clock)
    }
}

impl Drop for Drive {
    fn drop(&mut self) {
        drop(self.program.stdin.take());
        let _ended = self.program.wait();
    }
}

/// Commands a velocity for a while, as a run does.
fn turn(joint: &mut OdriveJoint, clock: &Arc<dyn Clock>, velocity: RadPerSec, seconds: f64) {
    let end_s = clock.now_s() + seconds;
    while clock.now_s() < end_s {
        joint.set_velocity(velocity).unwrap();
        clock.sleep_until_s(clock.now_s() + 4e-3);
    }
}

#[test]
fn it_is_identified_armed_turned_and_stood_down() {
    let Some(drive) = Drive::start() else { return };
    let (mut joint, clock) = drive.open();
    let identity = joint.identify().unwrap();
    assert_eq!((identity.model.as_str(), identity.firmware.as_str()), ("ODrive 3.6-56V", "0.5.6"));
    assert_eq!(identity.serial, "376E36573131");
    let health = joint.health().unwrap();
    assert!(!health.armed && health.errors.is_empty(), "{health:?}");
    assert!((health.bus_voltage.unwrap().0 - 24.087_744).abs() < 1e-6);
    assert!((health.temperature.unwrap().0 - 28.25).abs() < 1e-6);

    joint.arm(RadPerSec(200.0), Amperes(5.0)).unwrap();
    for velocity_rad_s in [40.0, -25.5] {
        turn(&mut joint, &clock, RadPerSec(velocity_rad_s), 0.4);
        let (first, from_s) = (joint.read().unwrap(), clock.now_s());
        assert!((first.motor_velocity.0 - velocity_rad_s).abs() < 0.1, "{first:?}");
        turn(&mut joint, &clock, RadPerSec(velocity_rad_s), 0.2);
        let (second, passed_s) = (joint.read().unwrap(), clock.now_s() - from_s);
        let turned_rad = second.motor_position.0 - first.motor_position.0;
        assert!((turned_rad / (velocity_rad_s * passed_s) - 1.0).abs() < 0.05, "{turned_rad} rad in {passed_s} s");
        let link_rad = second.link_position.unwrap().0;
        assert!((link_rad - second.motor_position.0 / 50.0).abs() < 0.01, "{second:?}");
    }
    // A current alone selects torque mode.
    joint.set_motor_current(Amperes(0.5)).unwrap();
    clock.sleep_until_s(clock.now_s() + 0.02);
    assert!((joint.read().unwrap().motor_current.0 - 0.5).abs() < 1e-3);
    joint.set_velocity(RadPerSec(f64::NAN)).unwrap_err();

    joint.disarm().unwrap();
    clock.sleep_until_s(clock.now_s() + 0.02);
    assert!(!joint.health().unwrap().armed);
}

#[test]
fn a_drive_without_watchdog_feed_disarms_reports_why_and_is_armed_again() {
    let Some(drive) = Drive::start() else { return };
    let (mut joint, clock) = drive.open();
    joint.arm(RadPerSec(200.0), Amperes(5.0)).unwrap();
    turn(&mut joint, &clock, RadPerSec(10.0), 0.1);
    clock.sleep_until_s(clock.now_s() + 0.4);
    let health = joint.health().unwrap();
    assert!(!health.armed, "{health:?}");
    assert!(health.errors.iter().any(|error| error.contains("WATCHDOG_TIMER_EXPIRED")), "{health:?}");
    joint.disarm().unwrap();
    joint.arm(RadPerSec(200.0), Amperes(5.0)).unwrap();
    turn(&mut joint, &clock, RadPerSec(10.0), 0.1);
    assert!(joint.health().unwrap().armed);
}

/// A foreign line absorbs the next command. The checksum of that command is then wrong, and the parser does not answer.
#[test]
fn what_somebody_else_leaves_on_the_line_is_gone_when_the_driver_has_recovered() {
    let Some(drive) = Drive::start() else { return };
    let (mut joint, _clock) = drive.open();
    for rubbish in [&b"f 0"[..], b"r axis0.error *1", &[b'x'; 700], b"\r\n\r\n", b"nothing known\n"] {
        OpenOptions::new().write(true).open(&drive.port).unwrap().write_all(rubbish).unwrap();
        std::thread::sleep(Duration::from_millis(20));
        if let Err(fault) = joint.read() {
            assert!(fault.is_retryable(), "{fault}");
            joint.recover().unwrap();
        }
        for _ in 0..50 {
            let reading = joint.read().unwrap();
            assert_eq!((reading.motor_position.0, reading.motor_velocity.0), (0.0, 0.0));
        }
    }
}

/// Lines whose replies do not depend on the shaft: all forms of the commands, and C's number parsing.
const LINES: &[&str] = &[
    "f",
    "f x",
    "f 5",
    "f -1",
    "x",
    "",
    " f 0",
    "r",
    "r nothing",
    "r axis0",
    "r axis0.",
    "r .axis0",
    "r axis2.error",
    "r axis0.error",
    "r\taxis0.error",
    "r axis0.error ; why",
    "r axis0.error extra",
    "r axis0.error *1",
    "r axis0.error *123",
    "r axis0.error*91",
    "r axis0.error*91junk",
    "r axis0.error*",
    "r axis0.error*x",
    "w",
    "w nothing 1",
    "; a comment",
    "f 5*83",
    "v",
    "v 0",
    "v x 1",
    "v 5 1",
    "v 0.5 1",
    "vel 0 1",
    "c 0",
    "c 9 1",
    "c 0 x",
    "t",
    "t 9 1",
    "p 0",
    "p 9 1",
    "q 0",
    "q 9 1",
    "u",
    "u x",
    "u 9",
    "u 0",
    "e",
    "es",
    "esx",
    "esl 0",
    "esl 7 1",
    "esl 0 100",
    "esl 0 -5",
    "s",
    "sx",
    "sc",
    "h",
    "v 0 2 0.5",
    "v 0 3 junk",
    "r axis0.controller.input_vel",
    "r axis0.controller.input_torque",
    "v 0 0 0",
    "p 0 1",
    "r axis0.controller.input_vel",
    "w axis0.controller.input_vel -123.456",
    "r axis0.controller.input_vel",
    "w axis0.controller.input_vel 123456.789",
    "r axis0.controller.input_vel",
    "w axis0.controller.input_vel 1e-3",
    "r axis0.controller.input_vel",
    "w axis0.controller.input_vel inf",
    "r axis0.controller.input_vel",
    "w axis0.controller.input_vel nan",
    "r axis0.controller.input_vel",
    "w axis0.controller.input_vel abc",
    "w axis0.controller.input_vel 5 6",
    "r axis0.controller.input_vel",
    "w axis0.controller.input_vel 0",
    "w axis0.config.enable_watchdog 2",
    "r axis0.config.enable_watchdog",
    "w axis0.config.enable_watchdog 0.5",
    "r axis0.config.enable_watchdog",
    "w axis0.config.enable_watchdog -1",
    "r axis0.config.enable_watchdog",
    "w axis0.config.enable_watchdog 0",
    "w axis0.controller.config.control_mode 2.9",
    "r axis0.controller.config.control_mode",
    "r axis0.controller.config.input_mode",
    "t 0 0",
    "r axis0.controller.config.input_mode",
    "w axis0.motor.error 68719476735",
    "r axis0.motor.error",
    "sc",
    "r axis0.motor.error",
    "r axis0.current_state",
    "r axis0.requested_state",
];
/// Sent after each line: its known reply marks the end of the replies to that line.
const LAST: (&str, &str) = ("f 77\n", "invalid motor 77\r\n");

fn reply_to(port: &mut dyn serialport::SerialPort, line: &str) -> String {
    port.write_all(format!("{line}\n{}", LAST.0).as_bytes()).unwrap();
    let mut received = Vec::new();
    while !received.ends_with(LAST.1.as_bytes()) {
        let mut bytes = [0; 256];
        let count = port.read(&mut bytes).unwrap_or_else(|error| panic!("{line:?}: {error} after {received:?}"));
        received.extend(&bytes[..count]);
    }
    String::from_utf8(received).unwrap()
}

#[test]
fn the_mock_replies_as_the_firmware_does() {
    let Some(drive) = Drive::start() else { return };
    let settings = MockSettings { transport: Transport::Terminal, ..MockSettings::new(Joint::JointA, 1) };
    let mock = MockBench::start(settings).unwrap();
    let path = mock.address(MockInstrument::Joint).unwrap().to_string();
    let mut ports = [drive.port.as_str(), path.as_str()]
        .map(|path| serialport::new(path, 921_600).timeout(Duration::from_secs(2)).open().unwrap());
    let long = [254, 255, 256, 257, 600].map(|length| "x".repeat(length));
    for line in LINES.iter().copied().chain(long.iter().map(String::as_str)) {
        let [firmware, mock] = ports.each_mut().map(|port| reply_to(port.as_mut(), line));
        assert_eq!(mock, firmware, "{line:?}");
    }
}
