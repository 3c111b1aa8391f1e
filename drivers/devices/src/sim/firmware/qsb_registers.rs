//! The registers of a QSB: their factory values, and which of them are non-volatile.

pub const MODE: u8 = 0x00;
pub const DIO: u8 = 0x01;
pub const DIO_CONFIGURATION: u8 = 0x02;
pub const MDR0: u8 = 0x03;
pub const MDR1: u8 = 0x04;
pub const STATUS: u8 = 0x06;
pub const OTR: u8 = 0x07;
pub const DTR: u8 = 0x08;
pub const CLEAR: u8 = 0x09;
pub const LOAD: u8 = 0x0A;
pub const THRESHOLD: u8 = 0x0B;
pub const INTERVAL: u8 = 0x0C;
pub const STAMP: u8 = 0x0D;
pub const ENCODER: u8 = 0x0E;
pub const VERSION: u8 = 0x14;
pub const EOR: u8 = 0x15;
pub const COMMAND: u8 = 0x16;

/// Register, factory value, whether it can be saved. MDR0 = 4F counts modulo DTR + 1: 0 to 499.
const FACTORY: [(u8, u32, bool); 9] = [
    (MODE, 0, true),
    (DIO_CONFIGURATION, 0, true),
    (MDR0, 0x4F, true),
    (MDR1, 0, true),
    (OTR, 0, false),
    (DTR, 0x1F3, true),
    (THRESHOLD, 0, true),
    (INTERVAL, 0xFFFF, true),
    (EOR, 0xB, true),
];

#[derive(Debug, Clone)]
pub struct Registers {
    held: [u32; FACTORY.len()],
    saved: [u32; FACTORY.len()],
}

impl Registers {
    pub fn factory() -> Self {
        let values = FACTORY.map(|(_, value, _)| value);
        Self { held: values, saved: values }
    }

    fn index(register: u8) -> Option<usize> {
        FACTORY.iter().position(|(known, ..)| *known == register)
    }

    pub fn find(&self, register: u8) -> Option<u32> {
        Some(self.held[Self::index(register)?])
    }

    pub fn get(&self, register: u8) -> u32 {
        self.find(register).unwrap_or(0)
    }

    pub fn is_writable(&self, register: u8) -> bool {
        Self::index(register).is_some() && register != OTR
    }

    pub fn set(&mut self, register: u8, value: u32) {
        if let Some(index) = Self::index(register) {
            self.held[index] = value;
        }
    }

    pub fn save(&mut self) {
        for (index, (.., kept)) in FACTORY.iter().enumerate() {
            if *kept {
                self.saved[index] = self.held[index];
            }
        }
    }

    pub fn restore(&mut self) {
        self.held = self.saved;
    }
}
