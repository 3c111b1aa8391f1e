//! A table of conditions: each row is the mean of one steady operating point.

use crate::ProposedOption;
use crate::column::Column;
use crate::error::FileFault;
use crate::guess::Proposal;
use crate::note::Note;
use crate::raw::RawTable;
use jointbench_instrument::{Kind, Meta, TableFault};

const ANGLE: &str = "motor_position_rad";
const SPEED: &str = "motor_velocity_rad_s";

/// Speeds without time and angle are operating points, not the record of a motion. So are the currents and torques of a
/// brake.
pub fn may_be(table: &RawTable, kind: Kind, guessed: &[Proposal]) -> bool {
    let has = |name: &str| table.place(name).is_some() || guessed.iter().any(|one| one.column == name);
    match kind {
        Kind::Friction => has(SPEED) && !has(ANGLE),
        Kind::Brake => kind.required_columns().iter().all(|name| *name == "time_s" || has(name)),
        Kind::Encoder | Kind::Stiffness => false,
    }
}

/// Numbers the rows as a time, one second each. For a friction table it also makes an angle: the sum of the speeds.
/// Both only have a meaning as the order of the rows.
pub fn settle(table: &mut RawTable, meta: &mut Meta, guessed: &[Proposal]) -> Result<(), FileFault> {
    if meta.kind == Some(Kind::Friction) && table.place(ANGLE).is_some() {
        let message = format!("the table has {ANGLE}: it is the record of a motion and no table of conditions");
        return Err(FileFault::Choice {
            message,
            options: vec![ProposedOption::words("the file without --operating-points")],
        });
    }
    if meta.kind == Some(Kind::Friction) && table.place(SPEED).is_none() {
        return Err(without_speed(table, guessed));
    }
    meta.operating_points = true;
    meta.sample_rate_hz = None;
    let numbers = Column::new("time_s", (0..table.rows).map(|row| row as f64).collect());
    match table.place("time_s") {
        Some(place) => table.columns[place] = numbers,
        None => table.columns.insert(0, numbers),
    }
    let mut counted = "“time_s” counts the rows";
    if meta.kind == Some(Kind::Friction)
        && let Some(speed) = table.place(SPEED)
    {
        let mut angle = 0.0;
        let mut turned = |speed: &f64| {
            angle += speed;
            angle
        };
        let values = table.columns[speed].values.iter().map(&mut turned).collect();
        table.columns.insert(1, Column::new(ANGLE, values));
        counted = "“time_s” counts the rows, and “motor_position_rad” adds up their speeds";
    }
    let message = format!("each row is one steady operating point: {counted}");
    table.notes.push(Note::with(message, ProposedOption::flag("operating_points")));
    Ok(())
}

/// Alternatives that the file seems to contain, as options to copy.
fn without_speed(table: &RawTable, guessed: &[Proposal]) -> FileFault {
    let of_points = |one: &&Proposal| one.column != ANGLE && one.column != "time_s";
    if guessed.iter().any(|one| one.column == SPEED) {
        let fault = TableFault::MissingColumn { kind: Kind::Friction, column: SPEED, found: table.names() };
        let options = guessed.iter().filter(of_points).map(Proposal::option).collect();
        return FileFault::Proposed { fault, message: "the file seems to hold it", options };
    }
    let message = format!("a table of conditions needs {SPEED}, and the file has {}", table.names().join(", "));
    let option =
        |unit: &str| ProposedOption::open("map", format!("{SPEED}=NAME")).and("unit", format!("{SPEED}={unit}"));
    FileFault::Choice { message, options: vec![option("rad/s"), option("rpm")] }
}
