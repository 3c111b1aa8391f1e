//! Long runs: the number of rows stays limited, and repeats are still paired.

mod common;

use common::tables::{Shape, table};
use jointbench_instrument::Kind;
use jointbench_model::Options;
use jointbench_model::preprocess::prepare;

#[test]
fn a_long_run_is_judged_on_some_of_its_rows() {
    // 64 swings in each repeat, each a segment.
    for kind in [Kind::Friction, Kind::Encoder, Kind::Stiffness, Kind::Brake] {
        let shape = Shape { rows: 150_795, segment: 785, repeats: 3, ..Shape::default() };
        let problem = prepare(&table(kind, &shape), &Options::default()).unwrap().main;
        assert!((4_000..=13_000).contains(&problem.rows()), "{kind}: {} rows", problem.rows());
        assert!(
            problem.replicate_pairs.len() > 1_000,
            "{kind}: {} pairs of moments in different repeats",
            problem.replicate_pairs.len()
        );
        let (first, second) = problem.replicate_pairs[problem.replicate_pairs.len() / 2];
        let of = |row: usize| (problem.repeat[row], problem.segment[row]);
        assert_ne!(of(first), of(second), "{kind}");
    }
}
