//! Reasons for which a sensor refuses a request (LorenzTelegram 1.0.0, `Error`).

/// The error of a NACK or of a status byte, in words.
pub(crate) fn nack_text(code: u8) -> String {
    let text = match code {
        1 => "generic error",
        2 => "watchdog",
        3 => "rotor error",
        4 => "rotor: wrong speed",
        5 => "rotor: too slow",
        6 => "rotor: too fast",
        7 => "rotor: not compatible",
        8 => "rotor: was reset",
        9 => "rotor: not found; check the air gap and the rotor's supply",
        10 => "rotor: link unstable; check the air gap",
        11 => "rotor: time-out",
        12 => "rotor: refused",
        13 => "rotor: bad command echo",
        14 => "rotor: EEPROM not written",
        15 => "rotor: bad communication",
        20 => "configuration block",
        21 => "stator configuration",
        26 => "stator hardware configuration",
        27 => "stator operation configuration",
        31 => "rotor configuration",
        32 => "factory calibration",
        33 => "user calibration",
        34 => "contents of the factory calibration",
        35 => "contents of the user calibration",
        40 => "wrong number of parameters",
        41 => "unknown command",
        42 => "wrong checksum",
        43 => "wrong parameter",
        44 => "wrong address",
        45 => "block is write-once",
        60 => "stack overflow",
        61 => "angle overflow",
        _ => "unknown error",
    };
    format!("{text} (NACK {code})")
}
