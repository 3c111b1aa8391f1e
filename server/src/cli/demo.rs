//! `jointbench demo`: the main job on a simulated bench, through the same path as every other run.

mod hidden;

use super::arguments::Demo;
use super::exit::{Done, Exit};
use super::print;
use super::progress::RunProgress;
use super::serve::{runtime, settings};
use crate::config::{BenchDescription, Description, Notify};
use crate::daemon::{Daemon, shutdown_signal};
use crate::lab::{LOCAL, Lab};
use crate::view::{Model, NewModel, NewRun, Run, RunState, Suggestion, reread};
use hidden::{Hidden, Setup};
use jointbench_devices::MockSettings;
use std::time::Instant;

/// Limit of added effects: the demo never hides more.
const MOST_EFFECTS: usize = 5;
/// An effect is added if the validation error falls below this share of its previous value.
const WORTH_ADDING: f64 = 0.98;

pub fn demo(arguments: Demo) -> Done {
    let hidden = Hidden::choose(&arguments)?;
    let mock = MockSettings::new(hidden.setup.joint, hidden.seed).hiding(&[hidden.effect]);
    let benches = vec![BenchDescription::mock(hidden.setup.bench, mock)];
    let description = Description { benches, notify: Notify::default(), archive: None };
    let stays = !arguments.exit;
    runtime()?.block_on(async {
        let daemon = Daemon::start(settings(arguments.place, "jointbench-data/demo", description)?).await?;
        let address = format!("{}://{}", daemon.scheme, daemon.address);
        let end = tokio::select! {
            shown = show(&daemon.lab, &hidden) => match shown {
                Ok(run) => {
                    if stays {
                        println!();
                        println!("dashboard: {address}/  (model workbench of this run: {address}/workbench/{run})");
                        println!("Press Ctrl-C to exit.");
                        shutdown_signal().await;
                    }
                    Ok(())
                }
                Err(error) => Err(error),
            },
            () = shutdown_signal() => {
                eprintln!("Stop requested: moving the bench to its safe state");
                Err(Exit::failed("stopped before the demo was complete; the bench is in its safe state"))
            }
        };
        daemon.stop().await;
        end
    })
}

/// The whole loop. Returns the run.
async fn show(lab: &Lab, hidden: &Hidden) -> Result<i64, Exit> {
    let began = Instant::now();
    let Setup { bench, procedure, title, ordinary, .. } = hidden.setup;
    println!("Simulated {title} with simulated instruments on the real protocols.");
    match hidden.is_secret {
        true => {
            println!("One hidden effect in addition to {ordinary}, revealed at the end (seed {}).", hidden.seed)
        }
        false => println!(
            "Hidden effect: {}, in addition to {ordinary}. The initial model does not contain it.",
            hidden.effect
        ),
    }
    println!();
    println!("1  Measure: procedure {procedure} on {bench}");
    let run = measure(lab, &hidden.setup).await?;
    println!("   {}", run.ending());

    println!();
    println!("2  Fit the initial model, diagnose it, add missing effects");
    let improved = improve(lab, &run, hidden.setup.known).await?;

    println!();
    println!("3  Validation error");
    println!();
    report(&improved.versions);
    println!();
    conclude(&improved, hidden);
    println!("Took {:.0} s.", began.elapsed().as_secs_f64());
    Ok(run.summary.id)
}

async fn measure(lab: &Lab, &Setup { bench, procedure, .. }: &Setup) -> Result<Run, Exit> {
    let new = NewRun { bench: bench.to_owned(), procedure: procedure.to_owned(), ..NewRun::default() };
    let run = lab.start_run(&new, LOCAL).await?.summary.id;
    let mut watch = lab.handle(bench)?.watch();
    let mut shown = RunProgress::begin();
    loop {
        if watch.changed().await.is_err() {
            return Err(Exit::failed("the bench thread has ended"));
        }
        let progress = watch.borrow_and_update().progress.clone();
        if let Some(progress) = &progress {
            shown.show(progress);
        }
        if !lab.handle(bench)?.is_busy() {
            break;
        }
    }
    shown.end();
    let run = lab.run(run).await?;
    match run.summary.state {
        RunState::Completed => Ok(run),
        _ => Err(Exit::failed(run.ending())),
    }
}

/// Initial model (the baseline and the `known` effects), diagnosis, best effect, again: through the same calls as the
/// dashboard.
async fn improve(lab: &Lab, run: &Run, known: &[&str]) -> Result<Improved, Exit> {
    let meta: jointbench_instrument::Meta = reread(&run.meta)?;
    let initial: Vec<String> = meta.baseline.into_iter().chain(known.iter().map(|id| (*id).to_owned())).collect();
    let mut versions = vec![lab.create_model(NewModel::free(&[run.summary.id], &initial, None), LOCAL).await?];
    let mut confounded = Vec::new();
    loop {
        let model = &versions[versions.len() - 1];
        let diagnosis = lab.diagnose(model.id).await?.finding;
        println!();
        println!("   model {}: {}", model.id, model.effects.join(" + "));
        println!("   {}", diagnosis.summary);
        print::regions(&diagnosis.regions, &diagnosis.fit.unit);
        print::suggestions(&diagnosis.suggestions, diagnosis.fit.validation_rms, &diagnosis.fit.unit);
        let worth = |suggestion: &&Suggestion| suggestion.validation_rms < WORTH_ADDING * model.validation_rms;
        let best = diagnosis.suggestions.iter().find(worth).filter(|_| versions.len() <= MOST_EFFECTS);
        let Some(best) = best else {
            let without_weight = diagnosis.suggestions.into_iter().map(|suggestion| suggestion.effect).collect();
            return Ok(Improved { versions, without_weight, confounded });
        };
        confounded.extend(best.confounded_with.iter().map(|with| (best.effect.clone(), with.clone())));
        println!();
        println!("   → add {} and refit", best.effect);
        let effects: Vec<String> = model.effects.iter().cloned().chain([best.effect.clone()]).collect();
        let next = NewModel::free(&[run.summary.id], &effects, Some(model.id));
        versions.push(lab.create_model(next, LOCAL).await?);
    }
}

struct Improved {
    versions: Vec<Model>,
    /// Seen, but where the error on settled motion does not look.
    without_weight: Vec<String>,
    /// Added effects, each with one that the run cannot distinguish from it.
    confounded: Vec<(String, String)>,
}

fn report(versions: &[Model]) {
    let steps: Vec<(String, f64)> = versions
        .iter()
        .map(|model| match model.parent {
            None => ("initial model".to_owned(), model.validation_rms),
            Some(_) => (format!("+ {}", model.added.join(", ")), model.validation_rms),
        })
        .collect();
    if let Some(last) = versions.last() {
        print::fall(&steps, last.noise_floor_rms, &last.fit.unit);
    }
}

fn conclude(improved: &Improved, hidden: &Hidden) {
    let added: Vec<&str> =
        improved.versions.iter().skip(1).flat_map(|model| &model.added).map(String::as_str).collect();
    let found = match added.as_slice() {
        [] => "No missing effect found".to_owned(),
        added => format!("Missing effect found: {}", added.join(", ")),
    };
    println!("{found}. Hidden effect: {}.", hidden.effect);
    if let Some((added, hidden)) = improved.confounded.iter().find(|(_, with)| with == hidden.effect) {
        println!("This run cannot distinguish {added} from {hidden}.");
    }
    if !improved.without_weight.is_empty() {
        let seen = improved.without_weight.join(", ");
        println!("Also detected: {seen}, without influence on the steady-state error.");
    }
}
