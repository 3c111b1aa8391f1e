//! Dahl parameters by least squares of the motor displacement, and the derived parameters of LuGre and Maxwell slip.

use super::dahl::{Dahl, top_nm};
use super::damping::Damping;
use super::loops::{Swings, dahl, swings};
use crate::findings::{Unusable, curve, jackknife95, quantity, scatter, solve};
use crate::identification::{Axis, Figure, Form, Identification, Mark, Quantity, Series, Verdict};
use crate::parameter::Values;
use crate::thresholds::WIDEST_PRESLIDING;
use jointbench_instrument::RunTable;
use jointbench_model::words;

const ROUNDS: usize = 30;
/// Elements of the Maxwell-slip polygon.
const ELEMENTS: usize = 4;
/// End of the polygon, as a share of the Coulomb torque.
const POLYGON_END: f64 = 0.98;
pub fn identify(values: &Values, run: &RunTable) -> Result<Identification, Unusable> {
    let torque_constant = run.meta().torque_constant_nm_per_a.unwrap_or(1.0);
    let Some(all) = swings(run, torque_constant) else {
        return Err(Unusable::InsufficientData(
            "The run has no motor current set-point, so it belongs to another procedure.",
            "Run presliding.",
        ));
    };
    let broke_away = all.iter().filter(|swings| swings.broke_away).count();
    let held: Vec<&Swings> = all.iter().filter(|swings| !swings.broke_away).collect();
    let Some(dahl) = fit(&held) else {
        return Err(match broke_away {
            0 => Unusable::InsufficientData(
                "The motor moved by less than one encoder count in each step.",
                "Set top_torque_nm to 95 % of the lower breakaway torque of both directions (breakaway, puma_friction).",
            ),
            _ => Unusable::InsufficientData("The joint broke away during the cycles.", "Reduce top_torque_nm."),
        });
    };
    // Delete-one-step jackknife, because a step has one position and one initial state.
    let without = |left_out: usize| fit(&others(&held, left_out));
    let jackknife: Vec<Dahl> = (0..held.len()).filter_map(without).collect();
    let interval = |figure: &dyn Fn(Dahl) -> f64| spread(&jackknife, figure).map(|reach| around(figure(dahl), reach));
    let points: usize = held.iter().map(|swings| swings.points.len()).sum();
    let wide = |ci95: Option<[f64; 2]>, value: f64| {
        ci95.is_none_or(|[low, high]| high - low > 2.0 * WIDEST_PRESLIDING * value)
    };
    let (k, coulomb, reach) = (interval(&Dahl::stiffness), interval(&|d| d.coulomb_nm), interval(&Dahl::reach_rad));
    // The zero of a torque sensor, divided by the gear ratio, looks like such a torque. It is the same in every step,
    // so that the scatter does not contain it.
    let bias = run.column("link_torque_nm").is_none().then(|| interval(&|d| d.bias_nm)).flatten();
    let decided = !wide(k, dahl.stiffness()) && !wide(coulomb, dahl.coulomb_nm) && broke_away == 0;
    let mut quantities = vec![
        quantity(["sigma_0", "σ₀", "Presliding (bristle) stiffness (Dahl, LuGre)", "Nm/rad"], dahl.stiffness(), k),
        quantity(["tau_c", "τ_c", "Torque at the start of sliding", "Nm"], dahl.coulomb_nm, coulomb),
        quantity(["reach", "τ_c/σ₀", "Presliding displacement", "rad"], dahl.reach_rad(), reach),
        quantity(["bias", "τ₀", "Torque offset", "Nm"], dahl.bias_nm, bias),
    ];
    let rate_hz = run.meta().sample_rate_hz.unwrap_or(250.0);
    let damping = k.and_then(|k| Damping::of(&held, dahl, k, rate_hz));
    quantities.extend(damping.iter().flat_map(Damping::quantities));
    quantities.extend(elements(dahl, &interval));
    Ok(Identification {
        verdict: if decided { Verdict::Identified } else { Verdict::Inconclusive },
        summary: format!(
            "Presliding stiffness {} (motor side). Sliding starts at {}, after a displacement of {} ({points} points).{}",
            words::figure(dahl.stiffness(), "Nm/rad"),
            words::figure(dahl.coulomb_nm, "Nm"),
            words::figure(dahl.reach_rad(), "rad"),
            damping.as_ref().map(Damping::words).unwrap_or_default(),
        ),
        advice: (!decided).then(|| {
            let top_nm = words::figure(values.number("top_torque_nm"), "Nm");
            match broke_away {
                0 => "The loops are too small. Increase repeats, or increase top_torque_nm towards breakaway.".into(),
                _ => format!("The joint broke away below {top_nm} in {broke_away} steps. Reduce top_torque_nm."),
            }
        }),
        quantities,
        figures: vec![loops(&held, dahl), first_loading(dahl)],
        ..Identification::default()
    })
}

