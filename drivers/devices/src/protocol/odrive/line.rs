//! Lines with checksums.

use crate::transport::shown;
use jointbench_instrument::FaultKind;
use std::fmt::Arguments;
use std::io::Write;

/// The longest reply line: 64 characters of text, a checksum and the line end.
pub const LINE_LIMIT: usize = 80;

fn checksum(text: &[u8]) -> u8 {
    text.iter().fold(0, |sum, byte| sum ^ byte)
}

/// Appends a command line with its checksum.
pub fn push(out: &mut Vec<u8>, text: Arguments<'_>) {
    let start = out.len();
    write!(out, "{text}").expect("a vector takes every byte");
    let sum = checksum(&out[start..]);
    writeln!(out, "*{sum}").expect("a vector takes every byte");
}

/// The text of a reply line, if its checksum is right and it is not an error reply.
pub fn text(line: &[u8]) -> Result<&str, FaultKind> {
    let garbled = |why: &str| FaultKind::Garbled { what: format!("{}: {why}", shown(line)) };
    let body = line.strip_suffix(b"\r\n").ok_or_else(|| garbled("expected the line end \\r\\n"))?;
    let star = body.iter().rposition(|byte| *byte == b'*').ok_or_else(|| garbled("expected a checksum"))?;
    let text = std::str::from_utf8(&body[..star]).map_err(|_| garbled("expected ASCII"))?;
    let sum = std::str::from_utf8(&body[star + 1..]).ok().and_then(|digits| digits.parse::<u8>().ok());
    if sum != Some(checksum(text.as_bytes())) {
        return Err(garbled(&format!("expected the checksum *{}", checksum(text.as_bytes()))));
    }
    match text {
        "invalid command format" | "invalid property" | "not implemented" | "unknown command" => {
            Err(FaultKind::Refused { what: text.to_owned() })
        }
        _ if text.starts_with("invalid motor") => Err(FaultKind::Refused { what: text.to_owned() }),
        _ => Ok(text),
    }
}

/// A number from a reply. `nan` and `inf` come from a controller with an invalid state and are not readings.
pub fn number(text: &str) -> Result<f64, FaultKind> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(FaultKind::Garbled { what: format!("`{text}`: expected a finite number") }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksums_are_the_published_ones() {
        let mut line = Vec::new();
        push(&mut line, format_args!("r vbus_voltage"));
        assert_eq!(line, b"r vbus_voltage*125\n");
        assert_eq!(checksum(b"r vbus_voltage "), 93);
        assert_eq!(text(b"24.087744*32\r\n"), Ok("24.087744"));
    }

    #[test]
    fn the_fault_of_a_line_is_reported() {
        for (line, why) in [
            (&b"24.087744\r\n"[..], "checksum"),
            (b"24.087745*32\r\n", "*33"),
            (b"24.087744*32\n", "line end"),
            (b"24.087744*\r\n", "*32"),
            (b"\xff*255\r\n", "ASCII"),
        ] {
            let fault = text(line).unwrap_err();
            assert!(matches!(&fault, FaultKind::Garbled { what } if what.contains(why)), "{fault}");
        }
        let mut refusal = b"invalid property".to_vec();
        let sum = checksum(&refusal);
        write!(refusal, "*{sum}\r\n").unwrap();
        assert_eq!(text(&refusal), Err(FaultKind::Refused { what: "invalid property".into() }));
    }

    #[test]
    fn only_finite_numbers_are_numbers() {
        assert_eq!(number("-123.4560"), Ok(-123.456));
        for text in ["nan", "inf", "-inf", "", "0x1"] {
            assert!(number(text).is_err(), "{text}");
        }
    }
}
