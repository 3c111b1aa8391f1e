//! Conversion of bytes to UTF-8: byte order marks, UTF-16, and the 8-bit text of older programs.

use crate::error::FileFault;
use encoding_rs::{Decoder, Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};

/// The encoding of a file. Windows-1252 includes Latin-1, as browsers read it (encoding.spec.whatwg.org).
#[derive(Debug, Clone, Copy)]
pub struct Coding {
    pub encoding: &'static Encoding,
    /// Bytes of the byte order mark.
    pub mark: usize,
}

/// A larger fraction of zeros, only at odd or only at even positions, means UTF-16 without a mark.
const MOSTLY: f64 = 0.3;
/// A larger fraction of control characters means that the file is not text.
const CONTROL: f64 = 0.02;

impl Coding {
    /// Determines the encoding from the first bytes of the file.
    pub fn of(head: &[u8]) -> Result<Coding, FileFault> {
        if let Some((encoding, mark)) = Encoding::for_bom(head) {
            return Ok(Coding { encoding, mark });
        }
        let zeros = |odd: usize| head.iter().skip(odd).step_by(2).filter(|byte| **byte == 0).count() as f64;
        let half = (head.len() / 2).max(1) as f64;
        let plain = |encoding| Ok(Coding { encoding, mark: 0 });
        match (zeros(0) / half, zeros(1) / half) {
            (even, odd) if odd > MOSTLY && even == 0.0 => return plain(UTF_16LE),
            (even, odd) if even > MOSTLY && odd == 0.0 => return plain(UTF_16BE),
            _ => {}
        }
        let control = |byte: &&u8| **byte < b' ' && !matches!(**byte, b'\t' | b'\n' | b'\r' | 0x0c | 0x1a);
        if let Some(byte) = head.iter().find(control)
            && (*byte == 0 || head.iter().filter(control).count() as f64 > CONTROL * head.len() as f64)
        {
            return Err(FileFault::NotText(*byte));
        }
        match std::str::from_utf8(head) {
            Ok(_) => plain(UTF_8),
            // The first bytes may end inside a character.
            Err(fault) if fault.error_len().is_none() => plain(UTF_8),
            Err(_) => plain(WINDOWS_1252),
        }
    }

    /// The decoder of the lines. `None` for UTF-8, which needs no conversion.
    pub fn decoder(self) -> Option<Decoder> {
        (self.encoding != UTF_8).then(|| self.encoding.new_decoder_without_bom_handling())
    }
}

/// Appends a decoded piece to `text`.
pub fn decode(decoder: &mut Decoder, mut piece: &[u8], is_last: bool, text: &mut Vec<u8>) {
    loop {
        let room = decoder.max_utf8_buffer_length(piece.len()).unwrap_or(piece.len());
        let start = text.len();
        text.resize(start + room.max(16), 0);
        let (result, read, written, _) = decoder.decode_to_utf8(piece, &mut text[start..], is_last);
        text.truncate(start + written);
        piece = &piece[read..];
        if result == encoding_rs::CoderResult::InputEmpty {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> String {
        let coding = Coding::of(bytes).unwrap();
        let bytes = &bytes[coding.mark..];
        let mut text = Vec::new();
        match coding.decoder() {
            // Byte by byte, so that characters are split at every position.
            Some(mut decoder) => {
                bytes.iter().for_each(|byte| decode(&mut decoder, &[*byte], false, &mut text));
                decode(&mut decoder, &[], true, &mut text);
            }
            None => text.extend_from_slice(bytes),
        }
        String::from_utf8(text).unwrap()
    }

    #[test]
    fn what_spreadsheets_write_is_decoded() {
        let text = "Zeit [µs];Größe\n1;2\n";
        let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        let latin: Vec<u8> = text.chars().map(|c| c as u8).collect();
        for bytes in [
            text.as_bytes(),
            &[b"\xef\xbb\xbf", text.as_bytes()].concat(),
            &[&b"\xff\xfe"[..], &little].concat(),
            &[&b"\xfe\xff"[..], &big].concat(),
            &little,
            &big,
            &latin,
        ] {
            assert_eq!(read(bytes), text);
        }
        assert!(matches!(Coding::of(b"PK\x03\x04\0\0\x08"), Err(FileFault::NotText(_))));
    }
}
