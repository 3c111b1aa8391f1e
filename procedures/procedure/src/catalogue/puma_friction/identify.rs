//! Lines of voltage over speed for each direction, and stiction, in the units of Corke 1994: volts, and degrees in
//! a second at the link. The same results are also given in newton metres at the motor.

use super::super::breakaway::ramps::{Onset, onsets, ramp_step_nm};
use super::super::breakaway::torques::with_resolution;
use super::settling_s;
use crate::findings::{Hold, Line, Mean, Unusable, combined, curve, directions, holds, quantity, scatter};
use crate::identification::{Axis, Direction, Figure, Form, Identification, Quantity, Verdict};
use crate::parameter::Values;
use jointbench_instrument::RunTable;
use jointbench_model::words;

/// Sections of the arc over which the volts in a figure are averaged.
const ANGLES: usize = 24;

/// One speed in one direction, within the common arc.
struct Point {
    deg_s: f64,
    volts: f64,
    /// Change of the voltage for each unit of the sine of the link angle.
    per_sine: f64,
}

struct Figures<'a> {
    /// Settling time of the joint at a constant speed.
    settle_s: f64,
    volts: Vec<f64>,
    link_rad: Vec<f64>,
    time_s: &'a [f64],
}

pub(super) fn identify(values: &Values, run: &RunTable) -> Result<Identification, Unusable> {
    let meta = run.meta();
    let fact = |name: &str| meta.other.get(name).and_then(serde_json::Value::as_f64);
    let (Some(warm_up), Some(count), Some(planned), Some(scale), Some(position), Some(current), Some(setpoint)) = (
        fact("warm_up_segments"),
        fact("line_segments"),
        fact("segments"),
        fact("amperes_per_volt"),
        run.column("motor_position_rad"),
        run.column("motor_current_a"),
        run.column("motor_current_setpoint_a"),
    ) else {
        return Err(Unusable::InsufficientData("The run belongs to another procedure.", "Run puma_friction."));
    };
    let gear = meta.gear_ratio.unwrap_or(1.0);
    let km = meta.torque_constant_nm_per_a.unwrap_or(1.0);
    let settle_s = settling_s(fact("setpoint_interval_s"));
    let figures = Figures {
        settle_s,
        volts: current.iter().map(|a| a / scale).collect(),
        link_rad: position.iter().map(|rad| rad / gear).collect(),
        time_s: run.column("time_s").unwrap_or_default(),
    };
    let holds = measured(run, [warm_up, count, planned].map(|number| number as i64), settle_s);
    let (points, arc_rad) = figures.points(&holds)?;
    let lines = Lines::through(&points)?;
    let stiction = Stiction::of(values, run, setpoint, [km, scale], &lines, &figures);
    let nm_per_v = km * scale;
    let mut quantities = lines.quantities();
    quantities.extend(stiction.quantities());
    quantities.extend(lines.at_motor(nm_per_v, nm_per_v * gear.recip().to_degrees()));
    quantities.extend(stiction.at_motor(nm_per_v));
    let over_volts = over_speed(&points, &lines.forward, &lines.backward);
    let complete = stiction.is_complete();
    Ok(Identification {
        verdict: if complete { Verdict::Identified } else { Verdict::Inconclusive },
        summary: format!(
            "Coulomb friction (motor side): {} in positive, {} in negative direction. {}.",
            words::figure(nm_per_v * lines.forward.offset, "Nm"),
            words::figure(nm_per_v * lines.backward.offset, "Nm"),
            lines.comparison(),
        ),
        advice: (!complete)
            .then(|| "Not all breakaway events were detected. Increase top_torque_nm or breakaways.".into()),
        quantities,
        figures: vec![over_volts.clone(), in_torque(over_volts, nm_per_v), figures.over_angle(&holds, arc_rad)],
        ..Identification::default()
    })
}

/// Voltage over link speed in both directions, and the change of the voltage for each unit of the sine of the link
/// angle.
struct Lines {
    forward: Line,
    backward: Line,
    weight: Mean,
}

impl Lines {
    fn through(points: &[Point]) -> Result<Self, Unusable> {
        let slopes: Vec<f64> = points.iter().map(|point| point.per_sine).collect();
        let weight = Mean::of(&slopes).ok_or(FEW)?;
        let side = |sign: f64| -> Vec<(f64, f64)> {
            points.iter().filter(|p| p.deg_s * sign > 0.0).map(|p| (p.deg_s, p.volts)).collect()
        };
        let (forward, backward) = (Line::through(&side(1.0)).ok_or(FEW)?, Line::through(&side(-1.0)).ok_or(FEW)?);
        Ok(Self { forward, backward, weight })
    }

