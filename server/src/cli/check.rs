//! `jointbench check`: description and instruments, without moving anything.

use super::arguments::Check;
use super::exit::{Done, Exit};
use super::serve::describe;
use crate::bench::open;
use crate::config::{BenchDescription, READY_MADE};

pub fn check(arguments: &Check) -> Done {
    if arguments.print {
        let text = match READY_MADE.iter().find(|(name, _)| *name == arguments.config) {
            Some((_, text)) => (*text).to_owned(),
            None => std::fs::read_to_string(&arguments.config)
                .map_err(|fault| Exit::bad_input(format!("{}: {fault}", arguments.config)))?,
        };
        print!("{text}");
        return Ok(());
    }
    let benches = describe(&arguments.config)?;
    let silent: usize = benches.iter().map(check_bench).sum();
    match silent {
        0 => Ok(()),
        _ => Err(Exit::failed("not ready: see above")),
    }
}

/// The number of instruments that do not answer.
fn check_bench(description: &BenchDescription) -> usize {
    let kind = if description.is_simulated() { "simulated" } else { "hardware" };
    println!("bench {} ({kind}): description is right", description.name);
    let opened = open(description);
    for instrument in &opened.instruments {
        let (role, port) = (&instrument.role, &instrument.port);
        match (&instrument.identity, &instrument.fault) {
            (Some(who), _) => {
                let told = [("serial", &who.serial), ("firmware", &who.firmware)];
                let told = told.into_iter().filter(|(_, value)| !value.is_empty());
                let told: String = told.map(|(name, value)| format!(", {name} {value}")).collect();
                println!("  ok    {role:<14} {port:<16} {} {}{told}", who.maker, who.model);
            }
            (None, Some(fault)) => println!("  FAIL  {role:<14} {port:<16} {fault}"),
            (None, None) => println!("  FAIL  {role:<14} {port:<16} no answer"),
        }
    }
    opened.instruments.iter().filter(|instrument| !instrument.ready).count()
}
