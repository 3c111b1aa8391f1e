//! Contradictions between columns: angles that wrap after a turn, and velocities whose unit differs from the slope of
//! their position. Corrections are proposed to the user, never applied.

use crate::ProposedOption;
use crate::column::Column;
use crate::note::Note;
use jointbench_instrument::{Kind, RunTable};
use std::f64::consts::TAU;

/// Unwraps an angle that wraps after a period.
pub fn unwrap(values: &mut [f64], period: f64) {
    let mut turns = 0.0;
    let mut before = values.first().copied().unwrap_or(0.0);
    for value in values {
        let step = *value - before;
        before = *value;
        turns -= (step / period).round();
        *value += turns * period;
    }
}

/// Proposed corrections for the columns of a run, each with its option.
pub fn proposals(run: &RunTable) -> Vec<Note> {
    let angles: &[&str] = match run.kind() {
        Kind::Friction | Kind::Stiffness => &["motor_position_rad", "link_position_rad"],
        Kind::Encoder => &["reference_position_rad", "test_position_rad"],
        Kind::Brake => &["position_rad"],
    };
    // The difference of two encoders wraps by definition.
    let may_wrap = run.kind() == Kind::Encoder;
    let leaps = |name: &str| wrapped(run, name).filter(|_| !may_wrap).or_else(|| in_degrees(run, name));
    let wrapped: Vec<Note> = angles.iter().filter_map(|name| leaps(name)).collect();
    let (speed, angle) = motion(run.kind());
    // A wrapped angle has no valid slope.
    let slope = if wrapped.is_empty() { slope(run, speed, angle) } else { None };
    let power = if wrapped.is_empty() && slope.is_none() { taken_power(run) } else { None };
    wrapped.into_iter().chain(slope).chain(power).collect()
}

/// A velocity, and the angle from which it derives.
fn motion(kind: Kind) -> (&'static str, &'static str) {
    match kind {
        Kind::Friction => ("motor_velocity_rad_s", "motor_position_rad"),
        Kind::Stiffness => ("link_velocity_rad_s", "link_position_rad"),
        Kind::Encoder => ("velocity_rad_s", "reference_position_rad"),
        Kind::Brake => ("velocity_rad_s", "position_rad"),
    }
}

/// An angle that moves by this much is not at rest [rad].
const MOVES: f64 = 0.1;

/// A velocity that is 0 in every row while its angle moves, with the note about it.
pub fn idle_velocity(columns: &[Column], kind: Kind) -> Option<(usize, Note)> {
    let (speed, angle) = motion(kind);
    let place = columns.iter().position(|column| column.name == speed)?;
    let angles = &columns.iter().find(|column| column.name == angle)?.values;
    let (low, high) = angles.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let is_idle = columns[place].values.iter().all(|value| *value == 0.0);
    (is_idle && high - low > MOVES).then(|| {
        let moved = high - low;
        let message = format!(
            "“{speed}” stays at 0 in every row, while “{angle}” moves by {moved:.3} rad: the column is omitted, and the velocity is the slope of the position"
        );
        (place, Note::with(message, ProposedOption::new("leave", speed)))
    })
}

/// Wraps of an angle differ by at most this fraction and exceed `LEAP_OF_RANGE` of its range.
const SAME_LEAP: f64 = 0.05;
const LEAP_OF_RANGE: f64 = 0.8;
/// Least number of changes of an angle for each wrap.
const MOVES_EACH_LEAP: usize = 4;

fn wrapped(run: &RunTable, name: &str) -> Option<Note> {
    let values = run.column(name)?;
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let range = high - low;
    // A wrap is the period minus one step, which is about as long as the step before.
    let leap = |w: &[f64]| (w[2] - w[1], (w[2] - w[1] - (w[1] - w[0])).abs());
    let leaps: Vec<f64> = values
        .windows(3)
        .map(leap)
        .filter(|(step, _)| step.abs() > LEAP_OF_RANGE * range)
        .map(|(_, leap)| leap)
        .collect();
    // Between wraps an angle moves: a held encoder that changes by one count only leaps.
    let moves = values.windows(2).filter(|pair| pair[0] != pair[1]).count();
    if moves < MOVES_EACH_LEAP * leaps.len() {
        return None;
    }
    let mean = leaps.iter().sum::<f64>() / leaps.len() as f64;
    let is_one_size = leaps.iter().all(|leap| (leap / mean - 1.0).abs() < SAME_LEAP);
    // Most encoders wrap after a turn, even if their samples do not reach its ends.
    let is_turn = (mean / TAU - 1.0).abs() < LEAP_OF_RANGE / 4.0 && range <= TAU * 1.001;
    if leaps.len() < 2 || !is_one_size || range <= 0.0 {
        return None;
    }
    if (mean / DEGREES - 1.0).abs() < SAME_LEAP {
        let message =
            format!("“{name}” jumps by {mean:.1} {} times: perhaps it is in degrees within a turn", leaps.len());
        return Some(Note::with(message, ProposedOption::new("unit", format!("{name}=deg")).and("unwrap", name)));
    }
    let period = if is_turn { String::new() } else { format!("={mean:.4}") };
    let message = format!("“{name}” jumps by {mean:.3} rad {} times, as an angle that wraps after a turn", leaps.len());
    Some(Note::with(message, ProposedOption::new("unwrap", format!("{name}{period}"))))
}

