//! How a table with other names or units becomes a run table.

use crate::Bounds;
use jointbench_instrument::Meta;
use std::path::PathBuf;

/// What to do to a file on its way in.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadOptions {
    /// The facts in a file of their own. Comes before `meta`, embedded facts and a file beside the table.
    pub meta_path: Option<PathBuf>,
    /// Facts already at hand.
    pub meta: Option<Meta>,
    /// Columns to rename: (name in the run table, name in the file).
    pub map: Vec<(String, String)>,
    /// Factors: (name in the run table, factor). A value in the table is the file's value times the factor.
    pub scale: Vec<(String, f64)>,
    /// Columns of the file that stay out, whatever they hold.
    pub leave: Vec<String>,
    /// A row with an empty cell stays out, and is a gap in time. How many did is a fact of the run.
    pub leave_empty_rows: bool,
    pub bounds: Bounds,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OptionFault {
    #[error("“{0}”: expected NAME=COLUMN, such as motor_current_a=Iq")]
    Map(String),
    #[error("“{0}”: expected NAME=FACTOR with a finite factor other than 0, such as motor_position_rad=0.0174532925")]
    Scale(String),
}

/// `motor_current_a=Iq` → (`motor_current_a`, `Iq`).
pub fn parse_map(text: &str) -> Result<(String, String), OptionFault> {
    match text.split_once('=') {
        Some((name, column)) if !name.trim().is_empty() && !column.trim().is_empty() => {
            Ok((name.trim().to_owned(), column.trim().to_owned()))
        }
        _ => Err(OptionFault::Map(text.to_owned())),
    }
}

/// `motor_position_rad=0.0174532925` → (`motor_position_rad`, 0.0174532925).
pub fn parse_scale(text: &str) -> Result<(String, f64), OptionFault> {
    let fault = || OptionFault::Scale(text.to_owned());
    let (name, factor) = text.split_once('=').ok_or_else(fault)?;
    let factor: f64 = factor.trim().parse().map_err(|_| fault())?;
    if name.trim().is_empty() || !factor.is_finite() || factor == 0.0 {
        return Err(fault());
    }
    Ok((name.trim().to_owned(), factor))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_checked_where_they_are_written() {
        assert_eq!(parse_map("motor_current_a=Iq"), Ok(("motor_current_a".into(), "Iq".into())));
        assert_eq!(parse_scale("x_rad = -2e-3"), Ok(("x_rad".into(), -2e-3)));
        for text in ["Iq", "=Iq", "x="] {
            assert!(parse_map(text).unwrap_err().to_string().contains("expected NAME=COLUMN"), "{text}");
        }
        for text in ["x_rad", "x_rad=deg", "x_rad=0", "x_rad=inf", "=2"] {
            assert!(parse_scale(text).unwrap_err().to_string().contains("expected NAME=FACTOR"), "{text}");
        }
    }
}
