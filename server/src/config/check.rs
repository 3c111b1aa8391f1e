//! Raw values to checked ones.

use super::mistake::{Collector, Mistakes};
use super::raw::{RawBench, RawBrake, RawConstants, RawFile, RawJoint, RawLimits, RawMock, RawTorqueSensor};
use super::{BenchDescription, Hardware, Source};
use jointbench_devices::driver::{LorenzSettings, OdriveSettings, Range, ScpiSettings, Thermistor};
use jointbench_devices::sim::{HIDDEN_EFFECTS, Load};
use jointbench_devices::{Joint, MockSettings, PortSettings};
use jointbench_instrument::Limits;
use jointbench_instrument::bench::JointConstants;
use toml::Spanned;

const LONGEST_DEADLINE_MS: u64 = 10_000;
const DEADLINE_MS: u64 = 100;

pub(super) fn check(file: &str, text: &str) -> Result<Vec<BenchDescription>, Mistakes> {
    let mut wrong = Collector::new(text);
    let raw: RawFile = match toml::from_str(text) {
        Ok(raw) => raw,
        Err(fault) => {
            wrong.add(fault.span().unwrap_or(0..0), fault.message().trim());
            return wrong.finish(file, None);
        }
    };
    if raw.bench.is_empty() {
        wrong.add(0..0, "no bench is described: begin one with [[bench]] and its name");
    }
    for (i, bench) in raw.bench.iter().enumerate() {
        if raw.bench[..i].iter().any(|earlier| earlier.name.get_ref() == bench.name.get_ref()) {
            wrong.add(
                bench.name.span(),
                format!("bench {:?} is there twice: give each its own name", bench.name.get_ref()),
            );
        }
    }
    // Every bench is looked at, whatever is wrong with the one before it.
    let benches: Vec<_> = raw.bench.iter().map(|bench| check_bench(bench, text, &mut wrong)).collect();
    wrong.finish(file, benches.into_iter().collect())
}

fn check_bench(raw: &RawBench, text: &str, wrong: &mut Collector) -> Option<BenchDescription> {
    let name = raw.name.get_ref();
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    if name.is_empty() || !name.chars().all(plain) {
        wrong.add(raw.name.span(), format!("name {name:?}: use letters, digits, -, _ and . (it is part of addresses)"));
    }
    let source = match (&raw.mock, &raw.joint) {
        (Some(mock), None) if raw.torque_sensor.is_none() && raw.brake.is_none() => {
            check_mock(mock, wrong).map(Source::Mock)
        }
        (Some(_), _) => {
            wrong.add(raw.name.span(), format!("bench {name:?} is a mock and has instruments too: keep one of them"));
            None
        }
        (None, Some(joint)) => check_hardware(raw, joint, wrong).map(|hardware| Source::Hardware(Box::new(hardware))),
        (None, None) => {
            wrong.add(raw.name.span(), format!("bench {name:?} has no joint: add [bench.joint], or [bench.mock]"));
            return None;
        }
    };
    if source.is_none() && raw.mock.is_some() {
        // Limits and constants come with the simulated joint, which is not known.
        return None;
    }
    let sheet = match &source {
        Some(Source::Mock(settings)) => Some((settings.joint, settings.load)),
        _ => None,
    };
    let place = raw.name.span();
    let limits = limits(raw.limits.as_ref(), sheet.map(|(joint, load)| joint.limits(load)), place.clone(), wrong);
    let constants = constants(raw.constants.as_ref(), sheet.map(|(joint, load)| joint.constants(load)), place, wrong);
    if let (Some(given), Some(limits), Some(constants)) = (&raw.limits, &limits, &constants) {
        check_reach(raw, given, limits, constants, wrong);
    }
    Some(BenchDescription {
        name: name.clone(),
        source: source?,
        limits: limits?,
        constants: constants?,
        text: text.to_owned(),
    })
}

