//! Test sets, and the truth about small sets by slow direct computation, with which the verifier is compared. A maximal
//! sampler after Ebeida et al. 2012 and brute-force searches over all triples. The truth uses neither the
//! verifier nor any structure beyond a list and a plain grid.

#![allow(dead_code, missing_docs, reason = "the example uses a part of it")]

pub mod changes;
pub mod sets;

use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec2;
use tilescope_analysis::measures::MeasureError;
use tilescope_analysis::{Boundary, Progress, Region, Report, VerifyError, VerifyOptions, verify};

pub const BOTH: [Boundary; 2] = [Boundary::Periodic, Boundary::Bounded];

/// The control function that cancels nothing.
pub fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

pub fn region(width: f64, height: f64, boundary: Boundary) -> Region {
    Region {
        width,
        height,
        boundary,
    }
}

/// The verdict with default options.
pub fn judge(points: &[[f64; 2]], region: Region, radius: f64) -> Result<Report, VerifyError> {
    verify(points, region, radius, &VerifyOptions::default(), &go_on)
}

/// Does some work on a pool of so many threads.
pub fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("a pool").install(work)
}

/// A small generator (xorshift64*), so that sets are the same everywhere and forever.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn points(&mut self, count: usize, region: Region) -> Vec<[f64; 2]> {
        (0..count)
            .map(|_| {
                [
                    self.uniform() * region.width,
                    self.uniform() * region.height,
                ]
            })
            .collect()
    }
}

/// The power of an integer frequency by its definition: `|sum exp(-2 pi i k.x)|^2 / N`, with coordinates divided by the
/// extents. Exact to about `1e-15` times the frequency per sample.
pub fn direct_power(points: &[[f64; 2]], region: Region, [kx, ky]: [i64; 2]) -> f64 {
    let [re, im] = points.iter().fold([0.0; 2], |[re, im], [x, y]| {
        let turns = kx as f64 * (x / region.width) + ky as f64 * (y / region.height);
        // Whole turns are removed first, exactly.
        let (sin, cos) = (TAU * (turns - turns.round())).sin_cos();
        [re + cos, im - sin]
    });
    (re * re + im * im) / points.len() as f64
}

/// Distance of two places, around the torus when periodic.
pub fn distance(a: impl Into<DVec2>, b: impl Into<DVec2>, region: Region) -> f64 {
    let direct = (a.into() - b.into()).abs();
    let offset = match region.boundary {
        Boundary::Periodic => direct.min(DVec2::new(region.width, region.height) - direct),
        Boundary::Bounded => direct,
    };
    offset.x.hypot(offset.y)
}

/// A maximal Poisson-disk set: darts into the squares still uncovered, which are quartered
/// when darts become rare, until the squares are below 1e-10 of the radius.
pub fn maximal_set(region: Region, radius: f64, seed: u64) -> Vec<[f64; 2]> {
    let mut thrower = Thrower::new(region, radius, seed);
    let mut active = thrower.grid_squares();
    let mut side = thrower.side;
    while !active.is_empty() && side[0].max(side[1]) > 1e-10 * radius {
        for _ in 0..active.len() {
            let picked = (thrower.random.uniform() * active.len() as f64) as usize;
            let [x, y] = active[picked];
            let [u, v] = [thrower.random.uniform(), thrower.random.uniform()];
            thrower.try_dart([x + u * side[0], y + v * side[1]]);
        }
        side = side.map(|length| length / 2.0);
        active = (active.iter())
            .flat_map(|&[x, y]| {
                [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
                    .map(|[i, j]| [x + i * side[0], y + j * side[1]])
            })
            .filter(|&corner| !thrower.covers(corner, side))
            .collect();
    }
    thrower.points
}

struct Thrower {
    region: Region,
    radius: f64,
    random: Random,
    points: Vec<[f64; 2]>,
    cells: [usize; 2],
    side: [f64; 2],
    /// Samples by cell; cells are smaller than r / sqrt 2, so at most one each.
    grid: Vec<Option<usize>>,
}

impl Thrower {
    fn new(region: Region, radius: f64, seed: u64) -> Self {
        let fit = |extent: f64| (extent / radius * 2f64.sqrt()).ceil().max(1.0) as usize;
        let cells = [fit(region.width), fit(region.height)];
        let side = [
            region.width / cells[0] as f64,
            region.height / cells[1] as f64,
        ];
        Self {
            region,
            radius,
            random: Random::new(seed),
            points: Vec::new(),
            cells,
            side,
            grid: vec![None; cells[0] * cells[1]],
        }
    }

    fn grid_squares(&self) -> Vec<[f64; 2]> {
        let [columns, rows] = self.cells;
        (0..columns * rows)
            .map(|cell| [(cell % columns) as f64, (cell / columns) as f64])
            .map(|[i, j]| [i * self.side[0], j * self.side[1]])
            .collect()
    }

    fn cell(&self, [x, y]: [f64; 2]) -> [usize; 2] {
        let cell = |value: f64, axis: usize| {
            ((value / self.side[axis]) as usize).min(self.cells[axis] - 1)
        };
        [cell(x, 0), cell(y, 1)]
    }

    /// The samples within three cells: cells are at least 0.35 r wide in a region wider than r / 2, so
    /// that is beyond the radius; narrower regions have fewer than seven cells and are seen whole.
    fn near(&self, place: [f64; 2]) -> impl Iterator<Item = [f64; 2]> + '_ {
        let [column, row] = self.cell(place);
        let [columns, rows] = self.cells;
        let periodic = self.region.boundary == Boundary::Periodic;
        let at = move |index: usize, step: usize, cells: usize| {
            let moved = index as i64 + step as i64 - 3;
            if periodic {
                Some(moved.rem_euclid(cells as i64) as usize)
            } else {
                (0..cells as i64).contains(&moved).then_some(moved as usize)
            }
        };
        (0..49).filter_map(move |step| {
            let cell = at(row, step / 7, rows)? * columns + at(column, step % 7, columns)?;
            self.grid[cell].map(|index| self.points[index])
        })
    }

    fn try_dart(&mut self, place: [f64; 2]) {
        if !self.region.contains(place) {
            return;
        }
        let (region, radius) = (self.region, self.radius);
        if self
            .near(place)
            .all(|other| distance(place, other, region) >= radius)
        {
            let [column, row] = self.cell(place);
            self.grid[row * self.cells[0] + column] = Some(self.points.len());
            self.points.push(place);
        }
    }

    /// Whether one disk covers a square.
    fn covers(&self, [x, y]: [f64; 2], [dx, dy]: [f64; 2]) -> bool {
        let center = [x + dx / 2.0, y + dy / 2.0];
        let half = dx.hypot(dy) / 2.0;
        self.near(center)
            .any(|other| distance(center, other, self.region) + half < self.radius)
    }
}

