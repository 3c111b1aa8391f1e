//! Figures of a result with their units, intervals, directions and configurations.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Direction of motion for which a quantity holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = QuantityDirection)]
pub enum Direction {
    /// The motor position increases.
    Positive,
    /// The motor position decreases.
    Negative,
}

impl Direction {
    /// In the order of tables.
    pub const ALL: [Self; 2] = [Self::Positive, Self::Negative];

    /// As in names and sentences.
    pub fn word(self) -> &'static str {
        match self {
            Self::Positive => "positive",
            Self::Negative => "negative",
        }
    }

    fn mark(self) -> char {
        match self {
            Self::Positive => '⁺',
            Self::Negative => '⁻',
        }
    }
}

/// One figure of a result, in SI units or in percent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Quantity {
    /// Stable and unique in its identification: `tau_c_positive`. Scripts and limits depend on it.
    pub name: String,
    /// As in the source document: `τ_c⁺`.
    pub symbol: String,
    /// In words: "Coulomb friction, positive direction".
    pub title: String,
    /// The title without the part of a campaign and without the configuration: "Coulomb friction". Absent: the title
    /// contains neither.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base_title: Option<String>,
    /// The symbol without the direction: `τ_c`. Absent: the symbol contains none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base_symbol: Option<String>,
    /// The direction or method for which it holds: "positive direction".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub configuration: Option<String>,
    /// The direction of motion, if the configuration is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<Direction>,
    /// SI symbol, or `%`; empty for a ratio or a count.
    pub unit: String,
    /// Estimate, in the unit of the quantity.
    pub value: f64,
    /// 95 % interval, if the run determines one.
    #[schema(value_type = Option<Vec<f64>>, min_items = 2, max_items = 2)]
    pub ci95: Option<[f64; 2]>,
}

impl Quantity {
    /// The quantity for one of several configurations, which its title names.
    pub fn in_configuration(self, configuration: &str) -> Self {
        let title = format!("{}, {configuration}", self.title);
        Self { base_title: Some(self.title), configuration: Some(configuration.to_owned()), title, ..self }
    }

    /// The quantity for one direction: `tau_c` becomes `tau_c_positive`, and its symbol `τ_c⁺`.
    pub fn in_direction(self, direction: Direction) -> Self {
        let one = self.in_configuration(&format!("{} direction", direction.word()));
        Self {
            name: format!("{}_{}", one.name, direction.word()),
            symbol: format!("{}{}", one.symbol, direction.mark()),
            base_symbol: Some(one.symbol),
            direction: Some(direction),
            ..one
        }
    }

    /// The quantity as one of a part of a campaign, with its id and title.
    pub fn in_part(self, id: &str, title: &str) -> Self {
        let (name, title) = (format!("{id}.{}", self.name), format!("{title}: {}", self.title));
        Self { base_title: Some(self.base_title.unwrap_or(self.title)), name, title, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::findings::quantity;

    #[test]
    fn a_quantity_of_a_direction_keeps_the_words_of_both_directions() {
        let friction = quantity(["tau_c", "τ_c", "Coulomb friction", "Nm"], 0.03, None);
        let negative = friction.in_direction(Direction::Negative);
        assert_eq!((negative.name.as_str(), negative.symbol.as_str()), ("tau_c_negative", "τ_c⁻"));
        assert_eq!(negative.title, "Coulomb friction, negative direction");
        assert_eq!(negative.base_symbol.as_deref(), Some("τ_c"));
        let part = negative.in_part("friction", "Friction");
        assert_eq!((part.name.as_str(), part.direction), ("friction.tau_c_negative", Some(Direction::Negative)));
    }
}
