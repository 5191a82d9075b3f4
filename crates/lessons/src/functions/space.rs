//! What expressions ask of a set in space and of the plane through it. Places [x, y] lie in the plane. Begin with
//! [`Now::plane`].

use rhai::Dynamic;
use tilescope_analysis::measures::SetNumber;
use tilescope_core::{Point, R, SolidDomain};

use super::{Found, Now, SET, id, lock, sample_or_unit, wrong};
use crate::sets::{PointSet, radii};

/// Why an expression has no value in the plane.
const PLANAR: &str = "this is asked of sets in space: the run of the step has no \"depth: ...\"";

/// Returns a number of the set of a box, of those that need no pass over the samples.
pub(super) fn number(set: &PointSet, domain: &SolidDomain, asked: &SetNumber) -> Found<f64> {
    let count = set.points.len() as f64;
    match asked.key {
        "count" => Ok(count),
        "density" => Ok(count / domain.volume_radii()),
        key => Err(wrong(format!(
            "of a set in space \"count\" and \"density\" are measured here, not \"{key}\""
        ))),
    }
}

impl Now {
    /// Returns where the plane lies along the third axis, in lattice units: where it was put, otherwise where the last event
    /// with a place happened, and before the first one in the middle. Of a planar set 0.
    pub(crate) fn plane(&self) -> i32 {
        let put = *lock(&self.plane);
        let followed = || self.recording.height_before(self.cursor());
        let middle = || self.recording.domain_in_space().map(|it| it.sides()[2] / 2);
        put.or_else(followed).or_else(middle).unwrap_or(0)
    }

    /// Puts the plane to a height, in lattice units, where it stays; or has it follow the events.
    pub(crate) fn put_plane(&self, to: Option<i32>) {
        *lock(&self.plane) = to;
    }

    fn box_of(&self) -> Found<SolidDomain> {
        self.recording
            .domain_in_space()
            .ok_or_else(|| wrong(PLANAR))
    }

    /// Returns how far a sample lies above the plane, in r; below it, less than 0.
    pub(crate) fn above(&self, s: i64) -> Found<f64> {
        self.box_of()?;
        let above = self.recording.above(id(s), self.plane());
        Ok(above.map_or(f64::NAN, radii))
    }

    /// Returns the radius of the disk in which the plane cuts the ball of a sample, in r; 0 where it does not cut it.
    pub(super) fn disk(&self, s: i64) -> Found<f64> {
        // By Pythagoras; a sample farther than r from the plane has the root of a number below 0.
        Ok((1.0 - self.above(s)?.powi(2)).max(0.0).sqrt())
    }

    /// Returns how far a sample is in space from a place of the plane, in r.
    pub(super) fn far_in_space(&self, s: i64, at: [f64; 2]) -> Found<f64> {
        Ok(self.far(s, at)?.hypot(self.above(s)?))
    }

    /// Returns the k-th nearest, from 0, of the valid samples whose balls the plane cuts, seen along the third axis
    /// from a place; `()` if there are too few of these samples, or if `k` is below 0.
    pub(super) fn dot(&self, at: [f64; 2], k: i64) -> Found<Dynamic> {
        self.box_of()?;
        let set = self.set()?;
        let all = set.ids.iter().zip(&set.points);
        let cut = all.filter(|(sample, _)| {
            let above = self.above(i64::from(**sample));
            above.is_ok_and(|z| z.abs() <= 1.0)
        });

        let mut near: Vec<(f64, u32)> = cut
            .map(|(&sample, &point)| (set.distance(point, at), sample))
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let found = usize::try_from(k).ok().and_then(|k| near.get(k));
        Ok(sample_or_unit(found.map(|&(_, sample)| sample)))
    }

    /// Returns how far two samples are apart, seen along the third axis, in r.
    pub(super) fn dots_apart(&self, s: i64, t: i64) -> Found<f64> {
        match self.point(t) {
            Some(at) => self.far(s, at),
            None => Ok(f64::NAN),
        }
    }

    /// Returns whether the ball of a valid sample holds a place of the plane.
    pub(super) fn covers_in_space(&self, at: Point) -> bool {
        let covering = self
            .recording
            .covering_in_space(at, self.plane(), self.cursor());
        covering.is_some()
    }

    /// Returns the valid samples within r of a place, seen along the third axis, each with the lowest and the highest place of its ball
    /// straight above or below it, in r above the plane.
    fn along(&self, at: [f64; 2]) -> Found<Vec<(u32, [f64; 2])>> {
        self.box_of()?;
        let set = self.set()?;
        let seen = set.ids.iter().zip(&set.points);
        let chords = seen.filter_map(|(&sample, &point)| {
            let half = (1.0 - set.distance(point, at).powi(2)).sqrt();
            let above = self.above(i64::from(sample)).ok()?;
            // The root of a number below 0 is no number: the line does not meet the ball.
            (half >= 0.0).then_some((sample, [above - half, above + half]))
        });
        Ok(chords.collect())
    }

