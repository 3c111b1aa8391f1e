//! Export of tables from a page. The page selects, bins and computes the values, so it sends the table.

use super::spreadsheet::defused_columns;
use super::{Answer, Lab, LabError};
use crate::view::{Cell, Table};
use jointbench_files::{TableColumn, write_table_csv, write_table_parquet};
use serde::Deserialize;
use std::collections::HashSet;
use utoipa::ToSchema;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum TableFormat {
    Csv,
    Parquet,
}

impl TableFormat {
    pub fn media_type(self) -> &'static str {
        match self {
            TableFormat::Csv => "text/csv; charset=utf-8",
            TableFormat::Parquet => "application/vnd.apache.parquet",
        }
    }
}

impl Lab {
    /// `spreadsheet_safe`: no text of a CSV file is read as a formula.
    pub async fn write_table(&self, table: Table, format: TableFormat, spreadsheet_safe: bool) -> Answer<Vec<u8>> {
        let mut columns = columns(table)?;
        if spreadsheet_safe && format == TableFormat::Csv {
            columns = defused_columns(columns);
        }
        let write = move || {
            let mut bytes = Vec::new();
            match format {
                TableFormat::Csv => write_table_csv(&mut bytes, &columns),
                TableFormat::Parquet => write_table_parquet(&mut bytes, columns),
            }
            .map(|()| bytes)
        };
        let failed = |fault: String| LabError::Internal(format!("writing the table failed: {fault}"));
        let written = tokio::task::spawn_blocking(write).await.map_err(|fault| failed(fault.to_string()))?;
        written.map_err(|fault| failed(fault.to_string()))
    }
}

fn columns(Table { head, rows }: Table) -> Answer<Vec<(String, TableColumn)>> {
    if head.is_empty() {
        return Err(LabError::Invalid("the table has no columns: name at least one in `head`".into()));
    }
    if let Some(row) = rows.iter().position(|row| row.len() != head.len()) {
        let (found, wanted) = (rows[row].len(), head.len());
        return Err(LabError::Invalid(format!("row {} has {found} values, expected {wanted}", row + 1)));
    }
    let mut taken = HashSet::new();
    let free = |name: String| {
        let more = (2..).map(|n| format!("{name} ({n})"));
        let free = std::iter::once(name.clone()).chain(more).find(|name| !taken.contains(name)).unwrap_or_default();
        taken.insert(free.clone());
        free
    };
    let names: Vec<String> = head.into_iter().map(free).collect();
    let column = |place: usize| rows.iter().map(move |row| row[place].as_ref());
    let typed = |place| match column(place).flatten().any(|cell| matches!(cell, Cell::Word(_))) {
        true => TableColumn::Words(column(place).map(|cell| cell.map(ToString::to_string)).collect()),
        false => TableColumn::Numbers(column(place).map(|cell| cell.and_then(Cell::number)).collect()),
    };
    Ok(names.into_iter().enumerate().map(|(place, name)| (name, typed(place))).collect())
}
