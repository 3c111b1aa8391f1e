//! `jointbench import` and `jointbench export`: directly in the data folder, or through the daemon that uses it.

use super::arguments::{Columns, Export, Import, StorePlace};
use super::client::Client;
use super::exit::{Done, Exit};
use super::files::{self, table, write};
use super::serve::runtime;
use crate::api::Health;
use crate::job::Job;
use crate::lab::{
    ATTENTION, COPY_OF, Encoding, ExportRequest, FileFormat, ImportRequest, LOCAL, Lab, LabError, UNDERSTOOD,
};
use crate::view::Run;
use jointbench_files::meta_path_of;
use std::path::{Path, PathBuf};

pub fn import(arguments: &Import) -> Done {
    let runtime = runtime()?;
    let store = open(&runtime, &arguments.store, true)?;
    for file in &arguments.files {
        let file = &table(file)?;
        let request = read(file, arguments.meta.as_deref(), &arguments.columns)?;
        let run = match &store {
            Target::Folder(lab) => runtime.block_on(lab.import(request, LOCAL))?,
            Target::Daemon(client) => upload(client, &request)?,
        };
        let summary = &run.summary;
        println!("run {}: {} ({}, {} rows)", summary.id, file.display(), summary.kind, summary.rows);
        if let Some(original) = run.provenance["imported"][COPY_OF].as_i64() {
            println!("  its samples are identical to those of run {original} (a copy, not a repeat)");
        }
        if let Some(note) = run.provenance["imported"][UNDERSTOOD].as_str() {
            println!("  {note}");
        }
        for sentence in run.provenance["imported"][ATTENTION].as_array().into_iter().flatten() {
            println!("  warning: {}", sentence.as_str().unwrap_or_default());
        }
    }
    Ok(())
}

pub fn export(arguments: &Export) -> Done {
    let runtime = runtime()?;
    let (run, format) = (arguments.run, format(arguments)?);
    let safe = arguments.spreadsheet_safe;
    if safe && format != FileFormat::Csv {
        return Err(Exit::bad_input("--spreadsheet-safe requires --format csv"));
    }
    let (bytes, meta) = match open(&runtime, &arguments.store, false)? {
        Target::Folder(lab) => runtime.block_on(async {
            let encoding = Encoding::File(format);
            let request =
                ExportRequest { run, encoding, channels: None, from_s: None, to_s: None, spreadsheet_safe: safe };
            Ok::<_, LabError>((lab.answer(Job::Export(request)).await?, lab.export_meta(run).await?))
        })?,
        Target::Daemon(client) => {
            let safe = if safe { "&spreadsheet_safe=true" } else { "" };
            let bytes = client.get_bytes(&format!("/runs/{run}/export?format={}{safe}", format.extension()))?;
            (bytes, String::from_utf8_lossy(&client.get_bytes(&format!("/runs/{run}/meta"))?).into_owned())
        }
    };
    let named = || PathBuf::from(format!("run-{run}.{}", format.extension()));
    let path = arguments.out.clone().unwrap_or_else(named);
    write(&path, &bytes)?;
    println!("{}", path.display());
    if format == FileFormat::Csv {
        let meta_file = meta_path_of(&path);
        write(&meta_file, meta.as_bytes())?;
        println!("{}", meta_file.display());
    }
    Ok(())
}

/// The requested format, or the format of the file extension.
fn format(arguments: &Export) -> Result<FileFormat, Exit> {
    let ending = arguments.out.as_deref().and_then(Path::extension).and_then(|ending| ending.to_str());
    let by_name = [FileFormat::Csv, FileFormat::Parquet, FileFormat::Mat]
        .into_iter()
        .find(|format| Some(format.extension()) == ending);
    match (arguments.format, by_name) {
        (Some(asked), Some(by_name)) if asked != by_name => Err(Exit::bad_input(format!(
            "--format {} contradicts the file extension .{}: omit one of them",
            asked.extension(),
            by_name.extension()
        ))),
        (None, None) if ending.is_some() => Err(Exit::bad_input(format!(
            "unknown file extension .{}: use .csv, .parquet or .mat, or choose the format with --format",
            ending.unwrap_or_default()
        ))),
        (asked, by_name) => Ok(asked.or(by_name).unwrap_or(FileFormat::Csv)),
    }
}

pub(super) enum Target {
    Folder(Lab),
    Daemon(Client),
}

pub(super) fn open(runtime: &tokio::runtime::Runtime, place: &StorePlace, makes_it: bool) -> Result<Target, Exit> {
    // Priority: explicit address, explicit folder, address from the environment.
    let outweighed = place.data.is_some() && place.reach.daemon == std::env::var("JOINTBENCH_URL").ok();
    if place.reach.daemon.is_some() && !outweighed {
        return Ok(Target::Daemon(Client::new(&place.reach)?));
    }
    let data = place.data.as_deref().unwrap_or(Path::new("jointbench-data"));
    if !makes_it && !crate::store::Store::is_in(data) {
        let folder = data.display();
        return Err(Exit::bad_input(format!(
            "no store in {folder}: give its folder with --data, or a daemon with --daemon"
        )));
    }
    match runtime.block_on(crate::store::Store::open(data)) {
        Ok(store) => Ok(Target::Folder(Lab::of_store(store))),
        Err(in_use @ crate::store::StoreError::InUse { process, .. }) => {
            // The folder probably belongs to the daemon at the default address; verify this.
            let client = Client::new(&place.reach)?;
            match client.get::<Health>("/health") {
                Ok(health) if process == Some(health.process) => Ok(Target::Daemon(client)),
                _ => Err(Exit::bad_input(format!("{in_use}, or give the address of its daemon with --daemon"))),
            }
        }
        Err(fault) => Err(LabError::from(fault).into()),
    }
}

fn read(file: &Path, meta: Option<&Path>, columns: &Columns) -> Result<ImportRequest, Exit> {
    let meta_file = [meta_path_of(file), file.with_file_name("meta.json")].into_iter().find(|path| path.is_file());
    let carries_its_own =
        matches!(file.extension().and_then(|end| end.to_str()), Some("parquet" | "arrow" | "feather"));
    let meta = match (meta, meta_file) {
        (Some(path), _) => Some(files::read_text(path)?),
        (None, Some(path)) if !carries_its_own => Some(files::read_text(&path)?),
        _ => None,
    };
    Ok(ImportRequest {
        name: None,
        file_name: file.display().to_string(),
        file: file.to_owned(),
        meta,
        choices: columns.choices(),
    })
}

fn upload(client: &Client, request: &ImportRequest) -> Result<Run, Exit> {
    let bytes = files::read(&request.file)?;
    // Long enough not to occur in a file by chance.
    let boundary = format!("jointbench-{:032x}", rand::random::<u128>());
    let mut body = Vec::new();
    let mut part = |name: &str, bytes: &[u8]| {
        let head = format!("--{boundary}\r\nContent-Disposition: form-data; name={name}\r\n\r\n");
        body.extend_from_slice(head.as_bytes());
        body.extend_from_slice(bytes);
        body.extend_from_slice(b"\r\n");
    };
    let file_name = request.file_name.replace(['"', '\r', '\n'], "_");
    part(&format!("\"file\"; filename=\"{file_name}\""), &bytes);
    if let Some(meta) = &request.meta {
        part("\"meta\"", meta.as_bytes());
    }
    for (name, text) in request.choices.parts() {
        part(&format!("\"{name}\""), text.as_bytes());
    }
    body.extend_from_slice(format!("--{boundary}--\r\n").as_bytes());
    client.post_bytes("/runs/import", &format!("multipart/form-data; boundary={boundary}"), &body)
}
