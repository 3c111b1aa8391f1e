//! Long runs: as many rows as a diagnosis needs, and repeats that still meet.

mod common;

use common::tables::{Shape, table};
use jointbench_instrument::Kind;
use jointbench_model::Options;
use jointbench_model::prepare::prepare;

#[test]
fn a_long_run_is_judged_on_some_of_its_rows() {
    for kind in [Kind::Friction, Kind::Encoder, Kind::Stiffness, Kind::Brake] {
        let shape = Shape { rows: 150_000, segment: 500, repeats: 3, ..Shape::default() };
        let problem = prepare(&table(kind, &shape), &Options::default()).unwrap().main;
        assert!((4_000..=13_000).contains(&problem.rows()), "{kind}: {} rows", problem.rows());
        assert!(problem.twins.len() > 1_000, "{kind}: {} pairs of moments in different repeats", problem.twins.len());
        let (first, second) = problem.twins[problem.twins.len() / 2];
        assert_ne!(problem.repeat[first], problem.repeat[second], "{kind}");
    }
}
