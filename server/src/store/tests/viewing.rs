use super::super::Window;
use super::*;

const TORQUE: &str = "link_torque_nm";

/// A run of `count` rows with one outlier at `spike`. Its last part is in the tail.
async fn with_spike(store: &Store, count: usize, spike: usize) -> (RunId, Trace) {
    let (channels, mut columns) = (rows(0, 1).channels().to_vec(), rows(0, count).columns().to_vec());
    columns[2][spike] = 55.5;
    let part = |from: usize, to: usize| {
        Trace::from_columns(channels.clone(), columns.iter().map(|column| column[from..to].to_vec()).collect())
    };
    let run = store.create_run(&new_run()).await.unwrap();
    let most = count * 9 / 10;
    commit(store, run, RunState::Running, part(0, most)).await;
    commit(store, run, RunState::Running, part(most, count)).await;
    (run, part(0, count))
}

fn check_view(view: &Window, trace: &Trace, rows: std::ops::Range<usize>, px: usize) {
    assert_eq!(view.rows, rows.len() as u64);
    assert!(view.time_s.len() <= px, "{} points for {px} pixels", view.time_s.len());
    assert!(view.time_s.is_sorted());
    assert_eq!(view.time_s.first(), trace.columns()[0].get(rows.start));
    for column in &view.columns {
        let values = &trace.column(&column.channel.name).unwrap()[rows.clone()];
        let lowest = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        assert_eq!(lowest(&column.min), lowest(values), "{}", column.channel.name);
        assert_eq!(highest(&column.max), highest(values), "{}", column.channel.name);
        assert_eq!((column.min.len(), column.max.len()), (view.time_s.len(), view.time_s.len()));
    }
}

#[test]
fn a_spike_of_one_sample_is_seen_at_every_width() {
    block_on(async {
        let (_folder, store) = fresh().await;
        const COUNT: usize = 150_000;
        for spike in [0, 1, 32_767, 32_768, 77_777, 134_999, 135_000, COUNT - 1] {
            let (run, trace) = with_spike(&store, COUNT, spike).await;
            // Covers all sources: coarse bins, fine bins, samples, and exact rows.
            for px in [1, 7, 60, 500, 2_000, 200_000] {
                let view = store.window(run, Some(&[TORQUE.to_owned()]), None, None, px).await.unwrap();
                check_view(&view, &trace, 0..COUNT, px);
                assert_eq!(view.exact, px >= COUNT);
                let peak = view.columns[0].max.iter().position(|max| *max == 55.5).expect("the spike is drawn");
                let drawn_s = view.time_s[peak];
                let pixel_s = COUNT as f64 * 0.004 / px as f64;
                assert!((drawn_s - spike as f64 * 0.004).abs() <= 1.6 * pixel_s, "{px} px: {drawn_s} s");
            }
        }
    });
}

#[test]
fn a_window_holds_its_rows_and_no_others() {
    block_on(async {
        let (_folder, store) = fresh().await;
        let (run, trace) = with_spike(&store, 150_000, 40_000).await;
        let time_s = &trace.columns()[0];
        for (from, to) in [(0, 150_000), (39_999, 40_001), (32_768, 65_536), (100, 149_000), (140_000, 150_000), (7, 8)]
        {
            for px in [1, 33, 1_000] {
                let window = (Some(time_s[from]), Some(time_s[to - 1]));
                let view = store.window(run, None, window.0, window.1, px).await.unwrap();
                check_view(&view, &trace, from..to, px);
            }
        }
        let nothing = store.window(run, None, Some(1e6), None, 100).await.unwrap();
        assert_eq!((nothing.rows, nothing.time_s.len()), (0, 0));
        let crossed = store.window(run, None, Some(10.0), Some(5.0), 100).await.unwrap();
        assert_eq!((crossed.rows, crossed.time_s.len()), (0, 0));
        let young = store.create_run(&new_run()).await.unwrap();
        assert_eq!(store.window(young, None, None, None, 100).await.unwrap().columns, []);
    });
}
