//! Compares a run, also an active one, with the last model of its bench: does the model still explain the run?

use super::blocking::blocking;
use super::{Answer, Lab};
use crate::job::Job;
use crate::view::{Figure, FigureAxis, FigureForm, FigureSeries, Mark, ModelOverlay, reread};
use jointbench_model::{Fit, Options, ResidualSet, residuals};

/// A plot cannot show more points.
const MOST_POINTS: usize = 1000;
/// For noise without structure, 5 % of the points are outside of this band.
const BAND_SIGMA: f64 = 2.0;

impl Lab {
    /// `None` if the bench has no model of this kind from another run.
    pub async fn model_overlay(&self, id: i64) -> Answer<Option<ModelOverlay>> {
        self.compute(Job::OverlayModel { run: id }).await
    }

    pub(super) async fn model_overlay_here(&self, id: i64) -> Answer<Option<ModelOverlay>> {
        let record = self.inner.store.run(id).await?;
        let Some(model) = self.inner.store.last_model(&record.bench, &record.kind, id).await? else {
            return Ok(None);
        };
        let fit: Fit = reread(&model.fit)?;
        let noise_rms = model.noise_floor_rms.unwrap_or(model.validation_rms);
        let table = self.measurement(id).await?;
        let left = blocking(move || Ok(residuals(&table, &fit, &Options::default()))).await?;
        let mut overlay = ModelOverlay {
            model: model.id,
            model_run: model.run,
            noise_rms,
            has_noise_floor: model.noise_floor_rms.is_some(),
            points: 0,
            outside: None,
            why_not: None,
            figures: Vec::new(),
        };
        match left {
            Ok(left) => show(&mut overlay, &left),
            Err(fault) => overlay.why_not = Some(fault.to_string()),
        }
        Ok(Some(overlay))
    }
}

/// Uses only the points that the model is expected to explain.
fn show(overlay: &mut ModelOverlay, left: &ResidualSet) {
    let judged: Vec<usize> = (0..left.error.len()).filter(|i| !left.held_out[*i]).collect();
    let band = BAND_SIGMA * overlay.noise_rms;
    let outside = judged.iter().filter(|i| left.error[**i].abs() > band).count();
    overlay.points = judged.len();
    overlay.outside = (!judged.is_empty()).then(|| outside as f64 / judged.len() as f64);
    let Some(time) = left.axes.iter().find(|axis| axis.name == "time_s") else { return };
    let shown: Vec<usize> = judged.iter().copied().step_by(judged.len().div_ceil(MOST_POINTS).max(1)).collect();
    let of = |values: &[f64]| -> Vec<f64> { shown.iter().map(|i| values[*i]).collect() };
    let points = |label: &str, values: &[f64]| FigureSeries {
        label: label.to_owned(),
        group: None,
        role: None,
        mark: Mark::Points,
        x: of(&time.values),
        y: of(values),
        band: Vec::new(),
    };
    let ends = [shown.first(), shown.last()].map(|i| i.map_or(0.0, |i| time.values[*i]));
    let noise = FigureSeries {
        label: format!("±{BAND_SIGMA} σ of the noise"),
        group: None,
        role: None,
        mark: Mark::Line,
        x: ends.to_vec(),
        y: vec![0.0; 2],
        band: vec![[-band, band]; 2],
    };
    let name = format!("model {}", overlay.model);
    let figure = |id: &str, title: String, series| Figure {
        name: id.to_owned(),
        title,
        form: FigureForm::Cartesian,
        x: axis("time", "s"),
        y: axis(id, &left.unit),
        series,
    };
    overlay.figures = vec![
        figure(
            "response",
            format!("Measured and {name}"),
            vec![points("measured", &left.measured), points(&name, &left.predicted)],
        ),
        figure("residual", format!("Residual of {name}"), vec![points("measured − model", &left.error), noise]),
    ];
}

fn axis(label: &str, unit: &str) -> FigureAxis {
    FigureAxis { label: label.to_owned(), unit: unit.to_owned(), names: Vec::new() }
}
