//! The runs of the digests: short runs of the machines of the example `evaluate`, with a user formula or with
//! contradicting columns, some of full length, and published measurements.

use crate::common::recordings::{KR300, recording};
use crate::made;
use jointbench_instrument::{Channel, Kind, RunTable, Trace};
use jointbench_model::{Choice, ModelSpec, Options, Stretch, UserEffect};
use std::path::Path;

pub struct Case {
    pub name: String,
    pub run: RunTable,
    pub spec: ModelSpec,
    pub options: Options,
}

/// Rounds of machines.
const ROUNDS: [u64; 2] = [34_001, 34_002];

/// One machine of this number is evaluated in full length.
const LONG: usize = 6;

/// Kept part of a short run: the beginning of each step of a friction run, every n-th sample of the others.
const BEGINNING: f64 = 0.4;
const THINNED: usize = 3;

/// Sign flips of the short runs: sufficient for the smallest error probability in use.
const FLIPS: usize = 99;

/// Modification of a machine's run.
#[derive(Clone, Copy)]
enum Way {
    Long,
    Short,
    Formula,
    Contradictory,
}

/// The machines in order, each with its number.
pub fn machines() -> impl Iterator<Item = (usize, made::Case)> + Send {
    ROUNDS.into_iter().flat_map(made::round).enumerate()
}

pub fn of_machine((number, case): (usize, made::Case)) -> Vec<Case> {
    let long = number.is_multiple_of(LONG).then_some(Way::Long);
    let ways = [Way::Short, Way::Formula, Way::Contradictory].into_iter().chain(long);
    ways.map(|way| way.of(&case)).collect()
}

impl Way {
    fn of(self, case: &made::Case) -> Case {
        let (label, run) = match self {
            Way::Long => ("long", case.run.clone()),
            Way::Short => ("short", short(&case.run)),
            Way::Formula => ("formula", short(&case.run)),
            Way::Contradictory => ("contradictory", contradictory(&short(&case.run))),
        };
        let baseline = ModelSpec::baseline(&run).unwrap();
        let own = if matches!(self, Way::Formula) { vec![formula(run.kind())] } else { Vec::new() };
        let spec = ModelSpec::with_user_effects(run.kind(), baseline.effects, own).unwrap();
        let flips = if matches!(self, Way::Long) { Options::default().flips } else { FLIPS };
        Case { name: format!("{}-{label}", case.name), run, spec, options: Options { flips, ..Options::default() } }
    }
}

fn short(run: &RunTable) -> RunTable {
    if run.kind() != Kind::Friction {
        return rows(run, |i| i % THINNED == 0);
    }
    let segment = run.column("segment").unwrap();
    let mut kept = Vec::new();
    for step in segment.chunk_by(|a, b| a == b) {
        let first = (BEGINNING * step.len() as f64) as usize;
        kept.extend((0..step.len()).map(|i| i < first));
    }
    rows(run, |i| kept[i])
}

/// The rows that are kept.
fn rows(run: &RunTable, is_kept: impl Fn(usize) -> bool) -> RunTable {
    changed(run, |_, values| values.iter().enumerate().filter(|(i, _)| is_kept(*i)).map(|(_, v)| *v).collect())
}

fn changed(run: &RunTable, change: impl Fn(&str, &[f64]) -> Vec<f64>) -> RunTable {
    let channels: Vec<Channel> = run.trace().channels().to_vec();
    let columns = channels.iter().map(|c| change(&c.name, run.column(&c.name).unwrap())).collect();
    RunTable::new(run.meta().clone(), Trace::from_columns(channels, columns)).unwrap()
}

