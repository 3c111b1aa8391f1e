//! The instruments of a description.

use super::error::Collector;
use super::raw::{RawBench, RawCounter, RawJoint, RawPort, RawThermometer, RawTorqueSensor};
use super::values::{calibrated, choice, deadline_ms, flip, port, positive, within};
use jiff::civil::Date;
use jointbench_devices::driver::{
    AdamSettings, DmmSettings, GcsSettings, LorenzSettings, OdriveSettings, PumaSettings, QsbSettings,
    Range as TorqueRange, ScpiSettings, Thermistor,
};
use jointbench_devices::protocol::puma::{VAL_INTERVAL, interval, intervals};
use jointbench_devices::{InstrumentSettings, JointSettings, PortSettings, TorqueSensorSettings};
use std::ops::Range;
use toml::Spanned;
use toml::value::Datetime;

/// Maximum counts per turn after quadrature: the 32-bit counter still has room for several turns.
const MOST_COUNTS: u32 = 1 << 24;

pub fn instruments(raw: &RawBench, joint: &RawJoint, wrong: &mut Collector) -> Option<InstrumentSettings> {
    let joint = check_joint(joint, wrong);
    let torque_sensor = raw.torque_sensor.as_ref().map(|sensor| check_sensor(sensor, wrong));
    let brake = raw.brake.as_ref().map(|brake| check_brake(brake, wrong));
    let mut counter = |raw: &Option<RawCounter>, name| raw.as_ref().map(|raw| check_counter(raw, name, wrong));
    let reference_encoder = counter(&raw.reference_encoder, "reference_encoder");
    let test_encoder = counter(&raw.test_encoder, "test_encoder");
    let stage = raw.stage.as_ref().map(|stage| check_stage(stage, wrong));
    let thermometer = raw.thermometer.as_ref().map(|felt| check_thermometer(felt, wrong));
    check_ports(raw, wrong);
    Some(InstrumentSettings {
        joint: joint?,
        torque_sensor: flip(torque_sensor)?,
        brake: flip(brake)?,
        reference_encoder: flip(reference_encoder)?,
        test_encoder: flip(test_encoder)?,
        stage: flip(stage)?,
        thermometer: flip(thermometer)?,
    })
}

