//! The curve of a run as a file: the table, or a picture of it with ticks where stages begin.

use serde::{Deserialize, Serialize};
use tilescope_figures::chart::{Axis, Figure, LineChart, Look, Panel, Series, figure_scene};
use tilescope_figures::{FigureError, Palette, Scene, to_png, to_svg_with_fonts};
use tilescope_session::sentence::name_in;
use tilescope_session::session::Session;
use tilescope_session::words::{capital, counted, grouped};

use super::{CurvePoints, RunCurve};

/// The columns of a picture, each about a pixel wide. Each keeps its least and its largest value, so that no peak is lost.
const COLUMNS: usize = 1_080;
/// The smallest share of the events that a stage needs to be named: in a narrower part of the picture its name has no room.
const MIN_SHARE: f64 = 0.06;
/// Pixels of a PNG for each of its points, as other figures have.
const SCALE: f64 = 2.0;

/// The formats of a curve's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CurveFormat {
    /// The curve's table: events, stage and value of each moment.
    Csv,
    /// A picture of pixels.
    Png,
    /// A picture of lines.
    Svg,
}

impl CurveFormat {
    /// Every format, the table first.
    pub const ALL: [Self; 3] = [Self::Csv, Self::Png, Self::Svg];

    /// Returns the name, as menus show it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Csv => "CSV",
            Self::Png => "PNG",
            Self::Svg => "SVG",
        }
    }

    /// Returns the extension of its files.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Png => "png",
            Self::Svg => "svg",
        }
    }
}

impl RunCurve {
    /// Returns the curve of a session as a file, a picture with `metadata`; `None` until it is made.
    ///
    /// # Errors
    ///
    /// [`FigureError`] when there is no picture, as of a number that is defined at no moment of the run.
    pub fn file(
        &self,
        session: &Session,
        format: CurveFormat,
        metadata: Vec<(String, String)>,
    ) -> Option<Result<Vec<u8>, FigureError>> {
        if format == CurveFormat::Csv {
            let (_, table) = self.csv()?;
            return Some(Ok(table.into_bytes()));
        }
        let scene = self
            .scene(session)?
            .map(|scene| Scene { metadata, ..scene });
        Some(scene.and_then(|scene| match format {
            // A table was returned above, so that the first arm makes PNG alone.
            CurveFormat::Csv | CurveFormat::Png => to_png(&scene, SCALE),
            CurveFormat::Svg => Ok(to_svg_with_fonts(&scene)?.into_bytes()),
        }))
    }

    /// Returns the picture; `None` until the curve is made.
    fn scene(&self, session: &Session) -> Option<Result<Scene, FigureError>> {
        let (_, number) = self.of?;
        let (number, points) = (number.row(), self.points()?);
        let events = points.events.last().copied().unwrap_or(0);

        let name = format!(
            "{}, r = {}, seed {}",
            counted(session.summary.count, "sample", "samples"),
            session.run().domain.radius(),
            session.run().parameters.seed
        );
        let series = lines(points).into_iter().map(|points| Series {
            name: name.clone(),
            look: Look::Alone,
            points,
            band: None,
        });
        // Even without events the axis needs a width.
        let x = Axis::new(format!("events, {} in all", grouped(events)))
            .with_range(0.0, events.max(1) as f64);

        let ticks = ticks(session);
        // A number without a unit leaves a comma behind its name, which is cut off below.
        let y_title = [number.name, number.unit].join(", ");
        let chart = LineChart {
            // The figure has the title.
            title: String::new(),
            // Without stages the axis keeps ticks at round numbers.
            x: if ticks.is_empty() {
                x
            } else {
                x.with_ticks(ticks)
            },
            y: Axis::new(y_title.trim_end_matches(", ")),
            series: series.collect(),
            levels: Vec::new(),
        };

        let figure = Figure {
            title: format!("{} over the events of a run", capital(number.name)),
            rows: vec![vec![Panel::Lines(chart)]],
        };
        Some(figure_scene(&figure, &Palette::LIGHT).map_err(FigureError::from))
    }
}

