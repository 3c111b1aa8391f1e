//! Channels that no instrument measures: formulas over the columns of a run.

use super::extract::{Answer, Json, Path, Query};
use super::refusals::Refusals;
use crate::lab::{Lab, PointLimit};
use crate::view::{Samples, SpectrumView};
use axum::extract::State;
use serde::Deserialize;
use utoipa::IntoParams;

#[derive(Debug, Clone, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub struct DerivedQuery {
    /// One to four formulas over the columns of the run, with semicolons between, in the language of effects; besides
    /// `derivative(x)`, `integral(x)` and `smooth(x, seconds)`.
    pub formulas: String,
    /// Start of the window, in run time; first row if omitted.
    pub from_s: Option<f64>,
    /// End of the window, in run time; last row if omitted.
    pub to_s: Option<f64>,
    /// Width of the view in pixels, each with minimum and maximum; 2000 if omitted.
    #[param(minimum = 1, maximum = 20_000)]
    pub px: Option<u32>,
    /// Instead of a view at most so many rows as they are, evenly chosen: to draw one channel over another.
    #[param(minimum = 1, maximum = 20_000)]
    pub rows: Option<u32>,
}

/// Channels computed from those of the run, each by a formula
#[utoipa::path(get, path = "/runs/{id}/derived", operation_id = "derive_samples", tag = "samples",
    params(("id" = i64, Path, description = "Run"), DerivedQuery),
    responses((status = 200, description = "The window; a channel is named by its formula", body = Samples), Refusals))]
pub async fn samples(
    State(lab): State<Lab>,
    Path(id): Path<i64>,
    Query(query): Query<DerivedQuery>,
) -> Answer<Samples> {
    let formulas = query.formulas.split(';').map(|formula| formula.trim().to_owned()).collect();
    let most = query.rows.map_or(PointLimit::Pixels(query.px.unwrap_or(2000)), PointLimit::Rows);
    Ok(Json(lab.derived(id, formulas, [query.from_s, query.to_s], most).await?))
}

#[derive(Debug, Clone, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub struct SpectrumQuery {
    /// A column of the run, or a formula over its columns.
    pub formula: String,
    /// Start of the window, in run time; first row if omitted.
    pub from_s: Option<f64>,
    /// End of the window, in run time; last row if omitted.
    pub to_s: Option<f64>,
}

/// Amplitude spectrum of a channel of the run, or of a formula over its channels
#[utoipa::path(get, path = "/runs/{id}/spectrum", operation_id = "get_spectrum", tag = "samples",
    params(("id" = i64, Path, description = "Run"), SpectrumQuery),
    responses((status = 200, description = "The spectrum of the window", body = SpectrumView), Refusals))]
pub async fn spectrum(
    State(lab): State<Lab>,
    Path(id): Path<i64>,
    Query(query): Query<SpectrumQuery>,
) -> Answer<SpectrumView> {
    Ok(Json(lab.spectrum(id, query.formula, [query.from_s, query.to_s]).await?))
}