/// The given calibration dates by role.
pub fn calibrations(raw: &RawBench, wrong: &mut Collector) -> Option<Vec<(String, Date)>> {
    let counter = |raw: &Option<RawCounter>| raw.as_ref().and_then(|counter| counter.calibrated.clone());
    let given: [(&'static str, Option<Spanned<Datetime>>); 6] = [
        ("torque_sensor", raw.torque_sensor.as_ref().and_then(|sensor| sensor.calibrated.clone())),
        ("brake", raw.brake.as_ref().and_then(|brake| brake.calibrated.clone())),
        ("reference_encoder", counter(&raw.reference_encoder)),
        ("test_encoder", counter(&raw.test_encoder)),
        ("stage", raw.stage.as_ref().and_then(|stage| stage.calibrated.clone())),
        ("thermometer", raw.thermometer.as_ref().and_then(|felt| felt.calibrated.clone())),
    ];
    let given = given.into_iter().filter_map(|(role, day)| Some((role, day?)));
    let days: Vec<_> = given.map(|(role, day)| Some((role.to_owned(), calibrated(&day, wrong)?))).collect();
    days.into_iter().collect()
}

fn check_ports(raw: &RawBench, wrong: &mut Collector) {
    let all = [
        raw.joint.as_ref().map(|joint| &joint.port),
        raw.torque_sensor.as_ref().map(|sensor| &sensor.port),
        raw.brake.as_ref().map(|brake| &brake.port),
        raw.reference_encoder.as_ref().map(|counter| &counter.port),
        raw.test_encoder.as_ref().map(|counter| &counter.port),
        raw.stage.as_ref().map(|stage| &stage.port),
        raw.thermometer.as_ref().map(|felt| &felt.port),
    ];
    let mut ports: Vec<&Spanned<String>> = Vec::new();
    for port in all.into_iter().flatten() {
        if ports.iter().any(|earlier| earlier.get_ref() == port.get_ref()) {
            wrong.add(port.span(), format!("port {:?} is already used by another instrument", port.get_ref()));
        }
        ports.push(port);
    }
}

fn check_joint(raw: &RawJoint, wrong: &mut Collector) -> Option<JointSettings> {
    let is_puma = choice(&raw.driver, "driver", &[("odrive", false), ("puma", true)], wrong);
    let port = port(&raw.port, raw.baud.unwrap_or(if is_puma == Some(true) { 115_200 } else { 921_600 }), wrong);
    let deadline_ms = deadline_ms(raw.deadline_ms.as_ref(), wrong);
    if is_puma? { check_puma(raw, port, deadline_ms, wrong) } else { check_odrive(raw, port, deadline_ms, wrong) }
}

fn check_odrive(
    raw: &RawJoint,
    port: Option<PortSettings>,
    deadline_ms: Option<u64>,
    wrong: &mut Collector,
) -> Option<JointSettings> {
    let thermistors = [("motor", Thermistor::Motor), ("power_stage", Thermistor::PowerStage)];
    let thermistor = raw.thermistor.as_ref().map(|given| choice(given, "thermistor", &thermistors, wrong));
    for (name, place) in [
        ("counts_per_turn", raw.counts_per_turn.as_ref().map(Spanned::span)),
        ("amperes_per_volt", raw.amperes_per_volt.as_ref().map(Spanned::span)),
        ("ninter", raw.ninter.as_ref().map(Spanned::span)),
        ("servo", raw.servo.as_ref().map(Spanned::span)),
    ] {
        misplaced(name, "odrive", place, wrong);
    }
    Some(JointSettings::Odrive(OdriveSettings {
        name: "joint".into(),
        port: port?,
        deadline_ms: deadline_ms?,
        link_encoder: raw.link_encoder.as_ref().is_some_and(|given| *given.get_ref()),
        thermistor: flip(thermistor)?,
    }))
}

fn check_puma(
    raw: &RawJoint,
    port: Option<PortSettings>,
    deadline_ms: Option<u64>,
    wrong: &mut Collector,
) -> Option<JointSettings> {
    misplaced("link_encoder", "puma", raw.link_encoder.as_ref().map(Spanned::span), wrong);
    misplaced("thermistor", "puma", raw.thermistor.as_ref().map(Spanned::span), wrong);
    if raw.counts_per_turn.is_none() || raw.amperes_per_volt.is_none() {
        let cure = "a puma requires counts_per_turn of its encoder and amperes_per_volt of its shunt";
        wrong.add(raw.driver.span(), cure);
    }
    let counts =
        raw.counts_per_turn.as_ref().and_then(|given| within(given, "counts_per_turn", 4..=MOST_COUNTS, wrong));
    let scale = raw.amperes_per_volt.as_ref().and_then(|given| positive(given, "amperes_per_volt", wrong));
    let ninter = ninter(raw.ninter.as_ref(), wrong);
    Some(JointSettings::Puma(PumaSettings {
        name: "joint".into(),
        port: port?,
        deadline_ms: deadline_ms?,
        counts_per_turn: counts?,
        amperes_per_volt: scale?,
        ninter: ninter?,
        gains: raw.servo.as_ref().map(|given| *given.get_ref()).unwrap_or_default(),
    }))
}

/// Clock ticks between two set-points of a Puma-type servo.
pub fn ninter(given: Option<&Spanned<u8>>, wrong: &mut Collector) -> Option<u8> {
    let Some(given) = given else { return Some(VAL_INTERVAL) };
    let ninter = *given.get_ref();
    if interval(ninter).is_none() {
        wrong.add(given.span(), format!("ninter {ninter}: choose {}", intervals()));
        return None;
    }
    Some(ninter)
}

fn misplaced(what: &str, driver: &str, place: Option<Range<usize>>, wrong: &mut Collector) {
    if let Some(place) = place {
        wrong.add(place, format!("{what} does not apply to driver {driver:?}: remove it"));
    }
}

fn check_sensor(raw: &RawTorqueSensor, wrong: &mut Collector) -> Option<TorqueSensorSettings> {
    let is_lorenz = choice(&raw.driver, "driver", &[("lorenz", true), ("multimeter", false)], wrong);
    let baud = raw.baud.unwrap_or(if is_lorenz == Some(false) { 9600 } else { 230_400 });
    let port = port(&raw.port, baud, wrong);
    let deadline_ms = deadline_ms(raw.deadline_ms.as_ref(), wrong);
    let nominal_nm = positive(&raw.nominal_nm, "nominal_nm", wrong);
    let ranges = [("fine", TorqueRange::Fine), ("coarse", TorqueRange::Coarse)];
    let range = raw.range.as_ref().map(|range| choice(range, "range", &ranges, wrong));
    let name = "torque_sensor".into();
    if is_lorenz? {
        if range.is_none() {
            wrong.add(raw.driver.span(), "range is missing: write range = \"fine\" or \"coarse\", the channel to read");
        }
        let range = range.flatten();
        let (port, deadline_ms, nominal_nm) = (port?, deadline_ms?, nominal_nm?);
        Some(TorqueSensorSettings::Lorenz(LorenzSettings { name, port, deadline_ms, range: range?, nominal_nm }))
    } else {
        if let Some(range) = &raw.range {
            wrong.add(
                range.span(),
                "range does not apply to a multimeter: remove it, and enter the torque at 10 V as nominal_nm",
            );
        }
        let (port, deadline_ms, nominal_nm) = (port?, deadline_ms?, nominal_nm?);
        Some(TorqueSensorSettings::Multimeter(DmmSettings { name, port, deadline_ms, nominal_nm }))
    }
}

fn check_brake(raw: &RawPort, wrong: &mut Collector) -> Option<ScpiSettings> {
    let driver = choice(&raw.driver, "driver", &[("scpi", ())], wrong);
    let port = port(&raw.port, raw.baud.unwrap_or(115_200), wrong);
    let deadline_ms = deadline_ms(raw.deadline_ms.as_ref(), wrong);
    driver?;
    Some(ScpiSettings { name: "brake_a".into(), port: port?, deadline_ms: deadline_ms? })
}

fn check_counter(raw: &RawCounter, name: &str, wrong: &mut Collector) -> Option<QsbSettings> {
    let driver = choice(&raw.driver, "driver", &[("qsb", ())], wrong);
    let port = port(&raw.port, raw.baud.unwrap_or(230_400), wrong);
    let deadline_ms = deadline_ms(raw.deadline_ms.as_ref(), wrong);
    let counts_per_turn = within(&raw.counts_per_turn, "counts_per_turn", 4..=MOST_COUNTS, wrong);
    let status_input = raw.status_input.as_ref().map(|input| within(input, "status_input", 0..=3, wrong));
    driver?;
    Some(QsbSettings {
        name: name.into(),
        port: port?,
        deadline_ms: deadline_ms?,
        counts_per_turn: counts_per_turn?,
        reversed: raw.reversed,
        status_input: flip(status_input)?,
    })
}

fn check_stage(raw: &RawPort, wrong: &mut Collector) -> Option<GcsSettings> {
    let driver = choice(&raw.driver, "driver", &[("gcs", ())], wrong);
    let port = port(&raw.port, raw.baud.unwrap_or(115_200), wrong);
    let deadline_ms = deadline_ms(raw.deadline_ms.as_ref(), wrong);
    driver?;
    Some(GcsSettings { name: "stage".into(), port: port?, deadline_ms: deadline_ms? })
}

fn check_thermometer(raw: &RawThermometer, wrong: &mut Collector) -> Option<AdamSettings> {
    let driver = choice(&raw.driver, "driver", &[("adam", ())], wrong);
    let port = port(&raw.port, raw.baud.unwrap_or(9600), wrong);
    let deadline_ms = deadline_ms(raw.deadline_ms.as_ref(), wrong);
    let slave = raw.slave.as_ref().map_or(Some(1), |slave| within(slave, "slave", 1..=247, wrong));
    let channels: Vec<_> = raw.channels.iter().map(|channel| within(channel, "channel", 0..=5, wrong)).collect();
    if channels.is_empty() {
        wrong.add(raw.driver.span(), "channels is empty: list the channels in use, such as channels = [0, 1]");
        return None;
    }
    driver?;
    Some(AdamSettings {
        name: "thermometer".into(),
        port: port?,
        deadline_ms: deadline_ms?,
        slave: slave?,
        channels: channels.into_iter().collect::<Option<_>>()?,
    })
}
