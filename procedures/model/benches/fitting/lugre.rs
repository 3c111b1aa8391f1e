//! The state of the LuGre model, stiff (σ₀ = 1e5), on a velocity with noise.

use crate::{least_s, line, peer};
use jointbench_instrument::Kind;
use jointbench_model::effects::find;
use jointbench_model::signal::{Signal, Signals};
use jointbench_model::view::View;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const STEP_S: f64 = 1e-3;
/// Presliding displacement [rad], Stribeck speed [rad/s] and rise of the static friction, as in peer.py.
const SHAPE: [f64; 3] = [1e-5, 0.05, 0.5];
/// Rows for LSODA, which is slower.
const OF_PEER: usize = 20_000;

pub fn measure(rows: usize) {
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut noise = || -> f64 { StandardNormal.sample(&mut random) };
    let velocity: Vec<f64> = (0..rows).map(|i| 0.1 * (0.004 * i as f64).sin() + 0.01 * noise()).collect();
    let mut angle = 0.0;
    let steps = velocity.windows(2).map(|w| 0.5 * STEP_S * (w[0] + w[1]));
    let position = std::iter::once(0.0).chain(steps).map(|way| {
        angle += way;
        angle
    });
    let mut signals = Signals::new(rows);
    signals.set(Signal::Position, position.collect());
    signals.set(Signal::Velocity, velocity.clone());
    // The effect is the state minus its limit in this direction, so that a zero direction gives the state itself.
    signals.set(Signal::Direction, vec![0.0; rows]);
    let view = View::new(signals.clone(), signals, Vec::new(), vec![0], STEP_S);
    let effect = find(Kind::Friction, "presliding").expect("the library has it");
    let (here_s, states) = least_s(5, || effect.columns("lugre", &SHAPE, &view));
    let of_peer = OF_PEER.min(rows);
    let scipy = peer::ask("lugre", &[&velocity[..of_peer]]);
    let apart = scipy.as_ref().map_or(String::new(), |(_, there)| {
        let squares: f64 = states[0].iter().zip(there).map(|(a, b)| (a - b).powi(2)).sum();
        let rms = (squares / of_peer as f64).sqrt();
        assert!(rms < 0.1, "the states differ by {rms} of the friction");
        format!(", {:.1} % of the friction apart in RMS", 100.0 * rms)
    });
    let what = format!("LuGre state on noisy velocity, a sample of {rows}");
    let peer = format!("SciPy odeint (LSODA){apart}, a sample of {of_peer}");
    line(&what, here_s / rows as f64, &peer, scipy.map(|b| b.0 / of_peer as f64), 500.0);
}
