//! The columns of a run of two encoders, with the pose of a stage if there is one.

use crate::column_names::POSE;
use jointbench_instrument::roles::{CounterReading, Pose};
use jointbench_instrument::units::Radians;
use jointbench_instrument::{Bench, Channel};

/// Both encoders, read one after the other, with the status of the encoder under test.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Encoders {
    pub reference: CounterReading,
    pub test: CounterReading,
    pub consistent: Option<bool>,
}

/// reference_position_rad, test_position_rad, encoder_skew_s (delay of the test encoder's reading),
/// encoder_consistent, and the pose if the plan moves the stage.
pub(crate) fn channels(bench: &Bench, placed: bool) -> Vec<Channel> {
    let step = |radians: Radians| Some(radians.0);
    let resolution = |encoder: &Option<Box<dyn jointbench_instrument::roles::PositionCounter>>| {
        encoder.as_ref().and_then(|encoder| step(encoder.resolution()))
    };
    let named = |name: &str, resolution| Channel { name: name.to_owned(), resolution };
    let mut channels = vec![
        named("reference_position_rad", resolution(&bench.reference_encoder)),
        named("test_position_rad", resolution(&bench.test_encoder)),
        named("encoder_skew_s", Some(1e-6)),
        named("encoder_consistent", Some(1.0)),
    ];
    if placed {
        channels.extend(POSE.map(|name| named(name, None)));
    }
    channels
}

/// In the order of the channels. An encoder without a status counts as consistent.
pub(crate) fn row(encoders: &Encoders, pose: Option<Pose>, row: &mut Vec<f64>) {
    row.extend([encoders.reference.position.0, encoders.test.position.0]);
    row.push(((encoders.test.at_s - encoders.reference.at_s) * 1e6).round() * 1e-6);
    row.push(f64::from(u8::from(encoders.consistent != Some(false))));
    if let Some(Pose { shift_m, rotation_rad }) = pose {
        row.extend(shift_m);
        row.extend(rotation_rad);
    }
}
