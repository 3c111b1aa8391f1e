//! Report of a run on one page.

use super::{Answer, Lab, LabError};
use crate::report::Report;
use crate::view::Model;

impl Lab {
    /// Result of the procedure, a model version and its diagnosis. The default `model` is the last version that is
    /// neither idle nor only tried.
    pub async fn report(&self, id: i64, model: Option<i64>) -> Answer<String> {
        let run = self.run(id).await?;
        let identification = match self.identification(id).await {
            Ok(found) => Some(found),
            Err(LabError::NotFound(_) | LabError::Invalid(_)) => None,
            Err(error) => return Err(error),
        };
        let journal = self.events(id, None).await?;
        let notes = journal.into_iter().filter(|event| event.kind == "note").map(|event| event.text).collect();
        let versions = lineage(self.models(id).await?, model);
        if let (Some(model), true) = (model, versions.is_empty()) {
            return Err(LabError::NotFound(format!("run {id} has no model {model}")));
        }
        let diagnosis = match versions.last() {
            Some(shown) => self.diagnoses(shown.id).await?.pop(),
            None => None,
        };
        let titles = self.effects(Some(&run.summary.kind)).await?.into_iter().map(|one| (one.id, one.title)).collect();
        let report = Report { run, notes, identification, versions, diagnosis, titles };
        tokio::task::spawn_blocking(move || report.html())
            .await
            .map_err(|fault| LabError::Internal(format!("the report of run {id} failed: {fault}")))
    }
}

/// A version and its ancestors, the oldest first. The default is the last version that is neither idle nor only tried.
fn lineage(mut versions: Vec<Model>, model: Option<i64>) -> Vec<Model> {
    let last =
        versions.iter().rposition(|version| model.map_or(!version.idle && !version.tried, |id| version.id == id));
    let mut line: Vec<Model> = last.map(|place| versions.remove(place)).into_iter().collect();
    while let Some(parent) = line.last().and_then(|version| version.parent) {
        let Some(place) = versions.iter().position(|version| version.id == parent) else { break };
        line.push(versions.swap_remove(place));
    }
    line.reverse();
    line
}
