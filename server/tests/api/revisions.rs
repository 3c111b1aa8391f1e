//! Model versions: comparison, evaluation on other runs, export and import.

use crate::daemon::TestDaemon;
use crate::user_effects::{RUB, rub, rubbing_run};
use serde_json::{Value, json};

struct Two {
    daemon: TestDaemon,
    run: i64,
    bare: Value,
    better: Value,
}

fn two_versions() -> Two {
    let daemon = TestDaemon::start();
    let run = rubbing_run(&daemon, 12_345);
    assert_eq!(daemon.post("/api/v1/effects", &rub(RUB).to_string()).0, 201);
    let fit = |effects: Value| {
        let (status, model) = daemon.post("/api/v1/models", &json!({"run": run, "effects": effects}).to_string());
        assert_eq!(status, 201, "{model}");
        model
    };
    let bare = fit(json!(["load_transmission", "coulomb", "viscous"]));
    let better = fit(json!(["load_transmission", "coulomb", "viscous", "rub"]));
    Two { daemon, run, bare, better }
}

fn text(daemon: &TestDaemon, path: &str) -> String {
    daemon.get_raw(path).into_body().read_to_string().unwrap()
}

#[test]
fn a_run_has_one_first_version_however_many_pages_open_it() {
    let daemon = TestDaemon::start();
    let run = rubbing_run(&daemon, 12_345);
    let first = |effects: Value| {
        let (status, model) = daemon.post("/api/v1/models", &json!({"run": run, "effects": effects}).to_string());
        assert_eq!(status, 201, "{model}");
        model["id"].clone()
    };
    let bare = || first(json!(["load_transmission", "coulomb", "viscous"]));
    let ids: Vec<Value> = std::thread::scope(|scope| {
        let pages: Vec<_> = (0..3).map(|_| scope.spawn(bare)).collect();
        pages.into_iter().map(|page| page.join().unwrap()).collect()
    });
    assert!(ids.iter().all(|id| *id == ids[0]), "{ids:?}");
    assert_ne!(first(json!(["load_transmission", "coulomb"])), ids[0], "another set is another version");
    assert_eq!(daemon.get(&format!("/api/v1/models?run={run}")).1.as_array().unwrap().len(), 2);
}

#[test]
fn a_trial_is_no_version_until_it_is_kept() {
    let Two { daemon, run, bare, better } = two_versions();
    let listed = || daemon.get(&format!("/api/v1/runs?search=id:{run}")).1["runs"][0]["model"]["id"].clone();
    let asked = json!({"run": run, "effects": better["effects"], "parent": bare["id"], "tried": true});
    let (status, tried) = daemon.post("/api/v1/models", &asked.to_string());
    assert_eq!((status, &tried["tried"], listed()), (201, &json!(true), better["id"].clone()), "{tried}");
    let (status, kept) = daemon.post(&format!("/api/v1/models/{}/keep", tried["id"]), "");
    assert_eq!((status, &kept["tried"], listed()), (200, &json!(false), tried["id"].clone()), "{kept}");
    let file = daemon.get_raw(&format!("/api/v1/models/{}/export?format=json", kept["id"]));
    let name = file.headers()["content-disposition"].to_str().unwrap();
    assert!(name.contains(&format!("run-{run}-model-{}.json", kept["id"])), "{name}");
}

