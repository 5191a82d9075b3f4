//! Charts of curves, grids of values and bars, and square pictures, as a scene: data in, shapes out.
//!
//! Axes have round ticks; a series has a colour, a dash pattern and a mark of its own, so that curves differ by
//! more than their colours. Values are drawn as given: a logarithmic axis has logarithms as values, and ticks of its own.

mod bars;
mod blank;
mod frame;
mod image;
mod layout;
mod lines;
mod ticks;
mod tiles;

pub use bars::{Bar, BarChart, BarGroup};
pub use layout::{figure_scene, panel_around, panel_groups};
pub use tiles::{ColorScale, TileChart, TileContent};

use crate::error::FigureError;

/// Colour, dash pattern and mark of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// One of a cycle of 60 combinations, by its number.
    Numbered(usize),
    /// The only one of its chart: solid, without marks, which would hop from frame to frame of an animation.
    Alone,
    /// What others are held against: dashed, in the colour of text, without marks.
    Reference,
}

/// A curve through places in their sequence, with or without a confidence band.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Its name in the legend; series of one name in several charts should have one look.
    pub name: String,
    /// How it looks; series of one figure need looks of their own.
    pub look: Look,
    /// Places `[x, y]` in the sequence in which they are joined.
    pub points: Vec<[f64; 2]>,
    /// Lower and upper end of a confidence band at each place, or none.
    pub band: Option<Vec<[f64; 2]>>,
}

/// A horizontal line with a name, such as an expected value.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// The name that is written at the line.
    pub name: String,
    /// Its ordinate, in units of the vertical axis.
    pub y: f64,
}

/// An axis of a chart: what it measures, from where to where, and its ticks.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The quantity and its unit.
    pub label: String,
    /// The ends; none takes those of the data.
    pub range: Option<[f64; 2]>,
    /// Values that have a tick, each with its label; none takes round values.
    pub ticks: Option<Vec<(f64, String)>>,
}

impl Axis {
    /// An axis that reaches as far as its data.
    #[must_use]
    pub fn new(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            range: None,
            ticks: None,
        }
    }

    /// The same axis from `low` to `high`; anything beyond is cut off.
    #[must_use]
    pub fn with_range(self, low: f64, high: f64) -> Self {
        Self {
            range: Some([low, high]),
            ..self
        }
    }

    /// The same axis with ticks at these values, each with its label; those beyond its range are left out. So an axis
    /// of logarithms can be labelled with the numbers themselves.
    #[must_use]
    pub fn with_ticks(self, ticks: Vec<(f64, String)>) -> Self {
        Self {
            ticks: Some(ticks),
            ..self
        }
    }
}

/// Curves over one pair of axes.
#[derive(Clone, Debug, PartialEq)]
pub struct LineChart {
    /// Heading above the plot.
    pub title: String,
    /// The horizontal axis, which rises to the right.
    pub x: Axis,
    /// The vertical axis, which rises upwards.
    pub y: Axis,
    /// The curves, the first painted first.
    pub series: Vec<Series>,
    /// Named horizontal lines, below the curves.
    pub levels: Vec<Level>,
}

/// Values on a grid, as shades of grey: white at the lower end, black at the upper. A unit is as long along both axes.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageChart {
    /// Heading above the plot.
    pub title: String,
    /// The horizontal axis; its range, which must be given, spans the grid's columns.
    pub x: Axis,
    /// The vertical axis, upwards; its range, which must be given, spans the grid's rows.
    pub y: Axis,
    /// How many columns the grid has; the values fill its rows.
    pub columns: usize,
    /// Rows of equal ordinate, the lowest first.
    pub values: Vec<f64>,
    /// Values at and beyond which a cell is white or black.
    pub clamp: [f64; 2],
    /// Index of a cell without a value: it is ringed, and its value is not read.
    pub absent: Option<usize>,
}

/// The frame of a chart that has nothing to show.
#[derive(Clone, Debug, PartialEq)]
pub struct BlankChart {
    /// Heading above the plot.
    pub title: String,
    /// The horizontal axis; its range must be given.
    pub x: Axis,
    /// The vertical axis; its range must be given.
    pub y: Axis,
    /// Columns and rows of the image that would be there; none where curves would be.
    pub cells: Option<[usize; 2]>,
    /// The reason why there is nothing, written in the middle.
    pub why: String,
}

/// A part of a figure.
#[derive(Clone, Debug, PartialEq)]
pub enum Panel {
    /// Curves over one pair of axes.
    Lines(LineChart),
    /// Shades of grey for a grid of values.
    Image(ImageChart),
    /// A frame without content.
    Blank(BlankChart),
    /// Bars; the only panel of its row.
    Bars(BarChart),
    /// A square picture with words about it.
    Tile(TileChart),
    /// A scale of colours, which takes no room in its row.
    Scale(ColorScale),
}

/// Panels under a common title and legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Title of the whole figure, above its legend.
    pub title: String,
    /// Rows of panels, which share the width evenly.
    pub rows: Vec<Vec<Panel>>,
}

