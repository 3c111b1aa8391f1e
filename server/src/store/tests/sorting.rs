use super::super::{Order, RunFilter};
use super::*;

#[test]
fn runs_are_sorted_by_a_quantity_of_their_results() {
    block_on(async {
        let (_folder, store) = fresh().await;
        for _ in 0..4 {
            store.create_run(&new_run()).await.unwrap();
        }
        let named = |name: &str, value: f64| (name.to_owned(), value);
        for (run, tau_c) in [(1, 0.03), (3, 0.03), (4, 0.01)] {
            let quantities = [named("c_v", 1.0), named("tau_c", tau_c)];
            store.keep_verdict(run, "identified", None, &quantities).await.unwrap();
        }
        assert_eq!(store.quantities_kept(2).await.unwrap(), None);
        // A later result replaces the former one.
        store.keep_verdict(4, "identified", None, &[named("tau_c", 0.02)]).await.unwrap();
        assert_eq!(store.quantities_kept(4).await.unwrap(), Some(vec![named("tau_c", 0.02)]));
        for (asked, ids) in [
            ("quantity:tau_c", [4, 3, 1, 2]),
            ("-quantity:tau_c", [3, 1, 4, 2]),
            ("-quantity:c_v", [3, 1, 4, 2]),
            ("quantity:'; DROP TABLE runs; --", [4, 3, 2, 1]),
        ] {
            let filter = RunFilter { limit: 9, order: Order::parse(asked).unwrap(), ..RunFilter::default() };
            let found = store.runs(&filter).await.unwrap().1.iter().map(|run| run.id).collect::<Vec<_>>();
            assert_eq!(found, ids, "{asked}");
        }
        let refused = Order::parse("quantity:").unwrap_err().to_string();
        assert!(refused.contains("quantity:NAME"), "{refused}");
    });
}
