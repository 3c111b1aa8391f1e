//! Report of a run: one page, and an appendix.

use super::blocking::blocking;
use super::{Answer, Lab, LabError};
use crate::job::Job;
use crate::report::{Report, ResidualMap};
use crate::store::Subject;
use crate::view::{Diagnosis, Figure, FigureAxis, FigureForm, FigureSeries, Mark, Model, Region, reread};
use jointbench_model::{AxisMap, Fit, Options, ResidualMaps, maps, words};

/// `positive` or `negative` in a [`Region`] and on the axis `direction`.
const NEGATIVE: &str = "negative";

impl Lab {
    /// Result of the procedure, a model version and its diagnosis. The default `model` is the last version that is
    /// neither idle nor only tried. `short`: only the first page.
    pub async fn report(&self, id: i64, model: Option<i64>, short: bool) -> Answer<String> {
        let run = self.run(id).await?;
        let identification = match self.identification(id).await {
            Ok(found) => Some(found),
            Err(LabError::NotFound(_) | LabError::Invalid(_)) => None,
            Err(error) => return Err(error),
        };
        let journal = self.events(id, None).await?;
        let notes = journal.into_iter().filter(|event| event.kind == "note").map(|event| event.text).collect();
        let versions = lineage(self.models(id).await?, model);
        if let (Some(model), true) = (model, versions.is_empty()) {
            return Err(LabError::NotFound(format!("run {id} has no model {model}")));
        }
        let diagnosis = match versions.last() {
            Some(shown) => self.diagnoses(shown.id).await?.pop(),
            None => None,
        };
        let residual_map = self.residual_map(&versions).await?;
        let effects = self.effects(Some(&run.summary.kind)).await?;
        let effects = effects.into_iter().map(|effect| (effect.id.clone(), effect)).collect();
        let report = Report { run, notes, identification, versions, diagnosis, residual_map, effects, short };
        tokio::task::spawn_blocking(move || report.html())
            .await
            .map_err(|fault| LabError::Internal(format!("the report of run {id} failed: {fault}")))
    }

    /// The residual of the first and the last version over the axis with the largest region of the first diagnosis.
    async fn residual_map(&self, versions: &[Model]) -> Answer<Option<ResidualMap>> {
        let [first, ..] = versions else { return Ok(None) };
        let last = versions.last().filter(|last| last.id != first.id);
        let mut region = None;
        for version in std::iter::once(first).chain(last) {
            let known = self.diagnoses(version.id).await?.pop();
            region = region.or(known.and_then(|Diagnosis { finding, .. }| finding.regions.into_iter().next()));
        }
        let shown: Vec<i64> = std::iter::once(first).chain(last).map(|version| version.id).collect();
        let over = region.as_ref().map_or("any", |region| &region.axis);
        let way = region.as_ref().and_then(|region| region.direction.as_deref()).unwrap_or("both");
        let (subject, what) = (Subject::Model(last.unwrap_or(first).id), format!("map {} {over} {way}", first.id));
        if let Some(map) = self.cached(subject, &what).await? {
            return Ok(Some(map));
        }
        let map: ResidualMap = match self.compute(Job::ResidualMap { models: shown, region }).await {
            Ok(map) => map,
            Err(LabError::Gone(why)) => return Ok(Some(ResidualMap { figure: None, why_not: Some(why) })),
            Err(fault) => return Err(fault),
        };
        self.cache(subject, &what, &map).await?;
        Ok(Some(map))
    }

    pub(super) async fn residual_map_here(&self, models: &[i64], region: Option<Region>) -> Answer<ResidualMap> {
        let mut drawn = Vec::new();
        for id in models {
            let record = self.inner.store.model(*id).await?;
            let (fit, table) = (reread::<_, Fit>(&record.fit)?, self.fitted_table(&record).await?);
            match blocking(move || Ok(maps(&table, &fit, &Options::default()))).await? {
                Ok(maps) => drawn.push((*id, maps)),
                Err(fault) => return Ok(ResidualMap { figure: None, why_not: Some(fault.to_string()) }),
            }
        }
        let figure = drawn_map(&drawn, region.as_ref());
        let why_not = figure.is_none().then(|| "no bin has three independent blocks".to_owned());
        Ok(ResidualMap { figure, why_not })
    }
}

