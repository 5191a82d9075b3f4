//! A figure's scene: title, legend, scales and rows of panels. What a panel shows is drawn by the modules beside this one.
//! Sizes were chosen, not measured, where no reason stands beside them.

use glam::DVec2;

use super::frame::{FOOT, Frame, HEAD, LEFT, RIGHT};
use super::lines::{self, drawn};
use super::tiles::{self, TileChart};
use super::{ChartError, Figure, Look, Panel, blank, image};
use crate::fonts::{Font, text_width};
use crate::palette::Palette;
use crate::scene::{Baseline, Group, Rect, Scene, Shape, Text};

/// Width of a figure in pixels.
pub(super) const WIDTH: f64 = 1200.0;
/// Height of a row of curves.
const ROW: f64 = 380.0;
/// The most that a row of images leaves for their height.
const IMAGE_HEIGHT: f64 = 480.0;
/// Left and right of everything, and below.
pub(super) const MARGIN: f64 = 20.0;
/// Room for the title above the legend, its baseline in it, and the size of its letters.
const TITLE: f64 = 52.0;
const TITLE_BASELINE: f64 = 34.0;
const TITLE_TEXT: f64 = 20.0;
/// Height of a line of the legend, and room below the last one.
const LEGEND_LINE: f64 = 24.0;
const LEGEND_FOOT: f64 = 8.0;
/// The size of names in the legend.
const LEGEND_TEXT: f64 = 13.0;
/// Room for a line's sample before its name, of which the last pixels stay free, and room after the name.
const SAMPLE: f64 = 44.0;
const SAMPLE_END: f64 = 8.0;
const GAP: f64 = 28.0;

/// Cells of whole pixels may leave a tenth of an image's room unused.
const MIN_SHARE_OF_ROOM: f64 = 0.9;

/// Returns the scene of a figure, 1200 pixels wide, or as wide as its tiles where it has nothing but tiles of a given side. Its
/// height follows from the rows.
///
/// Above the panels stands a legend with the name of each series, once.
///
/// # Errors
///
/// [`ChartError`] for a figure, a row, a chart or a series without content, bars or tiles beside other panels, numbers
/// that are not finite, bands of another length than their series, ranges that are missing or do not rise, and values
/// that do not fill the rows of a grid.
///
/// ```
/// use tilescope_figures::chart::{Axis, Figure, LineChart, Look, Panel, Series, figure_scene};
/// use tilescope_figures::{Palette, to_svg};
///
/// let curve = Series { name: "a.csv".into(), look: Look::Numbered(0), points: vec![[0.0, 1.0], [1.0, 2.0]], band: None };
/// let chart = LineChart {
///     title: "Power".into(),
///     x: Axis::new("frequency"),
///     y: Axis::new("power"),
///     series: vec![curve],
///     levels: Vec::new(),
/// };
/// let figure = Figure { title: "One set".into(), rows: vec![vec![Panel::Lines(chart)]] };
/// let scene = figure_scene(&figure, &Palette::LIGHT)?;
/// assert!(to_svg(&scene).unwrap().contains("a.csv"));
/// # Ok::<(), tilescope_figures::chart::ChartError>(())
/// ```
pub fn figure_scene(figure: &Figure, palette: &Palette) -> Result<Scene, ChartError> {
    if figure.rows.is_empty() || figure.rows.iter().any(Vec::is_empty) {
        return Err(ChartError::Empty(figure.title.clone()));
    }

    let (names, mut top) = legend(figure, palette, TITLE);
    // The height is set once all rows are there.
    let (width, height) = (tiles_width(figure).unwrap_or(WIDTH), 1.0);
    let mut scene = Scene::new(width, height, palette.background);
    scene.title.clone_from(&figure.title);
    scene.groups.extend([title(figure, palette), names]);
    for panel in figure.rows.iter().flatten() {
        if let Panel::Scale(scale) = panel {
            scene.groups.push(scale.group(scene.width, palette));
        }
    }

    let mut columns = 1;
    let first_tile = MARGIN + names_width(figure);
    for row in &figure.rows {
        let panels: Vec<&Panel> = (row.iter())
            // Scales of colours stand beside the title and take no room in their row.
            .filter(|panel| !matches!(panel, Panel::Scale(_)))
            .collect();

        if let [Panel::Bars(chart)] = panels[..] {
            chart.check()?;
            scene.groups.extend(chart.groups(top, palette));
            top += chart.height();
            continue;
        }

        // A row of scales alone takes no room.
        if panels.is_empty() {
            continue;
        }
        if panels.iter().any(|panel| matches!(panel, Panel::Tile(_))) {
            top = tile_row(&panels, first_tile, top, &mut scene, palette)?;
            continue;
        }

        // If a row has fewer images than a row of images just above it, its images are as large as those above.
        columns = if images(&panels) {
            columns.max(panels.len())
        } else {
            panels.len()
        };

        let cell_width = (WIDTH - 2.0 * MARGIN) / columns as f64;
        let cell_height = row_height(&panels, cell_width);

        for (index, panel) in panels.iter().enumerate() {
            // Panels begin at whole pixels, as cells of images do.
            let left = (MARGIN + index as f64 * cell_width).round();
            let cell = Rect::new([left, top], [left + cell_width, top + cell_height]);
            scene.groups.extend(panel_groups(panel, cell, palette)?);
        }

        top += cell_height;
        // What follows a row of curves need not be as wide as images above it.
        if !images(&panels) {
            columns = 1;
        }
    }

    scene.height = top + MARGIN;
    Ok(scene)
}

