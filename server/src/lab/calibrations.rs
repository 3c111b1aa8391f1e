//! Results that the next runs of a bench use. The brake's hysteresis is the one that a run is commanded with.

use super::{Answer, Lab, LabError};
use crate::view::{Calibration, Identified, NewCalibration};
use jointbench_procedure::RunState;

/// Whose result is used.
pub(super) const BRAKE_MODEL: &str = "brake_hysteresis";
/// More entries than a bench has in years.
const MOST: u32 = 500;

impl Lab {
    /// Newest first.
    pub async fn calibrations(&self, bench: &str) -> Answer<Vec<Calibration>> {
        self.handle(bench)?;
        let mut told: Vec<Calibration> = Vec::new();
        for record in self.inner.store.calibrations(bench, MOST).await? {
            let holds = !told.iter().any(|one| one.procedure == record.procedure);
            let (id, procedure, run, by, at) = (record.id, record.procedure, record.run, record.by, record.at);
            told.push(Calibration { id, procedure, run, by, at, holds });
        }
        Ok(told)
    }

    /// The next run uses it. Gives all entries, this one first.
    pub async fn calibrate(&self, bench: &str, new: &NewCalibration, by: &str) -> Answer<Vec<Calibration>> {
        let is_simulated = self.handle(bench)?.description().is_simulated();
        if new.procedure != BRAKE_MODEL {
            return Err(LabError::Invalid(format!(
                "no run uses what {} finds: {BRAKE_MODEL} is what can be applied to a bench",
                new.procedure
            )));
        }
        if let Some(id) = new.run {
            let record = self.inner.store.run(id).await?;
            if (record.bench.as_str(), record.procedure.as_str()) != (bench, BRAKE_MODEL) {
                return Err(LabError::Invalid(format!("run {id} is no {BRAKE_MODEL} of bench {bench}")));
            }
            if record.simulated != is_simulated {
                return Err(LabError::Invalid(format!(
                    "run {id} was not made on this {bench}: one of them is simulated"
                )));
            }
            let found = self.identification(id).await?.result.verdict;
            if record.state != RunState::Completed || found != Identified::Identified {
                return Err(LabError::Invalid(format!(
                    "run {id} has not identified what it was made for: apply one that has"
                )));
            }
        }
        self.inner.store.calibrate(bench, BRAKE_MODEL, new.run, by).await?;
        tracing::warn!(bench, procedure = BRAKE_MODEL, run.id = new.run, by, "applied to the bench");
        self.calibrations(bench).await
    }
}
