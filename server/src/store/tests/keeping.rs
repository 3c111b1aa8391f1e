use super::super::{NewModel, Order, RunFilter, SafetyRecord, StoreError, Subject};
use super::*;
use jointbench_procedure::Safe;
use serde_json::{Value, json};

#[test]
fn a_run_is_kept_with_all_that_it_was_started_with() {
    block_on(async {
        let (_folder, store) = fresh().await;
        let run = store.create_run(&new_run()).await.unwrap();
        let record = store.run(run).await.unwrap();
        assert_eq!((record.state, record.rows, record.safe), (RunState::Queued, 0, None));
        assert_eq!(record.parameters, new_run().parameters);
        assert_eq!(record.provenance, new_run().provenance);
        assert_eq!(record.meta, new_run().meta);
        assert_eq!((record.started_at, record.finished_at), (None, None));

        store.commit(run, RunState::Running, &[note(0.5, "warm")], rows(0, 500)).await.unwrap();
        let safe = Event { at_s: 2.5, kind: EventKind::Safe { safe: Safe::SafeVerified } };
        store.commit(run, RunState::Securing, &[safe], Trace::default()).await.unwrap();
        store.commit(run, RunState::Stopped, &[note(3.0, "over")], Trace::default()).await.unwrap();
        store.end_run(run, RunState::Aborted, Safe::SafeVerified, Some("a person stopped it")).await.unwrap();

        let record = store.run(run).await.unwrap();
        assert_eq!((record.state, record.rows, record.safe), (RunState::Stopped, 500, Some(Safe::SafeVerified)));
        assert_eq!(record.reason.as_deref(), Some("a person stopped it"));
        assert!((record.duration_s.unwrap() - 499.0 * 0.004).abs() < 1e-12);
        assert_eq!(record.channels, rows(0, 1).channels());
        assert!(record.finished_at > record.created_at.into());

        let events = store.events(run, 0).await.unwrap();
        assert_eq!(events.iter().map(|e| e.sequence).collect::<Vec<_>>(), [1, 2, 3]);
        assert_eq!(events[0].data, json!({"text": "warm"}).as_object().unwrap().clone());
        assert_eq!((events[1].kind.as_str(), &events[1].data["safe"]), ("safe", &json!("safe_verified")));
        assert_eq!(store.events(run, 2).await.unwrap(), events[2..]);

        let failed = store.create_run(&new_run()).await.unwrap();
        let why = EventKind::State { state: RunState::Failed, reason: Some("the drive has a fault".into()) };
        let end = Event { at_s: 0.0, kind: why };
        store.commit(failed, RunState::Failed, &[end], Trace::default()).await.unwrap();
        let kept = store.run(failed).await.unwrap().reason;
        assert_eq!(kept.as_deref(), Some("the drive has a fault"), "with the state that it is the reason of");

        let over = store.commit(run, RunState::Running, &[], rows(500, 1)).await.unwrap_err();
        assert!(matches!(over, StoreError::RunOver { .. }), "{over}");
        assert!(matches!(store.run(99).await.unwrap_err(), StoreError::NoRun(99)));
        assert!(matches!(store.commit(99, RunState::Arming, &[], Trace::default()).await, Err(StoreError::NoRun(99))));
    });
}

