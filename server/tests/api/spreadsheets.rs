//! Exports for a spreadsheet.

use crate::daemon::TestDaemon;
use crate::import::upload;

#[test]
fn no_text_of_a_safe_csv_becomes_a_formula() {
    let daemon = TestDaemon::start();
    let table = "time_s,motor_position_rad,motor_current_a,=cmd()\n0,0,-0.1,1\n0.004,0.01,0.2,2\n0.008,0.02,0.1,3\n";
    let meta = r#"{"kind": "friction", "torque_constant_nm_per_a": 0.04}"#;
    let (status, run) = upload(&daemon, table, &[("meta", meta)]);
    assert_eq!(status, 201, "{run}");
    let export = |safe: &str| {
        let path = format!("/api/v1/runs/{}/export?format=csv{safe}", run["id"]);
        daemon.get_raw(&path).body_mut().read_to_string().unwrap()
    };
    let (plain, safe) = (export(""), export("&spreadsheet_safe=true"));
    assert!(plain.lines().next().unwrap().ends_with(",=cmd()"), "{plain}");
    assert!(safe.lines().next().unwrap().ends_with(",'=cmd()"), "{safe}");
    assert_eq!(safe.lines().skip(1).collect::<Vec<_>>(), plain.lines().skip(1).collect::<Vec<_>>());

    let page = r#"{"head": ["+a", "b"], "rows": [["@sum", -1.5], ["-1", null]]}"#;
    let json = [("content-type", "application/json")];
    let written = |safe: &str| {
        let path = format!("/api/v1/tables?format=csv{safe}");
        daemon.post_raw(&path, page.as_bytes(), &json).body_mut().read_to_string().unwrap()
    };
    assert_eq!(written(""), "+a,b\n@sum,-1.5\n-1,\n");
    assert_eq!(written("&spreadsheet_safe=true"), "'+a,b\n'@sum,-1.5\n-1,\n");
}
