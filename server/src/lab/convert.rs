//! Converts records of the store and types of the lower crates to views.

use super::LabError;
use crate::bench::Status;
use crate::config::BenchDescription;
use crate::store::{DiagnosisRecord, EventRecord, ModelRecord, RunRecord, SafetyRecord};
use crate::view;
use jiff::Timestamp;
use jointbench_instrument::Motion;
use jointbench_instrument::limits::Limited;
use jointbench_procedure::{Control, EventKind, RunState, Safe};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

/// Converts a type to another through JSON. NaN becomes `null`, which a number refuses, so non-finite values cause an
/// error.
pub fn reread<T: Serialize, U: DeserializeOwned>(value: &T) -> Result<U, LabError> {
    let json = serde_json::to_value(value).map_err(|fault| LabError::Internal(fault.to_string()))?;
    serde_json::from_value(json)
        .map_err(|fault| LabError::Internal(format!("a result is not finite or not whole: {fault}")))
}

pub fn state_view(state: RunState) -> view::RunState {
    match state {
        RunState::Queued => view::RunState::Queued,
        RunState::Arming => view::RunState::Arming,
        RunState::Running => view::RunState::Running,
        RunState::Paused => view::RunState::Paused,
        RunState::Securing => view::RunState::Securing,
        RunState::Completed => view::RunState::Completed,
        RunState::Stopped => view::RunState::Stopped,
        RunState::Aborted => view::RunState::Aborted,
        RunState::Failed => view::RunState::Failed,
        RunState::Interrupted => view::RunState::Interrupted,
    }
}

pub fn safe_view(safe: Safe) -> view::Safe {
    match safe {
        Safe::SafeVerified => view::Safe::SafeVerified,
        Safe::SafeCommanded => view::Safe::SafeCommanded,
        Safe::UnsafeUnknown => view::Safe::UnsafeUnknown,
    }
}

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
        channels: status.channels.iter().map(|channel| channel.told(Timestamp::now())).collect(),
        constants: view::Constants {
            torque_constant_nm_per_a: constants.torque_constant_nm_per_a,
            gear_ratio: constants.gear_ratio,
            rotor_inertia_kg_m2: constants.rotor_inertia_kg_m2,
            brake_compliance_v: constants.brake_compliance_v,
            brake_rated_current_a: constants.brake_rated_current_a,
            brake_rated_torque_nm: constants.brake_rated_torque_nm,
            link_range_rad: constants.link_range_rad,
        },
    }
}

pub(super) fn safety_entry(record: SafetyRecord) -> view::SafetyEntry {
    let SafetyRecord { blocked, stopped, reason, run, by, at } = record;
    view::SafetyEntry { blocked, stopped, reason, run, by, at }
}

pub(super) fn summary(record: &RunRecord) -> view::RunSummary {
    let is_modelled =
        jointbench_procedure::procedure(&record.procedure).is_none_or(|procedure| procedure.is_modelled());
    view::RunSummary {
        id: record.id,
        bench: record.bench.clone(),
        procedure: record.procedure.clone(),
        kind: record.kind.clone(),
        state: state_view(record.state),
        safe: record.safe.map(safe_view),
        reason: record.reason.clone(),
        created_at: record.created_at.clone(),
        finished_at: record.finished_at.clone(),
        rows: record.rows,
        duration_s: record.duration_s.and_then(view::finite),
        simulated: record.simulated,
        by: record.provenance.get("by").and_then(Value::as_str).map(str::to_owned),
        tags: record.tags.clone(),
        note: record.note.clone(),
        verdict: record.verdict.as_ref().and_then(|verdict| reread(verdict).ok()),
        // An unreadable model is omitted.
        is_modelled,
        model: record.model.as_ref().filter(|_| is_modelled).and_then(|model| reread(model).ok()),
        not_stored: None,
        damaged: record.damaged.clone(),
    }
}

/// A run whose end is not stored is shown with the state of its worker.
pub(super) fn as_it_is(run: &mut view::RunSummary, status: &Status) {
    let Some((underway, fault)) = status.not_stored(run.id) else { return };
    run.state = state_view(underway.state);
    run.safe = underway.safe.map(safe_view);
    run.reason = underway.reason.clone();
    run.not_stored = Some(fault.to_owned());
}

