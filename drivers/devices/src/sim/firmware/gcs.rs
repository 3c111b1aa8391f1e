//! A PI hexapod on a C-887 controller (GCS 2.0 commands, C-887 user manual MS204E as far as the notes contain it).

use super::Firmware;
use super::gcs_motion::Motion;
use super::lines::answer_lines;
use crate::sim::plant::{Plant, Signal};
use crate::sim::trouble::Trouble;

const AXES: [&str; 6] = ["X", "Y", "Z", "U", "V", "W"];
const LONGEST_LINE: usize = 512;
/// Position noise: 0.1 µm, and 0.2 µrad in degrees.
const NOISE: [f64; 2] = [1e-4, 1.15e-5];

const SYNTAX: u32 = 1;
const UNKNOWN: u32 = 2;
const UNREFERENCED: u32 = 5;
const OUT_OF_LIMITS: u32 = 7;
const VELOCITY: u32 = 8;
const STOPPED: u32 = 10;
const INVALID_AXIS: u32 = 15;
const NAMED_TWICE: u32 = 22;
const COUNT: u32 = 24;
const INVALID_NUMBER: u32 = 25;
const LEVEL_TOO_LOW: u32 = 60;
const BUSY: u32 = 1005;

/// First word of the line and its description, for HLP?. A client (PIPython) assumes that other commands do not exist.
pub(super) const HELP: [&str; 26] = [
    "#5 request motion status",
    "#7 request controller ready status",
    "#24 stop all axes",
    "*IDN? get device identification",
    "CSV? get current syntax version",
    "CST? [{<AxisID>}] get assignment of stages to axes",
    "ERR? get error number",
    "FRF [{<AxisID>}] start reference move",
    "FRF? [{<AxisID>}] get referencing result",
    "HLP? get list of available commands",
    "HLT [{<AxisID>}] halt motion smoothly",
    "MOV {<AxisID> <Position>} set target position",
    "MOV? [{<AxisID>}] get target position",
    "MVR {<AxisID> <Distance>} set target relative to the last one",
    "ONT? [{<AxisID>}] get on-target state",
    "POS? [{<AxisID>}] get real position",
    "SAI? [ALL] get list of axis identifiers",
    "STP stop all axes",
    "SVO {<AxisID> <Mode>} set servo mode",
    "SVO? [{<AxisID>}] get servo mode",
    "TMN? [{<AxisID>}] get minimum commandable position",
    "TMX? [{<AxisID>}] get maximum commandable position",
    "VER? get versions of firmware and drivers",
    "VLS <Velocity> set system velocity",
    "VLS? get system velocity",
    "VMO? {<AxisID> <Position>} ask whether a move is possible",
];

pub struct Gcs {
    motion: Motion,
    servo: [f64; 6],
    error: u32,
    trouble: Trouble,
}

type Outcome = Result<Option<String>, u32>;

impl Gcs {
    pub fn new() -> Self {
        Self { motion: Motion::new(), servo: [1.0; 6], error: 0, trouble: Trouble::None }
    }

    fn line(&mut self, line: &str, plant: &Plant) -> Outcome {
        let mut words = line.split_ascii_whitespace();
        let Some(header) = words.next() else { return Ok(None) };
        let arguments: Vec<&str> = words.collect();
        if header == "ERR?" {
            return Ok(Some(std::mem::take(&mut self.error).to_string()));
        }
        if self.trouble == Trouble::Refusing {
            return Err(LEVEL_TOO_LOW);
        }
        if header.ends_with('?') { self.query(header, &arguments, plant) } else { self.set(header, &arguments, plant) }
    }

    fn query(&self, header: &str, arguments: &[&str], plant: &Plant) -> Outcome {
        let now_s = plant.now_s();
        let named = if arguments.is_empty() { &AXES[..] } else { arguments };
        let flag = |flag: bool| [if flag { 1.0 } else { 0.0 }; 6];
        let (values, decimals) = match header {
            "*IDN?" => {
                let serial = if self.trouble == Trouble::Exchanged { "999" } else { "0" };
                let maker = "(c)2015 Physik Instrumente (PI) GmbH & Co. KG";
                return Ok(Some(format!("{maker}, C-887, {serial}, 2.7.0.1")));
            }
            "CSV?" => return Ok(Some("2.0".into())),
            "SAI?" => return Ok(Some(AXES.join(" \n"))),
            "VER?" => return Ok(Some("FW_DSP: V2.7.0.1 \nFW_ARM: V2.7.0.1".into())),
            "HLP?" => {
                return Ok(Some(format!("The following commands are valid: \n{} \nend of help", HELP.join(" \n"))));
            }
            "CST?" => {
                let stage = |axis: &&str| index(axis).map(|_| format!("{axis}=NOSTAGE"));
                return Ok(Some(named.iter().map(stage).collect::<Result<Vec<_>, u32>>()?.join(" \n")));
            }
            "VLS?" => return Ok(Some(format!("{:.6}", self.motion.velocity_mm_s))),
            "VMO?" => {
                let possible = Motion::holds(assigned(self.motion.target, arguments, |_, value| value)?);
                return Ok(Some(u8::from(possible).to_string()));
            }
            "FRF?" => (flag(self.motion.is_referenced()), 0),
            "SVO?" => (self.servo, 0),
            "ONT?" => (flag(self.motion.is_settled(now_s)), 0),
            "MOV?" => (self.motion.target, 6),
            "POS?" => {
                let noise = plant.noise_of(Signal::Stage);
                let noisy = |axis: usize| self.motion.position(now_s)[axis] + NOISE[axis / 3] * noise;
                (std::array::from_fn(noisy), 6)
            }
            "TMN?" => (self.motion.reach().map(|reach| -reach), 4),
            "TMX?" => (self.motion.reach(), 4),
            _ => return Err(UNKNOWN),
        };
        let line = |axis: &&str| Ok(format!("{axis}={:.decimals$}", values[index(axis)?]));
        Ok(Some(named.iter().map(line).collect::<Result<Vec<_>, u32>>()?.join(" \n")))
    }

