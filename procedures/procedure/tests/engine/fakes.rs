//! A bench of fakes: one world, a clock that advances only during waits, and a script that receives every call first.

use jointbench_instrument::bench::JointConstants;
use jointbench_instrument::roles::{
    CurrentSource, DriveHealth, Identity, Instrument, JointController, JointReading, JointResolution, Regulation,
    SupplyReading, Thermometer, TorqueSensor,
};
use jointbench_instrument::units::{Amperes, Celsius, NewtonMetres, RadPerSec, Radians, Volts};
use jointbench_instrument::{Bench, Clock, Fault, FaultKind, Limits};
use std::sync::{Arc, Mutex, MutexGuard};

/// A request to an instrument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Call {
    Identify(Role),
    Recover(Role),
    Arm,
    SetVelocity(f64),
    SetMotorCurrent(f64),
    ReadJoint,
    Health,
    Disarm,
    ReadTorque,
    Prepare,
    SetCurrent(f64),
    ReadBrake,
    OutputOff,
    ReadWarmth,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Role {
    Joint,
    Torque,
    Brake,
    Thermometer,
}

impl Call {
    pub fn role(self) -> Role {
        match self {
            Call::Identify(role) | Call::Recover(role) => role,
            Call::ReadTorque => Role::Torque,
            Call::ReadWarmth => Role::Thermometer,
            Call::Prepare | Call::SetCurrent(_) | Call::ReadBrake | Call::OutputOff => Role::Brake,
            _ => Role::Joint,
        }
    }
}

/// The true state of the bench.
#[derive(Debug, Clone)]
pub struct World {
    pub now_s: f64,
    pub armed: bool,
    pub setpoint_rad_s: f64,
    pub velocity_rad_s: f64,
    pub position_rad: f64,
    pub current_a: f64,
    pub torque_nm: f64,
    /// Temperature that the joint reports, if it does.
    pub temperature_c: Option<f64>,
    /// At the two channels of the thermometer.
    pub warmth_c: [f64; 2],
    pub brake_a: f64,
    pub brake_on: bool,
    pub regulation: Regulation,
    pub errors: Vec<String>,
    /// Time stamp of the joint's readings instead of the clock's.
    pub stuck_at_s: Option<f64>,
    /// Every command, with its time.
    pub log: Vec<(f64, Call)>,
    /// Largest share by which the brake current fell while the armed joint was at rest.
    pub standstill_drop: f64,
}

type Script = Box<dyn FnMut(Call, &mut World) -> Result<(), FaultKind> + Send>;

pub struct Stage {
    pub world: World,
    script: Option<Script>,
}

/// The handle that all fakes share.
#[derive(Clone)]
pub struct Fakes(Arc<Mutex<Stage>>);

pub const RATIO: f64 = 50.0;
pub const FRICTION_A: f64 = 0.6;

impl Fakes {
    /// The script is called before every request; the caller receives its fault.
    pub fn new(script: impl FnMut(Call, &mut World) -> Result<(), FaultKind> + Send + 'static) -> (Fakes, Bench) {
        let world = World {
            now_s: 100.0,
            armed: false,
            setpoint_rad_s: 0.0,
            velocity_rad_s: 0.0,
            position_rad: 0.0,
            current_a: 0.0,
            torque_nm: 0.0,
            temperature_c: Some(25.0),
            warmth_c: [30.0, 20.0],
            brake_a: 0.0,
            brake_on: false,
            regulation: Regulation::ConstantCurrent,
            errors: Vec::new(),
            stuck_at_s: None,
            log: Vec::new(),
            standstill_drop: 0.0,
        };
        let fakes = Fakes(Arc::new(Mutex::new(Stage { world, script: Some(Box::new(script)) })));
        let bench = Bench {
            name: "fake".into(),
            simulated: true,
            clock: Arc::new(FakeClock(fakes.clone())),
            limits: Limits {
                motor_velocity_rad_s: 200.0,
                motor_current_a: 8.0,
                link_torque_nm: 18.0,
                temperature_c: 80.0,
                brake_current_a: 0.6,
                brake_power_w: 350.0,
            },
            torsion: None,
            constants: JointConstants {
                torque_constant_nm_per_a: 0.08,
                gear_ratio: RATIO,
                rotor_inertia_kg_m2: 4e-5,
                brake_compliance_v: 45.0,
                brake_rated_current_a: 0.6,
                brake_rated_torque_nm: 13.0,
                link_range_rad: Some(30.0),
                load_gear_ratio: None,
            },
            joint: Box::new(FakeJoint(fakes.clone())),
            torque_sensor: Some(Box::new(FakeTorqueSensor(fakes.clone()))),
            brake: Some(Box::new(FakeBrake(fakes.clone()))),
            reference_encoder: None,
            test_encoder: None,
            stage: None,
            thermometer: None,
            power: None,
        };
        (fakes, bench)
    }

