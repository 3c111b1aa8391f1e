//! Published measurements, with requirements on the diagnosis of each.

use super::read;
use jointbench_instrument::{Channel, Kind, Meta, RunTable, Trace};
use jointbench_model::{Fit, evaluate};
use std::path::Path;

pub const EMPS: &str = "emps-train";
pub const BAM: &str = "bam-xl330";
pub const ODRIVE: [&str; 3] = ["odrive-slow2-nocomp-0", "odrive-slow2-nocomp-1", "odrive-slow2-nocomp-2"];
pub const PLACID: &str = "placid-b5zd-brake";
pub const KR300: &str = "kr300-axis1";

/// Known waves in a motor turn of [`ODRIVE`]: a neighbour motor, slots, poles, and three times the slots.
pub const WAVES: [f64; 4] = [7.0, 12.0, 14.0, 36.0];

/// Number of effects that may be added to the baseline of a recording.
pub fn most(folder: &str) -> usize {
    if folder == EMPS { 5 } else { 3 }
}

pub fn recording(data: &Path, folder: &str) -> RunTable {
    let run = read(&data.join(folder));
    if folder == KR300 { stiffness(&run) } else { run }
}

/// Relative error of a fit on the force of the validation run of [`EMPS`].
pub fn of_pulses(data: &Path, fit: &Fit) -> f64 {
    evaluate(fit, &read(&data.join("emps-pulses"))).unwrap().relative_error
}

/// Waves in a turn in a fit.
pub fn waves(fit: &Fit) -> Vec<f64> {
    let mut waves: Vec<f64> =
        fit.parameters.iter().filter(|p| p.name.starts_with("harmonic")).map(|p| p.value).collect();
    waves.sort_by(f64::total_cmp);
    waves
}

/// Axis 1 of an industrial robot as a stiffness run: both encoders, and the motor torque times the gear ratio instead
/// of the link torque.
fn stiffness(robot: &RunTable) -> RunTable {
    let gear = robot.meta().gear_ratio.unwrap();
    let torque_constant = robot.meta().torque_constant_nm_per_a.unwrap();
    let column = |name: &str| robot.column(name).unwrap().to_vec();
    let torque = column("motor_current_a").iter().map(|i| torque_constant * gear * i).collect();
    let names =
        ["time_s", "motor_position_rad", "link_position_rad", "link_torque_nm", "link_velocity_rad_s", "repeat"];
    let columns = vec![
        column("time_s"),
        column("motor_position_rad"),
        column("link_position_rad"),
        torque,
        column("link_velocity_rad_s"),
        column("repeat"),
    ];
    let meta = Meta {
        kind: Some(Kind::Stiffness),
        gear_ratio: Some(gear),
        baseline: vec!["offset".into()],
        ..Meta::default()
    };
    RunTable::new(meta, Trace::from_columns(names.map(Channel::new).to_vec(), columns)).unwrap()
}
