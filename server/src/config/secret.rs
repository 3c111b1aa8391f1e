//! Secrets from protected files and from the environment.

use std::fmt;
use std::io::Read;
use std::path::Path;

/// Limit of a file with a secret, which is one short line.
const LONGEST_BYTES: u64 = 4096;

/// A password or a signing key. It is never printed.
#[derive(Clone, PartialEq, Eq)]
pub struct Secret(String);

impl Secret {
    pub fn new(text: impl Into<String>) -> Self {
        Self(text.into())
    }

    pub fn reveal(&self) -> &str {
        &self.0
    }
}

impl fmt::Debug for Secret {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Secret(…)")
    }
}

/// The one line of a file. Warns if all users of the computer can read the file.
///
/// # Errors
/// Why the file has no secret, without its name.
pub fn read_secret(file: &Path) -> Result<String, String> {
    let opened = std::fs::File::open(file).map_err(|fault| format!("cannot be read ({fault})"))?;
    warn_if_shared(file, &opened);
    let mut text = String::new();
    opened.take(LONGEST_BYTES).read_to_string(&mut text).map_err(|fault| format!("is not a text file ({fault})"))?;
    match text.trim() {
        "" => Err("is empty: generate a secret with `openssl rand -hex 24`".into()),
        secret if secret.contains('\n') => Err("has more than one line: write only the secret".into()),
        secret => Ok(secret.to_owned()),
    }
}

#[cfg(unix)]
fn warn_if_shared(file: &Path, opened: &std::fs::File) {
    use std::os::unix::fs::PermissionsExt;
    const OTHERS: u32 = 0o007;
    if opened.metadata().is_ok_and(|opened| opened.permissions().mode() & OTHERS != 0) {
        let file = file.display();
        eprintln!("jointbench: {file} is readable by all users of this computer: chmod 600 {file}");
    }
}

#[cfg(not(unix))]
fn warn_if_shared(_: &Path, _: &std::fs::File) {}
