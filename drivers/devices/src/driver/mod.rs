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

/// The part of `Instrument` that every driver answers in the same way, from its settings and its link.
macro_rules! common_answers {
    () => {
        fn name(&self) -> &str {
            &self.settings.name
        }

        fn port(&self) -> &str {
            self.link.address()
        }

        fn recover(&mut self) -> Result<Identity, Fault> {
            self.resume()
        }

        fn record(&mut self, file: Option<&std::path::Path>) -> Result<(), Fault> {
            self.link.record(file)
        }

        fn latency_counter(&self) -> Option<std::sync::Arc<jointbench_instrument::LatencyCounter>> {
            Some(self.link.latency_counter())
        }
    };
}

use common_answers;

/// The instrument must be the one that answered when the bench was opened. If it is another one, all requests are
/// refused until the original instrument is back.
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

/// Attempts to drain and identify. A reply that arrives after the silence of a drain spoils the identification.
const ATTEMPTS: usize = 3;

/// After a failed exchange the link is drained and the instrument identified again before the next use.
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
