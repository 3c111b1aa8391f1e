//! Opens the instruments of a description. A simulation replaces the transport, not the driver.

use crate::config::{BenchDescription, Source};
use crate::view::{Instrument, InstrumentIdentity};
use jiff::Timestamp;
use jointbench_devices::{Asked, InstrumentSettings, Instruments, MockBench};
use jointbench_instrument::roles::Identity;
use jointbench_instrument::{Bench, Clock, LatencyCounter, SystemClock};
use std::path::Path;
use std::sync::Arc;

/// Result of opening: each instrument, and the bench if all instruments answer.
#[derive(Default)]
pub struct Opened {
    pub instruments: Vec<Instrument>,
    pub bench: Option<Bench>,
    /// Counts the exchanges with each instrument of the bench, by its name.
    pub links: Vec<(String, Arc<LatencyCounter>)>,
    /// The simulation runs until this is dropped.
    pub mock: Option<MockBench>,
}

/// Opens and identifies every instrument without commands. A fault is stored with its instrument.
pub fn open(description: &BenchDescription) -> Opened {
    match reach(description) {
        Ok(Reached { slots, clock, mock }) => {
            let instruments = slots.asked.iter().map(|asked| described(description, asked)).collect();
            let (limits, constants) = (description.limits, description.constants);
            let bench = slots.into_bench(&description.name, description.is_simulated(), clock, limits, constants);
            let torsion = description.torsion;
            let power = mock.as_ref().map(MockBench::power_switch);
            let mut bench = bench.map(|bench| Bench { power, torsion, ..bench });
            let links = bench.as_mut().map(links).unwrap_or_default();
            Opened { instruments, bench, links, mock }
        }
        Err(fault) => Opened { instruments: vec![unreached(description, fault)], ..Opened::default() },
    }
}

fn links(bench: &mut Bench) -> Vec<(String, Arc<LatencyCounter>)> {
    let instruments = bench.instruments().into_iter();
    instruments.filter_map(|one| Some((one.name().to_owned(), one.latency_counter()?))).collect()
}

/// The instruments that answer, independent of the others.
pub struct Reached {
    pub slots: Instruments,
    clock: Arc<dyn Clock>,
    mock: Option<MockBench>,
}

/// `Err`: why the simulated bench or the traffic record is not available.
pub fn reach(description: &BenchDescription) -> Result<Reached, String> {
    let (mut settings, clock, mock): (_, Arc<dyn Clock>, _) = match &description.source {
        Source::Hardware(settings) => ((**settings).clone(), Arc::new(SystemClock::start()), None),
        Source::Mock(settings) => {
            let mock = MockBench::start(settings.clone()).map_err(|fault| fault.to_string())?;
            (mock.instruments(), mock.clock(), Some(mock))
        }
    };
    if let Some(folder) = &description.record {
        record(&mut settings, folder)?;
    }
    Ok(Reached { slots: settings.open(&clock), clock, mock })
}

/// One folder for each opening, so that a new opening does not overwrite earlier traffic.
fn record(settings: &mut InstrumentSettings, folder: &Path) -> Result<(), String> {
    let folder = folder.join(Timestamp::now().strftime("%Y%m%dT%H%M%S%3fZ").to_string());
    std::fs::create_dir_all(&folder)
        .map_err(|fault| format!("traffic cannot be recorded in {}: {fault}", folder.display()))?;
    settings.record_in(&folder);
    tracing::info!(folder = %folder.display(), "recording the traffic of every instrument");
    Ok(())
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
        since: asked.identity.is_err().then(|| Timestamp::now().to_string()),
        faults: Vec::new(),
    }
}

pub(super) fn unreached(description: &BenchDescription, fault: String) -> Instrument {
    Instrument {
        bench: description.name.clone(),
        role: "joint".to_owned(),
        name: "joint".to_owned(),
        driver: "mock".to_owned(),
        port: String::new(),
        ready: false,
        identity: None,
        fault: Some(fault),
        since: Some(Timestamp::now().to_string()),
        faults: Vec::new(),
    }
}

impl From<Identity> for InstrumentIdentity {
    fn from(identity: Identity) -> Self {
        Self { maker: identity.maker, model: identity.model, serial: identity.serial, firmware: identity.firmware }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{READY_MADE, parse};
    use jointbench_devices::sim::Transport;
    use jointbench_devices::transport::Traffic;
    use jointbench_devices::{GcsSettings, GcsStage, PortSettings, Replay};

    #[test]
    fn a_recorded_bench_can_be_opened_again_from_its_record() {
        let folder = tempfile::tempdir().unwrap();
        let (name, text) = READY_MADE.into_iter().find(|(name, _)| *name == "encoder-bench-mock").unwrap();
        let mut description = parse(name, text).unwrap().benches.remove(0);
        description.record = Some(folder.path().join(name));
        let asked = reach(&description).unwrap().slots.asked;
        let opening = std::fs::read_dir(folder.path().join(name)).unwrap().next().unwrap().unwrap().path();
        assert_eq!(std::fs::read_dir(&opening).unwrap().count(), asked.len());
        let text = std::fs::read_to_string(opening.join("stage.traffic")).unwrap();
        let replay = Replay::start(Traffic::parse(&text).unwrap(), Transport::Tcp).unwrap();
        let port = PortSettings::new(replay.address().clone(), 115_200);
        GcsStage::open(GcsSettings { name: "stage".into(), port, deadline_ms: 1000 }).unwrap();
        assert!(replay.departure().is_none(), "{:?}", replay.departure());
    }
}
