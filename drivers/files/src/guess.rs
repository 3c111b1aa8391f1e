//! The probable columns of a run table in a foreign table. Proposed to the user, never applied.

use crate::ProposedOption;
use crate::column::Column;
use crate::naming::{Named, is_time, known};
use crate::unit::{Dimension, Unit, dimension_of, is_count};
use jointbench_instrument::Kind;
use serde::{Deserialize, Serialize};

/// A column of the run table, and its probable source in the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Proposal {
    pub column: String,
    /// Name in the file.
    pub from: String,
    /// Unit of the source, if its name or the line of units states it, or the name itself is a unit.
    pub unit: Option<String>,
}

impl Proposal {
    /// The options that apply it.
    pub fn option(&self) -> ProposedOption {
        let map = ProposedOption::new("map", format!("{}={}", self.column, self.from));
        let is_open = |unit: &str| unit.starts_with("counts/N");
        let is_told = |unit: &&String| is_open(unit) || Unit::parse(unit).is_some_and(|unit| !unit.is_si());
        match self.unit.as_ref().filter(is_told) {
            Some(unit) => {
                let both = map.and("unit", format!("{}={unit}", self.column));
                if is_open(unit) { both.incomplete() } else { both }
            }
            None => map,
        }
    }
}

/// Common names of these columns without their units, the most certain first.
const ALIASES: [(&str, &str); 15] = [
    (
        "motor_position_rad",
        "motor_position motor_pos motor_angle theta_m rotor_position motorwinkel motor_winkel motorposition encoder encoder_position position pos angle q phi theta \
         winkel",
    ),
    (
        "motor_velocity_rad_s",
        "motor_velocity motor_vel motor_speed omega_m velocity velocity_measured vel speed omega qd dq rpm w drehzahl motordrehzahl motorgeschwindigkeit motor_drehzahl vitesse_moteur \
         velocity_estimate",
    ),
    (
        "motor_current_a",
        "motor_current iq i_q iq_measured iq_meas q_current current_q current cur i amps motorstrom motor_strom strom courant_moteur courant i_motor motor_current_measured",
    ),
    (
        "link_position_rad",
        "link_position link_pos link_angle output_position output_pos output_angle load_position load_angle joint_position \
         joint_angle",
    ),
    ("link_velocity_rad_s", "link_velocity link_vel output_velocity output_speed load_velocity joint_velocity"),
    (
        "link_torque_nm",
        "link_torque load_torque output_torque sensor_torque joint_torque tau_link link_tau trq torque tau couple load moment abtriebsmoment drehmoment last",
    ),
    ("temperature_c", "temperature temp winding_temperature motor_temperature motor_temp t_motor"),
    ("brake_current_a", "brake_current i_brake current i"),
    ("brake_torque_nm", "brake_torque torque tau drehmoment"),
    ("velocity_rad_s", "velocity velocity_measured vel speed omega rpm w"),
    ("position_rad", "position pos angle phi"),
    ("reference_position_rad", "reference_position reference ref ref_position ref_angle ref_pos"),
    ("test_position_rad", "test_position test dut test_angle dut_position encoder_position encoder"),
    ("segment", "segment seg step leg"),
    ("repeat", "repeat rep cycle pass"),
];

/// The most probable source of each missing column. Each source is used only once.
pub fn guess(columns: &[Column], kind: Kind) -> Vec<Proposal> {
    let mut taken: Vec<usize> = columns
        .iter()
        .enumerate()
        .filter(|(_, c)| known(kind).any(|name| name == c.name))
        .map(|(place, _)| place)
        .collect();
    let mut found = Vec::new();
    for column in known(kind).filter(|name| !columns.iter().any(|c| c.name == *name)) {
        let place = columns.iter().enumerate().filter(|(place, source)| !taken.contains(place) && !source.is_words());
        let best = place.filter_map(|(place, source)| Some((rank(column, source)?, place))).min();
        if let Some((_, place)) = best {
            taken.push(place);
            let from = columns[place].name.clone();
            found.push(Proposal { column: column.to_owned(), unit: unit_of(&columns[place], column), from });
        }
    }
    found
}

