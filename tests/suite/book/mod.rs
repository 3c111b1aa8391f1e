//! The book in `docs/`: its recipes.

#[cfg(unix)]
mod ci;

use crate::house::root;
use std::path::PathBuf;

fn docs() -> PathBuf {
    root().join("docs")
}

/// A page of `docs/`.
fn page(name: &str) -> String {
    std::fs::read_to_string(docs().join(name)).unwrap_or_else(|fault| panic!("docs/{name}: {fault}"))
}
