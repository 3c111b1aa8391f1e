//! The runs and instruments that rows of the documents name, on the bench of the first seed.

use super::benches;
use super::evidence::{Evidence, PlannedRun};
use crate::cli::exit::Exit;
use jointbench_devices::MockBench;
use jointbench_procedure::catalogue::{brake_model, compared_brake};
use jointbench_procedure::in_memory_run::run_in_memory_with_facts;
use jointbench_procedure::reproduce::ProcedureResult;
use jointbench_procedure::{BenchFacts, ComparedBrake, Identification, procedure};

/// A run with its result. `Err`: why it has none.
pub struct Performed {
    pub run: PlannedRun,
    pub result: Result<Identification, String>,
}

/// An instrument that has answered.
pub struct Answered {
    pub bench: String,
    pub role: &'static str,
    pub driver: &'static str,
    pub model: String,
}

impl Performed {
    /// A run of the campaign. Its parameters are those of the campaign.
    pub fn of_campaign(bench: &str, result: &ProcedureResult) -> Self {
        let (bench, procedure) = (bench.to_owned(), result.procedure.to_owned());
        let run = PlannedRun { bench, procedure, parameters: Default::default() };
        Self { run, result: Ok(result.identification.clone()) }
    }
}

/// Adds the runs that the campaign does not have: on a fresh bench for each name, in the order of the rows.
pub fn perform<'a>(
    performed: &mut Vec<Performed>,
    evidence: impl Iterator<Item = &'a Evidence>,
    seed: u64,
) -> Result<Vec<Answered>, Exit> {
    let mut open: Vec<&PlannedRun> = Vec::new();
    let mut named: Vec<&str> = Vec::new();
    for one in evidence {
        let bench = match one {
            Evidence::Run { run, .. } if performed.iter().any(|done| done.run == *run) || open.contains(&run) => {
                continue;
            }
            Evidence::Run { run, .. } => {
                open.push(run);
                &run.bench
            }
            Evidence::Driver { bench, .. } => bench,
            _ => continue,
        };
        if !named.contains(&bench.as_str()) {
            named.push(bench);
        }
    }
    let (mut answered, mut compared) = (Vec::new(), None);
    for bench in named {
        let runs: Vec<&PlannedRun> = open.iter().copied().filter(|run| run.bench == bench).collect();
        println!("{bench}, seed {seed}: rows");
        on_bench(bench, &runs, seed, performed, &mut answered, &mut compared)?;
    }
    Ok(answered)
}

fn on_bench(
    name: &str,
    runs: &[&PlannedRun],
    seed: u64,
    performed: &mut Vec<Performed>,
    answered: &mut Vec<Answered>,
    compared: &mut Option<ComparedBrake>,
) -> Result<(), Exit> {
    let failed = |why: String| Exit::failed(format!("{name}: {why}"));
    let settings = benches::named(name, seed).ok_or_else(|| failed("no such bench".into()))?;
    let mock = MockBench::start(settings).map_err(|fault| failed(fault.to_string()))?;
    for asked in mock.instruments().open(&mock.clock()).asked {
        let identity = asked.identity.map_err(|fault| failed(fault.to_string()))?;
        let (role, driver) = (asked.role, asked.driver);
        answered.push(Answered { bench: name.to_owned(), role, driver, model: identity.model });
    }
    let mut bench = mock.open_bench("mock").map_err(|fault| failed(fault.to_string()))?;
    // The last brake of an earlier bench: a comparison has to name a run, whose number does not exist here.
    let mut facts = BenchFacts { compared_brake: compared.clone(), ..BenchFacts::of(&bench) };
    for run in runs {
        let procedure = procedure(&run.procedure).ok_or_else(|| failed(format!("no procedure {}", run.procedure)))?;
        let result = match run_in_memory_with_facts(&mut bench, &facts, procedure, &run.parameters) {
            Err(fault) => Err(fault.to_string()),
            Ok(done) => {
                if procedure.id() == "brake_hysteresis" {
                    facts.brake_model = brake_model(&done.table);
                    *compared = compared_brake(&done.table);
                }
                done.identification.ok_or_else(|| format!("{} only records samples", run.procedure))
            }
        };
        let summary = result.as_ref().map_or_else(Clone::clone, |found| found.summary.clone());
        println!("  {}: {summary}", procedure.title());
        performed.push(Performed { run: (*run).clone(), result });
    }
    Ok(())
}
