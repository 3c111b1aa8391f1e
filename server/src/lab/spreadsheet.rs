//! Text that a spreadsheet would take for a formula. Whoever opens an export may not know where its names come from.

use super::{Answer, Lab, LabError};
use jointbench_files::{TableColumn, write_csv};
use jointbench_instrument::{Channel, Trace};

/// Text as a spreadsheet shows it and never computes it: an apostrophe before what begins a formula. A number stays one.
pub fn defused(text: String) -> String {
    let begins_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r']);
    match begins_formula && text.parse::<f64>().is_err() {
        true => format!("'{text}"),
        false => text,
    }
}

/// The same for the names and the texts of a table.
pub fn defused_columns(columns: Vec<(String, TableColumn)>) -> Vec<(String, TableColumn)> {
    let column = |column| match column {
        TableColumn::Words(words) => TableColumn::Words(words.into_iter().map(|word| word.map(defused)).collect()),
        numbers => numbers,
    };
    columns.into_iter().map(|(name, values)| (defused(name), column(values))).collect()
}

impl Lab {
    /// As [`Lab::export`] to a CSV, with names of columns that no spreadsheet takes for formulas.
    pub async fn export_for_spreadsheets(&self, id: i64, from_s: Option<f64>, to_s: Option<f64>) -> Answer<Vec<u8>> {
        let rows = self.inner.store.rows_between(id, from_s, to_s).await?;
        let trace = self.inner.store.trace(id, None, rows).await?;
        let failed = |fault: String| LabError::Internal(format!("writing the file failed: {fault}"));
        let write = move || {
            let mut bytes = Vec::new();
            write_csv(&mut bytes, &renamed(trace)).map(|()| bytes)
        };
        let written = tokio::task::spawn_blocking(write).await.map_err(|fault| failed(fault.to_string()))?;
        written.map_err(|fault| failed(fault.to_string()))
    }
}

fn renamed(trace: Trace) -> Trace {
    let channels =
        trace.channels().iter().map(|channel| Channel { name: defused(channel.name.clone()), ..channel.clone() });
    Trace::from_columns(channels.collect(), trace.columns().to_vec())
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
