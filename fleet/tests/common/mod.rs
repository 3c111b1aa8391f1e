//! A simulated fleet in the layout of docs/archive.md, written by the writer of the daemon.
//!
//! The formulas are those of this file: the simulation shares no code with the model.
#![allow(dead_code)]

use jointbench_files::{Annotations, ParquetWriter};
use jointbench_instrument::{Channel, Kind, Meta, Trace};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use sha2::{Digest, Sha256};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

pub const PART: &str = "JA-100";
/// Torque constant [Nm/A].
const KM: f64 = 0.1;
/// Scatter of the mean torque of a steady state [Nm].
const NOISE_NM: f64 = 2e-4;
/// Motor velocities of a run, in both directions [rad/s].
const SPEEDS: [f64; 8] = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];
const REPEATS: usize = 3;

/// What is simulated.
#[derive(Debug, Clone)]
pub struct Fleet {
    pub batches: usize,
    pub units_per_batch: usize,
    pub seed: u64,
    /// Share of the units with a Stribeck effect.
    pub stribeck_share: f64,
    /// Torque of that effect at standstill [Nm].
    pub stribeck_nm: f64,
    /// Batch whose Coulomb friction is larger, and by how much [Nm].
    pub shift: Option<(usize, f64)>,
    /// Steady states of a run are repeated until there are at least so many.
    pub least_rows: usize,
}

impl Default for Fleet {
    fn default() -> Self {
        Self {
            batches: 5,
            units_per_batch: 400,
            seed: 1,
            stribeck_share: 0.0,
            stribeck_nm: 0.012,
            shift: None,
            least_rows: 2 * REPEATS * SPEEDS.len(),
        }
    }
}

/// What a fleet contains.
#[derive(Debug, Clone, Default)]
pub struct Truth {
    /// Serial numbers with the Stribeck effect.
    pub planted: BTreeSet<String>,
    /// Files, in the order of the serial numbers.
    pub files: Vec<PathBuf>,
}

/// Parameters of one joint.
struct Joint {
    coulomb_nm: f64,
    viscous_nm_s_per_rad: f64,
    stribeck_nm: f64,
    stribeck_rad_s: f64,
}

impl Joint {
    fn torque(&self, velocity: f64) -> f64 {
        let low_speed = self.stribeck_nm * (-(velocity.abs() / self.stribeck_rad_s)).exp();
        (self.coulomb_nm + low_speed).copysign(velocity) + self.viscous_nm_s_per_rad * velocity
    }
}

fn normal(random: &mut ChaCha8Rng, mean: f64, deviation: f64) -> f64 {
    Normal::new(mean, deviation).unwrap().sample(random)
}

/// Writes all units to an archive folder.
pub fn write(root: &Path, fleet: &Fleet) -> Truth {
    let mut random = ChaCha8Rng::seed_from_u64(fleet.seed);
    let mut truth = Truth::default();
    let count = fleet.batches * fleet.units_per_batch;
    // A fixed number of planted units, spread evenly.
    let planted = (fleet.stribeck_share * count as f64).round() as usize;
    let is_planted = |unit: usize| (unit + 1) * planted / count > unit * planted / count;
    for unit in 0..count {
        let batch = unit / fleet.units_per_batch;
        let shift = fleet.shift.filter(|(shifted, _)| *shifted == batch).map_or(0.0, |(_, shift)| shift);
        let joint = Joint {
            coulomb_nm: normal(&mut random, 0.030 + shift, 0.0015),
            viscous_nm_s_per_rad: normal(&mut random, 8e-4, 4e-5),
            stribeck_nm: if is_planted(unit) { fleet.stribeck_nm } else { 0.0 },
            stribeck_rad_s: normal(&mut random, 3.0, 0.2),
        };
        let serial = format!("SN{unit:05}");
        if is_planted(unit) {
            truth.planted.insert(serial.clone());
        }
        let run = Run { serial, batch: format!("B{}", batch + 1), number: unit + 1, ..Run::default() };
        truth.files.push(run.write(root, &means(&joint, fleet.least_rows, &mut random)));
    }
    truth
}

/// Identity of a run.
#[derive(Debug, Clone)]
pub struct Run {
    pub serial: String,
    pub batch: String,
    pub number: usize,
    pub store: &'static str,
    pub state: &'static str,
    pub created_at: String,
}

impl Default for Run {
    fn default() -> Self {
        let (serial, batch, created_at) = ("SN1".to_owned(), "B1".to_owned(), String::new());
        Self { serial, batch, number: 1, store: "5f0c91d2aa03b7e4", state: "completed", created_at }
    }
}

/// Samples of one run at 1 kHz in segments of 10,000: velocities and currents as whole counts of their instruments.
pub fn samples(rows: usize, seed: u64) -> Trace {
    let names = ["time_s", "segment", "motor_position_rad", "motor_velocity_rad_s", "motor_current_a", "temperature_c"];
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let joint = Joint { coulomb_nm: 0.03, viscous_nm_s_per_rad: 8e-4, stribeck_nm: 0.0, stribeck_rad_s: 3.0 };
    let noise = Normal::new(0.0, 1.0).unwrap();
    let counted = |value: f64, count: f64| (value / count).round() * count;
    let mut trace = Trace::new(names.map(Channel::new).to_vec());
    let mut position = 0.0;
    for row in 0..rows {
        let segment = row / 10_000;
        let speed = SPEEDS[segment % SPEEDS.len()] * if segment.is_multiple_of(2) { 1.0 } else { -1.0 };
        let velocity = counted(speed + 0.02 * noise.sample(&mut random), 0.01);
        let current = counted((joint.torque(velocity) + 2e-3 * noise.sample(&mut random)) / KM, 1e-3);
        position += 1e-3 * velocity;
        trace.push_row(&[1e-3 * row as f64, segment as f64, counted(position, 1e-4), velocity, current, 25.0]);
    }
    trace
}