#[test]
fn rows_come_back_however_they_came() {
    block_on(async {
        let (_folder, store) = fresh().await;
        for commits in [vec![1], vec![500; 70], vec![100_000], vec![32_768], vec![32_767, 1, 1], vec![10, 70_000, 5]] {
            let run = store.create_run(&new_run()).await.unwrap();
            let mut kept = 0;
            for count in &commits {
                commit(&store, run, RunState::Running, rows(kept, *count)).await;
                kept += count;
            }
            check_rows(&store, run, kept).await;
            commit(&store, run, RunState::Completed, Trace::default()).await;
            check_rows(&store, run, kept).await;
            let left: i64 = sqlx::query_scalar("SELECT COUNT(*) FROM tail").fetch_one(&store.readers).await.unwrap();
            assert_eq!(left, 0, "a run that is over is all blocks");

            let some = store.trace(run, Some(&["link_torque_nm".to_owned()]), 3..40_000).await.unwrap();
            let all = rows(0, kept);
            let expected = &all.columns()[2][3.min(kept)..40_000.min(kept)];
            assert_eq!(some.columns(), [expected.to_vec()]);
        }
        let run = store.create_run(&new_run()).await.unwrap();
        commit(&store, run, RunState::Running, rows(0, 5)).await;
        let unknown = store.trace(run, Some(&["speed".to_owned()]), 0..1).await.unwrap_err().to_string();
        assert!(unknown.contains("no channel speed: it has time_s, motor_position_rad, link_torque_nm"), "{unknown}");
        let other = store.commit(
            run,
            RunState::Running,
            &[],
            Trace::from_columns(vec![Channel::new("time_s")], vec![vec![9.0]]),
        );
        assert!(matches!(other.await.unwrap_err(), StoreError::OtherChannels { .. }));
        check_rows(&store, run, 5).await;
    });
}

#[test]
fn what_was_measured_never_changes() {
    block_on(async {
        let (_folder, store) = fresh().await;
        let run = store.create_run(&new_run_of_unit("SN1")).await.unwrap();
        store.commit(run, RunState::Running, &[note(0.0, "first")], rows(0, 40_000)).await.unwrap();
        let later = store.create_run(&new_run()).await.unwrap();
        commit(&store, later, RunState::Running, Trace::default()).await;
        for (sql, why) in [
            ("UPDATE events SET data = '{}'", "only appended to"),
            ("DELETE FROM events", "only appended to"),
            ("INSERT INTO events (run, sequence, at_s, kind, data) VALUES (1, 3, 0, 'note', '{}')", "no gaps"),
            ("UPDATE blocks SET data = x''", "samples never change"),
            ("DELETE FROM blocks", "samples never change"),
            ("UPDATE spans SET coarse = x''", "samples never change"),
            ("DELETE FROM spans", "samples never change"),
            ("UPDATE tail SET data = x''", "samples never change"),
            ("DELETE FROM tail", "before a block holds them"),
            ("UPDATE channels SET resolution = 1.0", "channels never change"),
            ("DELETE FROM runs", "never deleted"),
            ("UPDATE runs SET provenance = '{}'", "never changes"),
            ("UPDATE run_units SET serial = 'SN2'", "the unit of a run never changes"),
            ("UPDATE run_units SET unit_checksum = NULL", "the unit of a run never changes"),
            ("DELETE FROM run_units", "the unit of a run never changes"),
            ("INSERT INTO run_units (id, serial) VALUES (2, 'SN2')", "set when the run is created"),
            ("INSERT INTO run_units (id, part) VALUES (2, 'P')", "set when the run is created"),
        ] {
            let refused = sqlx::query(sql).execute(&store.writer).await.unwrap_err().to_string();
            assert!(refused.contains(why), "{sql}: {refused}");
        }
        check_rows(&store, run, 40_000).await;
    });
}

#[test]
fn an_import_is_whole_or_not_there() {
    block_on(async {
        let (_folder, store) = fresh().await;
        let twice =
            Trace::from_columns(vec![Channel::new("time_s"), Channel::new("time_s")], vec![vec![0.0], vec![0.0]]);
        assert!(store.import(&new_run(), &[note(0.0, "from a file")], twice).await.is_err());
        assert_eq!(store.runs(&RunFilter { limit: 10, ..RunFilter::default() }).await.unwrap().0, 0);

        let run = store.import(&new_run(), &[note(0.0, "from a file")], rows(0, 70_000)).await.unwrap();
        assert_eq!(store.run(run).await.unwrap().state, RunState::Completed);
        check_rows(&store, run, 70_000).await;
    });
}