/// A column in another unit or with the opposite sign, in turn, so that every check is triggered.
fn contradictory(run: &RunTable) -> RunTable {
    let (name, scale) = match (run.kind(), run.len() % 3) {
        (Kind::Friction, 0) => ("motor_current_a", 1e3),
        (Kind::Friction, 1) => ("link_torque_nm", -1.0),
        (Kind::Friction, _) => ("motor_velocity_rad_s", 180.0 / std::f64::consts::PI),
        (Kind::Encoder, _) => ("velocity_rad_s", -1.0),
        (Kind::Stiffness, 0) => ("link_position_rad", -1.0),
        (Kind::Stiffness, _) => ("motor_position_rad", 1.02),
        (Kind::Brake, 0) => ("brake_current_a", 1e3),
        (Kind::Brake, _) => ("brake_torque_nm", 1e3),
    };
    changed(run, |column, values| {
        let scale = if column == name { scale } else { 1.0 };
        values.iter().map(|v| scale * v).collect()
    })
}

fn formula(kind: Kind) -> UserEffect {
    let text = match kind {
        Kind::Friction => "rub: tau = a * sqrt(abs(load) * abs(velocity)) * direction; a [1] 0..1",
        Kind::Encoder => "twist: error = a * tanh(velocity / w0); a [rad]; w0 [rad/s] 0.1..10",
        Kind::Stiffness => "cubic: torsion = a * load^3; a",
        Kind::Brake => "square: tau = a * current^2; a [Nm/A^2] 0..100",
    };
    UserEffect::inline(kind, text).unwrap()
}

/// Possible next runs: slow, fast, loaded, warm strokes.
pub fn menu(run: &RunTable) -> Vec<Choice> {
    let stroke = |name: &str, speeds: &[f64], load_nm: f64, brake_current_a: f64, warmer_k: f64| {
        let ways = speeds.iter().chain(speeds).flat_map(|speed| [*speed, -speed]);
        let stretches: Vec<Stretch> = ways
            .enumerate()
            .map(|(i, velocity_rad_s)| Stretch {
                start_s: i as f64,
                duration_s: 1.0,
                velocity_rad_s,
                from_rad: if velocity_rad_s > 0.0 { 0.0 } else { -velocity_rad_s },
                load_nm: load_nm * velocity_rad_s.signum(),
                brake_current_a,
                warmer_k,
                ..Stretch::default()
            })
            .collect();
        let duration_s = stretches.len() as f64;
        Choice { procedure: name.into(), parameters: serde_json::Map::new(), duration_s, stretches }
    };
    match run.kind() {
        Kind::Friction => vec![
            stroke("slow", &[0.5, 2.0], 0.0, 0.0, 0.0),
            stroke("fast", &[8.0, 20.0, 50.0, 100.0, 150.0], 0.0, 0.0, 0.0),
            stroke("loaded", &[8.0, 50.0], 12.0, 0.0, 0.0),
            stroke("warm", &[20.0, 100.0], 0.0, 0.0, 10.0),
        ],
        Kind::Brake => vec![stroke("weak", &[2.0, 5.0], 0.0, 0.1, 0.0), stroke("strong", &[2.0, 5.0], 0.0, 0.5, 0.0)],
        _ => vec![stroke("slow", &[0.5, 2.0], 0.0, 0.0, 0.0), stroke("loaded", &[2.0, 10.0], 20.0, 0.0, 0.0)],
    }
}

/// The published measurements that are present.
pub fn recordings(data: &Path) -> Vec<Case> {
    let mut folders: Vec<String> = std::fs::read_dir(data)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|folder| folder.join("meta.json").is_file())
        .map(|folder| folder.file_name().unwrap().to_string_lossy().into_owned())
        .collect();
    folders.sort();
    let mut cases: Vec<Case> = folders.iter().map(|folder| as_is(data, folder)).collect();
    let run = recording(data, KR300);
    let spec = ModelSpec::baseline(&run).unwrap();
    cases.push(Case { name: format!("{KR300}-as-stiffness"), run, spec, options: Options::default() });
    cases
}

fn as_is(data: &Path, folder: &str) -> Case {
    let run = crate::common::read(&data.join(folder));
    let spec = ModelSpec::baseline(&run).unwrap();
    Case { name: folder.to_owned(), run, spec, options: Options::default() }
}
