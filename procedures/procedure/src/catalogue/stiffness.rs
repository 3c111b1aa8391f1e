//! Flexibility of the joint: load steps at constant speed in alternating direction.
//!
//! Loads rise from zero to the highest and fall again. The compliance of the bearing behind the joint is subtracted:
//! 1/k_joint = 1/k_measured − 1/k_bearing.

mod identify;
mod zones;

use super::legs::{ACCELERATION, Legs, sample_rate};
use super::{Findable, Procedure, ProcedureInfo, ZERO_IS_LOST, findable};
use crate::bench_facts::BenchFacts;
use crate::findings::verdict;
use crate::identification::Identification;
use crate::parameter::{Parameter, Values};
use crate::plan::{Plan, PlanFault};
use jointbench_instrument::{Kind, Meta, RunTable};

pub(super) struct Stiffness;

static INFO: ProcedureInfo = ProcedureInfo {
    id: "stiffness",
    title: "Stiffness",
    summary: "Loads the joint step by step in both directions and compares its two encoders. Identifies stiffness, \
              directional offset and nonlinearity.",
    kind: Kind::Stiffness,
    schema: &[
        Parameter::count("load_levels", "Load levels, including no load", 8, [3, 40]),
        Parameter::fraction("top_load", "Maximum brake current, relative to rated", 1.0, [0.05, 1.0]),
        Parameter::number("bearing_stiffness_nm_rad", "Bearing stiffness (0: unknown)", "Nm/rad", 0.0, [0.0, 1e9]),
        Parameter::number("speed_rad_s", "Speed (link)", "rad/s", 0.5, [0.11, 20.0]),
        Parameter::number("dwell_s", "Dwell time in each direction", "s", 1.5, [0.5, 60.0]),
        Parameter::count("repeats", "Repeats of the profile", 2, [2, 50]),
        ACCELERATION,
        sample_rate(250.0),
    ],
};

impl Procedure for Stiffness {
    fn info(&self) -> &'static ProcedureInfo {
        &INFO
    }

    fn can_resume(&self) -> Result<(), &'static str> {
        Err(ZERO_IS_LOST)
    }

    fn build(&self, values: &Values, bench: &BenchFacts) -> Result<Plan, PlanFault> {
        bench.check_load("connect it, because stiffness is torque per torsion")?;
        let rate_hz = values.number("sample_rate_hz");
        let speed_rad_s = values.number("speed_rad_s") * bench.constants.gear_ratio;
        let top_a = values.number("top_load") * bench.constants.brake_rated_current_a;
        let levels = values.count("load_levels");
        let level_a = |level: u32| top_a * f64::from(level) / f64::from(levels - 1);
        let dwell_s = values.number("dwell_s");
        let mut legs = Legs::new(values.number("acceleration_rad_s2"));
        for repeat in 0..values.count("repeats") {
            legs.repeat = repeat;
            let mut before_a = 0.0;
            for level in (0..levels).chain((0..levels - 1).rev()) {
                let current_a = level_a(level);
                if current_a != before_a {
                    legs.change(speed_rad_s, before_a, current_a);
                }
                legs.leg(speed_rad_s, dwell_s, current_a);
                legs.leg(-speed_rad_s, dwell_s, current_a);
                before_a = current_a;
            }
        }
        let bearing = values.number("bearing_stiffness_nm_rad");
        let meta = Meta {
            kind: Some(Kind::Stiffness),
            baseline: ["offset", "compliance", "directional_offset"].map(str::to_owned).into(),
            sample_rate_hz: Some(rate_hz),
            gear_ratio: Some(bench.constants.gear_ratio),
            bearing_stiffness_nm_per_rad: (bearing > 0.0).then_some(bearing),
            ..Meta::default()
        };
        Ok(legs.plan(self, values, meta, rate_hz))
    }

    fn finds(&self) -> Vec<Findable> {
        findable(&[
            ("rad/Nm", "inverse_k"),
            ("Nm/rad", "k k_1 k_2 k_3"),
            ("rad", "beta_0 xi hysteresis_width lost_motion line_rms rms"),
            ("J", "loop_area"),
        ])
    }

    fn identify(&self, _: &Values, run: &RunTable) -> Option<Identification> {
        verdict(identify::identify(run))
    }
}
