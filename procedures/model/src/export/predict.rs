//! Prediction of a fit for given signals instead of a recording.

use crate::ModelError;
use crate::prediction::predict_on;
use crate::report::fit::Fit;
use crate::signal::Signals;
use crate::user_effects::signals_with;
use crate::view::View;

/// Signals of equal length by their formula names, one value for each moment.
pub type Moments<'m> = [(&'m str, Vec<f64>)];

/// The prediction at every moment. For hysteresis the first moment is the start, and `sample_s` [s] is the time step.
pub fn predict(fit: &Fit, moments: &Moments, sample_s: f64) -> Result<Vec<f64>, ModelError> {
    let rows = moments.first().map_or(0, |(_, values)| values.len());
    let mut given = Signals::new(rows);
    let signals = signals_with(fit.kind, &fit.user_effects);
    for (name, values) in moments {
        let Some(signal) = signals.iter().find(|s| s.name == *name) else {
            let known: Vec<&str> = signals.iter().map(|s| s.name).collect();
            return Err(ModelError::BadSignal {
                signal: (*name).to_owned(),
                why: format!("signals of {} models are {}", fit.kind, known.join(", ")),
            });
        };
        if values.len() != rows {
            let why = format!("{} values, but the first signal has {rows}", values.len());
            return Err(ModelError::BadSignal { signal: (*name).to_owned(), why });
        }
        given.set(signal.signal, values.clone());
    }
    let view = View::new(given.clone(), given, Vec::new(), vec![0], sample_s);
    predict_on(fit, &view, rows, |column| column)
}