/// The maps of all versions over one axis. Without a region it is the axis over which the first residual has most
/// structure.
fn drawn_map(drawn: &[(i64, ResidualMaps)], region: Option<&Region>) -> Option<Figure> {
    let (_, first) = drawn.first()?;
    let largest = || first.axes.iter().max_by(|a, b| a.removable_share.total_cmp(&b.removable_share));
    let named = region.and_then(|region| first.axes.iter().find(|axis| axis.axis == region.axis));
    let axis = named.or_else(largest)?;
    let direction = region.filter(|_| named.is_some()).and_then(|region| region.direction.as_deref());
    let curves: Vec<(i64, Vec<[f64; 3]>)> =
        drawn.iter().map(|(id, maps)| (*id, curve(maps, &axis.axis, direction))).collect();
    let series: Vec<FigureSeries> = curves
        .iter()
        .enumerate()
        .filter(|(_, (_, points))| !points.is_empty())
        .map(|(place, (id, points))| FigureSeries {
            label: format!("{} (model {id})", if place == 0 { "before" } else { "after" }),
            group: None,
            role: None,
            mark: Mark::Points,
            x: points.iter().map(|[x, ..]| *x).collect(),
            y: points.iter().map(|[_, mean, _]| *mean).collect(),
            band: points.iter().map(|[_, mean, half]| [mean - half, mean + half]).collect(),
        })
        .collect();
    let over = words::spoken(&axis.axis);
    let way = direction.map(|way| format!(", {way} direction")).unwrap_or_default();
    let figure_axis = |label: &str, unit: &str| FigureAxis {
        label: label.to_owned(),
        unit: if unit == "1" { String::new() } else { unit.to_owned() },
        names: Vec::new(),
    };
    (!series.is_empty()).then(|| Figure {
        name: "residual_map".to_owned(),
        title: format!("Residual map over {over}{way}"),
        form: FigureForm::Cartesian,
        x: figure_axis(&over, &axis.unit),
        y: figure_axis("mean residual", &first.unit),
        series,
    })
}

/// Place, mean and half width of each bin with a band.
fn curve(maps: &ResidualMaps, axis: &str, direction: Option<&str>) -> Vec<[f64; 3]> {
    let Some(map) = maps.axes.iter().find(|map| map.axis == axis) else { return Vec::new() };
    let whole =
        |map: &AxisMap| map.bins.iter().filter_map(|bin| Some([bin.centre, bin.mean, bin.half_width?])).collect();
    let Some((way, pair)) = direction.zip(maps.in_each_direction(map)) else { return whole(map) };
    let is_meant = |range: &[f64; 2]| (range[0] + range[1] < 0.0) == (way == NEGATIVE);
    let cells = pair.cells.iter().filter(|cell| pair.y_bins.get(cell.y).is_some_and(is_meant));
    cells
        .filter_map(|cell| Some((pair.x_bins.get(cell.x)?, cell)))
        .filter_map(|([from, to], cell)| Some([(from + to) / 2.0, cell.mean, cell.half_width?]))
        .collect()
}

