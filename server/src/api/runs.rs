//! Runs: start, watch, steer.

use super::extract::{Answer, Created, Json, Path, Query, created};
use super::problem::{Problem, Refusals};
use crate::lab::{Alignment, Caller, Lab, LabError, Order, RunFilter};
use crate::view::{ChannelStatistics, Figure, NewRun, Preview, Run, RunEvent, RunList, Samples};
use axum::Extension;
use axum::extract::State;
use jointbench_procedure::Control;
use serde::Deserialize;
use utoipa::IntoParams;

#[derive(Debug, Clone, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(default, deny_unknown_fields)]
pub struct RunQuery {
    /// At most so many; 50 where left out, 500 at most.
    #[param(maximum = 500)]
    pub limit: Option<u32>,
    /// Leave out so many of the newest.
    pub offset: Option<u32>,
    /// Words, and terms such as `kind:friction`, `tag:oil`, `-state:failed`, `duration>2min`, `after:2026-01-31`; all must hold.
    pub search: Option<String>,
    /// By what they are ordered: `started`, `state`, `procedure`, `bench`, `duration`, `rows`, `safe`, `error` (held out, of the
    /// last version of the model that is not idle) or `coulomb`; with a minus sign the largest first. Newest first where left out.
    pub sort: Option<String>,
    /// The search is still being typed: terms that are not understood are left out, and told, instead of refused.
    pub typing: bool,
}

/// Runs, newest first unless told otherwise
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

/// Plans a procedure, checks it against the limits and starts it
#[utoipa::path(post, path = "/runs", tag = "runs", request_body = NewRun,
    responses((status = 201, description = "The run, queued", body = Run), Refusals))]
pub async fn start(
    State(lab): State<Lab>,
    Extension(caller): Extension<Caller>,
    Json(new): Json<NewRun>,
) -> Created<Run> {
    created(lab.start_run(&new.bench, &new.procedure, &new.parameters, &caller.name).await?)
}

/// One run
#[utoipa::path(get, path = "/runs/{id}", operation_id = "get_run", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "The run", body = Run), Refusals))]
pub async fn get(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<Run> {
    Ok(Json(lab.run(id).await?))
}

/// Brings the joint to rest between two steps and waits
#[utoipa::path(post, path = "/runs/{id}/pause", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "Taken; the run as it is now", body = Run), Refusals))]
pub async fn pause(State(lab): State<Lab>, Extension(caller): Extension<Caller>, Path(id): Path<i64>) -> Answer<Run> {
    Ok(Json(lab.control(id, Control::Pause, &caller.name).await?))
}

/// What the run does, step by step, as its dry run told it; of a run that goes on with another, what was left
#[utoipa::path(get, path = "/runs/{id}/plan", operation_id = "get_plan", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "Its steps, in the order of its progress", body = Preview), Refusals))]
pub async fn plan(State(lab): State<Lab>, Path(id): Path<i64>) -> Answer<Preview> {
    Ok(Json(lab.plan_of(id).await?))
}

/// Goes on after a pause
#[utoipa::path(post, path = "/runs/{id}/resume", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "Taken; the run as it is now", body = Run), Refusals))]
pub async fn resume(State(lab): State<Lab>, Extension(caller): Extension<Caller>, Path(id): Path<i64>) -> Answer<Run> {
    Ok(Json(lab.control(id, Control::Resume, &caller.name).await?))
}

/// Makes the steps that a run has left, in a new run: the warm-up again, the brake demagnetised, then from the first step
/// that was not finished. Both together are one measurement
#[utoipa::path(post, path = "/runs/{id}/continue", operation_id = "continue_run", tag = "runs", params(("id" = i64, Path, description = "Run that did not come to its end")),
    responses((status = 201, description = "The new run, queued", body = Run), Refusals))]
pub async fn go_on(State(lab): State<Lab>, Extension(caller): Extension<Caller>, Path(id): Path<i64>) -> Created<Run> {
    created(lab.continue_run(id, &caller.name).await?)
}

