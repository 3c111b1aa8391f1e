//! What a procedure makes of a run that is kept.

use super::{Answer, Lab, LabError, reread};
use crate::view::Identification;
use jointbench_procedure::parameter::Values;

impl Lab {
    /// Worked out anew from the samples, so that it is always the present code's; `None` where the procedure asks nothing of
    /// its run but samples.
    pub async fn identification(&self, id: i64) -> Answer<Identification> {
        let record = self.inner.store.run(id).await?;
        let none = || {
            LabError::NotFound(format!(
                "run {id} ({}) has no result of a procedure: fit a model to it instead",
                record.procedure
            ))
        };
        let procedure = jointbench_procedure::procedure(&record.procedure).ok_or_else(none)?;
        let values = Values::parse(procedure.schema(), &record.parameters)
            .map_err(|fault| LabError::Invalid(format!("run {id} was made by another version: {fault}")))?;
        let table = self.measurement(id).await?;
        let runs = self.together(id).await?;
        let mut found = tokio::task::spawn_blocking(move || procedure.identify(&values, &table))
            .await
            .map_err(|fault| LabError::Internal(format!("the identification of run {id} failed: {fault}")))?
            .ok_or_else(none)?
            .of_run(id, record.state, procedure.goes_on().is_ok());
        if let [before @ .., last] = runs.as_slice()
            && !before.is_empty()
        {
            let before: Vec<String> = before.iter().map(i64::to_string).collect();
            found.summary = format!("Runs {} and {last} together: {}", before.join(", "), found.summary);
        }
        Ok(Identification {
            run: id,
            procedure: record.procedure,
            software: concat!("jointbench ", env!("CARGO_PKG_VERSION")).to_owned(),
            follow_up: procedure.follow_up(&found).map(|next| reread(&next)).transpose()?,
            result: reread(&found)?,
        })
    }
}