/// Copies a periodic set side by side: a periodic set of the larger region, as maximal as it was.
pub fn repeated(points: &[[f64; 2]], region: Region, times: usize) -> (Vec<[f64; 2]>, Region) {
    let larger = Region {
        width: region.width * times as f64,
        height: region.height * times as f64,
        ..region
    };
    let mut all = Vec::with_capacity(points.len() * times * times);
    for copy in 0..times * times {
        let shift = [
            (copy % times) as f64 * region.width,
            (copy / times) as f64 * region.height,
        ];
        all.extend(points.iter().map(|p| [p[0] + shift[0], p[1] + shift[1]]));
    }
    all.retain(|&point| larger.contains(point));
    (all, larger)
}

/// The truth about a small set, from the definitions.
pub struct Truth {
    pub conflicts: u64,
    pub min_distance: f64,
    pub covering_radius: f64,
    /// Places whose empty circle has a radius, with that radius; equal places once.
    pub places: Vec<([f64; 2], f64)>,
}

impl Truth {
    pub fn gaps(&self, limit: f64) -> u64 {
        self.places.iter().filter(|place| place.1 > limit).count() as u64
    }
}

/// Tries every triple of samples and copies, every pair on every side, and the corners.
pub fn truth(points: &[[f64; 2]], region: Region, radius: f64) -> Truth {
    let (mut conflicts, mut min_distance) = (0, f64::INFINITY);
    for (i, &a) in points.iter().enumerate() {
        for &b in &points[..i] {
            let found = distance(a, b, region);
            conflicts += u64::from(found < radius);
            min_distance = min_distance.min(found);
        }
    }
    if region.boundary == Boundary::Periodic {
        let period = region.width.min(region.height);
        min_distance = min_distance.min(period);
        conflicts += if period < radius {
            points.len() as u64
        } else {
            0
        };
    }
    let places = empty_places(points, region);
    Truth {
        conflicts,
        min_distance,
        covering_radius: places.iter().map(|place| place.1).fold(0.0, f64::max),
        places,
    }
}

/// Samples with all copies that can be nearest to a place of the region.
fn copies(points: &[[f64; 2]], region: Region) -> Vec<[f64; 2]> {
    let steps = match region.boundary {
        Boundary::Periodic => -1..=1,
        Boundary::Bounded => 0..=0,
    };
    let mut all = Vec::new();
    for i in steps.clone() {
        for j in steps.clone() {
            let shift = [f64::from(i) * region.width, f64::from(j) * region.height];
            all.extend(points.iter().map(|p| [p[0] + shift[0], p[1] + shift[1]]));
        }
    }
    all
}

