//! `jointbench diagnose`, `discover`, `fit`: work on a file, without a daemon.

use super::arguments::{Columns, Diagnose, Discover, Fit, Measured, Preparation};
use super::exit::{Done, Exit};
use super::files::{self, write};
use super::print::{self, json_out};
use crate::lab::{Offer, next_run};
use crate::view::reread;
use jointbench_files::{ReadOptions, Understood, paragraph, understand};
use jointbench_instrument::RunTable;
use jointbench_model::export::{Format, export};
use jointbench_model::{ModelSpec, Open, Options};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

pub fn diagnose(arguments: &Diagnose) -> Done {
    let (run, spec, options) = open(&arguments.run)?;
    let about = |fault| Exit::of(&arguments.run.files, fault);
    let diagnosis = crate::lab::diagnose(&run, &spec, &options, &Offer::shown_by(&run)).map_err(about)?.bounded();
    let drawn = arguments.maps.then(|| jointbench_model::maps(&run, &diagnosis.fit, &options));
    let drawn = drawn.transpose().map_err(about)?;
    if arguments.run.json {
        let mut object: Map<String, Value> = reread(&diagnosis)?;
        if let Some(drawn) = &drawn {
            object.insert("maps".to_owned(), reread(drawn)?);
        }
        json_out(&object)?;
    } else {
        print::diagnosis(&diagnosis);
        drawn.iter().for_each(|maps| print::maps(maps, &diagnosis.shows_over, diagnosis.kind));
    }
    decided(diagnosis.undecided.as_ref())
}

pub fn discover(arguments: &Discover) -> Done {
    let (run, spec, options) = open(&arguments.run)?;
    let about = |fault| Exit::of(&arguments.run.files, fault);
    let mut discovery =
        jointbench_model::discover(&run, &spec, &options, arguments.max_effects).map_err(about)?.bounded();
    let open = Open { user_effects: spec.user_effects, ..Open::from(&discovery) };
    let next = next_run(&run, &open, &Offer::shown_by(&run), &options);
    discovery.experiment = next.experiment;
    discovery.summary.extend(next.in_vain.map(|reason| format!(" {reason}")));
    if arguments.run.json {
        json_out(&discovery)?;
    } else {
        print::discovery(&discovery);
    }
    decided(discovery.undecided.as_ref())
}

/// The exit has no message: the summary contains the reason.
pub(super) fn decided(undecided: Option<&String>) -> Done {
    match undecided {
        None => Ok(()),
        Some(_) => Err(Exit::undecided("")),
    }
}

pub fn fit(arguments: &Fit) -> Done {
    let (run, spec, options) = open(&arguments.run)?;
    if let Some(idle) = spec.user_effects.iter().find(|effect| !spec.contains(effect.id())) {
        let (all, id) = (spec.effects.join(","), idle.id());
        return Err(Exit::bad_input(format!("effect {id} is not part of the model: add it, as in --model {all},{id}")));
    }
    let fit = jointbench_model::fit(&run, &spec, &options).map_err(|fault| Exit::of(&arguments.run.files, fault))?;
    if let Some(path) = &arguments.out {
        save(&fit, path)?;
    }
    let evaluation = match &arguments.evaluate {
        None => None,
        Some(other) => {
            let other_run = read(other, None, &arguments.run.columns)?;
            Some((other, jointbench_model::evaluate(&fit, &other_run).map_err(|fault| Exit::of(&[other], fault))?))
        }
    };
    if arguments.run.json {
        let mut object: Value = reread(&fit)?;
        if let (Some((file, evaluation)), Some(object)) = (&evaluation, object.as_object_mut()) {
            let result: Value = reread(evaluation)?;
            object.insert("evaluation".to_owned(), json!({ "file": file.display().to_string(), "result": result }));
        }
        return json_out(&object);
    }
    print::fit(&fit);
    if let Some((file, evaluation)) = &evaluation {
        println!();
        print::evaluation(file, evaluation);
    }
    Ok(())
}

fn save(fit: &jointbench_model::Fit, path: &Path) -> Done {
    write(path, export(fit, Format::Json)?.as_bytes())
}

fn open(measured: &Measured) -> Result<(RunTable, ModelSpec, Options), Exit> {
    let files = measured.files.iter().map(|file| files::table(file)).collect::<Result<Vec<PathBuf>, Exit>>()?;
    let mut runs = Vec::new();
    for (i, file) in files.iter().enumerate() {
        let same = |other: &PathBuf| matches!((other.canonicalize(), file.canonicalize()), (Ok(a), Ok(b)) if a == b);
        if files[..i].iter().any(same) {
            return Err(Exit::bad_input(format!("{} is named twice: name each run once", file.display())));
        }
        runs.push(read(file, measured.meta.as_deref(), &measured.columns)?);
    }
    let first = runs.remove(0);
    let run = first.join(runs).map_err(|fault| Exit::bad_input(fault.to_string()))?;
    let user_effects = measured.own.read(run.kind(), run.meta().motion)?;
    let spec = match &measured.model {
        Some(list) => ModelSpec::with_user_effects(
            run.kind(),
            list.split(',').map(str::trim).filter(|id| !id.is_empty()),
            user_effects,
        )?,
        None => ModelSpec::with_user_effects(run.kind(), run.meta().baseline.iter(), user_effects)?,
    };
    Ok((run, spec, options(&measured.preparation)?))
}

pub(super) fn read(file: &Path, meta: Option<&Path>, columns: &Columns) -> Result<RunTable, Exit> {
    let (understood, table) = understood(file, meta, columns)?;
    let (run, notes) = understood.into_run()?;
    if !notes.is_empty() {
        eprintln!("{}: {}", table.display(), paragraph(&notes));
    }
    Ok(run)
}

/// Content of a file, and the path of that file.
pub(super) fn understood(file: &Path, meta: Option<&Path>, columns: &Columns) -> Result<(Understood, PathBuf), Exit> {
    let options = ReadOptions { meta_path: meta.map(Path::to_owned), ..columns.choices().options()? };
    let table = files::table(file)?;
    if !table.exists() && file.to_str().is_some_and(|name| name.parse::<u64>().is_ok()) {
        let run = file.display();
        return Err(Exit::bad_input(format!(
            "file {run} does not exist; to write the stored run {run} to a file: jointbench export {run}"
        )));
    }
    Ok((understand(&table, &options)?, table))
}

fn options(preparation: &Preparation) -> Result<Options, Exit> {
    let defaults = Options::default();
    let residual = match preparation.residual.as_deref() {
        None => None,
        // The argument has the same words as the type.
        Some(word) => Some(reread(&word)?),
    };
    Ok(Options {
        residual,
        cutoff_hz: preparation.cutoff_hz,
        decimation: preparation.decimation,
        chunk_s: preparation.chunk_s,
        alpha: preparation.alpha.unwrap_or(defaults.alpha),
        ..defaults
    })
}