/// Interval of a figure of the Dahl parameters.
type Interval<'a> = &'a dyn Fn(&dyn Fn(Dahl) -> f64) -> Option<[f64; 2]>;

/// Stiffness and slip torque of each Maxwell-slip element, with the jackknife intervals of the Dahl parameters.
fn elements(dahl: Dahl, interval: Interval) -> Vec<Quantity> {
    let mut quantities = Vec::new();
    for i in 0..ELEMENTS {
        let (n, title) = (i + 1, format!("Maxwell slip, element {}", i + 1));
        let named = |what: &str, symbol: &str, text: &str, unit: &str, figure: &dyn Fn(Dahl) -> f64| {
            let words = [&format!("element_{n}_{what}"), &format!("{symbol}_{n}"), &format!("{title}: {text}"), unit];
            quantity(words.map(|word: &str| word), figure(dahl), interval(figure))
        };
        quantities.push(named("stiffness", "k", "stiffness", "Nm/rad", &|dahl| maxwell(dahl)[i].0));
        quantities.push(named("slip", "w", "slip torque", "Nm", &|dahl| maxwell(dahl)[i].1));
    }
    quantities
}

fn others<'s>(held: &[&'s Swings], left_out: usize) -> Vec<&'s Swings> {
    held.iter().enumerate().filter(|(i, _)| *i != left_out).map(|(_, swings)| *swings).collect()
}

fn around(value: f64, reach: f64) -> [f64; 2] {
    [value - reach, value + reach]
}

/// Half width of a 95 % interval, by the jackknife.
fn spread(jackknife: &[Dahl], figure: &dyn Fn(Dahl) -> f64) -> Option<f64> {
    (jackknife.len() > 2).then(|| jackknife95(&jackknife.iter().map(|d| figure(*d)).collect::<Vec<f64>>()))
}

/// Gauss–Newton with halved steps; the zero of each step is subtracted.
fn fit(all: &[&Swings]) -> Option<Dahl> {
    let top_nm = top_nm(all);
    let ways: f64 = all.iter().filter_map(|s| width(s)).fold(0.0, f64::max);
    if top_nm == 0.0 || ways == 0.0 {
        return None;
    }
    let mut at = Dahl { compliance: 0.2 * ways / top_nm, coulomb_nm: 1.1 * top_nm, bias_nm: 0.0 };
    let (mut left, mut error) = residuals(all, at);
    for _ in 0..ROUNDS {
        let sizes = at.sizes(top_nm).map(|size| 1e-5 * size);
        let slopes = [0, 1, 2].map(|i| {
            let mut by = [0.0; 3];
            by[i] = sizes[i];
            residuals(all, at.shifted(by, 1.0, top_nm)).0
        });
        // In shares of each parameter, because they differ by orders of magnitude.
        let rows: Vec<[f64; 3]> =
            (0..left.len()).map(|row| [0, 1, 2].map(|i| (left[row] - slopes[i][row]) / 1e-5)).collect();
        let step = solve(&rows, &left)?.values;
        let step = [0, 1, 2].map(|i| step[i] * sizes[i] / 1e-5);
        let tried = [1.0, 0.5, 0.25, 0.125, 0.0625, 0.015_625].into_iter().find_map(|share| {
            let next = at.shifted(step, share, top_nm);
            let (left, next_error) = residuals(all, next);
            (next_error < error).then_some((next, left, next_error))
        });
        let Some((next, next_left, next_error)) = tried else { break };
        let done = next_error > (1.0 - 1e-9) * error;
        (at, left, error) = (next, next_left, next_error);
        if done {
            break;
        }
    }
    Some(at)
}