    /// Difference of the magnitudes of f; f⁻ is negative, so that it is the sum.
    fn f_difference(&self) -> (f64, [f64; 2]) {
        let offset = |line: &Line| (line.offset, line.offset_ci95);
        combined(offset(&self.forward), offset(&self.backward), 1.0)
    }

    fn b_difference(&self) -> (f64, [f64; 2]) {
        let slope = |line: &Line| (line.slope, line.slope_ci95);
        combined(slope(&self.forward), slope(&self.backward), -1.0)
    }

    /// The viscous friction of a linear model (Corke 1994, section 3.1).
    fn b_mean(&self) -> (f64, [f64; 2]) {
        let half = |line: &Line| (0.5 * line.slope, line.slope_ci95.map(|end| 0.5 * end));
        combined(half(&self.forward), half(&self.backward), 1.0)
    }

    fn quantities(&self) -> Vec<Quantity> {
        let mut quantities = sides(&self.forward, &self.backward);
        quantities.extend([
            named(["b_mean", "B", "Viscous friction, mean of both directions", "V/(°/s)"], self.b_mean()),
            named(
                ["f_difference", "|f⁺| − |f⁻|", "Coulomb friction, difference between directions", "V"],
                self.f_difference(),
            ),
            named(
                ["b_difference", "B⁺ − B⁻", "Viscous friction, difference between directions", "V/(°/s)"],
                self.b_difference(),
            ),
            named(
                ["weight", "g", "Gravity torque, link horizontal", "V"],
                (-self.weight.value, [-self.weight.ci95[1], -self.weight.ci95[0]]),
            ),
        ]);
        quantities
    }

    /// The same in newton metres at the motor, as magnitudes.
    fn at_motor(&self, nm_per_v: f64, nm_s_per_slope: f64) -> Vec<Quantity> {
        let mut all = Vec::new();
        for (direction, line) in Direction::ALL.into_iter().zip([&self.forward, &self.backward]) {
            let (offset, slope) = (
                magnitude(line.offset, line.offset_ci95, nm_per_v),
                magnitude(line.slope, line.slope_ci95, nm_s_per_slope),
            );
            let coulomb = named(["tau_c", "τ_c", "Coulomb friction (motor)", "Nm"], offset);
            let viscous = named(["c_v", "c_v", "Viscous friction (motor)", "Nm·s/rad"], slope);
            all.extend([coulomb, viscous].map(|one| one.in_direction(direction)));
        }
        let (mean, ci95) = self.b_mean();
        let viscous = ["c_v_mean", "c_v", "Viscous friction (motor), mean of both directions", "Nm·s/rad"];
        all.push(named(viscous, magnitude(mean, ci95, nm_s_per_slope)));
        all
    }

    fn comparison(&self) -> String {
        let coulomb = directions("Coulomb friction", self.f_difference(), "V");
        format!("{coulomb}; {}", directions("viscous friction", self.b_difference(), "V/(°/s)"))
    }
}

/// Breakaway of both directions in volts, corrected for gravity.
struct Stiction {
    positive: Option<Mean>,
    negative: Option<Mean>,
    /// Ramps that reached the highest torque without motion.
    held: usize,
}

impl Stiction {
    /// `km` [Nm/A] is the torque constant, `scale` [A/V] that of the shunt.
    fn of(
        values: &Values,
        run: &RunTable,
        setpoint_a: &[f64],
        [km, scale]: [f64; 2],
        lines: &Lines,
        figures: &Figures<'_>,
    ) -> Self {
        let top_a = values.number("top_torque_nm") / km;
        let (onsets, held) = onsets(run, setpoint_a, values.count("increases") as usize, top_a);
        // Gravity acts outside the upright pose and is corrected.
        let volts = |onset: &Onset| onset.current_a / scale - lines.weight.value * figures.link_rad[onset.row].sin();
        let stiction = |sign: f64| -> Option<Mean> {
            let of_side = onsets.iter().filter(|o| o.current_a * sign > 0.0).map(volts).collect::<Vec<_>>();
            Mean::of(&of_side).map(|mean| with_resolution(mean, ramp_step_nm(values) / km / scale))
        };
        Self { positive: stiction(1.0), negative: stiction(-1.0), held }
    }

