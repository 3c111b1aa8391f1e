//! `jointbench simulate`: the instruments of a mock bench for other programs, with time that runs.

use super::arguments::Simulate;
use super::exit::{Done, Exit};
use super::serve::describe;
use crate::config::{BenchDescription, Source};
use jointbench_devices::sim::Transport;
use jointbench_devices::{MockBench, MockSettings};
use serde::Serialize;
use std::convert::Infallible;
use std::io::Write;

/// Time between two checks of the wall clock [s].
const SLICE_S: f64 = 0.02;

/// One line of `--json`.
#[derive(Serialize)]
struct Simulated {
    bench: String,
    instrument: &'static str,
    address: String,
}

/// Serves the instruments until the program is ended.
pub fn simulate(arguments: &Simulate) -> Done {
    let mut benches = Vec::new();
    for description in describe(&arguments.config)?.benches {
        let bench = MockBench::start(settings(&description, arguments)?);
        benches.push((description.name, bench.map_err(|fault| Exit::failed(fault.to_string()))?));
    }
    print(&benches, arguments).map_err(|fault| Exit::failed(format!("standard output: {fault}")))?;
    let Some(((_, last), others)) = benches.split_last() else { return Ok(()) };
    std::thread::scope(|scope| {
        for (_, bench) in others {
            scope.spawn(|| run(bench));
        }
        match run(last) {}
    })
}

/// The mock bench of a description, on ports that other programs can open.
fn settings(description: &BenchDescription, arguments: &Simulate) -> Result<MockSettings, Exit> {
    let Source::Mock(mock) = &description.source else {
        return Err(Exit::bad_input(format!(
            "bench {} has real instruments: give a simulated one, such as joint-a-mock",
            description.name
        )));
    };
    Ok(MockSettings {
        transport: if arguments.tcp { Transport::Tcp } else { Transport::Terminal },
        pace: Some(arguments.pace),
        paced_lines: arguments.paced_lines,
        ..mock.clone()
    })
}

/// The instruments and their addresses. A client may close the pipe after the line that it needs, so that it is
/// written at once.
fn print(benches: &[(String, MockBench)], arguments: &Simulate) -> std::io::Result<()> {
    let mut text = String::new();
    for (name, bench) in benches {
        if !arguments.json {
            text += &format!("bench {name}, {} s of simulation per second\n", arguments.pace);
        }
        for (instrument, address) in bench.addresses() {
            let address = address.to_string();
            if arguments.json {
                let line = Simulated { bench: name.clone(), instrument, address };
                text += &format!("{}\n", serde_json::to_string(&line)?);
            } else {
                text += &format!("  {instrument:<14} {address}\n");
            }
        }
    }
    if !arguments.json {
        text += "Ctrl-C ends the simulation.\n";
    }
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes())?;
    out.flush()
}

/// Lets the time of a bench run.
fn run(bench: &MockBench) -> Infallible {
    let clock = bench.clock();
    loop {
        clock.sleep_until_s(clock.now_s() + SLICE_S);
    }
}
