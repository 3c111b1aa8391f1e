//! A mock bench for other programs: prints the addresses of the instruments, and lets time pass until Enter is pressed.
//!
//! `cargo run -p jointbench-devices --example mock_bench -- [joint_a|joint_b|encoder_bench] [seed] [tcp] [hmp4040] [effect …]`

use jointbench_devices::sim::{Supply, Transport};
use jointbench_devices::{Joint, MockBench, MockSettings};
use std::error::Error;
use std::io::Read;
use std::sync::atomic::{AtomicBool, Ordering};

fn main() -> Result<(), Box<dyn Error>> {
    let mut settings = MockSettings { transport: Transport::Terminal, ..MockSettings::new(Joint::JointA, 1) };
    for argument in std::env::args().skip(1) {
        match argument.as_str() {
            "joint_a" => settings.joint = Joint::JointA,
            "joint_b" => settings.joint = Joint::JointB,
            "encoder_bench" => {
                let bench = MockSettings::new(Joint::EncoderShaft, settings.seed);
                (settings.joint, settings.load, settings.others) = (bench.joint, bench.load, bench.others);
            }
            "hmp4040" => settings.supply = Supply::Hmp4040,
            "tcp" => settings.transport = Transport::Tcp,
            other => match other.parse() {
                Ok(seed) => settings.seed = seed,
                Err(_) => settings.effects.push(other.to_owned()),
            },
        }
    }
    settings.pace = Some(1.0);
    let mock = MockBench::start(settings)?;
    for (instrument, address) in mock.addresses() {
        println!("{instrument} {address}");
    }

    let clock = mock.clock();
    let ended = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !ended.load(Ordering::Acquire) {
                clock.sleep_until_s(clock.now_s() + 0.02);
            }
        });
        let read = std::io::stdin().read(&mut [0]);
        ended.store(true, Ordering::Release);
        read
    })?;
    Ok(())
}
