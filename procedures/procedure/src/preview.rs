//! The dry run: effect of a plan on a bench, before anything moves.

use crate::bench_facts::BenchFacts;
use crate::catalogue::procedure;
use crate::parameter::{Parameter, ParameterKind};
use crate::plan::{BrakeControl, Drive, Plan, Step};
use jointbench_instrument::limits::Limited;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Preview of a run before its start.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Preview {
    /// Longest duration, without pauses.
    pub duration_s: f64,
    /// Every step, in its order.
    pub steps: Vec<StepPreview>,
    /// Largest value of each quantity, with its limit.
    pub extremes: Vec<Extreme>,
    /// The commanded courses.
    pub setpoints: Setpoints,
    /// All conditions of the start, met or not.
    pub checks: Vec<Check>,
}

impl Preview {
    /// Whether the engine would start this plan.
    pub fn is_allowed(&self) -> bool {
        self.checks.iter().all(|check| check.ok)
    }
}

/// One step of a previewed plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = PlannedStep)]
pub struct StepPreview {
    /// The label of the step in the plan.
    pub label: String,
    /// Duration without pauses.
    pub duration_s: f64,
}

/// The largest value that a plan commands, or is estimated to cause.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Extreme {
    /// The quantity, in words.
    pub quantity: String,
    /// Its unit, as SI symbol.
    pub unit: String,
    /// Largest absolute value over the plan.
    pub value: f64,
    /// Absent: the bench has no such limit.
    pub limit: Option<f64>,
    /// Within its limit.
    pub ok: bool,
}

/// The set-points as piecewise linear functions, exact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Setpoints {
    /// Times of the knots, the same for both courses (s).
    pub time_s: Vec<f64>,
    /// Motor-side velocity at each knot.
    pub motor_velocity_rad_s: Vec<f64>,
    /// Brake current at each knot.
    pub brake_current_a: Vec<f64>,
}

impl Extreme {
    /// Within its limit, with what friction and overshoot take.
    fn leaves_room(&self) -> bool {
        let taken = match self.quantity.as_str() {
            BEFORE_FRICTION => FOR_FRICTION,
            TRAVEL => FOR_OVERSHOOT,
            _ => 0.0,
        };
        self.ok && self.limit.is_none_or(|limit| self.value.abs() <= (1.0 - taken) * limit)
    }

    /// To a thousandth: `motor velocity 900 rad/s exceeds the limit of 350 rad/s`.
    fn exceeds(&self) -> String {
        let [value, limit] = [self.value, self.limit.unwrap_or(f64::INFINITY)].map(|v| (1e3 * v).round() / 1e3);
        let Self { quantity, unit, .. } = self;
        format!("{quantity} {value} {unit} exceeds the limit of {limit} {unit}")
    }
}

/// One condition of the start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Check {
    /// The condition, in words.
    pub name: String,
    /// The condition is met.
    pub ok: bool,
    /// What was compared, with values.
    pub detail: String,
    /// Advice if the condition is not met.
    pub cure: Option<String>,
}

impl Check {
    /// What is not met, and what to do.
    pub fn refusal(&self) -> String {
        match &self.cure {
            Some(cure) => format!("{} ({cure})", self.detail),
            None => self.detail.clone(),
        }
    }
}

/// Parameters that set the largest load, as a share of the brake's rated current. They are reduced before any other.
const LOADS: [&str; 2] = ["top_load", "top_current"];
/// Share of the motor current that a proposed value leaves to friction, which a plan does not know, and share of the
/// range that it leaves to overshoot. Decides nothing else.
const FOR_FRICTION: f64 = 0.1;
const FOR_OVERSHOOT: f64 = 0.01;
const BEFORE_FRICTION: &str = "motor current, friction not included";
const TRAVEL: &str = "link travel";
/// A proposed value has this number of digits.
const DIGITS: i32 = 3;
/// Halvings of the range of a parameter: more than the digits need.
const HALVINGS: u32 = 24;

impl Plan {
    /// Judges the plan against limits and instruments of a bench. Nothing moves.
    pub fn preview(&self, facts: &BenchFacts) -> Preview {
        Preview {
            duration_s: self.duration_s(),
            steps: self
                .steps
                .iter()
                .map(|step| StepPreview { label: step.label.clone(), duration_s: step.duration_s() })
                .collect(),
            extremes: self.extremes(facts),
            setpoints: self.setpoints(),
            checks: self.checks(facts),
        }
    }

