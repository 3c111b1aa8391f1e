//! A recorder in memory, and helpers that run a plan.

use crate::fakes::{Fakes, World};
use jointbench_instrument::{Bench, Kind, Meta, RunTable, Trace};
use jointbench_procedure::plan::{BrakeControl, Drive, InitialState, Phase, Step};
use jointbench_procedure::profile::Profile;
use jointbench_procedure::stage_pose::StagePose;
use jointbench_procedure::*;
use std::sync::mpsc::{Receiver, Sender, channel};

/// One acknowledged commit.
pub struct Committed {
    pub state: RunState,
    pub events: Vec<Event>,
    pub rows: Trace,
    pub at_s: f64,
}

pub struct Ledger {
    fakes: Fakes,
    pub kept: Vec<Committed>,
    pub live_rows: usize,
    pub progress: Vec<Progress>,
    pub blocked: Option<String>,
    /// Number of acknowledged commits before the disk is full.
    pub room: usize,
    /// Commits of this state fail.
    pub refuses: Option<RunState>,
}

impl Ledger {
    pub fn new(fakes: &Fakes) -> Self {
        Self {
            fakes: fakes.clone(),
            kept: Vec::new(),
            live_rows: 0,
            progress: Vec::new(),
            blocked: None,
            room: usize::MAX,
            refuses: None,
        }
    }

    pub fn events(&self) -> impl Iterator<Item = &Event> {
        self.kept.iter().flat_map(|kept| &kept.events)
    }

    pub fn states(&self) -> Vec<RunState> {
        let state = |event: &Event| match event.kind {
            EventKind::State { state, .. } => Some(state),
            _ => None,
        };
        self.events().filter_map(state).collect()
    }

    pub fn notes(&self) -> Vec<&str> {
        self.events()
            .filter_map(|event| match &event.kind {
                EventKind::Note { text } | EventKind::Warning { text } => Some(text.as_str()),
                _ => None,
            })
            .collect()
    }

    /// All rows as the run table of an export.
    pub fn table(&self) -> RunTable {
        let mut rows = self.kept.iter().filter(|kept| !kept.rows.channels().is_empty()).map(|kept| kept.rows.clone());
        let mut all = rows.next().expect("a run with rows");
        rows.for_each(|more| all.append(more));
        RunTable::new(Meta { kind: Some(Kind::Friction), ..Meta::default() }, all).expect("a valid run table")
    }
}

impl Recorder for Ledger {
    fn blocked(&mut self) -> Result<Option<String>, RecorderFault> {
        Ok(self.blocked.clone())
    }

    fn commit(&mut self, commit: Commit<'_>) -> Result<(), RecorderFault> {
        if self.kept.len() >= self.room || self.refuses == Some(commit.state) {
            return Err(RecorderFault("no space left on device; free some and start the run again".into()));
        }
        let at_s = self.fakes.world().now_s;
        self.kept.push(Committed { state: commit.state, events: commit.events.to_vec(), rows: commit.rows, at_s });
        Ok(())
    }

    fn live(&mut self, live: Live<'_>) {
        self.live_rows += live.rows.len();
        self.progress.push(live.progress.clone());
    }
}

/// Up to a load, a leg under it, down from it, and one without: the parts of a run with a brake.
pub fn loaded_plan() -> Plan {
    let step = |segment: u32, speed: f64, dwell_s: f64, brake: Profile| Step {
        label: format!("step {segment}"),
        phase: Phase::Measure,
        segment,
        repeat: 0,
        before: InitialState::AsLeft,
        place: StagePose::AsLeft,
        velocity: Profile::plateau(speed, 400.0, dwell_s),
        brake,
        brake_control: BrakeControl::Current,
        drive: Drive::Velocity,
    };
    Plan {
        procedure: "test".into(),
        parameters: serde_json::Map::new(),
        kind: Kind::Friction,
        meta: Meta::default(),
        rate_hz: 250.0,
        acceleration_rad_s2: 400.0,
        steps: vec![
            step(0, 100.0, 1.0, Profile::from(0.0).hold(0.3).to(0.4, 0.5)),
            step(1, -100.0, 1.0, Profile::constant(0.4)),
            step(2, 1.0, 2.5, Profile::constant(0.4)),
            step(3, 150.0, 3.0, Profile::from(0.4).hold(0.4).to(0.0, 2.0)),
            step(4, -150.0, 3.0, Profile::constant(0.0)),
        ],
        steady: None,
        both_ranges: false,
        torque_period_s: None,
        deferred: None,
        begins_rad: 0.0,
    }
}

/// Bench time from the start of the run to the middle of each step.
pub fn middles_s(plan: &Plan) -> Vec<f64> {
    let mut start_s = 0.0;
    let middle = |step: &Step| {
        let middle_s = start_s + 0.5 * step.duration_s();
        start_s += step.duration_s();
        middle_s
    };
    plan.steps.iter().map(middle).collect()
}

/// Results of a run.
pub struct FinishedRun {
    pub end: RunEnd,
    pub ledger: Ledger,
    pub world: World,
}

/// Runs a plan on a bench with a recorder that `prepare` may modify.
pub fn play(fakes: &Fakes, bench: &mut Bench, plan: &Plan, prepare: impl FnOnce(&mut Ledger)) -> FinishedRun {
    let (_held, controls) = channel();
    play_with(fakes, bench, plan, &controls, prepare)
}

pub fn play_with(
    fakes: &Fakes,
    bench: &mut Bench,
    plan: &Plan,
    controls: &Receiver<Demand>,
    prepare: impl FnOnce(&mut Ledger),
) -> FinishedRun {
    let mut ledger = Ledger::new(fakes);
    prepare(&mut ledger);
    let end = run(bench, plan, 7, controls, &mut ledger);
    FinishedRun { end, ledger, world: fakes.world() }
}

/// Runs the loaded plan while a person gives controls at times after the start of the run.
pub fn play_controlled(controls: &[(f64, Control)]) -> FinishedRun {
    play_controlled_at(loaded_plan().rate_hz, controls)
}

pub fn play_controlled_at(rate_hz: f64, controls: &[(f64, Control)]) -> FinishedRun {
    let (sender, receiver): (Sender<Demand>, _) = channel();
    let mut due = controls.to_vec();
    due.sort_by(|a, b| a.0.total_cmp(&b.0));
    due.reverse();
    let (fakes, mut bench) = Fakes::new(move |_, world| {
        while let Some((_, control)) = due.pop_if(|(at_s, _)| world.now_s >= 100.0 + *at_s) {
            // A run that has ended ignores controls.
            let _ = sender.send(control.into());
        }
        Ok(())
    });
    play_with(&fakes, &mut bench, &Plan { rate_hz, ..loaded_plan() }, &receiver, |_| {})
}

impl FinishedRun {
    /// Required final state of every run while the instruments answer.
    pub fn check_safe(&self, state: RunState) -> &Self {
        assert_eq!(self.end.state, state, "{:?}", self.end.reason);
        assert_eq!(self.end.safe, Safe::SafeVerified, "{:?}", self.ledger.notes());
        assert!(self.world.is_safe(), "{:?}", self.world.log.last());
        let states = self.ledger.states();
        assert!(states.ends_with(&[RunState::Securing, state]), "{states:?}");
        self
    }

    pub fn check_no_cogging(&self) -> &Self {
        assert!(self.world.standstill_drop <= 0.2, "brake fell by {} at standstill", self.world.standstill_drop);
        self
    }
}
