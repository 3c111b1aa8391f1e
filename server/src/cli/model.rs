//! `jointbench model`: exported models in files, and their import into the store.

use super::arguments::{Model, ModelCommand, StorePlace};
use super::exit::{Done, Exit};
use super::files::{self, write};
use super::offline::read;
use super::print;
use super::print::json_out;
use super::serve::runtime;
use super::transfer::{self, Target};
use crate::lab::LOCAL;
use crate::view::{self, reread};
use jointbench_model::export::{ModelFile, export};
use jointbench_model::{Fit, words};
use std::path::Path;

pub fn model(arguments: &Model) -> Done {
    match &arguments.command {
        ModelCommand::Export { model, format, output } => {
            let text = export(&open(model)?, (*format).into())?;
            match output {
                Some(path) => write(path, text.as_bytes()),
                None => {
                    print!("{text}");
                    Ok(())
                }
            }
        }
        ModelCommand::Import { model, run, json, store } => import(model, *run, *json, store),
        ModelCommand::Evaluate { model, run, meta, columns, json } => {
            let (fit, table) = (open(model)?, read(run, meta.as_deref(), columns)?);
            let evaluation = jointbench_model::evaluate(&fit, &table).map_err(|fault| Exit::of(&[run], fault))?;
            if *json {
                return json_out(&evaluation);
            }
            print::evaluation(run, &evaluation);
            Ok(())
        }
        ModelCommand::Compare { first, second, run, meta, columns, json } => {
            let (a, b) = (open(first)?, open(second)?);
            let table = read(run, meta.as_deref(), columns)?;
            let comparison = jointbench_model::compare(&a, &b, &table).map_err(|fault| Exit::of(&[run], fault))?;
            if *json {
                return json_out(&comparison);
            }
            print::comparison(run, &comparison);
            Ok(())
        }
    }
}

/// Makes a model file a version of a run.
fn import(model: &Path, run: i64, json: bool, store: &StorePlace) -> Done {
    let runtime = runtime()?;
    let fit = open(model)?;
    let file = reread(&ModelFile::new(fit.clone()))?;
    let import = view::ModelImport { run, model: file };
    let refused = |exit: Exit| Exit { message: format!("{}: {}", model.display(), exit.message), ..exit };
    let (imported, page) = match transfer::open(&runtime, store, false)? {
        Target::Folder(lab) => {
            (runtime.block_on(lab.import_model(import, LOCAL)).map_err(|fault| refused(fault.into()))?, None)
        }
        Target::Daemon(client) => {
            let imported: view::ImportedModel = client.post("/models/import", &import).map_err(refused)?;
            let page = client.page(&format!("/workbench/{run}?model={}", imported.model.id));
            (imported, Some(page))
        }
    };
    if json {
        return json_out(&imported);
    }
    let version = &imported.model;
    let figure = |rms: f64| words::figure(rms, &fit.unit);
    println!("model {} of run {run}: {}", version.id, version.effects.join(" + "));
    println!("error {} on this run, {} on the fitted run", figure(version.rms), figure(fit.validation_rms));
    imported.notes.iter().for_each(|note| println!("note      {note}"));
    if let Some(page) = page {
        println!("{page}");
    }
    Ok(())
}

/// Writes a fit in the format of `fit --out`.
fn open(path: &Path) -> Result<Fit, Exit> {
    let refuse = |fault: &dyn std::fmt::Display| Exit::bad_input(format!("{}: {fault}", path.display()));
    let bytes = files::read(path)?;
    // A table in place of a model may not be text.
    let text = String::from_utf8_lossy(&bytes);
    // The other export formats (headers, tables, attributes of joints) cannot be read back.
    if !text.trim_start().starts_with('{') {
        return Err(refuse(
            &"not a model file (arguments: first the model, then the run): give a JSON file written by `jointbench fit \
              --out` or `jointbench model export --format json`",
        ));
    }
    ModelFile::read(&text).map_err(|fault| refuse(&fault))
}
