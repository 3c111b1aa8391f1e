//! A figure of a result as SVG.

use super::number::scale;
use crate::view::{Figure, FigureForm, FigureSeries, Mark};
use jointbench_model::words;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;

/// Okabe and Ito, as in the dashboard (`tokens.css`): distinguishable with every kind of colour vision, and in print by
/// their dashes.
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 128, 92),
    RGBColor(176, 87, 138),
    RGBColor(184, 116, 0),
    RGBColor(45, 142, 196),
    RGBColor(20, 25, 29),
];
/// Length and gap of the dashes [px].
const DASHES: [(i32, i32); 4] = [(0, 0), (8, 4), (3, 3), (12, 3)];
/// Width of a series sample in the legend [px].
const SAMPLE: i32 = 30;
const FONT: &str = "sans-serif";
const WHOLE: (u32, u32) = (760, 400);
/// Two of them stand side by side, with labels that remain legible in print.
const SMALL: (u32, u32) = (480, 320);

type Drawn<T = ()> = Result<T, DrawingAreaErrorKind<std::io::Error>>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Plane<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// `None` if the figure has no points.
pub fn svg(figure: &Figure) -> Option<String> {
    drawn(figure, WHOLE)
}

/// The same in half of the width.
pub fn small_svg(figure: &Figure) -> Option<String> {
    drawn(figure, SMALL)
}

fn drawn(figure: &Figure, (width, height): (u32, u32)) -> Option<String> {
    let mut text = String::new();
    let figure = &prefixed(figure);
    let polar = figure.form == FigureForm::Polar;
    let turned: Vec<FigureSeries>;
    let series = if polar {
        let lowest = figure.series.iter().flat_map(|s| &s.y).fold(0.0_f64, |low, y| low.min(*y));
        turned = figure.series.iter().map(|series| around(series, lowest)).collect();
        &turned
    } else {
        &figure.series
    };
    let (x, y) = (range(series.iter().flat_map(|s| s.x.iter().copied()))?, y_range(series)?);
    {
        let size = if polar { (height + 80, height) } else { (width, height) };
        let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
        let drawn = match polar {
            true => {
                let reach = [x.0, x.1, y.0, y.1].into_iter().map(f64::abs).fold(0.0, f64::max);
                draw(&area, figure, series, ((-reach, reach), (-reach, reach)))
            }
            false => draw(&area, figure, series, (widened(x, figure), y)),
        };
        drawn.and_then(|()| area.present()).ok()?;
    }
    Some(text)
}

/// The figure in the prefixed units of its largest values. The angle of a polar figure keeps its unit.
fn prefixed(figure: &Figure) -> Figure {
    let largest = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).fold(0.0, f64::max);
    let width = largest(&mut figure.series.iter().flat_map(|s| s.x.iter().copied()));
    let height = largest(&mut figure.series.iter().flat_map(reach));
    let is_scaled = figure.form == FigureForm::Cartesian && figure.x.names.is_empty();
    let x = if is_scaled { scale(width, &figure.x.unit) } else { (1.0, figure.x.unit.clone()) };
    let y = scale(height, &figure.y.unit);
    let mut figure = figure.clone();
    for series in &mut figure.series {
        series.x.iter_mut().for_each(|value| *value *= x.0);
        series.y.iter_mut().chain(series.band.iter_mut().flatten()).for_each(|value| *value *= y.0);
    }
    (figure.x.unit, figure.y.unit) = (x.1, y.1);
    figure
}

/// Values of a series along y, with their bands.
fn reach(series: &FigureSeries) -> impl Iterator<Item = f64> {
    series.y.iter().copied().chain(series.band.iter().flatten().copied())
}

/// Converts angle and radius to Cartesian coordinates. The centre is at twice the lowest radius, so that negative
/// values remain visible.
fn around(series: &FigureSeries, lowest: f64) -> FigureSeries {
    let radii = series.y.iter().map(|radius| radius - 2.0 * lowest);
    let place = |of: fn(f64) -> f64| series.x.iter().zip(radii.clone()).map(|(angle, r)| r * of(*angle)).collect();
    FigureSeries { x: place(f64::cos), y: place(f64::sin), band: Vec::new(), ..series.clone() }
}

fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    (low <= high).then_some((low, high))
}

fn y_range(series: &[FigureSeries]) -> Option<(f64, f64)> {
    let bars = series.iter().any(|s| s.mark == Mark::Bars).then_some(0.0);
    let values = series.iter().flat_map(reach).chain(bars);
    let (low, high) = range(values)?;
    let air = match high - low {
        0.0 => 0.5 * high.abs().max(1.0),
        span => 0.05 * span,
    };
    Some((low - air, high + air))
}

