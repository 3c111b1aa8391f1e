//! Tables for SQL: the files of the archive, united over their columns, with the facts of their footers as columns.

use crate::Fault;
use crate::archive::{ArchiveFile, Content, Inventory, Source};
use datafusion::arrow::array::{ArrayRef, RecordBatch, StringArray, UInt64Array};
use datafusion::arrow::datatypes::{DataType, Field, FieldRef, Schema, SchemaRef};
use datafusion::catalog::{Session, TableProvider};
use datafusion::common::{Result, ScalarValue};
use datafusion::datasource::listing::PartitionedFile;
use datafusion::datasource::physical_plan::{FileGroup, FileScanConfigBuilder, ParquetSource};
use datafusion::datasource::source::DataSourceExec;
use datafusion::datasource::table_schema::TableSchema;
use datafusion::datasource::{MemTable, TableType};
use datafusion::execution::object_store::ObjectStoreUrl;
use datafusion::logical_expr::Expr;
use datafusion::physical_plan::ExecutionPlan;
use datafusion::physical_plan::empty::EmptyExec;
use datafusion::physical_plan::union::UnionExec;
use std::sync::Arc;

/// A table of the archive.
#[derive(Debug)]
pub struct ArchiveTable {
    /// Columns in the files of the daemon: channels, and for means the texts of docs/archive.md.
    in_files: Vec<FieldRef>,
    /// Facts that files of `compact` contain as columns.
    per_run: Vec<FieldRef>,
    /// Facts that are the same in each file.
    per_file: Vec<FieldRef>,
    content: Content,
    files: Vec<ArchiveFile>,
}

/// Facts of a run that are columns: name, type and value.
fn facts(source: &Source, content: Content) -> Result<Vec<(&'static str, ScalarValue)>, Fault> {
    let text = |value: Option<&str>| ScalarValue::Utf8(value.map(str::to_owned));
    let meta = source.conditions().map_err(Fault::Input)?;
    let labels = match content {
        Content::Means => Vec::new(),
        Content::Samples => vec![
            ("serial", text(source.serial())),
            ("revision", text(source.revision())),
            ("procedure", text(Some(source.procedure()))),
            ("run", text(Some(source.run()))),
        ],
    };
    let own = [
        ("store", text(Some(source.store()))),
        ("state", text(Some(source.state()))),
        ("created_at", text(Some(source.created_at()))),
        ("torque_constant_nm_per_a", ScalarValue::Float64(meta.torque_constant_nm_per_a)),
        ("gear_ratio", ScalarValue::Float64(meta.gear_ratio)),
    ];
    Ok(labels.into_iter().chain(own).collect())
}

/// Facts of a run that `compact` writes as columns, with a value for each of them.
pub(crate) fn facts_of_means(source: &Source) -> Result<Vec<(&'static str, ScalarValue)>, Fault> {
    facts(source, Content::Means)
}

