//! The second judge of sets in space: covered circles.
//!
//! Balls cover a box exactly if they and the six half-spaces beyond its faces cover all of space. That is so if of every
//! circle in which two spheres meet, or a sphere and a face, each place lies inside a third ball or half-space, each edge
//! is covered, and each sphere meets another or a face.
//!
//! *Proof.* Let a place of the closed box be in no open ball, and look at the boundary of the set of such places. If a sphere
//! has a part in it, that part is closed. It is not the whole sphere, which meets another surface: of a circle in which they
//! meet each place is covered. So it has an end on the sphere, and there another surface passes: the end lies on a circle,
//! and is not covered, against the assumption. If only faces have a part in it, the same argument ends on a circle or on
//! an edge. If nothing has, no place of the box is covered, and neither are its edges.
//!
//! It shares nothing with [`super::cubes`] and [`super::pairs`], which look for other things in other structures.

use std::f64::consts::TAU;
use std::ops::Range;

use rayon::prelude::*;

use crate::monitor::Monitor;

use super::error::SolidError;
use super::region::SolidRegion;
use super::{MAX_PLACES, SolidQuestion};

/// By how much rounding may make an arc longer or a ball wider, relative to the radius: a thousand times what it does.
const MARGIN: f64 = 1e-12;

/// Samples that a thread works on at a time.
const CHUNK: usize = 256;

/// Chunks between two questions to the caller.
const CHUNKS: usize = 64;

/// What the judge found in a set without conflicts.
pub(super) struct CirclesFound {
    pub min_distance: f64,
    /// Number of circles, edges and single spheres with a place that no ball covers.
    pub exposed: u64,
    /// Such a place of each of the first ones.
    pub places: Vec<[f64; 3]>,
}

impl CirclesFound {
    const fn new() -> Self {
        Self {
            min_distance: f64::INFINITY,
            exposed: 0,
            places: Vec::new(),
        }
    }

    fn add(&mut self, place: [f64; 3]) {
        self.exposed += 1;
        if self.places.len() < MAX_PLACES {
            self.places.push(place);
        }
    }

    fn merge(&mut self, other: Self) {
        self.min_distance = self.min_distance.min(other.min_distance);
        self.exposed += other.exposed;
        self.places.extend(other.places);
        self.places.truncate(MAX_PLACES);
    }
}

/// Looks for places that no open ball of the limit covers. `None` stands for a set that this judge declines: two
/// samples are in conflict, or there are several samples and no ball meets another one, or there are too few samples to
/// cover so large a region.
pub(super) fn search(
    question: &SolidQuestion<'_>,
    monitor: &Monitor<'_>,
) -> Result<Option<CirclesFound>, SolidError> {
    let &SolidQuestion {
        points,
        ref region,
        radius,
        ..
    } = question;
    // If the first judge shows no gap, all places are within this distance of a sample. With a smaller one, this judge
    // could see a gap that the first judge does not show.
    let limit = question.bound();
    let Some(neighbours) = Neighbours::new(points, region, 2.0 * limit) else {
        return Ok(None);
    };

    let of_chunk = |indices: Range<usize>| {
        let mut found = CirclesFound::new();
        let mut near = Vec::new();
        for index in indices {
            neighbours.list(index, &mut near);
            let distances = near.iter().map(|other| other.distance);
            found.min_distance = distances.fold(found.min_distance, f64::min);
            // A set with conflicts is declined below: where spheres nearly coincide, rounding decides what they cover
            // of each other.
            if found.min_distance < radius {
                break;
            }
            let sphere = Sphere {
                index,
                center: points[index],
                limit,
                region,
                near: &near,
            };
            sphere.add_exposed(&mut found);
        }
        found
    };

    let mut all = CirclesFound::new();
    let count = points.len();
    for batch in (0..count).step_by(CHUNK * CHUNKS) {
        let end = count.min(batch + CHUNK * CHUNKS);
        let starts = (batch..end).into_par_iter().step_by(CHUNK);
        let chunks = starts.map(|start| of_chunk(start..end.min(start + CHUNK)));
        let found: Vec<CirclesFound> = chunks.collect();
        for found in found {
            all.merge(found);
        }
        monitor.advance((end - batch) as u64)?;
        if all.min_distance < radius {
            return Ok(None);
        }
    }

    // Only pairs whose balls meet were compared. If no balls meet, the nearest pair was not seen, and its distance is
    // unknown. A single sample has no pair that could be missed.
    if all.min_distance.is_infinite() && count > 1 {
        return Ok(None);
    }

    if region.is_periodic() {
        // A sample and its own image are the shortest period apart.
        all.min_distance = all.min_distance.min(region.shortest());
    } else {
        add_bare_edges(points, region, limit, &mut all);
    }
    Ok(Some(all))
}

