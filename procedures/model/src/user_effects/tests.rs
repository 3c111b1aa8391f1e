use crate::signal::Signals;
use crate::user_effects::*;

const RUB: &str = "rub: tau = a * tanh(velocity / w0) * abs(load); a [1] 0..1; w0 [rad/s] 0.1..10 start 1..5";

fn rub() -> UserEffect {
    UserEffect::inline(Kind::Friction, RUB).unwrap()
}

/// An error at `§`.
fn check_mistake(marked: &str, words: &str) {
    let fault = UserEffect::inline(Kind::Friction, &marked.replacen('§', "", 1)).unwrap_err();
    let at = marked.chars().position(|c| c == '§').unwrap();
    assert!(fault.position == at && fault.message.contains(words), "{marked}: {fault:?}");
}

#[test]
fn the_short_form_says_the_same_as_the_long_one() {
    let definition = Definition {
        id: "rub".into(),
        kind: Kind::Friction,
        formula: "tau = a * tanh(velocity / w0) * abs(load)".into(),
        parameters: vec![
            UserParameter {
                name: "a".into(),
                unit: "1".into(),
                min: Some(0.0),
                max: Some(1.0),
                start: None,
                whole: false,
            },
            UserParameter {
                name: "w0".into(),
                unit: "rad/s".into(),
                min: Some(0.1),
                max: Some(10.0),
                start: Some([1.0, 5.0]),
                whole: false,
            },
        ],
        title: String::new(),
        sentence: String::new(),
    };
    assert_eq!(*rub().definition(), definition);
    let again: UserEffect = serde_json::from_str(&serde_json::to_string(&rub()).unwrap()).unwrap();
    assert_eq!(again, rub());
    assert_eq!(rub().needs, ["motor_velocity_rad_s", "link_torque_nm"]);
}

#[test]
fn every_error_of_the_short_form_has_its_character() {
    check_mistake("rub: tau = a * §velocty; a [µm]", "did you mean velocity");
    check_mistake("r§üb: tau = a * velocity; a", "a name begins with a letter");
    check_mistake("§stribeck: tau = a * velocity; a", "the library has an effect");
    check_mistake("rub §tau = a * velocity; a", "colon");
    check_mistake("§Rub: tau = a * velocity; a", "lower case");
    check_mistake("rub: tau = a * velocity; §", "the name of a parameter");
    check_mistake("rub: tau = a * velocity; a §1", "a range such as 0..1");
    check_mistake("rub: tau = a * velocity; §a 2..1", "empty");
    check_mistake("rub: tau = a * velocity; a; §b", "does not occur");
    check_mistake("rub: tau = a * velocity; a; §a", "declared twice");
    check_mistake("rub: tau = a * velocity; a; §load", "is a signal");
    check_mistake("rub: tau = a * tanh(velocity / w); a; §w 1..2 start 0.5..1", "outside its bounds");
    check_mistake("rub: tau = a * cos(h * position); a; §h 1.. whole", "whole bounds");
    check_mistake("rub: tau = h * position; §h 1..4 whole", "cannot be whole");
    assert!(UserEffect::inline(Kind::Friction, &"(".repeat(5000)).is_err());
}

#[test]
fn a_formula_without_its_left_hand_side_is_kept_with_it() {
    let short = "rub: a * tanh(velocity / w0) * abs(load); a [1] 0..1; w0 [rad/s] 0.1..10 start 1..5";
    assert_eq!(UserEffect::inline(Kind::Friction, short).unwrap(), rub());
    let torsion = UserEffect::inline(Kind::Stiffness, "soft: k * load; k [rad/Nm]").unwrap();
    assert_eq!(torsion.definition().formula, "torsion = k * load");
    let tau = UserEffect::inline(Kind::Friction, "x: tau * velocity; tau [Nm*s/rad]").unwrap();
    assert_eq!(tau.definition().formula, "tau = tau * velocity");
    check_mistake("rub: a * §velocty; a", "did you mean velocity");
    check_mistake("rub: a * (load§; a", "closing bracket");
    check_mistake("rub: tau §* load; a", "= after the left-hand side");
}

#[test]
fn the_caret_is_below_the_error() {
    let fault = UserEffect::inline(Kind::Friction, "rub: tau = a * velocty; a").unwrap_err();
    assert_eq!(fault.marked(), "rub: tau = a * velocty; a\n               ^^^^^^^");
}

#[test]
fn all_unknown_names_are_reported_at_once() {
    let text = "rub: tau = a * tanh(µ / w1) * w2 * w1 * thanh(load); a";
    let fault = UserEffect::inline(Kind::Friction, text).unwrap_err();
    let marked = "                    ^   ^^    ^^        ^^^^^";
    assert_eq!(fault.marked(), format!("{text}\n{marked}"));
    let text = fault.to_string();
    for words in ["µ is neither", "`µ [Nm] 0..1`, or use a signal", "w1 [Nm] 0..1` (character 25)", "w2 is", "tanh?"]
    {
        assert!(text.contains(words), "{words}: {text}");
    }
    assert_eq!(text.matches("w1 is neither").count(), 1, "{text}");
}

