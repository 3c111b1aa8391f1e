//! The worker of a bench: a separate process that owns the instruments. Faults in the server part of the daemon (a fit
//! without memory, a blocked disk, a panic) do not affect the instruments.
//!
//! Four threads: the owner runs the engine. `orders` receives messages and executes the software stop immediately.
//! `reports` sends data to store and show. `presses` keeps a software stop in a file until it is stored. Without a
//! server, the worker ends the active run, secures the bench and writes unstored data to the data folder.

mod outbox;
mod owner;
mod press_file;
mod process;
mod recorder;
mod worker_state;

pub use process::wait_until_gone;

use super::leftovers;
use super::wire::{self, Order, Setup};
use jointbench_procedure::{Control, Demand, Plan, RunId};
use outbox::Outbox;
use owner::Owner;
use press_file::PressFiles;
use std::io::{self, Read};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, Sender};
use worker_state::WorkerState;

/// Commands to the owner of the bench, executed in sequence.
enum Command {
    Run { run: RunId, plan: Box<Plan>, controls: Receiver<Demand> },
    Secure,
    Reopen { wanting: Vec<String>, ticket: u64 },
    ReadMemory { ranges: Vec<(u8, u8)>, ticket: u64 },
    Quit,
}

/// Serves a bench until the server quits or is gone. Standard input and output belong to the server.
///
/// # Errors
/// If there is no server, or a thread cannot be started.
pub fn serve() -> io::Result<()> {
    let mut orders = io::stdin();
    let Some(Order::Open(setup)) = wire::receive(&mut orders)? else {
        return Err(io::Error::other("a worker can only be started by the daemon"));
    };
    let Setup { description, data, block } = *setup;
    let name = description.name.clone();
    process::raise_priority(description.is_real_time());
    let (outbox, reports) = Outbox::start(io::stdout())?;
    let worker = Arc::new(WorkerState::new(outbox, block));
    let (commands, to_do) = mpsc::channel();
    process::end_on_signal(worker.clone(), commands.clone())?;
    let (listening, presses) = (worker.clone(), PressFiles::start(&data, &name)?);
    std::thread::Builder::new().name("orders".into()).spawn(move || listen(orders, &listening, &presses, &commands))?;
    // Held until the end: the next worker then finds the file of this one.
    let lock = process::take(&data, &name);
    match &lock {
        Ok(_) => Owner::new(description, worker.clone()).serve(&to_do),
        Err(why) => owner::serve_nothing(&description, &worker, &to_do, why),
    }
    worker.outbox.send(wire::Report::Finished);
    worker.outbox.close();
    if reports.join().is_err() {
        tracing::error!("the thread of the reports has panicked");
    }
    // The server closes its end after it has stored all that it can.
    while !worker.is_alone() && to_do.recv().is_ok() {}
    leftovers::leave(&data, &name, worker.unstored_block(), &worker.outbox.unstored());
    drop(lock);
    Ok(())
}

fn listen(mut orders: impl Read, worker: &WorkerState, presses: &PressFiles, commands: &Sender<Command>) {
    loop {
        match wire::receive(&mut orders) {
            Ok(Some(order)) => obey(order, worker, presses, commands),
            Ok(None) => break,
            Err(fault) => {
                tracing::error!(%fault, "an order of the server cannot be read");
                break;
            }
        }
    }
    worker.server_is_gone();
    // An error means that the owner has already ended.
    let _ = commands.send(Command::Quit);
}

fn obey(order: Order, worker: &WorkerState, presses: &PressFiles, commands: &Sender<Command>) {
    let command = match order {
        Order::Stop { block, ticket } => {
            let secures_itself = worker.stop(block.clone());
            presses.pressed(block);
            worker.outbox.send(wire::Report::Done { ticket });
            if secures_itself {
                return;
            }
            Command::Secure
        }
        Order::Control(demand) => {
            worker.control(demand);
            return;
        }
        Order::Run { run, plan } => Command::Run { run, plan, controls: worker.expect(run) },
        Order::Release { until } => return worker.release(&until),
        Order::BlockStored { at } => {
            presses.stored(&at);
            worker.block_is_stored(&at);
            return;
        }
        Order::Stored { number } => return worker.outbox.stored(number),
        Order::Storage { fault } => return worker.outbox.set_fault(fault),
        Order::Reopen { wanting, ticket } => Command::Reopen { wanting, ticket },
        Order::ReadMemory { ranges, ticket } => Command::ReadMemory { ranges, ticket },
        Order::Quit => {
            worker.control(Control::Quit.into());
            Command::Quit
        }
        Order::Open(_) => return tracing::error!("a bench is opened once"),
    };
    // An error means that the owner has already ended.
    let _ = commands.send(command);
}
