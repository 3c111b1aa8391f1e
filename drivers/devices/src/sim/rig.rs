//! The simulation behind the wires: the plant and the instruments' firmware, advanced together.

use super::firmware::{Adam, Dmm, Dp800, Encoder, Firmware, Gcs, Hmp, Kepco, Lorenz, Qsb};
use super::plant::{Plant, STEP_S};
use super::trouble::{PlannedTrouble, Trouble};
use serde::{Deserialize, Serialize};

/// The instruments of a mock bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MockInstrument {
    /// Drive of the joint.
    Joint,
    /// Torque sensor between joint and load.
    TorqueSensor,
    /// Supply of the brake's coil.
    Brake,
    /// Encoder S1 of the encoder bench, on the motor shaft.
    CounterS1,
    /// Encoder S2 on the same shaft; its status output is wired to the counter's first digital input.
    CounterS2,
    /// Channel 0: the brake housing; 1: the joint's gear; the others: the room.
    Thermometer,
    /// Holds the sensor of S2: x radial, y vertical, z axial.
    Stage,
    /// On the analogue output of the torque sensor's small range, 10 V for 20 Nm.
    Multimeter,
    /// The disk for the readings: no instrument and no wire. The recorder asks [`super::MockBench::disk_is_full`].
    Disk,
}

impl MockInstrument {
    /// The instruments of every mock bench with a load.
    pub const JOINT_BENCH: [MockInstrument; 3] =
        [MockInstrument::Joint, MockInstrument::TorqueSensor, MockInstrument::Brake];

    /// The instruments of an encoder bench in addition to its motor.
    pub const ENCODER_BENCH: [MockInstrument; 4] =
        [MockInstrument::CounterS1, MockInstrument::CounterS2, MockInstrument::Stage, MockInstrument::Thermometer];

    /// The disk is the last variant.
    const COUNT: usize = MockInstrument::Disk as usize + 1;

    pub(super) fn label(self) -> &'static str {
        match self {
            MockInstrument::Joint => "joint",
            MockInstrument::TorqueSensor => "torque_sensor",
            MockInstrument::Brake => "brake",
            MockInstrument::CounterS1 => "counter_s1",
            MockInstrument::CounterS2 => "counter_s2",
            MockInstrument::Thermometer => "thermometer",
            MockInstrument::Stage => "stage",
            MockInstrument::Multimeter => "multimeter",
            MockInstrument::Disk => "disk",
        }
    }

    /// Bits per second on its line.
    pub fn baud(self) -> u32 {
        match self {
            MockInstrument::Joint => 921_600,
            MockInstrument::TorqueSensor | MockInstrument::CounterS1 | MockInstrument::CounterS2 => 230_400,
            MockInstrument::Brake | MockInstrument::Stage => 115_200,
            MockInstrument::Thermometer | MockInstrument::Multimeter => 9600,
            MockInstrument::Disk => 0,
        }
    }

    /// The firmware of an instrument that only some mock benches have.
    fn other(self) -> Option<Box<dyn Firmware + Send>> {
        match self {
            MockInstrument::Joint | MockInstrument::TorqueSensor | MockInstrument::Brake | MockInstrument::Disk => None,
            MockInstrument::CounterS1 => Some(Box::new(Qsb::new(Encoder::S1))),
            MockInstrument::CounterS2 => Some(Box::new(Qsb::new(Encoder::S2))),
            MockInstrument::Thermometer => Some(Box::new(Adam::new())),
            MockInstrument::Stage => Some(Box::new(Gcs::new())),
            MockInstrument::Multimeter => Some(Box::new(Dmm::new())),
        }
    }
}

/// The supply of the brake's coil.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Supply {
    /// Rigol DP821A, up to 60 V.
    #[default]
    Dp821a,
    /// Ends at 32 V, which is too low for the rated current in a warm coil.
    Hmp4040,
    /// Kepco BOP 100-2, up to 100 V.
    KepcoBop,
}

/// Beyond 131 % of the small range, where the converter ends, and well within the large range.
const SENSOR_SHIFT_NM: f64 = 27.0;
const LOOSE_CONTACT_OHM: f64 = 250.0;
const THERMISTOR_FAULT_K: f64 = 70.0;

pub(super) struct Rig {
    pub plant: Plant,
    joint: Box<dyn Firmware + Send>,
    torque_sensor: Lorenz,
    brake: Box<dyn Firmware + Send>,
    others: Vec<(MockInstrument, Box<dyn Firmware + Send>)>,
    troubles: [Trouble; MockInstrument::COUNT],
    /// Start and end times of planned troubles. The next one is last.
    planned: Vec<(f64, MockInstrument, Trouble)>,
}

