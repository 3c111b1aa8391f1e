//! Checks raw values and converts them.

use super::archive::check_archive;
use super::error::{Collector, ConfigErrors};
use super::figures::{Sheet, check_reach, check_torsion};
use super::instruments::{calibrations, instruments, ninter};
use super::notify::{check_dashboard, check_targets};
use super::raw::{RawBench, RawFile, RawMock};
use super::values::{choice, flip, positive, within};
use super::{BenchDescription, Description, Notify, Source};
use jointbench_devices::sim::{Load, MockInstrument, PlannedTrouble, Supply, Transport, Trouble};
use jointbench_devices::{Joint, MockSettings};
use jointbench_instrument::spelling::plainly;
use serde::Serialize;
use toml::Spanned;

/// Of the name of a bench.
const LONGEST_NAME: usize = 64;

pub(super) fn check(file: &str, text: &str) -> Result<Description, ConfigErrors> {
    let mut wrong = Collector::new(text);
    let raw: RawFile = match toml::from_str(text) {
        Ok(raw) => raw,
        Err(fault) => {
            wrong.add(fault.span().unwrap_or(0..0), plainly(fault.message().trim()));
            return wrong.finish(file, None);
        }
    };
    if raw.bench.is_empty() {
        wrong.add(0..0, "no bench described: add [[bench]] with its name");
    }
    for (i, bench) in raw.bench.iter().enumerate() {
        if raw.bench[..i].iter().any(|earlier| earlier.name.get_ref() == bench.name.get_ref()) {
            wrong.add(
                bench.name.span(),
                format!("bench {:?} exists twice: give each bench its own name", bench.name.get_ref()),
            );
        }
    }
    // Checks every bench, so that the errors of all benches are reported.
    let benches: Vec<_> = raw.bench.iter().map(|bench| check_bench(bench, text, &mut wrong)).collect();
    let heads = text.lines().filter(|line| is_notify(line)).count();
    if let Some(hidden) = raw.notify.get(heads) {
        wrong.add(hidden.span(), "write each target of notifications as a table [[notify]]");
    }
    let targets = check_targets(file, &raw.notify, &mut wrong);
    let dashboard = raw.dashboard.as_ref().map(|given| check_dashboard(given, &mut wrong));
    let archive = raw.archive.as_ref().map(|given| check_archive(given, &mut wrong));
    let checked = || {
        let benches = benches.into_iter().collect::<Option<_>>()?;
        let notify = Notify { dashboard: flip(dashboard)?, targets: targets? };
        Some(Description { benches, notify, archive: flip(archive)? })
    };
    let checked = checked();
    wrong.finish(file, checked)
}

fn check_bench(raw: &RawBench, text: &str, wrong: &mut Collector) -> Option<BenchDescription> {
    let name = raw.name.get_ref();
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    if name.is_empty() || name.len() > LONGEST_NAME || !name.chars().all(plain) {
        let message = "use 1 to 64 letters, digits, -, _ and . (the name is part of addresses)";
        wrong.add(raw.name.span(), format!("name {name:?}: {message}"));
    }
    let source = match (&raw.mock, &raw.joint) {
        (Some(mock), None) if !raw.has_instruments() => check_mock(mock, wrong).map(Source::Mock),
        (Some(_), _) => {
            wrong.add(raw.name.span(), format!("bench {name:?} has [bench.mock] and instruments: remove one of them"));
            None
        }
        (None, Some(joint)) => instruments(raw, joint, wrong).map(|settings| Source::Hardware(Box::new(settings))),
        (None, None) => {
            wrong.add(raw.name.span(), format!("bench {name:?} has no joint: add [bench.joint], or [bench.mock]"));
            return None;
        }
    };
    let sheet = match &source {
        // Limits and constants depend on the simulated joint, which is unknown.
        None if raw.mock.is_some() => return None,
        Some(Source::Mock(settings)) => Sheet::simulated(settings.limits(), settings.constants()),
        _ => Sheet::of(raw),
    };
    let (limits, constants) = (sheet.limits(raw, wrong), sheet.constants(raw, wrong));
    if let (Some(limits), Some(constants)) = (&limits, &constants) {
        check_reach(raw, limits, constants, wrong);
    }
    let torsion = raw.torsion.as_ref().map(|given| check_torsion(given, source.as_ref(), wrong));
    let calibrated = calibrations(raw, wrong);
    Some(BenchDescription {
        name: name.clone(),
        source: source?,
        limits: limits?,
        torsion: flip(torsion)?,
        constants: constants?,
        calibrated: calibrated?,
        record: None,
        text: without_notify(bench_section(text, raw.name.span().start)),
    })
}

/// The text of the bench whose name is at `name_at`: its section, or the whole file if it has one bench.
fn bench_section(text: &str, name_at: usize) -> &str {
    let lines = text.split_inclusive('\n').scan(0, |end, line| {
        *end += line.len();
        Some((*end - line.len(), line))
    });
    let heads: Vec<usize> =
        lines.filter(|(_, line)| line.trim_start().starts_with("[[bench]]")).map(|(start, _)| start).collect();
    match heads.iter().rposition(|head| *head < name_at) {
        Some(own) if heads.len() > 1 => &text[heads[own]..heads.get(own + 1).copied().unwrap_or(text.len())],
        _ => text,
    }
}