pub(super) fn run(record: RunRecord, progress: Option<view::Progress>) -> view::Run {
    let motion: Motion = record.meta.get("motion").and_then(|motion| reread(motion).ok()).unwrap_or_default();
    let channel = |channel| {
        let told = view::ChannelInfo::from(channel);
        view::ChannelInfo { unit: told.unit.map(|unit| motion.label(&unit)), ..told }
    };
    view::Run {
        summary: summary(&record),
        channels: record.channels.iter().map(channel).collect(),
        parameters: record.parameters,
        provenance: record.provenance,
        meta: record.meta,
        progress,
    }
}

/// An event with its sentence.
pub fn run_event(record: EventRecord) -> view::RunEvent {
    let mut whole = record.data.clone();
    whole.insert("kind".to_owned(), Value::from(record.kind.clone()));
    let text = match serde_json::from_value::<EventKind>(Value::Object(whole)) {
        Ok(kind) => sentence(&kind),
        Err(_) if record.kind == "damaged" => {
            record.data.get("text").and_then(Value::as_str).unwrap_or_default().to_owned()
        }
        // An event of another version.
        Err(_) => record.kind.replace('_', " "),
    };
    view::RunEvent { sequence: record.sequence, at_s: record.at_s, kind: record.kind, text, data: record.data }
}

fn sentence(kind: &EventKind) -> String {
    match kind {
        EventKind::State { state: RunState::Securing, .. } => "moving to safe state".to_owned(),
        EventKind::State { state, .. } if !state.is_final() => state.to_string(),
        EventKind::State { state, .. } => format!("run {state}"),
        EventKind::Identified { instrument, port, identity } => {
            let firmware = match identity.firmware.as_str() {
                "" => String::new(),
                version => format!(", firmware {version}"),
            };
            format!("{instrument} on {port}: {} {}{firmware}", identity.maker, identity.model)
        }
        EventKind::StepStarted { label, repeat, .. } => format!("{label} (repeat {})", repeat + 1),
        EventKind::StepFinished { step, rows, .. } => format!("step {} done, {rows} rows", step + 1),
        EventKind::Control { control: Control::Quit, .. } => "daemon shutdown requested".to_owned(),
        EventKind::Control { control: Control::StorageLost, .. } => {
            "the storage process of the daemon terminated".to_owned()
        }
        EventKind::Control { control, by } => {
            let asked = match control {
                Control::EStop => "software stop pressed".to_owned(),
                _ => format!("operator command: {}", view::word(control)),
            };
            by.iter().fold(asked, |asked, by| format!("{asked} ({by})"))
        }
        EventKind::Fault { fault, recovered: true } => format!("{fault}; recovered"),
        EventKind::Fault { fault, recovered: false } => fault.to_string(),
        EventKind::Breach { breach } => breach.to_string(),
        EventKind::Note { text } | EventKind::Warning { text } => text.clone(),
        EventKind::Safe { safe } => format!("bench {safe}"),
    }
}

pub(super) fn model(record: ModelRecord) -> Result<view::Model, LabError> {
    Ok(view::Model {
        id: record.id,
        run: record.run,
        more_runs: record.more_runs,
        excluded: reread(&record.excluded)?,
        kind: record.kind,
        parent: record.parent,
        added: record.added,
        removed: record.removed,
        effects: record.effects,
        fit: reread(&record.fit)?,
        residual: reread(&record.residual)?,
        validation_rms: record.validation_rms,
        rms: record.rms,
        noise_floor_rms: record.noise_floor_rms,
        idle: record.idle,
        tried: record.tried,
        by: record.by,
        created_at: record.created_at,
        options: record.options,
    })
}

pub(super) fn diagnosis(record: DiagnosisRecord, run: i64) -> Result<view::Diagnosis, LabError> {
    Ok(view::Diagnosis {
        id: record.id,
        model_id: record.model,
        run,
        created_at: record.created_at,
        finding: reread(&record.diagnosis)?,
    })
}
