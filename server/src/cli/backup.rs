//! `jointbench backup` and `jointbench restore`.

use super::arguments::Backup;
use super::exit::{Done, Exit};
use super::serve::runtime;
use crate::lab::LabError;
use crate::store;

pub fn backup(arguments: &Backup) -> Done {
    let (file, data) = (&arguments.file, &arguments.data);
    let report = runtime()?.block_on(store::backup(data, file)).map_err(LabError::from)?;
    match report.damaged.first() {
        None => {
            println!("{}: runs: {}; rows of samples: {}", file.display(), report.runs, report.rows);
            Ok(())
        }
        Some(first) => Err(Exit::failed(format!(
            "{} was written, but contains the damage of the store ({}: {}): `jointbench verify` lists all",
            file.display(),
            first.table,
            first.what
        ))),
    }
}

pub fn restore(arguments: &Backup) -> Done {
    let (file, data) = (&arguments.file, &arguments.data);
    let aside = runtime()?.block_on(store::restore(data, file)).map_err(LabError::from)?;
    println!("{} now contains {}", data.display(), file.display());
    if let Some(aside) = aside {
        println!("the previous store is in {}", aside.display());
    }
    Ok(())
}
