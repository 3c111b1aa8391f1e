//! The procedures of the product.

mod brake_hysteresis;
mod brake_poles;
mod brake_run;
mod brake_speed_independence;
mod brake_torque;
mod breakaway;
mod compensation;
mod constant_load;
mod demagnetise;
mod encoder;
mod findable;
mod friction;
mod friction_load;
mod friction_temperature;
mod identify_joint;
mod legs;
mod presliding;
mod puma_friction;
mod remaining;
mod remanence;
mod stiffness;
mod strokes;
mod torque_sensor_zero;
mod transmission_breakaway;
mod warm_up;

pub use brake_hysteresis::{brake_model, compared_brake};
pub use findable::Findable;
use findable::findable;

use crate::bench_facts::BenchFacts;
use crate::identification::{FollowUp, Identification};
use crate::parameter::{Parameter, Values};
use crate::plan::{Plan, PlanFault, Step};
use jointbench_instrument::{Kind, RunTable};
use serde_json::{Map, Value};

/// Why a run that compares two encoders cannot be resumed ([`Procedure::can_resume`]).
const ZERO_IS_LOST: &str = "the zero of the encoders is lost when an instrument is switched off";

/// Steps that were planned during their run.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedSteps {
    /// The dependent steps ([`crate::deferred_plan::DeferredPlan::to`]), planned anew.
    pub steps: Vec<Step>,
    /// The values that were used, in a sentence for the journal.
    pub message: String,
}

/// What a procedure is, and the form of its parameters.
#[derive(Debug)]
pub struct ProcedureInfo {
    /// Stable name in files, REST and on the command line: `brake_hysteresis`.
    pub id: &'static str,
    /// Name for people: `Brake hysteresis`.
    pub title: &'static str,
    /// One or two plain sentences for people.
    pub summary: &'static str,
    /// The kind of its run table.
    pub kind: Kind,
    /// Its parameters with units, defaults and ranges, in the order of the form.
    pub schema: &'static [Parameter],
}

/// A measurement method: it plans the steps of a run, and the engine performs them. Pure and deterministic: the same
/// parameters on the same bench give the same plan.
pub trait Procedure: Sync {
    /// What it is.
    fn info(&self) -> &'static ProcedureInfo;

    /// [`ProcedureInfo::id`].
    fn id(&self) -> &'static str {
        self.info().id
    }

    /// [`ProcedureInfo::title`].
    fn title(&self) -> &'static str {
        self.info().title
    }

    /// [`ProcedureInfo::summary`].
    fn summary(&self) -> &'static str {
        self.info().summary
    }

    /// [`ProcedureInfo::kind`].
    fn kind(&self) -> Kind {
        self.info().kind
    }

    /// [`ProcedureInfo::schema`].
    fn schema(&self) -> &'static [Parameter] {
        self.info().schema
    }

    /// Plans with checked values.
    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault>;
    /// Whether the models of its kind describe its run. False if the run shows something else, such as the zero of a
    /// sensor.
    fn is_modelled(&self) -> bool {
        true
    }
    /// The quantities that `identify` can return.
    fn finds(&self) -> Vec<Findable>;
    /// Result of a run of this procedure, with the values of its plan. Pure; a run that ended early or an unusable
    /// table gets a verdict too. `None`: the procedure only records samples.
    fn identify(&self, _values: &Values, _run: &RunTable) -> Option<Identification> {
        None
    }

    /// Plans the steps that depend on results of the run ([`Plan::deferred`]) from the rows so far. `Err` states why
    /// they are omitted.
    fn plan_deferred(&self, _run: &RunTable, _bench: &BenchFacts) -> Result<PlannedSteps, String> {
        Err(format!("{} has no steps that are planned during the run", self.title()))
    }

    /// The run that uses the results.
    fn follow_up(&self, _found: &Identification) -> Option<FollowUp> {
        None
    }

    /// The run of `brake_hysteresis` whose model it needs, 0 for the last one of the bench. `None`: it needs none.
    fn brake_model(&self, _values: &Values) -> Option<u32> {
        None
    }

    /// The run of `brake_hysteresis` of another brake, with which the result is compared. `None`: no comparison.
    fn compared_brake(&self, _values: &Values) -> Option<u32> {
        None
    }

    /// Whether the rest of an incomplete run may be measured in a later one. `Err` states which part of the history
    /// cannot be restored.
    fn can_resume(&self) -> Result<(), &'static str> {
        Ok(())
    }

    /// Checks the parameters against the schema, adds the defaults and plans, at a rate that suits the drive. Nothing
    /// moves.
    fn plan(&self, parameters: &Map<String, Value>, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let mut plan = self.build(&Values::parse(self.schema(), parameters)?, bench)?;
        if let Some(interval) = bench.setpoint_interval {
            plan.rate_hz = interval.suitable_rate_hz(plan.rate_hz);
            plan.meta.sample_rate_hz = Some(plan.rate_hz);
        }
        Ok(plan)
    }
}

/// Every procedure, in the order of lists.
pub fn catalogue() -> &'static [&'static dyn Procedure] {
    &[
        &friction::Friction,
        // The procedure for a Puma's bench is listed first there.
        &puma_friction::PumaFriction,
        &friction_load::FrictionLoad,
        &friction_temperature::FrictionTemperature,
        &brake_speed_independence::BrakeSpeedIndependence,
        &brake_hysteresis::BrakeHysteresis,
        &brake_torque::BrakeTorque,
        &constant_load::ConstantLoad,
        &demagnetise::Demagnetise,
        &brake_poles::BrakePoles,
        &torque_sensor_zero::TorqueSensorZero,
        &stiffness::Stiffness,
        &breakaway::Breakaway,
        &transmission_breakaway::TransmissionBreakaway,
        &presliding::Presliding,
        &compensation::Compensation,
        &strokes::Strokes,
        &warm_up::WarmUp,
        &identify_joint::IdentifyJoint,
        &encoder::EncoderOffset,
        &encoder::EncoderStartup,
        &encoder::EncoderDelay,
        &encoder::EncoderLinearity,
        &encoder::EncoderAlignment,
    ]
}

/// The procedure with this id.
pub fn procedure(id: &str) -> Option<&'static dyn Procedure> {
    catalogue().iter().copied().find(|procedure| procedure.id() == id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_unique_and_defaults_lie_in_their_range() {
        for procedure in catalogue() {
            assert_eq!(super::procedure(procedure.id()).unwrap().title(), procedure.title());
            for parameter in procedure.schema() {
                let inside = (parameter.min..=parameter.max).contains(&parameter.default);
                assert!(inside, "{} of {}", parameter.name, procedure.id());
            }
        }
        let mut ids: Vec<_> = catalogue().iter().map(|procedure| procedure.id()).collect();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), catalogue().len());
    }
}
