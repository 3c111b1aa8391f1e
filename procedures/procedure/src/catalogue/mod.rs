//! The procedures that the product knows.

mod brake_hysteresis;
mod brake_run;
mod brake_speed_independence;
mod brake_torque;
mod breakaway;
mod compensation;
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
mod rest;
mod stiffness;
mod strokes;
mod torque_sensor_zero;
mod warm_up;

pub use brake_hysteresis::{BrakeModel, brake_model};
pub use findable::Findable;
use findable::findable;

use crate::identification::{FollowUp, Identification};
use crate::parameter::{Parameter, Values};
use crate::plan::{BenchFacts, Plan, PlanFault, Step};
use jointbench_instrument::{Kind, RunTable};
use serde_json::{Map, Value};

/// Steps planned while their run is on.
#[derive(Debug, Clone, PartialEq)]
pub struct Learnt {
    pub steps: Vec<Step>,
    /// With what, in a sentence for the journal.
    pub said: String,
}

/// Decides what a bench shall do; the engine does it. Pure and deterministic: the same choices on the same bench give
/// the same plan.
pub trait Procedure: Sync {
    fn id(&self) -> &'static str;
    fn title(&self) -> &'static str;
    /// One or two plain sentences.
    fn summary(&self) -> &'static str;
    /// The kind of run table that it brings.
    fn kind(&self) -> Kind;
    fn schema(&self) -> &'static [Parameter];
    /// Plans with checked values.
    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault>;
    /// Whether the models of its kind describe its run. Not where the run shows something else, such as the zero of a sensor.
    fn is_modelled(&self) -> bool {
        true
    }
    /// What `identify` may find.
    fn finds(&self) -> Vec<Findable>;
    /// What a run of this procedure shows, with the values that it was planned with. Pure; a run that ended early or a
    /// table that says nothing gets its verdict too. `None`: nothing but samples is asked of it.
    fn identify(&self, _values: &Values, _run: &RunTable) -> Option<Identification> {
        None
    }

    /// The steps that wait for what the run finds ([`Plan::lesson`]), planned from what it has measured so far. `Err` says
    /// why they are left out.
    fn learn(&self, _run: &RunTable, _bench: &BenchFacts) -> Result<Learnt, String> {
        Err(format!("{} has no steps that are planned during the run", self.title()))
    }

    /// The run that uses what was found.
    fn follow_up(&self, _found: &Identification) -> Option<FollowUp> {
        None
    }

    /// The run of `brake_hysteresis` whose model it needs, 0 for the last one of the bench. `None`: it needs none.
    fn brake_model(&self, _values: &Values) -> Option<u32> {
        None
    }

    /// Whether what is left of a run that did not come to its end may be made in another one later. `Err` says what of the
    /// first run's history cannot be had again.
    fn goes_on(&self) -> Result<(), &'static str> {
        Ok(())
    }

    /// Checks the choices against the schema, fills in the defaults and plans. Nothing moves.
    fn plan(&self, parameters: &Map<String, Value>, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        self.build(&Values::parse(self.schema(), parameters)?, bench)
    }
}

/// Every procedure, in the order in which a list shows them.
pub fn catalogue() -> &'static [&'static dyn Procedure] {
    &[
        &friction::Friction,
        // What a Puma's bench can make comes first there.
        &puma_friction::PumaFriction,
        &friction_load::FrictionLoad,
        &friction_temperature::FrictionTemperature,
        &brake_speed_independence::BrakeSpeedIndependence,
        &brake_hysteresis::BrakeHysteresis,
        &brake_torque::BrakeTorque,
        &demagnetise::Demagnetise,
        &torque_sensor_zero::TorqueSensorZero,
        &stiffness::Stiffness,
        &breakaway::Breakaway,
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
        ids.dedup();
        assert_eq!(ids.len(), catalogue().len());
    }
}
