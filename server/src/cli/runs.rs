//! `jointbench runs`: lists the runs.

use super::arguments::Runs;
use super::exit::Done;
use super::print::json_out;
use super::serve::runtime;
use super::transfer::{Target, open};
use crate::lab::{LabError, Order, RunFilter};
use crate::view::{RunList, RunSummary, word};
use jiff::Timestamp;
use jiff::tz::TimeZone;
use jointbench_model::words;
use percent_encoding::{NON_ALPHANUMERIC, utf8_percent_encode};
use std::fmt::Display;

/// Header of the list. Times are local; the error is that of the last model version that is not idle.
const HEAD: &str =
    "  run  started (local)   state        procedure                 bench             duration       rows       error";
const BENCH: usize = 16;

/// For an unfinished run in a folder without a daemon.
const NO_DAEMON: &str =
    "its daemon has terminated: `jointbench serve` with this folder secures the bench and marks the run as interrupted";

pub fn runs(arguments: &Runs) -> Done {
    let runtime = runtime()?;
    let search = arguments.search.join(" ");
    let list: RunList = match open(&runtime, &arguments.store, false)? {
        Target::Folder(lab) => {
            let order =
                arguments.sort.as_deref().map(Order::parse).transpose().map_err(LabError::from)?.unwrap_or_default();
            let filter = RunFilter { limit: arguments.limit, offset: 0, search: Some(search.clone()), order };
            let mut list = runtime.block_on(lab.runs(&filter))?;
            for run in list.runs.iter_mut().filter(|run| !run.state.is_final()) {
                run.reason = Some(NO_DAEMON.to_owned());
            }
            list
        }
        Target::Daemon(client) => {
            let sort = arguments.sort.as_deref().map(|sort| format!("&sort={}", encoded(sort))).unwrap_or_default();
            client.get(&format!("/runs?limit={}&search={}{sort}", arguments.limit, encoded(&search)))?
        }
    };
    if arguments.json {
        return json_out(&list);
    }
    if !list.runs.is_empty() {
        println!("{HEAD}");
    }
    list.runs.iter().for_each(|run| println!("{}", line(run).trim_end()));
    let shown = list.runs.len() as u64;
    if shown < list.total {
        println!("{shown} of {}: --limit shows more", list.total);
    } else if shown == 0 {
        println!("no run{}", if search.is_empty() { "" } else { " matches" });
    }
    Ok(())
}

fn line(run: &RunSummary) -> String {
    let duration = run.duration_s.map(|s| format!("{s:.0} s")).unwrap_or_default();
    let day = local(&run.created_at, &TimeZone::system());
    let unit = run.unit.as_ref().map(|unit| format!("  unit {}", unit.line())).unwrap_or_default();
    let reason = run.damaged.as_ref().or(run.reason.as_ref()).map(|reason| format!("  {reason}")).unwrap_or_default();
    let not_stored = run.not_stored.as_ref().map(|why| format!("  not yet stored: {why}")).unwrap_or_default();
    let (id, state, procedure, rows) = (run.id, word(run.state), &run.procedure, run.rows);
    // The end of a long path is more useful than its beginning.
    let bench = match run.bench.chars().count().saturating_sub(BENCH) {
        0 => run.bench.clone(),
        more => std::iter::once('…').chain(run.bench.chars().skip(more + 1)).collect(),
    };
    let error = run.model.as_ref().map(|model| words::figure(model.validation_rms, &model.unit)).unwrap_or_default();
    format!(
        "{id:5}  {day}  {state:11}  {procedure:24}  {bench:BENCH$}  {duration:>7}  {rows:>9}  {error:>10}{unit}{reason}{not_stored}"
    )
}

/// Converts a time of the API (UTC) to local time.
pub(super) fn local(moment: &str, zone: &TimeZone) -> String {
    match moment.parse::<Timestamp>() {
        Ok(moment) => moment.to_zoned(zone.clone()).strftime("%Y-%m-%d %H:%M").to_string(),
        Err(_) => moment.to_owned(),
    }
}

/// URL-encodes a text.
pub(super) fn encoded(text: &str) -> impl Display {
    utf8_percent_encode(text, NON_ALPHANUMERIC)
}

#[cfg(test)]
mod tests {
    use super::{encoded, local};
    use jiff::tz::TimeZone;

    #[test]
    fn times_are_shown_in_local_time() {
        let tokyo = TimeZone::fixed(jiff::tz::offset(9));
        assert_eq!(local("2026-11-26T18:13:02.602Z", &tokyo), "2026-11-27 03:13");
        assert_eq!(local("", &tokyo), "");
    }

    #[test]
    fn a_search_may_stand_in_an_address() {
        assert_eq!(encoded("rows>10 tag:öl").to_string(), "rows%3E10%20tag%3A%C3%B6l");
    }
}