#[test]
fn runs_are_found_by_their_words() {
    block_on(async {
        let (_folder, store) = fresh().await;
        for bench in ["joint-a", "Joint-B", "100%"] {
            store.create_run(&NewRun { bench: bench.into(), ..new_run() }).await.unwrap();
        }
        let found = async |search: Option<&str>, limit, offset| {
            let filter = RunFilter { limit, offset, search: search.map(str::to_owned), ..RunFilter::default() };
            let (total, runs) = store.runs(&filter).await.unwrap();
            (total, runs.into_iter().map(|run| run.id).collect::<Vec<_>>())
        };
        assert_eq!(found(None, 2, 0).await, (3, vec![3, 2]));
        assert_eq!(found(None, 2, 2).await, (3, vec![1]));
        assert_eq!(found(Some("JOINT-b"), 9, 0).await, (1, vec![2]));
        assert_eq!(found(Some("%"), 9, 0).await, (1, vec![3]));
        assert_eq!(found(Some("queued"), 1, 0).await, (3, vec![3]));
    });
}

#[test]
fn runs_are_found_by_field_tag_note_and_number() {
    block_on(async {
        let (_folder, store) = fresh().await;
        for bench in ["joint-a", "joint-b"] {
            store.create_run(&NewRun { bench: bench.into(), ..new_run() }).await.unwrap();
        }
        let imported = store.import(&new_run(), &[], rows(0, 500)).await.unwrap();
        store.set_tags(1, &["cold".into(), "Oil".into()]).await.unwrap();
        store.set_tags(1, &["Oil".into()]).await.unwrap();
        store.save_note(2, None, "a new belt").await.unwrap();
        store.save_note(2, Some(1.5), "smells of ozone").await.unwrap();
        assert_eq!(store.run(2).await.unwrap().note.as_deref(), Some("smells of ozone"), "the last one");
        let found = async |search: &str| {
            let filter = RunFilter { limit: 9, search: Some(search.to_owned()), ..RunFilter::default() };
            store.runs(&filter).await.unwrap().1.into_iter().map(|run| run.id).collect::<Vec<_>>()
        };
        assert_eq!(found("tag:oil").await, [1]);
        assert_eq!(found("oil").await, [1]);
        assert!(found("tag:cold").await.is_empty(), "tags are replaced");
        assert_eq!(found("-tag:oil").await, [imported, 2]);
        assert_eq!(found("ozone bench:joint-b").await, [2]);
        assert_eq!(found("note:\"of ozone\"").await, [2]);
        assert_eq!(found("rows>=500 duration>0").await, [imported]);
        assert_eq!(found("state:done").await, [imported], "as the pages call it");
        assert_eq!(found("state:comp -bench:joint-b").await, [imported]);
        assert_eq!(found("-state:").await, [0i64; 0], "every state begins like that");
        let all = found("").await;
        assert_eq!(found("bench:joi").await, all);
        assert_eq!(found("bench:joint-b").await, [2], "a name that is there is meant whole");
        let long = store.import(&new_run(), &[], rows(0, 40_000)).await.unwrap();
        assert_eq!(found("duration>2min").await, [long]);
        assert_eq!(found("duration>0.04h rows>=500").await, [long]);
        assert_eq!(found("duration<=120s").await, [imported]);
        assert_eq!(found("-duration>0").await, [2, 1], "what is not known does not hold");
        assert_eq!(found("after:2020-01-01 before:2020-01-02").await, [0i64; 0]);
        assert_eq!(store.run(1).await.unwrap().tags, ["Oil"]);
        assert_eq!(store.notes(2).await.unwrap()[1].at_s, Some(1.5));
        assert_eq!(store.tags().await.unwrap(), ["Oil"]);
        assert!(matches!(store.save_note(99, None, "?").await, Err(StoreError::NoRun(99))));
    });
}

