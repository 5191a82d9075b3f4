//! The parallel projection: from places of the box to columns, rows and nearness, all three in rays, so that a ball is a ball there,
//! too.

use super::{OrbitSet, OrbitView};

/// The share of the picture that the box fills at a magnification of 1. The rest is a margin, which was chosen by eye.
const FILLED: f64 = 0.94;
/// The slopes of the plane across an axis are divided by the axis's part towards the eye. If the plane is seen edge-on,
/// that part is 0, and this number stands for it. The plane then passes the whole depth of the box within a small part
/// of a pixel.
const LEAST_TOWARDS: f64 = 1e-6;

/// A ball in the picture. Lengths are in rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedBall {
    /// The column of its middle, from the left edge of the picture.
    pub column: f32,
    /// The row of its middle, from the upper edge.
    pub row: f32,
    /// How much nearer to the eye its middle is than that of the box.
    pub near: f32,
    /// Its number in the set.
    pub index: u32,
    /// Whether the cut goes through it.
    pub is_cut: bool,
}

/// How places of the box lie in the picture.
pub(super) struct Projection {
    /// The directions to the right, upwards and towards the eye.
    axes: [[f64; 3]; 3],
    /// The middle of the box.
    middle: [f64; 3],
    /// Rays to a user unit.
    scale: f64,
    /// Column and row of the middle of the picture.
    center: [f64; 2],
    /// The radius of balls, in rays.
    pub radius: f32,
    /// The greatest nearness of a corner of the box, in rays.
    pub depth: f32,
    /// For each axis, the plane across it through the middle of the box: how much its nearness grows from column to
    /// column, and from row to row.
    slopes: [[f32; 2]; 3],
}

impl Projection {
    pub fn new(set: &OrbitSet<'_>, view: OrbitView, size: [u32; 2], rays: usize) -> Self {
        let axes = view.axes();
        let [right, up, eye] = axes;

        let ball = set.radius / 2.0;
        let half = set.size.map(|side| side / 2.0);
        // The box reaches to the side by half of the diagonal of its base at most. This bound counts for all azimuths,
        // so that a turn keeps its scale.
        let half_diagonal = (half[0] * half[0] + half[1] * half[1]).sqrt();
        // The picture shows a vertical length times the cosine of the elevation, `up[2]`. A horizontal length reaches
        // upwards by itself times the elevation's sine, `eye[2]`, at most.
        let reach = [
            half_diagonal + ball,
            eye[2].abs() * half_diagonal + up[2] * half[2] + ball,
        ];
        let fits = |axis: usize| f64::from(size[axis]) / 2.0 / reach[axis];
        let scale = FILLED * view.zoom * fits(0).min(fits(1)) * rays as f64;

        let depth: f64 = (0..3).map(|axis| eye[axis].abs() * half[axis]).sum();
        let slopes = [0, 1, 2].map(|axis: usize| {
            let towards: f64 = eye[axis];
            // A plane that is seen edge-on has no nearness. A steep plane stands for it, which is nearer than all
            // balls on one side of the edge and farther than all balls on the other.
            let towards = if towards.abs() < LEAST_TOWARDS {
                LEAST_TOWARDS.copysign(towards)
            } else {
                towards
            };
            // From the middle of the picture the plane is right * column - up * row + eye * nearness = 0: rows are
            // counted downwards.
            [(-right[axis] / towards) as f32, (up[axis] / towards) as f32]
        });

        Self {
            axes,
            middle: half,
            scale,
            center: size.map(|side| f64::from(side) * rays as f64 / 2.0),
            radius: (ball * scale) as f32,
            depth: (depth * scale) as f32,
            slopes,
        }
    }

    /// Returns column, row and nearness of a place.
    pub fn of(&self, place: [f64; 3]) -> [f32; 3] {
        let [right, up, near] = self.axes.map(|axis| {
            let along = |k: usize| axis[k] * (place[k] - self.middle[k]);
            (along(0) + along(1) + along(2)) * self.scale
        });
        // Rows are counted downwards.
        let [column, row] = [self.center[0] + right, self.center[1] - up];
        [column as f32, row as f32, near as f32]
    }

    /// Returns the longer side of the picture, in rays.
    pub fn longer_side(&self) -> f32 {
        // The middle lies at half of each side.
        (2.0 * self.center[0].max(self.center[1])) as f32
    }

    /// Returns 1 if an axis of the box leads towards the eye, and -1 otherwise. An axis across the view has the sign of its
    /// 0, as in `slopes`.
    pub fn towards_eye(&self, axis: usize) -> f32 {
        1.0_f32.copysign(self.axes[2][axis] as f32)
    }

    /// Returns a direction of the box in the picture: to the right, upwards and towards the eye.
    pub fn direction(&self, axis: usize) -> [f32; 3] {
        self.axes.map(|own| own[axis] as f32)
    }

    /// Returns the balls that are not cut away, the nearest first.
    pub fn place(&self, set: &OrbitSet<'_>, open: Option<[f64; 3]>) -> Vec<PlacedBall> {
        let ball = set.radius / 2.0;
        let mut placed = Vec::with_capacity(set.points.len());
        for (index, &point) in set.points.iter().enumerate() {
            let mut is_cut = false;
            if let Some(signs) = open {
                let inwards = [0, 1, 2].map(|axis| signs[axis] * (point[axis] - self.middle[axis]));
                // A ball within the octant is cut away; one that reaches into it across all three planes may be cut.
                if inwards.iter().all(|&along| along >= ball) {
                    continue;
                }
                is_cut = inwards.iter().all(|&along| along > -ball);
            }

            let [column, row, near] = self.of(point);
            placed.push(PlacedBall {
                column,
                row,
                near,
                index: index as u32,
                is_cut,
            });
        }
        // Balls of equal nearness keep their order, so that the picture does not depend on the sort.
        placed.sort_by(|a, b| b.near.total_cmp(&a.near));
        placed
    }

    /// Returns the part of a ray that lies in the open octant, by nearness, and the axis of the plane at its far end.
    /// The part is empty where its near end is not above its far end.
    pub fn opening(&self, signs: [f64; 3], column: f32, row: f32) -> Opening {
        let x = column - self.center[0] as f32;
        let y = row - self.center[1] as f32;
        let mut opening = Opening {
            far: f32::NEG_INFINITY,
            near: f32::INFINITY,
            far_axis: 0,
        };
        for (axis, [along_x, along_y]) in self.slopes.into_iter().enumerate() {
            let plane = along_x * x + along_y * y;
            // The octant lies on the eye's side of a plane, or behind it where the set was turned since it was cut.
            if signs[axis] * f64::from(self.towards_eye(axis)) > 0.0 {
                if plane > opening.far {
                    (opening.far, opening.far_axis) = (plane, axis);
                }
            } else {
                opening.near = opening.near.min(plane);
            }
        }
        opening
    }
}

/// The part of a ray in the open octant.
pub(super) struct Opening {
    /// The nearness at which it ends, going away from the eye.
    pub far: f32,
    /// The nearness at which it begins.
    pub near: f32,
    /// The axis that the plane at the far end is across.
    pub far_axis: usize,
}
