//! Results that the next runs of a bench use: the brake hysteresis for brake commands, the zero of the torque sensor,
//! which is subtracted, and the friction for planning its compensation.

use super::{Answer, Lab, LabError};
use crate::view::{Applies, Calibration, NewCalibration};
use jointbench_procedure::{Procedure, RunState};
use serde_json::{Map, Value};

/// Procedure whose result is used for brake commands.
pub(super) const BRAKE_MODEL: &str = "brake_hysteresis";
const SENSOR_ZERO: &str = "torque_sensor_zero";
const FRICTION: &str = "friction";
/// Applicable procedures and the use of their results.
const USES: [(&str, &str); 3] = [
    (BRAKE_MODEL, "subsequent runs of this bench use this brake model"),
    (
        SENSOR_ZERO,
        "subsequent runs of this bench subtract this zero from the torque; the stored samples remain \
                   uncorrected",
    ),
    (FRICTION, "friction compensation on this bench uses these values by default"),
];

/// The use of a procedure's result after it is applied, or why it cannot be applied; empty if no procedure uses it.
pub(super) fn applies(procedure: &str) -> Applies {
    match USES.iter().find(|(id, _)| *id == procedure) {
        Some((_, what)) => Applies { can: true, what: (*what).to_owned() },
        None => Applies { can: false, what: why_not(procedure).to_owned() },
    }
}

fn why_not(procedure: &str) -> &'static str {
    match procedure {
        "encoder_linearity" => {
            "Load the table into the controller that reads this encoder. The bench itself keeps measuring \
             uncompensated."
        }
        "identify_joint" => {
            "Cannot be applied as a whole: run friction or torque_sensor_zero separately and apply its \
                             result."
        }
        _ => "",
    }
}

impl Lab {
    /// Newest first.
    pub async fn calibrations(&self, bench: &str) -> Answer<Vec<Calibration>> {
        self.handle(bench)?;
        let mut calibrations: Vec<Calibration> = Vec::new();
        for record in self.inner.store.calibrations(bench).await? {
            let holds = !calibrations.iter().any(|one| one.procedure == record.procedure);
            let (id, procedure, run, by, at) = (record.id, record.procedure, record.run, record.by, record.at);
            calibrations.push(Calibration { id, procedure, run, by, at, holds });
        }
        Ok(calibrations)
    }

    /// Applies a run to the next runs. Returns all entries, the new one first.
    pub async fn calibrate(&self, bench: &str, new: &NewCalibration, by: &str) -> Answer<Vec<Calibration>> {
        let is_simulated = self.handle(bench)?.description().is_simulated();
        let wanted = new.procedure.as_str();
        if !applies(wanted).can {
            let can = USES.map(|(id, _)| id).join(", ");
            return Err(LabError::Invalid(format!(
                "results of {wanted} cannot be applied to a bench; applicable: {can}"
            )));
        }
        if let Some(id) = new.run {
            let record = self.inner.store.run(id).await?;
            if (record.bench.as_str(), record.procedure.as_str()) != (bench, wanted) {
                return Err(LabError::Invalid(format!("run {id} is not a {wanted} run of bench {bench}")));
            }
            if record.simulated != is_simulated {
                return Err(LabError::Invalid(format!(
                    "run {id} does not belong to this {bench}: one of them is simulated"
                )));
            }
            let found = self.identification(id).await?.result.verdict;
            if record.state != RunState::Completed || !found.is_identified() {
                return Err(LabError::Invalid(format!(
                    "run {id} has no identified result: apply a run with an identified result"
                )));
            }
        }
        self.inner.store.calibrate(bench, wanted, new.run, by).await?;
        tracing::warn!(bench, procedure = wanted, run.id = new.run, by, "applied to the bench");
        self.calibrations(bench).await
    }

    /// Parameters of a procedure from the bench's applied friction run, and that run.
    pub(super) async fn applied_choices(&self, bench: &str, id: &str) -> Answer<Option<(i64, Map<String, Value>)>> {
        let Some(run) = self.inner.store.calibration(bench, FRICTION).await? else { return Ok(None) };
        let Some(next) = self.follow_up(run).await?.filter(|next| next.procedure == id) else { return Ok(None) };
        Ok(Some((run, next.parameters)))
    }

    /// The zero to subtract from the torque in a run of this procedure. `None` if the procedure measures the zero
    /// itself.
    pub(super) async fn applied_zero(&self, bench: &str, of: &dyn Procedure) -> Answer<Option<(i64, f64)>> {
        let parts = of.finds();
        if parts.iter().any(|found| found.name.rsplit('.').next() == Some("zero")) {
            return Ok(None);
        }
        let Some(run) = self.inner.store.calibration(bench, SENSOR_ZERO).await? else { return Ok(None) };
        Ok(self.quantities(run).await?.into_iter().find(|one| one.name == "zero").map(|zero| (run, zero.value)))
    }
}
