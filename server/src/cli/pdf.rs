//! An HTML page as PDF, printed by an installed Chromium or Chrome.

use super::exit::{Done, Exit};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Explicit path of the browser.
const VARIABLE: &str = "JOINTBENCH_CHROMIUM";
/// Its usual names on PATH.
const NAMES: [&str; 5] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"];
/// A report is printed within a few seconds. The first start of a browser on a busy computer takes longer.
const MOST_TIME: Duration = Duration::from_secs(90);
const PAUSE: Duration = Duration::from_millis(50);

/// An installed browser that can print.
#[derive(Debug)]
pub struct Browser {
    program: PathBuf,
}

impl Browser {
    /// The browser that is named in the environment, otherwise the first one on PATH.
    pub fn find() -> Result<Self, Exit> {
        Self::among(std::env::var_os(VARIABLE), std::env::var_os("PATH"))
    }

    fn among(named: Option<OsString>, folders: Option<OsString>) -> Result<Self, Exit> {
        if let Some(program) = named.map(PathBuf::from).filter(|program| !program.as_os_str().is_empty()) {
            return match program.is_file() {
                true => Ok(Self { program }),
                false => Err(Exit::bad_input(format!(
                    "{VARIABLE}={} is not a file: give the path of Chromium or Chrome",
                    program.display()
                ))),
            };
        }
        let folders: Vec<PathBuf> = folders.iter().flat_map(std::env::split_paths).collect();
        let there = NAMES.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
        there.into_iter().find(|program| program.is_file()).map(|program| Self { program }).ok_or_else(|| {
            Exit::bad_input(format!(
                "a PDF needs Chromium or Chrome, and PATH contains none of {}: install it (Debian: apt-get install \
                 chromium), or give its path in {VARIABLE}. A report as .html needs no browser.",
                NAMES.join(", ")
            ))
        })
    }

    /// Writes the complete file or nothing.
    pub fn print(&self, page: &[u8], path: &Path) -> Done {
        self.print_within(page, path, MOST_TIME)
    }

    fn print_within(&self, page: &[u8], path: &Path, most: Duration) -> Done {
        let unwritten = |fault: std::io::Error| Exit::bad_input(format!("{}: {fault}", path.display()));
        // Next to the file: a browser from a snap package can neither read nor write in /tmp.
        let parent = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = tempfile::Builder::new().prefix("jointbench-pdf-").tempdir_in(parent).map_err(unwritten)?;
        let inside = fs::canonicalize(folder.path()).map_err(unwritten)?;
        let (source, printed) = (inside.join("report.html"), inside.join("report.pdf"));
        fs::write(&source, page).map_err(unwritten)?;
        let messages = inside.join("messages.txt");
        let stderr = fs::File::create(&messages).map_err(unwritten)?;
        let started = self.command(&inside, &source, &printed).stderr(stderr).spawn();
        self.wait(&mut started.map_err(|fault| self.failed(&fault.to_string()))?, most)?;
        let is_whole = |pdf: Vec<u8>| pdf.starts_with(b"%PDF-") && pdf.trim_ascii_end().ends_with(b"%%EOF");
        if !fs::read(&printed).is_ok_and(is_whole) {
            let stderr = String::from_utf8_lossy(&fs::read(&messages).unwrap_or_default()).into_owned();
            return Err(self.failed(stderr.lines().rfind(|line| !line.trim().is_empty()).unwrap_or_default()));
        }
        fs::rename(&printed, path).map_err(unwritten)
    }

    fn command(&self, folder: &Path, source: &Path, printed: &Path) -> Command {
        let option = |name: &str, value: &Path| {
            let mut text = OsString::from(name);
            text.push(value);
            text
        };
        let mut command = Command::new(&self.program);
        command.args(["--headless", "--disable-gpu", "--no-first-run", "--no-pdf-header-footer"]);
        // A profile of its own: the browser of the user may be open.
        command.arg(option("--user-data-dir=", &folder.join("profile")));
        command.arg(option("--print-to-pdf=", printed));
        // Chromium refuses to start as root with its sandbox.
        #[cfg(unix)]
        if rustix::process::geteuid().is_root() {
            command.arg("--no-sandbox");
        }
        command.arg(source).stdin(Stdio::null()).stdout(Stdio::null());
        command
    }

