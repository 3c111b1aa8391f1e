//! Coulomb, viscous and Stribeck friction of the joint without load, for each direction.

use super::free_friction::{Figured, FreeFriction, fit_with, friction_nm};
use super::inconclusive::{Side, hidden_rise_nm, is_small, rest};
use crate::findings::{
    Leg, Line, Plateau, Unusable, combined, curve, directions, legs, parameter, plateaus, quantity, scatter,
    select_legs, settled,
};
use crate::identification::{Axis, Direction, Figure, Form, Identification, Quantity, Series, Verdict};
use crate::thresholds::{AMBIGUOUS_COULOMB, LINE_SPAN};
use jointbench_instrument::RunTable;
use jointbench_model::preprocess::Prepared;
use jointbench_model::words;
use std::panic::resume_unwind;
use std::thread;

fn coulomb_with_quadratic_drag(run: &Prepared, whole: &FreeFriction) -> Option<f64> {
    whole.stribeck.as_ref()?;
    let square = fit_with(run, &["stribeck", "viscous_quadratic"]).ok()?;
    parameter(&square, "viscous_quadratic", "c_2")?;
    let coulomb_nm = parameter(&square, "coulomb", "tau_c")?.value;
    ((coulomb_nm - whole.coulomb.0).abs() > AMBIGUOUS_COULOMB * coulomb_nm.abs()).then_some(coulomb_nm)
}

/// The legs without load after the warm-up.
pub(crate) fn free(run: &RunTable) -> Vec<Leg> {
    let warm_up = run.meta().other.get("warm_up_segments").and_then(serde_json::Value::as_i64).unwrap_or(0);
    let unloaded = |leg: &Leg| leg.brake_nm == Some(0.0) && leg.direction != 0.0;
    legs(run).into_iter().filter(|leg| leg.segment >= warm_up && unloaded(leg)).collect()
}

/// Friction of both directions together and of each direction.
struct Fits {
    points: Vec<Plateau>,
    whole: FreeFriction,
    /// Coulomb friction (Nm) with a quadratic drag, if the run does not distinguish this drag from the Stribeck effect.
    with_drag_nm: Option<f64>,
    forward: FreeFriction,
    backward: FreeFriction,
}

impl Fits {
    /// A run of hours takes seconds, so that the directions are fitted in parallel.
    fn of(run: &RunTable, free: &[Leg]) -> Result<Self, Unusable> {
        let part = |sign: f64| select_legs(run, free.iter().filter(|leg| leg.direction == sign));
        let (both, sides) = thread::scope(|scope| {
            let sides = scope.spawn(|| [1.0, -1.0].map(|sign| FreeFriction::of(&settled(&part(sign)?)?)));
            let both = || -> Result<_, Unusable> {
                let both = settled(&select_legs(run, free)?)?;
                let whole = FreeFriction::of(&both)?;
                let with_drag_nm = coulomb_with_quadratic_drag(&both, &whole);
                Ok((whole, with_drag_nm, plateaus(&both)))
            };
            (both(), sides.join())
        });
        let [forward, backward] = sides.unwrap_or_else(|panic| resume_unwind(panic));
        let ((whole, with_drag_nm, points), forward, backward) = (both?, forward?, backward?);
        Ok(Self { points, whole, with_drag_nm, forward, backward })
    }

    fn sides(&self) -> [(Direction, Side); 2] {
        [
            (Direction::Positive, Side::of(&self.points, 1.0, &self.forward)),
            (Direction::Negative, Side::of(&self.points, -1.0, &self.backward)),
        ]
    }

    /// Coulomb and viscous friction, positive minus negative direction.
    fn differences(&self) -> [(f64, [f64; 2]); 2] {
        [
            combined(self.forward.coulomb, self.backward.coulomb, -1.0),
            combined(self.forward.viscous, self.backward.viscous, -1.0),
        ]
    }

    fn quantities(&self, sides: &[(Direction, Side); 2], gear: f64) -> Vec<Quantity> {
        let mut quantities = parameters(&self.whole, gear);
        for (direction, of) in Direction::ALL.into_iter().zip([&self.forward, &self.backward]) {
            quantities.extend(parameters(of, gear).into_iter().map(|one| one.in_direction(direction)));
        }
        let r2 = |side: &Side| quantity(["r2", "r²", "Coefficient of determination", ""], side.r2, None);
        quantities.extend(sides.iter().map(|(direction, side)| r2(side).in_direction(*direction)));
        quantities
    }
}

