//! `jointbench convert`: converts any readable file to a run table.

use super::arguments::Convert;
use super::exit::{Done, Exit};
use super::files;
use super::offline::understood;
use super::print::json_out;
use jointbench_files::{Understood, meta_path_of, paragraph, write};
use jointbench_instrument::Trace;
use serde_json::json;

pub fn convert(arguments: &Convert) -> Done {
    let Convert { file, meta, out, columns, .. } = arguments;
    files::writable(out)?;
    let same = |a: &std::path::Path, b: &std::path::Path| matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b);
    let (understood, table) = understood(file, meta.as_deref(), columns)?;
    if same(&table, out) {
        return Err(Exit::bad_input(format!(
            "{} would be written over itself: name another file with --out",
            out.display()
        )));
    }
    let units = understood.stated_units();
    // With a known kind, the measurement is completed and checked as a run. Other tables are written as they were read.
    let (meta, trace, notes, left) = match understood.lacks() {
        None => {
            let left = understood.left.clone();
            let (run, notes) = understood.into_run()?;
            let (meta, trace) = run.into_parts();
            (meta, trace, notes, left)
        }
        Some(lacking) => {
            let Understood { meta, trace, mut notes, left, .. } = understood;
            notes.push(lacking);
            (meta, trace, notes, left)
        }
    };
    let (mut channels, values) = trace.into_parts();
    for (name, unit) in &units {
        let of = channels.iter_mut().filter(|channel| channel.name == *name);
        of.for_each(|channel| channel.name = format!("{name} [{unit}]"));
    }
    let trace = Trace::from_columns(channels, values);
    write(out, &meta, &trace)?;
    if arguments.json {
        let names: Vec<&str> = trace.channels().iter().map(|channel| channel.name.as_str()).collect();
        json_out(&json!({ "file": out, "rows": trace.len(), "columns": names, "left": left, "notes": notes }))?;
    } else {
        let rows = if trace.len() == 1 { "row" } else { "rows" };
        println!("{} ({} {rows})", out.display(), trace.len());
        if out.extension().is_none_or(|end| end != "parquet") {
            println!("{}", meta_path_of(out).display());
        }
    }
    if !notes.is_empty() {
        eprintln!("{}: {}", table.display(), paragraph(&notes));
    }
    Ok(())
}
