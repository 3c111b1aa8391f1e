//! Short runs on the mock bench. Its truth is only read for comparison.

use jointbench_devices::{Joint, MockBench, MockSettings};
use jointbench_procedure::catalogue::brake_model;
use jointbench_procedure::identification::{Identification, Verdict};
use jointbench_procedure::in_memory_run::{run_in_memory, run_in_memory_with_facts};
use jointbench_procedure::parameter::Values;
use jointbench_procedure::{BenchFacts, procedure};
use serde_json::{Value, json};

pub fn found(settings: MockSettings, id: &str, parameters: Value) -> (MockBench, Identification) {
    let mock = MockBench::start(settings).unwrap();
    let mut bench = mock.open_bench("mock").unwrap();
    let done = run_in_memory(&mut bench, procedure(id).unwrap(), parameters.as_object().unwrap()).unwrap();
    let found = done.identification.unwrap();
    let finds = procedure(id).unwrap().finds();
    for quantity in &found.quantities {
        let is_declared = finds.iter().any(|findable| findable.is(&quantity.name) && findable.unit == quantity.unit);
        assert!(is_declared, "{id} does not say that it finds {} [{}]", quantity.name, quantity.unit);
    }
    (mock, found)
}

/// The engine ends a warm-up just below its bounds.
#[test]
fn a_warm_up_that_ended_by_itself_is_warm_and_one_that_did_not_says_what_drifts() {
    for joint in [Joint::JointA, Joint::JointB] {
        let warm_up = |given| found(MockSettings::new(joint, 1), "warm_up", given).1;
        let warm = warm_up(json!({"steady_c_per_min": 1.0, "sample_rate_hz": 100.0}));
        assert_eq!(warm.verdict, Verdict::Identified, "{}", warm.summary);
        let drift = warm.quantity("temperature_drift").unwrap().value;
        assert!((0.8..=1.0).contains(&drift), "{}", warm.summary);

        let cut_off = warm_up(json!({"longest_s": 100.0, "sample_rate_hz": 100.0, "steady_share_per_min": 1.0}));
        assert_eq!(cut_off.verdict, Verdict::Inconclusive, "{}", cut_off.summary);
        let says = |word: &str| cut_off.summary.contains(word);
        assert!(says("limit 0.3 K/min, steady_c_per_min") && !says("current"), "{}", cut_off.summary);
    }
}

#[test]
fn a_sensor_of_two_ranges_has_two_zeros_and_one_torque() {
    let mock = MockBench::start(MockSettings::new(Joint::JointB, 3)).unwrap();
    let mut bench = mock.open_bench("mock").unwrap();
    let procedure = procedure("torque_sensor_zero").unwrap();
    let given = json!({"duration_s": 45.0, "loads": 3, "speed_rad_s": 1.0, "dwell_s": 1.2});
    let done = run_in_memory(&mut bench, procedure, given.as_object().unwrap()).unwrap();
    let found = done.identification.unwrap();
    let value = |name: &str| found.quantity(name).unwrap().value;
    assert!((value("gain_ratio") - 1.0).abs() < 1e-3, "{}", found.summary);
    // 0.05 % of 200 Nm and 0.1 % of 20 Nm.
    assert!(value("disagreement") < 0.12 && found.summary.contains("they agree"), "{}", found.summary);
    assert!((value("zero_other") - value("zero")).abs() < 5e-3 && value("drag") > 0.01, "{}", found.summary);

    let strict = Values::parse(procedure.schema(), json!({"agree_nm": 1e-4}).as_object().unwrap()).unwrap();
    let found = procedure.identify(&strict, &done.table).unwrap();
    assert!(found.summary.contains("do not agree"), "{}", found.summary);
    assert!(found.verdict == Verdict::Inconclusive && found.advice.is_some());
}