/// Returns the lines of a curve: a new one after each part where it is not defined.
fn lines(points: &CurvePoints) -> Vec<Vec<[f64; 2]>> {
    let all: Vec<[f64; 2]> = (points.events.iter())
        .zip(&points.values)
        .map(|(event, value)| [*event as f64, *value])
        .collect();
    let parts = all.split(|point| !point[1].is_finite());
    let shown = parts.filter(|part| !part.is_empty());
    let last = points.events.last().copied().unwrap_or(0);
    let line = |part| stepped(&thinned(part, last as f64));
    shown.map(line).collect()
}

/// Returns the first, the least, the largest and the last point of each column of the picture; `last` is the last event of the run.
fn thinned(line: &[[f64; 2]], last: f64) -> Vec<[f64; 2]> {
    // A run without events has `last` 0, which cannot be a divisor.
    let column = |point: &[f64; 2]| (point[0] / last.max(1.0) * COLUMNS as f64) as usize;
    let mut thin: Vec<[f64; 2]> = Vec::new();
    for points in line.chunk_by(|a, b| column(a) == column(b)) {
        let value = |index: &usize| points[*index][1];
        let by_value = |a: &usize, b: &usize| value(a).total_cmp(&value(b));
        let all = || 0..points.len();

        // The first and the last point join the line to the neighbouring columns; the least and the largest are its peaks.
        let mut kept: Vec<usize> = [
            Some(0),
            all().min_by(by_value),
            all().max_by(by_value),
            points.len().checked_sub(1),
        ]
        .into_iter()
        .flatten()
        .collect();

        // The points come in the order of the events, and each once: the first point may also be the least.
        kept.sort_unstable();
        kept.dedup();
        thin.extend(kept.into_iter().map(|index| points[index]));
    }
    thin
}

/// Returns the line of a value that holds until its next change.
fn stepped(line: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut steps = Vec::with_capacity(2 * line.len());
    for (index, point) in line.iter().enumerate() {
        let before = index.checked_sub(1).map(|before| line[before][1]);
        steps.extend(before.map(|y| [point[0], y]));
        steps.push(*point);
    }
    steps
}

/// Returns the beginnings of stages with their names, of those that have room for it. There are none where the moments
/// are prefixes, as those of nested levels and of stipples: such runs have no stages to step through.
fn ticks(session: &Session) -> Vec<(f64, String)> {
    if session.has_prefixes() {
        return Vec::new();
    }
    let ends = session.ends();
    // Without ends there are no stages to be named below.
    let least = MIN_SHARE * ends.last().map_or(0.0, |&last| last as f64);

    let mut start = 0;
    let mut ticks = Vec::new();
    for (&end, &stage) in ends.iter().zip(&session.stages) {
        if (end - start) as f64 >= least {
            ticks.push((start as f64, name_in(session, stage)));
        }
        start = end;
    }
    ticks
}

#[cfg(test)]
mod tests {
    use tilescope_core::Stage;

    use super::*;

    #[test]
    fn lines_keep_every_peak_and_end_where_the_number_does() {
        let count = 20_000;
        let mut values = vec![1.0; count];
        (values[0], values[7_777], values[7_778]) = (f64::NAN, 9.0, -3.0);
        values[15_000] = f64::NAN;
        let points = CurvePoints {
            events: (0..count).collect(),
            stages: vec![Stage::Tile; count],
            has_levels: false,
            values,
        };

        let lines = lines(&points);
        assert_eq!(lines.len(), 2, "it is not defined in the middle");
        assert!(lines[0].len() + lines[1].len() <= 8 * (COLUMNS + 2));
        assert_eq!((lines[0][0], lines[1][0]), ([1.0, 1.0], [15_001.0, 1.0]));
        for peak in [[7_777.0, 9.0], [7_778.0, -3.0]] {
            assert!(lines[0].contains(&peak), "{peak:?}");
        }
        let events = lines.concat();
        assert!(events.windows(2).all(|pair| pair[0][0] <= pair[1][0]));
        // Between two points the value is the first one's, so that a line is level or upright.
        let is_same = |a: f64, b: f64| a.total_cmp(&b).is_eq();
        let is_step = |pair: &[[f64; 2]]| (0..2).any(|axis| is_same(pair[0][axis], pair[1][axis]));
        assert!(lines.iter().all(|line| line.windows(2).all(is_step)));
    }
}
