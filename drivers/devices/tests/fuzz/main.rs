//! Every codec with bytes that no instrument would send.

mod codecs;

use proptest::collection::vec;
use proptest::prelude::*;

/// Random bytes, with more of those that have a meaning in the protocols.
fn bytes() -> impl Strategy<Value = Vec<u8>> {
    let meant =
        prop::sample::select(b"\x02\x06\x15\x40\x41\x44\x5A\x01\x03\xFF\n\r*,;?:.-+0123456789eE naNifRSV\"".to_vec());
    vec(prop_oneof![any::<u8>(), meant], 0..600)
}

proptest! {
    #[test]
    fn no_reply_is_too_strange(noise in bytes()) {
        codecs::odrive(&noise);
        codecs::scpi(&noise);
        codecs::qsb(&noise);
        codecs::encoder_status(&noise);
        codecs::gcs(&noise);
        codecs::modbus(&noise);
        codecs::puma(&noise);
        codecs::lorenz(&noise);
        codecs::lorenz_stream(&noise);
    }

    #[test]
    fn any_text_is_a_record_or_a_mistake_with_its_line(text in "([0-9a-fx.> <!#-]|\n){0,200}") {
        codecs::record(text.as_bytes());
    }
}
