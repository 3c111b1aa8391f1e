//! Runs: start, observe, control.

use super::extract::{Answer, Created, Json, Path, Query, created};
use super::problem::Problem;
use super::refusals::{File, Refusals};
use super::transfer::streamed;
use crate::lab::{ARROW_STREAM, Alignment, Caller, Encoding, ExportRequest, Lab, LabError, Order, RunFilter};
use crate::view::{ChannelStatistics, Figure, Lease, NewRun, Preview, QueueEntry, Run, RunEvent, RunList, Samples};
use axum::Extension;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use jointbench_procedure::Control;
use serde::Deserialize;
use utoipa::IntoParams;

#[derive(Debug, Clone, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(default, deny_unknown_fields)]
pub struct RunQuery {
    /// Maximum number of runs; 50 if omitted, at most 500.
    #[param(maximum = 500)]
    pub limit: Option<u32>,
    /// Number of newest runs to skip.
    pub offset: Option<u32>,
    /// Words, and terms such as `kind:friction`, `unit:SN123`, `tag:oil`, `-state:failed`, `duration>2min`,
    /// `after:2026-01-31`; all must match.
    pub search: Option<String>,
    /// Sort column: `started`, `state`, `procedure`, `bench`, `duration`, `rows`, `safe`, `error` (validation error of
    /// the latest active model version), `coulomb`, or a quantity of the result as `quantity:tau_c`; with a minus sign
    /// largest first. Runs without the value are last. Newest first if omitted.
    pub sort: Option<String>,
    /// The search is incomplete: unknown terms are ignored and reported instead of rejected.
    pub typing: bool,
}

/// Runs, by default newest first
#[utoipa::path(get, path = "/runs", operation_id = "list_runs", tag = "runs", params(RunQuery),
    responses((status = 200, description = "A page of runs", body = RunList), Refusals))]
pub async fn list(State(lab): State<Lab>, Query(query): Query<RunQuery>) -> Answer<RunList> {
    let order = query.sort.as_deref().map(Order::parse).transpose().map_err(LabError::from)?.unwrap_or_default();
    let limit = query.limit.unwrap_or(50).min(500);
    let filter = RunFilter { limit, offset: query.offset.unwrap_or(0), search: query.search, order };
    Ok(Json(match query.typing {
        true => lab.runs_while_typing(&filter).await?,
        false => lab.runs(&filter).await?,
    }))
}

pub(super) const IDEMPOTENCY_KEY: &str = "idempotency-key";

/// Plans a procedure, checks it against the limits and starts it; with `queue` when the bench is free
#[utoipa::path(post, path = "/runs", operation_id = "start_run", tag = "runs", request_body = NewRun,
    params(("Idempotency-Key" = Option<String>, Header, description = "With `queue`: a repeated request with the same key returns the first entry; at most 200 characters")),
    responses((status = 201, description = "The run, queued", body = Run),
        (status = 202, description = "With `queue`: the entry of the queue", body = QueueEntry), Refusals))]
pub async fn start(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    headers: HeaderMap,
    Json(new): Json<NewRun>,
) -> Result<Response, Problem> {
    let unreadable = |_| Problem::malformed("Idempotency-Key: write visible ASCII characters");
    let key = headers.get(IDEMPOTENCY_KEY).map(|key| key.to_str()).transpose().map_err(unreadable)?;
    if new.queue {
        let entry = lab.enqueue(&new, key, &caller.name).await?;
        return Ok((StatusCode::ACCEPTED, Json(entry)).into_response());
    }
    if key.is_some() || new.priority != 0 {
        return Err(Problem::malformed("Idempotency-Key and priority need \"queue\": true"));
    }
    Ok(created(lab.start_run(&new, &caller.name).await?)?.into_response())
}