fn widened((low, high): (f64, f64), figure: &Figure) -> (f64, f64) {
    match figure.x.names.len() {
        0 if low == high => (low - 0.5, high + 0.5),
        0 => {
            let bars = figure.series.iter().filter(|s| s.mark == Mark::Bars).map(|s| 0.5 * slot(s));
            let air = bars.fold(0.0, f64::max);
            (low - air, high + air)
        }
        count => (-0.5, count as f64 - 0.5),
    }
}

/// The smallest distance between two bars of a series.
fn slot(series: &FigureSeries) -> f64 {
    let steps = series.x.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 0.0);
    Some(steps.fold(f64::INFINITY, f64::min)).filter(|step| step.is_finite()).unwrap_or(1.0)
}

fn draw(area: &Area, figure: &Figure, series: &[FigureSeries], (x, y): ((f64, f64), (f64, f64))) -> Drawn {
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(area)
        .margin(8)
        .x_label_area_size(44)
        .y_label_area_size(78)
        .build_cartesian_2d(x.0..x.1, y.0..y.1)?;
    let names = &figure.x.names;
    let name = |at: &f64| match names.is_empty() {
        true => number(*at, x.1 - x.0),
        false if (at - at.round()).abs() < 1e-6 => names.get(at.round() as usize).cloned().unwrap_or_default(),
        false => String::new(),
    };
    let height = |at: &f64| number(*at, y.1 - y.0);
    let mut mesh = chart.configure_mesh();
    mesh.light_line_style(TRANSPARENT)
        .x_labels(if names.is_empty() { 8 } else { 2 * names.len() + 1 })
        .x_label_formatter(&name)
        .y_label_formatter(&height)
        .label_style((FONT, 13))
        .axis_desc_style((FONT, 14));
    match figure.form {
        FigureForm::Cartesian => {
            mesh.x_desc(labelled(&figure.x)).y_desc(labelled(&figure.y)).draw()?;
        }
        FigureForm::Polar => {
            // Cartesian coordinates are no radii, so only the ring at radius 0 is labelled.
            mesh.x_desc(format!("{}, ring: 0", labelled(&figure.y))).x_labels(0).y_labels(0).draw()?;
            let zero = 2.0 * figure.series.iter().flat_map(|s| &s.y).fold(0.0_f64, |low, y| low.min(*y)).abs();
            let ring = (0..=180).map(|step| f64::from(step) * std::f64::consts::PI / 90.0);
            chart.draw_series(LineSeries::new(ring.map(|a| (zero * a.cos(), zero * a.sin())), BLACK.mix(0.4)))?;
        }
    }
    let bars = series.iter().filter(|s| s.mark == Mark::Bars).count();
    let mut bar = 0;
    for (i, one) in series.iter().enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        match one.mark {
            Mark::Line => line(&mut chart, one, colour, DASHES[i % DASHES.len()])?,
            Mark::Points => points(&mut chart, one, colour)?,
            Mark::Bars => {
                columns(&mut chart, one, colour, (bar, bars))?;
                bar += 1;
            }
        }
    }
    if series.len() > 1 {
        chart
            .configure_series_labels()
            .legend_area_size(SAMPLE + 6)
            .label_font((FONT, 13))
            .background_style(WHITE.mix(0.8))
            .border_style(BLACK.mix(0.3))
            .draw()?;
    }
    Ok(())
}

fn labelled(axis: &crate::view::FigureAxis) -> String {
    if axis.unit.is_empty() { axis.label.clone() } else { format!("{} [{}]", axis.label, axis.unit) }
}

/// A tick label of an axis with this span; negligible values are shown as 0.
fn number(value: f64, span: f64) -> String {
    let size = value.abs();
    if size < 1e-9 * span {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&size) {
        let text = format!("{value:.4}");
        words::with_minus(text.trim_end_matches('0').trim_end_matches('.'))
    } else {
        words::scientific(value, 1)
    }
}

fn line(chart: &mut Plane, series: &FigureSeries, colour: RGBColor, (dash, gap): (i32, i32)) -> Drawn {
    if series.band.len() == series.x.len() {
        let low = series.x.iter().zip(&series.band).map(|(x, band)| (*x, band[0]));
        let high = series.x.iter().zip(&series.band).map(|(x, band)| (*x, band[1]));
        let edge: Vec<(f64, f64)> = low.chain(high.rev()).collect();
        chart.draw_series(std::iter::once(Polygon::new(edge, colour.mix(0.15))))?;
    }
    let places = series.x.iter().copied().zip(series.y.iter().copied());
    let style = colour.stroke_width(2);
    let drawn = match gap {
        0 => chart.draw_series(LineSeries::new(places, style))?,
        _ => chart.draw_series(DashedLineSeries::new(places, dash, gap, style))?,
    };
    let (dash, gap) = if gap == 0 { (SAMPLE, 1) } else { (dash, gap) };
    let sample = move |(x, y)| DashedPathElement::new([(x, y), (x + SAMPLE, y)], dash, gap, style);
    drawn.label(&series.label).legend(sample);
    Ok(())
}

