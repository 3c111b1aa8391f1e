//! Data of a daemon that other users of the computer can see.

use crate::auth::{FULL, READS};
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use tempfile::TempDir;

#[test]
#[cfg(target_os = "linux")]
fn a_token_among_the_arguments_is_in_no_list_of_processes_and_opens_the_door() {
    let data = TempDir::new().unwrap();
    let mut daemon = Command::new(env!("CARGO_BIN_EXE_jointbench"))
        .args(["serve", "--listen", "127.0.0.1:0", "--token", FULL, &format!("--read-token={READS}"), "--data"])
        .arg(data.path())
        .env_remove("JOINTBENCH_TOKEN_FILE")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(daemon.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let base = line.split_whitespace().find(|word| word.starts_with("http://")).expect(&line);
    let of_process = |what: &str| std::fs::read_to_string(format!("/proc/{}/{what}", daemon.id())).unwrap();
    let (arguments, name) = (of_process("cmdline"), of_process("comm"));
    let with = |token: &str| {
        let agent = ureq::Agent::new_with_config(ureq::Agent::config_builder().http_status_as_error(false).build());
        let asked = agent.get(format!("{base}/api/v1/tokens")).header("authorization", format!("Bearer {token}"));
        asked.call().unwrap().status().as_u16()
    };
    let answered = [FULL, READS, "wrong horse battery"].map(with);
    daemon.kill().unwrap();
    let stderr = String::from_utf8_lossy(&daemon.wait_with_output().unwrap().stderr).into_owned();
    assert!(arguments.contains("serve") && !arguments.contains("horse"), "{arguments}");
    assert_eq!(name.trim(), "jointbench");
    assert_eq!(answered, [200, 403, 401]);
    assert!(stderr.contains("--token-file") && stderr.contains("127.0.0.1"), "the warning, and the source: {stderr}");
    assert!(!stderr.contains("horse"), "{stderr}");
}
