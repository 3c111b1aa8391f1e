//! Request and reply: a driver's link beside raw file descriptors on the same pseudo-terminal and responder, in one run;
//! and what one control tick of the mock bench costs.

use divan::Bencher;
use jointbench_devices::protocol::odrive::ReadFeedback;
use jointbench_devices::sim::Transport;
use jointbench_devices::transport::Link;
use jointbench_devices::{Joint, MockBench, MockSettings, PortSettings};
use jointbench_instrument::units::{Amperes, RadPerSec, Volts};
use rustix::fs::{Mode, OFlags};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::time::Duration;

const REPLY: &[u8] = b"1.077135 1.482737*42\r\n";

fn main() {
    divan::main();
}

/// Answers every chunk with the same line. Ends when the process does: its reads never fail while the slave is open.
fn responder() -> (String, rustix::fd::OwnedFd) {
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
    grantpt(&master).unwrap();
    unlockpt(&master).unwrap();
    let path = ptsname(&master, Vec::new()).unwrap().into_string().unwrap();
    let slave = rustix::fs::open(&path, OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).unwrap();
    let mut attributes = tcgetattr(&slave).unwrap();
    attributes.make_raw();
    tcsetattr(&slave, OptionalActions::Now, &attributes).unwrap();
    std::thread::spawn(move || {
        let mut master = File::from(master);
        let mut chunk = [0; 256];
        while let Ok(1..) = master.read(&mut chunk) {
            master.write_all(REPLY).unwrap();
        }
    });
    (path, slave)
}

/// The floor: blocking reads and writes without deadline, checksum or parsing.
#[divan::bench(sample_count = 4000)]
fn raw_descriptors(bencher: Bencher) {
    let (path, _slave) = responder();
    let mut port = OpenOptions::new().read(true).write(true).open(path).unwrap();
    let mut chunk = [0; 256];
    bencher.bench_local(|| {
        port.write_all(b"f 0*118\n").unwrap();
        port.read(&mut chunk).unwrap()
    });
}

#[divan::bench(sample_count = 4000)]
fn driver_link(bencher: Bencher) {
    let (path, _slave) = responder();
    let settings = PortSettings::new(path.as_str(), 921_600);
    let mut link = Link::open("joint", &settings, Duration::from_secs(1)).unwrap();
    link.trust();
    bencher.bench_local(|| link.request(&ReadFeedback { axis: 0 }).unwrap());
}

/// 4 ms of the mock bench: set the velocity, wait, read joint, link encoder, current and torque. Fifty times real time are
/// 80 µs.
#[divan::bench(sample_count = 4000, args = [Transport::Inside, Transport::Terminal, Transport::Tcp])]
fn mock_control_tick(bencher: Bencher, transport: Transport) {
    let settings = MockSettings { transport, ..MockSettings::new(Joint::JointA, 1) };
    let mock = MockBench::start(settings.hiding(&["stribeck"])).unwrap();
    let mut bench = mock.open_bench("mock").unwrap();
    bench.joint.arm(RadPerSec(300.0), Amperes(6.0)).unwrap();
    bench.brake.as_mut().unwrap().prepare(Volts(45.0)).unwrap();
    let mut tick = 0;
    bencher.bench_local(|| {
        tick += 1;
        // Alternating, so that the joint keeps within its range, and changing, so that every set is read back.
        let speed = if tick / 500 % 2 == 0 { 50.0 } else { -50.0 };
        bench.joint.set_velocity(RadPerSec(speed + f64::from(tick % 10) * 0.1)).unwrap();
        bench.clock.sleep_until_s(f64::from(tick) * 0.004 + 1.0);
        (bench.joint.read().unwrap(), bench.torque_sensor.as_mut().unwrap().read().unwrap())
    });
}

/// One second of plant and drive without any wire: 8000 substeps.
#[divan::bench]
fn mock_second_without_wire(bencher: Bencher) {
    let mock = MockBench::start(MockSettings::new(Joint::JointA, 1).hiding(&["stribeck"])).unwrap();
    let clock = mock.clock();
    let mut second = 0.0;
    bencher.bench_local(|| {
        second += 1.0;
        clock.sleep_until_s(second);
    });
}
