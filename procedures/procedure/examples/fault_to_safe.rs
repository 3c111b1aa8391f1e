//! Time until a silent instrument is given up, and until the first safety commands are sent after that: a loaded,
//! turning joint of the mock bench in real time, with recorded traffic. Prints rows of docs/benchmarks.md.
//!
//! `cargo run --release -p jointbench-procedure --example fault_to_safe`

use jointbench_devices::sim::{MockInstrument, Transport, Trouble};
use jointbench_devices::transport::{Event, Traffic};
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_procedure::{BenchFacts, Commit, Live, Recorder, RecorderFault, RunState, procedure, run};
use serde_json::json;
use std::error::Error;
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

const DEADLINE_MS: u64 = 50;
/// Time at which the shaft turns against the brake.
const STRIKES_S: f64 = 8.5;

/// Records when securing begins.
struct Watch(Option<Instant>);

impl Recorder for Watch {
    fn blocked(&mut self) -> Result<Option<String>, RecorderFault> {
        Ok(None)
    }

    fn commit(&mut self, commit: Commit<'_>) -> Result<(), RecorderFault> {
        if commit.state == RunState::Securing {
            self.0.get_or_insert_with(Instant::now);
        }
        Ok(())
    }

    fn live(&mut self, _live: Live<'_>) {}
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("| what | timeout after | first command to drive | first command to brake |\n| --- | --- | --- | --- |");
    for instrument in MockInstrument::JOINT_BENCH {
        let [given_up_s, drive_s, brake_s] = strike(instrument)?;
        println!(
            "| {instrument:?} silent | {:.2} deadlines | {:.1} ms later | {:.1} ms later |",
            1e3 * given_up_s / DEADLINE_MS as f64,
            1e3 * drive_s,
            1e3 * brake_s
        );
    }
    Ok(())
}

/// From the first lost reply to the timeout, and from there to the first commands.
fn strike(instrument: MockInstrument) -> Result<[f64; 3], Box<dyn Error>> {
    let settings = MockSettings {
        transport: Transport::Terminal,
        pace: Some(1.0),
        deadline_ms: DEADLINE_MS,
        ..MockSettings::new(Joint::JointA, 1)
    };
    let mock = MockBench::start(settings)?;
    let mut bench = mock.open_bench("bench")?;
    let folder = std::env::temp_dir().join(format!("fault-to-safe-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let parameters = json!({"load_levels": 3, "top_load": 0.5}).as_object().cloned().unwrap_or_default();
    let plan = procedure("stiffness").ok_or("no such procedure")?.plan(&parameters, &BenchFacts::of(&bench))?;

    bench.record(Some(&folder))?;
    // The records start a moment earlier: the reported times are a little too long, never too short.
    let opened = Instant::now();
    let (_held, controls) = channel();
    let mut watch = Watch(None);
    let struck = std::thread::scope(|scope| {
        let striker = scope.spawn(|| {
            std::thread::sleep(Duration::from_secs_f64(STRIKES_S));
            mock.trouble(instrument, Trouble::Silent);
            opened.elapsed().as_secs_f64()
        });
        run(&mut bench, &plan, 1, &controls, &mut watch);
        striker.join()
    });
    let struck_s = struck.map_err(|_| "the striker has panicked")?;
    let given_up_s = watch.0.ok_or("the run was not secured")?.duration_since(opened).as_secs_f64();
    let sent = |name: &str| -> Result<Vec<(f64, String)>, Box<dyn Error>> {
        let traffic = Traffic::parse(&std::fs::read_to_string(folder.join(format!("{name}.traffic")))?)?;
        let words = traffic.events.into_iter().filter_map(|(at_s, event)| match event {
            Event::Sent(bytes) => Some((at_s, String::from_utf8_lossy(&bytes).into_owned())),
            _ => None,
        });
        Ok(words.collect())
    };
    let drive_s = first_less(&sent("joint")?, given_up_s, "v 0 ", "requested_state 1")?;
    let brake_s = first_less(&sent("brake_a")?, given_up_s, "CURR ", ",OFF")?;
    // A stream is lost at once, a polled instrument with the first request after that.
    let name = if instrument == MockInstrument::Brake { "brake_a" } else { "joint" };
    let asked = sent(name)?.into_iter().map(|(at_s, _)| at_s).find(|at_s| *at_s >= struck_s);
    let lost_s =
        if instrument == MockInstrument::TorqueSensor { struck_s } else { asked.ok_or("not asked any more")? };
    std::fs::remove_dir_all(&folder)?;
    Ok([given_up_s - lost_s, drive_s - given_up_s, brake_s - given_up_s])
}

/// Time after `from_s` of the first smaller command, or of the command `off`.
fn first_less(sent: &[(f64, String)], from_s: f64, command: &str, off: &str) -> Result<f64, Box<dyn Error>> {
    let asked = |text: &str| {
        let (_, value) = text.split_once(command)?;
        let end = value.find(|c: char| !(c.is_ascii_digit() || "+-.e".contains(c))).unwrap_or(value.len());
        value[..end].parse::<f64>().ok().map(f64::abs)
    };
    let before = sent.iter().rev().filter(|(at_s, _)| *at_s <= from_s).find_map(|(_, text)| asked(text));
    let before = before.ok_or("nothing was commanded before")?;
    let is_less = |text: &str| text.contains(off) || asked(text).is_some_and(|value| value < before);
    let found = sent.iter().find(|(at_s, text)| *at_s > from_s && is_less(text));
    found.map(|(at_s, _)| *at_s).ok_or_else(|| "it was never told".into())
}