/// Degrees in a turn, and the tolerance at its ends.
const DEGREES: f64 = 360.0;
const END_TOLERANCE: f64 = 2.0;

/// From 0 to 360, or from -180 to 180: one turn in degrees. A motor behind a gear may turn by as many radians, but hardly
/// between these ends.
fn in_degrees(run: &RunTable, name: &str) -> Option<Note> {
    let values = run.column(name)?;
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let is_turn = |from: f64| (low - from).abs() < END_TOLERANCE && (high - from - DEGREES).abs() < END_TOLERANCE;
    [0.0, -DEGREES / 2.0].into_iter().any(is_turn).then(|| {
        let message = format!("“{name}” ranges from {low:.1} to {high:.1} rad: perhaps it is in degrees");
        Note::with(message, ProposedOption::new("unit", format!("{name}=deg")))
    })
}

/// Fraction of the total work above which the motor only absorbs power.
const TAKES: f64 = 0.8;

/// A motor that drives a joint against friction supplies power. If it only absorbs power, its current has the wrong
/// sign, or another machine drives the joint.
fn taken_power(run: &RunTable) -> Option<Note> {
    if run.kind() != Kind::Friction || run.column("link_torque_nm").is_some() {
        return None;
    }
    let (angles, currents) = (run.column("motor_position_rad")?, run.column("motor_current_a")?);
    let work = |row: usize| 0.5 * (currents[row] + currents[row - 1]) * (angles[row] - angles[row - 1]);
    let (sum, both) = (1..angles.len()).map(work).fold((0.0, 0.0), |(sum, both), work| (sum + work, both + work.abs()));
    (sum < -TAKES * both).then(|| {
        let message =
            "“motor_current_a” opposes nearly all motion, and a motor drives its joint: perhaps it has the other sign";
        Note::with(message, ProposedOption::new("scale", "motor_current_a=-1"))
    })
}

/// Number of rows for a slope.
const OVER: usize = 20;
/// Smallest shared fraction of the variance for two columns that describe the same quantity.
const SAME: f64 = 0.9;
/// Tolerance between a ratio and the ratio of two units.
const NEAR: f64 = 0.04;