    /// Speed, brake current and travel as commanded. Link torque, brake power and motor current as estimates: the
    /// upper bound of the brake torque, and the current for load and inertia without friction.
    pub fn extremes(&self, facts: &BenchFacts) -> Vec<Extreme> {
        let constants = &facts.constants;
        let limited = |quantity: Limited, value: f64| Extreme {
            quantity: quantity.name().to_owned(),
            unit: quantity.unit().to_owned(),
            value,
            limit: Some(facts.limits.of(quantity)),
            ok: facts.limits.check(quantity, value).is_ok(),
        };
        let (lowest, highest) = self.travel_rad();
        let ends_rad = [lowest, highest].map(|way| (self.begins_rad + way).abs() / constants.gear_ratio);
        let travel_rad = ends_rad[0].max(ends_rad[1]);
        let mut power_w = 0.0_f64;
        let mut torque_nm = 0.0_f64;
        for step in &self.steps {
            let brake_nm = brake_torque_bound_nm(step.brake.largest(), facts);
            torque_nm = torque_nm.max(brake_nm);
            power_w = power_w.max(brake_nm * step.velocity.largest() / constants.gear_ratio);
        }
        let steepest = self.steps.iter().map(|step| step.velocity.steepest()).fold(self.acceleration_rad_s2, f64::max);
        let motor_nm = torque_nm / constants.gear_ratio + constants.rotor_inertia_kg_m2 * steepest;
        let mut extremes = vec![
            limited(Limited::MotorVelocity, self.top_speed_rad_s()),
            limited(Limited::BrakeCurrent, self.top_brake_current_a()),
            limited(Limited::LinkTorque, torque_nm),
            limited(Limited::BrakePower, power_w),
            Extreme {
                quantity: BEFORE_FRICTION.to_owned(),
                ..limited(Limited::MotorCurrent, motor_nm / constants.torque_constant_nm_per_a)
            },
        ];
        if self.commands_current() {
            extremes.push(limited(Limited::MotorCurrent, self.top_motor_current_a()));
        }
        extremes.push(Extreme {
            quantity: TRAVEL.to_owned(),
            unit: "rad".to_owned(),
            value: travel_rad,
            limit: constants.link_range_rad,
            ok: constants.link_range_rad.is_none_or(|range_rad| travel_rad <= range_rad),
        });
        // For a bench without a brake, the brake quantities are omitted.
        extremes.retain(|extreme| extreme.value != 0.0 || extreme.limit != Some(0.0));
        extremes
    }

    fn checks(&self, facts: &BenchFacts) -> Vec<Check> {
        let broken: Vec<String> =
            self.extremes(facts).iter().filter(|extreme| !extreme.ok).map(Extreme::exceeds).collect();
        let needs_brake = self.top_brake_current_a() > 0.0;
        let feeds = self.steps.iter().any(|step| matches!(step.drive, Drive::Fed(_)));
        let cannot_feed = feeds && !facts.feeds_forward;
        let mut checks = vec![
            Check {
                name: "limits".to_owned(),
                ok: broken.is_empty(),
                detail: if broken.is_empty() {
                    "all values are within the limits of the bench".into()
                } else {
                    broken.join("; ")
                },
                cure: (!broken.is_empty()).then(|| self.within_limits(facts)),
            },
            Check {
                name: "brake".to_owned(),
                ok: facts.has_brake || !needs_brake,
                detail: match (needs_brake, facts.has_brake) {
                    (false, _) => "not needed",
                    (true, true) => "connected",
                    (true, false) => "not connected",
                }
                .into(),
                cure: (needs_brake && !facts.has_brake).then(|| "connect a brake, or plan without load".into()),
            },
            Check {
                name: "Feed-forward".to_owned(),
                ok: !cannot_feed,
                detail: match (feeds, cannot_feed) {
                    (false, _) => "not needed",
                    (true, false) => "supported by the drive",
                    (true, true) => "the drive does not support motor current feed-forward",
                }
                .into(),
                cure: cannot_feed.then(|| "select a bench with feed-forward, or another procedure".into()),
            },
            Check {
                name: "rest".to_owned(),
                ok: self.steps.iter().all(|step| step.velocity.at(0.0) == 0.0 && step.velocity.end() == 0.0),
                detail: format!("{} steps, each starts and ends at rest", self.steps.len()),
                cure: None,
            },
        ];
        checks.retain(|check| check.name != "brake" || facts.has_brake || needs_brake);
        checks.extend(self.magnetisation_check());
        checks.extend(facts.setpoint_interval.map(|interval| self.setpoint_check(interval.duration_s())));
        checks
    }

