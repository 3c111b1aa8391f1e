//! Compares runs with a first run: a channel over an alignment axis, and its differences from the first run.

use super::statistics::ROWS_AT_ONCE;
use super::{Answer, Lab, LabError};
use crate::job::{Alignment, Job};
use crate::view::{Figure, FigureAxis, FigureForm, FigureSeries, Mark, RunEvent};
use jointbench_instrument::Channel;
use jointbench_model::words::spoken;

/// Bins along the axis.
const PLACES: usize = 60;
/// Two runs are compared at this number of moments in each bin of time.
const MOMENTS: usize = 8;
const AT_MOST: usize = 6;
const TIME: &str = "time_s";
const VELOCITY: &str = "motor_velocity_rad_s";
const LOAD: &str = "link_torque_nm";
/// Only data at similar load is compared: the range of all loads is divided into this number of bins.
const LOADS: usize = 8;
/// Below this share of the maximum speed, the direction is undefined.
const AT_REST: f64 = 0.01;

impl Lab {
    /// The channel over the alignment axis (unless that is time), and the differences from the first run with two
    /// standard errors. The standard errors follow from the scatter of passes at the same place and load.
    pub async fn compare_runs(&self, runs: &[i64], how: &Alignment) -> Answer<Vec<Figure>> {
        if !(2..=AT_MOST).contains(&runs.len()) {
            return Err(LabError::Invalid(format!("{} runs: choose 2 to {AT_MOST}", runs.len())));
        }
        self.compute(Job::CompareRuns { runs: runs.to_vec(), how: how.clone() }).await
    }

    pub(super) async fn compare_runs_here(&self, runs: &[i64], how: &Alignment) -> Answer<Vec<Figure>> {
        let (mut zeros, mut moment) = (Vec::new(), None);
        for run in runs {
            let event = self.zero(*run, how).await?;
            zeros.push(event.as_ref().map_or(0.0, |event| event.at_s));
            moment = moment.or(event.map(|event| event.text));
        }
        // The figures name the event by its text.
        let how = &Alignment { from: moment, ..how.clone() };
        let spans = self.spans(runs, &how.by).await?;
        let spans: Vec<[f64; 2]> = spans.iter().zip(&zeros).map(|(span, zero)| span.map(|end| end - zero)).collect();
        if how.by == TIME {
            return self.over_time(runs, how, &zeros, &spans).await;
        }
        let low = spans.iter().map(|span| span[0]).fold(f64::INFINITY, f64::min);
        let high = spans.iter().map(|span| span[1]).fold(f64::NEG_INFINITY, f64::max);
        if !(high - low).is_finite() || high <= low {
            return Err(LabError::Invalid(format!("{} does not change in these runs", spoken(&how.by))));
        }
        let axis = Axis { low, step: (high - low) / PLACES as f64, places: PLACES };
        let loads = self.loads(runs, how).await?;
        let mut courses = Vec::new();
        for (run, zero) in runs.iter().zip(zeros) {
            courses.push(self.course(*run, how, [&axis, &loads], zero).await?);
        }
        let (shown, apart) = over_places(runs, &axis, &courses);
        Ok(figures(runs[0], how, &courses[0].unit, shown, apart))
    }

    /// Compares each run with the first over their common time, so that a short run does not limit the others.
    async fn over_time(&self, runs: &[i64], how: &Alignment, zeros: &[f64], spans: &[[f64; 2]]) -> Answer<Vec<Figure>> {
        let (mut apart, mut unit) = (Vec::new(), String::new());
        for other in 1..runs.len() {
            let low = spans[0][0].max(spans[other][0]);
            let high = spans[0][1].min(spans[other][1]);
            let mut rows = (PLACES * 2 * MOMENTS) as u64;
            for i in [0, other] {
                let both = self.inner.store.rows_between(runs[i], Some(low + zeros[i]), Some(high + zeros[i])).await?;
                rows = rows.min(both.end - both.start);
            }
            // Each moment needs two rows; otherwise there is no value.
            let places = (rows as usize / 2 / MOMENTS).max(1) * MOMENTS;
            let axis = Axis { low, step: (high - low) / places as f64, places };
            let base = self.course(runs[0], how, [&axis, &Axis::ANY], zeros[0]).await?;
            let course = self.course(runs[other], how, [&axis, &Axis::ANY], zeros[other]).await?;
            let points = (0..places / MOMENTS).filter_map(|place| apart_at(&axis, [&base, &course], place)).collect();
            apart.push(series(format!("#{} − #{}", runs[other], runs[0]), runs[other], points));
            unit = base.unit;
        }
        Ok(figures(runs[0], how, &unit, Vec::new(), apart))
    }