#[test]
fn the_inverse_of_the_hysteresis_holds_on_a_history_that_it_has_not_seen() {
    let given = json!({"levels": 5, "loops": 2, "random_turns": 6, "dwell_s": 0.8, "speed_rad_s": 3.0});
    let (_, found) = found(MockSettings::new(Joint::JointB, 3), "brake_hysteresis", given);
    // Five levels are coarse: a straight line instead has at least three times the error.
    let [error, line] = ["error_max", "error_line"].map(|name| found.quantity(name).unwrap().value);
    assert!(error < 4.0 && 3.0 * error < line, "{error} % {line} %");
    let width = found.quantity("width").unwrap();
    let [low, high] = width.ci95.unwrap();
    assert!(width.value > 0.2 && low < width.value && width.value < high, "{} {low} {high}", width.value);
    // Every validation history is shown with the prediction of the model.
    let rated_nm = found.quantity("torque_top").unwrap().value;
    for name in ["minor_loops", "random_history"] {
        let figure = found.figures.iter().find(|figure| figure.name == name).unwrap();
        let [measured, model] = &figure.series[..] else { panic!("{figure:?}") };
        for (current_a, torque_nm) in measured.x.iter().zip(&measured.y) {
            let predicted = model.x.iter().zip(&model.y).filter(|(x, _)| (*x - current_a).abs() < 1e-9);
            let off = predicted.map(|(_, y)| (y - torque_nm).abs()).fold(f64::INFINITY, f64::min);
            assert!(off < 0.04 * rated_nm, "{name} at {current_a} A: {off} Nm");
        }
    }
}

#[test]
fn torque_is_commanded_through_the_model_of_an_earlier_run() {
    let mock = MockBench::start(MockSettings::new(Joint::JointB, 3)).unwrap();
    let mut bench = mock.open_bench("mock").unwrap();
    let mut facts = BenchFacts::of(&bench);
    let brake_torque = procedure("brake_torque").unwrap();
    let given = json!({"histories": 2, "torques": 8, "speed_rad_s": 3.0});
    let given = given.as_object().unwrap();
    let without = brake_torque.plan(given, &facts).unwrap_err().to_string();
    assert!(without.contains("run brake_hysteresis first"), "{without}");

    let hysteresis = json!({"levels": 8, "loops": 1, "random_turns": 4, "speed_rad_s": 3.0});
    let measured =
        run_in_memory(&mut bench, procedure("brake_hysteresis").unwrap(), hysteresis.as_object().unwrap()).unwrap();
    facts.brake_model = brake_model(&measured.table);
    let done = run_in_memory_with_facts(&mut bench, &facts, brake_torque, given).unwrap();
    let found = done.identification.unwrap();
    // Eight levels are coarse; 20, the default, keep 1 %.
    let error = found.quantity("error_max").unwrap();
    assert!(error.unit == "%" && error.value > 0.1 && error.value < 3.0, "{} % {}", error.value, found.summary);
    assert_eq!(found.quantity("torques").unwrap().value, 16.0);
    assert!(brake_model(&done.table).is_none(), "no reversal curves in it");
}

#[test]
fn strokes_on_the_mock_bench_bracket_its_friction() {
    let given = json!({"repeats": 2, "dwell_s": 1.0, "speeds": 3, "sample_rate_hz": 100.0});
    let (mock, found) = found(MockSettings::new(Joint::JointA, 4), "strokes", given);
    let truth = mock.truth();
    for (name, value) in [("offset_positive", truth.coulomb_nm), ("slope_negative", truth.viscous_nm_s)] {
        let quantity = found.quantity(name).unwrap();
        assert!((quantity.value / value - 1.0).abs() < 0.05, "{name}: {} for {value}", quantity.value);
    }
}

#[test]
fn a_stribeck_part_that_may_be_a_square_of_speed_is_not_identified() {
    let hidden = |effects: &[&str]| {
        let mut settings = MockSettings::new(Joint::JointA, 14003);
        settings.effects = effects.iter().map(|effect| (*effect).to_owned()).collect();
        found(settings, "friction", json!({})).1
    };
    let open = hidden(&["stribeck", "viscous_quadratic"]);
    assert_eq!(open.verdict, Verdict::Inconclusive, "{}", open.summary);
    assert!(open.summary.contains("Quadratic drag explains this run equally well"), "{}", open.summary);
    let friction = procedure("friction").unwrap();
    assert!(friction.follow_up(&open).is_none(), "half of Coulomb friction is not fed forward");
    let alone = hidden(&["stribeck"]);
    assert_eq!(alone.verdict, Verdict::Identified, "{}", alone.summary);
    assert!(friction.follow_up(&alone).is_some() && !alone.summary.contains("Quadratic drag"), "{}", alone.summary);
}

