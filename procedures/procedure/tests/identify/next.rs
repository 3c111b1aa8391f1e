//! Open questions of one run, the recommended run, and the result of both together, on the mock bench.

use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_instrument::{Bench, RunTable};
use jointbench_model::{Diagnosis, Experiment, ModelSpec, Open, Options, diagnose, next_run};
use jointbench_procedure::in_memory_run::run_in_memory;
use jointbench_procedure::{BenchFacts, menu, procedure};
use serde_json::{Map, Value, json};

/// A bench with its measurements so far.
struct Laboratory {
    /// Its instruments answer as long as it exists.
    _mock: MockBench,
    bench: Bench,
    spec: ModelSpec,
    run: RunTable,
}

impl Laboratory {
    fn new(joint: Joint, id: &str, parameters: Value, model: &[&str]) -> Self {
        let mock = MockBench::start(MockSettings::new(joint, 5)).unwrap();
        let mut bench = mock.open_bench("mock").unwrap();
        let run = measured(&mut bench, id, parameters.as_object().unwrap());
        Self { _mock: mock, bench, spec: ModelSpec::new(run.kind(), model.iter().copied()).unwrap(), run }
    }

    fn diagnosis(&self) -> Diagnosis {
        diagnose(&self.run, &self.spec, &Options::default()).unwrap()
    }

    fn asked(&self) -> Option<Experiment> {
        let offered = menu(&BenchFacts::of(&self.bench), &self.run, &Map::new());
        next_run(&self.run, &Open::from(&self.diagnosis()), &offered, &Options::default()).unwrap().experiment
    }

    fn measure(&mut self, asked: &Experiment) {
        let next = measured(&mut self.bench, &asked.procedure, &asked.parameters);
        self.run = self.run.clone().join(vec![next]).unwrap();
    }
}

fn measured(bench: &mut Bench, id: &str, parameters: &Map<String, Value>) -> RunTable {
    run_in_memory(bench, procedure(id).unwrap(), parameters).unwrap().table
}

#[test]
fn another_speed_distinguishes_a_flank_from_a_delay() {
    let given = json!({"load_levels": 5});
    let mut bench = Laboratory::new(Joint::JointA, "stiffness", given, &["offset", "compliance"]);
    let open = bench.diagnosis();
    let first = &open.suggestions[0];
    let reported: Vec<&str> = first.confounded_with.iter().chain([&first.effect]).map(String::as_str).collect();
    assert!(
        reported.contains(&"delay") && reported.contains(&"directional_offset"),
        "at one speed both are one: {reported:?}"
    );
    let asked = bench.asked().unwrap();
    assert_eq!(asked.procedure, "stiffness", "{}", asked.why);
    assert!(asked.expected_z.unwrap() > 4.0 && asked.separates.iter().any(|e| e == "delay"), "{}", asked.why);
    bench.measure(&asked);
    let decided = bench.diagnosis();
    let named: Vec<_> = decided.suggestions.iter().map(|s| (s.effect.as_str(), s.confounded_with.len())).collect();
    assert_eq!(named, [("directional_offset", 0)], "{}", decided.summary);
    assert!(!decided.structure_remains, "{}", decided.summary);
    assert_eq!(bench.asked().map(|asked| asked.separates), None, "nothing is left open");
}
