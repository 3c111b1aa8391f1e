//! Presliding friction: the motor current oscillates below breakaway, at several amplitudes.
//!
//! Every oscillation begins after a stroke in the same direction and a rest without torque. The contacts then start
//! from the same state. The torque is commanded, and the motor encoder measures the displacement. The joint moves by
//! only a few counts, so that the times at which a reading changes are evaluated.

use super::breakaway::ramps::REST_S;
use super::compensation;
use super::legs::{ACCELERATION, Legs, sample_rate};
use super::{Findable, Procedure, ProcedureInfo, findable};
use crate::bench_facts::BenchFacts;
use crate::findings::verdict;
use crate::identification::{FollowUp, Identification};
use crate::parameter::{Parameter, Values};
use crate::plan::{Drive, EndCondition, Plan, PlanFault};
use crate::profile::Profile;
use jointbench_instrument::{Kind, RunTable};

mod dahl;
mod damping;
mod identify;
mod loops;

pub(super) struct Presliding;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "presliding",
    title: "Presliding",
    summary: "Oscillates the motor current below breakaway at several amplitudes. The hysteresis loops give the \
              presliding stiffness.",
    kind: Kind::Friction,
    schema: &[
        Parameter::number("top_torque_nm", "Maximum amplitude, below breakaway (motor)", "Nm", 0.028, [1e-4, 100.0]),
        Parameter::count("amplitudes", "Number of amplitudes, evenly spaced up to the maximum", 4, [2, 20]),
        Parameter::count("swings", "Cycles at each amplitude", 3, [1, 50]),
        Parameter::number("period_s", "Period of a cycle", "s", 8.0, [0.2, 600.0]),
        Parameter::count("repeats", "Repeats of the profile, each at different positions", 4, [2, 50]),
        ACCELERATION,
        sample_rate(250.0),
    ],
};

/// The stroke before an oscillation (motor), long enough to renew every contact.
const STROKE_RAD: f64 = 1.3;
const STROKE_RAD_S: f64 = 10.0;
const FURTHER: f64 = 1e-3;
/// Limits of a breakaway: this number of consecutive increases, or this motor speed.
const UNTIL: EndCondition = EndCondition { increases: 50, speed_rad_s: 10.0 };

impl Procedure for Presliding {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        let rate_hz = values.number("sample_rate_hz");
        let top_a = values.number("top_torque_nm") / bench.constants.torque_constant_nm_per_a;
        let quarter_s = 0.25 * values.number("period_s");
        let amplitudes = values.count("amplitudes");
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        let dwell_s = STROKE_RAD / STROKE_RAD_S;
        for repeat in 0..values.count("repeats") {
            legs.repeat = repeat;
            for amplitude in 1..=amplitudes {
                let share = f64::from(amplitude) / f64::from(amplitudes);
                let mut current_a = Profile::from(0.0).hold(REST_S);
                for _ in 0..values.count("swings") {
                    current_a =
                        current_a.to(share * top_a, quarter_s).to(-share * top_a, 2.0 * quarter_s).to(0.0, quarter_s);
                }
                // Out and back, and a little farther each time, so that the oscillations cover different parts of a
                // count.
                let further = 1.0 + FURTHER * f64::from(repeat * amplitudes + amplitude);
                let out = Profile::plateau(-STROKE_RAD_S, legs.acceleration_rad_s2, dwell_s);
                let back = Profile::plateau(STROKE_RAD_S, legs.acceleration_rad_s2, dwell_s * further);
                legs.push("stroke".into(), out, Profile::constant(0.0));
                let from_s = back.duration_s() + REST_S;
                legs.push(
                    format!("cycles at {:.0} % of the maximum torque", 100.0 * share),
                    back,
                    Profile::constant(0.0),
                );
                legs.drive_of_last(Drive::Current { from_s, current_a, until: UNTIL });
            }
        }
        // The velocity loop holds the joint after the last oscillation before the run ends.
        legs.push("rest".into(), Profile::from(0.0).hold(REST_S), Profile::constant(0.0));
        Ok(legs.friction_plan(self, values, bench, rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[
            ("Nm/rad", "sigma_0 element_#_stiffness"),
            ("Nm", "tau_c bias element_#_slip"),
            ("rad", "reach"),
            ("Nm·s/rad", "sigma_1 sigma_1_most"),
        ])
    }

    fn follow_up(&self, found: &Identification) -> Option<FollowUp> {
        compensation::of_presliding(found)
    }

    fn identify(&self, values: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify::identify(values, run))
    }
}
