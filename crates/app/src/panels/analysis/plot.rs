//! A generic chart of curves: axes with round ticks, levels, confidence bands, values under the pointer, and a range to
//! drag. `charts.rs` chooses the curves. Sizes are in screen points, and chosen, not measured, where no reason stands
//! beside them.

use egui::{
    Align2, Color32, CursorIcon, FontId, Mesh, Painter, Pos2, Rect, Response, Role, Sense, Shape,
    Stroke, Ui, WidgetInfo, pos2, vec2,
};

use tilescope_drawing::palette::Palette;
use tilescope_ui::theme::semibold;
use tilescope_ui::widgets::Known;

use crate::ENABLED;

/// Margin for the numbers of the vertical axis, in screen points.
const LEFT: f32 = 30.0;
/// Margin for the title.
const ABOVE: f32 = 23.0;
/// Margin for the numbers and the label of the horizontal axis.
const BELOW: f32 = 31.0;
/// Minimum distance between numbers along the horizontal and the vertical axis.
const TICKS_APART: [f32; 2] = [33.0, 26.0];

/// The style of a line, so that lines are distinguishable without colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dash {
    /// A solid and wide line, for the run.
    Solid,
    /// A dotted line, for the reference.
    Dotted,
    /// A dashed line, for a file.
    Dashed,
    /// A line of long dashes, for run B.
    Long,
}

/// A curve of the chart, with its name for readers and legends.
pub struct Curve {
    /// Its name in the values under the pointer.
    pub name: String,
    /// Its points, ascending in x.
    pub points: Vec<[f64; 2]>,
    /// The confidence band at each point.
    pub band: Option<Vec<[f64; 2]>>,
    /// The style of its line.
    pub line: Dash,
    /// The colour of its line and its band.
    pub color: Color32,
}

/// An axis of the chart.
pub struct PlotAxis<'a> {
    /// Its label, with the unit.
    pub label: &'a str,
    /// Its symbol, for the readout.
    pub sign: &'a str,
    /// The values at its ends.
    pub range: [f64; 2],
}

/// A chart of several curves over one axis.
pub struct Plot<'a> {
    /// The title above it.
    pub title: &'a str,
    /// The horizontal axis, with its label below.
    pub x: PlotAxis<'a>,
    /// The vertical axis; its label is neither drawn nor read out.
    pub y: PlotAxis<'a>,
    /// A reference level with its meaning.
    pub level: (f64, &'a str),
    /// The curves, the most important first.
    pub curves: Vec<Curve>,
    /// Whether the first two are those of runs A and B, whose difference is of interest.
    pub is_compared: bool,
    /// The selected range of the horizontal axis.
    pub brush: Option<[f64; 2]>,
    /// Height, in screen points.
    pub height: f32,
}

/// A change of the selected range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dragged {
    /// A range was selected, with these ends in any order.
    Between(f64, f64),
    /// The selected range was cleared.
    Nothing,
}

/// Returns how a click or a drag changes the selected range; `value` is that of a position on the screen.
pub fn dragged(
    ui: &Ui,
    response: &Response,
    brush: Option<[f64; 2]>,
    value: impl Fn(Pos2) -> f64,
) -> Option<Dragged> {
    if response.clicked() {
        return brush.map(|_| Dragged::Nothing);
    }
    let from = ui.input(|input| input.pointer.press_origin());
    let (from, to) = from.zip(response.interact_pointer_pos())?;
    let is_dragged = response.dragged();
    is_dragged.then(|| Dragged::Between(value(from), value(to)))
}

