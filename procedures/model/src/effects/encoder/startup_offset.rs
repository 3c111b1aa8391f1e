//! Start-up offset.

use crate::effect::{Columns, Effect, EffectInfo, Form, Traits, parameter};
use crate::signal::Signal;
use crate::symbolic::{FittedForm, Symbolic};
use crate::view::View;
use jointbench_instrument::Kind;
use std::sync::LazyLock;

pub struct StartupOffset;

/// Largest number of offsets that can be searched for.
const MOST: usize = 256;

/// One offset for each repeat after the first.
static NAMES: LazyLock<Vec<String>> = LazyLock::new(|| (1..=MOST).map(|r| format!("xi_{r}")).collect());

static INFO: EffectInfo = EffectInfo {
    id: "startup_offset",
    kind: Kind::Encoder,
    title: "Start-up offset",
    sentence: "The zero of the encoder changes at each power-up.",
    formula: "ξ_r for every repeat r after the first, up to 256",
    source: "JCGM 200:2012 (VIM), 4.28 zero error",
    looks: "a different constant in each repeat",
    parameters: &[parameter("xi", "rad", f64::NEG_INFINITY, f64::INFINITY)],
    needs: &["repeat"],
};

impl Effect for StartupOffset {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        match restarts(view).len() {
            n @ 1..=MOST => vec![Form::linear(&NAMES[..n].iter().map(String::as_str).collect::<Vec<_>>())],
            _ => Vec::new(),
        }
    }

    fn traits(&self) -> Traits {
        Traits { is_nuisance: true, ..Traits::default() }
    }

    fn columns(&self, _: &str, _: &[f64], view: &View) -> Columns {
        let is = |k: f64| view.map(Signal::Repeat, |r| f64::from(u8::from(r == k)));
        restarts(view).into_iter().map(is).collect()
    }

    fn symbolic(&self, _: &FittedForm) -> Symbolic {
        Err("it has an offset for each power-up of the recording, and a controller's own is another")
    }
}

/// Numbers of the repeats after the first.
fn restarts(view: &View) -> Vec<f64> {
    let mut numbers = view.get(Signal::Repeat).to_vec();
    numbers.sort_by(f64::total_cmp);
    numbers.dedup();
    numbers.into_iter().skip(1).collect()
}

#[cfg(test)]
mod tests {
    use crate::{ModelSpec, Options, Verdict, discover};
    use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Two motions back and forth after each power-up.
    fn started(power_ups: usize) -> RunTable {
        const WAY: usize = 125;
        let names = ["time_s", "reference_position_rad", "test_position_rad", "segment", "repeat"];
        let mut trace = Trace::new(names.map(Channel::new).into());
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let mut scatter = |size: f64| size * (random.random::<f64>() - 0.5);
        let offsets: Vec<f64> = (0..power_ups).map(|_| scatter(1e-3)).collect();
        for i in 0..power_ups * 4 * WAY {
            let (segment, at) = (i / WAY, i % WAY);
            let repeat = segment / 4;
            let angle = 0.03 * if segment.is_multiple_of(2) { at } else { WAY - at } as f64;
            let test = angle + offsets[repeat] + scatter(2e-5);
            trace.push_row(&[0.004 * i as f64, angle, test, segment as f64, repeat as f64]);
        }
        RunTable::new(Meta { kind: Some(Kind::Encoder), ..Meta::default() }, trace).unwrap()
    }

    #[test]
    fn every_power_up_has_its_offset() {
        for power_ups in [6, 18, 60] {
            let spec = ModelSpec::new(Kind::Encoder, ["offset"]).unwrap();
            let found = discover(&started(power_ups), &spec, &Options::default(), 4).unwrap();
            assert_eq!(found.model, ["offset", "startup_offset"], "{}", found.summary);
            assert_eq!(found.verdict, Verdict::Adequate, "{}", found.summary);
            let offsets = found.fit.parameters.iter().filter(|p| p.effect == "startup_offset");
            assert_eq!(offsets.count(), power_ups - 1);
        }
    }
}
