//! A six-axis alignment stage: a PI hexapod on a C-887 controller.

use super::{Recovers, common_answers, same};
use crate::protocol::gcs::{Identify, QueryAxes, QueryError, QueryReachable, Set, StopAll, error_text};
use crate::transport::{Link, PortSettings};
use jointbench_instrument::roles::{AlignmentStage, Identity, Instrument, Pose};
use jointbench_instrument::{Fault, FaultKind};
use serde::{Deserialize, Serialize};
use std::time::Duration;

const M_PER_MM: f64 = 1e-3;
/// The error code that every stop sets.
const STOPPED: u32 = 10;

/// Connection of a PI C-887 hexapod controller.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GcsSettings {
    /// Name in the bench description (role or own name).
    pub name: String,
    /// Port and line speed.
    pub port: PortSettings,
    /// Longest time for a reply.
    pub deadline_ms: u64,
}

/// A PI hexapod, commanded with GCS 2.0.
pub struct GcsStage {
    settings: GcsSettings,
    link: Link,
    identity: Option<Identity>,
    /// The stage was referenced when this driver last read the flag.
    referenced: bool,
}

impl GcsStage {
    /// Opens the port and identifies the controller. Nothing moves.
    pub fn open(settings: GcsSettings) -> Result<Self, Fault> {
        let link = Link::open(&settings.name, &settings.port, Duration::from_millis(settings.deadline_ms))?;
        let mut stage = Self { settings, link, identity: None, referenced: false };
        stage.ready()?;
        Ok(stage)
    }

    fn axes(&mut self, query: &'static str) -> Result<[f64; 6], Fault> {
        self.ready()?.request(&QueryAxes(query))
    }

    fn all(&mut self, query: &'static str) -> Result<bool, Fault> {
        Ok(self.axes(query)?.iter().all(|flag| *flag == 1.0))
    }
}

impl Recovers for GcsStage {
    fn link(&mut self) -> &mut Link {
        &mut self.link
    }

    fn drain_and_identify(&mut self) -> Result<Identity, Fault> {
        self.link.drain(b"\n", false)?;
        let found = self.link.probe(&Identify)?;
        if found.model != "C-887" {
            let found = format!("{} {}", found.maker, found.model);
            return Err(self.link.fault(FaultKind::WrongInstrument { expected: "PI C-887".into(), found }));
        }
        let identity = same(&mut self.link, &mut self.identity, found)?;
        // An old error must not be attributed to the next command.
        let error = self.link.probe(&QueryError)?;
        if error != 0 && error != STOPPED {
            tracing::info!(instrument = self.link.instrument(), what = %error_text(error), "an old error is cleared");
        }
        let referenced = self.link.probe(&QueryAxes("FRF?"))?.iter().all(|flag| *flag == 1.0);
        if std::mem::replace(&mut self.referenced, referenced) && !referenced {
            let what =
                "the axes lost their reference because the controller was switched off; reference them again".into();
            return Err(self.link.fault(FaultKind::Reported { what }));
        }
        Ok(identity)
    }
}

impl Instrument for GcsStage {
    common_answers!();

    fn identify(&mut self) -> Result<Identity, Fault> {
        let found = self.ready()?.request(&Identify)?;
        same(&mut self.link, &mut self.identity, found)
    }
}

impl AlignmentStage for GcsStage {
    fn reference(&mut self) -> Result<(), Fault> {
        self.ready()?.request(&Set("FRF".into()))
    }

    fn is_referenced(&mut self) -> Result<bool, Fault> {
        self.referenced = self.all("FRF?")?;
        Ok(self.referenced)
    }

    fn move_to(&mut self, pose: Pose) -> Result<(), Fault> {
        let axes = [pose.shift_m.map(|m| m / M_PER_MM), pose.rotation_rad.map(f64::to_degrees)].concat();
        let axes: [f64; 6] = std::array::from_fn(|axis| axes[axis]);
        if !axes.iter().all(|axis| axis.is_finite()) {
            return Err(self.link.fault(FaultKind::Refused { what: format!("{pose:?}: expected finite numbers") }));
        }
        if !self.ready()?.request(&QueryReachable(axes))? {
            let what = format!("{pose:?} cannot be reached; nothing has moved");
            return Err(self.link.fault(FaultKind::Refused { what }));
        }
        self.link.request(&Set::move_to(axes))
    }

    fn pose(&mut self) -> Result<Pose, Fault> {
        let [x, y, z, u, v, w] = self.axes("POS?")?;
        Ok(Pose { shift_m: [x, y, z].map(|mm| mm * M_PER_MM), rotation_rad: [u, v, w].map(f64::to_radians) })
    }

    fn is_settled(&mut self) -> Result<bool, Fault> {
        self.all("ONT?")
    }

    fn stop(&mut self) -> Result<(), Fault> {
        // The stop is sent first, in any state of the link. Then the error that a stop sets is read and cleared.
        self.link.send(&StopAll)?;
        self.link.distrust();
        self.resume().map(drop)
    }
}