/// Renews the lease of a run that was started with `lease_s`
#[utoipa::path(post, path = "/runs/{id}/lease", operation_id = "renew_lease", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "The renewed lease", body = Lease), Refusals))]
pub async fn renew_lease(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<Lease> {
    Ok(Json(lab.renew_lease(id).await?))
}

/// One run
#[utoipa::path(get, path = "/runs/{id}", operation_id = "get_run", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "The run", body = Run), Refusals))]
pub async fn get(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<Run> {
    Ok(Json(lab.run(id).await?))
}

/// Pauses the run after the current step
#[utoipa::path(post, path = "/runs/{id}/pause", operation_id = "pause_run", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "Accepted; present state of the run", body = Run), Refusals))]
pub async fn pause(State(lab): State<Lab>, Extension(caller): Extension<Caller>, Path(id): Path<i64>) -> Answer<Run> {
    Ok(Json(lab.control(id, Control::Pause, &caller.name).await?))
}

/// Steps of the run, as in its dry run; of a resumed run the remaining steps
#[utoipa::path(get, path = "/runs/{id}/plan", operation_id = "get_plan", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "The steps of the run, in order", body = Preview), Refusals))]
pub async fn plan(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<Preview> {
    Ok(Json(lab.plan_of(id).await?))
}

/// Resumes the run after a pause
#[utoipa::path(post, path = "/runs/{id}/resume", operation_id = "resume_run", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "Accepted; present state of the run", body = Run), Refusals))]
pub async fn resume(State(lab): State<Lab>, Extension(caller): Extension<Caller>, Path(id): Path<i64>) -> Answer<Run> {
    Ok(Json(lab.control(id, Control::Resume, &caller.name).await?))
}

/// Resumes an interrupted run in a new run: warm-up, demagnetised brake, then the first unfinished step. Both together
/// form one measurement
#[utoipa::path(post, path = "/runs/{id}/continue", operation_id = "continue_run", tag = "runs", params(("id" = i64, Path, description = "Interrupted run")),
    responses((status = 201, description = "The new run, queued", body = Run), Refusals))]
pub async fn go_on(State(lab): State<Lab>, Extension(caller): Extension<Caller>, Path(id): Path<i64>) -> Created<Run> {
    created(lab.continue_run(id, &caller.name).await?)
}

/// Finishes the run after the current step and evaluates the recorded data
#[utoipa::path(post, path = "/runs/{id}/stop", operation_id = "stop_run", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "Accepted; present state of the run", body = Run), Refusals))]
pub async fn stop(State(lab): State<Lab>, Extension(caller): Extension<Caller>, Path(id): Path<i64>) -> Answer<Run> {
    Ok(Json(lab.control(id, Control::Stop, &caller.name).await?))
}

/// Ends the run immediately; the bench is secured
#[utoipa::path(post, path = "/runs/{id}/abort", operation_id = "abort_run", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "Accepted; present state of the run", body = Run), Refusals))]
pub async fn abort(State(lab): State<Lab>, Extension(caller): Extension<Caller>, Path(id): Path<i64>) -> Answer<Run> {
    Ok(Json(lab.control(id, Control::Abort, &caller.name).await?))
}

#[derive(Debug, Clone, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(default, deny_unknown_fields)]
pub struct EventQuery {
    /// Only events with a larger sequence number.
    pub after: Option<u64>,
}

/// The journal of the run
#[utoipa::path(get, path = "/runs/{id}/events", operation_id = "list_run_events", tag = "runs",
    params(("id" = i64, Path, description = "Run"), EventQuery),
    responses((status = 200, description = "Events in order", body = Vec<RunEvent>), Refusals))]
pub async fn events(
    State(lab): State<Lab>,
    Path(id): Path<i64>,
    Query(query): Query<EventQuery>,
) -> Answer<Vec<RunEvent>> {
    Ok(Json(lab.events(id, query.after).await?))
}

#[derive(Debug, Clone, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(default, deny_unknown_fields)]
pub struct SampleQuery {
    /// Channel names, comma-separated; all if omitted.
    pub channels: Option<String>,
    /// Start of the window, in run time; first row if omitted.
    pub from_s: Option<f64>,
    /// End of the window, in run time; last row if omitted.
    pub to_s: Option<f64>,
    /// Width of the view in pixels; 2000 if omitted.
    #[param(minimum = 1, maximum = 20_000)]
    pub px: Option<u32>,
}

