//! Makes the thesis' joint campaign again on a mock bench and prints each table beside the document's.
//!
//! ```text
//! cargo run -p jointbench-procedure --example reproduce -- a 1
//! ```

use jointbench_devices::sim::Truth;
use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_procedure::reproduce::{Subject, reproduce};
use std::time::Instant;

/// What the bench was given, by the names of the quantities.
fn given(truth: &Truth, name: &str) -> Option<f64> {
    let stribeck = |figure: &str| truth.hidden.iter().find(|h| h.effect == "stribeck")?.parameters.get(figure).copied();
    match name {
        "tau_c" => Some(truth.coulomb_nm),
        "c_v" => Some(truth.viscous_nm_s),
        "tau_h" => Some(truth.coulomb_nm + stribeck("rise_nm")?),
        "omega_s" => Some(stribeck("velocity_rad_s")? / truth.gear_ratio),
        "delta_s" => stribeck("exponent"),
        "k" => Some(truth.stiffness_nm_rad),
        "beta_0" => Some(truth.directional_offset_rad),
        _ => None,
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [joint, seed] = &words[..] else { return Err("joint (a or b) and seed".into()) };
    let (joint, subject) =
        if joint == "a" { (Joint::JointA, Subject::JointA) } else { (Joint::JointB, Subject::JointB) };
    let mock = MockBench::start(MockSettings::new(joint, seed.parse()?).hiding(&["stribeck"]))?;
    let mut bench = mock.open_bench("mock")?;
    let started = Instant::now();
    let truth = mock.truth();
    reproduce(&mut bench, subject, &|name| given(truth, name), &mut |chapter| {
        let (bench_s, wall_s) = (chapter.duration_s, started.elapsed().as_secs_f64());
        println!(
            "{} ({bench_s:.0} s of the bench, {wall_s:.0} s so far): {:?}",
            chapter.title, chapter.identification.verdict
        );
        println!("  {}", chapter.identification.summary);
        for c in &chapter.comparisons {
            let ci95 = c.found.ci95.map_or(String::new(), |[low, high]| format!("[{low:.6}, {high:.6}]"));
            let given = c.given.map_or(String::new(), |given| format!("given {given:.6}"));
            let judged = format!("inside {:?}, narrow {:?}", c.is_inside(), c.is_narrow());
            println!("  {:24} {:12.6} {ci95} document {:.6} {given} {judged}", c.found.name, c.found.value, c.document);
        }
    })?;
    Ok(())
}