fn points(chart: &mut Plane, series: &FigureSeries, colour: RGBColor) -> Drawn {
    if series.band.len() == series.x.len() {
        let bars = series.x.iter().zip(&series.y).zip(&series.band);
        chart.draw_series(bars.map(|((x, y), band)| ErrorBar::new_vertical(*x, band[0], *y, band[1], colour, 6)))?;
    }
    let places = series.x.iter().zip(&series.y);
    chart
        .draw_series(places.map(|(x, y)| Circle::new((*x, *y), 3, colour.filled())))?
        .label(&series.label)
        .legend(move |(x, y)| Circle::new((x + SAMPLE / 2, y), 3, colour.filled()));
    Ok(())
}

/// Bars; several series are drawn next to each other.
fn columns(chart: &mut Plane, series: &FigureSeries, colour: RGBColor, (place, count): (usize, usize)) -> Drawn {
    let slot = slot(series);
    let wide = 0.8 * slot / count as f64;
    let left = move |x: f64| x - 0.4 * slot + wide * place as f64;
    let bars = series.x.iter().zip(&series.y);
    chart
        .draw_series(
            bars.map(|(x, y)| Rectangle::new([(left(*x), 0.0), (left(*x) + wide, *y)], colour.mix(0.8).filled())),
        )?
        .label(&series.label)
        .legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + SAMPLE, y + 5)], colour.mix(0.8).filled()));
    if series.band.len() == series.x.len() {
        let ends = series.x.iter().zip(&series.y).zip(&series.band);
        let middle = |x: f64| left(x) + wide / 2.0;
        chart.draw_series(
            ends.map(|((x, y), band)| ErrorBar::new_vertical(middle(*x), band[0], *y, band[1], BLACK, 6)),
        )?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::FigureAxis;

    fn figure(form: FigureForm, mark: Mark, names: &[&str]) -> Figure {
        let axis = |label: &str, unit: &str, names: &[&str]| FigureAxis {
            label: label.to_owned(),
            unit: unit.to_owned(),
            names: names.iter().map(|name| (*name).to_owned()).collect(),
        };
        let series = |label: &str, lift: f64| FigureSeries {
            label: label.to_owned(),
            group: None,
            role: None,
            mark,
            x: vec![0.0, 1.0, 2.0],
            y: vec![1.0 + lift, 2.0 + lift, 1.5 + lift],
            band: vec![[0.9, 1.4], [1.8, 2.5], [1.2, 1.9]],
        };
        Figure {
            name: "friction".to_owned(),
            title: "Friction".to_owned(),
            form,
            x: axis("velocity", "rad/s", names),
            y: axis("torque", "Nm", &[]),
            series: vec![series("there & back", 0.0), series("model", 0.1)],
        }
    }

    #[test]
    fn every_form_is_drawn_with_its_labels() {
        for (form, mark, names) in [
            (FigureForm::Cartesian, Mark::Line, &[][..]),
            (FigureForm::Cartesian, Mark::Points, &[]),
            (FigureForm::Cartesian, Mark::Bars, &["none", "Coulomb", "full"]),
            (FigureForm::Polar, Mark::Line, &[]),
        ] {
            let text = svg(&figure(form, mark, names)).unwrap();
            assert!(text.starts_with("<svg") && text.contains("torque [Nm]"), "{text}");
            assert!(text.contains("there &amp; back") && !text.contains("NaN"));
            assert!(names.iter().all(|name| text.contains(name)), "{text}");
        }
    }

    #[test]
    fn axes_have_prefixes_and_minus_signs() {
        let mut small = figure(FigureForm::Cartesian, Mark::Points, &[]);
        for series in &mut small.series {
            series.y.iter_mut().chain(series.band.iter_mut().flatten()).for_each(|y| *y *= -0.01);
        }
        let text = svg(&small).unwrap();
        assert!(text.contains("torque [mNm]") && text.contains("velocity [rad/s]"), "{text}");
        assert!(text.contains("\n−20\n") && !text.contains("\n-"), "{text}");
    }

    #[test]
    fn bars_are_as_wide_as_they_lie_apart() {
        let mut histogram = figure(FigureForm::Cartesian, Mark::Bars, &[]);
        histogram.series.iter_mut().for_each(|one| one.x.iter_mut().for_each(|x| *x *= 1e-4));
        let text = svg(&histogram).unwrap();
        let width = |rect: &str| rect.split("width=\"").nth(1)?.split('"').next()?.parse::<f64>().ok();
        let bars: Vec<f64> = text.split("<rect").skip(1).filter_map(width).filter(|wide| *wide < 700.0).collect();
        assert!(bars.len() >= 6 && bars.iter().all(|wide| *wide < 130.0), "{bars:?}");
    }

    #[test]
    fn a_figure_without_points_is_none() {
        let mut empty = figure(FigureForm::Cartesian, Mark::Line, &[]);
        empty.series.clear();
        assert_eq!(svg(&empty), None);
    }
}