/// The means of one run of one joint with these parameters: Coulomb \[Nm\], viscous \[Nm·s/rad\], Stribeck \[Nm\].
pub fn table(coulomb_nm: f64, viscous_nm_s_per_rad: f64, stribeck_nm: f64, seed: u64) -> Trace {
    let joint = Joint { coulomb_nm, viscous_nm_s_per_rad, stribeck_nm, stribeck_rad_s: 3.0 };
    means(&joint, 0, &mut ChaCha8Rng::seed_from_u64(seed))
}

fn means(joint: &Joint, least_rows: usize, random: &mut ChaCha8Rng) -> Trace {
    let names = [
        "time_s",
        "segment",
        "repeat",
        "motor_position_rad",
        "motor_velocity_rad_s",
        "motor_current_a",
        "temperature_c",
        "duration_s",
        "samples",
    ];
    let mut trace = Trace::new(names.map(Channel::new).to_vec());
    let (mut time_s, mut segment) = (0.0, 0.0);
    let repeats = REPEATS.max(least_rows.div_ceil(2 * SPEEDS.len()));
    for repeat in 0..repeats {
        for speed in SPEEDS {
            for direction in [1.0, -1.0] {
                // The drive holds the speed within 0.1 %.
                let velocity = direction * speed * (1.0 + normal(random, 0.0, 1e-3));
                let torque = joint.torque(velocity) + normal(random, 0.0, NOISE_NM);
                let temperature = 25.0 + normal(random, 0.0, 0.2);
                let angle = direction * speed * 1.5;
                trace.push_row(&[
                    time_s,
                    segment,
                    repeat as f64,
                    angle,
                    velocity,
                    torque / KM,
                    temperature,
                    2.0,
                    2000.0,
                ]);
                time_s += 3.0;
                segment += 1.0;
            }
        }
    }
    trace
}

impl Run {
    /// Test conditions, as the daemon writes them for means.
    pub fn meta() -> Meta {
        Meta {
            kind: Some(Kind::Friction),
            operating_points: true,
            torque_constant_nm_per_a: Some(KM),
            gear_ratio: Some(100.0),
            baseline: vec!["coulomb".into(), "viscous".into()],
            ..Meta::default()
        }
    }

    /// One batch a week, one run every twelve minutes.
    fn created(&self) -> String {
        let batch: usize = self.batch.trim_start_matches('B').parse().unwrap_or(1);
        if !self.created_at.is_empty() {
            return self.created_at.clone();
        }
        let first: jiff::Timestamp = "2026-03-02T00:00:00Z".parse().unwrap();
        let minutes = 7 * 24 * 60 * (batch as i64 - 1) + 12 * (self.number as i64 % 500);
        (first + jiff::SignedDuration::from_mins(minutes)).to_string()
    }

    /// Writes the means of this run. Returns the path.
    pub fn write(&self, root: &Path, means: &Trace) -> PathBuf {
        let folder = root.join(format!("means/part={PART}/batch={}/bench=eol-1", self.batch));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join(format!("run-{}-{}.parquet", self.store, self.number));
        self.write_to(&path, means);
        path
    }

    pub fn write_to(&self, path: &Path, means: &Trace) {
        let labels = vec![
            ("serial", Some(self.serial.clone())),
            ("revision", Some("C".to_owned())),
            ("procedure", Some("friction".to_owned())),
            ("started_at", Some(self.created())),
            ("run", Some(self.number.to_string())),
        ];
        self.write_table(path, "means", &Self::meta(), means, labels);
    }

    /// Writes the samples of this run. Returns the path.
    pub fn write_samples(&self, root: &Path, samples: &Trace) -> PathBuf {
        let folder = root.join(format!("samples/part={PART}/batch={}/bench=eol-1", self.batch));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join(format!("run-{}-{}.parquet", self.store, self.number));
        self.write_table(&path, "samples", &Meta { operating_points: false, ..Self::meta() }, samples, Vec::new());
        path
    }

    fn write_table(
        &self,
        path: &Path,
        content: &str,
        meta: &Meta,
        table: &Trace,
        labels: Vec<(&'static str, Option<String>)>,
    ) {
        let file = fs::File::create(path).unwrap();
        let facts = [
            ("jointbench.schema_version", "1".to_owned()),
            ("jointbench.content", content.to_owned()),
            ("jointbench.store", self.store.to_owned()),
            ("jointbench.run", self.number.to_string()),
            ("jointbench.bench", "eol-1".to_owned()),
            ("jointbench.procedure", "friction".to_owned()),
            ("jointbench.state", self.state.to_owned()),
            ("jointbench.created_at", self.created()),
            ("jointbench.calibrations", r#"{"certificates":null}"#.to_owned()),
            ("jointbench.software_version", "0.2.0".to_owned()),
            ("jointbench.sha256", digest(table)),
            ("jointbench.serial", self.serial.clone()),
            ("jointbench.part", PART.to_owned()),
            ("jointbench.revision", "C".to_owned()),
            ("jointbench.batch", self.batch.clone()),
        ];
        let more = Annotations { footer: facts.into(), labels };
        let mut parquet = ParquetWriter::annotated(file, meta, table.channels(), more).unwrap();
        parquet.write(table).unwrap();
        parquet.finish().unwrap();
    }
}

/// SHA-256 of all columns, as the daemon computes it.
fn digest(means: &Trace) -> String {
    let mut digest = Sha256::new();
    means.columns().iter().flatten().for_each(|value| digest.update(value.to_le_bytes()));
    digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