/// Samples of a window, at most one minimum and maximum for each pixel. With `Accept: application/vnd.apache.arrow.stream`
/// all rows of the window, as an Arrow stream with one column of doubles for each channel
#[utoipa::path(get, path = "/runs/{id}/samples", operation_id = "get_samples", tag = "samples",
    params(("id" = i64, Path, description = "Run"), SampleQuery),
    responses(
        (status = 200, description = "The window", content(
            (Samples = "application/json"), (File = "application/vnd.apache.arrow.stream"))),
        Refusals))]
pub async fn samples(
    State(lab): State<Lab>,
    Path(id): Path<i64>,
    Query(query): Query<SampleQuery>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let SampleQuery { channels, from_s, to_s, px } = query;
    let channels = named(channels);
    if accepts_arrow(&headers) {
        if px.is_some() {
            return Err(Problem::malformed("px is for JSON: an Arrow stream has all rows of the window"));
        }
        let (encoding, spreadsheet_safe) = (Encoding::ArrowStream, false);
        let request = ExportRequest { run: id, encoding, channels, from_s, to_s, spreadsheet_safe };
        return streamed(&lab, request).await;
    }
    Ok(Json(lab.samples(id, channels.as_deref(), from_s, to_s, px.unwrap_or(2000)).await?).into_response())
}

/// Whether a client names the Arrow stream. `*/*` gets JSON.
fn accepts_arrow(headers: &HeaderMap) -> bool {
    let accepted = headers.get_all(header::ACCEPT).iter().filter_map(|value| value.to_str().ok());
    accepted
        .flat_map(|value| value.split(','))
        .any(|kind| kind.split(';').next().is_some_and(|kind| kind.trim() == ARROW_STREAM))
}

#[derive(Debug, Clone, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(default, deny_unknown_fields)]
pub struct StatisticsQuery {
    /// Channel names, comma-separated; all if omitted.
    pub channels: Option<String>,
    /// Start of the window, in run time; first row if omitted.
    pub from_s: Option<f64>,
    /// End of the window, in run time; last row if omitted.
    pub to_s: Option<f64>,
}

/// Mean, standard deviation, RMS, minimum and maximum of each channel over all rows of a window
#[utoipa::path(get, path = "/runs/{id}/statistics", operation_id = "get_statistics", tag = "samples",
    params(("id" = i64, Path, description = "Run"), StatisticsQuery),
    responses((status = 200, description = "One entry for each channel", body = Vec<ChannelStatistics>), Refusals))]
pub async fn statistics(
    State(lab): State<Lab>,
    Path(id): Path<i64>,
    Query(query): Query<StatisticsQuery>,
) -> Answer<Vec<ChannelStatistics>> {
    Ok(Json(lab.statistics(id, named(query.channels).as_deref(), query.from_s, query.to_s).await?))
}

#[derive(Debug, Clone, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub struct DifferenceQuery {
    /// The other runs, one to five, comma-separated.
    pub others: String,
    /// The channel to compare.
    pub channel: String,
    /// The channel for the alignment; time if omitted.
    pub by: Option<String>,
    /// Event that defines time zero: its `key`, or its text.
    pub from: Option<String>,
}

/// Difference of a channel between runs and a reference run, over time or another channel, with two standard errors
#[utoipa::path(get, path = "/runs/{id}/differences", operation_id = "get_run_differences", tag = "samples",
    params(("id" = i64, Path, description = "Reference run of the comparison"), DifferenceQuery),
    responses((status = 200, description = "Figures; the means first if the runs are not aligned by time", body = Vec<Figure>), Refusals))]
pub async fn differences(
    State(lab): State<Lab>,
    Path(id): Path<i64>,
    Query(query): Query<DifferenceQuery>,
) -> Answer<Vec<Figure>> {
    let others: Result<Vec<i64>, _> = query.others.split(',').map(|run| run.trim().parse()).collect();
    let others = others
        .map_err(|_| Problem::malformed(format!("others = {}: write run numbers, comma-separated", query.others)))?;
    let by = query.by.unwrap_or_else(|| "time_s".to_owned());
    let how = Alignment { channel: query.channel, by, from: query.from };
    Ok(Json(lab.compare_runs(&[vec![id], others].concat(), &how).await?))
}

fn named(channels: Option<String>) -> Option<Vec<String>> {
    channels.map(|names| names.split(',').map(|name| name.trim().to_owned()).collect())
}
