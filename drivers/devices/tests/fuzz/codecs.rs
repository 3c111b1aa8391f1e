//! Invariants of every codec for any input: no panic, every step consumes input, memory is limited to one packet, and
//! the codec resynchronizes after a few good replies.
//!
//! Two sources feed it: the property tests next to it, and the fuzzer (`fuzz/`), which finds less obvious inputs.

use jointbench_devices::protocol::gcs::{self, QueryAxes, QueryReachable};
use jointbench_devices::protocol::lorenz::{
    Frames, Hello, Item, ReadConfig, ReadRaw, ReadStatusShort, StartStream, Telegram,
};
use jointbench_devices::protocol::modbus::ReadRegisters;
use jointbench_devices::protocol::odrive::{Part, ReadErrors, ReadFeedback, ReadInfo, ReadNumber, SetVelocity};
use jointbench_devices::protocol::puma::{DiagRead, Numbered, PositionMode, ReadPosition};
use jointbench_devices::protocol::qsb::{ReadRegister, Register, WriteRegister};
use jointbench_devices::protocol::scpi::{
    Dialect, Identify, QueryError, QueryFlag, QueryNumber, ReadCondition, ReadMeasured, ReadVoltage, Set, Terminator,
};
use jointbench_devices::transport::{Request, Scan, Traffic};
use std::fmt::Debug;

/// Bytes without an end that a codec may still accept as the beginning of a packet. A link gives up at twice as many.
const KEPT: usize = 2048;
/// Good replies until a codec is resynchronized: noise may have begun a packet that includes the first ones.
const REPLIES: usize = 3;

/// Consumes input as the link does and returns the replies. Every step consumes at least one byte of the input.
fn walk<R: Request>(request: &R, mut rest: &[u8]) -> Vec<R::Reply> {
    let mut replies = Vec::new();
    while !rest.is_empty() {
        let taken = match request.scan(rest) {
            Scan::Short => {
                assert!(rest.len() <= KEPT, "{}: {} bytes are kept", request.name(), rest.len());
                break;
            }
            Scan::Packet { length } => {
                assert!((1..=rest.len()).contains(&length), "{}: packet of {length}", request.name());
                replies.extend(request.decode(&rest[..length]));
                length
            }
            Scan::Noise { skip } => {
                assert!((1..=rest.len()).contains(&skip), "{}: noise of {skip}", request.name());
                skip
            }
        };
        rest = &rest[taken..];
    }
    replies
}

/// Noise alone; a good reply damaged by noise; and good replies after noise, of which the last one is found.
fn withstands<R: Request>(request: &R, noise: &[u8], reply: &[u8])
where
    R::Reply: PartialEq + Debug,
{
    walk(request, noise);
    let damaged: Vec<u8> = reply.iter().zip(noise.iter().chain(std::iter::repeat(&0))).map(|(a, b)| a ^ b).collect();
    walk(request, &damaged);
    let expected = walk(request, reply).pop();
    assert!(expected.is_some(), "{}: {} is a reply", request.name(), reply.escape_ascii());
    let found = walk(request, &[noise, &reply.repeat(REPLIES)].concat()).pop();
    assert_eq!(found, expected, "{} after {noise:02X?}", request.name());
}

pub fn odrive(noise: &[u8]) {
    let line = |text: &str| format!("{text}*{}\r\n", text.bytes().fold(0, |sum, byte| sum ^ byte)).into_bytes();
    withstands(&ReadFeedback { axis: 0 }, noise, &line("1.077135 1.482737"));
    withstands(&ReadNumber { path: "vbus_voltage" }, noise, b"24.087744*32\r\n");
    withstands(&SetVelocity { turns_s: 1.5, torque_nm: 0.0 }, noise, &line("1.500000"));
    for part in Part::ALL {
        withstands(&ReadErrors(part), noise, &line("2048"));
    }
    // Three lines: the first of them is known only on a drained line.
    walk(&ReadInfo, noise);
}

pub fn scpi(noise: &[u8]) {
    let lf = Terminator::Lf;
    withstands(&Identify(lf), noise, b"RIGOL TECHNOLOGIES,DP821A,DP8E204500123,00.01.16\n");
    withstands(&QueryError(lf), noise, b"-222,\"Data out of range\"\n");
    withstands(&QueryNumber(lf, ":SOUR1:CURR?"), noise, b"0.250\n");
    withstands(&QueryFlag(lf, ":OUTP? CH1"), noise, b"ON\n");
    withstands(&ReadMeasured(lf, Dialect::Dp800), noise, b"12.9870,0.2498,3.2441\n");
    withstands(&ReadMeasured(lf, Dialect::Hmp), noise, b"12.987;0.2498\n");
    withstands(&ReadCondition(lf, Dialect::Hmp), noise, b"513\n");
    withstands(&ReadCondition(lf, Dialect::Kepco), noise, b"1;1024\n");
    withstands(&Set(lf, ":OUTP CH1,ON".into(), "\n"), noise, b"0,\"No error\"\n");
    withstands(&ReadVoltage(lf), noise, b"+4.50012345E+00\n");
}

