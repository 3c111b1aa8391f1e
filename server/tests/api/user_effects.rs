//! A user's effect, from the first wrong character to a model with it.

use crate::daemon::TestDaemon;
use crate::import::upload;
use serde_json::{Value, json};

const META: &str = r#"{"kind": "friction", "torque_constant_nm_per_a": 0.1, "gear_ratio": 50,
    "baseline": ["load_transmission", "coulomb", "viscous"]}"#;

/// Two repeats of speeds and loads, with a rub that grows with both. The noise is a linear congruential sequence.
pub fn rubbing_run(daemon: &TestDaemon, seed: u64) -> i64 {
    let mut table =
        String::from("time_s,motor_position_rad,motor_velocity_rad_s,motor_current_a,link_torque_nm,segment,repeat\n");
    let (mut time, mut position, mut segment, mut noise) = (0.0f64, 0.0f64, 0, seed);
    for repeat in 0..2 {
        for load in [2.0, 8.0, 20.0] {
            for speed in [2.0, 4.0, 8.0, 16.0, 32.0, 64.0] {
                for sign in [1.0, -1.0] {
                    let velocity: f64 = sign * speed;
                    for _ in 0..100 {
                        time += 0.004;
                        position += 0.004 * velocity;
                        noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                        let error = 4e-3 * ((noise >> 40) as f64 / (1u64 << 24) as f64 - 0.5);
                        let rub = 0.05 * (velocity / 12.0).tanh() * load / 50.0;
                        let torque = 0.03 * sign + 1e-4 * velocity + rub + load / 50.0 + error;
                        let current = torque / 0.1;
                        table += &format!("{time},{position},{velocity},{current},{load},{segment},{repeat}\n");
                    }
                    segment += 1;
                }
            }
        }
    }
    let (status, run) = upload(daemon, &table, &[("meta", META)]);
    assert_eq!(status, 201, "{run}");
    run["id"].as_i64().unwrap()
}

pub fn rub(formula: &str) -> Value {
    json!({"id": "rub", "kind": "friction", "formula": formula, "parameters": [
        {"name": "a", "unit": "1", "min": 0, "max": 1},
        {"name": "w0", "unit": "rad/s", "min": 1, "max": 100, "start": [5, 50]}]})
}

pub const RUB: &str = "tau = a * tanh(velocity / w0) * abs(load)";

#[test]
fn a_wrong_formula_is_refused_at_its_character() {
    let daemon = TestDaemon::start();
    for path in ["/api/v1/effects", "/api/v1/effects/check"] {
        let body = |effect: Value| if path.ends_with("check") { json!({ "effect": effect }) } else { effect };
        for (formula, position, length, words) in [
            ("tau = a * tanh(velocity / w1) * abs(load)", 26, 2, "neither a signal nor a parameter"),
            ("tau = a * tanh(velocity / w0 * abs(load)", 40, 0, "closing bracket"),
            ("torque = a * velocity / w0", 0, 6, "begins with tau"),
            ("tau = velocity ^ (a / w0)", 6, 18, "multiply it"),
        ] {
            let (status, problem) = daemon.post(path, &body(rub(formula)).to_string());
            assert_eq!(status, 422, "{problem}");
            let typing = json!({"effect": rub(formula), "typing": true}).to_string();
            let (status, check) = daemon.post("/api/v1/effects/check", &typing);
            assert_eq!((status, &check["mistake"]), (200, &problem["place"]), "{check}");
            assert_eq!(problem["type"], "urn:jointbench:formula");
            assert_eq!(problem["place"]["position"], position, "{problem}");
            assert_eq!((&problem["place"]["length"], &problem["place"]["text"]), (&length.into(), &formula.into()));
            assert!(problem["detail"].as_str().unwrap().contains(words), "{problem}");
        }
        let mut of_library = rub(RUB);
        of_library["id"] = "stribeck".into();
        let (status, problem) = daemon.post(path, &body(of_library).to_string());
        assert_eq!((status, &problem["place"]["field"]), (422, &"id".into()), "{problem}");
    }
    let (_, effects) = daemon.get("/api/v1/effects?kind=friction");
    assert!(effects.as_array().unwrap().iter().all(|effect| effect["definition"].is_null()), "{effects}");
}

