//! Shear-thinning viscous friction.

use crate::effect::{Columns, Effect, EffectInfo, Form, Search, Shape, parameter};
use crate::view::{Signal, View};
use jointbench_instrument::Kind;

pub struct ViscousSublinear;

static INFO: EffectInfo = EffectInfo {
    id: "viscous_sublinear",
    kind: Kind::Friction,
    title: "Shear-thinning viscous friction",
    sentence: "Sheared grease gets thinner: the drag grows more slowly than the speed.",
    formula: "c_α·|ω|^α·sgn ω, α < 1",
    source: "Harnoy, Friedland, Cohn 2008; contract section 2",
    looks: "a curve over speed that is steep at first and flattens, odd in direction",
    parameters: &[parameter("c_alpha", "Nm·(s/rad)^α", 0.0, f64::INFINITY), parameter("alpha", "1", 0.15, 0.85)],
    needs: &[],
};

impl Effect for ViscousSublinear {
    fn info(&self) -> EffectInfo<'_> {
        INFO
    }

    fn forms(&self, view: &View) -> Vec<Form<'_>> {
        if crate::effects::speed_range(view).is_none_or(|(slow, fast)| fast < 3.0 * slow) {
            return Vec::new();
        }
        let shape = vec![Shape { name: "alpha", min: 0.15, max: 0.85, search: Search::Smooth }];
        let grid = [0.25, 0.4, 0.55, 0.7].iter().map(|a| vec![*a]).collect();
        vec![Form { name: "power", linear: vec!["c_alpha"], shape, grid }]
    }

    fn columns(&self, _: &str, shape: &[f64], view: &View) -> Columns {
        vec![view.map2(Signal::Velocity, Signal::Direction, |w, d| w.abs().powf(shape[0]) * d)]
    }
}
