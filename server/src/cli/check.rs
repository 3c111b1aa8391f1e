//! `jointbench check`: checks description and instruments without motion.

use super::arguments::Check;
use super::exit::{Done, Exit};
use super::serve::describe;
use crate::bench::{InstrumentCheck, check_instruments, reach};
use crate::config::{BenchDescription, Description, READY_MADE, S3, unread};
use jiff::Zoned;
use jointbench_instrument::roles::Identity;
use std::path::Path;

/// The usual interval between two calibrations.
const LONG_AGO_DAYS: i32 = 366;

pub fn check(arguments: &Check) -> Done {
    if arguments.print {
        let text = match READY_MADE.iter().find(|(name, _)| *name == arguments.config) {
            Some((_, text)) => (*text).to_owned(),
            None => std::fs::read_to_string(&arguments.config).map_err(|fault| {
                let name = &arguments.config;
                Exit::bad_input(format!("{name}: {}", unread(name, &fault)))
            })?,
        };
        print!("{text}");
        return Ok(());
    }
    let Description { benches, notify, archive } = describe(&arguments.config)?;
    for target in &notify.targets {
        println!("notify {} ({}): description is valid", target.name, target.channel.kind());
    }
    if let Some(archive) = &archive {
        let is_there = archive.folder.starts_with(S3) || Path::new(&archive.folder).is_dir();
        let folder = if is_there { "" } else { ", but its folder does not exist" };
        println!("archive {}: description is valid{folder}", archive.url);
    }
    let not_ready: usize = benches.iter().map(check_bench).sum();
    match not_ready {
        0 => Ok(()),
        _ => Err(Exit::failed("not ready, see the failed instruments above")),
    }
}

/// Returns the number of instruments that are not ready.
fn check_bench(description: &BenchDescription) -> usize {
    let kind = if description.is_simulated() { "simulated" } else { "hardware" };
    println!("bench {} ({kind}): description is valid", description.name);
    let mut reached = match reach(description) {
        Ok(reached) => reached,
        Err(fault) => {
            println!("  FAIL  {fault}");
            return 1;
        }
    };
    let checks = check_instruments(&mut reached.slots);
    let mut not_ready = 0;
    for asked in &reached.slots.asked {
        let (role, port) = (asked.role, &asked.port);
        let seen = checks.iter().find(|check| check.role == role);
        let (mark, text) = match (&asked.identity, seen.map(|check| &check.state)) {
            (Err(fault), _) => ("FAIL", fault.to_string()),
            (Ok(who), Some(Err(why))) => ("FAIL", format!("{} {}, {why}", who.maker, who.model)),
            (Ok(who), _) => ("ok  ", named(who)),
        };
        not_ready += usize::from(mark == "FAIL");
        println!("  {mark}  {role:<18} {port:<16} {text}");
        let Some(InstrumentCheck { state, timing, .. }) = seen else { continue };
        if let Ok(state) = state {
            println!("        {:<18} {state}", "");
        }
        if let Some(timing) = timing {
            let [median_ms, longest_ms] = [timing.median, timing.longest].map(|taken| 1e3 * taken.as_secs_f64());
            let per_s = timing.per_s;
            println!(
                "        {:<18} {per_s:.0} readings/s, reply in {median_ms:.2} ms, at most {longest_ms:.2} ms",
                ""
            );
        }
    }
    calibrations(description);
    not_ready
}

fn named(who: &Identity) -> String {
    let details = [("serial", &who.serial), ("firmware", &who.firmware)];
    let details = details.into_iter().filter(|(_, value)| !value.is_empty());
    let details: String = details.map(|(name, value)| format!(", {name} {value}")).collect();
    format!("{} {}{details}", who.maker, who.model)
}

fn calibrations(description: &BenchDescription) {
    let today = Zoned::now().date();
    for (role, day) in &description.calibrated {
        let days = (today - *day).get_days();
        let cure = if days > LONG_AGO_DAYS { ": calibration overdue" } else { "" };
        println!("  note  {role:<18} calibrated {day}, {days} days ago{cure}");
    }
}