/// A source regulates around its set point: a limit a little above the rated current is no mistake.
const ABOVE_RATED: f64 = 1.1;

/// A limit beyond what an instrument can show or bear protects nothing.
fn check_reach(raw: &RawBench, given: &RawLimits, limits: &Limits, constants: &JointConstants, wrong: &mut Collector) {
    if let (Some(place), Some(sensor)) = (&given.link_torque_nm, &raw.torque_sensor) {
        let nominal_nm = *sensor.nominal_nm.get_ref();
        if limits.link_torque_nm > nominal_nm {
            let told =
                format!("limits.link_torque_nm = {}: the torque sensor ends at {nominal_nm} Nm", limits.link_torque_nm);
            wrong.add(place.span(), format!("{told}; give at most that"));
        }
    }
    if let Some(place) = &given.brake_current_a
        && limits.brake_current_a > ABOVE_RATED * constants.brake_rated_current_a
    {
        let rated_a = constants.brake_rated_current_a;
        let told = format!("limits.brake_current_a = {}: the brake is rated for {rated_a} A", limits.brake_current_a);
        wrong.add(place.span(), format!("{told}; give at most a tenth more"));
    }
}

fn check_mock(raw: &RawMock, wrong: &mut Collector) -> Option<MockSettings> {
    let joint = choice(&raw.joint, "joint", &[("a", Joint::JointA), ("b", Joint::JointB)], wrong);
    for effect in raw.effects.iter().filter(|effect| !HIDDEN_EFFECTS.contains(&effect.get_ref().as_str())) {
        let known = HIDDEN_EFFECTS.join(", ");
        wrong.add(effect.span(), format!("effect {:?}: the mock bench can hide {known}", effect.get_ref()));
    }
    let loads = [("brake_a", Load::BrakeA), ("gear_and_brake_b", Load::GearAndBrakeB)];
    let load = raw.load.as_ref().map_or(Some(Load::default()), |load| choice(load, "load", &loads, wrong));
    let pace = raw.pace.as_ref().and_then(|pace| positive(pace, "pace", wrong));
    let effects = raw.effects.iter().map(|effect| effect.get_ref().clone()).collect();
    let troubles = raw.troubles.clone();
    Some(MockSettings { load: load?, effects, pace, troubles, ..MockSettings::new(joint?, raw.seed.unwrap_or(1)) })
}

fn check_hardware(raw: &RawBench, joint: &RawJoint, wrong: &mut Collector) -> Option<Hardware> {
    let joint = check_joint(joint, wrong);
    let torque_sensor = raw.torque_sensor.as_ref().map(|sensor| check_sensor(sensor, wrong));
    let brake = raw.brake.as_ref().map(|brake| check_brake(brake, wrong));
    let mut ports: Vec<&Spanned<String>> = Vec::new();
    let all = [raw.joint.as_ref().map(|j| &j.port), raw.torque_sensor.as_ref().map(|t| &t.port)];
    for port in all.into_iter().flatten().chain(raw.brake.as_ref().map(|b| &b.port)) {
        if ports.iter().any(|earlier| earlier.get_ref() == port.get_ref()) {
            wrong.add(port.span(), format!("port {:?} has an instrument already: each needs its own", port.get_ref()));
        }
        ports.push(port);
    }
    Some(Hardware { joint: joint?, torque_sensor: flip(torque_sensor)?, brake: flip(brake)? })
}

/// A slot that is empty, or filled and right.
fn flip<T>(slot: Option<Option<T>>) -> Option<Option<T>> {
    match slot {
        None => Some(None),
        Some(checked) => checked.map(Some),
    }
}

