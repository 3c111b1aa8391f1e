//! The names of what a procedure can find, so that a demand on one that it never gives is refused before anything moves.

use super::identify_joint;

/// Names by procedure; `#` stands for a number from 1 on. What a run does not show is not among its quantities.
const NAMES: [(&str, &str); 20] = [
    (
        "friction",
        "tau_c c_v tau_h omega_s delta_s tau_c_positive c_v_positive tau_h_positive omega_s_positive delta_s_positive \
         tau_c_negative c_v_negative tau_h_negative omega_s_negative delta_s_negative tau_c_difference c_v_difference \
         r2_positive r2_negative",
    ),
    ("friction_load", "tau_c c_v mu mu_2 added"),
    ("friction_temperature", "temperature_low temperature_high tau_c c_v tau_t c_t"),
    ("brake_speed_independence", "torque_# slope_# change_# change_max"),
    ("brake_hysteresis", "torque_top width drag error_max error_rms current_error error_line"),
    ("brake_torque", "error_max error_rms error_mean torques"),
    ("demagnetise", "left noise"),
    ("torque_sensor_zero", "zero drift drag zero_other drift_other gain_ratio disagreement"),
    ("stiffness", "inverse_k k beta_0 xi line_rms rms loop_area"),
    ("breakaway", "tau_b tau_b_positive tau_b_negative deviation"),
    ("presliding", "sigma_0 tau_c reach bias element_#_stiffness element_#_slip"),
    (
        "compensation",
        "rho_1_none rho_1_zero_area rho_1_interpolated rho_1_coulomb_viscous rho_1_full rho_1_observer rho_2_none \
         rho_2_zero_area rho_2_interpolated rho_2_coulomb_viscous rho_2_full rho_2_observer rho_max_none rho_max_zero_area \
         rho_max_interpolated rho_max_coulomb_viscous rho_max_full rho_max_observer ratio_none ratio_zero_area \
         ratio_interpolated ratio_coulomb_viscous ratio_full ratio_observer over_none over_zero_area over_interpolated \
         over_coulomb_viscous over_full over_observer",
    ),
    ("strokes", "offset_positive slope_positive r2_positive offset_negative slope_negative r2_negative"),
    ("warm_up", "torque current_drift temperature_drift"),
    (
        "puma_friction",
        "b_positive f_positive r2_positive b_negative f_negative r2_negative f_difference b_difference weight \
         stiction_positive stiction_negative tau_c_positive c_v_positive tau_c_negative c_v_negative",
    ),
    ("encoder_offset", "offset offset_points direction_difference positions"),
    ("encoder_startup", "offset startup_spread startup_range repeatability power_ups"),
    ("encoder_delay", "delay offset hysteresis filter_delay"),
    (
        "encoder_linearity",
        "bits_before peak_before bits_table peak_table bits_velocity peak_velocity bits_direction peak_direction harmonic_1 \
         harmonic_2 pole_period pole_period_order",
    ),
    (
        "encoder_alignment",
        "radial_negative radial_positive axial_positive rotation_negative rotation_positive tilt_negative tilt_positive \
         vertical_negative vertical_positive best_radial_shift best_harmonic_1",
    ),
];

/// What a procedure can find. Empty where no procedure has this id.
pub fn results(procedure: &str) -> Vec<String> {
    if procedure == "identify_joint" {
        let of_part = |part: &&str| results(part).into_iter().map(|name| format!("{part}.{name}")).collect::<Vec<_>>();
        return identify_joint::PARTS_IN_ORDER.iter().flat_map(of_part).collect();
    }
    let names = NAMES.iter().find(|(id, _)| *id == procedure).map_or("", |(_, names)| names);
    names.split_whitespace().map(str::to_owned).collect()
}

/// Whether a procedure can find a quantity of this name.
pub fn can_find(procedure: &str, name: &str) -> bool {
    let plain: String =
        name.split('_').map(|word| if is_number(word) { "#" } else { word }).collect::<Vec<_>>().join("_");
    results(procedure).iter().any(|known| *known == name || *known == plain)
}

fn is_number(word: &str) -> bool {
    !word.is_empty() && word.bytes().all(|byte| byte.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_procedure_names_what_it_finds() {
        for procedure in crate::catalogue() {
            assert!(!results(procedure.id()).is_empty(), "{}", procedure.id());
        }
        assert!(can_find("friction", "tau_c") && !can_find("friction", "tau_x"));
        assert!(can_find("presliding", "element_3_slip") && can_find("brake_speed_independence", "torque_2"));
        assert!(can_find("identify_joint", "stiffness.beta_0") && !can_find("identify_joint", "beta_0"));
        // A number of a name is no place for any number.
        assert!(can_find("stiffness", "beta_0") && !can_find("stiffness", "beta_1"));
    }
}