#[test]
fn two_versions_stand_side_by_side() {
    let Two { daemon, run, bare, better } = two_versions();
    let (status, found) = daemon.get(&format!("/api/v1/models/{}/compare/{}", bare["id"], better["id"]));
    assert_eq!(status, 200, "{found}");
    assert_eq!((&found["added"], &found["removed"]), (&json!(["rub"]), &json!([])));
    assert!(found["second"]["rms"].as_f64() < found["first"]["rms"].as_f64(), "{found}");
    let pair = |name: &str| found["parameters"].as_array().unwrap().iter().find(|p| p["name"] == name).unwrap().clone();
    assert!(pair("a")["first"].is_null() && pair("a")["differ"].is_null() && pair("a")["second"]["value"].is_f64());
    assert!(pair("tau_c")["differ"].is_boolean(), "{found}");
    let width = |one: &Value| one["ci95"][1].as_f64().unwrap() - one["ci95"][0].as_f64().unwrap();
    for pair in found["parameters"].as_array().unwrap().iter().filter(|pair| pair["differ"].is_boolean()) {
        let times = width(&pair["second"]) / width(&pair["first"]);
        assert_eq!(pair["wider"].is_object(), !(1.0 / 1.5..=1.5).contains(&times), "{pair}");
        if pair["wider"].is_object() {
            assert_eq!(pair["wider"]["second"], times > 1.0);
            assert!(pair["wider"]["why"].as_str().unwrap().len() > 10, "{pair}");
        }
    }
    let (status, held) =
        daemon.post(&format!("/api/v1/models/{}/evaluate", better["id"]), &json!({"run": run}).to_string());
    assert_eq!((status, &held["rms"]), (200, &found["second"]["rms"]), "{held}");
    assert_eq!(daemon.get(&format!("/api/v1/models/{}/compare/99", bare["id"])).0, 404);
    assert_eq!(daemon.post("/api/v1/models/1/evaluate", r#"{"run": 99}"#).0, 404);
}

#[test]
fn each_effect_has_its_contribution() {
    let Two { daemon, bare, better, .. } = two_versions();
    let (status, worth) = daemon.get(&format!("/api/v1/models/{}/worth", better["id"]));
    assert_eq!(status, 200, "{worth}");
    let of = |effect: &str| worth.as_array().unwrap().iter().find(|one| one["effect"] == effect).unwrap().clone();
    assert_eq!(of("rub")["without_rms"], bare["validation_rms"], "without what was added it is the version before");
    assert!(of("coulomb")["without_rms"].as_f64() > better["validation_rms"].as_f64(), "{worth}");
    assert_eq!(worth.as_array().unwrap().len(), better["effects"].as_array().unwrap().len());
    assert_eq!(daemon.get("/api/v1/models/99/worth").0, 404);
}

#[test]
fn what_is_exported_comes_in_again_unchanged() {
    let Two { daemon, run, better, .. } = two_versions();
    let path = format!("/api/v1/models/{}/export?format=", better["id"]);
    let out = text(&daemon, &format!("{path}json"));
    let body = format!(r#"{{"run": {run}, "model": {out}}}"#);
    let (status, again) = daemon.post("/api/v1/models/import", &body);
    assert_eq!((status, &again["fit"]["terms"]), (201, &better["fit"]["terms"]), "{again}");
    let residuals = |model: &Value| daemon.get(&format!("/api/v1/models/{}/residuals", model["id"])).1;
    assert_eq!(residuals(&again)["predicted"], residuals(&better)["predicted"]);
    for (format, words) in [
        ("c", "static inline double joint_friction_nm("),
        ("lut", "velocity_rad_s,load_nm,motor_torque_nm"),
        ("mujoco", "<joint frictionloss="),
        ("urdf", "<dynamics damping="),
    ] {
        assert!(text(&daemon, &format!("{path}{format}")).contains(words), "{format}");
    }
    assert_eq!(daemon.get(&format!("{path}matlab")).0, 400);
    let bad = format!(r#"{{"run": {run}, "model": {}}}"#, out.replace("tanh(velocity", "thanh(velocity"));
    let (status, problem) = daemon.post("/api/v1/models/import", &bad);
    assert_eq!(status, 422, "{problem}");
    assert!(problem["detail"].as_str().unwrap().contains("did you mean tanh"), "{problem}");
    let mut bad: Value = serde_json::from_str(&body).unwrap();
    bad["model"]["fit"]["terms"][0]["form"] = "other".into();
    let (status, problem) = daemon.post("/api/v1/models/import", &bad.to_string());
    assert_eq!(status, 422, "{problem}");
    assert!(problem["detail"].as_str().unwrap().contains("has the form other: expected is"), "{problem}");
}

/// An imported model can be extended: its effects are stored as effects of this store.
#[test]
fn an_imported_model_brings_its_own_effects_along() {
    let Two { daemon, better, .. } = two_versions();
    let out = text(&daemon, &format!("/api/v1/models/{}/export?format=json", better["id"]));
    let other = TestDaemon::start();
    let run = rubbing_run(&other, 3);
    let import = |model: &str| other.post("/api/v1/models/import", &format!(r#"{{"run": {run}, "model": {model}}}"#));
    let (status, there) = import(&out);
    assert_eq!(status, 201, "{there}");
    let own = || {
        let effects = other.get("/api/v1/effects?kind=friction").1;
        let all = effects.as_array().unwrap().iter().filter(|effect| effect["definition"].is_object());
        all.map(|effect| (effect["id"].clone(), effect["version"].clone())).collect::<Vec<_>>()
    };
    assert_eq!(own(), [(json!("rub"), json!(1))]);
    let effects = ["load_transmission", "coulomb", "viscous", "rub", "stribeck"];
    let wanted = json!({"run": run, "effects": effects, "parent": there["id"]});
    let (status, further) = other.post("/api/v1/models", &wanted.to_string());
    assert_eq!((status, &further["added"]), (201, &json!(["stribeck"])), "{further}");
    assert_eq!(import(&out).0, 201, "the same effect again");
    assert_eq!(own(), [(json!("rub"), json!(1))]);

    let another = out.replace("abs(load)", "load");
    let (status, problem) = import(&another);
    assert_eq!(status, 422, "{problem}");
    assert!(
        problem["detail"].as_str().unwrap().contains("differs from effect rub of this daemon (tau = a * tanh"),
        "{problem}"
    );
    assert_eq!(own(), [(json!("rub"), json!(1))]);
}

#[test]
fn set_parameters_hold_are_inherited_and_reappear() {
    let Two { daemon, run, bare, .. } = two_versions();
    let effects = json!(["load_transmission", "coulomb", "viscous"]);
    let ask = |body: Value| daemon.post("/api/v1/models", &body.to_string());
    let fixed = json!([{"effect": "coulomb", "name": "tau_c", "fixed": 0.02}]);
    let asked = json!({"run": run, "effects": effects, "parent": bare["id"], "parameters": fixed});
    let (status, set) = ask(asked.clone());
    assert_eq!((status, &set["fit"]["settings"], &set["idle"]), (201, &fixed, &json!(false)), "{set}");
    let parameter = |model: &Value, name: &str| {
        let all = model["fit"]["parameters"].as_array().unwrap();
        all.iter().find(|p| p["name"] == name).unwrap().clone()
    };
    let coulomb = parameter(&set, "tau_c");
    assert_eq!((&coulomb["value"], &coulomb["state"]), (&json!(0.02), &json!("fixed")));
    assert_eq!(parameter(&set, "c_v")["state"], "ok");
    // A child has the settings of its parent for the same effects, unless the request has others.
    let (_, child) = ask(json!({"run": run, "effects": ["coulomb", "viscous"], "parent": set["id"]}));
    assert_eq!(child["fit"]["settings"], fixed, "{child}");
    let (_, free) = ask(json!({"run": run, "effects": effects, "parent": set["id"], "parameters": []}));
    assert_eq!((parameter(&free, "tau_c"), &free["fit"]["settings"]), (parameter(&bare, "tau_c"), &Value::Null));
    // The settings are part of exports and reports, and the file can be imported.
    let file = text(&daemon, &format!("/api/v1/models/{}/export?format=json", set["id"]));
    let file: Value = serde_json::from_str(&file).unwrap();
    assert_eq!(file["fit"]["settings"], fixed);
    let (status, imported) = daemon.post("/api/v1/models/import", &json!({"run": run, "model": file}).to_string());
    assert_eq!((status, &imported["fit"]["settings"]), (201, &fixed), "{imported}");
    let report = text(&daemon, &format!("/api/v1/runs/{run}/report?model={}", set["id"]));
    assert!(report.contains("<td class=\"figure\">fixed</td>"), "{report}");
    // A setting that no fit can follow is refused with the reason, and no version is stored.
    let versions = || daemon.get(&format!("/api/v1/models?run={run}")).1.as_array().unwrap().len();
    let before = versions();
    for (setting, reason) in [
        (json!({"effect": "gravity", "name": "g_c", "fixed": 1.0}), "the model does not contain the effect"),
        (json!({"effect": "coulomb", "name": "tau", "fixed": 1.0}), "it has tau_c"),
        (json!({"effect": "coulomb", "name": "tau_c", "min": 2.0, "max": 1.0}), "min 2 is larger than max 1"),
        (json!({"effect": "coulomb", "name": "tau_c", "start": 0.1}), "a start value has no influence"),
    ] {
        let (status, problem) = ask(json!({"run": run, "effects": effects, "parameters": [setting]}));
        assert_eq!(status, 422, "{problem}");
        assert!(problem["detail"].as_str().unwrap().contains(reason), "{problem}");
    }
    assert_eq!(versions(), before);
    let (status, problem) = daemon.post("/api/v1/diagnoses", &json!({"model": set["id"]}).to_string());
    assert_eq!(status, 422, "{problem}");
    assert!(problem["detail"].as_str().unwrap().contains("diagnose the model without these settings"), "{problem}");
}
