//! The rows of one part of a campaign, as a run of its own procedure.

use crate::findings::{Unusable, select_rows};
use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
use serde_json::Value;

/// The table of one part. A step that was repeated after a pause has a new number: it belongs to the part of the rows
/// before it.
pub(super) fn table_of(run: &RunTable, facts: &[Value], number: usize) -> Result<RunTable, Unusable> {
    const NONE: Unusable = Unusable::InsufficientData("The run ended before this part.", "Repeat the run.");
    let ranges: Vec<_> = facts
        .iter()
        .map(|fact| {
            let first = fact["first_segment"].as_i64().unwrap_or(0);
            first..first + fact["segments"].as_i64().unwrap_or(0)
        })
        .collect();
    let segment = run.column("segment").unwrap_or_default();
    let (mut part, mut first, mut last) = (0, None, 0);
    for (row, segment) in segment.iter().enumerate() {
        part = ranges.iter().position(|range| range.contains(&(*segment as i64))).unwrap_or(part);
        if part == number {
            first = first.or(Some(row));
            last = row;
        }
    }
    let rows = first.ok_or(NONE)?..last + 1;
    let (_, trace) = select_rows(run, &[rows])?.into_parts();
    let meta: Meta = serde_json::from_value(facts[number]["meta"].clone()).map_err(|_| NONE)?;
    let trace = match meta.kind {
        Some(Kind::Stiffness) => of_link(trace, &meta, "link_velocity_rad_s"),
        Some(Kind::Brake) => of_brake(of_link(trace, &meta, "velocity_rad_s"), &meta),
        _ => trace,
    };
    Ok(RunTable::new(meta, trace)?)
}

/// Adds the velocity of the link, which is not a column of a friction run.
fn of_link(trace: Trace, meta: &Meta, name: &str) -> Trace {
    let (mut channels, mut columns) = (trace.channels().to_vec(), trace.columns().to_vec());
    if let (Some(velocity), Some(gear)) = (trace.column("motor_velocity_rad_s"), meta.gear_ratio) {
        channels.push(Channel::new(name));
        columns.push(velocity.iter().map(|v| v / gear).collect());
    }
    Trace::from_columns(channels, columns)
}

/// Torque against the commanded direction, and the commanded current instead of the corresponding torque.
fn of_brake(trace: Trace, meta: &Meta) -> Trace {
    let ways: Vec<f64> = trace
        .column("velocity_setpoint_rad_s")
        .unwrap_or_default()
        .iter()
        .scan(1.0, |way, setpoint| {
            if *setpoint != 0.0 {
                *way = f64::signum(*setpoint);
            }
            Some(*way)
        })
        .collect();
    let rated = |name: &str| meta.other.get(name).and_then(Value::as_f64);
    let nm_per_a = rated("rated_torque_nm").zip(meta.rated_current_a).map_or(1.0, |(nm, a)| nm / a);
    let (mut channels, mut columns) = (trace.channels().to_vec(), trace.columns().to_vec());
    for (channel, column) in channels.iter_mut().zip(&mut columns) {
        let name = match channel.name.as_str() {
            "link_torque_nm" => {
                column.iter_mut().zip(&ways).for_each(|(torque, way)| *torque *= way);
                "brake_torque_nm"
            }
            "brake_torque_command_nm" => {
                column.iter_mut().for_each(|value| *value /= nm_per_a);
                channel.resolution = channel.resolution.map(|step| step / nm_per_a);
                "brake_current_command_a"
            }
            "link_position_rad" => "position_rad",
            _ => continue,
        };
        name.clone_into(&mut channel.name);
    }
    Trace::from_columns(channels, columns)
}
