//! Tables 4.2 and 4.3 of docs/documents.md on the mock bench that has exactly their values.

use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_procedure::identification::Identification;
use jointbench_procedure::in_memory_run::run_in_memory;
use jointbench_procedure::procedure;
use serde_json::{Value, json};

const SEEDS: u64 = 10;
/// Of ten 95 % intervals, nine contain the value.
const LEAST: u32 = 9;
/// Points for each rpm, and delay of the filter beyond its data sheet, from the lowest speed to the highest.
const POINTS_PER_RPM: [f64; 6] = [0.2724, 0.2735, 0.2748, 0.2902, 0.2887, 0.2869];
const MISSING_DELAY_S: [f64; 6] = [0.94e-6, 1.11e-6, 0.69e-6, 1.34e-6, 1.02e-6, 0.84e-6];

fn delay(seed: u64, filter: bool, parameters: Value) -> Identification {
    let settings = MockSettings { filter, documents: true, ..MockSettings::new(Joint::EncoderShaft, seed) };
    let mock = MockBench::start(settings).unwrap();
    let mut bench = mock.open_bench("encoder bench").unwrap();
    let run = run_in_memory(&mut bench, procedure("encoder_delay").unwrap(), parameters.as_object().unwrap());
    run.unwrap().identification.unwrap()
}

/// Figures of a document, each with the number of intervals that contain it.
#[derive(Default)]
struct Inside(Vec<(String, u32)>);

impl Inside {
    /// `widest`: largest half width of the interval.
    fn count(&mut self, found: &Identification, name: &str, document: f64, widest: f64) {
        let [low, high] = found.quantity(name).unwrap().ci95.unwrap();
        assert!(0.5 * (high - low) < widest, "{name}: {low:e} to {high:e}");
        println!("{name}: {document:e} in {low:e} to {high:e}");
        let contains = u32::from(low <= document && document <= high);
        match self.0.iter_mut().find(|(known, _)| known == name) {
            Some((_, inside)) => *inside += contains,
            None => self.0.push((name.to_owned(), contains)),
        }
    }
}

#[test]
fn the_intervals_contain_the_figures_of_tables_4_2_and_4_3() {
    let mut inside = Inside::default();
    for seed in 1..=SEEDS {
        let without = delay(seed, false, json!({}));
        inside.count(&without, "delay_mean", 64.34e-6, 0.3e-6);
        for (i, figure) in (1..).zip(POINTS_PER_RPM) {
            inside.count(&without, &format!("points_per_rpm_{i}"), figure, 0.0035);
        }
        let value = |name: &str| without.quantity(name).unwrap().value;
        let known = json!({
            "delay_without_filter_s": value("delay"),
            "half_difference_without_filter_s": value("half_difference"),
        });
        let with = delay(seed, true, known);
        inside.count(&with, "filter_delay", 10.99e-6, 0.5e-6);
        for (i, figure) in (1..).zip(MISSING_DELAY_S) {
            inside.count(&with, &format!("missing_delay_{i}"), figure, 1.6e-6);
        }
    }
    assert!(inside.0.iter().all(|(_, inside)| *inside >= LEAST), "of {SEEDS} seeds: {:?}", inside.0);
}