/// The text without the tables of targets: their addresses are not for everybody who reads a run.
fn without_notify(section: &str) -> String {
    let mut notify = false;
    let kept = section.split_inclusive('\n').filter(|line| {
        if line.trim_start().starts_with('[') {
            notify = is_notify(line);
        }
        !notify
    });
    kept.collect()
}

/// Whether a line is the head of a target.
fn is_notify(line: &str) -> bool {
    let head = line.trim_start().strip_prefix("[[").and_then(|rest| rest.split_once("]]"));
    head.is_some_and(|(name, _)| name.trim() == "notify")
}

/// Checks simulated faults, each for an instrument of the bench.
fn troubles(given: &[Spanned<PlannedTrouble>], bench: &MockSettings, wrong: &mut Collector) -> Vec<PlannedTrouble> {
    for planned in given {
        let PlannedTrouble { instrument, trouble, from_s, until_s } = *planned.get_ref();
        if (instrument == MockInstrument::Disk) != (trouble == Trouble::DiskFull) {
            wrong.add(
                planned.span(),
                "instrument \"disk\" and trouble \"disk_full\" belong together: give both or neither",
            );
        } else if !trouble.can_strike(instrument) {
            let what =
                format!("{} cannot have the trouble {}: choose another instrument", word(instrument), word(trouble));
            wrong.add(planned.span(), what);
        } else if instrument != MockInstrument::Disk && !bench.has(instrument) {
            wrong.add(planned.span(), format!("this bench has no {}: remove its trouble", word(instrument)));
        }
        if let Some(until_s) = until_s.filter(|until_s| *until_s <= from_s) {
            wrong.add(planned.span(), format!("until_s = {until_s} must be later than from_s = {from_s}"));
        }
    }
    given.iter().map(|planned| *planned.get_ref()).collect()
}

/// The spelling in a description.
fn word(named: impl Serialize) -> String {
    serde_json::to_value(named).map(|word| word.to_string()).unwrap_or_default()
}

fn check_mock(raw: &RawMock, wrong: &mut Collector) -> Option<MockSettings> {
    let joints =
        [("a", Joint::JointA), ("b", Joint::JointB), ("encoder_shaft", Joint::EncoderShaft), ("puma", Joint::Puma)];
    let joint = choice(&raw.joint, "joint", &joints, wrong);
    let hideable = joint.map(Joint::hides).unwrap_or_default();
    for effect in raw.effects.iter().filter(|effect| joint.is_some() && !hideable.contains(&effect.get_ref().as_str()))
    {
        let what = format!("effect {:?}: this mock bench can hide {}", effect.get_ref(), hideable.join(", "));
        wrong.add(effect.span(), what);
    }
    let loads = [("brake_a", Load::BrakeA), ("gear_and_brake_b", Load::GearAndBrakeB)];
    let load = raw.load.as_ref().map(|load| choice(load, "load", &loads, wrong));
    if let (Some(given), Some(Joint::EncoderShaft | Joint::Puma)) = (&raw.load, joint) {
        wrong.add(given.span(), "this joint has no load: remove load");
    }
    if joint.is_some_and(|joint| joint != Joint::Puma) {
        let given = [
            ("servo", raw.servo.as_ref().map(Spanned::span)),
            ("ninter", raw.ninter.as_ref().map(Spanned::span)),
            ("axis", raw.axis.as_ref().map(Spanned::span)),
        ];
        for (name, place) in given {
            let place = place.into_iter();
            place.for_each(|place| wrong.add(place, format!("this joint is not a Puma-type arm: remove {name}")));
        }
    }
    let ninter = ninter(raw.ninter.as_ref(), wrong);
    let gains = raw.servo.as_ref().map(|given| *given.get_ref()).unwrap_or_default();
    let supplies = [("dp821a", Supply::Dp821a), ("hmp4040", Supply::Hmp4040), ("kepco_bop", Supply::KepcoBop)];
    let supply =
        raw.supply.as_ref().map_or(Some(Supply::default()), |supply| choice(supply, "supply", &supplies, wrong));
    let pace = raw.pace.as_ref().and_then(|pace| positive(pace, "pace", wrong));
    let axis = raw.axis.as_ref().map(|axis| within(axis, "axis", 1..=6, wrong));
    let effects = raw.effects.iter().map(|effect| effect.get_ref().clone()).collect();
    let mut settings = MockSettings { documents: raw.documents, ..MockSettings::new(joint?, raw.seed.unwrap_or(1)) };
    settings.axis = axis.unwrap_or(Some(settings.axis))?;
    if raw.thermometer && !settings.has(MockInstrument::Thermometer) {
        settings.others.push(MockInstrument::Thermometer);
    }
    let load = load.unwrap_or(Some(settings.load))?;
    let (filter, supply, ninter, troubles) = (raw.filter, supply?, ninter?, troubles(&raw.troubles, &settings, wrong));
    // Other programs can connect to a bench with a pace; a bench without one is too fast for them.
    let transport = if pace.is_some() { Transport::Terminal } else { settings.transport };
    Some(MockSettings { load, effects, pace, filter, supply, troubles, transport, ninter, gains, ..settings })
}