fn empty_places(points: &[[f64; 2]], region: Region) -> Vec<([f64; 2], f64)> {
    let all = copies(points, region);
    let mut candidates = Vec::new();
    for (i, &a) in all.iter().enumerate() {
        for (j, &b) in all[..i].iter().enumerate() {
            if region.boundary == Boundary::Bounded {
                candidates.extend(crossings(a, b, region));
            }
            candidates.extend(all[..j].iter().filter_map(|&c| circumcentre(a, b, c)));
        }
    }
    if region.boundary == Boundary::Bounded {
        for corner in 0..4 {
            let x = if corner % 2 == 0 { 0.0 } else { region.width };
            let y = if corner / 2 == 0 { 0.0 } else { region.height };
            let nearest = nearest(&all, [x, y]);
            candidates.push(([x, y], nearest));
        }
    }
    let same = 1e-9 * region.width.min(region.height);
    let mut places: Vec<([f64; 2], f64)> = Vec::new();
    for (center, radius) in candidates {
        // A circle is empty when no sample is nearer than those it goes through.
        if region.contains(center)
            && nearest(&all, center) >= radius * (1.0 - 1e-9)
            && !places
                .iter()
                .any(|place| distance(place.0, center, region) < same)
        {
            places.push((center, radius));
        }
    }
    places
}

pub fn nearest(points: &[[f64; 2]], place: [f64; 2]) -> f64 {
    (points.iter())
        .map(|p| (p[0] - place[0]).hypot(p[1] - place[1]))
        .fold(f64::INFINITY, f64::min)
}

/// Where the bisector of two samples meets the lines of the four sides.
fn crossings(a: [f64; 2], b: [f64; 2], region: Region) -> Vec<([f64; 2], f64)> {
    // Places c with c.(b - a) = (|b|^2 - |a|^2) / 2.
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let level = 0.5 * (dx * (a[0] + b[0]) + dy * (a[1] + b[1]));
    let mut places = Vec::new();
    for y in [0.0, region.height] {
        places.push([(level - dy * y) / dx, y]);
    }
    for x in [0.0, region.width] {
        places.push([x, (level - dx * x) / dy]);
    }
    (places.into_iter())
        .filter(|place| region.contains(*place))
        .map(|place| (place, (place[0] - a[0]).hypot(place[1] - a[1])))
        .collect()
}

/// From the equations of two bisectors, by Cramer's rule.
fn circumcentre(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Option<([f64; 2], f64)> {
    let row = |p: [f64; 2]| {
        let (dx, dy) = (p[0] - a[0], p[1] - a[1]);
        (dx, dy, 0.5 * (dx * dx + dy * dy))
    };
    let ((bx, by, bb), (cx, cy, cc)) = (row(b), row(c));
    let determinant = bx * cy - by * cx;
    if determinant.abs() < 1e-14 * (bx.abs() + by.abs()) * (cx.abs() + cy.abs()) {
        return None;
    }
    let x = (bb * cy - by * cc) / determinant;
    let y = (bx * cc - bb * cx) / determinant;
    Some(([a[0] + x, a[1] + y], x.hypot(y)))
}

/// Runs a measure to its end and stopped at several of its reports.
pub fn check_reports(
    measure: impl Fn(&(dyn Fn(Progress) -> ControlFlow<()> + Sync)) -> Option<MeasureError>,
) {
    check_reports_of(measure, MeasureError::Cancelled);
}

/// The same for work with errors of its own.
pub fn check_reports_of<E: std::fmt::Debug + PartialEq>(
    measure: impl Fn(&(dyn Fn(Progress) -> ControlFlow<()> + Sync)) -> Option<E>,
    cancelled: E,
) {
    let cancelled = Some(cancelled);
    let (calls, furthest, total) = (AtomicU64::new(0), AtomicU64::new(0), AtomicU64::new(0));
    let count = |progress: Progress| {
        calls.fetch_add(1, Ordering::Relaxed);
        furthest.fetch_max(progress.done, Ordering::Relaxed);
        total.store(progress.total, Ordering::Relaxed);
        assert!(progress.done <= progress.total, "{progress:?}");
        ControlFlow::Continue(())
    };
    assert_eq!(measure(&count), None);
    let load = |value: &AtomicU64| value.load(Ordering::Relaxed);
    assert_eq!(load(&furthest), load(&total), "all work is reported");
    let all = load(&calls);
    for stop in [1, 2, all / 4, all / 2, 3 * all / 4, all - 1, all] {
        let seen = AtomicU64::new(0);
        let control = |_: Progress| {
            if seen.fetch_add(1, Ordering::Relaxed) + 1 >= stop {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        assert_eq!(measure(&control), cancelled, "{stop} of {all}");
    }
}
