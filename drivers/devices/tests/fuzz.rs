//! Every codec against bytes that no instrument would send: no panic, always forward, and back in step afterwards.

use jointbench_devices::protocol::gcs::{self, QueryAxes};
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
use proptest::collection::vec;
use proptest::prelude::*;

const REGISTERS: ReadRegisters = ReadRegisters { slave: 1, first: 0, count: 6 };

/// Anything, with more of what the protocols give a meaning to.
fn bytes() -> impl Strategy<Value = Vec<u8>> {
    let meant =
        prop::sample::select(b"\x02\x06\x15\x40\x41\x44\x5A\x01\xFF\n\r*,;?:.-+0123456789eE naNifRSV\"".to_vec());
    vec(prop_oneof![any::<u8>(), meant], 0..600)
}

/// What the link does with what comes in. The replies found; every step takes something, and no more than there is.
fn walk<R: Request>(request: &R, mut rest: &[u8]) -> Vec<R::Reply> {
    let mut replies = Vec::new();
    while !rest.is_empty() {
        let taken = match request.scan(rest) {
            Scan::Short => break,
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

/// Noise that ends, then a good reply: it is found.
fn check_back_in_step<R: Request>(request: &R, noise: &[u8], end: &[u8], reply: &[u8])
where
    R::Reply: PartialEq + std::fmt::Debug,
{
    let expected = walk(request, reply).pop();
    assert!(expected.is_some(), "{}: {reply:02X?} is a reply", request.name());
    let found = walk(request, &[noise, end, reply].concat()).pop();
    assert_eq!(found, expected, "{} after {noise:02X?}", request.name());
}

fn telegram(command: u8, parameters: &[u8]) -> Vec<u8> {
    let mut wire = Vec::new();
    Telegram { command, to: 0xFF, from: 0x01, parameters: parameters.to_vec() }.encode(&mut wire);
    wire
}

proptest! {
    #[test]
    fn no_reply_is_too_strange(noise in bytes()) {
        walk(&ReadFeedback { axis: 0 }, &noise);
        walk(&ReadNumber { path: "vbus_voltage" }, &noise);
        walk(&ReadInfo, &noise);
        walk(&SetVelocity { turns_s: 1.5, torque_nm: 0.0 }, &noise);
        for part in Part::ALL {
            walk(&ReadErrors(part), &noise);
        }
        let lf = Terminator::Lf;
        walk(&Identify(lf), &noise);
        walk(&QueryError(lf), &noise);
        walk(&QueryNumber(lf, ":SOUR1:CURR?"), &noise);
        walk(&QueryFlag(lf, ":OUTP? CH1"), &noise);
        walk(&ReadMeasured(lf, Dialect::Dp800), &noise);
        walk(&ReadCondition(lf, Dialect::Hmp), &noise);
        walk(&Set(lf, ":OUTP CH1,ON".into()), &noise);
        walk(&ReadVoltage(lf), &noise);
        walk(&ReadRegister(Register::Encoder), &noise);
        walk(&WriteRegister(Register::Mode, 0), &noise);
        walk(&REGISTERS, &noise);
        walk(&Numbered { number: 1, order: PositionMode(-5) }, &noise);
        walk(&Numbered { number: 0x5A, order: DiagRead(4) }, &noise);
        walk(&QueryAxes("POS?"), &noise);
        walk(&gcs::Identify, &noise);
        walk(&gcs::Set("FRF".into()), &noise);
        walk(&Hello, &noise);
        walk(&ReadRaw, &noise);
        walk(&ReadStatusShort, &noise);
        walk(&ReadConfig { block: 0 }, &noise);
        walk(&StartStream { period: 5 }, &noise);
    }

    #[test]
    fn lines_are_found_behind_a_line_of_noise(noise in bytes()) {
        let noise: Vec<u8> = noise.into_iter().filter(|byte| *byte != b'\n').collect();
        check_back_in_step(&ReadNumber { path: "vbus_voltage" }, &noise, b"\n", b"24.087744*32\r\n");
        check_back_in_step(&ReadMeasured(Terminator::Lf, Dialect::Dp800), &noise, b"\n", b"12.9870,0.2498,3.2441\n");
        check_back_in_step(&QueryError(Terminator::Lf), &noise, b"\n", b"-222,\"Data out of range\"\n");
        check_back_in_step(&ReadRegister(Register::Encoder), &noise, b"\n", b"r 0E 000012F3 0000ABD0 !\r\n");
        // A line that ends with a blank is not the last one of its reply.
        check_back_in_step(&gcs::QueryError, &noise, b".\n", b"7\n");
    }

    #[test]
    fn frames_are_found_behind_noise(noise in bytes(), counts in any::<i16>()) {
        let noise: Vec<u8> = noise.into_iter().filter(|byte| *byte != 0x5A).collect();
        let [high, low] = counts.to_be_bytes();
        let sum = [0x07, 0x01, high, low].iter().fold(0u8, |sum, byte| sum.wrapping_sub(*byte));
        let reply = [0x5A, 0x07, 0x01, high, low, sum];
        let request = Numbered { number: 0x07, order: ReadPosition };
        check_back_in_step(&request, &noise, b"", &reply);
        // A frame that broke off: one in 256 makes a good sum with the beginning of the next, as far as one byte can tell.
        let broken = &reply[..4];
        if broken[1..].iter().chain(&reply[..2]).fold(0u8, |sum, byte| sum.wrapping_add(*byte)) != 0 {
            check_back_in_step(&request, broken, b"", &reply);
        }
    }

    #[test]
    fn telegrams_are_found_behind_noise(noise in bytes(), torque in any::<[i16; 4]>()) {
        let noise: Vec<u8> = noise.into_iter().filter(|byte| *byte != 0x02).collect();
        let words: Vec<u8> = torque.into_iter().flat_map(i16::to_be_bytes).chain([0]).collect();
        check_back_in_step(&ReadRaw, &noise, b"", &telegram(0x41, &words));
        // A telegram that broke off: its successor's start ends it, whatever stood in it.
        let broken = telegram(0x41, &words);
        let broken = &broken[..broken.len() - 3];
        if broken.last() != Some(&0x02) {
            check_back_in_step(&ReadRaw, broken, b"", &telegram(0x41, &[0, 1, 0, 1, 0, 3, 0, 4, 0]));
        }
    }

    #[test]
    fn a_stream_is_found_again_behind_noise(noise in bytes(), torque in vec(any::<[i16; 2]>(), 60), first in any::<u8>()) {
        let mut frames = Frames::default();
        frames.push(&noise);
        assert!(frames.by_ref().count() <= 2 * noise.len());
        let sent = torque.iter().zip(0_u8..).map(|([a, b], i)| {
            let ([a0, a1], [b0, b1]) = (a.to_be_bytes(), b.to_be_bytes());
            [first.wrapping_add(i), a0, a1, b0, b1]
        });
        for frame in sent {
            frames.push(&frame);
        }
        let last = frames.filter_map(|item| if let Item::Frame(frame) = item { Some(frame) } else { None }).last();
        let last = last.expect("60 frames in a row are found");
        assert_eq!((last.index, last.counts), (first.wrapping_add(57), torque[57]));
    }

    #[test]
    fn any_text_is_a_record_or_a_mistake_with_its_line(text in "([0-9a-fx.> <!#-]|\n){0,200}") {
        if let Err(error) = Traffic::parse(&text) {
            assert_eq!(text.lines().nth(error.line - 1).unwrap().chars().take(80).collect::<String>(), error.text);
        }
    }
}