/// A version and its ancestors, the oldest first. The default is the last version that is neither idle nor only tried.
fn lineage(mut versions: Vec<Model>, model: Option<i64>) -> Vec<Model> {
    let last =
        versions.iter().rposition(|version| model.map_or(!version.idle && !version.tried, |id| version.id == id));
    let mut line: Vec<Model> = last.map(|place| versions.remove(place)).into_iter().collect();
    while let Some(parent) = line.last().and_then(|version| version.parent) {
        let Some(place) = versions.iter().position(|version| version.id == parent) else { break };
        line.push(versions.swap_remove(place));
    }
    line.reverse();
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointbench_model::{MapBin, MapCell, PairMap, ResidualKind};

    fn bin(centre: f64, mean: f64, half_width: Option<f64>) -> MapBin {
        MapBin { from: centre - 0.5, to: centre + 0.5, centre, mean, half_width, rows: 30 }
    }

    /// A residual of this size over speed and load, and over speed in each direction.
    fn residual(size: f64) -> ResidualMaps {
        let bins = vec![bin(1.0, size, Some(1e-4)), bin(2.0, -size, Some(1e-4)), bin(3.0, 9.0, None)];
        let axis = |axis: &str, removable_share: f64| AxisMap {
            axis: axis.to_owned(),
            unit: "rad/s".to_owned(),
            bins: bins.clone(),
            removable_share,
        };
        let cell = |y: usize, mean: f64| MapCell { x: 0, y, mean, half_width: Some(1e-4), rows: 30 };
        let pair = PairMap {
            x: "motor_velocity_rad_s".to_owned(),
            x_unit: "rad/s".to_owned(),
            y: "direction".to_owned(),
            y_unit: "1".to_owned(),
            x_bins: vec![[0.5, 1.5]],
            y_bins: vec![[-1.0, -1.0], [1.0, 1.0]],
            cells: vec![cell(0, -size), cell(1, 3.0 * size)],
            removable_share: 0.5,
        };
        ResidualMaps {
            residual: ResidualKind::PlateauMean,
            unit: "Nm".to_owned(),
            axes: vec![axis("motor_velocity_rad_s", 0.1), axis("link_position_rad", 0.7)],
            pairs: vec![pair],
            regions: Vec::new(),
        }
    }

    fn region(axis: &str, direction: Option<&str>) -> Region {
        Region {
            axis: axis.to_owned(),
            from: 0.0,
            to: 1.0,
            mean_residual: 1e-3,
            ci95: [5e-4, 2e-3],
            samples: 30,
            direction: direction.map(str::to_owned),
            sentence: String::new(),
        }
    }

    #[test]
    fn the_map_shows_both_versions_over_the_axis_of_the_region() {
        let drawn = [(1, residual(8e-3)), (2, residual(1e-3))];
        let figure = drawn_map(&drawn, Some(&region("motor_velocity_rad_s", None))).unwrap();
        assert_eq!((figure.title.as_str(), figure.y.unit.as_str()), ("Residual map over motor velocity", "Nm"));
        let labels: Vec<&str> = figure.series.iter().map(|one| one.label.as_str()).collect();
        assert_eq!(labels, ["before (model 1)", "after (model 2)"]);
        assert_eq!(figure.series[0].x, [1.0, 2.0], "a bin without a band is omitted");
        let [low, high] = figure.series[0].band[0];
        assert!((low - 7.9e-3).abs() < 1e-12 && (high - 8.1e-3).abs() < 1e-12, "{low} {high}");
    }

    #[test]
    fn a_region_of_one_direction_gets_the_map_of_that_direction() {
        let drawn = [(1, residual(8e-3))];
        let means = |way| {
            let figure = drawn_map(&drawn, Some(&region("motor_velocity_rad_s", Some(way)))).unwrap();
            assert!(figure.title.ends_with(&format!("{way} direction")), "{}", figure.title);
            figure.series[0].y.clone()
        };
        assert_eq!((means("negative"), means("positive")), (vec![-8e-3], vec![24e-3]));
    }

    #[test]
    fn without_a_region_the_axis_with_most_structure_is_shown() {
        for region in [None, Some(region("temperature_c", Some("positive")))] {
            let figure = drawn_map(&[(1, residual(8e-3))], region.as_ref()).unwrap();
            assert_eq!(figure.title, "Residual map over link position");
        }
    }
}