/// Ends the run after the step at hand; what was measured counts
#[utoipa::path(post, path = "/runs/{id}/stop", operation_id = "stop_run", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "Taken; the run as it is now", body = Run), Refusals))]
pub async fn stop(State(lab): State<Lab>, Extension(caller): Extension<Caller>, Path(id): Path<i64>) -> Answer<Run> {
    Ok(Json(lab.control(id, Control::Stop, &caller.name).await?))
}

/// Ends the run now; the bench is secured
#[utoipa::path(post, path = "/runs/{id}/abort", tag = "runs", params(("id" = i64, Path, description = "Run")),
    responses((status = 200, description = "Taken; the run as it is now", body = Run), Refusals))]
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

/// The run's journal
#[utoipa::path(get, path = "/runs/{id}/events", tag = "runs",
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
    /// Names with commas between; all where left out.
    pub channels: Option<String>,
    /// Begin of the window on the run's clock; its first row where left out.
    pub from_s: Option<f64>,
    /// End of the window; the last row where left out.
    pub to_s: Option<f64>,
    /// Width of the view in pixels; 2000 where left out.
    #[param(minimum = 1, maximum = 20_000)]
    pub px: Option<u32>,
}

/// Samples of a window, at most one minimum and maximum for each pixel
#[utoipa::path(get, path = "/runs/{id}/samples", tag = "samples",
    params(("id" = i64, Path, description = "Run"), SampleQuery),
    responses((status = 200, description = "The window", body = Samples), Refusals))]
pub async fn samples(State(lab): State<Lab>, Path(id): Path<i64>, Query(query): Query<SampleQuery>) -> Answer<Samples> {
    let channels = named(query.channels);
    Ok(Json(lab.samples(id, channels.as_deref(), query.from_s, query.to_s, query.px.unwrap_or(2000)).await?))
}

#[derive(Debug, Clone, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(default, deny_unknown_fields)]
pub struct StatisticsQuery {
    /// Names with commas between; all where left out.
    pub channels: Option<String>,
    /// Begin of the window on the run's clock; its first row where left out.
    pub from_s: Option<f64>,
    /// End of the window; the last row where left out.
    pub to_s: Option<f64>,
}

/// Mean, deviation, RMS, smallest and largest value of each channel over every row of a window
#[utoipa::path(get, path = "/runs/{id}/statistics", tag = "samples",
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
    /// The others, one to five, with commas between.
    pub others: String,
    /// The channel that is held against that of the first run.
    pub channel: String,
    /// The channel by which the runs are aligned; the time where left out.
    pub by: Option<String>,
    /// The event, by its text, from which on the time is told.
    pub from: Option<String>,
}

/// How far a channel of other runs is from that of a first one, over time or another channel, with two standard errors
#[utoipa::path(get, path = "/runs/{id}/differences", operation_id = "run_differences", tag = "samples",
    params(("id" = i64, Path, description = "The run that the others are held against"), DifferenceQuery),
    responses((status = 200, description = "Figures; the means first where the runs are not aligned by time", body = Vec<Figure>), Refusals))]
pub async fn differences(
    State(lab): State<Lab>,
    Path(id): Path<i64>,
    Query(query): Query<DifferenceQuery>,
) -> Answer<Vec<Figure>> {
    let others: Result<Vec<i64>, _> = query.others.split(',').map(|run| run.trim().parse()).collect();
    let others = others.map_err(|_| {
        Problem::malformed(format!("others = {}: write numbers of runs with commas between", query.others))
    })?;
    let by = query.by.unwrap_or_else(|| "time_s".to_owned());
    let how = Alignment { channel: query.channel, by, from: query.from };
    Ok(Json(lab.differences(&[vec![id], others].concat(), &how).await?))
}

fn named(channels: Option<String>) -> Option<Vec<String>> {
    channels.map(|names| names.split(',').map(|name| name.trim().to_owned()).collect())
}