impl Rig {
    pub fn new(
        plant: Plant,
        joint: Box<dyn Firmware + Send>,
        supply: Supply,
        others: &[MockInstrument],
        planned: &[PlannedTrouble],
    ) -> Self {
        let others = others.iter().filter_map(|other| Some((*other, other.other()?))).collect();
        let mut moments = Vec::new();
        for plan in planned {
            moments.push((plan.from_s, plan.instrument, plan.trouble));
            moments.extend(plan.until_s.map(|until_s| (until_s, plan.instrument, Trouble::None)));
        }
        // At equal times, an end precedes a start.
        moments.sort_by(|(a_s, _, a), (b_s, _, b)| {
            b_s.total_cmp(a_s).then((*a == Trouble::None).cmp(&(*b == Trouble::None)))
        });
        let torque_sensor = Lorenz::new();
        let brake: Box<dyn Firmware + Send> = match supply {
            Supply::Dp821a => Box::new(Dp800::new()),
            Supply::Hmp4040 => Box::new(Hmp::new()),
            Supply::KepcoBop => Box::new(Kepco::new()),
        };
        Self { plant, joint, torque_sensor, brake, others, troubles: Default::default(), planned: moments }
    }

    pub fn advance(&mut self) {
        while let Some((_, instrument, trouble)) = self.planned.pop_if(|(at_s, ..)| *at_s <= self.plant.now_s()) {
            self.apply_trouble(instrument, trouble);
        }
        self.joint.step(&mut self.plant);
        self.brake.step(&mut self.plant);
        self.torque_sensor.step(&mut self.plant);
        self.others.iter_mut().for_each(|(_, firmware)| firmware.step(&mut self.plant));
        self.plant.advance();
    }

    /// Advances the plant to `t_s`.
    pub fn advance_until(&mut self, t_s: f64) {
        while self.plant.now_s() + 0.5 * STEP_S < t_s {
            self.advance();
        }
    }

    pub fn trouble(&self, instrument: MockInstrument) -> Trouble {
        self.troubles[instrument as usize]
    }

    /// Starts or ends a trouble of an instrument.
    pub fn apply_trouble(&mut self, instrument: MockInstrument, trouble: Trouble) {
        let before = std::mem::replace(&mut self.troubles[instrument as usize], trouble);
        let Some((firmware, plant)) = self.firmware(instrument) else { return };
        firmware.apply_trouble(trouble);
        if before != trouble && [before, trouble].contains(&Trouble::PowerCycled) {
            firmware.power_cycle(plant);
        }
        let is = |instrument, trouble| self.trouble(instrument) == trouble;
        let saturated = is(MockInstrument::TorqueSensor, Trouble::Saturated);
        let loose = is(MockInstrument::Brake, Trouble::CurrentLost);
        let hot = is(MockInstrument::Joint, Trouble::OverTemperature);
        self.plant.coupling_slips(is(MockInstrument::Joint, Trouble::CouplingSlips));
        self.plant.sensor_shift_nm = if saturated { SENSOR_SHIFT_NM } else { 0.0 };
        self.plant.brake.contact_ohm = if loose { LOOSE_CONTACT_OHM } else { 0.0 };
        self.plant.thermistor_fault_k = if hot { THERMISTOR_FAULT_K } else { 0.0 };
    }

    /// Passes `input` to an instrument; incomplete requests remain in `input`.
    pub fn receive(&mut self, instrument: MockInstrument, input: &mut Vec<u8>, output: &mut Vec<u8>) {
        if self.trouble(instrument) == Trouble::PowerCycled {
            return input.clear();
        }
        if let Some((firmware, plant)) = self.firmware(instrument) {
            firmware.receive(input, plant, output);
        }
    }

    /// Appends bytes that an instrument sends without a request.
    pub fn unasked(&mut self, instrument: MockInstrument, output: &mut Vec<u8>) {
        if let Some((firmware, _)) = self.firmware(instrument) {
            firmware.unasked(output);
        }
    }

    pub fn is_streaming(&mut self, instrument: MockInstrument) -> bool {
        self.firmware(instrument).is_some_and(|(firmware, _)| firmware.is_streaming())
    }

    /// `None`: this bench does not have the instrument.
    fn firmware(&mut self, instrument: MockInstrument) -> Option<(&mut dyn Firmware, &mut Plant)> {
        let firmware: &mut dyn Firmware = match instrument {
            MockInstrument::Joint => self.joint.as_mut(),
            MockInstrument::TorqueSensor => &mut self.torque_sensor,
            MockInstrument::Brake => self.brake.as_mut(),
            other => self.others.iter_mut().find(|(known, _)| *known == other).map(|(_, firmware)| firmware)?.as_mut(),
        };
        Some((firmware, &mut self.plant))
    }
}