    /// Adds a thermometer to the bench.
    pub fn connect_thermometer(&self, bench: &mut Bench) {
        bench.thermometer = Some(Box::new(FakeThermometer(self.clone())));
    }

    pub fn quiet() -> (Fakes, Bench) {
        Self::new(|_, _| Ok(()))
    }

    /// A panic of the script poisons the lock; the state behind it is still valid.
    fn stage(&self) -> MutexGuard<'_, Stage> {
        self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    pub fn world(&self) -> World {
        self.stage().world.clone()
    }

    pub fn change(&self, change: impl FnOnce(&mut World)) {
        change(&mut self.stage().world);
    }

    /// The script first, then the world.
    fn call<T>(&self, call: Call, act: impl FnOnce(&mut World) -> T) -> Result<T, Fault> {
        let stage = &mut *self.stage();
        if let Some(script) = &mut stage.script {
            let (name, port) = NAMES[call.role() as usize];
            script(call, &mut stage.world).map_err(|kind| kind.at(name, port))?;
        }
        if !matches!(call, Call::ReadJoint | Call::ReadTorque | Call::ReadBrake | Call::Health | Call::ReadWarmth) {
            stage.world.log.push((stage.world.now_s, call));
        }
        Ok(act(&mut stage.world))
    }
}

const NAMES: [(&str, &str); 4] =
    [("joint", "pty0"), ("torque_sensor", "pty1"), ("brake_a", "pty2"), ("thermometer", "pty3")];

impl World {
    /// Velocity follows at once; friction is constant, the brake proportional, both with the sign of the motion.
    fn advance(&mut self, to_s: f64) {
        let passed_s = to_s - self.now_s;
        if passed_s <= 0.0 {
            return;
        }
        self.now_s = to_s;
        self.velocity_rad_s = if self.armed { self.setpoint_rad_s } else { 0.0 };
        self.position_rad += passed_s * self.velocity_rad_s;
        let direction = if self.velocity_rad_s == 0.0 { 0.0 } else { self.velocity_rad_s.signum() };
        self.torque_nm = direction * 20.0 * self.brake_a;
        self.current_a = direction * 0.5 + 0.001 * self.velocity_rad_s + self.torque_nm / RATIO / 0.08;
    }

    fn take_brake(&mut self, current_a: f64) {
        let standing = self.velocity_rad_s.abs() / RATIO < std::f64::consts::TAU / 60.0;
        if self.armed && standing && self.brake_a > 0.0 {
            self.standstill_drop = self.standstill_drop.max(1.0 - current_a / self.brake_a);
        }
        self.brake_a = current_a;
    }

    /// Commands of one kind, in order.
    pub fn commands(&self, pick: impl Fn(&Call) -> bool) -> Vec<(f64, Call)> {
        self.log.iter().copied().filter(|(_, call)| pick(call)).collect()
    }

    pub fn is_safe(&self) -> bool {
        !self.armed && self.velocity_rad_s.abs() <= 1.0 && (!self.brake_on || self.brake_a == 0.0)
    }
}

struct FakeClock(Fakes);

impl Clock for FakeClock {
    fn now_s(&self) -> f64 {
        self.0.stage().world.now_s
    }

    fn sleep_until_s(&self, t_s: f64) {
        self.0.stage().world.advance(t_s);
    }
}

fn identity(model: &str) -> Identity {
    Identity { maker: "fake".into(), model: model.into(), serial: "1".into(), firmware: "0".into() }
}

macro_rules! instrument {
    ($fake:ident, $role:expr) => {
        struct $fake(Fakes);

        impl Instrument for $fake {
            fn name(&self) -> &str {
                NAMES[$role as usize].0
            }

            fn port(&self) -> &str {
                NAMES[$role as usize].1
            }

            fn identify(&mut self) -> Result<Identity, Fault> {
                self.0.call(Call::Identify($role), |_| identity(stringify!($fake)))
            }

            fn recover(&mut self) -> Result<Identity, Fault> {
                self.0.call(Call::Recover($role), |_| identity(stringify!($fake)))
            }
        }
    };
}

