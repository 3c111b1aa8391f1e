//! HTTP: the router lists all operations. Handlers only translate; [`crate::lab`] does the work.

mod archive;
mod auth;
mod autopilots;
mod bench;
mod body_limit;
mod calibrations;
mod cancellation;
mod dashboard;
mod derived;
mod examples;
mod extract;
mod headers;
mod health;
mod identifications;
mod live;
mod log;
mod models;
mod notes;
mod notifications;
mod presence;
mod problem;
mod procedures;
mod queue;
mod refusals;
mod response_budget;
mod revisions;
mod rights;
mod runs;
#[cfg(test)]
mod specification;
mod tables;
mod throttle;
mod tokens;
mod transfer;
mod units;
mod user_effects;

pub use auth::Transport;
pub use health::Health;
pub use presence::Presence;
pub use problem::Problem;

use crate::lab::Lab;
use crate::view::LiveMessage;
use auth::Auth;
use axum::extract::{DefaultBodyLimit, Request};
use axum::routing::{any, get};
use axum::{Router, middleware};
use std::sync::Arc;
use tokio::sync::Semaphore;
use tower_http::CompressionLevel;
use tower_http::compression::CompressionLayer;
use tower_http::trace::TraceLayer;
use utoipa::openapi::security::{HttpAuthScheme, HttpBuilder, SecurityScheme};
use utoipa::{Modify, OpenApi};
use utoipa_axum::{router::OpenApiRouter, routes};

#[derive(OpenApi)]
#[openapi(
    info(
        title = "jointbench",
        description = "Test bench for robot joints: measure, identify a model, find the missing effect.\n\nSI units; the unit is the suffix of a name. Errors are problem documents (RFC 9457).",
        license(name = "MIT OR Apache-2.0", identifier = "MIT OR Apache-2.0")
    ),
    servers((url = "/", description = "The daemon that this document comes from")),
    components(schemas(Problem, LiveMessage)),
    modifiers(&Token),
    security((), ("token" = [])),
    tags(
        (name = "bench", description = "Benches and instruments"),
        (name = "procedures", description = "Procedures that a bench can run"),
        (name = "runs", description = "Measurements, running and stored"),
        (name = "queue", description = "Runs that wait for their bench"),
        (name = "samples", description = "Windows of samples"),
        (name = "effects", description = "The library of physical effects"),
        (name = "models", description = "Fitted model versions, a tree for each run"),
        (name = "diagnoses", description = "Where a model fails and which effect is missing"),
        (name = "autopilots", description = "Recommended runs, and the autopilot that performs them"),
        (name = "live", description = "Live state, progress, events and samples"),
        (name = "daemon", description = "The daemon"),
    )
)]
struct Description;

/// On loopback no token is required; elsewhere every request needs one.
struct Token;

impl Modify for Token {
    fn modify(&self, document: &mut utoipa::openapi::OpenApi) {
        let scheme = HttpBuilder::new()
            .scheme(HttpAuthScheme::Bearer)
            .description(Some(
                "Required if the daemon was started with a token (`--token-file`); further tokens are created at \
                 `/tokens`",
            ))
            .build();
        document.components.get_or_insert_default().add_security_scheme("token", SecurityScheme::Http(scheme));
    }
}

/// Simultaneous requests for windows of samples, residuals or journals, for each kind.
const ANSWERS_AT_ONCE: usize = 8;
/// Reading a table of many megabytes needs twenty times its size in memory.
const TABLES_AT_ONCE: usize = 2;

/// Where Prometheus looks by default.
const METRICS: &str = "/metrics";

/// Everything under `/api/v1`.
fn operations() -> OpenApiRouter<Lab> {
    let rest = samples().merge(measurements()).merge(models()).merge(daemon()).layer(middleware::from_fn_with_state(
        response_budget::ResponseBudget::default(),
        response_budget::limit_memory,
    ));
    let rest = sized(rest, body_limit::BODY_LIMIT_BYTES);
    OpenApiRouter::with_openapi(Description::openapi()).nest("/api/v1", rest.merge(tables()).merge(uploads()))
}

fn uploads() -> OpenApiRouter<Lab> {
    let turns = Arc::new(Semaphore::new(body_limit::UPLOADS));
    let routes = OpenApiRouter::new().routes(routes!(transfer::import)).routes(routes!(transfer::preview));
    sized(routes, body_limit::UPLOAD_LIMIT_BYTES)
        .layer(middleware::from_fn(move |request, next| body_limit::queue(turns.clone(), request, next)))
}

fn tables() -> OpenApiRouter<Lab> {
    sized(gated(TABLES_AT_ONCE, OpenApiRouter::new().routes(routes!(tables::write))), body_limit::TABLE_LIMIT_BYTES)
}

/// Large answers. Each kind has its own limit, so that requests for residuals do not delay samples.
fn samples() -> OpenApiRouter<Lab> {
    OpenApiRouter::new()
        .merge(gated(ANSWERS_AT_ONCE, OpenApiRouter::new().routes(routes!(runs::samples))))
        .merge(gated(ANSWERS_AT_ONCE, OpenApiRouter::new().routes(routes!(derived::samples))))
        .merge(gated(ANSWERS_AT_ONCE, OpenApiRouter::new().routes(routes!(models::residuals))))
        .merge(gated(ANSWERS_AT_ONCE, OpenApiRouter::new().routes(routes!(runs::events))))
}