/// The unit that a column states in its name or as its name, if it suits the wanted column.
pub fn unit_of(source: &Column, column: &str) -> Option<String> {
    let named = Named::of(source);
    let last = named.quantity.rsplit('_').next().unwrap_or_default().to_owned();
    let pair = named.quantity.rsplitn(3, '_').take(2).collect::<Vec<_>>();
    let ratio = if pair.len() == 2 { format!("{}/{}", pair[1], pair[0]) } else { String::new() };
    let fits = |unit: Unit| Some(unit.dimension) == dimension_of(column);
    // The m in `theta_m` means motor, not metres.
    let is_linear = |text: &str, unit: Unit| unit.is_linear() && text.len() > 1;
    if let Some(stated) = &named.unit
        && Unit::parse(stated).is_some_and(|unit| fits(unit) || unit.is_linear())
    {
        return Some(stated.clone());
    }
    let words = [named.unit.unwrap_or_default(), ratio, last].into_iter().filter(|text| !text.is_empty());
    words.into_iter().find_map(|text| {
        let unit = Unit::parse(&text).filter(|unit| fits(*unit) || is_linear(&text, *unit));
        match unit {
            Some(_) => Some(Unit::written(&text).unwrap_or(text)),
            None => counts_of(&text, column).map(str::to_owned),
        }
    })
}

/// The unit of encoder counts, which is complete only with the counts per turn.
pub fn counts_of(word: &str, column: &str) -> Option<&'static str> {
    let per_turn = match dimension_of(column)? {
        Dimension::Angle => "counts/N",
        Dimension::AngularVelocity => "counts/N/s",
        _ => return None,
    };
    (is_count(word) || word == per_turn).then_some(per_turn)
}

/// Uncertainty of a source; smaller is more certain.
fn rank(column: &str, source: &Column) -> Option<usize> {
    let named = Named::of(source);
    let unit = named.unit.as_deref().and_then(Unit::parse);
    if unit.is_some_and(|unit| dimension_of(column).is_some_and(|of| of != unit.dimension) && !unit.is_linear()) {
        return None;
    }
    let bare = bare(&named.quantity, column);
    match column {
        "time_s" => is_time(&bare).then_some(0),
        _ => {
            let (_, names) = ALIASES.iter().find(|(name, _)| *name == column)?;
            names.split_whitespace().position(|name| name == bare || name.replace('_', "") == bare)
        }
    }
}

/// A quantity without a unit at its end: `pos_deg` → `pos`, `vel_rad_s` → `vel`.
fn bare(quantity: &str, column: &str) -> String {
    let fits = |text: &str| Unit::parse(text).is_some_and(|unit| Some(unit.dimension) == dimension_of(column));
    let parts: Vec<&str> = quantity.split('_').collect();
    let count = parts.len();
    if count > 2 && fits(&format!("{}/{}", parts[count - 2], parts[count - 1])) {
        return parts[..count - 2].join("_");
    }
    if count > 1 && fits(parts[count - 1]) {
        return parts[..count - 1].join("_");
    }
    quantity.to_owned()
}

/// The kind with the largest fraction of its required columns; the first one of equals.
pub fn guess_kind(columns: &[Column]) -> Kind {
    let share = |kind: Kind| {
        let guessed = guess(columns, kind);
        let has =
            |name: &&&str| columns.iter().any(|c| c.name == **name) || guessed.iter().any(|one| one.column == **name);
        kind.required_columns().iter().filter(has).count() as f64 / kind.required_columns().len() as f64
    };
    Kind::ALL
        .into_iter()
        .reduce(|best, kind| if share(kind) > share(best) { kind } else { best })
        .unwrap_or(Kind::Friction)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(names: &[&str]) -> Vec<Column> {
        names.iter().map(|name| Column::new(*name, vec![0.0, 1.0])).collect()
    }

    #[test]
    fn foreign_names_are_guessed_with_their_units() {
        let found = guess(&columns(&["Time [ms]", "pos_deg", "Iq [A]", "speed_rpm", "Torque (mNm)"]), Kind::Friction);
        let options: Vec<String> = found.iter().map(|one| one.option().text).collect();
        assert_eq!(
            options,
            [
                "--map 'time_s=Time [ms]' --unit time_s=ms",
                "--map motor_position_rad=pos_deg --unit motor_position_rad=deg",
                "--map 'motor_current_a=Iq [A]'",
                "--map motor_velocity_rad_s=speed_rpm --unit motor_velocity_rad_s=rpm",
                "--map 'link_torque_nm=Torque (mNm)' --unit link_torque_nm=mNm",
            ]
        );
        assert!(guess(&columns(Kind::Friction.required_columns()), Kind::Friction).is_empty());
        assert!(guess(&columns(&["T [degC]"]), Kind::Friction).iter().all(|one| one.column != "time_s"));
    }

    #[test]
    fn a_table_of_each_kind_is_known_by_its_columns() {
        for kind in Kind::ALL {
            assert_eq!(guess_kind(&columns(kind.required_columns())), kind);
        }
    }
}