/// Returns the title above everything.
fn title(figure: &Figure, palette: &Palette) -> Group {
    let at = [MARGIN, TITLE_BASELINE];
    let mut text = Text::new(at, &figure.title, TITLE_TEXT, palette.text);
    text.font = Font::SemiBold;

    let mut group = Group::new("title");
    group.shapes.push(Shape::Text(text));
    group
}

/// Adds a row of tiles whose upper end is `top`, and returns its lower end, or the error for a row with other panels or
/// for a tile that cannot be drawn. Tiles of a given side stand side by side from `first_tile` on.
fn tile_row(
    row: &[&Panel],
    first_tile: f64,
    top: f64,
    scene: &mut Scene,
    palette: &Palette,
) -> Result<f64, ChartError> {
    let all: Vec<&TileChart> = tiles_of(row.iter().copied()).collect();
    // A row is as high as its tiles, or else as high as `row_height` says for other panels: it cannot have both
    // heights.
    if all.len() != row.len() {
        return Err(ChartError::Mixed(scene.title.clone()));
    }

    let [head, foot] = tiles::room(&all);
    let column = (WIDTH - 2.0 * MARGIN) / all.len() as f64;

    let (mut below, mut next_left) = (top, first_tile);
    for (index, tile) in (0..).map(f64::from).zip(all) {
        let (left, side) = match tile.side {
            Some(side) => {
                let left = next_left;
                next_left += side + tiles::GAP;
                (left, side)
            }
            // Without a side of its own, a tile is as wide as the plots of charts above and below it.
            None => (MARGIN + index * column + LEFT, column - LEFT - RIGHT),
        };

        // Every tile has the room of the highest title above it, so that the tiles of a row stand in one line.
        let corner = DVec2::new(left, top + head);
        let frame = Rect::new(corner, corner + side);
        scene.groups.extend(tile.groups(frame, palette)?);
        below = frame.max.y.max(below);
    }

    Ok(below + foot)
}

fn tiles_of<'a>(panels: impl Iterator<Item = &'a Panel>) -> impl Iterator<Item = &'a TileChart> {
    panels.filter_map(|panel| match panel {
        Panel::Tile(tile) => Some(tile),
        _ => None,
    })
}

/// Returns the width of a figure that has nothing but tiles of a given side; none for others.
fn tiles_width(figure: &Figure) -> Option<f64> {
    // The title is not to be cut off above a few small tiles.
    let mut widest = text_width(&figure.title, Font::SemiBold, TITLE_TEXT);
    for row in &figure.rows {
        // There is one gap less than tiles.
        let mut width = -tiles::GAP;
        for panel in row {
            match panel {
                Panel::Tile(tile) => width += tile.side? + tiles::GAP,
                // Scales stand beside the title.
                Panel::Scale(_) => {}
                _ => return None,
            }
        }
        widest = widest.max(names_width(figure) + width);
    }
    Some((widest + 2.0 * MARGIN).ceil())
}

/// Returns the room left of tiles, which their rows' names take.
fn names_width(figure: &Figure) -> f64 {
    let named = tiles_of(figure.rows.iter().flatten()).any(|tile| tile.y.is_some());
    if named { tiles::NAMES } else { 0.0 }
}

fn images(row: &[&Panel]) -> bool {
    row.iter().all(|panel| matches!(panel, Panel::Image(_)))
}

/// Returns the height of a row. Images are as high as makes them square, unless one alone would fill a page.
fn row_height(row: &[&Panel], width: f64) -> f64 {
    if images(row) {
        let plot = width - LEFT - RIGHT;
        return (plot.min(IMAGE_HEIGHT) + HEAD + FOOT).round();
    }
    ROW
}

/// Returns the rectangle that a panel needs for its plot with heading, ticks and labels.
#[must_use]
pub fn panel_around(plot: Rect) -> Rect {
    Rect::new(
        plot.min - DVec2::new(LEFT, HEAD),
        plot.max + DVec2::new(RIGHT, FOOT),
    )
}

