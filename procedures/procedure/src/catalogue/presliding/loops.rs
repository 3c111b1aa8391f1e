//! Data of the presliding loops: the rows at which the encoder count changed, and the displacement of the Dahl model.

use jointbench_instrument::RunTable;

/// A smaller change of position counts as rest (rad).
const STILL_RAD: f64 = 1e-7;

/// One oscillation step: the commanded torques, and the points at which the position is known.
pub struct Swings {
    /// Torque at each row (motor) (Nm).
    pub torque_nm: Vec<f64>,
    /// Row, and motor position (rad) relative to an arbitrary zero of this step.
    pub points: Vec<(usize, f64)>,
    /// The joint broke away and was stopped; the rows before that are kept.
    pub broke_away: bool,
}

/// Centred averaging time of the link torque: with less, noise would look like reversals.
const LINK_S: f64 = 0.25;

/// Every oscillation step that was completed, or that ended with a breakaway.
pub fn swings(run: &RunTable, torque_constant: f64) -> Option<Vec<Swings>> {
    let setpoint_a = run.column("motor_current_setpoint_a")?;
    let position_rad = run.column("motor_position_rad")?;
    let segment = run.column("segment")?;
    let link_nm = run.column("link_torque_nm");
    let (ratio, rate_hz) = (run.meta().gear_ratio.unwrap_or(1.0), run.meta().sample_rate_hz.unwrap_or(250.0));
    let mut all = Vec::new();
    let mut start = 0;
    for rows in segment.chunk_by(|a, b| a == b) {
        let (from, end) = (start, start + rows.len());
        start = end;
        let Some(first) = setpoint_a[from..end].iter().position(|a| *a != 0.0) else { continue };
        // The step starts at rest without torque, where the oscillation begins.
        let from = from + first.saturating_sub(1);
        // A row is read in the tick that sends its set-point, so that the previous set-point caused its motion. A
        // count edge was crossed between the previous reading and this one, on average half a period earlier.
        let before = |row: usize, by: usize| setpoint_a[row.max(from + by) - by];
        let mut torque_nm: Vec<f64> =
            (from..end).map(|row| 0.5 * torque_constant * (before(row, 1) + before(row, 2))).collect();
        // The link torque does not act on the contacts.
        if let Some(link_nm) = link_nm {
            let taken = averaged(&link_nm[from..end], (LINK_S * rate_hz) as usize);
            torque_nm.iter_mut().zip(taken).for_each(|(motor_nm, link_nm)| *motor_nm -= link_nm / ratio);
        }
        let last_nm = torque_nm[torque_nm.len() - 1];
        let top_nm = torque_nm.iter().fold(0.0, |top: f64, nm| top.max(nm.abs()));
        let (ended, slid) = (last_nm.abs() <= 0.1 * top_nm, slides(&position_rad[from..end], rate_hz));
        // A step that a pause interrupted is repeated.
        if ended || slid {
            all.push(Swings { torque_nm, points: known(&position_rad[from..end]), broke_away: !ended });
        }
    }
    Some(all)
}

/// Whether the joint slid at the end: motion in most of the last rows, or too fast for presliding.
fn slides(position_rad: &[f64], rate_hz: f64) -> bool {
    let last = |rows: usize| &position_rad[position_rad.len().saturating_sub(rows + 1)..];
    let moving = last(50).windows(2).filter(|pair| (pair[1] - pair[0]).abs() > STILL_RAD).count();
    let end = last(5);
    let speed_rad_s = (end[end.len() - 1] - end[0]).abs() * rate_hz / end.len() as f64;
    2 * moving > 50 || speed_rad_s > 1.0
}

/// Means over `2 reach + 1` rows, fewer at the ends.
fn averaged(values: &[f64], reach: usize) -> Vec<f64> {
    let mut sums = vec![0.0];
    sums.extend(values.iter().scan(0.0, |sum, value| {
        *sum += value;
        Some(*sum)
    }));
    let mean = |row: usize| {
        let (from, end) = (row.saturating_sub(reach), (row + reach + 1).min(values.len()));
        (sums[end] - sums[from]) / (end - from) as f64
    };
    (0..values.len()).map(mean).collect()
}

