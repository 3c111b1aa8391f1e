//! Export of the tables of a page.

use crate::daemon::TestDaemon;
use jointbench_files::{ReadOptions, read_bytes};
use jointbench_instrument::{Kind, Meta};
use serde_json::json;

#[test]
fn a_table_leaves_as_csv_and_as_parquet() {
    let daemon = TestDaemon::start();
    let write = |format: &str, body: &serde_json::Value| {
        let headers = [("content-type", "application/json")];
        let mut file =
            daemon.post_raw(&format!("/api/v1/tables?format={format}"), body.to_string().as_bytes(), &headers);
        (file.status().as_u16(), file.body_mut().read_to_vec().unwrap())
    };
    let table = json!({"head": ["series", "x [s]", "x [s]"], "rows": [["a, b", 0.1, null], ["c", 2, -1e-9]]});
    let (status, csv) = write("csv", &table);
    assert_eq!(status, 200);
    assert_eq!(String::from_utf8(csv).unwrap(), "series,x [s],x [s] (2)\n\"a, b\",0.1,\nc,2,-0.000000001\n");
    let ragged = json!({"head": ["x"], "rows": [[1], [1, 2]]});
    assert_eq!(write("csv", &ragged).0, 422);
    for format in ["csv", "parquet"] {
        assert_eq!(write(format, &json!({"head": [], "rows": []})).0, 422, "{format}");
    }

    let rows: Vec<[f64; 3]> = (0..200).map(f64::from).map(|i| [0.01 * i, 0.1 * i, (0.03 * i).sin()]).collect();
    let head = ["time_s", "motor_position_rad", "motor_current_a"];
    let (status, parquet) = write("parquet", &json!({"head": head, "rows": rows}));
    assert_eq!(status, 200);
    let meta = Meta { kind: Some(Kind::Friction), torque_constant_nm_per_a: Some(0.1), ..Meta::default() };
    let options = ReadOptions { meta: Some(meta), ..ReadOptions::default() };
    let again = read_bytes("drawn.parquet", &parquet, &options).unwrap();
    for (place, name) in head.into_iter().enumerate() {
        let column: Vec<f64> = rows.iter().map(|row| row[place]).collect();
        assert_eq!(again.column(name), Some(&column[..]), "{name}");
    }
}
