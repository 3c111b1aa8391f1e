//! Protection against formula injection: a spreadsheet may run text as a formula, and names can come from other
//! persons.

use jointbench_files::TableColumn;
use jointbench_instrument::Channel;

/// Text that a spreadsheet shows and does not evaluate: adds an apostrophe before the start of a formula. Numbers
/// remain.
pub fn defused(text: String) -> String {
    let begins_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r']);
    match begins_formula && text.parse::<f64>().is_err() {
        true => format!("'{text}"),
        false => text,
    }
}

/// The same for names and texts of a table.
pub fn defused_columns(columns: Vec<(String, TableColumn)>) -> Vec<(String, TableColumn)> {
    let column = |column| match column {
        TableColumn::Words(words) => TableColumn::Words(words.into_iter().map(|word| word.map(defused)).collect()),
        numbers => numbers,
    };
    columns.into_iter().map(|(name, values)| (defused(name), column(values))).collect()
}

/// The same for names of channels.
pub fn defused_channels(channels: Vec<Channel>) -> Vec<Channel> {
    channels.into_iter().map(|channel| Channel { name: defused(channel.name), ..channel }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_formula_becomes_text_and_a_number_stays() {
        for (text, safe) in [
            ("=HYPERLINK(\"x\")", "'=HYPERLINK(\"x\")"),
            ("+cmd|' /C calc'!A0", "'+cmd|' /C calc'!A0"),
            ("-2+3", "'-2+3"),
            ("@SUM(A1)", "'@SUM(A1)"),
            ("-1.5e-3", "-1.5e-3"),
            ("time_s", "time_s"),
            ("a=b", "a=b"),
            ("", ""),
        ] {
            assert_eq!(defused(text.to_owned()), safe);
        }
    }
}
