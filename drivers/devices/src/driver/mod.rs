//! One driver for each instrument, behind the narrow role that the bench needs.

mod lorenz;
mod odrive;
mod scpi;

pub use lorenz::{LorenzSensor, LorenzSettings, Range};
pub use odrive::{OdriveJoint, OdriveSettings, Thermistor};
pub use scpi::{ScpiSettings, ScpiSource};

use jointbench_instrument::roles::Identity;
use jointbench_instrument::{Fault, FaultKind};

/// The instrument that answers must be the one that answered when the bench was opened.
fn same(known: &mut Option<Identity>, found: Identity) -> Result<Identity, FaultKind> {
    match known {
        Some(known) if *known != found => {
            let shown = |identity: &Identity| format!("{} {}", identity.model, identity.serial);
            Err(FaultKind::WrongInstrument { expected: shown(known), found: shown(&found) })
        }
        _ => Ok(known.insert(found).clone()),
    }
}

/// A link that is drained and identified again before the next use, where the last one failed.
trait Recovers {
    fn link(&mut self) -> &mut crate::transport::Link;
    fn drain_and_identify(&mut self) -> Result<Identity, Fault>;

    fn ready(&mut self) -> Result<&mut crate::transport::Link, Fault> {
        if !self.link().is_trusted() {
            let identity = self.drain_and_identify()?;
            let link = self.link();
            tracing::info!(instrument = link.instrument(), serial = %identity.serial, "identified");
        }
        Ok(self.link())
    }
}
