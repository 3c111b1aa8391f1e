//! The daemon over HTTPS.

use crate::auth::FULL;
use crate::daemon::TestDaemon;
use jointbench::listener::TlsFiles;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use tempfile::TempDir;
use ureq::tls::{Certificate, RootCerts, TlsConfig};

/// A self-signed certificate for loopback.
fn certificate(folder: &Path) -> TlsFiles {
    let made = rcgen::generate_simple_self_signed(["127.0.0.1".to_owned(), "localhost".to_owned()]).unwrap();
    let files = TlsFiles { certificate: folder.join("cert.pem"), key: folder.join("key.pem") };
    std::fs::write(&files.certificate, made.cert.pem()).unwrap();
    std::fs::write(&files.key, made.signing_key.serialize_pem()).unwrap();
    files
}

fn daemon(files: &TlsFiles) -> TestDaemon {
    TestDaemon::start_with(None, |settings| {
        settings.listen = "0.0.0.0:0".parse().unwrap();
        settings.token = Some(FULL.into());
        settings.network.tls = Some(files.clone());
    })
}

fn port(daemon: &TestDaemon) -> u16 {
    daemon.address().rsplit(':').next().unwrap().parse().unwrap()
}

#[test]
fn beyond_loopback_it_answers_by_tls_and_in_no_other_way() {
    let folder = TempDir::new().unwrap();
    let files = certificate(folder.path());
    let daemon = daemon(&files);
    let root = Certificate::from_pem(&std::fs::read(&files.certificate).unwrap()).unwrap();
    let trusting = TlsConfig::builder().root_certs(RootCerts::Specific(Arc::new(vec![root]))).build();
    let agent = |tls: TlsConfig| ureq::Agent::new_with_config(ureq::Agent::config_builder().tls_config(tls).build());
    let ask = |agent: ureq::Agent, scheme: &str| {
        let address = format!("{scheme}://127.0.0.1:{}/api/v1/health", port(&daemon));
        agent.get(address).header("authorization", format!("Bearer {FULL}")).call()
    };
    let answer = ask(agent(trusting.clone()), "https").unwrap();
    assert_eq!(answer.status().as_u16(), 200);
    assert!(answer.headers()["strict-transport-security"].to_str().unwrap().starts_with("max-age="));
    assert!(ask(agent(TlsConfig::default()), "https").is_err(), "no public authority knows it");
    assert!(ask(agent(trusting), "http").is_err());
}

fn jointbench(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_jointbench"));
    for variable in
        ["JOINTBENCH_URL", "JOINTBENCH_TOKEN", "JOINTBENCH_TOKEN_FILE", "JOINTBENCH_DATA", "JOINTBENCH_CA_FILE"]
    {
        command.env_remove(variable);
    }
    command.args(arguments);
    command
}

#[test]
fn the_command_line_reaches_it_with_the_certificate_and_a_token_from_a_file() {
    let folder = TempDir::new().unwrap();
    let files = certificate(folder.path());
    let daemon = daemon(&files);
    let token: PathBuf = folder.path().join("token");
    std::fs::write(&token, FULL).unwrap();
    let url = format!("https://localhost:{}", port(&daemon));
    let (ca, token) = (files.certificate.to_str().unwrap(), token.to_str().unwrap());
    let done = jointbench(&["runs", "--daemon", &url, "--ca-file", ca, "--token-file", token]).output().unwrap();
    let stderr = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{stderr}");
    let strange = jointbench(&["runs", "--daemon", &url, "--token-file", token]).output().unwrap();
    assert_eq!(strange.status.code(), Some(2), "{}", String::from_utf8_lossy(&strange.stderr));
    // A token among the arguments also works, with a warning.
    let seen = jointbench(&["runs", "--daemon", &url, "--ca-file", ca, "--token", FULL]).output().unwrap();
    let stderr = String::from_utf8_lossy(&seen.stderr);
    assert!(seen.status.success() && stderr.contains("--token-file") && !stderr.contains(FULL), "{stderr}");
}
