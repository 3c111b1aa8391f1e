//! The one service layer.
mod error;
use crate::view::*;
pub use error::LabError;
use jointbench_procedure::Control;
use serde::Deserialize;
use serde_json::{Map, Value};
use utoipa::ToSchema;

type R<T> = Result<T, LabError>;
fn no<T>() -> R<T> {
    Err(LabError::Internal("not wired".into()))
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum FileFormat {
    Csv,
    Parquet,
}
impl FileFormat {
    pub fn extension(self) -> &'static str {
        match self {
            FileFormat::Csv => "csv",
            FileFormat::Parquet => "parquet",
        }
    }
    pub fn media_type(self) -> &'static str {
        match self {
            FileFormat::Csv => "text/csv; charset=utf-8",
            FileFormat::Parquet => "application/vnd.apache.parquet",
        }
    }
}
#[derive(Debug, Clone, Default)]
pub struct ImportRequest {
    pub name: Option<String>,
    pub file_name: String,
    pub bytes: Vec<u8>,
    pub meta: Option<String>,
    pub map: Vec<String>,
    pub scale: Vec<String>,
}

#[derive(Clone)]
pub struct Lab;
impl Lab {
    pub fn benches(&self) -> Vec<Bench> {
        vec![]
    }
    pub fn bench(&self, _: &str) -> R<Bench> {
        no()
    }
    pub async fn emergency_stop(&self, _: &str) -> R<Bench> {
        no()
    }
    pub async fn acknowledge(&self, _: &str, _: &str) -> R<Bench> {
        no()
    }
    pub fn procedures(&self) -> Vec<Procedure> {
        vec![]
    }
    pub fn preview(&self, _: &str, _: &str, _: &Map<String, Value>) -> R<Preview> {
        no()
    }
    pub async fn runs(&self, _: u32, _: u32, _: Option<&str>) -> R<RunList> {
        no()
    }
    pub async fn start_run(&self, _: &str, _: &str, _: &Map<String, Value>) -> R<Run> {
        no()
    }
    pub async fn run(&self, _: i64) -> R<Run> {
        no()
    }
    pub async fn control(&self, _: i64, _: Control) -> R<Run> {
        no()
    }
    pub async fn events(&self, _: i64, _: Option<u64>) -> R<Vec<RunEvent>> {
        no()
    }
    pub async fn samples(&self, _: i64, _: Option<&[String]>, _: Option<f64>, _: Option<f64>, _: u32) -> R<Samples> {
        no()
    }
    pub async fn export(&self, _: i64, _: FileFormat) -> R<Vec<u8>> {
        no()
    }
    pub async fn import(&self, _: ImportRequest) -> R<Run> {
        no()
    }
    pub fn effects(&self, _: Option<&str>) -> R<Vec<Effect>> {
        no()
    }
    pub async fn create_model(&self, _: i64, _: &[String], _: Option<i64>) -> R<Model> {
        no()
    }
    pub async fn models(&self, _: i64) -> R<Vec<Model>> {
        no()
    }
    pub async fn model(&self, _: i64) -> R<Model> {
        no()
    }
    pub async fn residuals(&self, _: i64) -> R<ResidualSet> {
        no()
    }
    pub async fn diagnose(&self, _: i64) -> R<Diagnosis> {
        no()
    }
    pub async fn diagnosis(&self, _: i64) -> R<Diagnosis> {
        no()
    }
    pub async fn diagnoses(&self, _: i64) -> R<Vec<Diagnosis>> {
        no()
    }
}