/// Rows at which a reading determines the position. A coarse encoder does so only where its count changes, a fine one
/// everywhere.
fn known(position_rad: &[f64]) -> Vec<(usize, f64)> {
    let moves = |row: usize| (position_rad[row] - position_rad[row - 1]).abs() > STILL_RAD;
    let moving = (1..position_rad.len()).filter(|row| moves(*row)).count();
    if 2 * moving > position_rad.len() {
        return position_rad.iter().copied().enumerate().collect();
    }
    // Each move: the row at which it began, and its length.
    let mut events: Vec<(usize, f64)> = Vec::new();
    let mut row = 1;
    while row < position_rad.len() {
        let first = row;
        while row < position_rad.len() && moves(row) {
            row += 1;
        }
        if row > first {
            events.push((first, position_rad[row - 1] - position_rad[first - 1]));
        }
        row += 1;
    }
    counted(&events)
}

/// Positions of the count edges. A reading may overshoot an edge, but it does so equally in consecutive moves in one
/// direction, which therefore determine the size of a count.
fn counted(events: &[(usize, f64)]) -> Vec<(usize, f64)> {
    let mut sizes: Vec<f64> =
        events.windows(2).filter(|pair| pair[0].1 * pair[1].1 > 0.0).map(|pair| pair[1].1.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let Some(count_rad) = sizes.get(sizes.len() / 2).copied() else { return Vec::new() };
    let (mut counts, mut sign, mut points) = (0.0, 0.0, Vec::new());
    for (row, went_rad) in events {
        // After a reversal, when the contacts are stiffest, one edge is crossed at a time, and it is the last one
        // again.
        let crossed = if went_rad * sign > 0.0 { (went_rad.abs() / count_rad).round() } else { 1.0 };
        sign = went_rad.signum();
        let edge = counts + if *went_rad > 0.0 { crossed } else { 1.0 - crossed };
        counts += crossed * sign;
        // For two edges in one move the time of the first crossing is unknown.
        if crossed == 1.0 {
            points.push((*row, edge * count_rad));
        }
    }
    points
}

/// Displacement of Dahl contacts (1968, exponent 1) of unit stiffness in equilibrium with a torque, from the first
/// row on: dq = dτ/(k (1 − τ sgn(dτ)/τ_c)), integrated in closed form over every rising or falling section.
pub fn dahl(torque_nm: &[f64], coulomb_nm: f64, bias_nm: f64) -> Vec<f64> {
    let mut way = Vec::with_capacity(torque_nm.len());
    let (mut at, mut before_nm) = (0.0, bias_nm);
    for torque_nm in torque_nm {
        let (from, to) = (before_nm - bias_nm, torque_nm - bias_nm);
        let sign = (to - from).signum();
        at += sign * coulomb_nm * ((1.0 - sign * from / coulomb_nm) / (1.0 - sign * to / coulomb_nm)).ln();
        before_nm = *torque_nm;
        way.push(at);
    }
    way
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swing_closes_and_a_stiff_contact_is_a_spring() {
        let swing: Vec<f64> = [0.0, 0.5, 0.9, 0.2, -0.9, 0.0, 0.9].into();
        let way = dahl(&swing, 1.0, 0.0);
        // From the reversal at 0.9 back and forth.
        assert!((way[6] - way[2]).abs() < 1e-12, "{way:?}");
        assert!((way[1] - 2.0_f64.ln()).abs() < 1e-12);
        let spring = dahl(&swing, 1e6, 0.0);
        assert!(spring.iter().zip(&swing).all(|(q, nm)| (q - nm).abs() < 1e-5), "{spring:?}");
    }

    #[test]
    fn a_coarse_reading_is_known_at_the_edges_of_its_counts() {
        // Up over the edges 1 and 2, then over 3 and 4 at once, and back over 4 and 3: the reading overshoots each
        // way.
        let reading = [0.2, 0.2, 1.2, 1.2, 1.2, 2.2, 2.2, 4.2, 4.2, 4.2, 3.8, 3.8, 2.8, 2.8, 2.8, 2.8];
        assert_eq!(known(&reading).iter().map(|(row, _)| *row).collect::<Vec<_>>(), [2, 5, 10, 12]);
        let edges = known(&reading).into_iter().map(|(_, at)| at);
        assert!(edges.zip([1.0, 2.0, 4.0, 3.0]).all(|(at, edge)| (at - edge).abs() < 1e-9), "{:?}", known(&reading));
        let fine: Vec<f64> = (0..20).map(f64::from).collect();
        assert_eq!(known(&fine).len(), 20);
        assert_eq!(known(&[1.0; 5]), []);
    }
}
