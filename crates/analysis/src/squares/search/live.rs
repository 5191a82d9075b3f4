//! The judge by squares for samples that come and go one by one: its squares are kept with the finding in each, and a change
//! searches only those squares anew that the sample reaches. The counts are those of [`SquaresJudge::judge`], for at most
//! [`MOST_SAMPLES`].

use std::sync::Arc;

use crate::live::{LiveSample, Renew};
use crate::region::Boundary;

use super::{
    Asked, List, Near, PointSpan, RadiusRange, Share, SquaresJudge, TileFindings, TileSearch,
    TileSquare, is_near, tile_bits,
};

/// The most squares that are kept: some 200 MB with their lists. A steep field, whose least radius is small next to every place,
/// may need more.
const MAX_SQUARES: usize = 1 << 20;

/// Of more samples the judge may begin with squares that are smaller than those kept, and count more open places. A window follows
/// runs of 200,000 at most.
const MOST_SAMPLES: usize = 1 << 18;

/// About the counted steps of a change: a sample reaches some 15 of the smallest squares, each of which is searched anew.
const STEPS_OF_CHANGE: u64 = 800;

/// About the counted steps of a sample when all squares are searched anew: two or three of the smallest are to a sample.
const STEPS_OF_SAMPLE: u64 = 300;

/// About the counted steps that a searched square takes besides those of its samples.
const STEPS_OF_SQUARE: u64 = 4;

/// The conflicts and the open places of samples that come and go, with the radius at each place.
///
/// Squares are kept down to those with which the judge begins where samples are many, and on to where the side is at most the
/// least radius in the square: there the judge counts one uncovered place at most, so that it is searched as a whole.
#[derive(Clone, Debug)]
pub struct LiveSquares {
    plan: Arc<Plan>,
    /// How many samples, or images of samples, may be near a place of each square.
    reached: Vec<u32>,
    /// In how many places the judge finds each square uncovered.
    open: Vec<u64>,
    /// Those samples, for each of the smallest squares.
    lists: Vec<Vec<Near>>,
    count: usize,
    conflicts: u64,
}

/// The squares of a domain, without samples.
#[derive(Debug)]
struct Plan {
    judge: SquaresJudge,
    /// The squares with which the judge begins where samples are few.
    roots: Vec<u32>,
    /// The sides of those with which it begins of [`MOST_SAMPLES`] are two to this power.
    least_bits: u32,
    squares: Vec<PlannedSquare>,
    /// The numbers of the smallest squares, by those of their lists.
    smallest: Vec<u32>,
}

#[derive(Debug)]
struct PlannedSquare {
    /// Its lattice points in the region.
    span: PointSpan,
    bits: u32,
    share: Share,
    range: RadiusRange,
    parts: SquareParts,
}

/// There are more squares than are kept.
struct TooManySquares;

/// What a square consists of.
#[derive(Clone, Copy, Debug)]
enum SquareParts {
    /// It is one of the smallest, with the list of this number.
    Whole(u32),
    /// Its quarters, except for those outside of the domain.
    Quarters([Option<u32>; 4]),
}

/// A sample that comes or goes, or an image of it.
#[derive(Clone, Copy)]
struct Changed {
    place: [i64; 2],
    radius: i32,
    sample: u32,
    comes: bool,
    /// Whether the squares that it reaches are searched at once.
    searches: bool,
}

impl Changed {
    /// Returns the squared distance to the nearest place of a span.
    fn beside(&self, span: &PointSpan) -> i64 {
        // Farther away nothing is near, as radii are below 2^22; so that squares fit 64 bits, all of that is one distance.
        const FAR: i64 = 1 << 30;
        let [x, y] = [0, 1].map(|axis| {
            let (low, high) = (span.min[axis], span.max[axis]);
            let beside = (low - self.place[axis]).max(self.place[axis] - high);
            beside.clamp(0, FAR)
        });
        x * x + y * y
    }
}

impl Plan {
    /// Returns the squares of a judge's domain.
    fn new(judge: SquaresJudge) -> Result<Self, TooManySquares> {
        // With more samples the judge may begin with smaller squares, which are parts of these.
        let bits = tile_bits(&judge.places(), 0);
        let [right, top] = judge.last();
        let least_bits = tile_bits(&judge.places(), MOST_SAMPLES);
        let mut plan = Self {
            judge,
            roots: Vec::new(),
            least_bits,
            squares: Vec::new(),
            smallest: Vec::new(),
        };
        for y in (0..=top).step_by(1 << bits) {
            for x in (0..=right).step_by(1 << bits) {
                // Nothing is known of the squares around a root: the shape is asked for its share.
                let around = Share::Some;
                let root = plan.add([x, y], bits, around)?;
                plan.roots.extend(root);
            }
        }
        Ok(plan)
    }

