//! Dependencies inside the crates: no cycle between the modules of a folder. In the model crate, stages depend only on
//! earlier ones.

use super::root;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The crates whose modules have no cycles, in any folder.
const CRATES: [&str; 3] = ["procedures/model", "procedures/procedure", "server"];

type ModulePath = Vec<String>;
/// For each module of a folder, the modules of the same folder that it depends on, with an example of a user.
type Arrows = BTreeMap<String, BTreeMap<String, String>>;

/// The pipeline as in ARCHITECTURE.md: a stage depends only on earlier stages.
const PIPELINE: [&str; 9] = [
    "signal",
    "effect",
    "preprocess",
    "regression",
    "inference",
    "residual_analysis",
    "selection",
    "diagnosis",
    // Depends on neither selection nor diagnosis: it simulates runs of a given model.
    "experiment_design",
];

#[test]
fn no_modules_of_a_folder_depend_on_each_other_in_a_circle() {
    for name in CRATES {
        for (folder, arrows) in &arrows_of(&sources(&root().join(name).join("src"))) {
            for module in arrows.keys() {
                assert!(
                    !reach(arrows, module).contains(module),
                    "{name}: {} is in a circle: {:?}",
                    [folder.clone(), vec![module.clone()]].concat().join("::"),
                    arrows[module]
                );
            }
        }
    }
}

#[test]
fn stages_of_the_model_depend_on_earlier_ones() {
    let all = arrows_of(&sources(&root().join("procedures/model/src")));
    let arrows = &all[&Vec::new()];
    for (at, stage) in PIPELINE.iter().enumerate() {
        for later in &PIPELINE[at + 1..] {
            let example = arrows.get(*stage).and_then(|to| to.get(*later));
            assert!(example.is_none(), "{stage} must not depend on {later}: {example:?}");
        }
    }
}

fn reach<'a>(arrows: &'a Arrows, from: &'a str) -> BTreeSet<&'a String> {
    let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(next) = open.pop() {
        for to in arrows.get(next).into_iter().flat_map(BTreeMap::keys) {
            if seen.insert(to) {
                open.push(to);
            }
        }
    }
    seen
}

/// Every module's source without comments and tests. The root is the empty path.
fn sources(folder: &Path) -> BTreeMap<ModulePath, String> {
    let (mut found, mut open) = (BTreeMap::new(), vec![(folder.to_owned(), Vec::new())]);
    while let Some((folder, module)) = open.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder of sources").map(|entry| entry.expect("an entry")) {
            let path = entry.path();
            let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
            let inner = [module.clone(), vec![name.clone()]].concat();
            if path.is_dir() {
                open.push((path, inner));
            } else if path.extension().is_some_and(|e| e == "rs") && name != "tests" {
                let own = if ["mod", "lib"].contains(&name.as_str()) { module.clone() } else { inner };
                found.insert(own, code(&std::fs::read_to_string(&path).expect("a source file")));
            }
        }
    }
    found
}