/// A sample near another, or an image of one.
#[derive(Clone, Copy)]
struct Other {
    index: usize,
    offset: [f64; 3],
    distance: f64,
}

/// Samples in cells at least as wide as the reach, linked cell by cell.
struct Neighbours<'a> {
    points: &'a [[f64; 3]],
    region: &'a SolidRegion,
    reach: f64,
    counts: [usize; 3],
    /// The first sample of each cell, and the next one of each sample.
    heads: Vec<u32>,
    next: Vec<u32>,
}

/// No sample: there are fewer than 2^32.
const NOTHING: u32 = u32::MAX;

impl<'a> Neighbours<'a> {
    /// Sorts samples into cells, none narrower than `reach`. `None` if there are over 64 more cells than samples.
    fn new(points: &'a [[f64; 3]], region: &'a SolidRegion, reach: f64) -> Option<Self> {
        // A hair wider, so that rounding moves no sample two cells away.
        let fitting = region
            .size()
            .map(|extent| (0.999 * extent / reach).max(1.0));
        // A cell has the volume of nearly two balls, so that a set whose balls cover the region has more samples than
        // cells of that size. The 64, chosen, not measured, let a set of a few samples have a large region.
        if fitting.iter().product::<f64>() > 64.0 + points.len() as f64 {
            return None;
        }

        let counts = fitting.map(|count| count as usize);
        let mut found = Self {
            points,
            region,
            reach,
            counts,
            heads: vec![NOTHING; counts.iter().product()],
            next: vec![NOTHING; points.len()],
        };
        for (index, &point) in points.iter().enumerate() {
            let cell = found.number(found.cell(point));
            found.next[index] = std::mem::replace(&mut found.heads[cell], index as u32);
        }
        Some(found)
    }

    /// Returns the cell of a place, by its index along each axis.
    fn cell(&self, point: [f64; 3]) -> [usize; 3] {
        let size = self.region.size();
        [0, 1, 2].map(|axis| {
            let cell = (point[axis] / size[axis] * self.counts[axis] as f64) as usize;
            cell.min(self.counts[axis] - 1)
        })
    }

    const fn number(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    /// Lists all other samples, and images of these, that are nearer than the reach to the sample `index`.
    fn list(&self, index: usize, near: &mut Vec<Other>) {
        near.clear();
        let center = self.points[index];
        let home = self.cell(center);
        let [columns, rows, planes] = [0, 1, 2].map(|axis| self.beside(home[axis], axis));
        for &z in &planes {
            for (&y, &x) in rows
                .iter()
                .flat_map(|y| columns.iter().map(move |x| (y, x)))
            {
                let mut other = self.heads[self.number([x, y, z])];
                while other != NOTHING {
                    self.add_images(index, other as usize, near);
                    other = self.next[other as usize];
                }
            }
        }
    }

    /// Returns the cells beside one on an axis, and itself, each once.
    fn beside(&self, cell: usize, axis: usize) -> Vec<usize> {
        let count = self.counts[axis];
        if count <= 3 {
            return (0..count).collect();
        }
        // `count` is added to all numbers, so that none is below 0, and taken off by the remainder below.
        let around = cell + count - 1..=cell + count + 1;
        let is_inside = |at: &usize| self.region.is_periodic() || (count..2 * count).contains(at);
        around.filter(is_inside).map(|at| at % count).collect()
    }

    /// Appends a sample `index` as seen from the sample `own`, and each of its images, if it is nearer than the reach.
    fn add_images(&self, own: usize, index: usize, near: &mut Vec<Other>) {
        let (center, size) = (self.points[own], self.region.size());
        // A period is longer than the reach, or the set was refused. So on an axis only two images can be near: the
        // sample itself, and the one a period closer, which lies on the other side of `own`.
        let offsets = [0, 1, 2].map(|axis| {
            let plain = self.points[index][axis] - center[axis];
            let image = plain - size[axis].copysign(plain);
            let wraps = self.region.is_periodic();
            [Some(plain), wraps.then_some(image)].into_iter().flatten()
        });

        let [columns, rows, planes] = offsets;
        for (y, z) in planes.flat_map(|z| rows.clone().map(move |y| (y, z))) {
            for offset in columns.clone().map(|x| [x, y, z]) {
                let distance = dot(offset, offset).sqrt();
                // A sample is not near itself, and its own images are a period away, beyond the reach.
                if distance < self.reach && index != own {
                    near.push(Other {
                        index,
                        offset,
                        distance,
                    });
                }
            }
        }
    }
}

/// A plane beyond which nothing has to be covered, as seen from a sample.
#[derive(Clone, Copy)]
struct Face {
    /// The direction away from the region, of length 1.
    normal: [f64; 3],
    distance: f64,
}

/// A circle in which a sphere meets another surface.
struct Circle {
    middle: [f64; 3],
    radius: f64,
    /// Two directions of its plane, at right angles.
    along: [f64; 3],
    across: [f64; 3],
}

impl Circle {
    /// Returns the circle in which a plane cuts a sphere of radius `limit`. The plane is `distance` from the sphere's
    /// center, less than the limit, at right angles to a direction of length 1.
    fn of_sphere(limit: f64, direction: [f64; 3], distance: f64) -> Self {
        // An axis far from the direction, so that the product is long: of a direction whose x is 0.6 or more, y is at
        // most 0.8.
        let axis = if direction[0].abs() < 0.6 {
            [1.0, 0.0, 0.0]
        } else {
            [0.0, 1.0, 0.0]
        };
        let product = cross(direction, axis);
        let length = dot(product, product).sqrt();
        let along = product.map(|value| value / length);
        Self {
            middle: direction.map(|value| value * distance),
            radius: (limit * limit - distance * distance).sqrt(),
            along,
            across: cross(direction, along),
        }
    }