impl Plot<'_> {
    /// Shows the chart over the full width; returns the change of the range, if it was changed.
    pub fn show(&self, ui: &mut Ui, palette: &Palette) -> Option<Dragged> {
        let size = vec2(ui.available_width(), self.height);
        let (rect, response) = ui.allocate_exact_size(size, Sense::CLICK | Sense::DRAG);
        let said = self.description();
        response.widget_info(|| WidgetInfo::labeled(Role::Image, ENABLED, &said));
        response.known_as(format_args!("chart.{}", self.y.sign));

        let mut inner = rect;
        inner.min += vec2(LEFT, ABOVE);
        // The last number of the x axis is centred on the right edge of the chart, and needs room beyond it.
        inner.max -= vec2(13.0, BELOW);
        let frame = PlotFrame { plot: self, inner };

        let painter = ui.painter_at(rect);
        frame.ground(&painter, rect, palette);
        // A point wider than the axes, so that lines along the border are drawn in their whole width.
        let within = ui.painter_at(inner.expand(1.0));
        frame.marked(&within, palette);
        // The most important curve is the first one. It is drawn last, and so lies on top.
        for curve in self.curves.iter().rev() {
            frame.curve(&within, curve);
        }
        // Run B's dashes lie on run A's line, so that both are seen where they are the same.
        if let Some(second) = self.curves.get(1).filter(|_| self.is_compared) {
            frame.curve(&within, second);
        }

        for (row, curve) in self.curves.iter().enumerate() {
            frame.cut_off(&within, curve, row);
        }

        let pointer = response.hover_pos().filter(|at| inner.contains(*at));
        // During a drag the values under the pointer would hide the range that is dragged.
        if let Some(at) = pointer.filter(|_| !response.dragged()) {
            let x = frame.x_at(at);
            frame.cursor(&within, x, palette);
            let lines = self.rows(x);
            response.clone().on_hover_ui_at_pointer(|ui| {
                for row in lines {
                    ui.label(egui::RichText::new(row).monospace());
                }
            });
        }

        let response = response.on_hover_cursor(CursorIcon::Crosshair);
        dragged(ui, &response, self.brush, |at| frame.x_at(at))
    }

    /// Returns a description of the chart for screen readers.
    fn description(&self) -> String {
        let highest_of = |curve: &Curve| {
            let points = curve.points.iter().copied();
            points.max_by(|a, b| a[1].total_cmp(&b[1]))
        };
        let each = self.curves.iter().filter_map(|curve| {
            let [x, y] = highest_of(curve)?;
            Some(format!(
                " {}: highest {y:.2} at {} {x:.2}.",
                curve.name, self.x.sign
            ))
        });

        let highest: String = each.collect();
        let curves = if highest.is_empty() {
            " Nothing yet.".to_owned()
        } else {
            highest
        };
        format!("Chart: {} over {}.{curves}", self.title, self.x.label)
    }

    /// Returns the values of the curves at their points nearest to x, in words, without curves that have no point
    /// near x.
    fn rows(&self, x: f64) -> Vec<String> {
        let mut rows = vec![format!("{} = {x:.3}", self.x.sign)];
        for curve in &self.curves {
            if let Some([_, y]) = nearest(&curve.points, x) {
                rows.push(format!("{} {y:>8.3}  {}", self.y.sign, curve.name));
            }
        }

        // A difference needs a value of both runs near x.
        if let [run_a, run_b, ..] = &self.curves[..]
            && self.is_compared
            && let (Some([_, a]), Some([_, b])) =
                (nearest(&run_a.points, x), nearest(&run_b.points, x))
        {
            rows.push(format!("{} {:>+8.3}  B \u{2212} A", self.y.sign, b - a));
        }

        rows.push(format!(
            "{} {:>8.3}  {}",
            self.y.sign, self.level.0, self.level.1
        ));
        rows
    }
}

/// Returns the point nearest to x, if it is within two spacings.
fn nearest(points: &[[f64; 2]], x: f64) -> Option<[f64; 2]> {
    let after = points.partition_point(|point| point[0] < x);
    let around = [after.checked_sub(1), Some(after)];
    let near = around
        .into_iter()
        .flatten()
        .filter_map(|index| points.get(index));
    let nearest = near.min_by(|a, b| (a[0] - x).abs().total_cmp(&(b[0] - x).abs()))?;
    let step = match points {
        [first, .., last] => (last[0] - first[0]) / (points.len() - 1) as f64,
        _ => f64::INFINITY,
    };
    ((nearest[0] - x).abs() <= 2.0 * step).then_some(*nearest)
}