/// Whether the run determines the friction towards zero speed, and a sentence about it.
fn rise(whole: &FreeFriction, hidden_nm: Option<f64>, gear: f64) -> (bool, String) {
    match (&whole.stribeck, hidden_nm) {
        (Some(stribeck), _) => {
            let below = words::figure(stribeck.speed.0 / gear, "rad/s");
            let to = words::figure(whole.coulomb.0 + stribeck.rise.0, "Nm");
            (true, format!("Below {below} (link) friction rises to {to}"))
        }
        (None, Some(most_nm)) => {
            let most = words::figure(most_nm, "Nm");
            match is_small(most_nm, whole) {
                true => (true, format!("Towards zero speed friction rises by at most {most}")),
                false => (false, format!("A rise of up to {most} towards zero speed cannot be excluded")),
            }
        }
        (None, None) => (false, "A rise of friction towards zero speed is not determined by this run".to_owned()),
    }
}

/// What separates the effects that this run leaves open.
fn advice(is_drag_possible: bool, is_explained: bool, is_decided: bool) -> Option<&'static str> {
    match (is_drag_possible, is_explained, is_decided) {
        (true, ..) => Some(
            "To distinguish the two effects, open the run in the workbench or diagnose its export (jointbench export \
             RUN, jointbench diagnose run-RUN.csv). If they remain confounded, repeat the run with twice as many \
             fast_speeds.",
        ),
        (false, false, _) => Some(
            "To find the missing effect, open the run in the workbench or diagnose its export (jointbench export RUN, \
             jointbench diagnose run-RUN.csv).",
        ),
        (false, true, false) => Some(
            "Another effect may mask the Stribeck effect. Diagnose the run first (jointbench export RUN, jointbench \
             diagnose run-RUN.csv). Otherwise repeat it with more repeats or a lower stribeck_speed_rad_s.",
        ),
        (false, true, true) => None,
    }
}

/// `expected_rad_s` is the Stribeck velocity at the link for which the run was planned.
pub(super) fn identify(expected_rad_s: f64, run: &RunTable) -> Result<Identification, Unusable> {
    let free = free(run);
    if ![1.0, -1.0].iter().all(|sign| free.iter().any(|leg| leg.direction == *sign)) {
        return Err(Unusable::InsufficientData("One unloaded step in each direction is required.", "Repeat the run."));
    }
    let fits = Fits::of(run, &free)?;
    let (whole, points) = (&fits.whole, &fits.points);
    let gear = run.meta().gear_ratio.unwrap_or(1.0);
    let (sides, differences) = (fits.sides(), fits.differences());
    let hidden_nm = match whole.stribeck {
        Some(_) => None,
        None => hidden_rise_nm(points, expected_rad_s * gear),
    };
    let of_directions = [
        directions("Coulomb friction", differences[0], "Nm"),
        directions("viscous friction", differences[1], "Nm·s/rad"),
    ]
    .join("; ");
    let mut quantities = fits.quantities(&sides, gear);
    let [coulomb, viscous] = [
        ["tau_c_difference", "τ_c⁺ − τ_c⁻", "Coulomb friction (motor), difference between directions", "Nm"],
        ["c_v_difference", "c_v⁺ − c_v⁻", "Viscous friction (motor), difference between directions", "Nm·s/rad"],
    ];
    quantities.extend([quantity_of(coulomb, differences[0]), quantity_of(viscous, differences[1])]);
    quantities.extend(hidden_nm.map(|most_nm| {
        quantity(
            ["tau_s_most", "τ_s", "Maximum rise towards zero speed that cannot be excluded (motor)", "Nm"],
            most_nm,
            None,
        )
    }));
    let (is_rise_decided, rise) = rise(whole, hidden_nm, gear);
    let rest = rest(&sides, whole);
    let drag = fits.with_drag_nm.map(|coulomb_nm| {
        let coulomb = words::figure(coulomb_nm, "Nm");
        format!(" Quadratic drag explains this run equally well; Coulomb friction would then be {coulomb}.")
    });
    // The parameters of a curve over speed are not reported if friction depends on something else.
    let is_decided = is_rise_decided && drag.is_none() && rest.is_none();
    Ok(Identification {
        verdict: if is_decided { Verdict::Identified } else { Verdict::Inconclusive },
        advice: advice(drag.is_some(), rest.is_none(), is_decided).map(str::to_owned),
        summary: format!(
            "Coulomb friction {}, viscous friction {} (motor side). {rise}. {of_directions}.{}{}",
            words::figure(whole.coulomb.0, "Nm"),
            words::figure(whole.viscous.0, "Nm·s/rad"),
            drag.unwrap_or_default(),
            rest.map(|rest| format!(" {rest}")).unwrap_or_default()
        ),
        quantities,
        figures: vec![over_speed(points, whole), near_zero(points, whole, gear)],
        ..Identification::default()
    })
}

