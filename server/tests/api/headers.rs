//! Security headers of every answer.

use crate::daemon::TestDaemon;

#[test]
fn every_answer_carries_them_refusals_too() {
    let daemon = TestDaemon::start();
    for path in ["/", "/assets/none.js", "/api/v1/bench", "/api/v1/runs/99", "/api/v1/nothing"] {
        let answer = daemon.get_raw(path);
        let header = |name: &str| answer.headers().get(name).map(|value| value.to_str().unwrap().to_owned());
        let policy = header("content-security-policy").unwrap_or_default();
        assert!(policy.contains("default-src 'none'") && policy.contains("frame-ancestors 'none'"), "{path} {policy}");
        for (name, value) in [
            ("x-content-type-options", "nosniff"),
            ("x-frame-options", "DENY"),
            ("referrer-policy", "no-referrer"),
            ("cross-origin-resource-policy", "same-origin"),
        ] {
            assert_eq!(header(name).as_deref(), Some(value), "{path}");
        }
        assert!(header("permissions-policy").is_some_and(|policy| policy.contains("camera=()")), "{path}");
        assert_eq!(header("strict-transport-security"), None, "{path}: there is no TLS");
        let cached = header("cache-control");
        assert_eq!(cached.as_deref() == Some("no-store"), path.starts_with("/api"), "{path} {cached:?}");
    }
}
