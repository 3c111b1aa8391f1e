//! The position loop of a Puma's axis processor, once per clock tick, in the variables of Corke 1994, table 2.7.
//!
//! The document names the variables but not the arithmetic: the effect of the gains and their units are assumed.

/// Gain of the position loop at a proportional gain of 1 [1/s].
const POSITION_GAIN_PER_S: f64 = 20.0;
/// Gain of the derivative at a velocity gain of 1.
const VELOCITY_GAIN: f64 = 1.0 / 256.0;
/// Integral gain for a critically damped loop with the gains after power-up [1/s²].
const INTEGRAL_GAIN_PER_S2: f64 = POSITION_GAIN_PER_S * POSITION_GAIN_PER_S / 4.0;
/// Positions in the buffer of 32 bytes.
pub const BUFFERED: usize = 16;

/// Settings of the host. Initial values as in table 2.7.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gains {
    pub propgan: u8,
    pub velgan: u8,
    /// Number of times that the control force is halved.
    pub outscl: u8,
    /// Largest position error [counts].
    pub postol: u16,
    /// Largest error with integral action [counts].
    pub inttol: u16,
}

/// All values in counts and ticks.
pub struct Loop {
    pub gains: Gains,
    pub tick_s: f64,
    /// Interpolation of the set-point: target, present value, increment per tick, and remaining ticks.
    pub target: f64,
    pub interpolated: f64,
    pub increment: f64,
    pub count: u8,
    pub error: f64,
    pub derivative: f64,
    /// Contribution of integral action to the control force.
    pub offset: f64,
    /// Velocity command to the amplifier in counts per tick.
    pub force: f64,
    pub positions: [i16; BUFFERED],
    /// Index of the next position in the buffer.
    pub next: usize,
}

impl Loop {
    pub fn new(tick_s: f64) -> Self {
        Self {
            gains: Gains { propgan: 1, velgan: 0, outscl: 0, postol: 0, inttol: 0 },
            tick_s,
            target: 0.0,
            interpolated: 0.0,
            increment: 0.0,
            count: 0,
            error: 0.0,
            derivative: 0.0,
            offset: 0.0,
            force: 0.0,
            positions: [0; BUFFERED],
            next: 0,
        }
    }

    pub fn hold(&mut self, counts: i64) {
        (self.target, self.interpolated) = (counts as f64, counts as f64);
        (self.increment, self.count) = (0.0, 0);
        (self.error, self.derivative, self.offset, self.force) = (0.0, 0.0, 0.0, 0.0);
    }

    /// Moves to `target` in `ninter` ticks.
    pub fn go(&mut self, target: f64, ninter: u8) {
        self.target = target;
        self.count = ninter;
        self.increment = (target - self.interpolated) / f64::from(ninter);
    }

    /// Sets the command to the amplifier to zero.
    pub fn rest(&mut self) {
        (self.offset, self.force) = (0.0, 0.0);
    }

    /// The set-point is reached, and the error is within the tolerance.
    pub fn is_in_position(&self) -> bool {
        self.count == 0 && self.error.abs() <= f64::from(self.gains.postol)
    }

    pub fn tick(&mut self, counts: i64, closed: bool) {
        // The increment remains in the tick that reaches the target: periodic set-points join without a stop.
        if self.count == 0 {
            self.increment = 0.0;
        } else {
            self.count -= 1;
            self.interpolated = if self.count == 0 { self.target } else { self.interpolated + self.increment };
        }
        let error = self.interpolated - counts as f64;
        (self.derivative, self.error) = (error - self.error, error);
        self.positions[self.next] = counts as i16;
        self.next = (self.next + 1) % BUFFERED;
        if closed {
            self.close();
        }
    }

    fn close(&mut self) {
        let Gains { propgan, velgan, outscl, inttol, .. } = self.gains;
        self.offset = match inttol {
            0 => 0.0,
            band if self.error.abs() <= f64::from(band) => {
                self.offset + INTEGRAL_GAIN_PER_S2 * self.tick_s * self.tick_s * self.error
            }
            _ => 0.0,
        };
        let proportional = f64::from(propgan) * POSITION_GAIN_PER_S * self.tick_s * self.error;
        let derivative = f64::from(velgan) * VELOCITY_GAIN * self.derivative;
        let scaled = (proportional + derivative) * (-f64::from(outscl)).exp2();
        self.force = self.increment + scaled + self.offset;
    }
}