/// Why there is no figure.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ChartError {
    /// A figure, a row of it or a chart has nothing to show.
    #[error("\"{0}\" has nothing to show")]
    Empty(String),
    /// A series has no place.
    #[error("the series \"{series}\" of \"{chart}\" is empty")]
    EmptySeries {
        /// Title of the chart.
        chart: String,
        /// Name of the series.
        series: String,
    },
    /// Panels stand in one row that cannot: bars are alone, and tiles are among themselves.
    #[error("\"{0}\" has bars or tiles beside other panels")]
    Mixed(String),
    /// A number is NaN or infinite.
    #[error("value {index} of \"{series}\" in \"{chart}\" is {value}, which is not finite")]
    NotFinite {
        /// Title of the chart.
        chart: String,
        /// Name of the series, or what else the value belongs to.
        series: String,
        /// Index of the value in its series.
        index: usize,
        /// The value that is not finite.
        value: f64,
    },
    /// A band has not one pair of ends for each place.
    #[error("the band of \"{series}\" has {found} places, the series {expected}")]
    Band {
        /// Name of the series.
        series: String,
        /// Places of the band.
        found: usize,
        /// Places of the series.
        expected: usize,
    },
    /// A range of an axis or of shades does not rise, or an axis that needs one has none.
    #[error("the range of \"{0}\" is missing or does not rise")]
    Range(String),
    /// The values of an image do not fill its rows, or are too many.
    #[error(
        "the image \"{chart}\" has {values} values in {columns} columns; they must fill 1 to {MAX_CELLS} rows, and \
         columns be as many at most"
    )]
    Grid {
        /// Title of the image.
        chart: String,
        /// How many values there are.
        values: usize,
        /// How many of them are a row.
        columns: usize,
    },
}

impl From<ChartError> for FigureError {
    fn from(error: ChartError) -> Self {
        Self::Chart(error.to_string())
    }
}

/// Columns and rows of an image at most: more than pixels would not be seen.
pub const MAX_CELLS: usize = 1024;

impl LineChart {
    /// Refuses a chart without series, and one whose numbers cannot be drawn.
    fn check(&self) -> Result<(), ChartError> {
        if self.series.is_empty() {
            return Err(ChartError::Empty(self.title.clone()));
        }

        for series in &self.series {
            self.check_series(series)?;
        }

        self.check_finite("levels", self.levels.iter().map(|level| level.y))?;
        for axis in [&self.x, &self.y] {
            // An axis without a range reaches as far as the data, which are finite.
            if axis.range.is_some() {
                axis.checked_range()?;
            }
            axis.check_ticks(&self.title)?;
        }

        Ok(())
    }

    /// Refuses a series without places, with numbers that are not finite, or with a band of another length.
    fn check_series(&self, series: &Series) -> Result<(), ChartError> {
        if series.points.is_empty() {
            return Err(ChartError::EmptySeries {
                chart: self.title.clone(),
                series: series.name.clone(),
            });
        }

        for axis in [0, 1] {
            self.check_finite(&series.name, series.points.iter().map(|point| point[axis]))?;
        }

        let Some(band) = &series.band else {
            return Ok(());
        };

        // A band has two ends at each place of its curve.
        if band.len() != series.points.len() {
            return Err(ChartError::Band {
                series: series.name.clone(),
                found: band.len(),
                expected: series.points.len(),
            });
        }

        for end in [0, 1] {
            self.check_finite(&series.name, band.iter().map(|ends| ends[end]))?;
        }

        Ok(())
    }

    fn check_finite(
        &self,
        series: &str,
        values: impl Iterator<Item = f64>,
    ) -> Result<(), ChartError> {
        finite(&self.title, series, values.enumerate())
    }
}

impl ImageChart {
    /// Refuses an image whose values do not fill its rows, with numbers that are not finite, or with ranges that do not rise.
    fn check(&self) -> Result<(), ChartError> {
        let sides = 1..=MAX_CELLS;
        let values = self.values.len();
        // The columns are checked first: the values are divided by their number.
        let fits = sides.contains(&self.columns)
            && values.is_multiple_of(self.columns)
            && sides.contains(&(values / self.columns));

        if !fits {
            return Err(ChartError::Grid {
                chart: self.title.clone(),
                values,
                columns: self.columns,
            });
        }

        // The absent cell may hold anything: its value is not read.
        let read = (self.values.iter().copied().enumerate())
            .filter(|(index, _)| Some(*index) != self.absent);
        finite(&self.title, "the grid", read)?;

        for axis in [&self.x, &self.y] {
            axis.checked_range()?;
            axis.check_ticks(&self.title)?;
        }

        if !rises(self.clamp) {
            return Err(ChartError::Range(self.title.clone()));
        }

        Ok(())
    }
}

impl BlankChart {
    fn check(&self) -> Result<(), ChartError> {
        for axis in [&self.x, &self.y] {
            axis.checked_range()?;
            axis.check_ticks(&self.title)?;
        }
        // A chart without cells has no size.
        if self.cells.is_some_and(|cells| cells.contains(&0)) {
            return Err(ChartError::Empty(self.title.clone()));
        }
        Ok(())
    }
}

impl Axis {
    fn checked_range(&self) -> Result<[f64; 2], ChartError> {
        let range = self.range.filter(|range| rises(*range));
        range.ok_or_else(|| ChartError::Range(self.label.clone()))
    }

    fn check_ticks(&self, chart: &str) -> Result<(), ChartError> {
        let ticks = self.ticks.iter().flatten().map(|(value, _)| *value);
        finite(
            chart,
            &format!("ticks of {}", self.label),
            ticks.enumerate(),
        )
    }
}

fn rises([low, high]: [f64; 2]) -> bool {
    low.is_finite() && high.is_finite() && low < high && (high - low).is_normal()
}

/// Refuses the first of indexed values that is not finite. `series` names what the values belong to.
fn finite(
    chart: &str,
    series: &str,
    mut values: impl Iterator<Item = (usize, f64)>,
) -> Result<(), ChartError> {
    match values.find(|(_, value)| !value.is_finite()) {
        None => Ok(()),
        Some((index, value)) => Err(ChartError::NotFinite {
            chart: chart.to_owned(),
            series: series.to_owned(),
            index,
            value,
        }),
    }
}

#[cfg(test)]
mod tests;
