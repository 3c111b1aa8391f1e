//! The status of a bench as views.

use super::status::Status;
use crate::config::BenchDescription;
use crate::view;
use jiff::Timestamp;
use jointbench_instrument::limits::Limited;

pub fn bench_view(description: &BenchDescription, status: &Status) -> view::Bench {
    let constants = description.constants;
    view::Bench {
        name: description.name.clone(),
        simulated: description.is_simulated(),
        state: status.state,
        blocked: status.blocked.clone(),
        run: status.run,
        instruments: status.instruments.clone(),
        limits: Limited::ALL
            .iter()
            .map(|quantity| view::Limit {
                quantity: quantity.name().to_owned(),
                unit: quantity.unit().to_owned(),
                limit: description.limits.of(*quantity),
                value: status.reading(*quantity),
            })
            .collect(),
        unstored: (status.unstored.rows > 0 || status.unstored.fault.is_some()).then(|| view::Unstored {
            rows: status.unstored.rows as u64,
            since: status.unstored.since.map(|since| format!("{since:.3}")),
            fault: status.unstored.fault.clone(),
        }),
        channels: status.channels.iter().map(|channel| channel.view(Timestamp::now())).collect(),
        constants: view::Constants {
            torque_constant_nm_per_a: constants.torque_constant_nm_per_a,
            gear_ratio: constants.gear_ratio,
            rotor_inertia_kg_m2: constants.rotor_inertia_kg_m2,
            brake_compliance_v: constants.brake_compliance_v,
            brake_rated_current_a: constants.brake_rated_current_a,
            brake_rated_torque_nm: constants.brake_rated_torque_nm,
            link_range_rad: constants.link_range_rad,
            load_gear_ratio: constants.load_gear_ratio,
        },
    }
}

/// Shows a run whose end is not stored with the state of its worker.
pub fn show_unstored_end(run: &mut view::RunSummary, status: &Status) {
    let Some((active, fault)) = status.not_stored(run.id) else { return };
    run.state = active.state;
    run.safe = active.safe;
    run.reason = active.reason.clone();
    run.not_stored = Some(fault.to_owned());
}