    /// The event at the zero of a run's time. `None`: the time begins with the run.
    async fn zero(&self, run: i64, how: &Alignment) -> Answer<Option<RunEvent>> {
        let Some(from) = how.from.as_deref().filter(|_| how.by == TIME) else { return Ok(None) };
        let events = self.events(run, None).await?;
        let event = events.into_iter().find(|event| event.key == from || event.text == from);
        event.map(Some).ok_or_else(|| LabError::Invalid(format!("run {run} has no event “{from}”")))
    }

    /// Smallest and largest value of a channel in each run.
    async fn spans(&self, runs: &[i64], channel: &str) -> Answer<Vec<[f64; 2]>> {
        let mut spans = Vec::new();
        for run in runs {
            let whole = self.inner.store.window(*run, Some(&[channel.to_owned()]), None, None, 1).await?;
            let column = whole.columns.first();
            let low = column.map_or(f64::NAN, |column| column.min.iter().copied().fold(f64::NAN, f64::min));
            let high = column.map_or(f64::NAN, |column| column.max.iter().copied().fold(f64::NAN, f64::max));
            spans.push([low, high]);
        }
        Ok(spans)
    }

    /// Load bins, if all runs have similar loads and the load is neither the channel nor the axis.
    async fn loads(&self, runs: &[i64], how: &Alignment) -> Answer<Axis> {
        let spans = match [how.channel.as_str(), how.by.as_str()].contains(&LOAD) {
            true => Vec::new(),
            false => self.spans(runs, LOAD).await.unwrap_or_default(),
        };
        let low = spans.iter().map(|span| span[0]).fold(f64::INFINITY, f64::min);
        let high = spans.iter().map(|span| span[1]).fold(f64::NEG_INFINITY, f64::max);
        let alike = low < high && spans.iter().all(|span| span[1] - span[0] > (high - low) / 2.0);
        Ok(if alike { Axis { low, step: (high - low) / LOADS as f64, places: LOADS } } else { Axis::ANY })
    }

    async fn course(&self, run: i64, how: &Alignment, [axis, loads]: [&Axis; 2], zero: f64) -> Answer<Course> {
        let store = &self.inner.store;
        let mut names = vec![how.channel.clone(), how.by.clone()];
        if loads.places > 1 {
            names.push(LOAD.to_owned());
        }
        let known = store.trace(run, None, 0..0).await?;
        let moves = how.by != TIME && known.channels().iter().any(|c| c.name == VELOCITY);
        let turns = moves && how.by != VELOCITY;
        let mut rest = 0.0;
        if moves {
            if turns {
                names.push(VELOCITY.to_owned());
            }
            let [low, high] = self.spans(&[run], VELOCITY).await?[0];
            rest = AT_REST * low.abs().max(high.abs());
        }
        let [from_s, to_s] = [axis.low, axis.low + axis.step * axis.places as f64].map(|end| Some(end + zero));
        let rows = match how.by == TIME {
            true => store.rows_between(run, from_s, to_s).await?,
            false => store.rows_between(run, None, None).await?,
        };
        let mut walk = Walk::new(axis.places, loads);
        let mut unit = None;
        for first in rows.clone().step_by(ROWS_AT_ONCE as usize) {
            let trace = store.trace(run, Some(&names), first..(first + ROWS_AT_ONCE).min(rows.end)).await?;
            let column = |name: &str| trace.column(name).unwrap_or_default();
            let (values, along, velocity) = (column(&how.channel), column(&how.by), column(VELOCITY));
            let load = column(LOAD);
            unit = trace.channels().iter().find(|c| c.name == how.channel).and_then(Channel::unit).map(str::to_owned);
            for (i, (value, at)) in values.iter().zip(along).enumerate() {
                let way = match velocity.get(i).filter(|_| moves) {
                    Some(speed) if speed.abs() <= rest => None,
                    Some(speed) => Some(usize::from(turns && *speed < 0.0)),
                    None => Some(0),
                };
                let place = way.zip(axis.place(at - zero)).filter(|_| value.is_finite());
                let load = load.get(i).copied().unwrap_or_default();
                walk.step(place.map(|(way, place)| way * axis.places + place), *value, load);
            }
        }
        Ok(Course { tallies: walk.end(), unit: unit.unwrap_or_default(), turns })
    }
}