#[test]
fn friction_under_load_is_distinguished_from_a_rise_towards_standstill() {
    let settings = MockSettings::new(Joint::JointA, 1).hiding(&["stribeck", "load_linear"]);
    let (mock, found) = found(settings, "friction_load", json!({"load_levels": 4, "sample_rate_hz": 100.0}));
    assert!(found.summary.contains("in proportion to the load"), "{}", found.summary);
    let truth = mock.truth();
    for (name, truth) in [("tau_c", truth.coulomb_nm), ("c_v", truth.viscous_nm_s)] {
        let [low, high] = found.quantity(name).unwrap().ci95.unwrap();
        assert!((low..=high).contains(&truth), "{name} is given as {truth}: {low} … {high}");
        assert!(high - low < 0.05 * truth, "{name}: {low} … {high}");
    }
}

#[test]
fn a_joint_breaks_away_where_its_friction_at_rest_lies() {
    let given = json!({"positions": 3, "sample_rate_hz": 250.0, "ramp_nm_s": 0.04});
    let (mock, found) = found(MockSettings::new(Joint::JointA, 1), "breakaway", given);
    // Without a Stribeck part the breakaway torque equals Coulomb friction.
    let quantity = found.quantity("tau_b").unwrap();
    assert!((quantity.value / mock.truth().coulomb_nm - 1.0).abs() < 0.02, "{}", found.summary);
}

/// Each interval with commands that are frequent enough.
#[test]
fn set_point_intervals_do_not_change_the_friction_of_an_arm() {
    for (ninter, rate_hz, top_speed) in
        [(8, 200.0, 0.698), (16, 100.0, 0.698), (32, 250.0, 0.698), (64, 100.0, 0.698), (128, 100.0, 0.5)]
    {
        let given = json!({"speeds": 4, "breakaways": 2, "warm_up_s": 5.0, "ramp_nm_s": 0.03, "sample_rate_hz": rate_hz,
            "top_speed_rad_s": top_speed});
        let settings = MockSettings { ninter, ..MockSettings::new(Joint::Puma, 2) }.hiding(&["stribeck"]);
        let (mock, found) = found(settings, "puma_friction", given);
        let truth = mock.truth();
        let b = truth.viscous_nm_s * truth.gear_ratio / 1f64.to_degrees() / truth.torque_constant_nm_per_a;
        let [low, high] = found.quantity("b_mean").unwrap().ci95.unwrap();
        assert!((low..=high).contains(&b), "ninter {ninter}: {low} … {high} for {b}");
    }
}

/// Gravity loads the arm on both sides of its upright pose.
#[test]
fn an_arm_breaks_away_on_a_short_arc_without_its_weight() {
    let given = json!({"arc_rad": 0.3, "top_torque_nm": 0.3, "positions": 6, "ramp_nm_s": 0.01});
    let (mock, found) = found(MockSettings::new(Joint::Puma, 1).hiding(&["stribeck"]), "breakaway", given);
    assert_eq!(found.verdict, Verdict::Identified, "{}", found.summary);
    let truth = mock.truth();
    let hidden = |effect: &str, figure: &str| {
        truth.hidden.iter().find(|h| h.effect == effect).expect("the arm has it").parameters[figure]
    };
    let (rest_nm, offset_nm) =
        (truth.coulomb_nm + hidden("stribeck", "rise_nm"), hidden("direction_offset", "offset_nm"));
    assert!((found.quantity("tau_b").unwrap().value / rest_nm - 1.0).abs() < 0.02, "{}", found.summary);
    for (name, truth) in [
        ("tau_b_positive", rest_nm + offset_nm),
        ("tau_b_negative", rest_nm - offset_nm),
        ("tau_b_difference", 2.0 * offset_nm),
    ] {
        let [low, high] = found.quantity(name).unwrap().ci95.unwrap();
        assert!((low..=high).contains(&truth), "{name}: {low} … {high} for {truth}");
    }
}

