//! Joins several recordings of one joint into one run table.
//!
//! Each recording keeps its own segments and repeats: their numbers continue those of the recording before. Time
//! continues after a pause, so that changes from run to run appear over time. The column `run` numbers the recordings
//! from 0.

use crate::{Channel, Kind, Meta, RunTable, TableFault, Trace};

/// The pause between two recordings. The real pause is in no run table. The value is too long for a delayed sample and
/// short compared with changes from day to day.
const PAUSE_S: f64 = 60.0;

/// Relative difference above which two sample rates are different.
const SAME_RATE: f64 = 0.05;

/// Why recordings cannot be joined. `number` counts them from 1.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum JoinFault {
    /// The kinds of run differ.
    #[error(
        "run number {number} of the list is of kind {kind}, the first of kind {first}: combine only runs of the same \
         kind"
    )]
    OtherKind {
        /// Number of the recording in the list, from 1.
        number: usize,
        /// Its kind.
        kind: Kind,
        /// Kind of the first recording.
        first: Kind,
    },
    /// A fact of the joint differs.
    #[error(
        "run number {number} of the list belongs to a different joint ({fact} = {value}, first run {first}): combine \
         only runs of the same joint"
    )]
    OtherJoint {
        /// Number of the recording in the list, from 1.
        number: usize,
        /// Name of the fact in the meta file.
        fact: &'static str,
        /// Its value in this recording.
        value: String,
        /// Its value in the first recording.
        first: String,
    },
    /// The sample rates differ by more than 5 %.
    #[error(
        "run number {number} of the list has a sample rate of {rate_hz:.0} Hz, the first {first_hz:.0} Hz: repeat it \
         with --set sample_rate_hz={first_hz:.0}, or resample the file"
    )]
    OtherRate {
        /// Number of the recording in the list, from 1.
        number: usize,
        /// Its sample rate.
        rate_hz: f64,
        /// Sample rate of the first recording.
        first_hz: f64,
    },
    /// Two recordings contain the same samples.
    #[error(
        "runs number {first} and {number} of the list contain the same samples: omit one of them, because a copy is \
         not a repeat"
    )]
    Copy {
        /// Number of the later one in the list, from 1.
        number: usize,
        /// Number of the earlier one.
        first: usize,
    },
    /// The joined table breaks a rule of run tables.
    #[error(transparent)]
    Table(#[from] TableFault),
}

