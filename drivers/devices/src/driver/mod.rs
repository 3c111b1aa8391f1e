//! One driver for each instrument, behind the narrow role that the bench needs.

mod adam;
mod dmm;
mod gcs;
mod lorenz;
mod lorenz_stream;
mod odrive;
mod puma;
mod qsb;
mod scpi;
mod stream_clock;

pub use adam::{AdamSettings, AdamThermometer};
pub use dmm::{DmmSettings, DmmTorqueSensor};
pub use gcs::{GcsSettings, GcsStage};
pub use lorenz::{LorenzSensor, LorenzSettings, Range};
pub use odrive::{OdriveJoint, OdriveSettings, Thermistor};
pub use puma::{PumaAxis, PumaGains, PumaSettings};
pub use qsb::{QsbCounter, QsbSettings};
pub use scpi::{ScpiSettings, ScpiSource};

use crate::transport::Link;
use jointbench_instrument::roles::Identity;
use jointbench_instrument::{Fault, FaultKind};

/// The instrument that answers must be the one that answered when the bench was opened. Where it is another, no request is
/// answered any more before the first one is back.
fn same(link: &mut Link, known: &mut Option<Identity>, found: Identity) -> Result<Identity, Fault> {
    match known {
        Some(known) if *known != found => {
            link.distrust();
            let shown = |identity: &Identity| format!("{} {}", identity.model, identity.serial);
            Err(link.fault(FaultKind::WrongInstrument { expected: shown(known), found: shown(&found) }))
        }
        _ => Ok(known.insert(found).clone()),
    }
}

/// A reply that comes later than the silence after a drain spoils the identification: drain once more, this often.
const ATTEMPTS: usize = 3;

/// A link that is drained and identified again before the next use, where the last one failed.
trait Recovers {
    fn link(&mut self) -> &mut Link;
    fn drain_and_identify(&mut self) -> Result<Identity, Fault>;

    fn resume(&mut self) -> Result<Identity, Fault> {
        let mut outcome = self.drain_and_identify();
        for _ in 1..ATTEMPTS {
            match &outcome {
                Err(Fault { kind: FaultKind::Garbled { .. }, .. }) => outcome = self.drain_and_identify(),
                _ => break,
            }
        }
        let identity = outcome?;
        let link = self.link();
        link.trust();
        tracing::info!(instrument = link.instrument(), serial = %identity.serial, "identified");
        Ok(identity)
    }

    /// The link, trusted.
    fn ready(&mut self) -> Result<&mut Link, Fault> {
        if !self.link().is_trusted() {
            self.resume()?;
        }
        Ok(self.link())
    }
}
