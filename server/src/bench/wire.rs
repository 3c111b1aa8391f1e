//! What the server and the worker of a bench say to each other, over the worker's standard input and output: MessagePack,
//! each message behind its length.

use super::health::Incoming;
use crate::config::BenchDescription;
use crate::store::{RunCommit, SafetyRecord};
use crate::view::Instrument;
use jointbench_instrument::Trace;
use jointbench_procedure::{Demand, Plan, Progress, RunEnd, RunId, RunState, Safe};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::io::{self, ErrorKind, Read, Write};
use std::path::PathBuf;
use std::sync::Arc;

/// Longer messages are none of ours: a plan that goes on from a long run is the longest.
const LONGEST_BYTES: u32 = 1 << 30;

/// From the server to the worker.
#[derive(Debug, Serialize, Deserialize)]
pub enum Order {
    /// The first one.
    Open(Box<Setup>),
    Run {
        run: RunId,
        plan: Box<Plan>,
    },
    Control(Demand),
    /// The software stop. Carried out before anything else that waits.
    Stop {
        block: SafetyRecord,
        ticket: u64,
    },
    BlockStored {
        at: String,
    },
    /// A person has looked: a block that began at this moment or earlier is lifted.
    Release {
        until: String,
    },
    /// Opens what is not open, asks these instruments again, and secures the bench.
    Reopen {
        wanting: Vec<String>,
        ticket: u64,
    },
    /// Reads these ranges of the memory of the joint's servo: first address and number of bytes.
    ReadMemory {
        ranges: Vec<(u8, u8)>,
        ticket: u64,
    },
    /// Everything up to this number is durable.
    Stored {
        number: u64,
    },
    /// Why nothing can be stored now, or that it can again.
    Storage {
        fault: Option<String>,
    },
    /// Ends the run that is on, secures the bench and ends the worker.
    Quit,
}

/// What a worker begins with.
#[derive(Debug, Serialize, Deserialize)]
pub struct Setup {
    pub description: BenchDescription,
    /// The data folder, absolute.
    pub data: PathBuf,
    /// What keeps the bench from moving already.
    pub block: Option<SafetyRecord>,
}

/// From the worker to the server.
#[derive(Debug, Serialize, Deserialize)]
pub enum Report {
    /// The instruments, as opening or asking them again found them.
    Opened {
        instruments: Vec<Instrument>,
        channels: Vec<Incoming>,
        open: bool,
    },
    /// No run is on: the bench was secured.
    Secured {
        safe: Safe,
        notes: Vec<String>,
    },
    /// What was asked for with this ticket is done; a stop: known, and being carried out.
    Done {
        ticket: u64,
    },
    /// What the memory of the joint's servo holds, asked for with this ticket.
    Memory {
        ticket: u64,
        read: MemoryRead,
    },
    Entry(Arc<Entry>),
    Live {
        run: RunId,
        state: RunState,
        rows: Trace,
        progress: Progress,
    },
    Ended {
        run: RunId,
        end: RunEnd,
    },
    /// The bench is not open, or nobody would store the run: nothing was commanded.
    NotBegun {
        run: RunId,
    },
    /// The mock bench's disk has its bad day, or no longer.
    DiskFull(bool),
    /// The last one: the bench is secured, and nothing more will come.
    Finished,
}

/// What came of reading the memory of a joint's servo.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum MemoryRead {
    /// The bytes of each range.
    Read(Vec<Vec<u8>>),
    /// The joint's drive has no memory that can be read.
    None,
    /// Why it could not be read.
    Failed(String),
}

/// What is to be stored, in this order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Counts from 1 for each worker.
    pub number: u64,
    pub commit: RunCommit,
}

/// # Errors
/// Where the other side is gone.
pub fn send(stream: &mut impl Write, message: &impl Serialize) -> io::Result<()> {
    let body = rmp_serde::to_vec_named(message).map_err(io::Error::other)?;
    let length = u32::try_from(body.len()).ok().filter(|length| *length <= LONGEST_BYTES);
    let length = length.ok_or_else(|| io::Error::new(ErrorKind::InvalidInput, "the message is too long"))?;
    stream.write_all(&length.to_le_bytes())?;
    stream.write_all(&body)?;
    stream.flush()
}

/// `None` where the other side has ended between two messages.
///
/// # Errors
/// Where it ended within one, or what came is no message.
pub fn receive<T: DeserializeOwned>(stream: &mut impl Read) -> io::Result<Option<T>> {
    let mut length = [0; 4];
    match stream.read_exact(&mut length) {
        Ok(()) => {}
        Err(fault) if fault.kind() == ErrorKind::UnexpectedEof => return Ok(None),
        Err(fault) => return Err(fault),
    }
    let length = u32::from_le_bytes(length);
    if length > LONGEST_BYTES {
        return Err(io::Error::new(ErrorKind::InvalidData, format!("a message of {length} bytes")));
    }
    let mut body = Vec::new();
    stream.take(u64::from(length)).read_to_end(&mut body)?;
    let message = rmp_serde::from_slice(&body);
    Ok(Some(message.map_err(|fault| io::Error::new(ErrorKind::InvalidData, fault))?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_devices::{Joint, MockSettings};
    use jointbench_instrument::Channel;
    use jointbench_procedure::{Control, Event, EventKind, Procedure, catalogue};

    fn over<T: Serialize + DeserializeOwned>(message: &T) -> T {
        let mut bytes = Vec::new();
        send(&mut bytes, message).unwrap();
        receive(&mut bytes.as_slice()).unwrap().unwrap()
    }

    #[test]
    fn a_plan_of_every_procedure_comes_over_as_it_was() {
        for (joint, name) in [(Joint::JointA, "joint"), (Joint::EncoderShaft, "shaft"), (Joint::Puma, "arm")] {
            let description = BenchDescription::mock(name, MockSettings::new(joint, 1));
            let facts = crate::bench::facts(&description);
            let plans =
                catalogue().iter().filter_map(|one: &&dyn Procedure| one.plan(&Default::default(), &facts).ok());
            for plan in plans {
                let Order::Run { plan: told, .. } = over(&Order::Run { run: 1, plan: Box::new(plan.clone()) }) else {
                    panic!("another order")
                };
                assert_eq!(*told, plan, "{}", plan.procedure);
            }
        }
    }

    #[test]
    fn numbers_that_are_none_come_over() {
        let rows =
            Trace::from_columns(vec![Channel::counted("time_s", 1e-3)], vec![vec![0.0, f64::NAN, f64::INFINITY]]);
        let control = EventKind::Control { control: Control::EStop, by: Some("someone".into()) };
        let events = vec![Event { at_s: 0.25, kind: control }];
        let commit = RunCommit { run: 7, number: 2, state: RunState::Running, events, rows };
        let entry = Entry { number: 3, commit };
        let told = over(&entry);
        let [was, told] = [entry.commit, told.commit];
        assert_eq!((&told.events, told.rows.channels()), (&was.events, was.rows.channels()));
        let [was, is] =
            [&was, &told].map(|commit| commit.rows.columns()[0].iter().map(|v| v.to_bits()).collect::<Vec<_>>());
        assert_eq!(was, is);
    }

    #[test]
    fn a_message_that_is_cut_off_is_told() {
        let mut bytes = Vec::new();
        send(&mut bytes, &Order::Quit).unwrap();
        bytes.pop();
        assert!(receive::<Order>(&mut bytes.as_slice()).is_err());
        assert!(receive::<Order>(&mut &bytes[..2]).unwrap().is_none());
    }
}