/// Two set-ups that differ in one of these facts have different joints.
fn facts(meta: &Meta) -> [(&'static str, Option<f64>); 8] {
    [
        ("gear_ratio", meta.gear_ratio),
        ("torque_constant_nm_per_a", meta.torque_constant_nm_per_a),
        ("rotor_inertia_kg_m2", meta.rotor_inertia_kg_m2),
        ("bearing_stiffness_nm_per_rad", meta.bearing_stiffness_nm_per_rad),
        ("reference_bits", meta.reference_bits.map(f64::from)),
        ("test_bits", meta.test_bits.map(f64::from)),
        ("pole_pairs", meta.pole_pairs.map(f64::from)),
        ("poles", meta.poles.map(f64::from)),
    ]
}

impl RunTable {
    /// Joins this run and more runs of the same kind and joint, in the order of measurement, into one table.
    ///
    /// Columns that some recordings lack are dropped. A recording without `repeat` counts as one repeat. The facts are
    /// those of the first recording.
    pub fn join(self, more: Vec<RunTable>) -> Result<RunTable, JoinFault> {
        if more.is_empty() {
            return Ok(self);
        }
        for (run, number) in more.iter().zip(2..) {
            check(&self, run, number)?;
        }
        let meta = self.meta().clone();
        let runs: Vec<RunTable> = std::iter::once(self).chain(more).collect();
        for (number, run) in runs.iter().enumerate() {
            if let Some(first) = runs[..number].iter().position(|before| before.trace() == run.trace()) {
                return Err(JoinFault::Copy { number: number + 1, first: first + 1 });
            }
        }
        let shared = |channel: &&Channel| {
            !["run", "repeat"].contains(&channel.name.as_str())
                && runs.iter().all(|run| run.column(&channel.name).is_some())
        };
        let mut channels: Vec<Channel> = runs[0].trace().channels().iter().filter(shared).cloned().collect();
        let mut columns: Vec<Vec<f64>> = channels.iter().map(|c| joined(&runs, &c.name)).collect();
        let number = |name: &str, of: &dyn Fn(&RunTable) -> Vec<f64>| {
            (Channel::counted(name, 1.0), numbered(runs.iter().map(of)))
        };
        let zeros = |run: &RunTable| vec![0.0; run.len()];
        let repeat = number("repeat", &|run| run.column("repeat").map_or_else(|| zeros(run), <[f64]>::to_vec));
        for (channel, column) in [repeat, number("run", &zeros)] {
            channels.push(channel);
            columns.push(column);
        }
        Ok(RunTable::new(meta, Trace::from_columns(channels, columns))?)
    }

    /// Samples per second, from the median time step. Infinite for a single sample.
    pub fn rate_hz(&self) -> f64 {
        let time_s = self.column("time_s").unwrap_or_default();
        let mut steps: Vec<f64> = time_s.windows(2).map(|w| w[1] - w[0]).collect();
        if steps.is_empty() {
            return f64::INFINITY;
        }
        let middle = steps.len() / 2;
        1.0 / *steps.select_nth_unstable_by(middle, f64::total_cmp).1
    }
}

fn check(first: &RunTable, run: &RunTable, number: usize) -> Result<(), JoinFault> {
    if run.kind() != first.kind() {
        return Err(JoinFault::OtherKind { number, kind: run.kind(), first: first.kind() });
    }
    let motion = |run: &RunTable| format!("{:?}", run.meta().motion).to_lowercase();
    if run.meta().motion != first.meta().motion {
        return Err(JoinFault::OtherJoint { number, fact: "motion", value: motion(run), first: motion(first) });
    }
    for ((fact, a), (_, b)) in facts(first.meta()).into_iter().zip(facts(run.meta())) {
        if let (Some(a), Some(b)) = (a, b)
            && (a - b).abs() > 1e-6 * a.abs().max(b.abs())
        {
            return Err(JoinFault::OtherJoint { number, fact, value: b.to_string(), first: a.to_string() });
        }
    }
    let (first_hz, rate_hz) = (first.rate_hz(), run.rate_hz());
    if (rate_hz / first_hz - 1.0).abs() > SAME_RATE {
        return Err(JoinFault::OtherRate { number, rate_hz, first_hz });
    }
    Ok(())
}

fn joined(runs: &[RunTable], name: &str) -> Vec<f64> {
    let columns = runs.iter().map(|run| run.column(name).unwrap_or_default().to_vec());
    match name {
        "time_s" => shifted(columns, PAUSE_S),
        "segment" => numbered(columns),
        _ => columns.flatten().collect(),
    }
}

/// Continues the whole numbers of each recording after those of the recording before.
fn numbered(columns: impl Iterator<Item = Vec<f64>>) -> Vec<f64> {
    let mut next = 0.0;
    let mut out = Vec::new();
    for column in columns {
        let lowest = column.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = column.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let shift = if out.is_empty() { 0.0 } else { next - lowest };
        out.extend(column.into_iter().map(|v| v + shift));
        next = highest + shift + 1.0;
    }
    out
}

/// Starts each recording one pause after the end of the recording before.
fn shifted(columns: impl Iterator<Item = Vec<f64>>, pause_s: f64) -> Vec<f64> {
    let mut out: Vec<f64> = Vec::new();
    for column in columns {
        let shift = match (out.last(), column.first()) {
            (Some(end), Some(start)) => end + pause_s - start,
            _ => 0.0,
        };
        out.extend(column.into_iter().map(|v| v + shift));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(names: &[&str], rows: &[&[f64]], change: impl FnOnce(&mut Meta)) -> RunTable {
        let mut trace = Trace::new(names.iter().map(|n| Channel::new(*n)).collect());
        rows.iter().for_each(|row| trace.push_row(row));
        let mut meta = Meta { kind: Some(Kind::Friction), gear_ratio: Some(50.0), ..Meta::default() };
        change(&mut meta);
        RunTable::new(meta, trace).unwrap()
    }

    const NAMES: [&str; 5] = ["time_s", "motor_position_rad", "motor_current_a", "segment", "repeat"];

    fn two(change: impl FnOnce(&mut Meta)) -> (RunTable, RunTable) {
        let first = run(&NAMES, &[&[0.0, 0.0, 0.1, 3.0, 0.0], &[0.1, 0.0, 0.1, 4.0, 1.0]], |_| {});
        (first, run(&NAMES, &[&[5.0, 1.0, 0.2, 0.0, 0.0], &[5.1, 1.0, 0.2, 1.0, 0.0]], change))
    }

    #[test]
    fn segments_repeats_and_times_follow_each_other() {
        let (first, second) = two(|_| {});
        let both = first.join(vec![second]).unwrap();
        for (name, expected) in [
            ("segment", [3.0, 4.0, 5.0, 6.0]),
            ("repeat", [0.0, 1.0, 2.0, 2.0]),
            ("run", [0.0, 0.0, 1.0, 1.0]),
            ("motor_current_a", [0.1, 0.1, 0.2, 0.2]),
        ] {
            assert_eq!(both.column(name).unwrap(), expected, "{name}");
        }
        let time_s = both.column("time_s").unwrap();
        assert_eq!(time_s[..3], [0.0, 0.1, 0.1 + PAUSE_S]);
    }

    #[test]
    fn a_column_that_one_lacks_goes_but_a_run_is_a_repeat_in_itself() {
        let (first, _) = two(|_| {});
        let bare = run(&NAMES[..3], &[&[0.0, 1.0, 0.2], &[0.1, 1.0, 0.2]], |_| {});
        let again = run(&NAMES[..3], &[&[0.0, 1.0, 0.3], &[0.1, 1.0, 0.2]], |_| {});
        let both = first.join(vec![bare, again]).unwrap();
        assert_eq!(both.column("segment"), None);
        assert_eq!(both.column("repeat").unwrap(), [0.0, 1.0, 2.0, 2.0, 3.0, 3.0]);
        assert_eq!(both.column("run").unwrap(), [0.0, 0.0, 1.0, 1.0, 2.0, 2.0]);
    }

    #[test]
    fn what_does_not_belong_together_is_refused_in_words() {
        for (change, message) in [
            ((|m| m.gear_ratio = Some(100.0)) as fn(&mut Meta), "(gear_ratio = 100, first run 50)"),
            (|m| m.motion = crate::Motion::Linear, "(motion = linear,"),
        ] {
            let (first, second) = two(change);
            let fault = first.join(vec![second]).unwrap_err().to_string();
            assert!(fault.contains(message), "{fault}");
        }
        let (first, second) = two(|_| {});
        let copied = first.clone().join(vec![second.clone(), second]).unwrap_err();
        assert_eq!(copied, JoinFault::Copy { number: 3, first: 2 }, "no repeat is made out of a copy");
        let fast = run(&NAMES[..3], &[&[0.0, 0.0, 0.1], &[0.01, 0.0, 0.1]], |_| {});
        assert!(matches!(first.clone().join(vec![fast]), Err(JoinFault::OtherRate { number: 2, .. })));
        let mut trace = Trace::new(["time_s", "brake_current_a", "brake_torque_nm"].map(Channel::new).into());
        trace.push_row(&[0.0, 0.0, 0.0]);
        let brake = RunTable::new(Meta { kind: Some(Kind::Brake), ..Meta::default() }, trace).unwrap();
        let fault = first.join(vec![brake]).unwrap_err().to_string();
        assert_eq!(
            fault,
            "run number 2 of the list is of kind brake, the first of kind friction: combine only runs of the same kind"
        );
    }
}