    fn is_complete(&self) -> bool {
        self.held == 0 && self.positive.is_some() && self.negative.is_some()
    }

    fn quantities(&self) -> Vec<Quantity> {
        self.sides("stiction", |mean| (mean.value, mean.ci95), "Breakaway (static) friction", "V")
    }

    /// The same in newton metres at the motor, as magnitudes.
    fn at_motor(&self, nm_per_v: f64) -> Vec<Quantity> {
        let [title, unit] = ["Breakaway (static) friction (motor)", "Nm"];
        self.sides("tau_s", |mean| magnitude(mean.value, mean.ci95, nm_per_v), title, unit)
    }

    fn sides(&self, name: &str, value: impl Fn(&Mean) -> (f64, [f64; 2]), title: &str, unit: &str) -> Vec<Quantity> {
        let of_side = |(direction, mean): (Direction, &Option<Mean>)| {
            mean.as_ref().map(|mean| named([name, "τ_s", title, unit], value(mean)).in_direction(direction))
        };
        Direction::ALL.into_iter().zip([&self.positive, &self.negative]).filter_map(of_side).collect()
    }
}

const FEW: Unusable = Unusable::InsufficientData("Too few speeds were measured.", "Repeat the run.");

/// The uninterrupted holds of constant speed after the work-out.
fn measured(run: &RunTable, [first, count, planned]: [i64; 3], settle_s: f64) -> Vec<Hold> {
    let segment = run.column("segment").unwrap_or_default();
    // A step that was repeated after a pause has a new number: it belongs to the rows before it.
    let mut belongs = false;
    holds(run, 2.0 * settle_s)
        .into_iter()
        .filter(|hold| {
            if hold.segment < planned {
                belongs = (first..first + count).contains(&hold.segment);
            }
            let is_continued = segment.get(hold.rows.end).is_some_and(|next| *next as i64 == hold.segment);
            belongs && is_continued && hold.velocity_rad_s != 0.0
        })
        .collect()
}

impl Figures<'_> {
    /// The rows of a hold after the settling time.
    fn settled(&self, hold: &Hold) -> std::ops::Range<usize> {
        let from_s = self.time_s[hold.rows.start] + self.settle_s;
        let start = hold.rows.clone().find(|row| self.time_s[*row] >= from_s).unwrap_or(hold.rows.end);
        start..hold.rows.end
    }

    /// Means over the largest arc around the upright pose that every hold covers, and half of that arc.
    fn points(&self, holds: &[Hold]) -> Result<(Vec<Point>, f64), Unusable> {
        let reach = |hold: &Hold| {
            let rows = self.settled(hold);
            let (first, last) = (self.link_rad[rows.start.min(hold.rows.end - 1)], self.link_rad[hold.rows.end - 1]);
            // Distance to the nearer side of 0; negative if it does not pass 0.
            (-first * last.signum()).min(last.abs())
        };
        let arc_rad = holds.iter().map(reach).fold(f64::INFINITY, f64::min);
        if !(arc_rad > 0.0 && arc_rad.is_finite()) {
            return Err(Unusable::InsufficientData(
                "The link did not pass its upright pose.",
                "Set it upright (encoder at 0) and repeat the run.",
            ));
        }
        let points: Vec<Point> = holds.iter().filter_map(|hold| self.point(hold, arc_rad)).collect();
        Ok((points, arc_rad))
    }

    fn point(&self, hold: &Hold, arc_rad: f64) -> Option<Point> {
        let rows: Vec<usize> = self.settled(hold).filter(|row| self.link_rad[*row].abs() <= arc_rad).collect();
        let (first, last) = (*rows.first()?, *rows.last()?);
        let count = rows.len() as f64;
        let mean = |of: &dyn Fn(usize) -> f64| rows.iter().map(|row| of(*row)).sum::<f64>() / count;
        let sine = |row: usize| self.link_rad[row].sin();
        let (volts, centre) = (mean(&|row| self.volts[row]), mean(&sine));
        let spread = mean(&|row| (sine(row) - centre).powi(2));
        let per_sine = mean(&|row| (sine(row) - centre) * (self.volts[row] - volts)) / spread;
        let way_rad = self.link_rad[last] - self.link_rad[first];
        let deg_s = (way_rad / (self.time_s[last] - self.time_s[first])).to_degrees();
        // The arc is symmetric about 0, so that the remaining gravity torque is the difference of its ends.
        Some(Point { deg_s, volts: volts - per_sine * centre, per_sine })
            .filter(|p| p.volts.is_finite() && p.deg_s != 0.0)
    }

    fn over_angle(&self, holds: &[Hold], arc_rad: f64) -> Figure {
        let side = |label, sign: f64| {
            let mut sums = [(0.0, 0.0); ANGLES];
            for row in holds.iter().filter(|hold| hold.velocity_rad_s * sign > 0.0).flat_map(|hold| self.settled(hold))
            {
                let part = (self.link_rad[row] / arc_rad + 1.0) / 2.0 * ANGLES as f64;
                if (0.0..ANGLES as f64).contains(&part) {
                    let sum = &mut sums[part as usize];
                    *sum = (sum.0 + self.volts[row], sum.1 + 1.0);
                }
            }
            let angle = |part: usize| arc_rad * (2.0 * (part as f64 + 0.5) / ANGLES as f64 - 1.0);
            let seen = sums.into_iter().enumerate().filter(|(_, (_, count))| *count > 0.0);
            scatter(label, seen.map(|(part, (volts, count))| (angle(part).to_degrees(), volts / count)))
        };
        Figure {
            name: "volts_over_angle".into(),
            title: "Shunt voltage over link angle, all speeds".into(),
            form: Form::Cartesian,
            x: Axis::of("angle from upright (link)", "°"),
            y: Axis::of("shunt voltage", "V"),
            series: vec![side("positive", 1.0), side("negative", -1.0)],
        }
    }
}