instrument!(FakeJoint, Role::Joint);
instrument!(FakeTorqueSensor, Role::Torque);
instrument!(FakeBrake, Role::Brake);
instrument!(FakeThermometer, Role::Thermometer);

impl JointController for FakeJoint {
    fn arm(&mut self, _: RadPerSec, _: Amperes) -> Result<(), Fault> {
        self.0.call(Call::Arm, |world| (world.armed, world.setpoint_rad_s) = (true, 0.0))
    }

    fn set_velocity_fed(&mut self, velocity: RadPerSec, _: Amperes) -> Result<(), Fault> {
        self.0.call(Call::SetVelocity(velocity.0), |world| world.setpoint_rad_s = velocity.0)
    }

    /// This joint turns in proportion to the torque in excess of its friction.
    fn set_motor_current(&mut self, current: Amperes) -> Result<(), Fault> {
        self.0.call(Call::SetMotorCurrent(current.0), |world| {
            let beyond_a = (current.0.abs() - FRICTION_A).max(0.0);
            world.setpoint_rad_s = (50.0 * beyond_a).copysign(current.0);
        })
    }

    fn read(&mut self) -> Result<JointReading, Fault> {
        self.0.call(Call::ReadJoint, |world| JointReading {
            at_s: world.stuck_at_s.unwrap_or(world.now_s),
            uncertainty_s: 0.0,
            motor_position: Radians(world.position_rad),
            motor_velocity: RadPerSec(world.velocity_rad_s),
            motor_current: Amperes(world.current_a),
            link_position: Some(Radians(world.position_rad / RATIO)),
        })
    }

    fn health(&mut self) -> Result<DriveHealth, Fault> {
        self.0.call(Call::Health, |world| DriveHealth {
            armed: world.armed,
            errors: world.errors.clone(),
            bus_voltage: Some(Volts(48.0)),
            temperature: world.temperature_c.map(Celsius),
        })
    }

    fn disarm(&mut self) -> Result<(), Fault> {
        self.0.call(Call::Disarm, |world| world.armed = false)
    }

    fn resolution(&self) -> JointResolution {
        JointResolution {
            motor_position: None,
            motor_velocity: None,
            motor_current: None,
            link_position: None,
            temperature: Some(Celsius(0.1)),
        }
    }
}

impl TorqueSensor for FakeTorqueSensor {
    fn read(&mut self) -> Result<NewtonMetres, Fault> {
        self.0.call(Call::ReadTorque, |world| NewtonMetres(world.torque_nm))
    }

    fn range(&self) -> NewtonMetres {
        NewtonMetres(20.0)
    }

    fn resolution(&self) -> Option<NewtonMetres> {
        Some(NewtonMetres(1e-3))
    }
}

impl CurrentSource for FakeBrake {
    fn prepare(&mut self, _: Volts) -> Result<(), Fault> {
        self.0.call(Call::Prepare, |world| (world.brake_a, world.brake_on) = (0.0, true))
    }

    fn set_current(&mut self, current: Amperes) -> Result<(), Fault> {
        self.0.call(Call::SetCurrent(current.0), |world| world.take_brake(current.0))
    }

    fn read(&mut self) -> Result<SupplyReading, Fault> {
        self.0.call(Call::ReadBrake, |world| SupplyReading {
            current: Amperes(if world.brake_on { world.brake_a } else { 0.0 }),
            voltage: Volts(20.0),
            regulation: world.regulation,
        })
    }

    fn output_off(&mut self) -> Result<(), Fault> {
        self.0.call(Call::OutputOff, |world| world.brake_on = false)
    }

    fn command_off(&mut self) -> Result<(), Fault> {
        self.output_off()
    }

    fn resolution(&self) -> Option<Amperes> {
        Some(Amperes(1e-4))
    }
}

impl Thermometer for FakeThermometer {
    fn read(&mut self) -> Result<Vec<Celsius>, Fault> {
        self.0.call(Call::ReadWarmth, |world| world.warmth_c.map(Celsius).to_vec())
    }

    fn resolution(&self) -> Celsius {
        Celsius(0.01)
    }
}