#[test]
fn runs_have_their_units() {
    block_on(async {
        let (_folder, store) = fresh().await;
        for new in [new_run_of_unit("SN1"), new_run(), new_run_of_unit("SN2"), new_run_of_unit("SN1")] {
            let run = store.create_run(&new).await.unwrap();
            let record = store.run(run).await.unwrap();
            assert_eq!((record.unit, record.operator), (new.unit, new.operator));
        }
        let units = async |search: &str| {
            let runs = store.unit_runs(search).await.unwrap();
            runs.into_iter().map(|run| (run.run, run.unit.serial)).collect::<Vec<_>>()
        };
        let [one, two, again] = [(1, "SN1"), (3, "SN2"), (4, "SN1")].map(|(run, serial)| (run, serial.to_owned()));
        assert_eq!(units("").await, [one.clone(), two.clone(), again.clone()]);
        assert_eq!(units("id:4").await, [one, again], "all runs of the unit");
        assert_eq!(units("unit:sn2 batch:7 operator:a").await, [two]);
        assert!(units("id:2").await.is_empty());
    });
}

#[test]
fn runs_are_judged_once_and_what_is_on_is_not() {
    block_on(async {
        let (_folder, store) = fresh().await;
        for run in [new_run(), NewRun { procedure: "import".into(), ..new_run() }, new_run()] {
            store.import(&run, &[], rows(0, 5)).await.unwrap();
        }
        store.create_run(&new_run()).await.unwrap();
        assert_eq!(store.unjudged(9).await.unwrap(), [3, 1]);
        store.keep_verdict(3, "identified", Some("pass"), &[]).await.unwrap();
        assert_eq!(store.unjudged(9).await.unwrap(), [1]);
    });
}

#[test]
fn runs_are_ordered_by_what_they_are_asked_to_be() {
    block_on(async {
        let (_folder, store) = fresh().await;
        store.import(&NewRun { bench: "b".into(), ..new_run() }, &[], rows(0, 500)).await.unwrap();
        store.import(&NewRun { bench: "c".into(), ..new_run() }, &[], rows(0, 900)).await.unwrap();
        store.create_run(&NewRun { bench: "a".into(), ..new_run() }).await.unwrap();
        store.create_run(&NewRun { bench: "a".into(), ..new_run() }).await.unwrap();
        for (run, validation_rms, coulomb) in [(1, 0.1, 0.07), (1, 0.03, 0.02), (4, 0.02, 0.05)] {
            let fit = json!({"unit": "Nm", "parameters": [{"effect": "coulomb", "name": "tau_c", "value": coulomb}]});
            store.save_model(&NewModel { fit, validation_rms, ..model(run, None, &["coulomb"]) }).await.unwrap();
        }
        for (asked, ids) in [
            ("-started", [4, 3, 2, 1]),
            ("started", [1, 2, 3, 4]),
            ("bench", [4, 3, 1, 2]),
            ("-duration", [2, 1, 4, 3]),
            ("duration", [1, 2, 4, 3]),
            ("-rows", [2, 1, 4, 3]),
            ("error", [4, 1, 3, 2]),
            ("-error", [1, 4, 3, 2]),
            ("coulomb", [1, 4, 3, 2]),
        ] {
            let order = Order::parse(asked).unwrap();
            let filter = RunFilter { limit: 9, order, ..RunFilter::default() };
            let found = store.runs(&filter).await.unwrap().1.iter().map(|run| run.id).collect::<Vec<_>>();
            assert_eq!(found, ids, "{asked}");
        }
        let refused = Order::parse("-temp").unwrap_err().to_string();
        assert!(refused.contains("column \"temp\" to sort by: choose started, state"), "{refused}");
    });
}

