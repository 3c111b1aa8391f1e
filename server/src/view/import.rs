//! Preview of a file before its import.

use jointbench_files as files;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What a file holds, before its import. Nothing of it is stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ImportPreview {
    /// As the facts say, or as the columns look: `friction`, `encoder`, `stiffness` or `brake`.
    pub kind: String,
    pub rows: usize,
    pub columns: Vec<ImportColumn>,
    /// Columns that say themselves what they are, and likely sources of the others.
    pub proposals: Vec<ImportProposal>,
    /// What was skipped, assumed or noticed.
    pub notes: Vec<ImportNote>,
    /// Columns that no model can use.
    pub left: Vec<String>,
    /// Why the file is not imported with these choices.
    pub refused: Option<ImportRefusal>,
}

/// A column as it stands in the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ImportColumn {
    pub name: String,
    /// As its name or a line of units states it.
    pub unit: Option<String>,
    /// Its first cells.
    pub first: Vec<String>,
    pub is_words: bool,
    /// Cells without a value.
    pub missing: usize,
}

/// A column of the run table, and where it seems to be in the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ImportProposal {
    pub column: String,
    /// Name in the file.
    pub from: String,
    pub unit: Option<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ImportNote {
    pub said: String,
    /// What changes it, as it is written on the command line.
    pub option: Option<String>,
    /// The same in parts; absent for an instruction in words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub proposed: Option<ProposedImport>,
}

/// Options that a user may add to an import.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ProposedImport {
    /// As it is written on the command line.
    pub text: String,
    pub parts: Vec<ImportOption>,
    /// The parts can be applied as they are. Otherwise a value is a placeholder.
    pub is_complete: bool,
}

/// One part of an import request.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ImportOption {
    /// Such as `unit`.
    pub name: String,
    /// Such as `time_s=ms`; `true` for an option without a value.
    pub value: String,
}

impl ProposedImport {
    /// `None` for an instruction in words.
    fn of(option: files::ProposedOption) -> Option<Self> {
        let part = |part: files::OptionPart| ImportOption { name: part.name, value: part.value };
        let parts: Vec<ImportOption> = option.parts.into_iter().map(part).collect();
        (!parts.is_empty()).then_some(Self { text: option.text, parts, is_complete: option.is_complete })
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ImportRefusal {
    pub said: String,
    /// Line of a text, row of a columnar file.
    pub line: Option<u64>,
    pub column: Option<String>,
    /// The first of the rows that are no samples.
    #[serde(default)]
    #[schema(required = true)]
    pub rows: Vec<ImportWrongRow>,
    /// Number of all rows that are no samples.
    #[serde(default)]
    #[schema(required = true)]
    pub row_count: usize,
    /// Remedy, as an option of the command line.
    pub options: Vec<String>,
    /// The same in parts, without instructions in words.
    #[serde(default)]
    #[schema(required = true)]
    pub proposed: Vec<ProposedImport>,
}

/// A row that is no sample, and its first fault.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ImportWrongRow {
    /// Line of a text, row of a columnar file: a value for `omit_rows`.
    pub line: u64,
    pub column: Option<String>,
    pub message: String,
}

impl From<files::Preview> for ImportPreview {
    fn from(preview: files::Preview) -> Self {
        let column = |one: files::PreviewColumn| ImportColumn {
            name: one.name,
            unit: one.unit,
            first: one.first,
            is_words: one.is_words,
            missing: one.missing,
        };
        let proposal = |one: files::Proposal| ImportProposal { column: one.column, from: one.from, unit: one.unit };
        let note = |one: files::Note| ImportNote {
            said: one.message,
            option: one.option.as_ref().map(|option| option.text.clone()),
            proposed: one.option.and_then(ProposedImport::of),
        };
        let row = |one: files::WrongRow| ImportWrongRow { line: one.line, column: one.column, message: one.message };
        ImportPreview {
            kind: preview.kind.to_string(),
            rows: preview.rows,
            columns: preview.columns.into_iter().map(column).collect(),
            proposals: preview.proposals.into_iter().map(proposal).collect(),
            notes: preview.notes.into_iter().map(note).collect(),
            left: preview.left,
            refused: preview.refused.map(|one| ImportRefusal {
                said: one.message,
                line: one.line,
                column: one.column,
                rows: one.rows.into_iter().map(row).collect(),
                row_count: one.row_count,
                options: one.options.iter().map(|option| option.text.clone()).collect(),
                proposed: one.options.into_iter().filter_map(ProposedImport::of).collect(),
            }),
        }
    }
}
