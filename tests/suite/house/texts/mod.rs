//! Every text for users is standard English (docs/glossary.md): command line help, procedures, effects, API
//! description, strings for results, events and errors, and the documents.

mod banned;
mod dashboard;
mod documents;
mod literals;

use super::root;
use crate::program::{run, stdout};
use banned::{MOST_WORDS, MOST_WORDS_OF_DOCUMENTS, banned, long_sentences};
use jointbench_instrument::Kind;
use jointbench_model::effects;
use serde_json::Value;
use std::path::Path;

/// Folders and files whose strings are messages for users.
const SPOKEN: [&str; 17] = [
    "procedures/procedure/src",
    "procedures/model/src",
    "drivers/files/src",
    "drivers/instrument/src",
    "drivers/devices/src",
    "fleet/src",
    "server/src/api",
    "server/src/archive",
    "server/src/bench",
    "server/src/cli",
    "server/src/config",
    "server/src/error.rs",
    "server/src/job",
    "server/src/lab",
    "server/src/notify",
    "server/src/report",
    "server/src/view",
];

/// A text and its source.
type Text = (String, String);

fn assert_plain(texts: impl IntoIterator<Item = Text>, least: usize) {
    let texts: Vec<Text> = texts.into_iter().collect();
    assert!(texts.len() >= least, "only {} texts were found", texts.len());
    let of = |(place, text): &Text| banned(text).map(|phrase| format!("{place}: “{phrase}” in: {text}"));
    let wrong: Vec<String> = texts.iter().filter_map(of).collect();
    assert!(wrong.is_empty(), "{} texts with words that docs/glossary.md replaces:\n{}", wrong.len(), wrong.join("\n"));
}

fn assert_short(texts: impl IntoIterator<Item = Text>, most_words: usize) {
    let long = |(place, text): Text| {
        let sentences = long_sentences(&text, most_words).into_iter();
        sentences.map(|sentence| format!("{place}: {sentence}")).collect::<Vec<_>>()
    };
    let wrong: Vec<String> = texts.into_iter().flat_map(long).collect();
    assert!(wrong.is_empty(), "{} sentences are longer than {most_words} words:\n{}", wrong.len(), wrong.join("\n"));
}

/// The names of the subcommands in a help text.
fn subcommands(help: &str) -> Vec<String> {
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names = listed.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    names.filter_map(|line| Some(line.split_whitespace().next()?.to_owned())).filter(|name| name != "help").collect()
}

fn helps(command: &[&str]) -> Vec<Text> {
    let help = stdout(&run(&[command, &["--help"]].concat()));
    let below = subcommands(&help);
    let place = format!("jointbench {} --help", command.join(" "));
    let more = below.iter().flat_map(|name| helps(&[command, &[name.as_str()]].concat()));
    // As one text, because a phrase may continue on the next line.
    [(place, help)].into_iter().chain(more).collect()
}

fn procedures() -> Vec<Text> {
    let listed = stdout(&run(&["procedures"]));
    let ids = listed.lines().map_while(|line| line.split_whitespace().next());
    let described = |id: &str| {
        let text = stdout(&run(&["procedures", id]));
        text.lines().map(|line| (format!("procedure {id}"), line.to_owned())).collect::<Vec<_>>()
    };
    ids.flat_map(described).collect()
}

fn library() -> Vec<Text> {
    let infos = Kind::ALL.into_iter().flat_map(effects).map(|effect| effect.info());
    let texts = infos.flat_map(|one| {
        [
            ("title", one.title),
            ("sentence", one.sentence),
            ("looks", one.looks),
            ("formula", one.formula),
            ("source", one.source),
        ]
        .map(|(field, text)| (format!("effect {}, {field}", one.id), text.to_owned()))
    });
    texts.collect()
}

/// Summaries, descriptions and titles of the snapshot that `server/src/api/specification.rs` checks.
fn described(value: &Value, place: &str) -> Vec<Text> {
    match value {
        Value::Object(fields) => fields
            .iter()
            .flat_map(|(name, value)| match (name.as_str(), value.as_str()) {
                ("summary" | "description" | "title", Some(text)) => vec![(place.to_owned(), text.to_owned())],
                _ => described(value, &format!("{place}/{name}")),
            })
            .collect(),
        Value::Array(items) => items.iter().flat_map(|item| described(item, place)).collect(),
        _ => Vec::new(),
    }
}

#[test]
fn the_help_of_every_command_is_standard_english() {
    assert_plain(helps(&[]), 25);
}

#[test]
fn procedures_and_their_parameters_are_standard_english() {
    let texts = procedures();
    assert_short(texts.clone(), MOST_WORDS);
    assert_plain(texts, 150);
}

#[test]
fn effects_are_standard_english_and_cite_what_is_published() {
    let texts = library();
    assert_short(texts.iter().filter(|(place, _)| !place.ends_with("formula")).cloned(), MOST_WORDS);
    assert_plain(texts, 200);
}

#[test]
fn the_description_of_the_api_is_standard_english() {
    let text = std::fs::read_to_string(root().join("server/openapi.json")).expect("the snapshot");
    let snapshot: Value = serde_json::from_str(&text).expect("JSON");
    assert_plain(described(&snapshot, ""), 500);
}

#[test]
fn strings_of_the_sources_are_standard_english() {
    let of = |folder: &&str| literals::under(&root(), Path::new(folder));
    assert_plain(SPOKEN.iter().flat_map(of), 1000);
}

#[test]
fn the_dashboard_is_standard_english() {
    assert_plain(dashboard::under(&root(), Path::new("web/app")), 500);
}

#[test]
fn the_documents_are_standard_english() {
    let (mut prose, mut rows) = (Vec::new(), Vec::new());
    for (file, block) in documents::under(&root()) {
        let kind = if block.is_table_row { &mut rows } else { &mut prose };
        kind.push((format!("{file}:{}", block.line), block.text));
    }
    assert_short(prose.clone(), MOST_WORDS_OF_DOCUMENTS);
    assert_plain([prose, rows].concat(), 1000);
}