fn check_joint(raw: &RawJoint, wrong: &mut Collector) -> Option<OdriveSettings> {
    let driver = choice(&raw.driver, "driver", &[("odrive", ())], wrong);
    let port = port(&raw.port, raw.baud.unwrap_or(921_600), wrong);
    let deadline_ms = deadline_ms(raw.deadline_ms.as_ref(), wrong);
    let thermistors = [("motor", Thermistor::Motor), ("power_stage", Thermistor::PowerStage)];
    let thermistor = raw.thermistor.as_ref().map(|given| choice(given, "thermistor", &thermistors, wrong));
    driver?;
    Some(OdriveSettings {
        name: "joint".into(),
        port: port?,
        deadline_ms: deadline_ms?,
        link_encoder: raw.link_encoder,
        thermistor: flip(thermistor)?,
    })
}

fn check_sensor(raw: &RawTorqueSensor, wrong: &mut Collector) -> Option<LorenzSettings> {
    let driver = choice(&raw.driver, "driver", &[("lorenz", ())], wrong);
    let port = port(&raw.port, raw.baud.unwrap_or(230_400), wrong);
    let deadline_ms = deadline_ms(raw.deadline_ms.as_ref(), wrong);
    let range = choice(&raw.range, "range", &[("fine", Range::Fine), ("coarse", Range::Coarse)], wrong);
    let nominal_nm = positive(&raw.nominal_nm, "nominal_nm", wrong);
    driver?;
    Some(LorenzSettings {
        name: "torque_sensor".into(),
        port: port?,
        deadline_ms: deadline_ms?,
        range: range?,
        nominal_nm: nominal_nm?,
    })
}

fn check_brake(raw: &RawBrake, wrong: &mut Collector) -> Option<ScpiSettings> {
    let driver = choice(&raw.driver, "driver", &[("scpi", ())], wrong);
    let port = port(&raw.port, raw.baud.unwrap_or(115_200), wrong);
    let deadline_ms = deadline_ms(raw.deadline_ms.as_ref(), wrong);
    driver?;
    Some(ScpiSettings { name: "brake_a".into(), port: port?, deadline_ms: deadline_ms? })
}

fn port(given: &Spanned<String>, baud: u32, wrong: &mut Collector) -> Option<PortSettings> {
    if given.get_ref().trim().is_empty() {
        wrong.add(given.span(), "port is empty: name a serial port (/dev/ttyUSB0, COM3) or tcp://host:port");
        return None;
    }
    Some(PortSettings::new(given.get_ref().as_str(), baud))
}

fn deadline_ms(given: Option<&Spanned<u64>>, wrong: &mut Collector) -> Option<u64> {
    let Some(given) = given else { return Some(DEADLINE_MS) };
    if !(1..=LONGEST_DEADLINE_MS).contains(given.get_ref()) {
        wrong.add(given.span(), format!("deadline_ms {}: choose 1 to {LONGEST_DEADLINE_MS}", given.get_ref()));
        return None;
    }
    Some(*given.get_ref())
}

fn choice<T: Copy>(given: &Spanned<String>, what: &str, known: &[(&str, T)], wrong: &mut Collector) -> Option<T> {
    let found = known.iter().find(|(name, _)| name == given.get_ref());
    if found.is_none() {
        let names: Vec<String> = known.iter().map(|(name, _)| format!("{name:?}")).collect();
        wrong.add(given.span(), format!("{what} {:?} is not known: write {}", given.get_ref(), names.join(" or ")));
    }
    found.map(|(_, value)| *value)
}

fn positive(given: &Spanned<f64>, what: &str, wrong: &mut Collector) -> Option<f64> {
    let value = *given.get_ref();
    if value.is_finite() && value > 0.0 {
        return Some(value);
    }
    wrong.add(given.span(), format!("{what} = {value}: give a number above 0"));
    None
}

/// The value given, or that of the data sheet.
fn either(
    given: Option<&Spanned<f64>>,
    sheet: Option<f64>,
    name: &str,
    place: &std::ops::Range<usize>,
    wrong: &mut Collector,
) -> Option<f64> {
    match given {
        Some(given) => positive(given, name, wrong),
        None if sheet.is_some() => sheet,
        None => {
            wrong.add(place.clone(), format!("{name} is missing: a bench with real instruments has to give it"));
            None
        }
    }
}

