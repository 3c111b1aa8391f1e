//! Measures the diagnosis, as docs/diagnosis.md reports it:
//!
//! `cargo run --release -p jointbench-model --example evaluate -- --help`.

#[path = "../../tests/common/mod.rs"]
mod common;
mod detectable;
mod made;
mod measured;
mod null;
mod options;
mod power;
mod removed;
mod score;
mod show;
mod speed;
mod styles;

use clap::Parser;
use options::Asked;
use score::Table;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    jointbench_model::one_heap();
    let asked = Asked::parse();
    match &asked.folder {
        Some(folder) if folder.join("meta.json").exists() => return show::show(folder),
        Some(folder) => return answered(folder, &asked),
        None => {}
    }
    if asked.wants("hidden") {
        let mut table = Table::new("Hidden effects, simulated", asked.quiet);
        for case in
            (asked.first..).take(asked.rounds as usize).flat_map(made::round).filter(|c| asked.takes(c.family, &c.name))
        {
            table.judge(&case)?;
        }
        table.print();
    }
    if asked.wants("removed") {
        removed::measure(&asked)?;
    }
    if asked.wants("practice")
        && let Some(folder) = common::shared("hidden-effects")
    {
        answered(&folder, &asked)?;
    }
    if asked.wants("measured")
        && let Some(data) = common::shared("data")
    {
        measured::measure(&data, &asked)?;
    }
    if asked.wants("null") {
        null::measure(&asked)?;
    }
    if asked.wants("power") {
        power::measure(&asked)?;
    }
    if asked.wants("detectable") {
        detectable::measure(&asked)?;
    }
    if asked.wants("styles") {
        styles::measure(&asked)?;
    }
    if asked.wants("speed") {
        speed::measure(asked.case)?;
    }
    Ok(())
}

/// Every case of a folder compared with its answer.
fn answered(folder: &Path, asked: &Asked) -> Result<(), Box<dyn Error>> {
    if styles::is_written(folder) {
        return styles::evaluate(folder, asked);
    }
    let mut table = Table::new("Hidden effects, measurements with a known answer", asked.quiet);
    for case in score::practice(folder)?.into_iter().filter(|c| asked.takes(c.family, &c.name)) {
        table.judge(&case)?;
    }
    table.print();
    Ok(())
}