/// The magnitude of a scaled value and its interval.
fn magnitude(value: f64, ci95: [f64; 2], scale: f64) -> (f64, [f64; 2]) {
    let ends = ci95.map(|end| end * scale * value.signum());
    ((value * scale).abs(), [ends[0].min(ends[1]), ends[0].max(ends[1])])
}

fn named(words: [&str; 4], (value, ci95): (f64, [f64; 2])) -> Quantity {
    quantity(words, value, Some(ci95))
}

/// The table of figure 3.2.
fn sides(forward: &Line, backward: &Line) -> Vec<Quantity> {
    let mut all = Vec::new();
    for (direction, line) in Direction::ALL.into_iter().zip([forward, backward]) {
        let of_line = [
            quantity(["b", "B", "Viscous friction", "V/(°/s)"], line.slope, Some(line.slope_ci95)),
            quantity(["f", "f", "Coulomb friction", "V"], line.offset, Some(line.offset_ci95)),
            quantity(["r2", "r²", "Coefficient of determination", ""], line.r2, None),
        ];
        all.extend(of_line.map(|one| one.in_direction(direction)));
    }
    all
}

fn over_speed(points: &[Point], forward: &Line, backward: &Line) -> Figure {
    let top = points.iter().map(|p| p.deg_s.abs()).fold(0.0, f64::max);
    let side = |label, sign: f64| {
        scatter(label, points.iter().filter(move |p| p.deg_s * sign > 0.0).map(|p| (p.deg_s, p.volts)))
    };
    Figure {
        name: "volts_over_speed".into(),
        title: "Shunt voltage over speed".into(),
        form: Form::Cartesian,
        x: Axis::of("speed (link)", "°/s"),
        y: Axis::of("shunt voltage", "V"),
        series: vec![
            side("positive", 1.0),
            side("negative", -1.0),
            curve("line, positive", [0.0, top], 1, |x| forward.at(x)).in_group("positive"),
            curve("line, negative", [-top, 0.0], 1, |x| backward.at(x)).in_group("negative"),
        ],
    }
}

/// The same figure in newton metres at the motor.
fn in_torque(volts: Figure, nm_per_v: f64) -> Figure {
    let series = volts.series.into_iter().map(|mut one| {
        one.y.iter_mut().for_each(|y| *y *= nm_per_v);
        one.band.iter_mut().flatten().for_each(|end| *end *= nm_per_v);
        one
    });
    Figure {
        name: "torque_over_speed".into(),
        title: "Motor torque over speed".into(),
        y: Axis::of("motor torque", "Nm"),
        series: series.collect(),
        ..volts
    }
}
