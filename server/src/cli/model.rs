//! `jointbench model`: exported models, without a daemon.

use super::arguments::{Model, ModelCommand};
use super::exit::{Done, Exit};
use super::offline::{json_out, read};
use super::print;
use jointbench_model::Fit;
use jointbench_model::transfer::{Format, ModelFile, export};
use std::path::Path;

pub fn model(arguments: &Model) -> Done {
    match &arguments.command {
        ModelCommand::Export { model, format, output } => {
            let text = export(&open(model)?, (*format).into())?;
            match output {
                Some(path) => write(path, &text),
                None => {
                    print!("{text}");
                    Ok(())
                }
            }
        }
        ModelCommand::Evaluate { model, run, meta, columns, json } => {
            let (fit, table) = (open(model)?, read(run, meta.as_deref(), columns)?);
            let evaluation = jointbench_model::evaluate(&fit, &table)?;
            if *json {
                return json_out(&evaluation);
            }
            print::evaluation(run, &evaluation);
            Ok(())
        }
        ModelCommand::Compare { first, second, run, meta, columns, json } => {
            let (a, b) = (open(first)?, open(second)?);
            let comparison = jointbench_model::compare(&a, &b, &read(run, meta.as_deref(), columns)?)?;
            if *json {
                return json_out(&comparison);
            }
            print::comparison(run, &comparison);
            Ok(())
        }
    }
}

/// Writes a fit as `fit --out` does.
pub fn save(fit: &Fit, path: &Path) -> Done {
    write(path, &export(fit, Format::Json)?)
}

fn open(path: &Path) -> Result<Fit, Exit> {
    let refuse = |fault: &dyn std::fmt::Display| Exit::bad_input(format!("{}: {fault}", path.display()));
    let text = std::fs::read_to_string(path).map_err(|fault| refuse(&fault))?;
    ModelFile::read(&text).map_err(|fault| refuse(&fault))
}

fn write(path: &Path, text: &str) -> Done {
    std::fs::write(path, text).map_err(|fault| Exit::bad_input(format!("{}: {fault}", path.display())))
}
