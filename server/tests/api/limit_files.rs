//! Limits of a run: kept with it, compared with its result.

use crate::daemon::{SHORT_RUN, TestDaemon};
use serde_json::{Value, json};

const LIMITS: &str = "\
[[limit]]
part = \"P\"
quantity = \"tau_c\"
upper = 1.0
unit = \"Nm\"

[[limit]]
quantity = \"c_v\"
upper = 1e-9
unit = \"Nm·s/rad\"
";

fn start(daemon: &TestDaemon, limits: &str, part: &str) -> (u16, Value) {
    let mut new: Value = serde_json::from_str(SHORT_RUN).unwrap();
    new["unit"] = json!({"serial": "SN1", "part": part});
    new["limits"] = limits.into();
    daemon.post("/api/v1/runs", &new.to_string())
}

#[test]
fn a_result_is_compared_with_the_limits_that_are_kept_with_its_run() {
    let daemon = TestDaemon::start();
    let (status, run) = start(&daemon, LIMITS, "P");
    assert_eq!((status, &run["provenance"]["acceptance_limits"]["text"]), (201, &LIMITS.into()), "{run}");
    let id = run["id"].as_i64().unwrap();
    assert_eq!(daemon.get(&format!("/api/v1/runs/{id}/junit")).0, 409, "the run is not over");
    daemon.wait_for_end(id);

    let (_, found) = daemon.get(&format!("/api/v1/runs/{id}/identification"));
    let check = &found["limits"];
    assert_eq!(check["sha256"], run["provenance"]["acceptance_limits"]["sha256"], "{check}");
    assert_eq!(check["sha256"].as_str().map(str::len), Some(64));
    assert_eq!(check["outcome"], "fail", "{check}");
    let outcomes: Vec<_> =
        check["limits"].as_array().unwrap().iter().map(|one| (&one["quantity"], &one["outcome"])).collect();
    assert_eq!(outcomes, [(&json!("tau_c"), &json!("pass")), (&json!("c_v"), &json!("fail"))], "{check}");

    let report = daemon.get_raw(&format!("/api/v1/runs/{id}/junit")).body_mut().read_to_string().unwrap();
    assert!(report.contains("tests=\"3\"") && report.contains("name=\"c_v &lt; 0.000000001 Nm·s/rad\""), "{report}");
    let page = daemon.get_raw(&format!("/api/v1/runs/{id}/report")).body_mut().read_to_string().unwrap();
    assert!(page.contains("Limits: fail") && page.contains("1 of 2 within their limits"), "{page}");

    daemon.wait_for("/api/v1/runs?search=limits:fail", |list| list["total"] == 1);
    let list = daemon.wait_for("/api/v1/units", |list| !list["yields"].as_array().unwrap().is_empty());
    assert_eq!(
        (&list["units"][0]["newest_limits"], &list["yields"][0]["passed"]),
        (&json!("fail"), &json!(0)),
        "{list}"
    );
}

#[test]
fn a_continued_run_keeps_the_limits() {
    let daemon = TestDaemon::start();
    let (_, run) = start(&daemon, LIMITS, "P");
    let id = run["id"].as_i64().unwrap();
    daemon
        .wait_for(&format!("/api/v1/runs/{id}"), |run| run["progress"]["step"].as_u64().is_some_and(|step| step > 20));
    daemon.post(&format!("/api/v1/runs/{id}/abort"), "");
    daemon.wait_for_end(id);
    let report = daemon.get_raw(&format!("/api/v1/runs/{id}/junit")).body_mut().read_to_string().unwrap();
    assert!(report.contains("failures=\"1\" errors=\"0\" skipped=\"2\""), "{report}");
    let (_, rest) = daemon.post(&format!("/api/v1/runs/{id}/continue"), "");
    assert_eq!(rest["provenance"]["acceptance_limits"], run["provenance"]["acceptance_limits"], "{rest}");
    daemon.wait_for_end(rest["id"].as_i64().unwrap());
}

#[test]
fn limits_that_cannot_be_checked_are_refused_before_the_run() {
    let daemon = TestDaemon::start();
    for (limits, cause) in [
        ("[[limit]]\nquantity = \"tau_c\"\nlow = 1\n", "line 3"),
        ("[[limit]]\nquantity = \"tau_x\"\nupper = 1\n", "did you mean tau_c?"),
        ("[[limit]]\npart = \"Q\"\nquantity = \"tau_c\"\nupper = 1\n", "no limit applies to friction of part P"),
        (&"#".repeat(70_000), "at most 65536"),
    ] {
        let (status, problem) = start(&daemon, limits, "P");
        let detail = problem["detail"].as_str().unwrap_or_default();
        assert!(status == 422 && detail.starts_with("limits: ") && detail.contains(cause), "{problem}");
    }
    assert_eq!(daemon.get("/api/v1/runs").1["total"], 0);
}

#[test]
fn an_open_limit_says_what_would_decide() {
    let daemon = TestDaemon::start();
    let wide = "[[limit]]\nquantity = \"tau_c\"\nupper = 1.0\nunit = \"Nm\"\nguard_band = 0.9999\n";
    let (_, run) = start(&daemon, wide, "P");
    let id = run["id"].as_i64().unwrap();
    daemon.wait_for_end(id);
    let (_, found) = daemon.get(&format!("/api/v1/runs/{id}/identification"));
    let limit = &found["limits"]["limits"][0];
    assert_eq!((&limit["outcome"], &limit["decision"]["by"]), (&json!("marginal"), &json!("other_value")), "{limit}");
    assert_eq!((&limit["decision"]["procedure"], &limit["decision"]["settings"]), (&json!("friction"), &json!({})));
    assert!(limit["message"].as_str().unwrap().contains("repeats do not help"), "{limit}");

    // The guard band begins within the interval of the value.
    let quantity = found["quantities"].as_array().unwrap().iter().find(|one| one["name"] == "tau_c").unwrap();
    let (value, high) = (quantity["value"].as_f64().unwrap(), quantity["ci95"][1].as_f64().unwrap());
    let upper = value + 1.5 * (high - value);
    let near =
        format!("[[limit]]\nquantity = \"tau_c\"\nupper = {upper}\nunit = \"Nm\"\nguard_band = {}\n", high - value);
    let (_, run) = start(&daemon, &near, "P");
    let id = run["id"].as_i64().unwrap();
    daemon.wait_for_end(id);
    let (_, found) = daemon.get(&format!("/api/v1/runs/{id}/identification"));
    let limit = &found["limits"]["limits"][0];
    assert_eq!(limit["outcome"], "marginal", "{limit}");
    assert!(limit["decision"]["by"].is_string(), "{limit}");
}
