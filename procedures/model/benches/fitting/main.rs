//! `cargo bench -p jointbench-model --bench fitting`: cost of fits, compared with SciPy for the same answer from the
//! same rows, in the same run.
//!
//! `-- 100000` for another number of rows. SciPy's part is skipped if python3 or SciPy is missing.

mod linear;
mod lugre;
mod peer;
mod stribeck;

use std::time::Instant;

fn main() {
    let rows = std::env::args().find_map(|a| a.parse().ok()).unwrap_or(1_000_000);
    println!("| what | here | compared with | ratio | required |\n| --- | --- | --- | --- | --- |");
    linear::measure(rows);
    stribeck::measure(rows);
    lugre::measure(rows);
}

/// The least duration of several runs, with the result.
fn least_s<T>(times: usize, mut work: impl FnMut() -> T) -> (f64, T) {
    let mut timed = || {
        let start = Instant::now();
        let made = work();
        (start.elapsed().as_secs_f64(), made)
    };
    let first = timed();
    (1..times).map(|_| timed()).fold(first, |best, next| if next.0 < best.0 { next } else { best })
}

/// A line of the table. The peer's duration is `None` if it is missing.
fn line(what: &str, here_s: f64, peer: &str, peer_s: Option<f64>, bar: f64) {
    match peer_s {
        Some(s) => println!("| {what} | {} | {peer}: {} | {:.1} | ≥ {bar} |", show(here_s), show(s), s / here_s),
        None => {
            println!("| {what} | {} | {peer}: skipped, python3 with SciPy is missing | – | ≥ {bar} |", show(here_s))
        }
    }
}

fn show(seconds: f64) -> String {
    match seconds {
        s if s < 1e-6 => format!("{:.0} ns", 1e9 * s),
        s if s < 1e-3 => format!("{:.1} µs", 1e6 * s),
        s if s < 1.0 => format!("{:.1} ms", 1e3 * s),
        s => format!("{s:.2} s"),
    }
}