/// A chart and its rectangle.
struct PlotFrame<'a> {
    plot: &'a Plot<'a>,
    inner: Rect,
}

impl PlotFrame<'_> {
    fn at(&self, [x, y]: [f64; 2]) -> Pos2 {
        let part = |value: f64, [low, high]: [f64; 2]| ((value - low) / (high - low)) as f32;
        let (x, y) = (part(x, self.plot.x.range), part(y, self.plot.y.range));
        // Values far outside of the plot are clamped, so that lines stay finite.
        let y = y.clamp(-3.0, 4.0);
        pos2(
            self.inner.left() + x * self.inner.width(),
            self.inner.bottom() - y * self.inner.height(),
        )
    }

    fn x_at(&self, at: Pos2) -> f64 {
        let part = (at.x - self.inner.left()) / self.inner.width();
        let [low, high] = self.plot.x.range;
        low + f64::from(part.clamp(0.0, 1.0)) * (high - low)
    }

    /// Draws title, axes, ticks and the reference level.
    fn ground(&self, painter: &Painter, rect: Rect, palette: &Palette) {
        let (inner, plot) = (self.inner, self.plot);
        painter.rect_filled(inner, 2.0, palette.domain);

        let title = FontId::new(12.5, semibold());
        let at = pos2(rect.left(), rect.top() + 1.0);
        painter.text(at, Align2::LEFT_TOP, plot.title, title, palette.text);

        let (number_font, words_font) = (FontId::monospace(10.5), FontId::proportional(11.5));
        let thin = Stroke::new(1.0, palette.line);
        for (value, text) in ticks(plot.x.range, inner.width() / TICKS_APART[0]) {
            let x = self.at([value, plot.y.range[0]]).x;
            painter.vline(x, inner.y_range(), thin);
            let at = pos2(x, inner.bottom() + 3.0);
            let font = number_font.clone();
            painter.text(at, Align2::CENTER_TOP, text, font, palette.muted);
        }

        for (value, text) in ticks(plot.y.range, inner.height() / TICKS_APART[1]) {
            let y = self.at([plot.x.range[0], value]).y;
            painter.hline(inner.x_range(), y, thin);
            let at = pos2(inner.left() - 4.0, y);
            let font = number_font.clone();
            painter.text(at, Align2::RIGHT_CENTER, text, font, palette.muted);
        }

        let under = pos2(inner.center().x, rect.bottom() - 1.0);
        painter.text(
            under,
            Align2::CENTER_BOTTOM,
            plot.x.label,
            words_font,
            palette.muted,
        );

        // The reference level and the axes lie over the lines of the ticks.
        self.level(painter, palette);
        let border = Stroke::new(1.0, palette.border);
        painter.hline(inner.x_range(), inner.bottom(), border);
        painter.vline(inner.left(), inner.y_range(), border);
    }

    /// Draws the reference level.
    fn level(&self, painter: &Painter, palette: &Palette) {
        let (inner, plot) = (self.inner, self.plot);
        let y = self.at([plot.x.range[0], plot.level.0]).y;
        if inner.y_range().contains(y) {
            let ends = [pos2(inner.left(), y), pos2(inner.right(), y)];
            let stroke = Stroke::new(1.0, palette.border);
            painter.extend(Shape::dashed_line(&ends, stroke, 9.0, 5.0));
        }
    }

    /// Draws the selected range.
    fn marked(&self, painter: &Painter, palette: &Palette) {
        let Some([low, high]) = self.plot.brush else {
            return;
        };
        let x = |value: f64| self.at([value, 0.0]).x;
        let band = Rect::from_x_y_ranges(x(low)..=x(high), self.inner.y_range());
        painter.rect_filled(band, 0.0, palette.margin.gamma_multiply(0.22));
        for end in [low, high] {
            let stroke = Stroke::new(1.2, palette.margin);
            painter.vline(x(end), self.inner.y_range(), stroke);
        }
    }

    /// Draws a curve with its band.
    fn curve(&self, painter: &Painter, curve: &Curve) {
        let points: Vec<Pos2> = curve.points.iter().map(|&point| self.at(point)).collect();
        // The band lies below its line.
        if let Some(band) = &curve.band {
            painter.add(self.band(curve, band));
        }

        match curve.line {
            Dash::Solid => {
                painter.line(points, Stroke::new(1.8, curve.color));
            }
            Dash::Dotted => {
                painter.extend(Shape::dotted_line(&points, curve.color, 4.0, 1.1));
            }
            Dash::Dashed => {
                let stroke = Stroke::new(1.7, curve.color);
                painter.extend(Shape::dashed_line(&points, stroke, 6.0, 3.5));
            }
            Dash::Long => {
                let stroke = Stroke::new(1.8, curve.color);
                painter.extend(Shape::dashed_line(&points, stroke, 9.0, 6.0));
            }
        }
    }

    /// Marks where a curve leaves the chart at the top, and writes its highest value; `row` is different for each
    /// curve.
    fn cut_off(&self, painter: &Painter, curve: &Curve, row: usize) {
        let peaks = peaks_above(&curve.points, self.plot.y.range[1]);
        let top = self.inner.top();
        for peak in &peaks {
            let x = self.at(*peak).x;
            let corners = [
                pos2(x, top),
                pos2(x - 4.0, top + 6.0),
                pos2(x + 4.0, top + 6.0),
            ];
            let triangle = Shape::convex_polygon(corners.to_vec(), curve.color, Stroke::NONE);
            painter.add(triangle);
        }

        let highest = peaks.iter().max_by(|a, b| a[1].total_cmp(&b[1]));
        let Some(peak) = highest else {
            return;
        };
        let x = self.at(*peak).x;
        // The number stands on that side of its peak where the chart has more room.
        let is_right = x > self.inner.center().x;
        let (offset, align) = if is_right {
            (-7.0, Align2::RIGHT_TOP)
        } else {
            (7.0, Align2::LEFT_TOP)
        };
        // The numbers of several curves stand below each other.
        let at = pos2(x + offset, top + 1.0 + 12.0 * row as f32);
        let [_, value] = peak;
        let text = format!("{value:.1}");
        painter.text(at, align, text, FontId::monospace(10.5), curve.color);
    }

    fn band(&self, curve: &Curve, band: &[[f64; 2]]) -> Mesh {
        let mut mesh = Mesh::default();
        let color = curve.color.gamma_multiply(0.25);
        for (point, ends) in curve.points.iter().zip(band) {
            for end in ends {
                mesh.colored_vertex(self.at([point[0], *end]), color);
            }
        }
        for k in (2..mesh.vertices.len() as u32).step_by(2) {
            mesh.add_triangle(k - 2, k - 1, k);
            mesh.add_triangle(k - 1, k, k + 1);
        }
        mesh
    }

    /// Marks x and the values of the curves there.
    fn cursor(&self, painter: &Painter, x: f64, palette: &Palette) {
        let stroke = Stroke::new(1.0, palette.muted);
        painter.vline(self.at([x, 0.0]).x, self.inner.y_range(), stroke);
        for curve in &self.plot.curves {
            if let Some(point) = nearest(&curve.points, x) {
                painter.circle_filled(self.at(point), 3.0, curve.color);
            }
        }
    }
}