    /// Waits for the end of the browser.
    fn wait(&self, child: &mut Child, most: Duration) -> Done {
        let begin = Instant::now();
        loop {
            match child.try_wait() {
                Ok(Some(_)) => return Ok(()),
                Ok(None) if begin.elapsed() < most => std::thread::sleep(PAUSE),
                Ok(None) => {
                    let _ = child.kill();
                    let _ = child.wait();
                    return Err(self.failed(&format!("no PDF after {} s", most.as_secs())));
                }
                Err(fault) => return Err(self.failed(&fault.to_string())),
            }
        }
    }

    fn failed(&self, why: &str) -> Exit {
        let why = if why.trim().is_empty() { "it wrote no PDF" } else { why.trim() };
        Exit::failed(format!(
            "{} did not print the report: {why}. Write the report as .html, open it in a browser and print it.",
            self.program.display()
        ))
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use tempfile::TempDir;

    /// A program in the place of the browser.
    fn browser(script: &str) -> (TempDir, Browser) {
        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().join("chromium");
        let text = format!("#!/bin/sh\nfor a; do case $a in --print-to-pdf=*) out=${{a#*=}};; esac; done\n{script}\n");
        // Written by another process: a file that this one has just closed may still be busy.
        let write = "printf '%s' \"$1\" > \"$0\" && chmod 755 \"$0\"";
        assert!(Command::new("sh").args(["-c", write]).arg(&program).arg(text).status().unwrap().success());
        (folder, Browser { program })
    }

    fn printed(script: &str, most: Duration) -> (Result<(), Exit>, Vec<String>) {
        let (_program, browser) = browser(script);
        let folder = tempfile::tempdir().unwrap();
        let done = browser.print_within(b"<p>page</p>", &folder.path().join("out.pdf"), most);
        let names = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        (done, names.collect())
    }

    #[test]
    fn a_complete_file_alone_stays() {
        let (done, left) = printed("printf '%%PDF-1.4 page %%%%EOF\\n' > \"$out\"", MOST_TIME);
        assert!(done.is_ok() && left == ["out.pdf"], "{left:?}");
    }

    #[test]
    fn nothing_stays_of_a_failure() {
        for (script, why) in [
            ("echo 'no display' >&2; exit 1", "no display"),
            ("exit 0", "it wrote no PDF"),
            ("printf '%%PDF-1.4 half' > \"$out\"", "it wrote no PDF"),
        ] {
            let (done, left) = printed(script, MOST_TIME);
            let message = done.unwrap_err().message;
            assert!(message.contains(why) && message.contains(".html"), "{message}");
            assert!(left.is_empty(), "{script}: {left:?}");
        }
    }

    #[test]
    fn a_browser_that_hangs_is_ended() {
        let (done, left) = printed("exec sleep 60", Duration::from_millis(300));
        assert!(done.unwrap_err().message.contains("no PDF after 0 s") && left.is_empty(), "{left:?}");
    }

    #[test]
    fn the_named_browser_has_priority_and_its_absence_is_an_error() {
        let (folder, _) = browser("");
        let on_path = Some(folder.path().as_os_str().to_owned());
        assert!(Browser::among(None, on_path.clone()).unwrap().program.starts_with(folder.path()));
        let absent = Browser::among(Some("/nowhere/chrome".into()), on_path).unwrap_err().message;
        assert!(absent.contains("JOINTBENCH_CHROMIUM=/nowhere/chrome is not a file"), "{absent}");
        let none = Browser::among(None, None).unwrap_err().message;
        assert!(none.contains("apt-get install chromium") && none.contains("JOINTBENCH_CHROMIUM"), "{none}");
    }
}
