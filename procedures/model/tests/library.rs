//! Consistency of the library: every id exists, is complete, and tolerates data without its signals.

mod common;

use common::tables::{Shape, table};
use jointbench_instrument::Kind;
use jointbench_model::effect::ShapeSearch;
use jointbench_model::signal::{Signal, Signals};
use jointbench_model::view::View;
use jointbench_model::{ModelSpec, Options, effects, fit};

/// The ids of the library.
fn ids(kind: Kind) -> &'static [&'static str] {
    match kind {
        Kind::Friction => &[
            "inertia",
            "load_transmission",
            "coulomb",
            "viscous",
            "stribeck",
            "direction_offset",
            "viscous_asymmetry",
            "viscous_quadratic",
            "viscous_sublinear",
            "load_linear",
            "load_quadratic",
            "load_viscous",
            "stribeck_load",
            "temperature_viscous",
            "temperature_coulomb",
            "gravity",
            "cogging",
            "friction_ripple",
            "torque_constant_saturation",
            "drift",
            "presliding",
            "signal_delay",
        ],
        Kind::Encoder => &[
            "offset",
            "delay",
            "harmonic_1",
            "harmonic_2",
            "harmonic_n",
            "pole_period",
            "direction_hysteresis",
            "temperature_drift",
            "slip",
            "startup_offset",
        ],
        Kind::Stiffness => &[
            "offset",
            "compliance",
            "directional_offset",
            "backlash",
            "hardening",
            "torsional_hysteresis",
            "transmission_error",
            "temperature_compliance",
            "creep",
            "delay",
        ],
        Kind::Brake => &[
            "drag",
            "torque_per_current",
            "saturation",
            "hysteresis",
            "velocity_dependence",
            "cogging",
            "temperature_dependence",
        ],
    }
}

#[test]
fn every_effect_of_the_contract_is_there_and_whole() {
    for kind in Kind::ALL {
        let known: Vec<&str> = effects(kind).iter().map(|e| e.info().id).collect();
        for id in ids(kind) {
            assert!(known.contains(id), "{kind} {id}");
        }
        for effect in effects(kind) {
            let info = effect.info();
            assert!(info.sentence.ends_with('.') && info.sentence.len() > 20, "{}", info.id);
            assert!(!info.formula.is_empty() && !info.source.is_empty() && !info.looks.is_empty(), "{}", info.id);
            for p in info.parameters {
                assert!(p.min < p.max && !p.unit.is_empty(), "{} {}", info.id, p.name);
            }
            assert!(info.needs.iter().all(|n| Signal::of_column(n).is_some()), "{}", info.id);
        }
    }
}

/// All signals of a swinging joint.
fn everything() -> View {
    let n = 4000;
    let at = |f: &dyn Fn(f64) -> f64| (0..n).map(|i| f(0.004 * i as f64)).collect::<Vec<f64>>();
    let mut signals = Signals::new(n);
    for signal in Signal::ALL {
        let values = match signal {
            Signal::Time => at(&|t| t),
            Signal::Velocity => at(&|t| 3.0 * (2.0 * t).cos() * (1.0 + 0.2 * (0.3 * t).sin())),
            Signal::Direction => at(&|t| (2.0 * t).cos().signum()),
            Signal::Repeat => at(&|t| (t / 8.0).floor()),
            _ => at(&|t| (1.0 + 0.1 * t) * (2.0 * t).sin() + 0.3 * (0.7 * t).sin()),
        };
        signals.set(signal, values);
    }
    View::new(signals.clone(), signals, Vec::new(), vec![0], 0.004)
}

#[test]
fn every_form_has_its_columns_names_and_bounds() {
    let view = everything();
    for kind in Kind::ALL {
        for effect in effects(kind) {
            let info = effect.info();
            let forms = effect.forms(&view);
            assert!(!forms.is_empty(), "{kind} {}", info.id);
            for form in forms {
                let family =
                    |name: &str| name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('_').len();
                let known =
                    |name: &str| info.parameters.iter().any(|p| p.name == name || p.name == name[..family(name)]);
                if !effect.traits().is_offset {
                    assert!(form.linear.iter().all(|n| known(n)), "{} {:?}", info.id, form.linear);
                }
                assert!(form.shape.iter().all(|s| known(s.name)), "{} {:?}", info.id, form.shape);
                assert!(!form.grid.is_empty(), "{} {}", info.id, form.name);
                for shape in &form.grid {
                    for (value, bounds) in shape.iter().zip(&form.shape) {
                        assert!(
                            bounds.search == ShapeSearch::Whole
                                || *value == bounds.min && bounds.min == bounds.max
                                || (bounds.min * 0.999999..=bounds.max * 1.000001).contains(value),
                            "{} {}: {value}",
                            info.id,
                            bounds.name
                        );
                    }
                }
                let columns = effect.columns(form.name, &form.grid[0], &view);
                let several = form.name == "harmonics";
                assert!(several || columns.len() == form.linear.len(), "{} {}", info.id, form.name);
                for column in &columns {
                    assert_eq!(column.len(), view.len(), "{} {}", info.id, form.name);
                    assert!(column.iter().all(|v| v.is_finite()), "{} {}", info.id, form.name);
                }
            }
        }
    }
}

#[test]
fn what_lacks_its_signals_is_not_visible_and_no_error() {
    for kind in Kind::ALL {
        let run = table(kind, &Shape::default());
        for effect in effects(kind).iter().filter(|e| !e.info().needs.is_empty()) {
            let id = effect.info().id;
            let base = ModelSpec::baseline(&run).unwrap();
            if base.contains(id) {
                continue;
            }
            let found = fit(&run, &base.with(id).unwrap(), &Options::default()).unwrap();
            let text = found.notes.iter().any(|n| n.starts_with(&format!("{id} is not testable with this run")));
            let there = found.terms.iter().any(|t| t.effect == id);
            assert!(text || there, "{kind} {id}: {:?}", found.notes);
        }
    }
}

/// A shorter section of a wave is a curve over the angle.
#[test]
fn a_wave_needs_a_whole_turn_or_two_periods() {
    let orders = |turns: f64, kind: Kind, id: &str| -> Vec<f64> {
        let angle: Vec<f64> = (0..1000).map(|i| f64::from(i) * turns * std::f64::consts::TAU / 1000.0).collect();
        let mut signals = Signals::new(angle.len());
        signals.set(Signal::Position, angle.clone());
        signals.set(Signal::Link, angle);
        let view = View::new(signals.clone(), signals, Vec::new(), vec![0], 0.01);
        let forms = effects::find(kind, id).unwrap().forms(&view);
        forms.iter().flat_map(|form| &form.grid).map(|shape| shape.first().copied().unwrap_or(0.0)).collect()
    };
    assert!(orders(0.51, Kind::Encoder, "harmonic_1").is_empty());
    assert_eq!(orders(0.9, Kind::Encoder, "harmonic_1"), [0.0]);
    assert_eq!(orders(0.51, Kind::Encoder, "harmonic_n").first(), Some(&4.0));
    assert_eq!(orders(3.0, Kind::Encoder, "harmonic_n").first(), Some(&3.0));
}
