//! Addresses of table 2.7: the variables of the axis processor's program.

/// `propgan`: gain of the position error.
pub const PROPORTIONAL_GAIN: u8 = 0x03;
/// `velgan`: gain of the velocity.
pub const VELOCITY_GAIN: u8 = 0x04;
/// `outscl`: scale factor of the control output.
pub(crate) const OUTPUT_SCALE: u8 = 0x05;
/// Clock ticks between set-points.
pub(crate) const INTERVAL: u8 = 0x06;
/// `postol`: tolerance band of the position, two bytes.
pub(crate) const POSITION_TOLERANCE: u8 = 0x52;
/// `inttol`: tolerance band of the integral action, two bytes.
pub(crate) const INTEGRAL_TOLERANCE: u8 = 0x54;
/// Address of the velocity gain in the manual of the Puma 500 and 600 series; unused in the disassembled program.
pub const VELOCITY_GAIN_OF_MANUAL: u8 = 0x5C;
/// The last address of the memory.
pub const LAST: u8 = 0x7F;

/// The format of a variable. The document gives no formats. Assumed: the lowest byte comes first, and numbers of three
/// bytes have 8 fractional bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Unsigned whole number.
    Whole,
    /// Hexadecimal: bits, an address, or a code.
    Bits,
    /// Signed, with 8 bits of fraction.
    Fixed,
    /// Several values, without a common value.
    Buffer,
}

/// A variable of the memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Variable {
    /// Address of its lowest byte.
    pub address: u8,
    /// Number of bytes.
    pub bytes: u8,
    /// Name in the document.
    pub name: &'static str,
    /// Format of the bytes.
    pub form: Form,
    /// Unit of the value.
    pub unit: &'static str,
    /// Meaning in the program of the axis processor.
    pub meaning: &'static str,
}

impl Variable {
    /// Address of its highest byte.
    pub fn last(&self) -> u8 {
        self.address + self.bytes - 1
    }

    /// `bytes` from the lowest address on. `None` for a buffer.
    pub fn value(&self, bytes: &[u8]) -> Option<f64> {
        if self.form == Form::Buffer {
            return None;
        }
        let whole = bytes.iter().rev().fold(0_i64, |whole, byte| whole << 8 | i64::from(*byte));
        let bits = 8 * u32::from(self.bytes);
        let signed = if whole >> (bits - 1) & 1 == 1 { whole - (1 << bits) } else { whole };
        Some(if self.form == Form::Fixed { signed as f64 / 256.0 } else { whole as f64 })
    }
}

/// The variables of table 2.7, followed by the velocity gain's address in the manual.
pub fn variables() -> impl Iterator<Item = &'static Variable> {
    TABLE.iter()
}

/// The variable that contains an address.
pub fn at(address: u8) -> Option<&'static Variable> {
    TABLE.iter().find(|variable| (variable.address..=variable.last()).contains(&address))
}

const fn of(
    address: u8,
    bytes: u8,
    name: &'static str,
    form: Form,
    unit: &'static str,
    meaning: &'static str,
) -> Variable {
    Variable { address, bytes, name, form, unit, meaning }
}

const TABLE: &[Variable] = &[
    of(0x00, 2, "jstatus", Form::Bits, "", "Joint status word"),
    of(0x02, 1, "rmemp", Form::Bits, "", "Memory pointer of DIAGREAD"),
    of(0x03, 1, "propgan", Form::Whole, "", "Proportional gain"),
    of(
        VELOCITY_GAIN,
        1,
        "velgan",
        Form::Whole,
        "",
        "Velocity (derivative) gain. The manual of the Puma 500 and 600 series gives address 0x5C; the disassembled code uses 0x04",
    ),
    of(0x05, 1, "outscl", Form::Whole, "", "Scale factor of the control force"),
    of(
        0x06,
        1,
        "ninter",
        Form::Whole,
        "ticks",
        "Clock ticks between set-points; one tick is 0.875 ms, so that 32 ticks are the 28 ms of VAL-I",
    ),
    of(0x07, 1, "eintscl", Form::Whole, "", "Scale factor of the increment: ninter is 2 to the power of 8 − eintscl"),
    of(0x08, 1, "divisor", Form::Whole, "", "Divisor of the clock (6532)"),
    of(0x09, 1, "encmax", Form::Whole, "counts", "Encoder counts per revolution, low byte"),
    of(0x0A, 3, "deltae", Form::Fixed, "counts", "Encoder increment of each tick"),
    of(0x0D, 3, "etarget", Form::Fixed, "counts", "Encoder target of this tick"),
    of(0x10, 2, "dcoffset", Form::Fixed, "counts", "DC offset of the control force"),
    of(0x12, 3, "eerr", Form::Fixed, "counts", "Encoder error of this tick"),
    of(0x15, 3, "deriv", Form::Fixed, "counts", "Derivative of this tick"),
    of(0x18, 3, "u", Form::Fixed, "counts", "Computed control force"),
    of(0x1B, 2, "jvec1", Form::Bits, "", "Vector of jump table 1"),
    of(0x1D, 2, "jvec2", Form::Bits, "", "Vector of jump table 2"),
    of(0x1F, 1, "ipos", Form::Bits, "", "Pointer to the position buffer"),
    of(0x20, 32, "pos", Form::Buffer, "", "Position buffer"),
    of(0x41, 1, "pending", Form::Whole, "", "Number of pending commands"),
    of(0x43, 1, "cpc", Form::Bits, "", "Pointer to the command buffer"),
    of(0x44, 12, "cbuf", Form::Buffer, "", "Command buffer"),
    of(0x50, 1, "count", Form::Whole, "ticks", "Ticks that are left until the set-point is reached"),
    of(0x52, 2, "postol", Form::Whole, "counts", "Tolerance band of the position"),
    of(0x54, 2, "inttol", Form::Whole, "counts", "Tolerance band of the integral action"),
    of(0x56, 3, "enc", Form::Fixed, "counts", "Encoder position"),
    of(0x7E, 1, "stacktop", Form::Bits, "", "Top of the system stack"),
    of(
        VELOCITY_GAIN_OF_MANUAL,
        1,
        "(unused)",
        Form::Whole,
        "",
        "Address of velgan in the manual of the Puma 500 and 600 series; unused in the disassembled code, see 0x04",
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_27_variables_of_the_table_overlap_nowhere() {
        assert_eq!(variables().count(), 27 + 1);
        let mut taken = [false; 1 + LAST as usize];
        for variable in variables() {
            for address in variable.address..=variable.last() {
                assert!(!std::mem::replace(&mut taken[usize::from(address)], true), "{address:#04X} is taken twice");
                assert_eq!(at(address), Some(variable));
            }
        }
        assert_eq!(at(0x40), None);
        assert_eq!(
            (at(VELOCITY_GAIN).unwrap().name, at(VELOCITY_GAIN_OF_MANUAL).unwrap().name),
            ("velgan", "(unused)")
        );
    }

    #[test]
    fn bytes_become_values_by_their_form() {
        let value = |address, bytes: &[u8]| at(address).unwrap().value(bytes);
        assert_eq!(value(0x06, &[0x20]), Some(32.0));
        assert_eq!(value(0x52, &[0x34, 0x12]), Some(4660.0));
        assert_eq!(value(0x12, &[0x80, 0x01, 0x00]), Some(1.5));
        assert_eq!(value(0x12, &[0x80, 0xFE, 0xFF]), Some(-1.5));
        assert_eq!(value(0x10, &[0x00, 0xFF]), Some(-1.0));
        assert_eq!(value(0x20, &[0; 32]), None);
    }
}
