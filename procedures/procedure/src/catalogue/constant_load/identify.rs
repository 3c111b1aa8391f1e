//! Reached torque at each speed, and the torque without readjustment.

use super::CURVE;
use super::curves::{Curves, complete, is_same};
use crate::catalogue::brake_hysteresis::SETTLED;
use crate::findings::{Hold, Mean, Unusable, percentage, quantity, scatter};
use crate::identification::{Axis, Figure, Form, Identification, Mark, Quantity, Series, Verdict};
use crate::parameter::Values;
use jointbench_instrument::RunTable;

/// All holds of the demanded torque at one speed.
struct Reached {
    /// Measured link speed.
    speed_rad_s: f64,
    current_a: f64,
    torque_nm: Mean,
    /// Link velocity and torque of each hold.
    points: Vec<(f64, f64)>,
}

pub fn identify(values: &Values, run: &RunTable) -> Result<Identification, Unusable> {
    const FEW: Unusable =
        Unusable::InsufficientData("The run ended before the torque curves were complete.", "Repeat the run.");
    let curves = Curves::of(run);
    let demanded_nm = curves.demanded_nm(values).map_err(|_| FEW)?;
    let speeds_rad_s: Vec<f64> = curves.0.iter().map(|curve| curve.speed_rad_s).collect();
    if let Err(why) = curves.currents(&speeds_rad_s, demanded_nm) {
        return Ok(Identification::inconclusive(
            format!("The torque was not held: {why}."),
            "Change torque_nm or top_current.",
        ));
    }
    let reached: Vec<Reached> = speeds_rad_s.iter().filter_map(|speed| Reached::at(run, *speed)).collect();
    if reached.is_empty() || reached.len() < curves.0.len() {
        return Err(Unusable::InsufficientData(
            "The demanded torque was not held twice at each speed.",
            "Repeat the run.",
        ));
    }
    let constant = Constant::of(&curves, &reached);
    let error = |one: &Reached| one.torque_nm.value / demanded_nm - 1.0;
    let worst = reached.iter().map(|one| error(one).abs()).fold(0.0, f64::max);
    let change = range(reached.iter().map(|one| one.torque_nm.value)) / demanded_nm;
    let bound = values.number("bound");
    let good = worst <= bound;
    let mut quantities = vec![quantity(["demanded", "T_d", "Demanded torque", "Nm"], demanded_nm, None)];
    for (number, one) in (1..).zip(&reached) {
        quantities.extend(one.quantities(number, demanded_nm));
    }
    quantities.extend([
        percentage(["error_max", "e_max", "Maximum relative difference from the demanded torque"], worst, None),
        percentage(["change", "ΔT/T", "Relative change over speed, readjusted current"], change, None),
        quantity(["current_constant", "I", "Mean of the readjusted currents", "A"], constant.current_a, None),
        percentage(
            ["change_constant", "ΔT/T", "Relative change over speed at this constant current"],
            constant.change,
            None,
        ),
    ]);
    let [low, high] = [&reached[0], &reached[reached.len() - 1]].map(|one| one.speed_rad_s);
    Ok(Identification {
        verdict: if good { Verdict::Identified } else { Verdict::Inconclusive },
        summary: format!(
            "{demanded_nm:.2} Nm at {} speeds from {low:.2} to {high:.2} rad/s: maximum difference {:.2} % (limit {:.1} %). At \
             a constant current of {:.3} A the torque changes by {:.2} % over speed, readjusted by {:.2} %.",
            reached.len(),
            100.0 * worst,
            100.0 * bound,
            constant.current_a,
            100.0 * constant.change,
            100.0 * change,
        ),
        advice: (!good).then(|| "Increase levels or dwell_s, or run with a warm brake.".into()),
        quantities,
        figures: vec![torques(&reached, &constant, demanded_nm), currents(&reached)],
        ..Identification::default()
    })
}