#[test]
fn an_effect_without_a_sentence_says_its_formula() {
    let says = "What a user suspects: tau = a * tanh(velocity / w0) * abs(load).";
    assert_eq!(rub().info().sentence, says);
    let definition = Definition { sentence: "It rubs.".into(), ..rub().definition().clone() };
    assert_eq!(UserEffect::try_from(definition).unwrap().info().sentence, "It rubs.");
}

fn view(velocity: &[f64]) -> View {
    let mut points = Signals::new(velocity.len());
    points.set(Signal::Velocity, velocity.to_vec());
    points.set(Signal::Load, vec![2.0; velocity.len()]);
    View::new(points, Signals::new(0), Vec::new(), Vec::new(), 0.004)
}

#[test]
fn the_search_begins_where_the_user_says() {
    let effect = rub();
    let forms = effect.forms(&view(&[-3.0, 1.0, 4.0]));
    let [form] = forms.as_slice() else { panic!("one form") };
    assert_eq!((form.linear.as_slice(), form.shape[0].name), (["a"].as_slice(), "w0"));
    assert_eq!((form.shape[0].min, form.shape[0].max), (0.1, 10.0));
    assert_eq!((form.grid[0][0], form.grid.len()), (1.0, 10));
    assert!((form.grid[9][0] - 5.0).abs() < 1e-12);
}

#[test]
fn a_range_that_is_not_given_comes_from_the_data() {
    let effect = UserEffect::inline(Kind::Friction, "x: tau = a * exp(-abs(velocity)/w); a [Nm]; w [rad/s]").unwrap();
    let forms = effect.forms(&view(&[-3.0, 1.0, 4.0]));
    assert_eq!((forms[0].shape[0].min, forms[0].shape[0].max), (4e-3, 40.0));
    let effect = UserEffect::inline(Kind::Friction, "x: tau = a * abs(velocity - v); a [Nm]; v -1..2").unwrap();
    let forms = effect.forms(&view(&[-3.0, 1.0, 4.0]));
    assert_eq!((forms[0].grid[0][0], forms[0].grid[9][0]), (-1.0, 2.0));
}

#[test]
fn a_non_finite_value_is_reported_with_its_point() {
    let effect = UserEffect::inline(Kind::Friction, "x: tau = a / velocity; a [Nm]").unwrap();
    assert!(effect.check(&view(&[1.0, 2.0])).is_ok());
    let error = effect.check(&view(&[1.0, 0.0, 2.0])).unwrap_err();
    let ModelError::NotFinite { points: 1, first, .. } = &error else { panic!("{error}") };
    assert_eq!(first, "first where velocity = 0.0000 rad/s");
    assert!(effect.hidden(&view(&[1.0, 0.0, 2.0])).is_some_and(|why| why.contains("not finite")));
    let effect = UserEffect::inline(Kind::Friction, "x: tau = a / 0; a [Nm]").unwrap();
    let text = effect.check(&view(&[1.0, 2.0])).unwrap_err().to_string();
    assert!(text.contains("names no signal") && !text.contains("where ;"), "{text}");
}

#[test]
fn a_wave_is_attenuated_at_steady_state() {
    let effect = UserEffect::inline(Kind::Friction, "x: tau = a * cos(5 * position); a [Nm]").unwrap();
    let position: Vec<f64> = (0..40).map(|i| 0.1 * f64::from(i)).collect();
    let mut samples = Signals::new(40);
    samples.set(Signal::Position, position.clone());
    let mut points = Signals::new(1);
    points.set(Signal::Position, vec![1.95]);
    let mean = position.iter().map(|q| (5.0 * q).cos()).sum::<f64>() / 40.0;
    let view = View::new(points, samples, std::iter::once(0..40).collect(), vec![0], 0.004);
    assert!((effect.columns("formula", &[], &view)[0][0] - mean).abs() < 1e-15);
}

#[test]
fn a_column_that_the_run_has_not_is_missed_at_its_character() {
    let text = "oil: tau = a * tanh(velocity) + b * column(oil_presure_pa); a [Nm]; b [1]";
    let oil = UserEffect::inline(Kind::Friction, text).unwrap();
    let fault = oil.missing(&["time_s", "oil_pressure_pa"]).unwrap();
    assert_eq!((fault.position, fault.length), (31, 22));
    assert!(fault.message.contains("did you mean oil_pressure_pa?"), "{fault}");
    assert!(oil.missing(&["oil_presure_pa"]).is_none() && rub().missing(&[]).is_none());
}
