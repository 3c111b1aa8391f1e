use super::*;

const KNOWN: [&str; 3] = ["time_s", "motor_velocity_rad_s", "motor_current_a"];

fn times(n: usize, step_s: f64) -> Vec<f64> {
    (0..n).map(|i| i as f64 * step_s).collect()
}

#[test]
fn a_formula_is_computed_row_by_row() {
    let formula = ChannelFormula::parse("2 * motor_current_a - abs(motor_velocity_rad_s)^2", &KNOWN).unwrap();
    assert_eq!(formula.columns(), ["motor_current_a", "motor_velocity_rad_s"]);
    assert_eq!(formula.unit(), None);
    assert_eq!(formula.values(&[0.0, 1.0], &[&[1.0, 2.0], &[-3.0, 0.5]]), [-7.0, 3.75]);
}

#[test]
fn a_derivative_is_exact_on_a_parabola_and_stops_at_a_pause() {
    let formula = ChannelFormula::parse("derivative(motor_velocity_rad_s)", &KNOWN).unwrap();
    assert_eq!(formula.unit().as_deref(), Some("rad/s²"));
    let mut time_s = times(20, 0.01);
    time_s.extend(times(20, 0.01).iter().map(|t| t + 5.0));
    let velocity: Vec<f64> = time_s.iter().map(|t| 3.0 * t * t).collect();
    let slopes = formula.values(&time_s, &[&velocity]);
    for i in (1..19).chain(21..39) {
        assert!((slopes[i] - 6.0 * time_s[i]).abs() < 1e-9, "row {i}: {}", slopes[i]);
    }
    assert!((slopes[19] - 6.0 * 0.185).abs() < 1e-9, "the last row before the pause looks across it: {}", slopes[19]);
}

#[test]
fn an_integral_of_a_constant_grows_and_waits_through_a_pause() {
    let formula = ChannelFormula::parse("integral(motor_velocity_rad_s)", &KNOWN).unwrap();
    assert_eq!(formula.unit().as_deref(), Some("rad"));
    let mut time_s = times(11, 0.1);
    time_s.extend(times(11, 0.1).iter().map(|t| t + 100.0));
    let sums = formula.values(&time_s, &[&[2.0; 22]]);
    assert!((sums[10] - 2.0).abs() < 1e-12 && (sums[21] - 4.0).abs() < 1e-12, "{sums:?}");
}

#[test]
fn a_mean_over_time_leaves_out_what_is_missing() {
    let formula = ChannelFormula::parse("smooth(motor_current_a, 0.2)", &KNOWN).unwrap();
    assert_eq!(formula.unit().as_deref(), Some("A"));
    let means = formula.values(&times(5, 0.1), &[&[1.0, f64::NAN, 3.0, 5.0, 7.0]]);
    assert_eq!(means, [1.0, 2.0, 4.0, 5.0, 6.0]);
}

#[test]
fn an_error_has_its_character() {
    for (text, position, part) in [
        ("motor_currant_a * 2", 0, "motor_current_a"),
        ("derivativ(motor_current_a)", 0, "derivative"),
        ("smooth(motor_current_a, motor_velocity_rad_s)", 24, "number"),
        ("smooth(motor_current_a)", 0, "2 arguments"),
        ("motor_current_a *", 17, "expected"),
    ] {
        let fault = ChannelFormula::parse(text, &KNOWN).unwrap_err();
        assert_eq!(fault.position, position, "{text}: {fault}");
        assert!(fault.message.contains(part) || part == "expected", "{text}: {fault}");
    }
}

#[test]
fn a_sine_has_its_amplitude_in_the_spectrum() {
    let time_s = times(5000, 0.001);
    let values: Vec<f64> = time_s.iter().map(|t| 4.0 + 0.3 * (std::f64::consts::TAU * 125.0 * t).sin()).collect();
    let found = spectrum(&time_s, &values).unwrap();
    let peak = (0..found.amplitude.len()).max_by(|a, b| found.amplitude[*a].total_cmp(&found.amplitude[*b])).unwrap();
    assert!((found.frequency_hz[peak] - 125.0).abs() < 0.5, "{} Hz", found.frequency_hz[peak]);
    assert!((found.amplitude[peak] - 0.3).abs() < 1e-3, "{}", found.amplitude[peak]);
    assert!(found.amplitude[0] < 1e-9, "the mean is in it: {}", found.amplitude[0]);
    assert!(found.windows > 2, "{} windows", found.windows);
}

#[test]
fn no_spectrum_of_a_few_rows() {
    assert_eq!(spectrum(&times(20, 0.001), &[1.0; 20]), None);
    let holes: Vec<f64> = (0..100).map(|i| if i % 20 == 0 { f64::NAN } else { 1.0 }).collect();
    assert_eq!(spectrum(&times(100, 0.001), &holes), None);
}