fn model(run: RunId, parent: Option<i64>, effects: &[&str]) -> NewModel {
    NewModel {
        run,
        more_runs: Vec::new(),
        excluded: json!([]),
        parent,
        kind: "friction".into(),
        effects: effects.iter().map(|effect| (*effect).to_owned()).collect(),
        fit: json!({"rms": 0.012345678901234567, "unit": "Nm", "parameters": [
            {"effect": "viscous", "name": "c_v", "value": 1e-4}, {"effect": "coulomb", "name": "tau_c", "value": 0.03},
        ]}),
        residual: "raw".into(),
        rms: 0.0123,
        validation_rms: 0.0125,
        noise_floor_rms: None,
        options: json!({"decimation": 10}).as_object().unwrap().clone(),
        tried: false,
        by: "Anna".into(),
    }
}

#[test]
fn model_versions_are_a_tree() {
    block_on(async {
        let (_folder, store) = fresh().await;
        let run = store.create_run(&new_run()).await.unwrap();
        let other = store.create_run(&new_run()).await.unwrap();
        let root = store.save_model(&model(run, None, &["coulomb", "viscous"])).await.unwrap();
        let left = store.save_model(&model(run, Some(root.id), &["coulomb", "viscous", "stribeck"])).await.unwrap();
        let right = store.save_model(&model(run, Some(root.id), &["coulomb", "load_linear"])).await.unwrap();
        assert_eq!((root.added, root.removed), (vec!["coulomb".into(), "viscous".into()], vec![]));
        assert_eq!((&left.added, &left.removed), (&vec!["stribeck".into()], &vec![]));
        assert_eq!((&right.added, &right.removed), (&vec!["load_linear".into()], &vec!["viscous".into()]));
        assert_eq!(
            store.models(run).await.unwrap().iter().map(|m| m.parent).collect::<Vec<_>>(),
            [None, Some(1), Some(1)]
        );
        assert_eq!(store.model(left.id).await.unwrap(), left);
        assert_eq!(left.fit, model(run, None, &[]).fit);

        let astray = store.save_model(&model(other, Some(root.id), &[])).await.unwrap_err();
        assert!(matches!(astray, StoreError::OtherRun { .. }), "{astray}");
        assert!(matches!(store.save_model(&model(run, Some(77), &[])).await, Err(StoreError::NoModel(77))));
    });
}

#[test]
fn a_run_shows_its_best_version_that_is_neither_idle_nor_only_tried() {
    block_on(async {
        let (_folder, store) = fresh().await;
        let run = store.create_run(&new_run()).await.unwrap();
        let other = store.create_run(&new_run()).await.unwrap();
        let root = store.save_model(&model(run, None, &["coulomb", "viscous"])).await.unwrap();
        store.save_model(&model(run, Some(root.id), &["coulomb", "viscous", "stribeck"])).await.unwrap();
        let right = NewModel { validation_rms: 0.012, ..model(run, Some(root.id), &["coulomb", "load_linear"]) };
        let right = store.save_model(&right).await.unwrap();
        let listed = store.run(run).await.unwrap().model.unwrap();
        assert_eq!(
            (&listed["id"], &listed["unit"], &listed["coulomb"]["value"]),
            (&json!(right.id), &json!("Nm"), &json!(0.03))
        );
        let grown = |validation_rms| NewModel {
            validation_rms,
            ..model(run, Some(right.id), &["coulomb", "load_linear", "gravity"])
        };
        let better = store.save_model(&NewModel { more_runs: vec![other], ..grown(0.012) }).await.unwrap();
        let idle = store.save_model(&grown(0.01199)).await.unwrap();
        assert!(!right.idle && !better.idle && idle.idle, "other data is no reason to call a version idle");
        assert_eq!(store.run(run).await.unwrap().model.unwrap()["id"], better.id);
        assert_eq!(store.run(other).await.unwrap().model, None);
        let tried = store.save_model(&NewModel { tried: true, ..grown(0.004) }).await.unwrap();
        assert!(tried.tried && !tried.idle && store.run(run).await.unwrap().model.unwrap()["id"] == better.id);
        for id in [tried.id, idle.id, idle.id] {
            let kept = store.keep_model(id, "lab").await.unwrap();
            assert!(!kept.tried && !kept.idle);
        }
        assert_eq!(store.run(run).await.unwrap().model.unwrap()["id"], tried.id);
        assert!(matches!(store.keep_model(77, "lab").await, Err(StoreError::NoModel(77))));
    });
}

