//! Measurements by others and practice cases, which lie beside the project and are not part of it.

use crate::house::root;
use std::path::PathBuf;

/// A place below `../shared`, or `None` with a message where it is missing: such a test is skipped.
pub fn shared(place: &str) -> Option<PathBuf> {
    let path = root().join("../shared").join(place);
    if path.exists() {
        return Some(path);
    }
    eprintln!("SKIPPED: ../shared/{place} is not here");
    None
}