    /// Returns how far the angles reach in a direction, and the angle that reaches farthest.
    fn reach(&self, direction: [f64; 3]) -> (f64, f64) {
        let (x, y) = (dot(direction, self.along), dot(direction, self.across));
        (self.radius * x.hypot(y), y.atan2(x))
    }

    /// Returns what an open ball of radius `limit` around a place covers.
    fn share_of_ball(&self, place: [f64; 3], limit: f64) -> Share {
        let apart = [0, 1, 2].map(|axis| place[axis] - self.middle[axis]);
        let (reach, angle) = self.reach(apart);
        let squares = dot(apart, apart) + self.radius * self.radius - limit * limit;
        Share::above(squares / 2.0 + MARGIN * limit * limit, reach, angle)
    }

    /// Returns the share of the circle that lies beyond a face.
    fn share_beyond(&self, face: &Face, limit: f64) -> Share {
        let (reach, angle) = self.reach(face.normal);
        let least = face.distance - dot(face.normal, self.middle);
        Share::above(least + MARGIN * limit, reach, angle)
    }

    /// Returns the place of the circle at an angle.
    fn place(&self, angle: f64) -> [f64; 3] {
        let (sine, cosine) = angle.sin_cos();
        [0, 1, 2].map(|axis| {
            let aside = self.along[axis] * cosine + self.across[axis] * sine;
            self.middle[axis] + self.radius * aside
        })
    }
}

/// What a ball or a half-space covers of a circle.
enum Share {
    Nothing,
    Everything,
    /// The angles between two.
    Arc([f64; 2]),
}

impl Share {
    /// Returns the angles t with `reach * cos(t - middle) > least`, a little fewer.
    fn above(least: f64, reach: f64, middle: f64) -> Self {
        if least >= reach {
            return Self::Nothing;
        }
        if least <= -reach {
            return Self::Everything;
        }
        let half = (least / reach).acos() - MARGIN;
        Self::Arc([middle - half, middle + half])
    }
}

/// A sample's sphere, with all samples near enough to cover a place of it.
struct Sphere<'a> {
    index: usize,
    center: [f64; 3],
    limit: f64,
    region: &'a SolidRegion,
    near: &'a [Other],
}