#[test]
fn an_effect_is_defined_suggested_fitted_and_kept_while_used() {
    let daemon = TestDaemon::start();
    let run = rubbing_run(&daemon, 12_345);
    let oil = rub("tau = a * tanh(velocity / w0) * column(link_torqe_nm)");
    assert_eq!(daemon.post("/api/v1/effects/check", &json!({"effect": oil}).to_string()).0, 200);
    for asked in ["run", "columns_of"] {
        let (status, problem) = daemon.post("/api/v1/effects/check", &json!({"effect": oil, asked: run}).to_string());
        assert_eq!((status, &problem["place"]["position"]), (422, &32.into()), "{problem}");
        assert!(problem["detail"].as_str().unwrap().contains("did you mean link_torque_nm?"), "{problem}");
    }
    let bare = json!({"run": run, "effects": ["load_transmission", "coulomb", "viscous"]});
    let (_, model) = daemon.post("/api/v1/models", &bare.to_string());
    let diagnosed = |model: &Value| daemon.post("/api/v1/diagnoses", &json!({"model": model["id"]}).to_string()).1;
    let before = diagnosed(&model);
    assert_ne!(before["suggestions"][0]["effect"], "rub");
    assert_eq!(diagnosed(&model)["id"], before["id"], "nothing has changed");

    let trial = json!({"effect": rub(RUB), "run": run});
    let (status, check) = daemon.post("/api/v1/effects/check", &trial.to_string());
    assert_eq!((status, &check["linear"], &check["shape"]), (200, &json!(["a"]), &json!(["w0"])), "{check}");
    assert_eq!(check["error"]["before_rms"], model["validation_rms"], "{check}");
    let tried_rms = check["error"]["after_rms"].as_f64().unwrap();
    assert!(tried_rms < 0.5 * model["validation_rms"].as_f64().unwrap(), "{check}");
    assert!((check["parameters"][1]["value"].as_f64().unwrap() - 12.0).abs() < 1.0, "{check}");

    let dry = json!({"id": "dry", "kind": "friction", "formula": "tau = a * direction", "parameters": [{"name": "a", "unit": "Nm"}]});
    for (effects, like) in [(json!(null), json!(["coulomb"])), (json!(["load_transmission", "viscous"]), Value::Null)] {
        let trial = json!({"effect": dry, "run": run, "effects": effects});
        let (status, check) = daemon.post("/api/v1/effects/check", &trial.to_string());
        assert_eq!((status, &check["like"]), (200, &like), "{check}");
    }

    let twice = json!({"effect": rub(RUB), "run": run, "more_runs": [run]});
    assert_eq!(daemon.post("/api/v1/effects/check", &twice.to_string()).0, 422, "a run is named once");
    let more = json!({"effect": rub(RUB), "run": run, "more_runs": [rubbing_run(&daemon, 54_321)]});
    let (status, both) = daemon.post("/api/v1/effects/check", &more.to_string());
    assert_eq!(status, 200, "{both}");
    let width = |check: &Value| {
        let ci95 = check["parameters"][1]["ci95"].as_array().unwrap().clone();
        ci95[1].as_f64().unwrap() - ci95[0].as_f64().unwrap()
    };
    assert!(width(&both) < width(&check), "two runs tell more than one: {both}");

    let (status, effect) = daemon.post("/api/v1/effects", &rub(RUB).to_string());
    assert_eq!((status, &effect["version"]), (201, &1.into()), "{effect}");
    let here = format!("/api/v1/effects?run={run}");
    assert_eq!(daemon.post(&here, &rub(RUB).to_string()).1["version"], 1, "the same again");
    let (_, effects) = daemon.get("/api/v1/effects?kind=friction");
    assert_eq!(effects.as_array().unwrap().last().unwrap()["definition"]["formula"], RUB);

    let after = diagnosed(&model);
    assert_ne!(after["id"], before["id"], "there is one effect more");
    assert_eq!(after["suggestions"][0]["effect"], "rub", "{}", after["summary"]);

    let with =
        json!({"run": run, "effects": ["load_transmission", "coulomb", "viscous", "rub"], "parent": model["id"]});
    let (status, better) = daemon.post("/api/v1/models", &with.to_string());
    assert_eq!((status, &better["added"]), (201, &json!(["rub"])), "{better}");
    assert_eq!(better["fit"]["own"][0]["formula"], RUB);
    assert_eq!(better["validation_rms"], tried_rms, "a trial is the fit of the version");
    let (status, set) = daemon.get(&format!("/api/v1/models/{}/residuals", better["id"]));
    assert_eq!(status, 200, "{set}");

    let (status, problem) = daemon.delete("/api/v1/effects/friction/rub");
    assert_eq!((status, &problem["type"]), (409, &"urn:jointbench:conflict".into()), "{problem}");
    let changed = rub("tau = a * tanh(velocity / w0) * abs(load) * 2");
    assert_eq!(daemon.post("/api/v1/effects", &changed.to_string()).1["version"], 2);
    let (_, kept) = daemon.get(&format!("/api/v1/models/{}", better["id"]));
    assert_eq!(kept["fit"]["own"][0]["formula"], RUB, "a model keeps what it was fitted with");
}

