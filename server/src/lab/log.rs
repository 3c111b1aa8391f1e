//! The log: safety records of the benches, events of runs, notes, model versions and tokens in one list.

use super::{Answer, Lab, LabError};
use crate::store::{CalibrationRecord, RunFilter, RunRecord, SafetyRecord};
use crate::view::{Effect, LogEntry, run_event};
use jiff::{SignedDuration, Timestamp};

/// Number of runs in one request.
const RUNS: u32 = 12;
/// Kind of the entries about tokens.
pub const OF_TOKENS: &str = "token";

impl Lab {
    /// Newest first: one run, or the newest runs, or those `before` one, with the entries of benches and tokens in that
    /// time.
    pub async fn log(&self, run: Option<i64>, before: Option<i64>) -> Answer<Vec<LogEntry>> {
        let store = &self.inner.store;
        let runs = match run {
            Some(run) => vec![store.run(run).await?],
            None => {
                let search = before.map(|before| format!("id<{before}"));
                store.runs(&RunFilter { limit: RUNS, search, ..RunFilter::default() }).await?.1
            }
        };
        let end = match before {
            Some(before) => Some(store.run(before).await?.created_at),
            None => None,
        };
        let begin = runs.last().filter(|oldest| oldest.id > 1).map(|oldest| &oldest.created_at);
        let meanwhile = |entry: &LogEntry| match run {
            Some(_) => entry.run == run,
            None => end.as_ref().is_none_or(|end| entry.at < *end) && begin.is_none_or(|begin| entry.at >= *begin),
        };
        let mut log = Vec::new();
        for bench in &self.inner.benches {
            let record = store.safety(bench.name(), u32::MAX).await?;
            log.extend(record.into_iter().map(|entry| of_bench(bench.name(), entry)));
            let applied = store.calibrations(bench.name()).await?;
            log.extend(applied.into_iter().map(|entry| applied_to(bench.name(), entry)));
        }
        log.extend(self.token_log().await?);
        log.retain(meanwhile);
        let effects = self.effects(None).await?;
        for run in &runs {
            self.add_run(run, &effects, &mut log).await?;
        }
        // Stable sort: entries of equal time keep their order.
        log.sort_by(|a, b| a.at.cmp(&b.at));
        log.reverse();
        Ok(log)
    }

    async fn add_run(&self, run: &RunRecord, effects: &[Effect], log: &mut Vec<LogEntry>) -> Answer<()> {
        let of_run = LogEntry {
            at: run.created_at.clone(),
            bench: Some(run.bench.clone()),
            run: Some(run.id),
            procedure: Some(run.procedure.clone()),
            ..LogEntry::default()
        };
        let (kind, text) = match run.procedure.as_str() {
            "import" => ("imported", "imported from a file"),
            _ => ("started", "started"),
        };
        let by = run.provenance.get("by").and_then(|by| by.as_str()).map(str::to_owned);
        log.push(LogEntry { kind: kind.into(), text: text.into(), by, ..of_run.clone() });
        if let Some(damaged) = &run.damaged {
            log.push(LogEntry { kind: "damaged".into(), text: damaged.clone(), grave: true, ..of_run });
            return Ok(());
        }
        for record in self.inner.store.events(run.id, 0).await? {
            let event = run_event(record);
            log.push(LogEntry {
                at: wall(run, event.at_s)?,
                grave: matches!(event.kind.as_str(), "fault" | "breach"),
                kind: event.kind,
                text: event.text,
                sequence: Some(event.sequence),
                at_s: Some(event.at_s),
                ..of_run.clone()
            });
        }
        for note in self.notes(run.id).await? {
            log.push(LogEntry {
                at: note.created_at,
                kind: "user_note".into(),
                text: note.text,
                note: Some(note.id),
                at_s: note.at_s,
                ..of_run.clone()
            });
        }
        self.add_versions(run, effects, &of_run, log).await
    }

    async fn add_versions(
        &self,
        run: &RunRecord,
        effects: &[Effect],
        of_run: &LogEntry,
        log: &mut Vec<LogEntry>,
    ) -> Answer<()> {
        let title = |id: &String| effects.iter().find(|one| one.id == *id).map_or(id.clone(), |one| one.title.clone());
        let titles = |ids: &[String]| ids.iter().map(title).collect::<Vec<_>>().join(", ");
        for version in self.inner.store.versions(run.id).await? {
            let mut changes = Vec::new();
            for (what, effects) in [("added", &version.added), ("removed", &version.removed)] {
                if !effects.is_empty() {
                    changes.push(format!("{} {what}", titles(effects)));
                }
            }
            let what = match (version.parent, changes.as_slice()) {
                (None, _) => format!("fitted: {}", titles(&version.added)),
                (Some(_), []) => "refitted".to_owned(),
                _ => changes.join("; "),
            };
            log.push(LogEntry {
                at: version.created_at,
                kind: "model".into(),
                text: format!("model {}, {what}", version.id),
                by: version.by,
                model: Some(version.id),
                ..of_run.clone()
            });
        }
        Ok(())
    }

    async fn token_log(&self) -> Answer<Vec<LogEntry>> {
        let entry = |(at, text, by): (String, String, String)| LogEntry {
            at,
            kind: OF_TOKENS.into(),
            text,
            by: Some(by),
            ..LogEntry::default()
        };
        Ok(self.inner.store.token_events().await?.into_iter().map(entry).collect())
    }
}

fn of_bench(bench: &str, entry: SafetyRecord) -> LogEntry {
    let kind = match (entry.blocked, entry.stopped) {
        (true, true) => "stopped",
        (true, false) => "blocked",
        (false, _) => "reset",
    };
    LogEntry {
        at: entry.at,
        kind: kind.into(),
        text: format!("{kind}: {}", entry.reason),
        by: entry.by,
        bench: Some(bench.to_owned()),
        run: entry.run,
        grave: entry.blocked,
        ..LogEntry::default()
    }
}

fn applied_to(bench: &str, entry: CalibrationRecord) -> LogEntry {
    let source = entry.run.map_or("the latest complete run".to_owned(), |run| format!("run {run}"));
    LogEntry {
        at: entry.at,
        kind: "calibration".into(),
        text: format!("{} of {source} applied to {bench}", entry.procedure),
        by: Some(entry.by),
        bench: Some(bench.to_owned()),
        run: entry.run,
        ..LogEntry::default()
    }
}

/// Wall-clock time of an event of a run.
fn wall(run: &RunRecord, at_s: f64) -> Answer<String> {
    let read = |text: &String| {
        text.parse::<Timestamp>().map_err(|fault| LabError::Internal(format!("run {} at {text}: {fault}", run.id)))
    };
    let at = read(&run.created_at)? + SignedDuration::from_secs_f64(at_s);
    let end = run.finished_at.as_ref().map(read).transpose()?;
    Ok(format!("{:.3}", end.map_or(at, |end| at.min(end))))
}
