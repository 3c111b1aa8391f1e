//! The session of DataFusion: all tables and functions, made in one place.

use crate::Fault;
use crate::archive::{Archive, Content, Inventory, Selection};
use crate::gram::{gram, regressor};
use crate::table::{archive_table, runs_table};
use datafusion::prelude::{SessionConfig, SessionContext};
use std::sync::Arc;

/// The session over an archive, with the files that it reads.
pub struct Session {
    /// Tables `means`, `samples` and `runs`, functions `gram` and `regressor`.
    pub context: SessionContext,
    /// Files of the means.
    pub means: Inventory,
    /// Files of the samples.
    pub samples: Inventory,
}

/// The session over an archive. Each query uses at most `threads` threads.
///
/// # Errors
/// [`Fault::Input`] for damaged or foreign files, as [`Inventory::read`].
pub fn session(archive: &Archive, selection: &Selection, threads: usize) -> Result<Session, Fault> {
    let means = Inventory::read(archive, Content::Means, selection)?;
    let samples = Inventory::read(archive, Content::Samples, selection)?;
    let mut config = SessionConfig::new().with_target_partitions(threads);
    // The footers are read once more for statistics otherwise.
    config = config.with_collect_statistics(false);
    let context = SessionContext::new_with_config(config);
    context.register_udaf(gram());
    context.register_udf(regressor());
    for inventory in [&means, &samples] {
        context.register_table(inventory.content.name(), Arc::new(archive_table(inventory)?))?;
    }
    context.register_table("runs", runs_table([&means, &samples])?)?;
    Ok(Session { context, means, samples })
}
