//! Speed of drivers and mock bench on a wire, compared with the bare wire in the same run. Prints the table of
//! docs/benchmarks.md.
//!
//! `cargo bench -p jointbench-devices [-- SECONDS]`: SECONDS of the torque stream, ten minutes by default.

mod raw;
mod torque;

use jointbench_devices::protocol::odrive::ReadFeedback;
use jointbench_devices::sim::{MockInstrument, Transport};
use jointbench_devices::transport::{Event, Link, Traffic};
use jointbench_devices::{Joint, MockBench, MockSettings, PortSettings};
use jointbench_instrument::units::{Amperes, RadPerSec, Volts};
use std::error::Error;
use std::time::{Duration, Instant};

const EXCHANGES: usize = 20_000;
/// On a paced line an exchange takes a third of a millisecond.
const PACED_EXCHANGES: usize = 10_000;
const TICKS: u32 = 10_000;
const TICK_S: f64 = 4e-3;
const BITS_OF_A_BYTE: f64 = 10.0;

fn main() -> Result<(), Box<dyn Error>> {
    let stream_s = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(600.0);
    println!("| what | measured | required |\n| --- | --- | --- |");

    // Alternating, so that other load of the machine affects both equally.
    let (path, _slave) = raw::responder();
    let mut port = raw::Port::open(&path)?;
    let (linked, _other_slave) = raw::responder();
    let mut link = Link::open("joint", &PortSettings::new(linked.as_str(), 921_600), Duration::from_secs(1))?;
    link.trust();
    let (mut raw_s, mut link_s) = (Vec::new(), Vec::new());
    for _ in 0..EXCHANGES {
        raw_s.push(seconds(|| port.exchange())?);
        link_s.push(seconds(|| link.request(&ReadFeedback { axis: 0 }))?);
    }
    let (raw_s, link_s) = (median(raw_s), median(link_s));
    row("request and reply on a pseudo-terminal, raw descriptors, p50", format!("{:.0} µs", 1e6 * raw_s), "");
    row("the same through a driver's link: deadline, checksum, parser", format!("{:.0} µs", 1e6 * link_s), "");
    row("link / raw, in requests a second", format!("{:.2}", raw_s / link_s), "≥ 0.7");

    let (polls, limit) = polling()?;
    row(
        "feedback of the mock drive on its line of 921,600 baud, as the mock paces it, p50",
        format!("{polls:.0} /s"),
        "",
    );
    row("what that line carries of such requests and replies", format!("{limit:.0} /s"), "");
    row("polled / carried", format!("{:.3}", polls / limit), "≥ 0.9");

    torque::stream(stream_s)?;

    for (transport, name) in
        [(Transport::Inside, "in process"), (Transport::Terminal, "pseudo-terminals"), (Transport::Tcp, "TCP")]
    {
        let times = TICK_S / control_tick_s(transport)?;
        let what = format!("mock bench through the drivers, {name}: a control tick of 4 ms");
        row(&what, format!("{times:.0} × real time"), if transport == Transport::Inside { "≥ 50 ×" } else { "" });
    }
    Ok(())
}

fn row(what: &str, measured: String, bar: &str) {
    println!("| {what} | {measured} | {bar} |");
}

fn seconds<T, E>(work: impl FnOnce() -> Result<T, E>) -> Result<f64, E> {
    let start = Instant::now();
    work()?;
    Ok(start.elapsed().as_secs_f64())
}

fn median(mut measured: Vec<f64>) -> f64 {
    measured.sort_by(f64::total_cmp);
    measured[measured.len() / 2]
}

/// Rate of feedback requests to a drive at rest on its line, and the highest possible rate.
fn polling() -> Result<(f64, f64), Box<dyn Error>> {
    let settings =
        MockSettings { transport: Transport::Terminal, paced_lines: true, ..MockSettings::new(Joint::JointA, 1) };
    let mock = MockBench::start(settings)?;
    let address = mock.address(MockInstrument::Joint).ok_or("a mock bench without a joint")?;
    let baud = MockInstrument::Joint.baud();
    let record = std::env::temp_dir().join(format!("feedback-{}.traffic", std::process::id()));
    let mut link = Link::open("joint", &PortSettings::new(address, baud), Duration::from_secs(1))?;
    let bytes = exchange_bytes(&mut link, &record)?;
    let polls = (0..PACED_EXCHANGES).map(|_| seconds(|| link.request(&ReadFeedback { axis: 0 })));
    let poll_s = median(polls.collect::<Result<_, _>>()?);
    Ok((1.0 / poll_s, f64::from(baud) / BITS_OF_A_BYTE / bytes as f64))
}

/// Recorded bytes of one request and its reply.
fn exchange_bytes(link: &mut Link, record: &std::path::Path) -> Result<usize, Box<dyn Error>> {
    link.record(Some(record))?;
    link.trust();
    link.request(&ReadFeedback { axis: 0 })?;
    link.record(None)?;
    link.trust();
    let traffic = Traffic::parse(&std::fs::read_to_string(record)?)?;
    std::fs::remove_file(record)?;
    let bytes = traffic.events.iter().map(|(_, event)| match event {
        Event::Sent(bytes) | Event::Received(bytes) => bytes.len(),
        Event::Lost => 0,
    });
    Ok(bytes.sum())
}

/// One control tick: set the velocity, wait, read joint, link encoder, current and torque.
fn control_tick_s(transport: Transport) -> Result<f64, Box<dyn Error>> {
    let settings = MockSettings { transport, ..MockSettings::new(Joint::JointA, 1) };
    let mock = MockBench::start(settings.hiding(&["stribeck"]))?;
    let mut bench = mock.open_bench("mock")?;
    bench.joint.arm(RadPerSec(300.0), Amperes(6.0))?;
    bench.brake.as_mut().ok_or("no brake")?.prepare(Volts(45.0))?;
    let sensor = bench.torque_sensor.as_mut().ok_or("no torque sensor")?;
    let start_s = bench.clock.now_s();
    let start = Instant::now();
    for tick in 1..=TICKS {
        // The sign alternates to keep the joint within its range. The value changes, so that every set-point is read
        // back.
        let speed = if tick / 500 % 2 == 0 { 50.0 } else { -50.0 };
        bench.joint.set_velocity(RadPerSec(speed + f64::from(tick % 10) * 0.1))?;
        bench.clock.sleep_until_s(start_s + f64::from(tick) * TICK_S);
        bench.joint.read()?;
        sensor.read()?;
    }
    Ok(start.elapsed().as_secs_f64() / f64::from(TICKS))
}