#[test]
fn a_diagnosis_suggests_a_formula_only_on_runs_that_use_it() {
    let daemon = TestDaemon::start();
    let [home, other] = [12_345, 54_321].map(|seed| rubbing_run(&daemon, seed));
    assert_eq!(daemon.post(&format!("/api/v1/effects?run={home}"), &rub(RUB).to_string()).0, 201);
    let models = [home, other].map(|run| {
        let bare = json!({"run": run, "effects": ["load_transmission", "coulomb", "viscous"]});
        daemon.post("/api/v1/models", &bare.to_string()).1["id"].clone()
    });
    let suggests = |model: &Value| {
        let (_, found) = daemon.post("/api/v1/diagnoses", &json!({ "model": model }).to_string());
        let lists = ["suggestions", "silent", "not_visible", "left_out"].map(|list| found[list].as_array().unwrap());
        let tested = lists.iter().any(|list| list.iter().any(|one| one["effect"] == "rub"));
        assert_eq!(tested, found["suggestions"][0]["effect"] == "rub", "{found}");
        tested
    };
    let runs = || {
        let (_, effects) = daemon.get("/api/v1/effects?kind=friction");
        effects.as_array().unwrap().last().unwrap()["runs"].clone()
    };
    assert_eq!((models.each_ref().map(suggests), runs()), ([true, false], json!([home])));

    let here = format!("/api/v1/runs/{other}/effects/rub");
    assert_eq!(daemon.put_with(&here, b"", &[]).0, 204);
    assert_eq!((models.each_ref().map(suggests), runs()), ([true, true], json!([home, other])));
    assert_eq!(daemon.delete(&here).0, 204);
    assert_eq!((models.each_ref().map(suggests), runs()), ([true, false], json!([home])));

    for (path, status) in
        [(format!("/api/v1/runs/{other}/effects/stribeck"), 404), ("/api/v1/runs/99/effects/rub".to_owned(), 404)]
    {
        assert_eq!(daemon.put_with(&path, b"", &[]).0, status, "{path}");
    }
    // Deleted and written again, it is another effect: no run uses it.
    assert_eq!(daemon.delete("/api/v1/effects/friction/rub").0, 204);
    assert_eq!(daemon.post("/api/v1/effects", &rub(RUB).to_string()).0, 201);
    assert_eq!(runs(), Value::Null);
}

#[test]
fn an_unused_effect_can_be_deleted() {
    let daemon = TestDaemon::start();
    assert_eq!(daemon.post("/api/v1/effects", &rub(RUB).to_string()).0, 201);
    assert_eq!(daemon.delete("/api/v1/effects/friction/rub").0, 204);
    assert_eq!(daemon.delete("/api/v1/effects/friction/rub").0, 404);
    assert_eq!(daemon.delete("/api/v1/effects/friction/stribeck").0, 404);
    let (_, language) = daemon.get("/api/v1/formulas/friction");
    assert_eq!(language["left_hand_side"], "tau");
    let named = |name: &str| language["signals"].as_array().unwrap().iter().any(|s| s["name"] == name);
    assert!(named("velocity") && named("load") && !named("current"), "{language}");
}

#[test]
fn a_formula_that_is_not_finite_on_the_run_is_refused_with_words() {
    let daemon = TestDaemon::start();
    let run = rubbing_run(&daemon, 12_345);
    let effect = json!({"id": "root", "kind": "friction", "formula": "tau = a * sqrt(velocity)",
        "parameters": [{"name": "a", "unit": "Nm"}]});
    let (status, problem) = daemon.post("/api/v1/effects/check", &json!({"effect": effect, "run": run}).to_string());
    assert_eq!((status, &problem["type"]), (422, &"urn:jointbench:invalid".into()), "{problem}");
    assert!(problem["detail"].as_str().unwrap().contains("velocity = -"), "{problem}");
}

#[test]
fn every_effect_tells_all_of_itself() {
    let daemon = TestDaemon::start();
    assert_eq!(daemon.post("/api/v1/effects", &rub(RUB).to_string()).0, 201);
    let (_, effects) = daemon.get("/api/v1/effects");
    for effect in effects.as_array().unwrap() {
        for field in ["id", "sentence", "formula", "source", "looks"] {
            assert!(effect[field].as_str().is_some_and(|words| !words.is_empty()), "{field}: {effect}");
        }
        if effect["id"] == "rub" {
            assert_eq!(effect["looks"], "what is left follows its formula over velocity and load");
        }
        assert!(effect["needs"].is_array() && effect["parameters"].is_array(), "{effect}");
    }
}

#[test]
fn doubts_depend_on_the_run() {
    let daemon = TestDaemon::start();
    let run = rubbing_run(&daemon, 5);
    let doubt = |formula: &str, unit: &str, run: Option<i64>| {
        let mut effect = rub(formula);
        effect["parameters"][1]["unit"] = unit.into();
        let (status, check) =
            daemon.post("/api/v1/effects/check", &json!({"effect": effect, "columns_of": run}).to_string());
        assert_eq!(status, 200, "{check}");
        check["doubt"].as_str().unwrap_or_default().to_owned()
    };
    assert_eq!(doubt(RUB, "m/s", None), "", "a joint may slide");
    assert!(doubt(RUB, "m/s", Some(run)).contains("this is in 1/m"));
    let response = "tau = a * tanh(velocity / w0) * motor_torque";
    assert!(doubt(response, "rad/s", Some(run)).contains("the response that a friction model predicts"));
}