#[test]
fn presliding_of_an_arm_shows_just_below_breakaway() {
    let presliding = |given| found(MockSettings::new(Joint::Puma, 1).hiding(&["stribeck"]), "presliding", given);
    let (_, still) = presliding(json!({"repeats": 2}));
    assert!(still.advice.is_some_and(|advice| advice.contains("95 % of the lower breakaway torque")));
    let (mock, found) = presliding(json!({"top_torque_nm": 0.105}));
    assert_eq!(found.verdict, Verdict::Identified, "{}", found.summary);
    let [low, high] = found.quantity("sigma_0").unwrap().ci95.unwrap();
    assert!((low..=high).contains(&mock.truth().bristle_nm_rad), "{low} … {high}");
}

#[test]
fn presliding_finds_the_stiffness_of_the_contacts_from_a_few_counts() {
    let (mock, found) = found(MockSettings::new(Joint::JointA, 1), "presliding", json!({}));
    assert_eq!(found.verdict, Verdict::Identified, "{found:?}");
    let truth = mock.truth();
    for (name, truth, share) in [("sigma_0", truth.bristle_nm_rad, 0.03), ("tau_c", truth.coulomb_nm, 0.01)] {
        let quantity = found.quantity(name).unwrap();
        assert!((quantity.value / truth - 1.0).abs() < share, "{name}: {} for {truth}", quantity.value);
    }
    let elements = |what: &str| -> Vec<f64> {
        let value = |n: u32| found.quantity(&format!("element_{n}_{what}")).unwrap().value;
        (1..=4).map(value).collect()
    };
    let (stiffness, slips_nm): (f64, f64) = (elements("stiffness").iter().sum(), elements("slip").iter().sum());
    assert!(stiffness < truth.bristle_nm_rad && stiffness > 0.5 * truth.bristle_nm_rad, "{stiffness}");
    assert!((slips_nm / truth.coulomb_nm - 0.98).abs() < 0.02, "{slips_nm}");
    for n in 1..=4 {
        let slip = found.quantity(&format!("element_{n}_slip")).unwrap();
        let [low, high] = slip.ci95.unwrap();
        assert!(low < slip.value && slip.value < high && high - low < 0.1 * slip.value, "{n}: {low} … {high}");
    }
    // Twice 0.4 √(σ₀J) with the inertia of the rotor: 0.7 ms, less than a control period of 4 ms.
    let damping = found.quantity("sigma_1_most").unwrap_or_else(|| panic!("{}", found.summary)).value;
    assert!((0.0107..1.0).contains(&damping) && found.quantity("sigma_1").is_none(), "{}", found.summary);
}

#[test]
fn a_joint_that_breaks_away_in_the_swings_decides_nothing() {
    let given = json!({"top_torque_nm": 0.045, "repeats": 2, "amplitudes": 2, "swings": 1});
    let (_, found) = found(MockSettings::new(Joint::JointA, 1), "presliding", given);
    assert_ne!(found.verdict, Verdict::Identified, "{found:?}");
    assert!(found.advice.as_ref().is_some_and(|advice| advice.contains("Reduce top_torque_nm")), "{found:?}");
}

#[test]
fn a_warm_up_and_a_cool_down_separate_viscous_and_constant_friction() {
    let mut settings = MockSettings::new(Joint::JointA, 21);
    let (_, cold) = found(settings.clone(), "friction_temperature", json!({}));
    assert!(cold.quantity("c_t").is_none() && cold.summary.contains("change by less than"), "{}", cold.summary);

    settings.effects = vec!["temperature_viscous".into()];
    let (mock, warm) = found(settings, "friction_temperature", json!({}));
    let truth = mock.truth();
    let holds = |name: &str, given: f64| {
        let [low, high] = warm.quantity(name).unwrap().ci95.unwrap();
        assert!((low..=high).contains(&given), "{name} is given as {given}: {}", warm.summary);
    };
    holds("tau_c", truth.coulomb_nm);
    holds("c_v", truth.viscous_nm_s);
    holds("c_t", -truth.hidden[0].parameters["per_k"] * truth.viscous_nm_s);
}

#[test]
fn stiffness_takes_the_bearing_off() {
    let given = json!({"load_levels": 4, "repeats": 2, "dwell_s": 0.8, "bearing_stiffness_nm_rad": 155e3,
        "sample_rate_hz": 100.0});
    let (mock, found) = found(MockSettings::new(Joint::JointA, 1), "stiffness", given);
    for (name, truth, share) in
        [("k", mock.truth().stiffness_nm_rad, 0.01), ("beta_0", mock.truth().directional_offset_rad, 0.03)]
    {
        let quantity = found.quantity(name).unwrap();
        assert!((quantity.value / truth - 1.0).abs() < share, "{name}: {} for {truth}", quantity.value);
    }
}