pub fn qsb(noise: &[u8]) {
    withstands(&ReadRegister(Register::Encoder), noise, b"r 0E 000012F3 0000ABD0 !\r\n");
    withstands(&WriteRegister(Register::Mode, 0), noise, b"w 00 00000000 0000ABCD !\r\n");
}

/// An encoder's own status is read from a digital input of its counter.
pub fn encoder_status(noise: &[u8]) {
    withstands(&ReadRegister(Register::DigitalInputs), noise, b"r 01 00000003 0000ABD1 !\r\n");
}

pub fn gcs(noise: &[u8]) {
    let idn = b"(c)2015 Physik Instrumente (PI) GmbH & Co. KG, C-887, 0, 2.7.0.1\n";
    withstands(&gcs::Identify, noise, idn);
    withstands(&gcs::QueryError, noise, b"7\n");
    withstands(&gcs::Set("FRF".into()), noise, b"0\n");
    withstands(&QueryReachable([0.0; 6]), noise, b"1\n");
    let pose = b"X=0.499998 \nY=-0.000002 \nZ=0.000000 \nU=0.200000 \nV=0.000000 \nW=0.000000\n";
    withstands(&QueryAxes("POS?"), noise, pose);
}

pub fn modbus(noise: &[u8]) {
    let reply = b"\x01\x03\x0C\x10\x00\x13\xF8\x40\x00\x00\x00\xFF\xFF\x0F\x0A\x41\x32";
    withstands(&ReadRegisters { slave: 1, first: 0, count: 6 }, noise, reply);
    withstands(&ReadRegisters { slave: 1, first: 210, count: 2 }, noise, b"\x01\x03\x04\x40\x15\x00\x00\xFE\x37");
}

pub fn puma(noise: &[u8]) {
    let request = Numbered { number: 7, order: ReadPosition };
    withstands(&request, noise, &[0x5A, 0x07, 0x01, 0xFF, 0xFE, 0x90, 0xE0]);
    walk(&Numbered { number: 1, order: PositionMode(-5) }, noise);
    walk(&Numbered { number: 0x5A, order: DiagRead(4) }, noise);
}

pub fn lorenz(noise: &[u8]) {
    let telegram = |command, parameters: &[u8]| {
        let mut wire = Vec::new();
        Telegram { command, to: 0xFF, from: 0x01, parameters: parameters.to_vec() }.encode(&mut wire);
        wire
    };
    withstands(&Hello, noise, &telegram(0x40, &[1]));
    // Contains 02, which is sent twice.
    withstands(&ReadRaw, noise, &telegram(0x41, &[0, 2, 2, 2, 0, 3, 0xFF, 2, 0]));
    withstands(&ReadStatusShort, noise, &telegram(0x43, &[0]));
    withstands(&StartStream { period: 5 }, noise, &telegram(0x06, &[]));
    withstands(&ReadConfig { block: 0 }, noise, &telegram(0x44, &[0; 33]));
}

/// 60 frames after noise: the last frame that can be confirmed is found, without extra frames or memory.
pub fn lorenz_stream(noise: &[u8]) {
    const FRAMES: i16 = 60;
    let mut frames = Frames::default();
    frames.push(noise);
    assert!(frames.by_ref().count() <= 2 * noise.len());
    assert!(frames.waiting() <= KEPT as u64, "{} frames are kept", frames.waiting());
    let first = noise.first().copied().unwrap_or_default();
    let index = |number: i16| first.wrapping_add(number as u8);
    let counts = |number: i16| [37 * number, -37 * number];
    let mut last = None;
    for number in 0..FRAMES {
        let [[a0, a1], [b0, b1]] = counts(number).map(i16::to_be_bytes);
        frames.push(&[index(number), a0, a1, b0, b1]);
        let found = frames.by_ref().filter_map(|item| if let Item::Frame(frame) = item { Some(frame) } else { None });
        last = found.last().or(last);
    }
    let last = last.expect("60 frames in a row are found");
    assert_eq!((last.index, last.counts), (index(FRAMES - 3), counts(FRAMES - 3)));
}

/// An edited record: the error names its line.
pub fn record(noise: &[u8]) {
    let text = String::from_utf8_lossy(noise);
    if let Err(error) = Traffic::parse(&text) {
        let line = text.lines().nth(error.line - 1).unwrap();
        assert_eq!(line.chars().take(80).collect::<String>(), error.text);
    }
}