#[test]
fn diagnoses_and_cached_answers_belong_to_one_version() {
    block_on(async {
        let (_folder, store) = fresh().await;
        let run = store.create_run(&new_run()).await.unwrap();
        let left = store.save_model(&model(run, None, &["coulomb"])).await.unwrap();
        let right = store.save_model(&model(run, None, &["viscous"])).await.unwrap();
        assert_eq!(store.cached_result(Subject::Model(left.id), "worth").await.unwrap(), None);
        store.cache_result(Subject::Model(left.id), "worth", b"[1]").await.unwrap();
        store.cache_result(Subject::Model(left.id), "worth", b"[2]").await.unwrap();
        assert_eq!(store.cached_result(Subject::Model(left.id), "worth").await.unwrap().as_deref(), Some(&b"[2]"[..]));
        assert_eq!(store.cached_result(Subject::Model(right.id), "worth").await.unwrap(), None);
        assert_eq!(store.cached_result(Subject::Run(left.id), "worth").await.unwrap(), None);

        let diagnosis = store.save_diagnosis(left.id, &json!({"verdict": "adequate"})).await.unwrap();
        assert_eq!(store.diagnosis(diagnosis.id).await.unwrap(), diagnosis);
        assert_eq!(store.diagnoses(left.id).await.unwrap(), [diagnosis]);
        assert_eq!(store.diagnoses(right.id).await.unwrap(), []);
        assert!(matches!(store.save_diagnosis(77, &Value::Null).await, Err(StoreError::NoModel(77))));
        for sql in ["UPDATE models SET rms = 0.0", "DELETE FROM diagnoses"] {
            let refused = sqlx::query(sql).execute(&store.writer).await.unwrap_err().to_string();
            assert!(refused.contains("never change"), "{sql}: {refused}");
        }
    });
}

#[test]
fn an_unsafe_end_blocks_the_bench_until_a_person_has_looked() {
    block_on(async {
        let (_folder, store) = fresh().await;
        let run = store.create_run(&new_run()).await.unwrap();
        let unsafe_end = Event { at_s: 1.0, kind: EventKind::Safe { safe: Safe::UnsafeUnknown } };
        assert_eq!(store.bench_block("joint-a").await.unwrap(), None);
        store.commit(run, RunState::Failed, &[unsafe_end], Trace::default()).await.unwrap();
        let block = store.bench_block("joint-a").await.unwrap().unwrap();
        assert_eq!(block.run, Some(run));
        assert_eq!(store.bench_block("joint-b").await.unwrap(), None);
        let reason = "brake is off, shaft turns freely";
        let stop = SafetyRecord { stopped: true, at: format!("{}9", block.at), ..block.clone() };
        for _ in 0..2 {
            store.keep_block("joint-a", &stop).await.unwrap();
        }
        assert!(!store.acknowledge_bench("joint-a", &block.at, reason, "Anna").await.unwrap(), "it was pressed again");
        assert!(store.acknowledge_bench("joint-a", &stop.at, reason, "Anna").await.unwrap());
        assert_eq!(store.safety("joint-a", 10).await.unwrap().len(), 3, "what comes twice is kept once");
        assert_eq!(store.bench_block("joint-a").await.unwrap(), None);
        store.block_bench("joint-a", None, "cover open").await.unwrap();
        assert_eq!(store.bench_block("joint-a").await.unwrap().unwrap().reason, "cover open");
    });
}