fn code(source: &str) -> String {
    // A declaration of a file for tests is followed by other code, a module of tests is not.
    let mut lines = source.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default().lines();
    let mut kept = Vec::new();
    while let Some(line) = lines.next() {
        if line == "#[cfg(test)]" {
            lines.next();
        } else {
            kept.push(line);
        }
    }
    kept.into_iter().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

/// Dependencies between the modules of each folder; the content of a subfolder counts for it.
fn arrows_of(sources: &BTreeMap<ModulePath, String>) -> BTreeMap<ModulePath, Arrows> {
    let exported: BTreeMap<&ModulePath, Vec<ModulePath>> = (sources.iter())
        .map(|(module, text)| (module, statements(text, "pub use ").flat_map(|tree| leaves(&tree)).collect()))
        .collect();
    let mut all: BTreeMap<ModulePath, Arrows> = BTreeMap::new();
    for (from, text) in sources.iter().filter(|(from, _)| !from.is_empty()) {
        for path in references(from, text) {
            let to = module_of(&path, sources, &exported);
            let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
            if let (Some(one), Some(other)) = (from.get(shared), to.get(shared)) {
                let arrows = all.entry(from[..shared].to_vec()).or_default();
                let example = format!("{} uses {}", from.join("::"), to.join("::"));
                arrows.entry(one.clone()).or_default().insert(other.clone(), example);
            }
        }
    }
    all
}

/// Paths of a module's source below the root of the crate, in `use` statements and in expressions.
fn references(module: &[String], text: &str) -> Vec<ModulePath> {
    let used = ["crate", "super"].into_iter().flat_map(|begin| {
        let trees = statements(text, if begin == "crate" { "use crate" } else { "use super" });
        trees.flat_map(move |tree| leaves(&format!("{begin}{tree}")))
    });
    // A path in an expression begins at `crate` or at the first `super`.
    let begins = text.match_indices("crate::").chain(text.match_indices("super::"));
    let in_place = begins.filter(|(at, _)| !text[..*at].ends_with("super::")).map(|(at, _)| {
        let rest = &text[at..];
        let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':')).unwrap_or(rest.len());
        rest[..end].split("::").filter(|s| !s.is_empty()).map(String::from).collect()
    });
    used.chain(in_place).map(|path| from_root(module, &path)).filter(|path| !path.is_empty()).collect()
}

/// `crate::a` and, in the module `a::b`, `super::c` as `a` and `a::c`.
fn from_root(module: &[String], path: &[String]) -> ModulePath {
    let up = path.iter().take_while(|part| *part == "super").count();
    match up {
        0 => path[1..].to_vec(),
        // Inline modules of a file can go up further.
        _ => [&module[..module.len().saturating_sub(up)], &path[up..]].concat(),
    }
}

fn statements<'t>(text: &'t str, begin: &'t str) -> impl Iterator<Item = String> + 't {
    text.split(begin).skip(1).filter_map(|rest| Some(rest.split_once(';')?.0.split_whitespace().collect::<String>()))
}

/// `a::{b, c::d}` as `a::b` and `a::c::d`.
fn leaves(tree: &str) -> Vec<ModulePath> {
    let Some((before, inner)) = tree.split_once('{') else {
        return vec![tree.split("::").filter(|s| !s.is_empty()).map(String::from).collect()];
    };
    let before: ModulePath = before.split("::").filter(|s| !s.is_empty()).map(String::from).collect();
    let (mut depth, mut parts) = (0, vec![String::new()]);
    for c in inner.trim_end_matches('}').chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        match c {
            ',' if depth == 0 => parts.push(String::new()),
            c => parts.last_mut().expect("one part at least").push(c),
        }
    }
    let parts = parts.iter().filter(|part| !part.is_empty());
    // `trim_end_matches` also removed braces of the last part: add them again.
    let closed = parts.map(|p| p.clone() + &"}".repeat(p.matches('{').count() - p.matches('}').count()));
    closed.flat_map(|part| leaves(&part)).map(|leaf| [before.clone(), leaf].concat()).collect()
}

/// The module of a path: the longest existing module path, or the module from which that one exports the name.
fn module_of(
    path: &[String],
    sources: &BTreeMap<ModulePath, String>,
    exported: &BTreeMap<&ModulePath, Vec<ModulePath>>,
) -> ModulePath {
    let longest = (0..=path.len()).rev().map(|n| path[..n].to_vec()).find(|module| sources.contains_key(module));
    let module = longest.unwrap_or_default();
    let Some(name) = path.get(module.len()) else { return module };
    let leaves = || exported[&module].iter();
    let from = leaves().find(|leaf| leaf.last() == Some(name));
    // A module exports the rest with `report::*`, or not at all.
    let rest = || leaves().find(|leaf| leaf.last().is_some_and(|name| name == "*"));
    match from.or_else(rest) {
        Some(leaf) if leaf[0] == "crate" => module_of(&leaf[1..], sources, exported),
        Some(leaf) => {
            let whole = [&module[..], leaf.strip_suffix(&["*".to_owned()]).unwrap_or(leaf)].concat();
            module_of(&whole, sources, exported)
        }
        None => module,
    }
}