    /// Returns the first ball that the plane meets at a place when it rises, by its sample and how far it rises until then, in
    /// r; `None` where there is none.
    fn ball_above(&self, at: [f64; 2]) -> Found<Option<(u32, f64)>> {
        let balls = self.along(at)?.into_iter();
        let ahead = balls.filter(|(_, [_, highest])| *highest >= 0.0);
        // In a ball that it is in already the plane rises by nothing.
        let rises = ahead.map(|(sample, [lowest, _])| (sample, lowest.max(0.0)));
        Ok(rises.min_by(|a, b| a.1.total_cmp(&b.1)))
    }

    /// Returns how far the plane can rise until a ball covers a place of it, in r.
    pub(super) fn clear_above(&self, at: [f64; 2]) -> Found<f64> {
        let first = self.ball_above(at)?;
        first
            .map(|(_, rise)| rise)
            .ok_or_else(|| wrong("no ball lies above this place"))
    }

    /// Returns the sample of that ball, or `()`.
    pub(super) fn first_above(&self, at: [f64; 2]) -> Found<Dynamic> {
        let first = self.ball_above(at)?;
        Ok(sample_or_unit(first.map(|(sample, _)| sample)))
    }

    /// Returns the valid samples at most this far above or below the plane, in r, by their projections.
    fn layer(&self, t: f64) -> Found<Vec<Point>> {
        self.box_of()?;
        let set = self.set()?;
        let ids = set.ids.iter();
        let near = ids.filter(|&&sample| self.above(sample.into()).is_ok_and(|z| z.abs() <= t));
        Ok(near
            .filter_map(|&sample| self.recording.point(sample))
            .collect())
    }

    /// Returns how many of the places that stand for the plane, 128 x 128, are farther than r from all valid samples that lie at most `t`
    /// r above or below it, in space.
    pub(super) fn open_within(&self, t: f64) -> Found<i64> {
        self.box_of()?;
        self.spend(SET)?;
        let (plane, cursor) = (self.plane(), self.cursor());
        let is_near = |&sample: &u32| {
            let is_valid = self.recording.status(sample, cursor).is_valid();
            is_valid && self.above(sample.into()).is_ok_and(|z| z.abs() <= t)
        };
        let is_open = |at: &Point| {
            let covering = self.recording.ever_covering_in_space(*at, plane);
            !covering.iter().any(is_near)
        };
        Ok(self.places().filter(is_open).count() as i64)
    }

    /// Returns how many pairs of valid samples at most `t` r above or below the plane are closer than r, seen along the third axis.
    pub(super) fn close_pairs(&self, t: f64) -> Found<i64> {
        self.spend(SET)?;
        let (domain, layer) = (self.recording.domain(), self.layer(t)?);
        let limit = i64::from(R) * i64::from(R);
        let of_one = |(index, &at): (usize, &Point)| {
            let earlier = layer[..index].iter();
            earlier
                .filter(|&&other| domain.distance_squared(at, other) < limit)
                .count()
        };
        Ok(layer.iter().enumerate().map(of_one).sum::<usize>() as i64)
    }

    /// Returns the side of the active cubes of the current throw and where the lowest place of each lies along the third axis, in units.
    fn cubes(&self) -> Found<(i32, &[i32])> {
        self.box_of()?;
        let throw = self.recording.context(self.cursor()).iteration as usize;
        let throw = throw.checked_sub(1);
        let cells = throw.and_then(|throw| self.recording.run().iterations.get(throw));
        let side = cells
            .and_then(|throw| throw.cells.first())
            .map(|cell| cell.side);
        let lowest = throw.and_then(|throw| self.recording.active_cubes().get(throw));
        match side.zip(lowest) {
            Some((side, lowest)) => Ok((side, lowest)),
            None => Err(wrong("no cubes are active at this moment")),
        }
    }

    /// Returns how many cubes are active in the current throw.
    pub(super) fn active_cubes(&self) -> Found<i64> {
        Ok(self.cubes()?.1.len() as i64)
    }

    /// Returns the side of the active cubes of the current throw, in r.
    pub(super) fn cube_side(&self) -> Found<f64> {
        Ok(radii(self.cubes()?.0))
    }

    /// Returns how many of them the plane cuts.
    pub(super) fn cubes_in_plane(&self) -> Found<i64> {
        let (side, lowest) = self.cubes()?;
        let depth = self.box_of()?.sides()[2];
        let plane = self.plane();
        // The upper end of a periodic box is the image of its lower end. In a bounded one no cube begins there either.
        let plane = if plane == depth { 0 } else { plane };
        let holds = |low: &&i32| (**low..**low + side).contains(&plane);
        Ok(lowest.iter().filter(holds).count() as i64)
    }

    /// Returns of how many in a hundred planes, all heights alike, at least one active cube of the current throw is cut.
    pub(super) fn planes_cut(&self) -> Found<f64> {
        let (side, lowest) = self.cubes()?;
        let mut lowest = lowest.to_vec();
        // Cubes lie on multiples of their side, so that two of them share all heights or none.
        lowest.sort_unstable();
        lowest.dedup();
        let depth = f64::from(self.box_of()?.sides()[2]);
        let cut = lowest
            .iter()
            .map(|low| f64::from(side).min(depth - f64::from(*low)));
        Ok(100.0 * cut.sum::<f64>() / depth)
    }
}
