//! Opens the instruments of a description. Simulation swaps the wire, not the driver.

use crate::config::{BenchDescription, Source};
use crate::view::{Instrument, InstrumentIdentity};
use jointbench_devices::{Asked, InstrumentSettings, Instruments, MockBench};
use jointbench_instrument::roles::Identity;
use jointbench_instrument::{Bench, Clock, SystemClock};
use std::sync::Arc;

/// What opening has brought: the instruments one by one, and the bench where all of them answer.
pub struct Opened {
    pub instruments: Vec<Instrument>,
    pub bench: Option<Bench>,
    /// Answers for as long as it is held.
    _mock: Option<MockBench>,
}

/// Opens and identifies every instrument. Nothing is commanded. A fault is data here, and stands beside its instrument.
pub fn open(description: &BenchDescription) -> Opened {
    match reach(description) {
        Ok(Reached { slots, clock, mock }) => {
            let instruments = slots.asked.iter().map(|asked| described(description, asked)).collect();
            let (limits, constants) = (description.limits, description.constants);
            let bench = slots.into_bench(&description.name, description.is_simulated(), clock, limits, constants);
            Opened { instruments, bench, _mock: mock }
        }
        Err(fault) => Opened { instruments: vec![unreached(description, fault)], bench: None, _mock: None },
    }
}

/// The instruments that answer, whatever the others do.
pub struct Reached {
    pub slots: Instruments,
    clock: Arc<dyn Clock>,
    mock: Option<MockBench>,
}

/// `Err` says why there is no simulated bench.
pub fn reach(description: &BenchDescription) -> Result<Reached, String> {
    let at = |settings: &InstrumentSettings, clock: Arc<dyn Clock>, mock| Reached {
        slots: settings.open(&clock),
        clock,
        mock,
    };
    match &description.source {
        Source::Hardware(settings) => Ok(at(settings, Arc::new(SystemClock::start()), None)),
        Source::Mock(settings) => match MockBench::start(settings.clone()) {
            Ok(mock) => Ok(at(&mock.instruments(), mock.clock(), Some(mock))),
            Err(fault) => Err(fault.to_string()),
        },
    }
}

fn described(description: &BenchDescription, asked: &Asked) -> Instrument {
    Instrument {
        bench: description.name.clone(),
        role: asked.role.to_owned(),
        name: asked.name.clone(),
        driver: asked.driver.to_owned(),
        port: asked.port.clone(),
        ready: asked.identity.is_ok(),
        identity: asked.identity.clone().ok().map(Into::into),
        fault: asked.identity.as_ref().err().map(ToString::to_string),
    }
}

fn unreached(description: &BenchDescription, fault: String) -> Instrument {
    Instrument {
        bench: description.name.clone(),
        role: "joint".to_owned(),
        name: "joint".to_owned(),
        driver: "mock".to_owned(),
        port: String::new(),
        ready: false,
        identity: None,
        fault: Some(fault),
    }
}

impl From<Identity> for InstrumentIdentity {
    fn from(identity: Identity) -> Self {
        Self { maker: identity.maker, model: identity.model, serial: identity.serial, firmware: identity.firmware }
    }
}
