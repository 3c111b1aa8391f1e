//! The commands of three makers. A line that selects the channel precedes every command of an HMP, because the
//! instrument has only one selection and another client may have changed it.

use jointbench_instrument::roles::Identity;

/// The three families of supplies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialect {
    /// Rigol DP800 (programming guide PGH03109-1110).
    Dp800,
    /// Rohde & Schwarz HMP. Condition bits that the public client does not use are assumed.
    Hmp,
    /// Kepco BOP, bipolar, one channel (operator manual of the card BIT 4886, of the series BOP 1KW-MG). It loses what
    /// follows a line end too early, so that a message is one line. It has no relay at its output: off programs 0 A
    /// and 0 V. That bit CV shows an output at its voltage limit in current mode is assumed.
    Kepco,
}

impl Dialect {
    /// `None`: a supply that this driver does not support.
    pub fn of(identity: &Identity) -> Option<Self> {
        let maker = identity.maker.to_ascii_uppercase();
        match &identity.model {
            model if maker.contains("RIGOL") && model.starts_with("DP8") => Some(Dialect::Dp800),
            model if (maker.contains("ROHDE") || maker == "HAMEG") && model.starts_with("HMP") => Some(Dialect::Hmp),
            model if maker == "KEPCO" && (model.starts_with("BOP") || model.starts_with("BIT 4886")) => {
                Some(Dialect::Kepco)
            }
            _ => None,
        }
    }

    /// What separates two commands that are sent together.
    pub fn separator(self) -> &'static str {
        match self {
            Dialect::Dp800 | Dialect::Hmp => "\n",
            Dialect::Kepco => ";",
        }
    }

    /// A Kepco at RS-232 takes no other command before this one.
    pub(crate) fn remote(self) -> &'static str {
        match self {
            Dialect::Dp800 | Dialect::Hmp => ":SYST:REM",
            Dialect::Kepco => "SYST:REM 1",
        }
    }

    /// Regulation of the current, for supplies that have a mode for it. In this mode the voltage is the limit.
    pub(crate) fn current_mode(self) -> Option<&'static str> {
        match self {
            Dialect::Dp800 | Dialect::Hmp => None,
            Dialect::Kepco => Some("FUNC:MODE CURR"),
        }
    }

    /// Command and query of the current.
    pub fn current(self) -> [&'static str; 2] {
        match self {
            Dialect::Dp800 => [":SOUR1:CURR", ":SOUR1:CURR?"],
            Dialect::Hmp => ["INST:NSEL 1\nCURR", "INST:NSEL 1\nCURR?"],
            Dialect::Kepco => ["CURR", "CURR?"],
        }
    }

    /// Command and query of the voltage limit.
    pub fn voltage(self) -> [&'static str; 2] {
        match self {
            Dialect::Dp800 => [":SOUR1:VOLT", ":SOUR1:VOLT?"],
            Dialect::Hmp => ["INST:NSEL 1\nVOLT", "INST:NSEL 1\nVOLT?"],
            Dialect::Kepco => ["VOLT", "VOLT?"],
        }
    }

    /// Programming resolution of the current. Kepco: 14 bits of at most 16 A.
    pub(crate) fn current_step_a(self) -> f64 {
        match self {
            Dialect::Dp800 => 1e-4,
            Dialect::Hmp => 2e-4,
            Dialect::Kepco => 1e-3,
        }
    }

    /// Programming resolution of the voltage limit. Kepco: 12 bits of at most 100 V.
    pub(crate) fn voltage_step_v(self) -> f64 {
        match self {
            Dialect::Dp800 | Dialect::Hmp => 1e-3,
            Dialect::Kepco => 0.025,
        }
    }

    /// An HMP has one switch per channel and a relay for all channels. On uses both, off only the switch of the
    /// channel. For an inductive load at a Kepco, its manual recommends a current of 0 before off.
    pub fn output(self, on: bool) -> &'static str {
        match (self, on) {
            (Dialect::Dp800, true) => ":OUTP CH1,ON",
            (Dialect::Dp800, false) => ":OUTP CH1,OFF",
            (Dialect::Hmp, true) => "INST:NSEL 1\nOUTP:SEL 1\nOUTP:GEN 1",
            (Dialect::Hmp, false) => "INST:NSEL 1\nOUTP:SEL 0",
            (Dialect::Kepco, true) => "OUTP 1",
            (Dialect::Kepco, false) => "SYST:REM 1;:CURR 0;:OUTP 0",
        }
    }

    /// The output is on if all of them report on.
    pub(crate) fn output_queries(self) -> &'static [&'static str] {
        match self {
            Dialect::Dp800 => &[":OUTP? CH1"],
            Dialect::Hmp => &["INST:NSEL 1\nOUTP:SEL?", "OUTP:GEN?"],
            Dialect::Kepco => &["OUTP?"],
        }
    }

    /// Voltage, then current, in one reply.
    pub fn measured(self) -> &'static str {
        match self {
            Dialect::Dp800 => ":MEAS:ALL? CH1",
            Dialect::Hmp => "INST:NSEL 1\nMEAS:VOLT?;:MEAS:CURR?",
            Dialect::Kepco => "MEAS:VOLT?;:MEAS:CURR?",
        }
    }

    /// The register of the regulation. A Kepco reports a regulation while it is off as well, so that its switch
    /// precedes the register.
    pub(crate) fn condition(self) -> &'static str {
        match self {
            Dialect::Dp800 | Dialect::Hmp => ":STAT:QUES:INST:ISUM1:COND?",
            Dialect::Kepco => "OUTP?;:STAT:OPER:COND?",
        }
    }

    /// Bits of constant current, constant voltage, and tripped over-voltage and over-current protection (fuse).
    pub(crate) fn condition_bits(self) -> [u32; 4] {
        match self {
            Dialect::Dp800 => [1 << 0, 1 << 1, 1 << 2, 1 << 3],
            Dialect::Hmp => [1 << 0, 1 << 1, 1 << 9, 1 << 10],
            Dialect::Kepco => [1 << 10, 1 << 8, 0, 0],
        }
    }
}
