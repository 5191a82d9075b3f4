//! A grid of values as shades of grey.
//! Nothing is smoothed: a cell has one shade. The numbers below were chosen, not measured.

use std::ops::Range;

use glam::DVec2;

use super::ImageChart;
use super::frame::Frame;
use crate::palette::Color;
use crate::scene::{Group, Rect, Shape, Stroke, Style};

/// Shades that are told apart.
const SHADES: usize = 32;

/// Pixels by which cells reach over each other where their edges are not those of pixels.
const OVER: f64 = 0.3;

/// Returns the cells of an image, and the ring about the absent one. Cells of one shade are one shape.
pub(super) fn groups(chart: &ImageChart, frame: &Frame<'_>) -> Vec<Group> {
    let mut cells = Group {
        clip: Some(frame.plot),
        ..Group::new("cells")
    };

    let Rect { min, max } = frame.plot;
    let rows = chart.values.len() / chart.columns;
    let size = frame.plot.size() / DVec2::new(chart.columns as f64, rows as f64);

    // Pictures are often made at scale 2, with two pixels for each of the scene. If edges of cells lie between pixels,
    // the background would show through: then cells overlap a little.
    let on_pixels = (2.0 * size).fract().max_element() < 1e-6;
    let over = if on_pixels { 0.0 } else { OVER };

    // A shape for each cell would be up to a million shapes. Instead the cells of one shade are one shape, of lines as thick as
    // a row is high.
    let by_shade = runs(chart);
    for (shade, its_runs) in by_shade
        .iter()
        .enumerate()
        // A shade without cells would be an empty shape in the file.
        .filter(|(_, its_runs)| !its_runs.is_empty())
    {
        let line = |run: &CellRun| {
            // Rows of the values count from below, and y of the picture from above.
            let y = max.y - (run.row as f64 + 0.5) * size.y;
            let columns = [run.columns.start, run.columns.end];
            let [from, to] = columns.map(|column| min.x + column as f64 * size.x);
            [DVec2::new(from, y), DVec2::new(to + over, y)]
        };
        cells.shapes.push(Shape::Segments {
            segments: its_runs.iter().map(line).collect(),
            stroke: Stroke::new(grey(shade), size.y + over),
        });
    }

    let absent_ring = chart.absent.map(|absent| {
        let [column, row] = [absent % chart.columns, absent / chart.columns];
        let offset = (DVec2::new(column as f64, row as f64) + 0.5) * size;
        let center = DVec2::new(min.x + offset.x, max.y - offset.y);
        ring(center, size.max_element(), frame)
    });

    std::iter::once(cells).chain(absent_ring).collect()
}

fn ring(center: DVec2, cell: f64, frame: &Frame<'_>) -> Group {
    let mut group = Group::new("absent");
    let style = Style::stroked(frame.palette.conflict, 1.2);
    // Around a cell of a pixel or two a ring of its size would not be seen.
    group
        .shapes
        .push(Shape::circle(center, cell.max(5.0), style));
    group
}

/// Neighbouring cells of a row that have one shade.
#[derive(Clone)]
struct CellRun {
    row: usize,
    columns: Range<usize>,
}

/// Returns, for each shade, the runs of its cells.
fn runs(chart: &ImageChart) -> Vec<Vec<CellRun>> {
    let mut shades = vec![Vec::new(); SHADES];
    for (row, values) in chart.values.chunks(chart.columns).enumerate() {
        let mut last = None;
        for (column, value) in values.iter().enumerate() {
            let absent = chart.absent == Some(row * chart.columns + column);
            // The absent cell ends a run as another shade would, and its value is not read.
            let shade = (!absent).then(|| shade_of(*value, chart.clamp));

            // Neighbours of one shade are one line: fewer pieces, and no seam between them.
            if let Some(shade) = shade {
                let its_runs: &mut Vec<CellRun> = &mut shades[shade];
                match its_runs.last_mut() {
                    Some(run) if last == Some(shade) => run.columns.end = column + 1,
                    _ => its_runs.push(CellRun {
                        row,
                        columns: column..column + 1,
                    }),
                }
            }

            last = shade;
        }
    }
    shades
}

fn shade_of(value: f64, [low, high]: [f64; 2]) -> usize {
    let part = ((value - low) / (high - low)).clamp(0.0, 1.0);
    ((part * SHADES as f64) as usize).min(SHADES - 1)
}

fn grey(shade: usize) -> Color {
    let level = 255 - (255 * shade / (SHADES - 1)) as u8;
    [level, level, level, 255]
}