fn width(swings: &Swings) -> Option<f64> {
    let (low, high) =
        swings.points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), (_, q)| (q.min(l), q.max(h)));
    (high > low).then_some(high - low)
}

/// Measured minus modelled displacement, without the mean of each step, and the sum of squares.
fn residuals(all: &[&Swings], at: Dahl) -> (Vec<f64>, f64) {
    let mut left = Vec::new();
    for swings in all {
        let (errors, mean) = errors(swings, at);
        left.extend(errors.iter().map(|error| error - mean));
    }
    let error = left.iter().map(|e| e * e).sum();
    (left, error)
}

/// Measured minus modelled displacement at every point, and their mean.
fn errors(swings: &Swings, at: Dahl) -> (Vec<f64>, f64) {
    let way = dahl(&swings.torque_nm, at.coulomb_nm, at.bias_nm);
    let errors: Vec<f64> = swings.points.iter().map(|(row, q)| q - at.compliance * way[*row]).collect();
    let mean = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
    (errors, mean)
}

/// Parallel elements whose initial loading curve is a polygon on the Dahl curve: stiffness [Nm/rad] and slip torque
/// (Nm) of each.
fn maxwell(at: Dahl) -> Vec<(f64, f64)> {
    let loading = |way_rad: f64| first(at, way_rad);
    let end_rad = -at.reach_rad() * (1.0 - POLYGON_END).ln();
    // Corners are closer together where the curvature is larger.
    let corner = |i: usize| end_rad * (i as f64 / ELEMENTS as f64).powf(1.5);
    let slope = |i: usize| (loading(corner(i + 1)) - loading(corner(i))) / (corner(i + 1) - corner(i));
    let slopes: Vec<f64> = (0..ELEMENTS).map(slope).chain([0.0]).collect();
    (0..ELEMENTS)
        .map(|i| {
            let stiffness = slopes[i] - slopes[i + 1];
            (stiffness, stiffness * corner(i + 1))
        })
        .collect()
}

/// Torque of the contacts on the initial loading curve.
fn first(at: Dahl, way_rad: f64) -> f64 {
    at.coulomb_nm * (1.0 - (-way_rad / at.reach_rad()).exp())
}

fn loops(held: &[&Swings], at: Dahl) -> Figure {
    let mut series = Vec::new();
    let mut measured = Vec::new();
    for swings in held {
        let (_, zero) = errors(swings, at);
        measured.extend(swings.points.iter().map(|(row, q)| (q - zero, swings.torque_nm[*row])));
    }
    series.push(scatter("measured at encoder increments", measured));
    // One step of each amplitude.
    let mut shown: Vec<f64> = Vec::new();
    for swings in held {
        let top_nm = swings.torque_nm.iter().copied().fold(0.0, f64::max);
        if shown.iter().any(|seen| (seen - top_nm).abs() < 0.05 * top_nm) {
            continue;
        }
        shown.push(top_nm);
        let way = dahl(&swings.torque_nm, at.coulomb_nm, at.bias_nm);
        let x = way.iter().map(|q| at.compliance * q).collect();
        let label = format!("Dahl, {}", words::figure(top_nm, "Nm"));
        series.push(Series::new(&label, Mark::Line, x, swings.torque_nm.clone()));
    }
    Figure {
        name: "loops".into(),
        title: "Torque over motor displacement (presliding)".into(),
        form: Form::Cartesian,
        x: Axis::of("motor displacement", "rad"),
        y: Axis::of("motor torque", "Nm"),
        series,
    }
}

fn first_loading(at: Dahl) -> Figure {
    let end_rad = -at.reach_rad() * (1.0 - POLYGON_END).ln();
    let elements = maxwell(at);
    let polygon = |way_rad: f64| elements.iter().map(|(k, w)| (k * way_rad).min(*w)).sum();
    Figure {
        name: "first_loading".into(),
        title: "First loading: Dahl model and Maxwell-slip elements".into(),
        form: Form::Cartesian,
        x: Axis::of("motor displacement", "rad"),
        y: Axis::of("motor torque", "Nm"),
        series: vec![
            curve("Dahl", [0.0, 1.2 * end_rad], 100, |way_rad| first(at, way_rad)),
            curve(&format!("{ELEMENTS} Maxwell-slip elements"), [0.0, 1.2 * end_rad], 100, polygon),
        ],
    }
}
