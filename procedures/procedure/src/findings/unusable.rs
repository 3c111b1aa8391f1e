//! Verdict on a run that cannot be used.

use crate::identification::Identification;
use jointbench_instrument::TableFault;
use jointbench_model::{ModelError, words};

/// Why a run is not usable, with advice.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Unusable {
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error(transparent)]
    Table(#[from] TableFault),
    /// Missing data and advice, each as a sentence.
    #[error("{0} {1}")]
    InsufficientData(&'static str, &'static str),
    #[error("{} {SCATTERED}", scattered(*.rest_nm))]
    Scattered { rest_nm: f64 },
}

const SCATTERED: &str = "To find the missing effect, open the run in the workbench or diagnose its export \
    (jointbench export RUN, jointbench diagnose run-RUN.csv), or add repeats.";

fn scattered(rest_nm: f64) -> String {
    let rest = words::figure(rest_nm, "Nm");
    format!("{rest} RMS of the torque is unexplained by speed, too much to determine friction.")
}

impl Unusable {
    /// Missing data and advice, each as a sentence.
    fn sentences(&self) -> [String; 2] {
        match self {
            Self::InsufficientData(lacking, cure) => [lacking, cure].map(|sentence| (*sentence).to_owned()),
            Self::Scattered { rest_nm } => [scattered(*rest_nm), SCATTERED.to_owned()],
            // The message contains what to do about the run.
            Self::Model(_) | Self::Table(_) => [sentence(&self.to_string()), "Repeat the run.".to_owned()],
        }
    }
}

fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map(|first| format!("{}{}.", first.to_uppercase(), letters.as_str())).unwrap_or_default()
}

/// An unusable run gets a verdict too.
pub(crate) fn verdict(found: Result<Identification, Unusable>) -> Option<Identification> {
    let failed = |fault: Unusable| {
        let [lacking, cure] = fault.sentences();
        Identification::failed(lacking, cure)
    };
    Some(found.unwrap_or_else(failed))
}
