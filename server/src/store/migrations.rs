//! The migrations of the schema. An applied migration is never edited.

use sqlx::SqlSafeStr;
use sqlx::error::BoxDynError;
use sqlx::migrate::{Migration, MigrationSource, MigrationType};
use std::future::{self, Future};
use std::pin::Pin;

/// Name and text of every file in `migrations/`, in order. The list is manual because the macro compiles SQLite twice.
const FILES: &[(&str, &str)] = &[
    ("0001_runs.sql", include_str!("../../../migrations/0001_runs.sql")),
    ("0002_models.sql", include_str!("../../../migrations/0002_models.sql")),
    ("0003_safety.sql", include_str!("../../../migrations/0003_safety.sql")),
    ("0004_own_effects.sql", include_str!("../../../migrations/0004_own_effects.sql")),
    ("0005_experiments.sql", include_str!("../../../migrations/0005_experiments.sql")),
    ("0006_notes.sql", include_str!("../../../migrations/0006_notes.sql")),
    ("0007_kept.sql", include_str!("../../../migrations/0007_kept.sql")),
    ("0008_excluded.sql", include_str!("../../../migrations/0008_excluded.sql")),
    ("0009_stopped.sql", include_str!("../../../migrations/0009_stopped.sql")),
    ("0010_kept_of_runs.sql", include_str!("../../../migrations/0010_kept_of_runs.sql")),
    ("0011_tokens.sql", include_str!("../../../migrations/0011_tokens.sql")),
    ("0012_who.sql", include_str!("../../../migrations/0012_who.sql")),
    ("0013_calibrations.sql", include_str!("../../../migrations/0013_calibrations.sql")),
    ("0014_faults.sql", include_str!("../../../migrations/0014_faults.sql")),
    ("0015_idle_models.sql", include_str!("../../../migrations/0015_idle_models.sql")),
    ("0016_tried_models.sql", include_str!("../../../migrations/0016_tried_models.sql")),
    ("0017_verdicts.sql", include_str!("../../../migrations/0017_verdicts.sql")),
    ("0018_commits.sql", include_str!("../../../migrations/0018_commits.sql")),
    ("0019_checksums.sql", include_str!("../../../migrations/0019_checksums.sql")),
    ("0020_store_log.sql", include_str!("../../../migrations/0020_store_log.sql")),
    ("0021_warnings.sql", include_str!("../../../migrations/0021_warnings.sql")),
    ("0022_units.sql", include_str!("../../../migrations/0022_units.sql")),
    ("0023_effect_uses.sql", include_str!("../../../migrations/0023_effect_uses.sql")),
    ("0024_limit_outcomes.sql", include_str!("../../../migrations/0024_limit_outcomes.sql")),
    ("0025_queue.sql", include_str!("../../../migrations/0025_queue.sql")),
    ("0026_notifications.sql", include_str!("../../../migrations/0026_notifications.sql")),
    ("0027_run_quantities.sql", include_str!("../../../migrations/0027_run_quantities.sql")),
    ("0028_archive.sql", include_str!("../../../migrations/0028_archive.sql")),
    ("0029_unit_references.sql", include_str!("../../../migrations/0029_unit_references.sql")),
];

/// Number of the newest migration.
pub const NEWEST: i64 = FILES.len() as i64;

#[derive(Debug)]
pub struct Migrations;

impl<'s> MigrationSource<'s> for Migrations {
    fn resolve(self) -> Pin<Box<dyn Future<Output = Result<Vec<Migration>, BoxDynError>> + Send + 's>> {
        let step = |(version, (name, text)): (i64, &(&'static str, &'static str))| {
            let description = name.trim_end_matches(".sql").split_once('_').map_or(*name, |(_, words)| words);
            Migration::new(
                version,
                description.replace('_', " ").into(),
                MigrationType::Simple,
                text.into_sql_str(),
                false,
            )
        };
        Box::pin(future::ready(Ok((1..).zip(FILES).map(step).collect())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_listed_under_its_number() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../migrations");
        let mut there: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(|name| name.ends_with(".sql"))
            .collect();
        there.sort();
        assert!(there.iter().eq(FILES.iter().map(|(name, _)| name)), "{there:?}");
        for (number, name) in (1..).zip(&there) {
            assert!(name.starts_with(&format!("{number:04}_")), "{name} is number {number}");
        }
    }
}
