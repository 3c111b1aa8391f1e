//! The commands of two makers. A line that selects the channel precedes every command, because the instrument has only
//! one selection and another client may have changed it.

use jointbench_instrument::roles::Identity;

/// The two families of supplies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialect {
    /// Rigol DP800 (programming guide PGH03109-1110).
    Dp800,
    /// Rohde & Schwarz HMP. Condition bits that the public client does not use are assumed.
    Hmp,
}

impl Dialect {
    /// `None`: a supply that this driver does not support.
    pub fn of(identity: &Identity) -> Option<Self> {
        let maker = identity.maker.to_ascii_uppercase();
        match &identity.model {
            model if maker.contains("RIGOL") && model.starts_with("DP8") => Some(Dialect::Dp800),
            model if (maker.contains("ROHDE") || maker == "HAMEG") && model.starts_with("HMP") => Some(Dialect::Hmp),
            _ => None,
        }
    }

    /// Command and query of the current, then of the voltage.
    pub fn current(self) -> [&'static str; 2] {
        match self {
            Dialect::Dp800 => [":SOUR1:CURR", ":SOUR1:CURR?"],
            Dialect::Hmp => ["INST:NSEL 1\nCURR", "INST:NSEL 1\nCURR?"],
        }
    }

    /// Command and query of the voltage limit.
    pub fn voltage(self) -> [&'static str; 2] {
        match self {
            Dialect::Dp800 => [":SOUR1:VOLT", ":SOUR1:VOLT?"],
            Dialect::Hmp => ["INST:NSEL 1\nVOLT", "INST:NSEL 1\nVOLT?"],
        }
    }

    /// Programming resolution of the channel.
    pub(crate) fn current_step_a(self) -> f64 {
        match self {
            Dialect::Dp800 => 1e-4,
            Dialect::Hmp => 2e-4,
        }
    }

    /// An HMP has one switch per channel and a relay for all channels. On uses both, off only the switch of the
    /// channel.
    pub fn output(self, on: bool) -> &'static str {
        match (self, on) {
            (Dialect::Dp800, true) => ":OUTP CH1,ON",
            (Dialect::Dp800, false) => ":OUTP CH1,OFF",
            (Dialect::Hmp, true) => "INST:NSEL 1\nOUTP:SEL 1\nOUTP:GEN 1",
            (Dialect::Hmp, false) => "INST:NSEL 1\nOUTP:SEL 0",
        }
    }

    /// The output is on if all of them report on.
    pub(crate) fn output_queries(self) -> &'static [&'static str] {
        match self {
            Dialect::Dp800 => &[":OUTP? CH1"],
            Dialect::Hmp => &["INST:NSEL 1\nOUTP:SEL?", "OUTP:GEN?"],
        }
    }

    /// Voltage, then current, in one reply.
    pub fn measured(self) -> &'static str {
        match self {
            Dialect::Dp800 => ":MEAS:ALL? CH1",
            Dialect::Hmp => "INST:NSEL 1\nMEAS:VOLT?;:MEAS:CURR?",
        }
    }

    /// Bits of a tripped over-voltage and over-current protection (fuse).
    pub(crate) fn trips(self) -> [u32; 2] {
        match self {
            Dialect::Dp800 => [1 << 2, 1 << 3],
            Dialect::Hmp => [1 << 9, 1 << 10],
        }
    }
}
