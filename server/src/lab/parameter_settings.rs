//! Settings of the parameters of a new model version.

use super::{Answer, Lab};
use crate::view::{ParameterSetting, reread};
use jointbench_model::Fit;

impl Lab {
    /// The given settings, otherwise those of the parent for the effects that remain.
    pub(super) async fn settings(
        &self,
        parent: Option<i64>,
        effects: &[String],
        given: Option<Vec<ParameterSetting>>,
    ) -> Answer<Vec<ParameterSetting>> {
        let (None, Some(parent)) = (&given, parent) else { return Ok(given.unwrap_or_default()) };
        let before: Fit = reread(&self.inner.store.model(parent).await?.fit)?;
        Ok(before.settings.into_iter().filter(|setting| effects.contains(&setting.effect)).collect())
    }
}
