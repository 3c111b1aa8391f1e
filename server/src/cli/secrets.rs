//! Tokens from protected sources: files, systemd credentials, environment.

use super::arguments::{Reach, ServedTokens};
use super::exit::Exit;
use crate::config::read_secret;
use crate::program::TOKENS;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// Folder of the files from systemd (`LoadCredential=`).
const CREDENTIALS: &str = "CREDENTIALS_DIRECTORY";
const CREDENTIAL: &str = "jointbench-token";
const READ_CREDENTIAL: &str = "jointbench-read-token";
/// Options with a secret value, with the environment variables that replace them.
const SECRET: [(&str, &str); 2] = [("--token", TOKENS[0]), ("--read-token", TOKENS[1])];

/// The tokens of a daemon: full access and read access.
pub fn of_daemon(given: &ServedTokens) -> Result<[Option<String>; 2], Exit> {
    let token = choose(given.token_file.as_deref(), given.token.clone(), credential(CREDENTIAL))?;
    let read = choose(given.read_token_file.as_deref(), given.read_token.clone(), credential(READ_CREDENTIAL))?;
    Ok([token, read])
}

/// The token that a client sends.
pub fn of_client(reach: &Reach) -> Result<Option<String>, Exit> {
    choose(reach.token_file.as_deref(), reach.token.clone(), None)
}

/// Priority: named file, given value, credential.
fn choose(file: Option<&Path>, given: Option<String>, credential: Option<PathBuf>) -> Result<Option<String>, Exit> {
    match (file, given, credential) {
        (Some(file), _, _) => read(file).map(Some),
        (None, Some(given), _) => Ok(Some(given)),
        (None, None, credential) => credential.as_deref().map(read).transpose(),
    }
}

fn credential(name: &str) -> Option<PathBuf> {
    let file = PathBuf::from(std::env::var_os(CREDENTIALS)?).join(name);
    file.is_file().then_some(file)
}

fn read(file: &Path) -> Result<String, Exit> {
    read_secret(file).map_err(|why| Exit::bad_input(format!("token file {}: {why}", file.display())))
}

/// Removes tokens from the arguments, which all users of the computer can see (`ps`). The program restarts itself with
/// the tokens in its environment. Returns if the arguments contain no token.
pub fn hide_tokens() -> Result<(), Exit> {
    let given: Vec<OsString> = std::env::args_os().skip(1).collect();
    let (rest, secrets) = parted(&given);
    match secrets.is_empty() {
        true => Ok(()),
        false => start_again(&rest, &secrets),
    }
}

type Secrets = Vec<(&'static str, OsString)>;

/// The arguments without tokens, and the tokens with their variables.
fn parted(given: &[OsString]) -> (Vec<OsString>, Secrets) {
    let (mut rest, mut secrets) = (Vec::new(), Secrets::new());
    let mut left = given.iter();
    while let Some(one) = left.next() {
        if one == "--" {
            rest.push(one.clone());
            rest.extend(left.by_ref().cloned());
            break;
        }
        let text = one.to_str().unwrap_or_default();
        let option = SECRET.into_iter().find(|(option, _)| text.split('=').next() == Some(option));
        let value = option.and_then(|(option, _)| match text.strip_prefix(option) {
            Some("") => left.next().cloned(),
            value => value.map(|value| OsString::from(value.trim_start_matches('='))),
        });
        match (option, value) {
            (Some((_, variable)), Some(value)) => secrets.push((variable, value)),
            // The argument parser reports an option without a value.
            _ => rest.push(one.clone()),
        }
    }
    (rest, secrets)
}

#[cfg(unix)]
fn start_again(rest: &[OsString], secrets: &Secrets) -> Result<(), Exit> {
    use std::os::unix::process::CommandExt;
    warn("it has been removed from the process list");
    let name = std::env::args_os().next().unwrap_or_else(|| OsStr::new("jointbench").to_owned());
    // Uses the path, so that the process list still shows the name of the program.
    let program = std::env::current_exe().unwrap_or_else(|_| crate::program::path());
    let mut command = std::process::Command::new(program);
    command.arg0(name).args(rest).envs(secrets.iter().map(|(variable, value)| (variable, value)));
    // Returns only on failure.
    Err(Exit::failed(format!(
        "the token cannot be removed from the process list ({}): use --token-file",
        command.exec()
    )))
}

#[cfg(not(unix))]
fn start_again(_: &[OsString], _: &Secrets) -> Result<(), Exit> {
    warn("it remains there");
    Ok(())
}

fn warn(what_becomes_of_it: &str) {
    eprintln!(
        "jointbench: a token in the arguments is visible to all users of this computer and stored in the shell \
         history; {what_becomes_of_it}. Use --token-file or JOINTBENCH_TOKEN"
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arguments(line: &str) -> Vec<OsString> {
        line.split(' ').map(OsString::from).collect()
    }

    #[test]
    fn tokens_leave_the_arguments_and_nothing_else_does() {
        let secret = |variable, value: &str| (variable, OsString::from(value));
        for (line, rest, secrets) in [
            ("serve --token abc --listen x", "serve --listen x", vec![secret("JOINTBENCH_TOKEN", "abc")]),
            ("serve --token=a=b", "serve", vec![secret("JOINTBENCH_TOKEN", "a=b")]),
            ("serve --read-token r", "serve", vec![secret("JOINTBENCH_READ_TOKEN", "r")]),
            ("serve --token-file f --tokens", "serve --token-file f --tokens", vec![]),
            ("serve --token", "serve --token", vec![]),
            ("runs -- --token abc", "runs -- --token abc", vec![]),
        ] {
            assert_eq!(parted(&arguments(line)), (arguments(rest), secrets), "{line}");
        }
    }

    #[test]
    fn a_file_holds_one_token_alone() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("token");
        let of = |text: &str| {
            std::fs::write(&file, text).unwrap();
            choose(Some(&file), Some("given".into()), None).map_err(|exit| exit.message)
        };
        assert_eq!(of("correct horse battery\n").unwrap().as_deref(), Some("correct horse battery"));
        assert!(of(" \n").unwrap_err().contains("openssl rand"));
        assert!(of("one\ntwo").unwrap_err().contains("more than one line"));
        assert_eq!(choose(None, Some("given".into()), Some(file)).unwrap().as_deref(), Some("given"));
        let none = choose(Some(Path::new("/no/such/file")), None, None).unwrap_err();
        assert!(none.code == 2 && none.message.contains("/no/such/file"), "{}", none.message);
    }
}
