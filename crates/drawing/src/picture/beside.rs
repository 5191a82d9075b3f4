//! The analysis beside a picture: the name of the moment, the periodogram of its samples and the radial mean of that. Axes and
//! shades are those of the finished set, so that moments of one run can be compared by eye.

use glam::DVec2;
use tilescope_analysis::measures::Spectrum;
use tilescope_figures::chart::{
    Axis, BlankChart, ChartError, ImageChart, LineChart, Look, Panel, Series, panel_around,
    panel_groups,
};
use tilescope_figures::{Font, Group, Palette, Rect, Scene, Shape, Text, fitted};
use tilescope_session::words::grouped;

use super::{MARGIN, PictureView};
use crate::spectra::{self, BLACK};

/// The smallest side of the periodogram, in points: its axes have room for their labels.
const MIN_SIDE: f64 = 216.0;
/// The height of the radial mean, relative to the periodogram's. Chosen, not measured, as is the size of the name below.
const MEAN_HEIGHT: f64 = 0.62;
/// The height of the moment's name, and its font size, in points.
const NAME_HEIGHT: f64 = 24.0;
const NAME_SIZE: f64 = 15.0;

/// The analysis of a moment, for the picture beside that of its samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Beside {
    /// The name of the moment.
    pub name: String,
    /// The spectrum of its samples, at the frequencies and with the number of samples of the finished set.
    pub spectrum: Spectrum,
    /// Why the moment has no spectrum, if it has none; the axes are drawn all the same.
    pub lack: Option<String>,
}

/// The plots of the analysis, in points.
pub(super) struct Column {
    periodogram: Rect,
    mean: Rect,
}

impl Column {
    /// Returns the column beside a picture of this size: it begins where the picture ends (`left`), and is as high as
    /// the picture, or as high as its own axes need.
    pub(super) fn of(view: &PictureView, [left, height]: [f64; 2]) -> Self {
        let top = MARGIN * view.width() + NAME_HEIGHT;
        // The panel around a plot of no size at the origin is the room that heading and axes take: left of the plot and
        // above it up to `axes.min`, right of it and below up to `axes.max`.
        let axes = panel_around(Rect::new(DVec2::ZERO, DVec2::ZERO));
        let room = height - top - 2.0 * axes.size().y - MARGIN * view.width();
        let side = (room / (1.0 + MEAN_HEIGHT)).max(MIN_SIDE).floor();

        let first = (DVec2::new(left, top) - axes.min).round();
        let second = first + (side + axes.size().y) * DVec2::Y;
        let mean_height = (MEAN_HEIGHT * side).floor();
        Self {
            periodogram: Rect::new(first, first + side),
            mean: Rect::new(second, second + DVec2::new(side, mean_height)),
        }
    }

    /// Returns the size of a picture of this height together with the column.
    pub(super) fn paper(&self, view: &PictureView, height: f64) -> [f64; 2] {
        let end = panel_around(self.mean).max;
        [end.x, height.max(end.y + MARGIN * view.width())]
    }
}

impl Beside {
    /// Draws it beside the picture of a view that has room for it.
    ///
    /// # Errors
    ///
    /// [`ChartError`] for a spectrum with numbers that are not finite.
    pub fn draw(&self, view: &PictureView, scene: &mut Scene) -> Result<(), ChartError> {
        let palette = if view.is_dark() {
            &Palette::DARK
        } else {
            &Palette::LIGHT
        };
        let column = Column::of(view, view.canvas_paper());

        scene.groups.push(self.heading(&column, palette));
        for (panel, plot) in [
            (self.periodogram(view), column.periodogram),
            (self.mean(), column.mean),
        ] {
            let cell = panel_around(plot);
            scene.groups.extend(panel_groups(&panel, cell, palette)?);
        }
        Ok(())
    }

    fn heading(&self, column: &Column, palette: &Palette) -> Group {
        let plot = column.periodogram;
        let name = fitted(&self.name, plot.size().x, NAME_SIZE);
        let line = panel_around(plot).min.y - NAME_HEIGHT + NAME_SIZE;
        let mut text = Text::new([plot.min.x, line], name, NAME_SIZE, palette.text);
        text.font = Font::SemiBold;

        let mut group = Group::new("moment");
        group.shapes.push(Shape::Text(text));
        group
    }

    /// Returns the periodogram in shades of grey, or its empty frame with the reason for the lack.
    fn periodogram(&self, view: &PictureView) -> Panel {
        let printed = spectra::periodogram(&self.spectrum, "Periodogram".to_owned());
        // A white square would outshine a dark canvas in a lecture hall.
        let chart = if view.is_dark() {
            spectra::on_dark(printed)
        } else {
            printed
        };

        let rows = chart.values.len() / chart.columns;
        match &self.lack {
            None => Panel::Image(chart),
            Some(why) => {
                let ImageChart {
                    title,
                    x,
                    y,
                    columns,
                    ..
                } = chart;
                Panel::Blank(BlankChart {
                    title,
                    x,
                    y,
                    cells: Some([columns, rows]),
                    why: why.clone(),
                })
            }
        }
    }

    /// Returns the radial mean, or its empty frame with the reason for the lack. Its vertical axis ends where the shades of the
    /// periodogram do.
    fn mean(&self) -> Panel {
        // Frequencies are in the unit of the finished set, whose number of samples the spectrum states. The moment may
        // have fewer samples.
        let samples = grouped(self.spectrum.profile.samples.round() as usize);
        let frequency = format!("frequency \u{3bd} = |k| / \u{221a}{samples}");
        let power = format!("power P(\u{3bd}), cut off at {BLACK}");
        let series = Series {
            name: self.name.clone(),
            look: Look::Alone,
            points: self.spectrum.power(),
            band: None,
        };
        // The scale is the same for all moments: otherwise the eye could not compare two frames.
        let y = Axis::new(power).with_range(0.0, BLACK);
        let chart = spectra::radial_mean(&frequency, y, vec![series]);

        match &self.lack {
            None => Panel::Lines(chart),
            Some(why) => {
                let LineChart { title, x, y, .. } = chart;
                Panel::Blank(BlankChart {
                    title,
                    x,
                    y,
                    cells: None,
                    why: why.clone(),
                })
            }
        }
    }
}
