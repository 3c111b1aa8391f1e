//! Stored data of a run, and the time of storing.

use crate::fakes::Fakes;
use crate::ledger::{loaded_plan, play, play_controlled};
use jointbench_procedure::*;

#[test]
fn a_whole_run_is_kept_once_and_in_order() {
    let (fakes, mut bench) = Fakes::quiet();
    let plan = loaded_plan();
    let done = play(&fakes, &mut bench, &plan, |_| {});
    done.check_safe(RunState::Completed).check_no_cogging();
    assert_eq!(done.end.reason, None);
    assert_eq!(done.ledger.states(), [RunState::Arming, RunState::Running, RunState::Securing, RunState::Completed]);

    let table = done.ledger.table();
    let planned_rows = plan.duration_s() * plan.rate_hz;
    assert!((table.len() as f64 - planned_rows).abs() <= 2.0 * plan.steps.len() as f64, "{} rows", table.len());
    assert_eq!(done.end.rows, table.len() as u64);
    let names: Vec<_> = table.trace().channels().iter().map(|channel| channel.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "time_s",
            "motor_position_rad",
            "motor_velocity_rad_s",
            "motor_current_a",
            "link_position_rad",
            "link_torque_nm",
            "torque_skew_s",
            "temperature_c",
            "brake_current_a",
            "brake_torque_command_nm",
            "velocity_setpoint_rad_s",
            "segment",
            "repeat"
        ]
    );
    let segments = table.column("segment").unwrap();
    assert!(segments.windows(2).all(|pair| pair[0] <= pair[1]), "segments in order");
    let command_nm = table.column("brake_torque_command_nm").unwrap();
    let top_nm = command_nm.iter().copied().fold(0.0, f64::max);
    assert!((top_nm - 0.4 * 13.0 / 0.6).abs() < 1e-9, "{top_nm}");
    let sent = done.world.commands(|call| matches!(call, crate::fakes::Call::SetCurrent(_)));
    let closest_s = sent.windows(2).map(|pair| pair[1].0 - pair[0].0).fold(f64::MAX, f64::min);
    assert!(closest_s >= 0.099, "the supply takes a new current every 0.1 s, not {closest_s} s");
    assert!(done.ledger.live_rows >= table.len() - 9, "all but the last rows were shown");
}

#[test]
fn the_commit_that_ends_a_run_has_the_reason() {
    let done = play_controlled(&[(3.0, Control::Stop)]);
    let last = done.ledger.kept.last().and_then(|kept| kept.events.last()).expect("an end");
    let reason = done.end.reason.clone();
    assert_eq!((reason.is_some(), &last.kind), (true, &EventKind::State { state: RunState::Stopped, reason }));
}

#[test]
fn a_step_and_its_rows_become_durable_together() {
    let (fakes, mut bench) = Fakes::quiet();
    let done = play(&fakes, &mut bench, &loaded_plan(), |_| {});
    let mut rows_of = std::collections::BTreeMap::new();
    let mut finished = 0;
    for kept in &done.ledger.kept {
        for segment in kept.rows.column("segment").unwrap_or_default() {
            *rows_of.entry(*segment as u32).or_insert(0u64) += 1;
        }
        for event in &kept.events {
            if let EventKind::StepFinished { segment, rows, late_ticks, .. } = event.kind {
                assert_eq!((rows_of[&segment], late_ticks), (rows, 0), "segment {segment}");
                assert!(kept.at_s - 100.0 - event.at_s < 0.001, "the end of a step is durable at once");
                finished += 1;
            }
        }
    }
    assert_eq!(finished, loaded_plan().steps.len());
}

/// A kill loses only data without acknowledgement: at most two seconds of the bench.
#[test]
fn commits_come_often_enough_and_not_more() {
    let (fakes, mut bench) = Fakes::quiet();
    let plan = loaded_plan();
    let done = play(&fakes, &mut bench, &plan, |_| {});
    let running: Vec<_> = done.ledger.kept.iter().filter(|kept| kept.state == RunState::Running).collect();
    let longest_s = running.windows(2).map(|pair| pair[1].at_s - pair[0].at_s).fold(0.0, f64::max);
    assert!(longest_s <= 2.01, "{longest_s} s without a commit");
    let budget = plan.steps.len() + (plan.duration_s() / 2.0) as usize + 4;
    assert!(done.ledger.kept.len() <= budget, "{} commits, budget {budget}", done.ledger.kept.len());
}

#[test]
fn progress_counts_down() {
    let (fakes, mut bench) = Fakes::quiet();
    let plan = loaded_plan();
    let done = play(&fakes, &mut bench, &plan, |_| {});
    let progress: Vec<_> = done.ledger.progress.iter().filter(|progress| progress.remaining_s > 0.1).collect();
    assert!((progress[0].remaining_s - plan.duration_s()).abs() < 0.1, "{:?}", progress[0]);
    for shown in progress {
        let whole_s = shown.elapsed_s + shown.remaining_s;
        assert!((whole_s - plan.duration_s()).abs() < 0.3, "{shown:?}");
    }
}

#[test]
fn a_full_disk_ends_the_run_safely_wherever_it_strikes() {
    let (fakes, mut bench) = Fakes::quiet();
    let commits = play(&fakes, &mut bench, &loaded_plan(), |_| {}).ledger.kept.len();
    for room in 0..commits {
        let (fakes, mut bench) = Fakes::quiet();
        let done = play(&fakes, &mut bench, &loaded_plan(), |ledger| ledger.room = room);
        assert_eq!(done.end.state, RunState::Failed, "room for {room} commits");
        assert_eq!(done.end.safe, Safe::SafeVerified, "room for {room} commits");
        assert!(done.end.reason.as_ref().unwrap().contains("no space left"), "{:?}", done.end.reason);
        assert!(done.world.is_safe());
        done.check_no_cogging();
        let kept: usize = done.ledger.kept.iter().map(|kept| kept.rows.len()).sum();
        assert_eq!(done.end.rows, kept as u64, "only what was acknowledged counts");
    }
}

#[test]
fn a_blocked_bench_is_not_touched() {
    let (fakes, mut bench) = Fakes::quiet();
    let done =
        play(&fakes, &mut bench, &loaded_plan(), |ledger| ledger.blocked = Some("the brake never answered".into()));
    done.check_safe(RunState::Failed);
    assert!(done.end.reason.unwrap().contains("the brake never answered): inspect the bench, then reset it"));
    assert!(done.world.commands(|call| matches!(call, crate::fakes::Call::Arm)).is_empty());
}

/// All steps are done, but their last rows cannot be stored: the run is not complete.
#[test]
fn a_run_whose_end_is_not_kept_is_not_completed() {
    for state in [RunState::Securing, RunState::Completed] {
        let (fakes, mut bench) = Fakes::quiet();
        let done = play(&fakes, &mut bench, &loaded_plan(), |ledger| ledger.refuses = Some(state));
        assert_eq!((done.end.state, done.end.safe), (RunState::Failed, Safe::SafeVerified), "{state}");
    }
}

#[test]
fn a_reading_that_is_not_new_is_not_a_new_row() {
    let (fakes, mut bench) = Fakes::new(|_, world| {
        world.stuck_at_s = (102.0..102.1).contains(&world.now_s).then_some(101.9);
        Ok(())
    });
    let done = play(&fakes, &mut bench, &loaded_plan(), |_| {});
    done.check_safe(RunState::Completed);
    let gap_s = done.ledger.table().column("time_s").unwrap().windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
    assert!((0.1..0.11).contains(&gap_s), "{gap_s}");
}