    /// Adds a square with its parts, and returns its number; `None` if it is outside of the domain. `around` is how much of the
    /// larger square lies in the domain.
    fn add(
        &mut self,
        corner: [i64; 2],
        bits: u32,
        around: Share,
    ) -> Result<Option<u32>, TooManySquares> {
        let last = self.judge.last();
        let side = 1_i64 << bits;
        let max = [0, 1].map(|axis| (corner[axis] + side - 1).min(last[axis]));
        let span = PointSpan { min: corner, max };
        if (0..2).any(|axis| corner[axis] > max[axis]) {
            return Ok(None);
        }
        // The judge finds its shares in the same way. If all of the larger square is inside, so is this part of it.
        let share = match around {
            Share::Everything => Share::Everything,
            Share::Some | Share::Nothing => self.judge.shape.share(span, bits),
        };
        if share == Share::Nothing {
            return Ok(None);
        }
        if self.squares.len() == MAX_SQUARES {
            return Err(TooManySquares);
        }

        let number = self.squares.len() as u32;
        let range = self.judge.radii.range(span, bits);
        // The square gets its number before its quarters get theirs. Its parts are put right below, if it has quarters.
        self.squares.push(PlannedSquare {
            span,
            bits,
            share,
            range,
            parts: SquareParts::Whole(self.smallest.len() as u32),
        });
        let is_searched_whole = side <= range.least && bits <= self.least_bits;
        if is_searched_whole || bits == 0 {
            self.smallest.push(number);
            return Ok(Some(number));
        }

        let half = side / 2;
        let mut quarters = [None; 4];
        for (quarter, [right, up]) in quarters.iter_mut().zip([[0, 0], [1, 0], [0, 1], [1, 1]]) {
            let corner = [corner[0] + right * half, corner[1] + up * half];
            *quarter = self.add(corner, bits - 1, share)?;
        }
        self.squares[number as usize].parts = SquareParts::Quarters(quarters);
        Ok(Some(number))
    }

    /// Returns the number of the list of the smallest square around a place; `None` for a place that no square holds,
    /// as it is outside of the domain.
    fn list_at(&self, place: [i64; 2]) -> Option<usize> {
        let holds = |number: &u32| {
            let span = &self.squares[*number as usize].span;
            (0..2).all(|axis| (span.min[axis]..=span.max[axis]).contains(&place[axis]))
        };
        let mut at = self.roots.iter().copied().find(holds)?;
        loop {
            match self.squares[at as usize].parts {
                SquareParts::Whole(list) => return Some(list as usize),
                SquareParts::Quarters(quarters) => {
                    at = quarters.into_iter().flatten().find(holds)?;
                }
            }
        }
    }
}

impl LiveSquares {
    /// Returns the counts of no samples; `None` if the field is so steep that there are too many squares to be kept.
    #[must_use]
    pub fn new(judge: &SquaresJudge) -> Option<Self> {
        let plan = Arc::new(Plan::new(judge.clone()).ok()?);
        let squares = plan.squares.len();
        let mut all = Self {
            reached: vec![0; squares],
            open: vec![0; squares],
            lists: vec![Vec::new(); plan.smallest.len()],
            plan,
            count: 0,
            conflicts: 0,
        };
        all.search_all();
        Some(all)
    }

    /// Puts in a sample, which lies in the domain. Returns the counted steps.
    pub fn insert(&mut self, sample: u32, place: [i32; 2]) -> u64 {
        let (comes, searches) = (true, true);
        self.change(sample, place, comes, searches)
    }

    /// Takes out a sample that was put in at this place. Returns the counted steps.
    pub fn remove(&mut self, sample: u32, place: [i32; 2]) -> u64 {
        let (comes, searches) = (false, true);
        self.change(sample, place, comes, searches)
    }

    /// Begins again with these samples. Returns the counted steps.
    pub fn rebuild(&mut self, samples: &[LiveSample]) -> u64 {
        self.clear();
        let (comes, searches) = (true, false);
        let mut steps = 0;
        for &(sample, place) in samples {
            steps += self.change(sample, place, comes, searches);
        }
        steps + self.search_all()
    }

    /// Returns about the counted steps of a change.
    #[must_use]
    pub const fn cost_of_change(&self) -> u64 {
        STEPS_OF_CHANGE
    }