/// Returns the highest point of each part of a curve that is above `end`.
fn peaks_above(points: &[[f64; 2]], end: f64) -> Vec<[f64; 2]> {
    let mut peaks: Vec<[f64; 2]> = Vec::new();
    let mut goes_on = false;
    for point in points {
        let is_above = point[1] > end;
        match peaks.last_mut().filter(|_| goes_on) {
            Some(peak) if is_above && point[1] > peak[1] => *peak = *point,
            None if is_above => peaks.push(*point),
            Some(_) | None => {}
        }
        goes_on = is_above;
    }
    peaks
}

/// Draws a sample of a curve's line, for a legend.
pub fn sample(painter: &Painter, rect: Rect, line: Dash, color: Color32) {
    let ends = [rect.left_center(), rect.right_center()];
    match line {
        Dash::Solid => {
            painter.line_segment(ends, Stroke::new(1.8, color));
        }
        Dash::Dotted => {
            painter.extend(Shape::dotted_line(&ends, color, 4.0, 1.1));
        }
        Dash::Dashed => {
            painter.extend(Shape::dashed_line(&ends, Stroke::new(1.7, color), 6.0, 3.5));
        }
        Dash::Long => {
            // A legend's sample is too short for the pattern of the curve: it has two dashes, which fill most of its
            // width.
            painter.extend(Shape::dashed_line(
                &ends,
                Stroke::new(1.8, color),
                11.0,
                2.5,
            ));
        }
    }
}

