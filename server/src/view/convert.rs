//! Converts records of the store and types of the lower crates to views.

use crate::store::{DiagnosisRecord, EventRecord, ModelRecord, RunRecord, SafetyRecord};
use crate::view::{self, AxisKind};
use jointbench_instrument::Motion;
use jointbench_model::Axis;
use jointbench_procedure::{Control, EventKind, RunState};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

/// A value that is not valid in a view, such as NaN.
#[derive(Debug, Clone, thiserror::Error)]
#[error("{0}")]
pub struct ConversionError(String);

/// Converts a type to another through JSON. NaN becomes `null`, which a number refuses, so non-finite values cause an
/// error.
pub fn reread<T: Serialize, U: DeserializeOwned>(value: &T) -> Result<U, ConversionError> {
    let json = serde_json::to_value(value).map_err(|fault| ConversionError(fault.to_string()))?;
    serde_json::from_value(json)
        .map_err(|fault| ConversionError(format!("a result is not finite or not whole: {fault}")))
}

pub fn safety_entry(record: SafetyRecord) -> view::SafetyEntry {
    let SafetyRecord { blocked, stopped, reason, run, by, at } = record;
    view::SafetyEntry { blocked, stopped, reason, run, by, at }
}

pub fn run_summary(record: &RunRecord) -> view::RunSummary {
    let is_modelled =
        jointbench_procedure::procedure(&record.procedure).is_none_or(|procedure| procedure.is_modelled());
    view::RunSummary {
        id: record.id,
        bench: record.bench.clone(),
        procedure: record.procedure.clone(),
        kind: record.kind.clone(),
        state: record.state,
        safe: record.safe,
        reason: record.reason.clone(),
        created_at: record.created_at.clone(),
        finished_at: record.finished_at.clone(),
        rows: record.rows,
        duration_s: record.duration_s.and_then(view::finite),
        simulated: record.simulated,
        by: record.provenance.get("by").and_then(Value::as_str).map(str::to_owned),
        unit: record.unit.clone(),
        operator: record.operator.clone(),
        tags: record.tags.clone(),
        note: record.note.clone(),
        verdict: record.verdict.as_ref().and_then(|verdict| reread(verdict).ok()),
        limits: record.limits.as_ref().and_then(|outcome| reread(outcome).ok()),
        // An unreadable model is omitted.
        is_modelled,
        model: record.model.as_ref().filter(|_| is_modelled).and_then(|model| reread(model).ok()),
        not_stored: None,
        damaged: record.damaged.clone(),
    }
}

pub fn run_view(record: RunRecord, progress: Option<view::Progress>) -> view::Run {
    let motion: Motion = record.meta.get("motion").and_then(|motion| reread(motion).ok()).unwrap_or_default();
    let channel = |channel| {
        let info = view::ChannelInfo::from(channel);
        view::ChannelInfo { unit: info.unit.map(|unit| motion.label(&unit)), ..info }
    };
    view::Run {
        summary: run_summary(&record),
        channels: record.channels.iter().map(channel).collect(),
        parameters: record.parameters,
        provenance: record.provenance,
        meta: record.meta,
        progress,
        archive: Vec::new(),
    }
}

/// An event with its key and its sentence.
pub fn run_event(record: EventRecord) -> view::RunEvent {
    let EventRecord { sequence, at_s, kind, data } = record;
    let mut whole = data.clone();
    whole.insert("kind".to_owned(), Value::from(kind.clone()));
    let (subject, text) = match serde_json::from_value::<EventKind>(Value::Object(whole)) {
        Ok(event) => (subject(&event), sentence(&event)),
        Err(_) if kind == "damaged" => {
            (sequence.to_string(), data.get("text").and_then(Value::as_str).unwrap_or_default().to_owned())
        }
        // An event of another version.
        Err(_) => (sequence.to_string(), kind.replace('_', " ")),
    };
    view::RunEvent { sequence, at_s, key: format!("{kind}/{subject}"), kind, text, data }
}

/// What distinguishes an event from others of its kind. Equal in runs of the same plan.
fn subject(kind: &EventKind) -> String {
    match kind {
        EventKind::State { state, .. } => view::word(state),
        EventKind::Identified { instrument, .. } => instrument.clone(),
        EventKind::StepStarted { label, repeat, .. } => format!("{label}/{repeat}"),
        EventKind::StepFinished { step, .. } => step.to_string(),
        EventKind::Control { control, .. } => view::word(control),
        EventKind::Fault { fault, .. } => fault.to_string(),
        EventKind::Breach { breach } => breach.to_string(),
        EventKind::Note { text } | EventKind::Warning { text } => text.clone(),
        EventKind::Safe { safe } => view::word(safe),
    }
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
                Control::Abandon => "no client controls the run".to_owned(),
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

pub fn model_view(record: ModelRecord) -> Result<view::Model, ConversionError> {
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

/// The lists are moved, because they are long. An unknown value is refused.
pub fn residual_set(left: jointbench_model::ResidualSet) -> Result<view::ResidualSet, ConversionError> {
    let jointbench_model::ResidualSet {
        residual,
        unit,
        axes,
        measured,
        predicted,
        error,
        held_out,
        segment,
        repeat,
        piece,
    } = left;
    let lists = axes.iter().map(|axis| &axis.values).chain([&measured, &predicted, &error]);
    if lists.flatten().any(|value| !value.is_finite()) {
        return Err(ConversionError("the residuals are not finite".to_owned()));
    }
    let axis = |Axis { name, unit, values }| view::ResidualAxis { kind: AxisKind::of(&name), name, unit, values };
    let axes = axes.into_iter().map(axis).collect();
    let excluded = Vec::new();
    Ok(view::ResidualSet {
        residual,
        unit,
        axes,
        measured,
        predicted,
        error,
        held_out,
        excluded,
        segment,
        repeat,
        piece,
    })
}

pub fn diagnosis_view(record: DiagnosisRecord, run: i64) -> Result<view::Diagnosis, ConversionError> {
    Ok(view::Diagnosis {
        id: record.id,
        model_id: record.model,
        run,
        created_at: record.created_at,
        finding: reread::<_, view::Finding>(&record.diagnosis)?.bounded(),
    })
}