/// The partition of a file: the same for all of its runs.
fn partition(source: &Source) -> [(&'static str, ScalarValue); 3] {
    let text = |value: Option<&str>| ScalarValue::Utf8(value.map(str::to_owned));
    [("part", text(source.part())), ("batch", text(source.batch())), ("bench", text(Some(source.bench())))]
}

/// The table of the files of an inventory.
///
/// # Errors
/// [`Fault::Input`] if a column has different types in two files.
pub fn archive_table(inventory: &Inventory) -> Result<ArchiveTable, Fault> {
    let nameless = Source { facts: Default::default(), meta: "{}".to_owned(), rows: 0 };
    let field = |(name, value): &(&str, ScalarValue)| Arc::new(Field::new(*name, value.data_type(), true));
    let per_run: Vec<FieldRef> = facts(&nameless, inventory.content)?.iter().map(field).collect();
    let per_file: Vec<FieldRef> = partition(&nameless).iter().map(field).collect();
    let mut in_files: Vec<FieldRef> = Vec::new();
    for file in &inventory.files {
        for found in file.schema.fields() {
            match in_files.iter().find(|known| known.name() == found.name()) {
                Some(known) if known.data_type() != found.data_type() => {
                    return Err(Fault::Input(format!(
                        "{}: column {} has the type {}, in other files {}",
                        file.path.display(),
                        found.name(),
                        found.data_type(),
                        known.data_type()
                    )));
                }
                Some(_) => {}
                None if per_run.iter().any(|fact| fact.name() == found.name()) => {}
                None => in_files.push(Arc::new(Field::new(found.name(), found.data_type().clone(), true))),
            }
        }
    }
    Ok(ArchiveTable { in_files, per_run, per_file, content: inventory.content, files: inventory.files.clone() })
}

impl ArchiveTable {
    /// The files of one kind as a plan. Facts are constants of a file, or columns of it.
    fn plan(
        &self,
        files: Vec<&ArchiveFile>,
        is_compacted: bool,
        partitions: usize,
        projection: Option<&Vec<usize>>,
    ) -> Result<Arc<dyn ExecutionPlan>> {
        let (physical, constant): (Vec<FieldRef>, Vec<FieldRef>) = match is_compacted {
            true => ([&self.in_files[..], &self.per_run].concat(), self.per_file.clone()),
            false => (self.in_files.clone(), [&self.per_run[..], &self.per_file].concat()),
        };
        let schema = TableSchema::builder(Arc::new(Schema::new(physical))).with_table_partition_cols(constant).build();
        let mut groups: Vec<Vec<PartitionedFile>> = vec![Vec::new(); partitions.min(files.len())];
        let count = groups.len();
        for (at, file) in files.into_iter().enumerate() {
            let first = &file.sources[0];
            let mut values: Vec<ScalarValue> = Vec::new();
            if !is_compacted {
                let facts =
                    facts(first, self.content).map_err(|fault| datafusion::common::exec_datafusion_err!("{fault}"))?;
                values.extend(facts.into_iter().map(|(_, value)| value));
            }
            values.extend(partition(first).into_iter().map(|(_, value)| value));
            let mut scanned = PartitionedFile::new(file.path.display().to_string(), file.bytes);
            scanned.partition_values = values;
            groups[at % count].push(scanned);
        }
        let source = Arc::new(ParquetSource::new(schema));
        let config = FileScanConfigBuilder::new(ObjectStoreUrl::local_filesystem(), source)
            .with_file_groups(groups.into_iter().map(FileGroup::new).collect())
            .with_projection_indices(projection.cloned())?
            .build();
        Ok(DataSourceExec::from_data_source(config))
    }
}

#[async_trait::async_trait]
impl TableProvider for ArchiveTable {
    fn schema(&self) -> SchemaRef {
        Arc::new(Schema::new([&self.in_files[..], &self.per_run, &self.per_file].concat()))
    }

    fn table_type(&self) -> TableType {
        TableType::Base
    }

    async fn scan(
        &self,
        state: &dyn Session,
        projection: Option<&Vec<usize>>,
        _filters: &[Expr],
        _limit: Option<usize>,
    ) -> Result<Arc<dyn ExecutionPlan>> {
        let partitions = state.config().target_partitions();
        let mut plans = Vec::new();
        for is_compacted in [false, true] {
            let files: Vec<&ArchiveFile> = self.files.iter().filter(|f| f.is_compacted == is_compacted).collect();
            if !files.is_empty() {
                plans.push(self.plan(files, is_compacted, partitions, projection)?);
            }
        }
        match plans.len() {
            0 => {
                let schema = self.schema();
                let projected = projection.map_or(Ok(schema.clone()), |p| schema.project(p).map(Arc::new))?;
                Ok(Arc::new(EmptyExec::new(projected)))
            }
            1 => Ok(plans.remove(0)),
            _ => UnionExec::try_new(plans),
        }
    }
}

/// One row for each run and table of the archive, from the footers.
///
/// # Errors
/// Never for an inventory.
pub fn runs_table<'i>(inventories: impl IntoIterator<Item = &'i Inventory>) -> Result<Arc<MemTable>, Fault> {
    type Text = fn(&Source) -> Option<&str>;
    const TEXTS: [(&str, Text); 11] = [
        ("part", Source::part),
        ("batch", Source::batch),
        ("bench", |source| Some(source.bench())),
        ("serial", Source::serial),
        ("revision", Source::revision),
        ("procedure", |source| Some(source.procedure())),
        ("state", |source| Some(source.state())),
        ("created_at", |source| Some(source.created_at())),
        ("store", |source| Some(source.store())),
        ("run", |source| Some(source.run())),
        ("sha256", |source| Some(source.sha256())),
    ];
    let all: Vec<(&Inventory, &ArchiveFile, &Source)> = inventories
        .into_iter()
        .flat_map(|i| i.files.iter().flat_map(move |file| file.sources.iter().map(move |source| (i, file, source))))
        .collect();
    let texts = |values: Vec<Option<String>>| Arc::new(StringArray::from(values)) as ArrayRef;
    let mut columns = vec![texts(all.iter().map(|(i, ..)| Some(i.content.name().to_owned())).collect())];
    let mut fields = vec![Field::new("content", DataType::Utf8, false)];
    for (name, text) in TEXTS {
        fields.push(Field::new(name, DataType::Utf8, true));
        columns.push(texts(all.iter().map(|(_, _, source)| text(source).map(str::to_owned)).collect()));
    }
    fields.push(Field::new("rows", DataType::UInt64, false));
    columns.push(Arc::new(all.iter().map(|(_, _, source)| source.rows as u64).collect::<UInt64Array>()));
    fields.push(Field::new("file", DataType::Utf8, false));
    columns.push(texts(all.iter().map(|(_, file, _)| Some(file.path.display().to_string())).collect()));
    let schema = Arc::new(Schema::new(fields));
    let batch = RecordBatch::try_new(schema.clone(), columns).map_err(|fault| Fault::Failed(fault.to_string()))?;
    Ok(Arc::new(MemTable::try_new(schema, vec![vec![batch]])?))
}
