//! `jointbench simulate`: instruments of a mock bench for the programs of others.

use crate::program::{jointbench, run, stderr};
use serde_json::Value;
use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// A running simulation, ended on drop.
struct Simulation(Child);

impl Drop for Simulation {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A hexapod that only speaks its protocol, and a client that knows nothing of the mock bench.
#[test]
fn the_stage_of_a_simulation_moves_to_its_reference() {
    let arguments = ["simulate", "encoder-bench-mock", "--tcp", "--json", "--pace", "20"];
    let child = jointbench().args(arguments).stdout(Stdio::piped()).spawn().expect("jointbench starts");
    let mut simulation = Simulation(child);
    let lines = BufReader::new(simulation.0.stdout.take().expect("piped")).lines();
    let instruments = lines.map(|line| serde_json::from_str::<Value>(&line.expect("a line")).expect("JSON"));
    let stage = { instruments }.find(|one| one["instrument"] == "stage").expect("a stage");
    let address = stage["address"].as_str().and_then(|text| text.strip_prefix("tcp://")).expect("a TCP address");
    let stream = TcpStream::connect(address).expect("the stage listens");
    stream.set_read_timeout(Some(Duration::from_secs(10))).expect("a socket");
    let mut replies = BufReader::new(stream.try_clone().expect("a socket"));
    let send = |command: &str| (&stream).write_all(format!("{command}\n").as_bytes()).expect("sent");
    let mut ask = |command: &str| {
        send(command);
        let mut reply = String::new();
        replies.read_line(&mut reply).expect("a reply");
        reply.trim().to_owned()
    };
    assert!(ask("*IDN?").contains("Physik Instrumente"), "{}", ask("*IDN?"));
    assert_eq!(ask("FRF? X"), "X=0");
    ask("FRF\nERR?");
    let began = Instant::now();
    while ask("FRF? X") != "X=1" {
        assert!(began.elapsed() < Duration::from_secs(60), "no reference after a minute");
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn real_instruments_are_not_simulated() {
    let output = run(&["simulate", "joint-a"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("has real instruments: give a simulated one"), "{}", stderr(&output));
}