/// Returns the shapes of a panel in a rectangle of pixels, for pictures that arrange panels themselves.
///
/// # Errors
///
/// [`ChartError`], as of [`figure_scene`]; bars, tiles and scales have rows of their own and are refused.
pub fn panel_groups(
    panel: &Panel,
    cell: Rect,
    palette: &Palette,
) -> Result<Vec<Group>, ChartError> {
    let plot = Rect::new(
        cell.min + DVec2::new(LEFT, HEAD),
        cell.max - DVec2::new(RIGHT, FOOT),
    );
    let framed = |plot: Rect, [x, y]: [[f64; 2]; 2], axes| Frame {
        plot,
        x,
        y,
        axes,
        palette,
    };

    match panel {
        Panel::Lines(chart) => {
            chart.check()?;
            let frame = framed(plot, chart.ranges(), [&chart.x, &chart.y]);
            let mut groups = vec![frame.grid()];
            groups.extend(lines::groups(chart, &frame));
            // The border comes last, so that no curve covers it.
            groups.push(frame.border(&chart.title));
            Ok(groups)
        }
        Panel::Image(chart) => {
            chart.check()?;
            let ranges = [chart.x.checked_range()?, chart.y.checked_range()?];
            let cells = [chart.columns, chart.values.len() / chart.columns];
            let plot = true_to_scale(cells, ranges, plot);
            let frame = framed(plot, ranges, [&chart.x, &chart.y]);
            // No grid: the cells would cover it.
            let mut groups = image::groups(chart, &frame);
            groups.push(frame.border(&chart.title));
            Ok(groups)
        }
        Panel::Blank(chart) => {
            chart.check()?;
            let ranges = [chart.x.checked_range()?, chart.y.checked_range()?];
            // The frame is as large as the image's would be.
            let of_image = |cells| true_to_scale(cells, ranges, plot);
            let plot = chart.cells.map_or(plot, of_image);
            let frame = framed(plot, ranges, [&chart.x, &chart.y]);
            Ok(vec![
                blank::words(&chart.why, &frame),
                frame.border(&chart.title),
            ])
        }
        Panel::Bars(_) | Panel::Tile(_) | Panel::Scale(_) => {
            Err(ChartError::Mixed("bars and tiles".to_owned()))
        }
    }
}

/// Returns the largest plot of these columns and rows of cells within `plot` in which a unit is as long along both
/// axes, so that circles are round. Square cells have whole or half pixels, if these use nine tenths of the room.
fn true_to_scale([columns, rows]: [usize; 2], [x, y]: [[f64; 2]; 2], plot: Rect) -> Rect {
    let span = DVec2::new(x[1] - x[0], y[1] - y[0]);
    let unit = (plot.size() / span).min_element();

    let cells = DVec2::new(columns as f64, rows as f64);
    let mut cell = unit * span / cells;

    // Multiples of half a pixel: pictures are often made at scale 2, where these are whole. The hair allows for
    // rounding. Cells below a pixel would lose too much of their size.
    if (cell.x / cell.y - 1.0).abs() < 1e-9 && cell.x >= 1.0 {
        let whole = (2.0 * cell.x + 1e-9).floor() / 2.0;
        if whole > MIN_SHARE_OF_ROOM * cell.x {
            cell = DVec2::splat(whole);
        }
    }

    let min = plot.min.round();
    Rect::new(min, min + cell * cells)
}

/// Returns the legend, whose upper end is `top`, and its lower end. Without names it takes no room.
fn legend(figure: &Figure, palette: &Palette, top: f64) -> (Group, f64) {
    let mut group = Group::new("legend");
    let looks_by_name = entries(figure);
    if looks_by_name.is_empty() {
        return (group, top);
    }

    let mut at = DVec2::new(MARGIN, top + 0.5 * LEGEND_LINE);
    for (name, look) in looks_by_name {
        let width = SAMPLE + text_width(name, Font::Regular, LEGEND_TEXT) + GAP;
        // A name that does not fit goes to the next line. A name wider than the figure is not moved from the beginning of its
        // line, which would leave an empty one.
        if at.x > MARGIN && at.x + width - GAP > WIDTH - MARGIN {
            at = DVec2::new(MARGIN, at.y + LEGEND_LINE);
        }

        let line = drawn(look, palette);
        let along = (SAMPLE - SAMPLE_END) * DVec2::X;
        group.shapes.push(Shape::line(at, at + along, line.stroke));
        if let Some(marker) = line.marker {
            let middle = at + 0.5 * along;
            group
                .shapes
                .push(lines::mark(marker, middle, line.stroke.color));
        }

        let mut text = Text::new(at + SAMPLE * DVec2::X, name, LEGEND_TEXT, palette.text);
        text.baseline = Baseline::Middle;
        group.shapes.push(Shape::Text(text));
        at.x += width;
    }

    (group, at.y + 0.5 * LEGEND_LINE + LEGEND_FOOT)
}

/// Returns each name once, in sequence.
fn entries(figure: &Figure) -> Vec<(&str, Look)> {
    let mut entries: Vec<(&str, Look)> = Vec::new();
    for panel in figure.rows.iter().flatten() {
        if let Panel::Lines(chart) = panel {
            for series in &chart.series {
                if entries.iter().all(|(name, _)| *name != series.name) {
                    entries.push((&series.name, series.look));
                }
            }
        }
    }
    entries
}
