//! State and read rate of every instrument that answers. Sends no commands.

use jointbench_devices::Instruments;
use jointbench_instrument::Fault;
use jointbench_instrument::roles::{
    AlignmentStage, CurrentSource, JointController, PositionCounter, Regulation, Thermometer, TorqueSensor,
};
use std::time::{Duration, Instant};

/// Maximum number of timed readings, and their maximum time.
const READINGS: usize = 200;
const LONGEST: Duration = Duration::from_millis(400);
/// A brake current above this value exceeds the offset of a meter.
const NO_CURRENT_A: f64 = 0.01;

/// Check result of one instrument.
pub struct InstrumentCheck {
    pub role: &'static str,
    /// `Err`: why it is not ready, with the remedy.
    pub state: Result<String, String>,
    pub timing: Option<Timing>,
}

/// Duration of a reading, in wall-clock time.
#[derive(Debug, Clone, Copy)]
pub struct Timing {
    pub median: Duration,
    pub longest: Duration,
    pub per_s: f64,
}

pub fn check_instruments(slots: &mut Instruments) -> Vec<InstrumentCheck> {
    let mut checks = Vec::new();
    let mut add = |role, (state, timing): Checked| checks.push(InstrumentCheck { role, state, timing });
    if let Some(joint) = &mut slots.joint {
        let timing = timed(|| joint.read().map(drop));
        add("joint", checked(timing, || joint_state(joint.as_mut())));
    }
    if let Some(sensor) = &mut slots.torque_sensor {
        let timing = timed(|| sensor.read().map(drop));
        add("torque_sensor", checked(timing, || torque_state(sensor.as_mut())));
    }
    if let Some(brake) = &mut slots.brake {
        let timing = timed(|| brake.read().map(drop));
        add("brake", checked(timing, || brake_state(brake.as_mut())));
    }
    for (role, counter) in
        [("reference_encoder", &mut slots.reference_encoder), ("test_encoder", &mut slots.test_encoder)]
    {
        if let Some(counter) = counter {
            let timing = timed(|| counter.read().map(drop));
            add(role, checked(timing, || counter_state(counter.as_mut())));
        }
    }
    if let Some(stage) = &mut slots.stage {
        let timing = timed(|| stage.pose().map(drop));
        add("stage", checked(timing, || stage_state(stage.as_mut())));
    }
    if let Some(thermometer) = &mut slots.thermometer {
        let timing = timed(|| thermometer.read().map(drop));
        add("thermometer", checked(timing, || temperatures(thermometer.as_mut())));
    }
    checks
}

type Checked = (Result<String, String>, Option<Timing>);
/// Description of an instrument, and a reason against its use.
type State = Result<(String, Option<String>), Fault>;

fn checked(timing: Result<Timing, Fault>, state: impl FnOnce() -> State) -> Checked {
    let (timing, slow) = match timing {
        Ok(timing) => (Some(timing), None),
        Err(fault) => (None, Some(fault.to_string())),
    };
    let state = match (slow, state()) {
        (Some(fault), _) => Err(fault),
        (None, Err(fault)) => Err(fault.to_string()),
        (None, Ok((text, Some(problem)))) => Err(format!("{text}: {problem}")),
        (None, Ok((text, None))) => Ok(text),
    };
    (state, timing)
}

fn timed(mut read: impl FnMut() -> Result<(), Fault>) -> Result<Timing, Fault> {
    let began = Instant::now();
    let mut taken = Vec::with_capacity(READINGS);
    while taken.len() < READINGS && began.elapsed() < LONGEST {
        let asked = Instant::now();
        read()?;
        taken.push(asked.elapsed());
    }
    let per_s = taken.len() as f64 / began.elapsed().as_secs_f64();
    taken.sort();
    Ok(Timing { median: taken[taken.len() / 2], longest: taken[taken.len() - 1], per_s })
}

