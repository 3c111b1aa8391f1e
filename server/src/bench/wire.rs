//! Messages between server and bench worker, over standard input and output of the worker. A message is MessagePack,
//! preceded by its length.

use super::health::ChannelInput;
use crate::config::BenchDescription;
use crate::store::{RunCommit, SafetyRecord};
use crate::view::Instrument;
use jointbench_instrument::{LinkLatency, Trace};
use jointbench_procedure::{Demand, Plan, Progress, RunEnd, RunId, RunState, Safe};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::io::{self, ErrorKind, Read, Write};
use std::path::PathBuf;
use std::sync::Arc;

/// Limit of a message. The longest valid message is a plan that continues a long run.
const LONGEST_BYTES: u32 = 1 << 30;

/// From the server to the worker.
#[derive(Debug, Serialize, Deserialize)]
pub enum Order {
    /// The first message.
    Open(Box<Setup>),
    Run {
        run: RunId,
        plan: Box<Plan>,
    },
    Control(Demand),
    /// The software stop. It has priority over other orders.
    Stop {
        block: SafetyRecord,
        ticket: u64,
    },
    BlockStored {
        at: String,
    },
    /// Releases a block that began at this time or earlier, after a person checked the bench.
    Release {
        until: String,
    },
    /// Opens a closed bench, reconnects the named instruments, and secures the bench.
    Reopen {
        wanting: Vec<String>,
        ticket: u64,
    },
    /// Reads ranges (first address, number of bytes) of the memory of the joint's servo.
    ReadMemory {
        ranges: Vec<(u8, u8)>,
        ticket: u64,
    },
    /// All entries up to this number are durable.
    Stored {
        number: u64,
    },
    /// The storage fault, or `None` after recovery.
    Storage {
        fault: Option<String>,
    },
    /// Ends an active run, secures the bench and ends the worker.
    Quit,
}

/// Initial data of a worker.
#[derive(Debug, Serialize, Deserialize)]
pub struct Setup {
    pub description: BenchDescription,
    /// The data folder, absolute.
    pub data: PathBuf,
    /// An existing block of the bench.
    pub block: Option<SafetyRecord>,
}

/// From the worker to the server.
#[derive(Debug, Serialize, Deserialize)]
pub enum Report {
    /// The instruments after they were opened or reconnected.
    Opened {
        instruments: Vec<Instrument>,
        channels: Vec<ChannelInput>,
        open: bool,
    },
    /// Result of securing the bench without a run.
    Secured {
        safe: Safe,
        notes: Vec<String>,
    },
    /// The order with this ticket is done; a stop is received and in progress.
    Done {
        ticket: u64,
    },
    /// Result of reading the memory of the joint's servo, for this ticket.
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
    /// The bench is not open or the server is gone: nothing was commanded.
    NotBegun {
        run: RunId,
    },
    /// Whether the mock bench simulates a full disk.
    DiskFull(bool),
    /// Exchanges with instruments since the last such report, by their names.
    LinkLatency(Vec<(String, LinkLatency)>),
    /// The last message: the bench is secured.
    Finished,
}

/// Result of reading the memory of a joint's servo.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum MemoryRead {
    /// The bytes of each range.
    Read(Vec<Vec<u8>>),
    /// The joint's drive has no readable memory.
    None,
    /// The reason of the failure.
    Failed(String),
}

/// Data to be stored, in this order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Counts from 1 for each worker.
    pub number: u64,
    pub commit: RunCommit,
}

/// # Errors
/// If the other side is gone.
pub fn send(stream: &mut impl Write, message: &impl Serialize) -> io::Result<()> {
    let body = rmp_serde::to_vec_named(message).map_err(io::Error::other)?;
    let length = u32::try_from(body.len()).ok().filter(|length| *length <= LONGEST_BYTES);
    let length = length.ok_or_else(|| io::Error::new(ErrorKind::InvalidInput, "the message is too long"))?;
    stream.write_all(&length.to_le_bytes())?;
    stream.write_all(&body)?;
    stream.flush()
}

/// `None` if the other side has ended between two messages.
///
/// # Errors
/// If the other side ended within a message, or the data is not a message.
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
                let Order::Run { plan: received, .. } = over(&Order::Run { run: 1, plan: Box::new(plan.clone()) })
                else {
                    panic!("another order")
                };
                assert_eq!(*received, plan, "{}", plan.procedure);
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
        let received = over(&entry);
        let [was, received] = [entry.commit, received.commit];
        assert_eq!((&received.events, received.rows.channels()), (&was.events, was.rows.channels()));
        let [was, is] =
            [&was, &received].map(|commit| commit.rows.columns()[0].iter().map(|v| v.to_bits()).collect::<Vec<_>>());
        assert_eq!(was, is);
    }

    #[test]
    fn a_truncated_message_is_an_error() {
        let mut bytes = Vec::new();
        send(&mut bytes, &Order::Quit).unwrap();
        bytes.pop();
        assert!(receive::<Order>(&mut bytes.as_slice()).is_err());
        assert!(receive::<Order>(&mut &bytes[..2]).unwrap().is_none());
    }
}