/// The arm's constants are within the intervals of the run, and the directions are distinguished.
#[test]
fn an_arm_gives_a_line_for_each_direction_and_its_stiction() {
    let given = json!({"speeds": 4, "repeats": 2, "breakaways": 2, "warm_up_s": 5.0, "ramp_nm_s": 0.03});
    let settings = MockSettings::new(Joint::Puma, 2).hiding(&["stribeck"]);
    let (mock, found) = found(settings, "puma_friction", given);
    assert_eq!(found.verdict, Verdict::Identified, "{} {:?}", found.summary, found.advice);
    let truth = mock.truth();
    let hidden = |effect: &str, figure: &str| {
        truth.hidden.iter().find(|h| h.effect == effect).expect("the arm has it").parameters[figure]
    };
    let (offset_nm, share) = (hidden("direction_offset", "offset_nm"), hidden("viscous_asymmetry", "relative"));
    let deg_s = (1.0 / truth.gear_ratio).to_degrees();
    let volts = |nm: f64| nm / truth.torque_constant_nm_per_a;
    for (name, truth, widest) in [
        ("f_positive", volts(truth.coulomb_nm + offset_nm), 0.02),
        ("f_negative", -volts(truth.coulomb_nm - offset_nm), 0.02),
        ("b_positive", volts(truth.viscous_nm_s * (1.0 + share)) / deg_s, 0.08),
        ("b_negative", volts(truth.viscous_nm_s * (1.0 - share)) / deg_s, 0.08),
        ("b_mean", volts(truth.viscous_nm_s) / deg_s, 0.06),
        ("c_v_mean", truth.viscous_nm_s, 0.06),
        ("weight", volts(hidden("gravity", "link_nm") / truth.gear_ratio), 0.1),
    ] {
        let quantity = found.quantity(name).unwrap();
        let [low, high] = quantity.ci95.unwrap();
        assert!((low..=high).contains(&truth), "{name}: {low} … {high} for {truth}");
        assert!(high - low < 2.0 * widest * truth.abs(), "{name}: {low} … {high}");
    }
    let rise_nm = hidden("stribeck", "rise_nm");
    for (name, sign) in [("stiction_positive", 1.0), ("stiction_negative", -1.0)] {
        let (value, truth) =
            (found.quantity(name).unwrap().value, volts(sign * (truth.coulomb_nm + rise_nm) + offset_nm));
        assert!((value / truth - 1.0).abs() < 0.04, "{name}: {value} for {truth}");
    }
    let [low, high] = found.quantity("f_difference").unwrap().ci95.unwrap();
    assert!(low > 0.0 && high > low, "the directions differ: {low} … {high}");
}

#[test]
fn a_soft_start_is_shown_with_its_curve_its_table_and_its_loop() {
    let given = json!({"load_levels": 8, "repeats": 2});
    let (_, found) = found(MockSettings::new(Joint::JointB, 3), "stiffness", given);
    assert!(found.summary.contains("Stiffness decreases at low torque"), "{}", found.summary);
    let [whole, beyond] = &found.figures[..] else { panic!("{:?}", found.figures) };
    let labels: Vec<&str> = whole.series.iter().map(|series| &series.label[..]).collect();
    let expected =
        ["loop at maximum load", "positive", "negative", "model, positive", "model, negative", "look-up table"];
    assert_eq!(labels, expected);
    let area = found.quantity("loop_area").unwrap();
    assert!(area.ci95.is_some_and(|[low, high]| low < area.value && area.value < high), "two repeats: {area:?}");
    // Without the slope the model ends at β₀ and the loop stays a loop.
    let beta_rad = found.quantity("beta_0").unwrap().value;
    let end = beyond.series[3].y.last().unwrap();
    assert!((end - beta_rad).abs() < 0.2 * beta_rad, "{end} for {beta_rad}");
    let reach = |y: &[f64]| y.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
    assert!(reach(&beyond.series[0].y) < 0.2 * reach(&whole.series[0].y), "the slope is taken off the loop too");
}