fn limits(
    raw: Option<&RawLimits>,
    sheet: Option<Limits>,
    place: std::ops::Range<usize>,
    wrong: &mut Collector,
) -> Option<Limits> {
    let mut take = |given: Option<&Spanned<f64>>, sheet: Option<f64>, name: &str| {
        either(given, sheet, &format!("limits.{name}"), &place, wrong)
    };
    let velocity = take(
        raw.and_then(|r| r.motor_velocity_rad_s.as_ref()),
        sheet.map(|s| s.motor_velocity_rad_s),
        "motor_velocity_rad_s",
    );
    let current =
        take(raw.and_then(|r| r.motor_current_a.as_ref()), sheet.map(|s| s.motor_current_a), "motor_current_a");
    let torque = take(raw.and_then(|r| r.link_torque_nm.as_ref()), sheet.map(|s| s.link_torque_nm), "link_torque_nm");
    let heat = take(raw.and_then(|r| r.temperature_c.as_ref()), sheet.map(|s| s.temperature_c), "temperature_c");
    let brake = take(raw.and_then(|r| r.brake_current_a.as_ref()), sheet.map(|s| s.brake_current_a), "brake_current_a");
    let power = take(raw.and_then(|r| r.brake_power_w.as_ref()), sheet.map(|s| s.brake_power_w), "brake_power_w");
    Some(Limits {
        motor_velocity_rad_s: velocity?,
        motor_current_a: current?,
        link_torque_nm: torque?,
        temperature_c: heat?,
        brake_current_a: brake?,
        brake_power_w: power?,
    })
}

fn constants(
    raw: Option<&RawConstants>,
    sheet: Option<JointConstants>,
    place: std::ops::Range<usize>,
    wrong: &mut Collector,
) -> Option<JointConstants> {
    let range =
        raw.and_then(|r| r.link_range_rad.as_ref()).map(|given| positive(given, "constants.link_range_rad", wrong));
    let mut take = |given: Option<&Spanned<f64>>, sheet: Option<f64>, name: &str| {
        either(given, sheet, &format!("constants.{name}"), &place, wrong)
    };
    let torque_constant = take(
        raw.and_then(|r| r.torque_constant_nm_per_a.as_ref()),
        sheet.map(|s| s.torque_constant_nm_per_a),
        "torque_constant_nm_per_a",
    );
    let ratio = take(raw.and_then(|r| r.gear_ratio.as_ref()), sheet.map(|s| s.gear_ratio), "gear_ratio");
    let inertia = take(
        raw.and_then(|r| r.rotor_inertia_kg_m2.as_ref()),
        sheet.map(|s| s.rotor_inertia_kg_m2),
        "rotor_inertia_kg_m2",
    );
    let compliance = take(
        raw.and_then(|r| r.brake_compliance_v.as_ref()),
        sheet.map(|s| s.brake_compliance_v),
        "brake_compliance_v",
    );
    let current = take(
        raw.and_then(|r| r.brake_rated_current_a.as_ref()),
        sheet.map(|s| s.brake_rated_current_a),
        "brake_rated_current_a",
    );
    let torque = take(
        raw.and_then(|r| r.brake_rated_torque_nm.as_ref()),
        sheet.map(|s| s.brake_rated_torque_nm),
        "brake_rated_torque_nm",
    );
    Some(JointConstants {
        torque_constant_nm_per_a: torque_constant?,
        gear_ratio: ratio?,
        rotor_inertia_kg_m2: inertia?,
        brake_compliance_v: compliance?,
        brake_rated_current_a: current?,
        brake_rated_torque_nm: torque?,
        link_range_rad: flip(range)?.or(sheet.and_then(|s| s.link_range_rad)),
    })
}
