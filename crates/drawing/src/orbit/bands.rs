//! A band of rows of the picture: the nearest surface on each ray. [`Band::paint`] adds a ball, [`Band::draw`] an edge.

use super::edges::Edge;
use super::projection::{PlacedBall, Projection};

/// What a ray meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Surface {
    /// Nothing.
    Ground,
    /// An edge of the box.
    Border,
    /// An edge of the cut.
    Notch,
    /// The sphere of a ball, by the ball's number in the set.
    Sphere(u32),
    /// The flat face of a ball that was cut across an axis.
    Face(u32, usize),
}

/// Codes of the surfaces that are no ball's; those of balls are smaller, by [`super::MAX_BALLS`].
const GROUND: u32 = u32::MAX;
const BORDER: u32 = u32::MAX - 1;
const NOTCH: u32 = u32::MAX - 2;

/// Some rows of rays.
pub(super) struct Band {
    /// The number of its first row.
    pub top: usize,
    rows: usize,
    pub columns: usize,
    /// The nearness of the surface on each ray.
    nearness: Vec<f32>,
    /// The surface on each ray: a code above, or four times the number of a ball, plus 0 for its sphere, or 1 to 3 for
    /// its face across x, y or z.
    surfaces: Vec<u32>,
}

impl Band {
    pub fn new(top: usize, rows: usize, columns: usize) -> Self {
        Self {
            top,
            rows,
            columns,
            nearness: vec![f32::NEG_INFINITY; rows * columns],
            surfaces: vec![GROUND; rows * columns],
        }
    }

    /// Returns the numbers of the rows of this band between two heights, whose middles lie between them.
    fn rows_between(&self, above: f32, below: f32) -> std::ops::Range<usize> {
        between(above - self.top as f32, below - self.top as f32, self.rows)
    }

    /// Adds the visible part of a ball.
    pub fn paint(&mut self, ball: &PlacedBall, projection: &Projection, open: Option<[f64; 3]>) {
        let radius = projection.radius;
        let foremost = ball.near + radius;
        // Only the balls that the cut goes through have to look where it lies.
        let signs = open.filter(|_| ball.is_cut);

        for row in self.rows_between(ball.row - radius, ball.row + radius) {
            let height = (self.top + row) as f32 + 0.5;
            let dy = height - ball.row;
            // What Pythagoras leaves for the other two directions.
            let left = (radius * radius - dy * dy).max(0.0);
            let half = left.sqrt();
            for column in between(ball.column - half, ball.column + half, self.columns) {
                let at = row * self.columns + column;
                // Behind something that is nearer than the whole ball. Most rays of the balls inside end here.
                if self.nearness[at] >= foremost {
                    continue;
                }

                let across = column as f32 + 0.5;
                let dx = across - ball.column;
                let bulge = (left - dx * dx).max(0.0).sqrt();
                let mut near = ball.near + bulge;
                let mut face = 0;
                if let Some(signs) = signs {
                    let opening = projection.opening(signs, across, height);
                    // If the near side of the sphere lies in the octant, it is cut away. Otherwise it is seen.
                    if opening.far < near && near < opening.near {
                        // If the far side lies in the octant as well, the ray does not meet the ball.
                        if ball.near - bulge >= opening.far {
                            continue;
                        }
                        (near, face) = (opening.far, 1 + opening.far_axis as u32);
                    }
                }
                if near > self.nearness[at] {
                    self.nearness[at] = near;
                    self.surfaces[at] = 4 * ball.index + face;
                }
            }
        }
    }

    /// Adds the visible part of an edge, which is a line of some width.
    pub fn draw(&mut self, edge: &Edge) {
        let [[x0, y0, _], [x1, y1, _]] = edge.ends;
        let [along_x, along_y] = [x1 - x0, y1 - y0];
        let length = (along_x * along_x + along_y * along_y)
            .sqrt()
            .max(f32::EPSILON);
        let half = edge.width / 2.0;
        let code = if edge.is_notch { NOTCH } else { BORDER };

        for row in self.rows_between(y0.min(y1) - half, y0.max(y1) + half) {
            let height = (self.top + row) as f32 + 0.5;
            // In a row the line is a piece around the place at which it crosses; a line that is nearly level has no such
            // place, and is bounded by its ends.
            let reach = half * length / along_y.abs().max(f32::EPSILON);
            let middle = x0 + (height - y0) * along_x / nonzero(along_y);
            let from = (middle - reach).max(x0.min(x1) - half);
            let to = (middle + reach).min(x0.max(x1) + half);
            for column in between(from, to, self.columns) {
                let [dx, dy] = [column as f32 + 0.5 - x0, height - y0];
                let share = ((dx * along_x + dy * along_y) / (length * length)).clamp(0.0, 1.0);
                let near = edge.ends[0][2] + share * (edge.ends[1][2] - edge.ends[0][2]);
                let at = row * self.columns + column;
                // The lift only decides whether the edge is seen. The nearness that is kept is that of the edge itself.
                if near + edge.lift > self.nearness[at] {
                    self.nearness[at] = near;
                    self.surfaces[at] = code;
                }
            }
        }
    }

    /// Returns what a ray of the band meets, and how near.
    pub fn at(&self, row: usize, column: usize) -> (Surface, f32) {
        let at = row * self.columns + column;
        let surface = match self.surfaces[at] {
            GROUND => Surface::Ground,
            BORDER => Surface::Border,
            NOTCH => Surface::Notch,
            // The two low bits are 0 for the sphere, and one more than the axis for a face.
            code => match (code / 4, code % 4) {
                (index, 0) => Surface::Sphere(index),
                (index, face) => Surface::Face(index, face as usize - 1),
            },
        };
        (surface, self.nearness[at])
    }
}

/// Returns a number that is not 0, for a division.
fn nonzero(value: f32) -> f32 {
    if value == 0.0 { f32::EPSILON } else { value }
}

/// Returns the cells of a line of `count` whose middles lie between two places.
fn between(from: f32, to: f32, count: usize) -> std::ops::Range<usize> {
    // The middle of cell i lies at i + 0.5. A cast of a negative number gives 0.
    let first = (from - 0.5).ceil().max(0.0) as usize;
    let end = (to - 0.5).floor() + 1.0;
    first..(end.max(0.0) as usize).min(count)
}