    fn set(&mut self, header: &str, arguments: &[&str], plant: &Plant) -> Outcome {
        let now_s = plant.now_s();
        if self.motion.is_busy(now_s) && matches!(header, "MOV" | "MVR" | "SVO" | "FRF" | "VLS") {
            return Err(BUSY);
        }
        match header {
            "FRF" => self.motion.reference(now_s),
            "SVO" => self.servo = assigned(self.servo, arguments, |_, value| value)?,
            "MOV" | "MVR" => {
                let relative = header == "MVR";
                let target =
                    assigned(self.motion.target, arguments, |old, value| if relative { old + value } else { value })?;
                if !self.motion.is_referenced() || self.servo.contains(&0.0) {
                    return Err(UNREFERENCED);
                }
                if !Motion::holds(target) {
                    return Err(OUT_OF_LIMITS);
                }
                self.motion.start(target, now_s);
            }
            "VLS" => {
                let [velocity] = arguments else { return Err(COUNT) };
                let velocity: f64 = velocity.parse().map_err(|_| INVALID_NUMBER)?;
                if !(velocity > 0.0 && velocity <= 20.0) {
                    return Err(VELOCITY);
                }
                self.motion.velocity_mm_s = velocity;
            }
            "HLT" | "STP" => self.stop(now_s),
            _ => return Err(UNKNOWN),
        }
        Ok(None)
    }

    fn stop(&mut self, now_s: f64) {
        self.motion.stop(now_s);
        self.error = STOPPED;
    }

    /// Single-byte commands take effect immediately, also in the middle of a line.
    fn byte(&mut self, byte: u8, plant: &Plant, output: &mut Vec<u8>) {
        let now_s = plant.now_s();
        match byte {
            0x05 => output.extend(if self.motion.is_moving(now_s) { b"3F\n" } else { &b"0\n"[..] }),
            0x07 => output.extend([if self.motion.is_busy(now_s) { 0xB0 } else { 0xB1 }, b'\n']),
            0x18 => self.stop(now_s),
            _ => self.error = UNKNOWN,
        }
    }
}

fn index(axis: &str) -> Result<usize, u32> {
    AXES.iter().position(|known| *known == axis).ok_or(INVALID_AXIS)
}

/// Applies `X 0.5 U 0.2` to the present values.
fn assigned(mut values: [f64; 6], arguments: &[&str], put: impl Fn(f64, f64) -> f64) -> Result<[f64; 6], u32> {
    let (pairs, []) = arguments.as_chunks::<2>() else { return Err(COUNT) };
    if pairs.is_empty() {
        return Err(SYNTAX);
    }
    let mut named = [false; 6];
    for [axis, value] in pairs {
        let axis = index(axis)?;
        if std::mem::replace(&mut named[axis], true) {
            return Err(NAMED_TWICE);
        }
        let value = value.parse().ok().filter(|value: &f64| value.is_finite()).ok_or(INVALID_NUMBER)?;
        values[axis] = put(values[axis], value);
    }
    Ok(values)
}

impl Firmware for Gcs {
    fn receive(&mut self, input: &mut Vec<u8>, plant: &mut Plant, output: &mut Vec<u8>) {
        input.retain(|byte| {
            let single = matches!(byte, 0x01..=0x09 | 0x0B..=0x1F);
            if single {
                self.byte(*byte, plant, output);
            }
            !single
        });
        answer_lines(input, LONGEST_LINE, output, |line| {
            self.line(line, plant).unwrap_or_else(|error| {
                self.error = error;
                None
            })
        });
    }

    fn step(&mut self, plant: &mut Plant) {
        let now_s = plant.now_s();
        self.motion.finish_reference(now_s);
        let [x, y, z, u, v, w] = self.motion.position(now_s);
        plant.hold_sensor([x, y, z].map(|mm| 1e-3 * mm), [u, v, w].map(f64::to_radians));
    }

    fn apply_trouble(&mut self, trouble: Trouble) {
        self.trouble = trouble;
    }

    /// The platform keeps its pose, but the pose is unknown until the stage is referenced.
    fn power_cycle(&mut self, _plant: &mut Plant) {
        *self = Self { trouble: self.trouble, ..Self::new() };
    }
}