    /// Returns about the counted steps of [`Self::rebuild`] with so many samples.
    #[must_use]
    pub const fn cost_of_rebuild(&self, count: usize) -> u64 {
        STEPS_OF_SAMPLE * count as u64 + self.open.len() as u64
    }

    /// Returns how many samples there are.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.count
    }

    /// Returns the number of pairs that are near each other.
    #[must_use]
    pub const fn conflicts(&self) -> u64 {
        self.conflicts
    }

    /// Returns the number of squares in which the judge finds an uncovered place.
    #[must_use]
    pub fn open_places(&self) -> u64 {
        // A square that no sample reaches counts as one place, so that it matters with which squares the judge begins.
        let bits = tile_bits(&self.plan.judge.places(), self.count);
        let roots = self.plan.roots.iter();
        roots.map(|&root| self.open_from(root, bits)).sum()
    }

    fn open_from(&self, number: u32, bits: u32) -> u64 {
        let square = &self.plan.squares[number as usize];
        match square.parts {
            SquareParts::Quarters(quarters) if square.bits > bits => {
                let quarters = quarters.into_iter().flatten();
                quarters.map(|quarter| self.open_from(quarter, bits)).sum()
            }
            SquareParts::Quarters(_) | SquareParts::Whole(_) => self.open[number as usize],
        }
    }

    fn clear(&mut self) {
        self.reached.fill(0);
        self.lists.iter_mut().for_each(Vec::clear);
        (self.count, self.conflicts) = (0, 0);
    }

    /// Puts a sample in or takes it out. Returns the counted steps.
    fn change(&mut self, sample: u32, place: [i32; 2], comes: bool, searches: bool) -> u64 {
        let plan = Arc::clone(&self.plan);
        let changed = Changed {
            place: place.map(i64::from),
            radius: plan.judge.radius_at(place),
            sample,
            comes,
            searches,
        };

        // Its conflicts are counted while it is not there itself.
        if comes {
            self.conflicts += self.near(&changed);
            self.count += 1;
        }
        let mut steps = 0;
        let region = plan.judge.region;
        // As in the judge: the image of a sample that is nearest to a place of the region is at most one period away.
        let images = match region.boundary {
            Boundary::Periodic => -1..=1,
            Boundary::Bounded => 0..=0,
        };
        for (i, j) in images
            .clone()
            .flat_map(|i| images.clone().map(move |j| (i, j)))
        {
            let [x, y] = changed.place;
            let image = Changed {
                place: [
                    x + i * i64::from(region.width),
                    y + j * i64::from(region.height),
                ],
                ..changed
            };
            // Most images are far from the region.
            let all = PointSpan {
                min: [0, 0],
                max: plan.judge.last(),
            };
            let greatest = plan.judge.radii.greatest();
            if !is_near(image.beside(&all), image.radius.into(), greatest) {
                continue;
            }
            for &root in &plan.roots {
                steps += self.reach(&plan, root, &image);
            }
        }
        if !comes {
            self.conflicts -= self.near(&changed);
            self.count -= 1;
        }
        steps
    }

    /// Returns how many samples are near one that is not in the lists.
    fn near(&self, one: &Changed) -> u64 {
        let Some(list) = self.plan.list_at(one.place) else {
            return 0;
        };
        let corner = self.plan.squares[self.plan.smallest[list] as usize]
            .span
            .min;
        let is_near_one = |other: &&Near| {
            let x = one.place[0] - corner[0] - i64::from(other.x);
            let y = one.place[1] - corner[1] - i64::from(other.y);
            is_near(x * x + y * y, one.radius.into(), other.radius.into())
        };
        self.lists[list].iter().filter(is_near_one).count() as u64
    }

    /// Counts a sample in a square and in its parts, as far as it may be near a place of them, or takes it off. Returns the counted
    /// steps.
    fn reach(&mut self, plan: &Plan, number: u32, changed: &Changed) -> u64 {
        let square = &plan.squares[number as usize];
        let nearest = changed.beside(&square.span);
        if !is_near(nearest, changed.radius.into(), square.range.greatest) {
            return 1;
        }

        let reached = &mut self.reached[number as usize];
        if changed.comes {
            *reached += 1;
        } else {
            *reached -= 1;
        }
        let mut steps = 1;
        match square.parts {
            SquareParts::Whole(list) => {
                self.enlist(square, list as usize, changed);
                if changed.searches {
                    steps += self.search(plan, number);
                }
            }
            SquareParts::Quarters(quarters) => {
                for quarter in quarters.into_iter().flatten() {
                    steps += self.reach(plan, quarter, changed);
                }
                if changed.searches {
                    self.sum(plan, number);
                }
            }
        }
        steps
    }

    /// Puts a sample into the list of a square, or takes it out.
    fn enlist(&mut self, square: &PlannedSquare, list: usize, changed: &Changed) {
        let list = &mut self.lists[list];
        let [x, y] = [0, 1].map(|axis| (changed.place[axis] - square.span.min[axis]) as i32);
        if changed.comes {
            list.push(Near {
                x,
                y,
                radius: changed.radius,
                index: changed.sample,
            });
            return;
        }
        // Images of one sample have one number, and lie at different places.
        let is_it = |near: &Near| (near.index, near.x, near.y) == (changed.sample, x, y);
        if let Some(at) = list.iter().position(is_it) {
            list.swap_remove(at);
        }
    }

    /// Searches one of the smallest squares anew. Returns the counted steps.
    fn search(&mut self, plan: &Plan, number: u32) -> u64 {
        let square = &plan.squares[number as usize];
        let SquareParts::Whole(list) = square.parts else {
            return 0;
        };
        let near = self.lists[list as usize].clone();
        let length = near.len();
        let mut search = TileSearch {
            judge: &plan.judge,
            corner: square.span.min,
            last: plan.judge.last(),
            bits: square.bits,
            lists: near,
            // Pairs are compared when one of their samples comes or goes.
            asked: Asked::Everything,
            counts_conflicts: false,
            witnesses: 0,
            findings: TileFindings::new(0),
        };

        let whole = TileSquare {
            x: 0,
            y: 0,
            bits: square.bits,
        };
        // A square's own samples are listed first where pairs are compared. No pairs are compared here, so that no
        // sample is listed as the square's own.
        let all = List {
            first: 0,
            outside: 0,
            end: length,
        };
        search.visit(&whole, square.share, all);
        self.open[number as usize] = search.findings.uncovered;
        search.findings.squares * (length as u64 + STEPS_OF_SQUARE)
    }

    /// Counts the open places of a square from those of its quarters; does nothing for a square without quarters.
    fn sum(&mut self, plan: &Plan, number: u32) {
        let square = &plan.squares[number as usize];
        let SquareParts::Quarters(quarters) = square.parts else {
            return;
        };
        let quarters = quarters.into_iter().flatten();
        let of_quarters: u64 = quarters.map(|quarter| self.open[quarter as usize]).sum();

        let is_hole = self.reached[number as usize] == 0 && square.share == Share::Everything;
        // In a square no wider than the least radius in it, the judge looks for one uncovered place only.
        let has_one = 1_i64 << square.bits <= square.range.least;
        self.open[number as usize] = if is_hole {
            1
        } else if has_one {
            of_quarters.min(1)
        } else {
            of_quarters
        };
    }

    /// Searches all of the smallest squares, and counts the others. Returns the counted steps.
    fn search_all(&mut self) -> u64 {
        let plan = Arc::clone(&self.plan);
        let mut steps = 0;
        for number in (0..plan.squares.len() as u32).rev() {
            steps += self.search_one(&plan, number);
        }
        steps
    }

    /// Searches or counts a square whose parts are counted. A part has a higher number than its square.
    fn search_one(&mut self, plan: &Plan, number: u32) -> u64 {
        self.sum(plan, number);
        1 + self.search(plan, number)
    }
}

impl Renew for LiveSquares {
    /// The number of slices that are done: one for each sample that is put in, then one for each square, the smallest parts first.
    type Work = usize;

    const BEGINNING: u64 = 1;

    fn begin_anew(&self, _: &[LiveSample]) -> (Self, usize) {
        let mut empty = Self {
            plan: Arc::clone(&self.plan),
            reached: vec![0; self.reached.len()],
            open: vec![0; self.open.len()],
            lists: vec![Vec::new(); self.lists.len()],
            count: 0,
            conflicts: 0,
        };
        empty.clear();
        (empty, 0)
    }

    fn next_slice(&mut self, work: &mut usize, samples: &[LiveSample]) -> Option<u64> {
        let index = *work;
        *work += 1;
        if let Some(&(sample, place)) = samples.get(index) {
            let (comes, searches) = (true, false);
            return Some(self.change(sample, place, comes, searches));
        }

        let plan = Arc::clone(&self.plan);
        let number = plan.squares.len().checked_sub(index - samples.len() + 1)?;
        Some(self.search_one(&plan, number as u32))
    }

    fn cost_of_slices(&self, count: usize) -> u64 {
        self.cost_of_rebuild(count)
    }
}
