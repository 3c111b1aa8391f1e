//! A run as one page.

use super::{Answer, Lab, LabError};
use crate::report::Report;
use crate::view::Model;

impl Lab {
    /// Everything that is known of a run: what its procedure makes of it, its newest model and that model's diagnosis.
    pub async fn report(&self, id: i64) -> Answer<String> {
        let run = self.run(id).await?;
        let identification = match self.identification(id).await {
            Ok(found) => Some(found),
            Err(LabError::NotFound(_) | LabError::Invalid(_)) => None,
            Err(error) => return Err(error),
        };
        let journal = self.events(id, None).await?;
        let notes = journal.into_iter().filter(|event| event.kind == "note").map(|event| event.text).collect();
        let versions = lineage(self.models(id).await?);
        let diagnosis = match versions.last() {
            Some(newest) => self.diagnoses(newest.id).await?.pop(),
            None => None,
        };
        let report = Report { run, notes, identification, versions, diagnosis };
        tokio::task::spawn_blocking(move || report.html())
            .await
            .map_err(|fault| LabError::Internal(format!("the report of run {id} failed: {fault}")))
    }
}

/// The newest version and its forebears, the oldest first.
fn lineage(mut versions: Vec<Model>) -> Vec<Model> {
    let mut line: Vec<Model> = versions.pop().into_iter().collect();
    while let Some(parent) = line.last().and_then(|version| version.parent) {
        let Some(place) = versions.iter().position(|version| version.id == parent) else { break };
        line.push(versions.swap_remove(place));
    }
    line.reverse();
    line
}