impl Reached {
    /// `None` below two complete holds at this motor-side speed.
    fn at(run: &RunTable, motor_rad_s: f64) -> Option<Self> {
        let column = |name: &str| run.column(name).unwrap_or_default();
        let (torque, velocity) = (column("brake_torque_nm"), column("velocity_rad_s"));
        let is_held = |hold: &Hold| {
            hold.repeat > i64::from(CURVE) && hold.brake > 0.0 && is_same(hold.velocity_rad_s.abs(), motor_rad_s)
        };
        let held: Vec<Hold> = complete(run).into_iter().filter(is_held).collect();
        let points: Vec<(f64, f64)> =
            held.iter().map(|hold| (hold.mean(velocity, SETTLED), hold.mean(torque, SETTLED))).collect();
        let torques_nm: Vec<f64> = points.iter().map(|point| point.1).collect();
        Some(Self {
            speed_rad_s: points.iter().map(|point| point.0.abs()).sum::<f64>() / points.len() as f64,
            current_a: held.first()?.brake,
            torque_nm: Mean::of(&torques_nm)?,
            points,
        })
    }

    fn quantities(&self, number: usize, demanded_nm: f64) -> [Quantity; 3] {
        let at = format!("at {:.2} rad/s", self.speed_rad_s);
        let (value, ends) = (self.torque_nm.value, self.torque_nm.ci95);
        let named = |name: &str, symbol: &str, title: &str, unit: &str, value, ci95| {
            quantity([&format!("{name}_{number}"), symbol, &format!("{title} {at}"), unit], value, ci95)
        };
        let error = |nm: f64| nm / demanded_nm - 1.0;
        [
            named("reached", "T", "Reached torque", "Nm", value, Some(ends)),
            percentage(
                [&format!("error_{number}"), "e", &format!("Relative difference from the demanded torque {at}")],
                error(value),
                Some(ends.map(error)),
            ),
            named("current", "I", "Current", "A", self.current_a, None),
        ]
    }
}

/// The torque at one current for all speeds, from the curves of the same run.
struct Constant {
    current_a: f64,
    change: f64,
    /// Link speed and torque.
    points: Vec<(f64, f64)>,
}

impl Constant {
    fn of(curves: &Curves, reached: &[Reached]) -> Self {
        let current_a = reached.iter().map(|one| one.current_a).sum::<f64>() / reached.len() as f64;
        let points: Vec<(f64, f64)> =
            curves.0.iter().zip(reached).map(|(curve, one)| (one.speed_rad_s, curve.torque_nm(current_a))).collect();
        let mean_nm = points.iter().map(|point| point.1).sum::<f64>() / points.len() as f64;
        Self { current_a, change: range(points.iter().map(|point| point.1)) / mean_nm, points }
    }
}

fn range(values: impl Iterator<Item = f64> + Clone) -> f64 {
    values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
}

fn torques(reached: &[Reached], constant: &Constant, demanded_nm: f64) -> Figure {
    let of_direction = |sign: f64| {
        let points = reached.iter().flat_map(|one| &one.points).filter(move |point| point.0 * sign > 0.0);
        points.map(|(speed, nm)| (speed.abs(), *nm)).collect::<Vec<_>>()
    };
    let line = |label: &str, points: Vec<(f64, f64)>| {
        let (x, y) = points.into_iter().unzip();
        Series::new(label, Mark::Line, x, y)
    };
    let demanded = reached.iter().map(|one| (one.speed_rad_s, demanded_nm)).collect();
    Figure {
        name: "torque_over_speed".into(),
        title: "Torque over speed with readjusted and with constant current".into(),
        form: Form::Cartesian,
        x: Axis::of("link speed", "rad/s"),
        y: Axis::of("torque at the output", "Nm"),
        series: vec![
            scatter("readjusted, positive direction", of_direction(1.0)),
            scatter("readjusted, negative direction", of_direction(-1.0)),
            line("demanded", demanded),
            line(&format!("constant current of {:.3} A", constant.current_a), constant.points.clone()),
        ],
    }
}

fn currents(reached: &[Reached]) -> Figure {
    Figure {
        name: "current_over_speed".into(),
        title: "Readjusted current over speed".into(),
        form: Form::Cartesian,
        x: Axis::of("link speed", "rad/s"),
        y: Axis::of("brake current", "A"),
        series: vec![scatter("readjusted current", reached.iter().map(|one| (one.speed_rad_s, one.current_a)))],
    }
}