struct Axis {
    low: f64,
    step: f64,
    places: usize,
}

impl Axis {
    /// One bin for all values.
    const ANY: Axis = Axis { low: f64::MIN, step: f64::INFINITY, places: 1 };

    fn place(&self, at: f64) -> Option<usize> {
        let place = (at - self.low) / self.step;
        // The largest value belongs to the last bin.
        (place >= 0.0 && place <= self.places as f64).then(|| (place as usize).min(self.places - 1))
    }

    /// Centre of a bin that is `wide` bins of this axis.
    fn centre(&self, place: usize, wide: usize) -> f64 {
        self.low + (place as f64 + 0.5) * wide as f64 * self.step
    }
}

/// Values of a run for each place (forwards, then backwards) and load. They are means of passes, weighted by their
/// rows, because consecutive samples are not independent.
struct Course {
    tallies: Vec<[Tally; LOADS]>,
    unit: String,
    turns: bool,
}

impl Course {
    /// Mean over all loads.
    fn at(&self, place: usize) -> Option<Tally> {
        let mut all = Tally::default();
        self.loads(place).for_each(|(_, tally)| all.take(tally.mean, tally.weight));
        Some(all).filter(|tally| tally.n > 0)
    }

    /// The values at a place, by load.
    fn loads(&self, place: usize) -> impl Iterator<Item = (usize, Tally)> {
        self.tallies[place].into_iter().enumerate().filter(|(_, tally)| tally.n > 0)
    }

    /// Mean difference to another run at equal loads, and its variance; `scatters` are the variances per row.
    fn apart(&self, other: &Course, place: usize, scatters: [f64; 2]) -> Option<(f64, f64)> {
        let (mut all, mut variance) = (Tally::default(), 0.0);
        for (load, a) in self.loads(place) {
            let b = other.tallies[place][load];
            if b.n > 0 {
                let weight = 1.0 / (1.0 / a.weight + 1.0 / b.weight);
                all.take(b.mean - a.mean, weight);
                variance += weight.powi(2) * (scatters[0] / a.weight + scatters[1] / b.weight);
            }
        }
        (all.n > 0).then(|| (all.mean, variance / all.weight.powi(2)))
    }
}

/// A weighted mean and the sum of squares about it.
#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    n: usize,
    weight: f64,
    mean: f64,
    squares: f64,
}

impl Tally {
    fn take(&mut self, value: f64, weight: f64) {
        self.n += 1;
        self.weight += weight;
        let off = value - self.mean;
        self.mean += off * weight / self.weight;
        self.squares += weight * off * (value - self.mean);
    }
}

/// Consecutive rows: rows at the same place form one pass.
struct Walk<'a> {
    loads: &'a Axis,
    tallies: Vec<[Tally; LOADS]>,
    place: Option<usize>,
    stretch: Tally,
    load: Tally,
}

impl<'a> Walk<'a> {
    fn new(places: usize, loads: &'a Axis) -> Self {
        let tallies = vec![[Tally::default(); LOADS]; 2 * places];
        Self { loads, tallies, place: None, stretch: Tally::default(), load: Tally::default() }
    }

    fn step(&mut self, place: Option<usize>, value: f64, load: f64) {
        if place != self.place {
            self.close();
            self.place = place;
        }
        self.stretch.take(value, 1.0);
        self.load.take(load, 1.0);
    }

    fn close(&mut self) {
        if let Some((place, load)) = self.place.zip(self.loads.place(self.load.mean)) {
            self.tallies[place][load].take(self.stretch.mean, self.stretch.weight);
        }
        (self.stretch, self.load) = (Tally::default(), Tally::default());
    }

    fn end(mut self) -> Vec<[Tally; LOADS]> {
        self.close();
        self.tallies
    }
}