fn slope(run: &RunTable, speed: &str, angle: &str) -> Option<Note> {
    let (speeds, angles, time_s) = (run.column(speed)?, run.column(angle)?, run.column("time_s")?);
    let (mut aa, mut ab, mut bb) = (0.0, 0.0, 0.0);
    for from in (0..speeds.len().saturating_sub(OVER)).step_by(OVER) {
        let to = from + OVER;
        let way = (angles[to] - angles[from]) / (time_s[to] - time_s[from]);
        // Trapezoidal rule.
        let ends = 0.5 * (speeds[from] + speeds[to]);
        let mean = (speeds[from + 1..to].iter().sum::<f64>() + ends) / OVER as f64;
        (aa, ab, bb) = (aa + mean * mean, ab + mean * way, bb + way * way);
    }
    if ab * ab < SAME * aa * bb || bb <= 0.0 {
        return None;
    }
    let ratio = ab / bb;
    if (ratio - 1.0).abs() < NEAR {
        return None;
    }
    let gear = run.meta().gear_ratio.unwrap_or(f64::NAN);
    let is = |wanted: f64| (ratio / wanted - 1.0).abs() < NEAR;
    let unit = |column: &str, unit: &str| ProposedOption::new("unit", format!("{column}={unit}"));
    let scale = |column: &str, factor: f64| ProposedOption::new("scale", format!("{column}={factor}"));
    let (guess, option) = match () {
        () if is(60.0 / TAU) => ("it is in rpm".to_owned(), unit(speed, "rpm")),
        () if is(360.0 / TAU) => ("it is in deg/s".to_owned(), unit(speed, "deg/s")),
        () if is(1.0 / TAU) => ("it is in turns/s".to_owned(), unit(speed, "rev/s")),
        () if is(TAU / 360.0) => (format!("“{angle}” is in degrees"), unit(angle, "deg")),
        () if is(TAU) => (format!("“{angle}” is in turns"), unit(angle, "rev")),
        () if is(-1.0) => ("it has the other sign".to_owned(), scale(speed, -1.0)),
        () if is(gear) => (format!("“{angle}” is that of the other side of the gear"), scale(angle, gear)),
        () if is(1.0 / gear) => ("it is that of the other side of the gear".to_owned(), scale(speed, gear)),
        () => return None,
    };
    Some(Note::with(format!("“{speed}” is {ratio:.3} times the slope of “{angle}”: perhaps {guess}"), option))
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_instrument::{Channel, Meta, Trace};

    fn run(speed: f64, angle: impl Fn(f64) -> f64) -> RunTable {
        let names = ["time_s", "motor_position_rad", "motor_velocity_rad_s", "motor_current_a"];
        let mut trace = Trace::new(names.map(Channel::new).to_vec());
        for row in 0..2000 {
            let t = f64::from(row) * 0.005;
            trace.push_row(&[t, angle(20.0 * t.sin()), speed * 20.0 * t.cos(), 0.1]);
        }
        let meta = Meta { kind: Some(Kind::Friction), gear_ratio: Some(50.0), ..Meta::default() };
        RunTable::new(meta, trace).unwrap()
    }

    #[test]
    fn a_unit_or_a_sign_is_proposed_from_the_slope() {
        let proposal = |speed, angle: f64| proposals(&run(speed, |x| x * angle)).first().map(Note::to_string);
        assert_eq!(proposal(1.0, 1.0), None);
        assert!(proposal(9.5493, 1.0).unwrap().ends_with("perhaps it is in rpm (--unit motor_velocity_rad_s=rpm)"));
        assert!(proposal(-1.0, 1.0).unwrap().ends_with("(--scale motor_velocity_rad_s=-1)"));
        assert!(proposal(1.0, 57.29578).unwrap().ends_with("(--unit motor_position_rad=deg)"));
        assert!(proposal(0.02, 1.0).unwrap().contains("other side of the gear"));
        assert_eq!(proposal(1.5, 1.0), None, "no unit is like that");
    }

    #[test]
    fn a_motor_that_only_takes_work_has_a_current_of_the_other_sign() {
        let names = ["time_s", "motor_position_rad", "motor_current_a"];
        let run = |sign: f64| {
            let mut trace = Trace::new(names.map(Channel::new).to_vec());
            for row in 0..2000 {
                let t = f64::from(row) * 0.005;
                trace.push_row(&[t, 20.0 * t.sin(), sign * (0.5 * t.cos().signum() - 0.05 * t.sin())]);
            }
            RunTable::new(Meta { kind: Some(Kind::Friction), ..Meta::default() }, trace).unwrap()
        };
        assert_eq!(proposals(&run(1.0)), []);
        assert_eq!(proposals(&run(-1.0))[0].option, Some(ProposedOption::new("scale", "motor_current_a=-1")));
    }

    #[test]
    fn a_velocity_that_stays_at_0_is_reported() {
        let columns = |speed: f64, way: f64| {
            let values = |by: f64| (0..10).map(|row| by * f64::from(row)).collect();
            vec![Column::new("motor_position_rad", values(way)), Column::new("motor_velocity_rad_s", values(speed))]
        };
        let (place, note) = idle_velocity(&columns(0.0, 1.0), Kind::Friction).unwrap();
        assert!(
            place == 1
                && note.message.contains(
                    "“motor_velocity_rad_s” stays at 0 in every row, while “motor_position_rad” moves by 9.000"
                )
        );
        assert!(idle_velocity(&columns(1.0, 1.0), Kind::Friction).is_none());
        assert!(idle_velocity(&columns(0.0, 1e-3), Kind::Friction).is_none(), "at rest");
    }

    #[test]
    fn an_angle_over_360_is_in_degrees() {
        let proposal = |angle: &dyn Fn(f64) -> f64| proposals(&run(1.0, angle)).first().map(Note::to_string);
        let turns = proposal(&|x| x.to_degrees().rem_euclid(360.0)).unwrap();
        assert!(turns.ends_with("(--unit motor_position_rad=deg --unwrap motor_position_rad)"), "{turns}");
        let one = proposal(&|x| 180.0 + 9.0 * x).unwrap();
        assert!(
            one.contains("ranges from 0.0 to 360.0 rad") && one.ends_with("--unit motor_position_rad=deg)"),
            "{one}"
        );
        for angle in [&|x| 17.0 * x, &|x| 28.0 + 9.0 * x] as [&dyn Fn(f64) -> f64; 2] {
            assert_eq!(proposal(angle).filter(|message| message.contains("degrees")), None);
        }
    }

    #[test]
    fn a_wrapped_angle_is_reported_and_made_continuous() {
        let wrapped = run(1.0, |x| x.rem_euclid(TAU));
        let message = proposals(&wrapped)[0].to_string();
        assert!(
            message.starts_with("“motor_position_rad” jumps by 6.")
                && message.ends_with("(--unwrap motor_position_rad)"),
            "{message}"
        );
        let mut values = wrapped.column("motor_position_rad").unwrap().to_vec();
        unwrap(&mut values, TAU);
        let whole = run(1.0, |x| x);
        let expected = whole.column("motor_position_rad").unwrap();
        assert!(values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9));
    }
}