    /// A brake that a step magnetises at standstill is demagnetised by a later step.
    fn magnetisation_check(&self) -> Option<Check> {
        let at = self.steps.iter().rposition(|step| step.brake_control == BrakeControl::Magnetise)?;
        let top_a = self.steps[at].brake.largest();
        let demagnetises =
            |step: &Step| step.brake.largest() >= top_a && step.brake.end() == 0.0 && step.velocity.largest() > 0.0;
        let ok = self.steps[at + 1..].iter().any(demagnetises);
        let after = if ok { "demagnetised while turning afterwards" } else { "not demagnetised afterwards" };
        Some(Check {
            name: "magnetisation".to_owned(),
            ok,
            detail: format!("the brake is magnetised at standstill with {top_a:.3} A and {after}"),
            cure: (!ok).then(|| "end the plan with the steps of demagnetise".into()),
        })
    }

    /// A position servo stops where it has reached its set-point before the next command.
    fn setpoint_check(&self, interval_s: f64) -> Check {
        let ok = 1.0 / self.rate_hz <= interval_s * (1.0 + 1e-9);
        let cure = || {
            let rate_hz = (1.0 / interval_s).ceil();
            format!("set sample_rate_hz = {rate_hz} or more, or a larger ninter in the bench description")
        };
        Check {
            name: "set-point interval".to_owned(),
            ok,
            detail: format!(
                "a command every {:.3} ms, and set-points that are reached in {:.3} ms",
                1e3 / self.rate_hz,
                1e3 * interval_s
            ),
            cure: (!ok).then(cure),
        }
    }

    /// What brings the plan within the limits: the parameter of which a smaller value is enough, with its largest value.
    fn within_limits(&self, facts: &BenchFacts) -> String {
        let mut parameters: Vec<&Parameter> =
            procedure(&self.procedure).map_or_else(Vec::new, |procedure| procedure.schema().iter().collect());
        parameters.retain(|parameter| matches!(parameter.kind, ParameterKind::Number | ParameterKind::Fraction));
        parameters.sort_by_key(|parameter| !LOADS.contains(&parameter.name));
        let passing = |parameter: &Parameter| {
            let value = self.largest_value(parameter, facts)?;
            Some((parameter.name, parameter.text(value)))
        };
        match parameters.into_iter().find_map(passing) {
            Some((name, value)) => format!("set {name} = {value} or less, or select another bench"),
            None => "reduce speed or load, or select another bench".into(),
        }
    }

    /// The largest value of a parameter with which the plan is within the limits and leaves room, rounded.
    fn largest_value(&self, parameter: &Parameter, facts: &BenchFacts) -> Option<f64> {
        let procedure = procedure(&self.procedure)?;
        let passes = |value: f64| {
            let mut choices = self.parameters.clone();
            choices.insert(parameter.name.to_owned(), value.into());
            let plan = procedure.plan(&choices, facts);
            plan.is_ok_and(|plan| plan.extremes(facts).iter().all(Extreme::leaves_room))
        };
        let (mut passing, mut failing) = (parameter.min, self.parameters.get(parameter.name)?.as_f64()?);
        if !passes(passing) {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (passing + failing);
            *(if passes(middle) { &mut passing } else { &mut failing }) = middle;
        }
        if passing <= 0.0 {
            return Some(passing);
        }
        let scale = 10f64.powi(DIGITS - 1 - passing.log10().floor() as i32);
        let rounded = [(scale * passing).round() / scale, (scale * passing).floor() / scale];
        rounded.into_iter().find(|value| *value >= parameter.min && passes(*value))
    }

    fn setpoints(&self) -> Setpoints {
        let mut setpoints =
            Setpoints { time_s: Vec::new(), motor_velocity_rad_s: Vec::new(), brake_current_a: Vec::new() };
        let mut start_s = 0.0;
        for step in &self.steps {
            let knots = step.velocity.knots().iter().chain(step.brake.knots());
            let mut times: Vec<f64> = knots.map(|(t_s, _)| *t_s).chain([step.duration_s()]).collect();
            times.sort_by(f64::total_cmp);
            times.dedup();
            for t_s in times {
                setpoints.time_s.push(start_s + t_s);
                setpoints.motor_velocity_rad_s.push(step.velocity.at(t_s));
                setpoints.brake_current_a.push(step.brake.at(t_s));
            }
            start_s += step.duration_s();
        }
        setpoints
    }
}

/// An upper bound of the braking torque at a current (Nm).
///
/// The torque curve of a hysteresis brake is up to 4.4 % above the straight line to its rating, at 0.9 of the rated
/// current. Its descending branch is up to 8 % higher. The factor 1.15 covers both.
fn brake_torque_bound_nm(current_a: f64, facts: &BenchFacts) -> f64 {
    let constants = &facts.constants;
    if current_a == 0.0 {
        // A bench without a brake has no rating to divide by.
        return 0.0;
    }
    1.15 * constants.brake_rated_torque_nm * current_a / constants.brake_rated_current_a
}