impl Sphere<'_> {
    /// Adds a place of each circle that is not covered, and of the sphere if it has no circles.
    fn add_exposed(&self, found: &mut CirclesFound) {
        let faces = self.faces();
        // A sphere that meets no other one and no face lies in the region and is bare all over: any place of it serves.
        let faces_met = || faces.iter().filter(|face| face.distance < self.limit);
        if self.near.is_empty() && faces_met().next().is_none() {
            found.add(self.place_at([0.0, 0.0, self.limit]));
            return;
        }

        let mut arcs = Vec::new();
        // The circle of two samples is examined once, from the sample of the lower index.
        for other in self.near.iter().filter(|other| other.index > self.index) {
            let direction = other.offset.map(|value| value / other.distance);
            let circle = Circle::of_sphere(self.limit, direction, other.distance / 2.0);
            // The other ball is known by its offset. By its index its images would be left out as well, and they may
            // cover a part of the circle.
            let thirds = self
                .near
                .iter()
                .filter(|third| third.offset != other.offset);
            let balls = thirds.map(|third| circle.share_of_ball(third.offset, self.limit));
            let beyond = faces
                .iter()
                .map(|face| circle.share_beyond(face, self.limit));
            if let Some(angle) = bare_angle(balls.chain(beyond), &mut arcs) {
                found.add(self.place_at(circle.place(angle)));
            }
        }
        // On a face the sphere's circle is bare unless balls or the half-spaces beyond other faces cover it.
        for face in faces_met() {
            let circle = Circle::of_sphere(self.limit, face.normal, face.distance);
            let near = self.near.iter();
            let balls = near.map(|other| circle.share_of_ball(other.offset, self.limit));
            let others = faces.iter().filter(|other| other.normal != face.normal);
            let beyond = others.map(|other| circle.share_beyond(other, self.limit));
            if let Some(angle) = bare_angle(balls.chain(beyond), &mut arcs) {
                found.add(self.place_at(circle.place(angle)));
            }
        }
    }

    /// Returns the faces of a bounded region; a periodic one has none.
    fn faces(&self) -> Vec<Face> {
        if self.region.is_periodic() {
            return Vec::new();
        }
        let size = self.region.size();
        let of_axis = |axis: usize| {
            let ends = [
                (-1.0, self.center[axis]),
                (1.0, size[axis] - self.center[axis]),
            ];
            ends.map(|(outward, distance)| {
                let mut normal = [0.0; 3];
                normal[axis] = outward;
                Face { normal, distance }
            })
        };
        [of_axis(0), of_axis(1), of_axis(2)].concat()
    }

    /// Returns the place of the region at an offset from the center.
    fn place_at(&self, offset: [f64; 3]) -> [f64; 3] {
        let size = self.region.size();
        [0, 1, 2].map(|axis| {
            let (value, extent) = (self.center[axis] + offset[axis], size[axis]);
            if !self.region.is_periodic() {
                return value.clamp(0.0, extent);
            }
            let wrapped = value.rem_euclid(extent);
            // A hair below 0 is rounded to the far side.
            if wrapped < extent { wrapped } else { 0.0 }
        })
    }
}

/// Returns an angle of a circle that no share covers. `arcs` is a buffer.
fn bare_angle(shares: impl Iterator<Item = Share>, arcs: &mut Vec<[f64; 2]>) -> Option<f64> {
    arcs.clear();
    for share in shares {
        match share {
            Share::Nothing => {}
            Share::Everything => return None,
            // An arc begins at -TAU or later and ends at TAU or before: of it and its copy a turn on, the parts from 0
            // to TAU are the whole arc.
            Share::Arc([from, to]) => arcs.extend([[from, to], [from + TAU, to + TAU]]),
        }
    }
    bare(arcs, TAU)
}

/// Returns the least value from 0 to `end` that lies in none of some open intervals, if there is one.
fn bare(intervals: &mut [[f64; 2]], end: f64) -> Option<f64> {
    intervals.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    let mut reached = 0.0;
    for &[from, to] in intervals.iter() {
        if from >= reached {
            break;
        }
        reached = to.max(reached);
    }
    (reached <= end).then_some(reached)
}

/// Adds a place of each edge of a bounded region that is not covered.
fn add_bare_edges(points: &[[f64; 3]], region: &SolidRegion, limit: f64, found: &mut CirclesFound) {
    let size = region.size();
    for edge in 0..12 {
        // Four edges lie along each axis: the two bits of `side` say at which end of each of the other two axes.
        let (axis, side) = (edge / 4, edge % 4);
        let [first, second] = [(axis + 1) % 3, (axis + 2) % 3];
        let mut corner = [0.0; 3];
        corner[first] = size[first] * f64::from(side as u8 & 1);
        corner[second] = size[second] * f64::from(side as u8 >> 1);

        // Returns the interval of the edge's line that a ball covers.
        let interval = |point: &[f64; 3]| {
            let aside = [first, second].map(|axis| point[axis] - corner[axis]);
            let squared = limit * limit - aside[0] * aside[0] - aside[1] * aside[1];
            let half = squared.max(0.0).sqrt() - MARGIN * limit;
            (half > 0.0).then(|| [point[axis] - half, point[axis] + half])
        };
        let mut intervals: Vec<[f64; 2]> = points.iter().filter_map(interval).collect();
        if let Some(value) = bare(&mut intervals, size[axis]) {
            corner[axis] = value;
            found.add(corner);
        }
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