fn parameters(of: &FreeFriction, gear: f64) -> Vec<Quantity> {
    let one = |name, symbol, title, unit, figure| quantity_of([name, symbol, title, unit], figure);
    let mut out = vec![
        one("tau_c", "τ_c", "Coulomb friction (motor)", "Nm", of.coulomb),
        one("c_v", "c_v", "Viscous friction (motor)", "Nm·s/rad", of.viscous),
    ];
    if let (Some(stribeck), Some(breakaway)) = (&of.stribeck, of.breakaway()) {
        let link = |v: f64| v / gear;
        out.extend([
            one("tau_h", "τ_h", "Friction at zero speed (motor)", "Nm", breakaway),
            one(
                "omega_s",
                "θ̇_s",
                "Stribeck velocity (link)",
                "rad/s",
                (link(stribeck.speed.0), stribeck.speed.1.map(link)),
            ),
            one("delta_s", "δ_s", "Stribeck exponent", "", stribeck.exponent),
        ]);
    }
    out
}

fn quantity_of(words: [&str; 4], figure: Figured) -> Quantity {
    quantity(words, figure.0, Some(figure.1))
}

fn over_speed(points: &[Plateau], whole: &FreeFriction) -> Figure {
    let top = points.iter().map(|p| p.velocity_rad_s.abs()).fold(0.0, f64::max);
    let mut series = sides(points, 1.0);
    series.push(curve("model, positive", [0.0, top], 200, |v| whole.at(v)).in_group("positive"));
    series.push(curve("model, negative", [-top, 0.0], 200, |v| -whole.at(-v)).in_group("negative"));
    // The line of table 4.5: through the points of each direction above the Stribeck region.
    let clear = 3.0 * whole.stribeck.as_ref().map_or(0.0, |s| s.speed.0);
    for sign in [1.0, -1.0] {
        let fast = points.iter().filter(|p| p.velocity_rad_s * sign > clear);
        let fast: Vec<(f64, f64)> = fast.map(|p| (p.velocity_rad_s, friction_nm(p))).collect();
        let slowest = fast.iter().map(|(speed, _)| speed.abs()).fold(top, f64::min);
        if slowest <= LINE_SPAN * top
            && let Some(line) = Line::through(&fast)
        {
            let way = if sign > 0.0 { "positive" } else { "negative" };
            let label = format!("line, {way}, r² = {:.4}", line.r2);
            let ends = if sign > 0.0 { [0.0, top] } else { [-top, 0.0] };
            series.push(curve(&label, ends, 1, |v| line.at(v)).in_group(way));
        }
    }
    figure("friction_over_speed", "Friction over motor speed", "motor velocity", series)
}

/// Figures 4.12 to 4.18 show the low speeds over the link velocity.
fn near_zero(points: &[Plateau], whole: &FreeFriction, gear: f64) -> Figure {
    let top = 5.0 * whole.stribeck.as_ref().map_or(0.1 * gear, |s| s.speed.0);
    let near: Vec<Plateau> = points.iter().copied().filter(|p| p.velocity_rad_s.abs() <= top).collect();
    let mut series = sides(&near, gear);
    series.push(curve("model, positive", [0.0, top / gear], 200, |v| whole.at(v * gear)).in_group("positive"));
    series.push(curve("model, negative", [-top / gear, 0.0], 200, |v| -whole.at(-v * gear)).in_group("negative"));
    figure("friction_near_zero", "Friction near zero speed", "link velocity", series)
}

fn sides(points: &[Plateau], gear: f64) -> Vec<Series> {
    let side = |label, sign: f64| {
        let own = points.iter().filter(move |p| p.velocity_rad_s * sign > 0.0);
        scatter(label, own.map(|p| (p.velocity_rad_s / gear, friction_nm(p))))
    };
    vec![side("positive", 1.0), side("negative", -1.0)]
}

fn figure(name: &str, title: &str, over: &str, series: Vec<Series>) -> Figure {
    Figure {
        name: name.into(),
        title: title.into(),
        form: Form::Cartesian,
        x: Axis::of(over, "rad/s"),
        y: Axis::of("friction torque (motor)", "Nm"),
        series,
    }
}
