//! Subtracts the zero of a torque sensor, measured before a run, from the torque of that run.
//!
//! The stored rows stay as measured. Before any computation on a run, the zero in its facts is subtracted, and the fact
//! is set to 0.

use crate::{Channel, Meta, Trace};

/// The fact: the reading of the sensor without torque.
pub const TORQUE_ZERO: &str = "torque_sensor_zero_nm";

pub(crate) fn subtract(meta: &mut Meta, trace: Trace) -> Trace {
    let Some(zero_nm) = meta.other.get(TORQUE_ZERO).and_then(|zero| zero.as_f64()).filter(|zero| *zero != 0.0) else {
        return trace;
    };
    meta.other.insert(TORQUE_ZERO.to_owned(), 0.0.into());
    let setpoint = trace.column("velocity_setpoint_rad_s").map(<[f64]>::to_vec);
    let (mut channels, mut columns) = trace.into_parts();
    for (channel, column) in channels.iter_mut().zip(&mut columns) {
        match channel.name.as_str() {
            "link_torque_nm" => column.iter_mut().for_each(|torque| *torque -= zero_nm),
            // Brake torque is positive when it brakes, so the sign of the zero follows the last commanded direction of
            // rotation.
            "brake_torque_nm" => {
                let mut direction = 1.0;
                for (row, torque) in column.iter_mut().enumerate() {
                    let setpoint_rad_s = setpoint.as_ref().map_or(0.0, |setpoint| setpoint[row]);
                    direction = if setpoint_rad_s == 0.0 { direction } else { setpoint_rad_s.signum() };
                    *torque -= direction * zero_nm;
                }
            }
            _ => continue,
        }
        // The corrected value is no longer a whole count.
        *channel = Channel::new(&channel.name);
    }
    Trace::from_columns(channels, columns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Kind, RunTable};

    #[test]
    fn a_zero_is_taken_off_once_and_turns_with_the_shaft_where_the_torque_does() {
        let names = ["time_s", "brake_current_a", "brake_torque_nm", "link_torque_nm", "velocity_setpoint_rad_s"];
        let mut trace = Trace::new(names.map(Channel::new).into());
        for (i, setpoint_rad_s) in [0.0, 5.0, 0.0, -5.0, 0.0].into_iter().enumerate() {
            trace.push_row(&[i as f64, 0.0, 1.0, 1.0, setpoint_rad_s]);
        }
        let mut meta = Meta { kind: Some(Kind::Brake), ..Meta::default() };
        meta.other.insert(TORQUE_ZERO.to_owned(), 0.25.into());
        let table = RunTable::new(meta, trace).unwrap();
        assert_eq!(table.column("brake_torque_nm").unwrap(), [0.75, 0.75, 0.75, 1.25, 1.25]);
        assert_eq!(table.column("link_torque_nm").unwrap(), [0.75; 5]);
        let again = RunTable::new(table.meta().clone(), table.trace().clone()).unwrap();
        assert_eq!(again, table);
    }
}
