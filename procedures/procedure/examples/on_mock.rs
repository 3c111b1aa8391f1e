//! Runs a procedure on a mock bench and prints its result next to the true values.
//!
//! ```text
//! cargo run -p jointbench-procedure --example on_mock -- a 1 stribeck friction '{"repeats": 2}'
//! ```
//! Joint a or b (ab, bb: behind the gear with brake B), encoder or puma, seed, hidden effects (or -), then procedures with
//! parameters.

use jointbench_devices::sim::Load;
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_procedure::catalogue::brake_model;
use jointbench_procedure::in_memory_run::run_in_memory_with_facts;
use jointbench_procedure::{BenchFacts, Procedure, procedure};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [joint, seed, effects, work @ ..] = &words[..] else {
        return Err("joint seed effects procedure json …".into());
    };
    let subject = match joint.as_str() {
        "a" | "ab" => Joint::JointA,
        "b" | "bb" => Joint::JointB,
        "puma" => Joint::Puma,
        "encoder" => Joint::EncoderShaft,
        _ => return Err("joint: a, b, ab, bb, encoder or puma".into()),
    };
    let mut settings = MockSettings::new(subject, seed.parse()?);
    if joint.len() == 2 {
        settings.load = Load::GearAndBrakeB;
    }
    settings.effects = effects.split(',').filter(|e| *e != "-").map(str::to_owned).collect();
    let mock = MockBench::start(settings)?;
    let mut bench = mock.open_bench(joint)?;
    println!("{:#?}", mock.truth());
    let mut facts = BenchFacts::of(&bench);
    for pair in work.chunks(2) {
        let procedure: &dyn Procedure = procedure(&pair[0]).ok_or("no such procedure")?;
        let parameters = serde_json::from_str(pair.get(1).map_or("{}", String::as_str))?;
        let started = Instant::now();
        let done = run_in_memory_with_facts(&mut bench, &facts, procedure, &parameters)?;
        facts.brake_model = brake_model(&done.table).or(facts.brake_model);
        let ran_s = started.elapsed().as_secs_f64();
        println!("{}: {} rows, {:.0} s of the bench in {ran_s:.1} s", pair[0], done.table.len(), done.duration_s);
        let Some(found) = done.identification else { continue };
        println!("{:?}: {} {}", found.verdict, found.summary, found.advice.unwrap_or_default());
        for q in &found.quantities {
            let ci95 = q.ci95.map_or(String::new(), |[low, high]| {
                format!("[{low:.6e}, {high:.6e}] ±{:.2} %", 50.0 * (high - low) / q.value.abs())
            });
            println!("  {:24} {:14.6e} {:10} {ci95}", q.name, q.value, q.unit);
        }
        let figures: Vec<_> = found.figures.iter().map(|f| (f.name.as_str(), f.series.len())).collect();
        println!("  figures {figures:?}");
    }
    Ok(())
}
