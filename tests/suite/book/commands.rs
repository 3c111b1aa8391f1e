//! Commands of the pages: each exists, with its options.

use super::{code_blocks, pages};
use crate::house::root;
use crate::program::{run, stderr, stdout};
use std::collections::BTreeMap;

/// The calls of `jointbench` in the blocks of a shell, as words.
fn calls(text: &str) -> Vec<Vec<String>> {
    let blocks = code_blocks(text).into_iter().filter(|(language, _)| *language == "sh");
    let lines: String = blocks.map(|(_, code)| code.replace("\\\n", " ")).collect();
    let commands = lines.lines().flat_map(|line| line.split(" #").next().unwrap_or_default().split([';', '|', '&']));
    let words = |command: &str| command.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let calls = commands.map(words).filter(|words| words.first().is_some_and(|word| word == "jointbench"));
    calls.map(|words| words[1..].to_vec()).collect()
}

/// The help of each command, by its words.
#[derive(Default)]
struct Helps(BTreeMap<Vec<String>, String>);

impl Helps {
    /// `Err`: why there is no such command.
    fn of(&mut self, command: &[String]) -> Result<&str, String> {
        if !self.0.contains_key(command) {
            let mut arguments: Vec<&str> = command.iter().map(String::as_str).collect();
            arguments.push("--help");
            let output = run(&arguments);
            if !output.status.success() {
                return Err(stderr(&output));
            }
            self.0.insert(command.to_vec(), stdout(&output));
        }
        Ok(&self.0[command])
    }

    /// Why a call is wrong.
    fn check(&mut self, call: &[String]) -> Result<(), String> {
        let named = |word: &&String| !word.starts_with('-');
        let mut command: Vec<String> = call.iter().take(1).filter(named).cloned().collect();
        let has_subcommands = self.of(&command)?.contains("\nCommands:\n");
        command.extend(call.get(1).filter(|_| has_subcommands && !command.is_empty()).filter(named).cloned());
        let help = self.of(&command)?;
        let is_word = |c: char| c.is_alphanumeric() || c == '-';
        let known: Vec<&str> = help.split(|c: char| !is_word(c)).filter(|word| word.starts_with('-')).collect();
        let options = call.iter().filter(|word| word.starts_with('-') && word.len() > 1);
        let unknown = options.map(|word| word.split('=').next().unwrap_or(word)).find(|word| !known.contains(word));
        unknown.map_or(Ok(()), |option| Err(format!("there is no option {option}")))
    }
}

#[test]
fn every_command_of_the_pages_exists() {
    let paths = pages().into_iter().map(|name| root().join("docs").join(name)).chain([root().join("README.md")]);
    let mut helps = Helps::default();
    let (mut count, mut wrong) = (0, Vec::new());
    for path in paths {
        let text = std::fs::read_to_string(&path).expect("a page");
        for call in calls(&text) {
            count += 1;
            if let Err(why) = helps.check(&call) {
                wrong.push(format!("{}: jointbench {}: {why}", path.display(), call.join(" ")));
            }
        }
    }
    assert!(count > 80, "only {count} commands were found");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_command_is_read_with_its_options() {
    let text = "```sh\njointbench queue add a.toml \\\n    --unit X  # --no\nset -e; jointbench runs | cat\n```\n";
    let calls = calls(text);
    assert_eq!(calls, [vec!["queue", "add", "a.toml", "--unit", "X"], vec!["runs"]]);
    let mut helps = Helps::default();
    assert_eq!(helps.check(&calls[0]), Ok(()));
    let check = |call: &[&str]| helps.check(&call.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>());
    let [option, command] = [&["queue", "add", "--batsch"][..], &["quee"]].map(check);
    assert_eq!(option, Err("there is no option --batsch".into()));
    assert!(command.is_err_and(|why| why.contains("unrecognized subcommand")));
}