/// Returns round values within a range, at most about `most`, with their labels.
fn ticks([low, high]: [f64; 2], most: f32) -> Vec<(f64, String)> {
    // A chart with hardly any room still has two steps, so that its scale can be read.
    let rough = (high - low) / f64::from(most.max(2.0));
    let power = 10_f64.powf(rough.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0];
    // Rounding must not pass over a step that is just large enough.
    let times = steps.into_iter().find(|step| step * power >= rough * 0.999);
    let step = times.unwrap_or(10.0) * power;
    // Steps of one and more need no decimals; beyond six the margin has no room. Chosen.
    let decimals = (-step.log10().floor()).clamp(0.0, 6.0) as usize;

    // Ends of the range that are round have a number, whatever rounding makes of them.
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;

    let text = |value: f64| format!("{value:.decimals$}").replace('-', "\u{2212}");
    (first..=last)
        .map(|k| k as f64 * step)
        .map(|value| (value, text(value)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_few() {
        let texts = |range, most| -> Vec<String> {
            ticks(range, most)
                .into_iter()
                .map(|(_, text)| text)
                .collect()
        };
        assert_eq!(
            texts([0.0, 2.5], 6.0),
            ["0.0", "0.5", "1.0", "1.5", "2.0", "2.5"]
        );
        assert_eq!(
            texts([-20.0, 10.0], 3.1),
            ["\u{2212}20", "\u{2212}10", "0", "10"]
        );
        assert_eq!(texts([0.0, 5.0], 2.0), ["0", "5"]);
        for most in 2..20 {
            for high in [0.3, 1.0, 7.0, 64.0] {
                let count = ticks([0.0, high], most as f32).len();
                assert!(count <= most + 1 && count >= 1, "{most} {high} {count}");
            }
        }
    }

    #[test]
    fn each_part_that_is_cut_off_is_marked_at_its_highest_point() {
        let points = [5.0, 8.0, 6.0, 1.0, 2.0, 4.5, 3.0, 7.0];
        let points: Vec<[f64; 2]> = (0..)
            .map(f64::from)
            .zip(points)
            .map(|(x, y)| [x, y])
            .collect();
        let peaks = [[1.0, 8.0], [5.0, 4.5], [7.0, 7.0]];
        assert_eq!(peaks_above(&points, 4.0), peaks);
        assert!(peaks_above(&points, 8.0).is_empty());
    }

    #[test]
    fn the_point_under_the_pointer_is_the_nearest_one_or_none() {
        let points = [[0.0, 1.0], [1.0, 2.0], [2.0, 3.0]];
        assert_eq!(nearest(&points, 0.6), Some([1.0, 2.0]));
        assert_eq!(nearest(&points, 3.9), Some([2.0, 3.0]));
        assert_eq!(nearest(&points, 4.5), None);
        assert_eq!(nearest(&[], 1.0), None);
    }
}