/// Variance of the passes about the mean at their place and load, times their rows. It is pooled over all places,
/// because most places have few passes.
fn scatter(course: &Course) -> Option<f64> {
    let tallies = || course.tallies.iter().flatten();
    let more = tallies().map(|tally| tally.n.saturating_sub(1) as f64).sum::<f64>();
    (more > 0.0).then(|| tallies().map(|tally| tally.squares).sum::<f64>() / more)
}

/// Place, value and, if known, two standard errors.
type Points = Vec<(f64, f64, Option<f64>)>;

/// Means of all runs and their differences from the first, for each place and direction.
fn over_places(runs: &[i64], axis: &Axis, courses: &[Course]) -> (Vec<FigureSeries>, Vec<FigureSeries>) {
    let ways: &[&str] = if courses.iter().any(|course| course.turns) { &[", forwards", ", backwards"] } else { &[""] };
    let (mut shown, mut apart) = (Vec::new(), Vec::new());
    let scatters: Vec<Option<f64>> = courses.iter().map(scatter).collect();
    for (way, name) in ways.iter().enumerate() {
        let at = |course: usize, place: usize| courses[course].at(way * axis.places + place);
        for (i, run) in runs.iter().enumerate() {
            let mean = |place| {
                let tally = at(i, place)?;
                Some((axis.centre(place, 1), tally.mean, scatters[i].map(|s| 2.0 * (s / tally.weight).sqrt())))
            };
            shown.push(series(format!("#{run}{name}"), *run, (0..axis.places).filter_map(mean).collect()));
            if i == 0 {
                continue;
            }
            let difference = |place| {
                let known = scatters[0].zip(scatters[i]);
                let (a, b) = known.unwrap_or_default();
                let (apart, variance) = courses[0].apart(&courses[i], way * axis.places + place, [a, b])?;
                Some((axis.centre(place, 1), apart, known.map(|_| 2.0 * variance.sqrt())))
            };
            let points = (0..axis.places).filter_map(difference).collect();
            apart.push(series(format!("#{run} − #{}{name}", runs[0]), *run, points));
        }
    }
    (shown, apart)
}

/// Difference at a place from the differences at its moments.
fn apart_at(axis: &Axis, [base, other]: [&Course; 2], place: usize) -> Option<(f64, f64, Option<f64>)> {
    let mut tally = Tally::default();
    for moment in place * MOMENTS..(place + 1) * MOMENTS {
        tally.take(other.at(moment)?.mean - base.at(moment)?.mean, 1.0);
    }
    let error = 2.0 * (tally.squares / (MOMENTS * (MOMENTS - 1)) as f64).sqrt();
    Some((axis.centre(place, MOMENTS), tally.mean, Some(error)))
}

fn figures(base: i64, how: &Alignment, unit: &str, shown: Vec<FigureSeries>, apart: Vec<FigureSeries>) -> Vec<Figure> {
    let figure = |name: &str, title: String, series: Vec<FigureSeries>| Figure {
        name: name.to_owned(),
        title,
        form: FigureForm::Cartesian,
        x: axis_of(&how.from.as_ref().map_or(spoken(&how.by), |from| format!("time since “{from}”")), &how.by),
        y: FigureAxis { label: spoken(&how.channel), unit: unit.to_owned(), names: Vec::new() },
        series,
    };
    let mean = figure("mean", format!("Mean {}, ± 2 σ", spoken(&how.channel)), shown);
    let difference = figure("difference", format!("Difference from #{base}, ± 2 σ"), apart);
    let both = [mean, difference].into_iter();
    both.filter(|figure| figure.series.iter().any(|series| !series.x.is_empty())).collect()
}

fn axis_of(label: &str, column: &str) -> FigureAxis {
    let unit = Channel::new(column).unit().unwrap_or_default().to_owned();
    FigureAxis { label: label.to_owned(), unit, names: Vec::new() }
}

/// The series of a run in the group `#run`.
fn series(label: String, run: i64, points: Points) -> FigureSeries {
    let band = points.iter().filter_map(|(_, y, error)| error.map(|error| [y - error, y + error])).collect();
    let (x, y) = points.into_iter().map(|(x, y, _)| (x, y)).unzip();
    FigureSeries { label, group: Some(format!("#{run}")), role: None, mark: Mark::Line, x, y, band }
}
