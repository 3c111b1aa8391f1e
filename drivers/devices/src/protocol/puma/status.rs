//! The joint status word.

use std::fmt;

const POSITION: u16 = 1 << 0;
const CURRENT: u16 = 1 << 1;
const ARM_POWER: u16 = 1 << 2;
const IN_POSITION: u16 = 1 << 3;
/// The document describes the first three as not implemented; another revision of the program may set them.
const ERRORS: [(u16, &str); 5] = [
    (1 << 8, "RAM error"),
    (1 << 9, "out of the position envelope"),
    (1 << 10, "lost synchronization with the encoder"),
    (1 << 11, "no request for 0.25 s: arm power was switched off"),
    (1 << 12, "motor current at its limit for 0.5 s: arm power was switched off"),
];

/// Low byte: state of the servo, with bits 6 and 7 for its own use. High byte: errors.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Status(pub u16);

impl Status {
    /// The motor may produce torque.
    pub fn is_armed(self) -> bool {
        self.0 & ARM_POWER != 0 && self.0 & (POSITION | CURRENT) != 0
    }

    /// State of the servo. In position: the set-point is reached within the tolerance `postol`.
    pub fn states(self) -> Vec<&'static str> {
        let states = [
            (POSITION, "position mode"),
            (CURRENT, "current mode"),
            (ARM_POWER, "arm power"),
            (IN_POSITION, "in position"),
        ];
        states.into_iter().filter(|(bit, _)| self.0 & bit != 0).map(|(_, state)| state).collect()
    }

    /// Set error bits in words; unknown bits in hexadecimal.
    pub fn errors(self) -> Vec<String> {
        let known = ERRORS.iter().filter(|(bit, _)| self.0 & bit != 0).map(|(_, name)| (*name).to_owned());
        let other = self.0 & 0xFF00 & !ERRORS.iter().fold(0, |bits, (bit, _)| bits | bit);
        known.chain((other != 0).then(|| format!("error bits {other:#06X}"))).collect()
    }
}

impl fmt::Debug for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:#06X}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_have_names_and_the_processors_own_mean_nothing() {
        assert!(Status(0x00C5).is_armed() && Status(0x00C5).errors().is_empty());
        assert!(!Status(0x00C1).is_armed(), "no arm power");
        assert!(!Status(0x0004).is_armed(), "no servo");
        assert_eq!(Status(0x000D).states(), ["position mode", "arm power", "in position"]);
        assert_eq!(Status(0x0500).errors(), ["RAM error", "lost synchronization with the encoder"]);
        assert_eq!(Status(0x8000).errors(), ["error bits 0x8000"]);
    }
}