fn joint_state(joint: &mut dyn JointController) -> State {
    let (health, reading) = (joint.health()?, joint.read()?);
    let armed = if health.armed { "armed" } else { "off" };
    let heat = health.temperature.map(|temperature| format!(", {:.1} °C", temperature.0)).unwrap_or_default();
    let bus = health.bus_voltage.map(|bus| format!(", bus {:.1} V", bus.0)).unwrap_or_default();
    let text = format!("{armed}{bus}{heat}, motor at {:.3} rad", reading.motor_position.0);
    let problem = match (health.errors.is_empty(), health.armed) {
        (false, _) => {
            Some(format!("it reports {}; clear the error with the tool of the drive", health.errors.join(", ")))
        }
        (true, true) => Some("it is already armed; end the program that controls it".to_owned()),
        (true, false) => None,
    };
    Ok((text, problem))
}

fn torque_state(sensor: &mut dyn TorqueSensor) -> State {
    Ok((format!("{:.3} Nm of ±{} Nm", sensor.read()?.0, sensor.range().0), None))
}

fn brake_state(brake: &mut dyn CurrentSource) -> State {
    let reading = brake.read()?;
    let regulation = match reading.regulation {
        Regulation::ConstantCurrent => "constant current",
        Regulation::ConstantVoltage => "constant voltage",
        Regulation::Unregulated => "not regulated",
        Regulation::Off => "output off",
    };
    let text = format!("{regulation}, {:.3} A, {:.2} V", reading.current.0, reading.voltage.0);
    let flows = reading.regulation != Regulation::Off && reading.current.0.abs() > NO_CURRENT_A;
    Ok((text, flows.then(|| "current is already flowing; reduce it to zero while the shaft turns".to_owned())))
}

fn counter_state(counter: &mut dyn PositionCounter) -> State {
    let at_rad = counter.read()?.position.0;
    let text = format!("at {at_rad:.4} rad, {:.0} counts a turn", std::f64::consts::TAU / counter.resolution().0);
    let Some(status) = counter.status() else { return Ok((text, None)) };
    if status.periods_are_consistent()? {
        return Ok((format!("{text}, periods consistent"), None));
    }
    Ok((text, Some("its periods are not consistent; move the sensor closer to its nominal position".to_owned())))
}

fn stage_state(stage: &mut dyn AlignmentStage) -> State {
    if !stage.is_referenced()? {
        return Ok(("not referenced; the first run that uses it references it".to_owned(), None));
    }
    let pose = stage.pose()?;
    let [x, y, z] = pose.shift_m.map(|m| 1e3 * m);
    let [u, v, w] = pose.rotation_rad.map(f64::to_degrees);
    Ok((format!("at {x:.3}, {y:.3}, {z:.3} mm, turned {u:.2}, {v:.2}, {w:.2}°"), None))
}

fn temperatures(thermometer: &mut dyn Thermometer) -> State {
    let temperatures: Vec<String> =
        thermometer.read()?.iter().map(|temperature| format!("{:.1} °C", temperature.0)).collect();
    Ok((temperatures.join(", "), None))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::reach;
    use crate::config::{READY_MADE, parse};
    use jointbench_instrument::units::{Amperes, RadPerSec};

    #[test]
    fn every_mock_bench_is_ready_and_described() {
        for (name, text) in READY_MADE.into_iter().filter(|(name, _)| name.ends_with("-mock")) {
            let mut reached = reach(&parse(name, text).unwrap().benches[0]).unwrap();
            let checks = check_instruments(&mut reached.slots);
            assert_eq!(checks.len(), reached.slots.asked.len(), "{name}");
            for InstrumentCheck { role, state, timing } in checks {
                let text = state.unwrap_or_else(|why| panic!("{name}, {role}: {why}"));
                let timing = timing.unwrap();
                assert!(!text.is_empty() && timing.per_s > 0.0 && timing.median <= timing.longest);
            }
        }
    }

    #[test]
    fn a_problem_of_an_instrument_is_reported() {
        let (name, text) = READY_MADE[0];
        let mut reached = reach(&parse(name, text).unwrap().benches[0]).unwrap();
        reached.slots.joint.as_mut().unwrap().arm(RadPerSec(10.0), Amperes(1.0)).unwrap();
        let checks = check_instruments(&mut reached.slots);
        let why =
            |wanted| checks.iter().find(|check| check.role == wanted).and_then(|check| check.state.as_ref().err());
        assert!(why("joint").unwrap().contains("already armed"));
        assert!(why("brake").is_none());
    }
}
