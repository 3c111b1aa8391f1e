//! Channels computed from those of a run, and their spectra.

use super::{Answer, Lab, LabError};
use crate::job::{Job, PointLimit};
use crate::view::{SampleColumn, Samples, SpectrumView, finite};
use jointbench_model::channels::{ChannelFormula, spectrum};

/// Limit of curves in one plot.
const FORMULAS: usize = 4;
const POINTS: u32 = 20_000;
const TIME: &str = "time_s";

impl Lab {
    /// A channel for each formula in the window `[from_s, to_s]`.
    pub async fn derived(
        &self,
        run: i64,
        formulas: Vec<String>,
        window: [Option<f64>; 2],
        most: PointLimit,
    ) -> Answer<Samples> {
        let (PointLimit::Pixels(points) | PointLimit::Rows(points)) = most;
        if points == 0 || points > POINTS {
            return Err(LabError::Invalid(format!("{points} points: choose 1 to {POINTS}")));
        }
        if formulas.is_empty() || formulas.len() > FORMULAS {
            return Err(LabError::Invalid(format!("{} formulas: write 1 to {FORMULAS}", formulas.len())));
        }
        self.compute(Job::Derived { run, formulas, window, most }).await
    }

    pub(super) async fn derived_here(
        &self,
        run: i64,
        formulas: &[String],
        window: [Option<f64>; 2],
        most: PointLimit,
    ) -> Answer<Samples> {
        let (time_s, channels) = self.computed(run, formulas, window).await?;
        let rows = time_s.len();
        let groups = grouped(rows, most);
        let points = |values: &[f64], of: fn(&[f64]) -> f64| -> Vec<Option<f64>> {
            groups.iter().map(|group| finite(of(&values[group.clone()]))).collect()
        };
        let column = |(formula, values): &(ChannelFormula, Vec<f64>)| SampleColumn {
            name: formula.text().to_owned(),
            unit: formula.unit(),
            min: points(values, |group| group.iter().copied().fold(f64::NAN, f64::min)),
            max: points(values, |group| group.iter().copied().fold(f64::NAN, f64::max)),
        };
        Ok(Samples {
            channels: channels.iter().map(column).collect(),
            time_s: groups.iter().map(|group| time_s[group.start]).collect(),
            exact: groups.iter().all(|group| group.len() == 1),
            rows: rows as u64,
        })
    }

    pub async fn spectrum(&self, run: i64, formula: String, window: [Option<f64>; 2]) -> Answer<SpectrumView> {
        self.compute(Job::Spectrum { run, formula, window }).await
    }

    pub(super) async fn spectrum_here(
        &self,
        run: i64,
        formula: &str,
        window: [Option<f64>; 2],
    ) -> Answer<SpectrumView> {
        let (time_s, mut channels) = self.computed(run, &[formula.to_owned()], window).await?;
        let Some((formula, values)) = channels.pop() else { return Err(LabError::Internal("no channel".into())) };
        let found = spectrum(&time_s, &values).ok_or_else(|| {
            LabError::Invalid(format!(
                "run {run}: no 32 rows without a pause or a missing value in this window: choose a longer one"
            ))
        })?;
        Ok(SpectrumView {
            name: formula.text().to_owned(),
            unit: formula.unit(),
            frequency_hz: found.frequency_hz,
            amplitude: found.amplitude,
            windows: found.windows as u64,
        })
    }

    /// Every row of a window: time and result of each formula.
    async fn computed(
        &self,
        run: i64,
        formulas: &[String],
        [from_s, to_s]: [Option<f64>; 2],
    ) -> Answer<(Vec<f64>, Vec<(ChannelFormula, Vec<f64>)>)> {
        let store = &self.inner.store;
        let whole = store.trace(run, None, 0..0).await?;
        let known: Vec<&str> = whole.channels().iter().map(|channel| channel.name.as_str()).collect();
        let parsed = formulas.iter().map(|text| ChannelFormula::parse(text, &known));
        let parsed = parsed.collect::<Result<Vec<_>, _>>().map_err(|fault| LabError::Formula(Box::new(fault)))?;
        let mut names = vec![TIME.to_owned()];
        names.extend(parsed.iter().flat_map(ChannelFormula::columns).cloned());
        names.sort();
        names.dedup();
        let rows = store.rows_between(run, from_s, to_s).await?;
        let trace = store.trace(run, Some(&names), rows).await?;
        let column = |name: &str| trace.column(name).unwrap_or_default();
        let time_s = column(TIME).to_vec();
        let compute = |formula: ChannelFormula| {
            let columns: Vec<&[f64]> = formula.columns().iter().map(|name| column(name)).collect();
            let values = formula.values(&time_s, &columns);
            (formula, values)
        };
        let channels = parsed.into_iter().map(compute).collect();
        Ok((time_s, channels))
    }
}

/// The row range of each point.
fn grouped(rows: usize, most: PointLimit) -> Vec<std::ops::Range<usize>> {
    let (PointLimit::Pixels(points) | PointLimit::Rows(points)) = most;
    let points = (points as usize).min(rows);
    let begin = |point: usize| point * rows / points.max(1);
    let group = |point: usize| match most {
        PointLimit::Pixels(_) => begin(point)..begin(point + 1),
        PointLimit::Rows(_) => begin(point)..begin(point) + 1,
    };
    (0..points).map(group).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_in_one_pixel_and_rows_are_chosen_evenly() {
        let pixels = grouped(10, PointLimit::Pixels(4));
        assert_eq!(pixels, [0..2, 2..5, 5..7, 7..10]);
        let rows = grouped(10, PointLimit::Rows(4));
        assert_eq!(rows, [0..1, 2..3, 5..6, 7..8]);
        assert_eq!(grouped(3, PointLimit::Pixels(9)).len(), 3);
        assert!(grouped(0, PointLimit::Rows(9)).is_empty());
    }
}