/// Benches, procedures, runs and their results.
fn measurements() -> OpenApiRouter<Lab> {
    OpenApiRouter::new()
        .routes(routes!(bench::list))
        .routes(routes!(bench::get))
        .routes(routes!(bench::stop))
        .routes(routes!(bench::acknowledge))
        .routes(routes!(bench::retry))
        .routes(routes!(bench::description))
        .routes(routes!(bench::safety))
        .routes(routes!(bench::servo_memory))
        .routes(routes!(calibrations::list, calibrations::apply))
        .routes(routes!(bench::instruments))
        .routes(routes!(procedures::list))
        .routes(routes!(procedures::preview))
        .routes(routes!(runs::list, runs::start))
        .routes(routes!(runs::get))
        .routes(routes!(runs::renew_lease))
        .routes(routes!(queue::list, queue::add_plan))
        .routes(routes!(queue::get, queue::remove))
        .routes(routes!(queue::prioritise))
        .routes(routes!(queue::renew_lease))
        .routes(routes!(queue::restore))
        .routes(routes!(queue::pause))
        .routes(routes!(queue::resume))
        .routes(routes!(runs::pause))
        .routes(routes!(runs::resume))
        .routes(routes!(runs::stop))
        .routes(routes!(runs::abort))
        .routes(routes!(runs::go_on))
        .routes(routes!(runs::plan))
        .routes(routes!(notes::list, notes::write))
        .routes(routes!(notes::set_tags))
        .routes(routes!(notes::tags))
        .routes(routes!(runs::statistics))
        .routes(routes!(runs::differences))
        .routes(routes!(derived::spectrum))
        .routes(routes!(identifications::get))
        .routes(routes!(identifications::junit))
        .routes(routes!(identifications::earlier))
        .routes(routes!(identifications::trends))
        .routes(routes!(identifications::model_overlay))
        .routes(routes!(identifications::report))
        .routes(routes!(units::list))
        .routes(routes!(units::chart))
        .routes(routes!(units::set_reference))
        .routes(routes!(units::changes))
        .routes(routes!(transfer::export))
        .routes(routes!(transfer::export_meta))
        .routes(routes!(archive::drop_samples))
}

/// Effects, model versions, diagnoses and autopilots.
fn models() -> OpenApiRouter<Lab> {
    OpenApiRouter::new()
        .routes(routes!(models::effects, user_effects::define))
        .routes(routes!(user_effects::check))
        .routes(routes!(user_effects::delete))
        .routes(routes!(user_effects::opt_in, user_effects::opt_out))
        .routes(routes!(user_effects::language))
        .routes(routes!(models::list, models::create))
        .routes(routes!(models::get))
        .routes(routes!(models::keep))
        .routes(routes!(revisions::compare))
        .routes(routes!(revisions::worth))
        .routes(routes!(revisions::with_effect))
        .routes(routes!(revisions::evaluate))
        .routes(routes!(revisions::export))
        .routes(routes!(revisions::import))
        .routes(routes!(models::fit))
        .routes(routes!(models::diagnoses, models::diagnose))
        .routes(routes!(models::diagnosis))
        .routes(routes!(autopilots::experiment))
        .routes(routes!(autopilots::list, autopilots::start))
        .routes(routes!(autopilots::get))
        .routes(routes!(autopilots::stop))
}

fn daemon() -> OpenApiRouter<Lab> {
    OpenApiRouter::new()
        .routes(routes!(live::stream))
        .routes(routes!(log::log))
        .routes(routes!(tokens::list, tokens::make))
        .routes(routes!(tokens::revoke))
        .routes(routes!(notifications::list))
        .routes(routes!(notifications::test))
        .routes(routes!(archive::get))
        .routes(routes!(archive::retry))
        .routes(routes!(archive::samples))
        .routes(routes!(health::health))
        .routes(routes!(health::specification))
}

/// Routes with a limit of simultaneous requests.
fn gated(at_once: usize, routes: OpenApiRouter<Lab>) -> OpenApiRouter<Lab> {
    routes.layer(middleware::from_fn_with_state(
        response_budget::ConcurrencyLimit::of(at_once),
        response_budget::limit_concurrency,
    ))
}

/// Routes with a limit of the body size.
fn sized(routes: OpenApiRouter<Lab>, limit: usize) -> OpenApiRouter<Lab> {
    routes
        .layer(middleware::from_fn(move |request, next| body_limit::guard(limit, request, next)))
        .layer(DefaultBodyLimit::max(limit))
}

/// The OpenAPI 3.1 description of all operations.
pub fn specification() -> utoipa::openapi::OpenApi {
    examples::added(refusals::named(operations().to_openapi()))
}

/// Everything that the daemon serves. `/api` never falls back to the dashboard.
pub fn router(lab: Lab, transport: Transport) -> Router {
    let (rest, _) = operations().split_for_parts();
    let auth = Auth::new(lab.clone(), transport);
    rest.route(METRICS, get(health::metrics))
        .route("/api", get(health::no_such_route))
        .route("/api/{*rest}", any(health::no_such_route))
        .method_not_allowed_fallback(health::no_such_method)
        .fallback_service(
            any(dashboard::serve)
                .with_state(lab.clone())
                .layer(CompressionLayer::new().quality(CompressionLevel::Best)),
        )
        .with_state(lab)
        .layer(middleware::from_fn_with_state(auth, auth::guard))
        .layer(middleware::from_fn(body_limit::discard_body))
        .layer(middleware::from_fn(problem::name_instance))
        .layer(middleware::from_fn(move |request, next| headers::add(transport, request, next)))
        .layer(TraceLayer::new_for_http().make_span_with(span))
}

/// The logged data of a request. Without query and headers, because both may contain a token.
fn span(request: &Request) -> tracing::Span {
    tracing::debug_span!("request", method = %request.method(), path = request.uri().path())
}
