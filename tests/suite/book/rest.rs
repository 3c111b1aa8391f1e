//! The commands of `docs/rest.md`, carried out in order on a mock bench. Each block prints what the page shows below it.

use super::{code_blocks, page};
use crate::browser::has;
use crate::program::{Daemon, run, stderr, stdout};
use std::process::Command;

/// Between the outputs of two blocks.
const MARK: &str = "--- end of the block ---";

#[test]
fn the_commands_of_the_page_print_what_it_shows() {
    if let Some(missing) = ["curl", "jq"].into_iter().find(|tool| !has(tool)) {
        eprintln!("SKIPPED: {missing} is not installed. The commands of docs/rest.md were NOT carried out.");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let config = folder.path().join("bench.toml");
    // The bench of `jointbench serve`, as fast as it can.
    let described = stdout(&run(&["check", "joint-a-mock", "--print"]));
    let unpaced: Vec<&str> = described.lines().filter(|line| !line.starts_with("pace")).collect();
    std::fs::write(&config, unpaced.join("\n")).expect("the bench description is written");
    let daemon = Daemon::serve(&folder.path().join("data"), &config);

    let text = page("rest.md");
    let blocks = code_blocks(&text);
    let mut shown = Vec::new();
    let mut script = String::from("set -eu\n");
    for (at, (_, code)) in blocks.iter().enumerate().filter(|(_, (language, _))| *language == "sh") {
        let below = blocks.get(at + 1).filter(|(language, _)| *language == "text");
        shown.push(below.map_or("", |(_, output)| output.as_str()));
        script.push_str(&format!("{code}echo '{MARK}'\n"));
    }
    assert!(shown.len() >= 8, "{} blocks of commands were found", shown.len());
    let address = "http://127.0.0.1:8080";
    assert_eq!(script.matches(address).count(), 1, "the address of the daemon stands once");
    let script = script.replace(address, &daemon.base);
    let output = Command::new("sh").args(["-c", &script]).current_dir(folder.path()).output().expect("sh runs");
    let printed = stdout(&output);
    assert!(output.status.success(), "{printed}\n{}\nthe daemon's log:\n{}", stderr(&output), daemon.log());
    let end = format!("{MARK}\n");
    let printed: Vec<&str> = printed.split_terminator(&end).collect();
    assert_eq!(printed, shown, "what the commands print (left) and what docs/rest.md shows");
}
