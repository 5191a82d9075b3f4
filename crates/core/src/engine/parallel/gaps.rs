//! Detection and insertion in a region (see `stages::detect` for what a candidate is). A place that
//! no sample covers was covered by a lost one, so only cells near lost samples are looked at; stamps
//! prove most of their pixels covered, and only in the others candidates are sought: among the
//! samples that are about as near to the pixel as the nearest one, since only those can make one.

use fearless_simd::Simd;

use crate::circumcentre::circumcentre;
use crate::lattice::{Domain, Point, R, R_SQUARED};
use crate::parameters::{Insertion, Search};
use crate::random::{Key, Stream};
use crate::stages::detect::{Border, DETECTOR_REACH, NEARER_SLACK, Reach};

use super::frame::{CELL_BITS, PAD};
use super::near::{HALF_DIAGONAL, MOST_SITES, Near, SITE_SLACK, Site};
use super::region::{Loss, Lost, Region, WIDEST, flag, pack};
use super::stamp::{PIXEL_SIDE, PIXELS, Stamps};

/// Cells searched around a cell unless that proves too few: all samples within 2r of its places.
const USUAL: i32 = 2;

/// The square of R, less far more than f32 rounds.
const SURELY_COVERED: f32 = (R_SQUARED - 8_192) as f32;

/// What a fill needs to know of the run.
pub(crate) struct Rules {
    pub domain: Domain,
    pub search: Search,
    /// The run's key.
    pub key: Key,
    /// Cells around a lost sample in which an uncovered place may lie: 1, or more with a pattern
    /// that leaves lattice points uncovered.
    pub lost_reach: i32,
    /// How gaps are filled.
    pub insertion: Insertion,
}

impl Rules {
    /// Returns whether every place that no sample covers was covered by a lost one.
    pub(crate) fn is_exact(&self) -> bool {
        self.lost_reach == 1
    }

    /// Returns how many cells away an unsure sample may matter to a place.
    pub(crate) fn reach(&self) -> i32 {
        match self.insertion {
            Insertion::Circumcentre => reach_cells(self.domain.is_periodic()),
            Insertion::Uniform => self.lost_reach,
        }
    }
}

/// A pixel that no single sample is known to cover.
#[derive(Clone, Copy)]
struct Pixel {
    /// Its number in the cell, 0 to 63, row by row.
    number: u8,
    /// The distance from its centre to the nearest sample when that was measured.
    nearest: f32,
}

/// A candidate, compared by its turn.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Candidate {
    rank: u32,
    /// Its place in the domain, y first.
    place: (i32, i32),
    /// Its place in the frame.
    x: i32,
    y: i32,
}

/// A sample that was inserted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inserted {
    pub x: i32,
    pub y: i32,
    pub iteration: u32,
}

/// Indices of samples gathered.
type SiteList = [u8; MOST_SITES];

/// The buffers of a fill.
pub(crate) struct GapBuffers {
    pub marked: Vec<u64>,
    pub listed: Vec<(u32, i32, i32)>,
    open: Vec<u64>,
    open_index: Vec<u32>,
    masks: Vec<(u32, u64)>,
    /// The first pixel of each open cell.
    first_pixels: Vec<u32>,
    pixels: Vec<Pixel>,
    /// The largest of their distances.
    farthest: f32,
    pub near: Near,
    wide: Near,
    sites: SiteList,
    candidates: Vec<Candidate>,
    todo: Vec<(u32, u8)>,
    pub inserted: Vec<Inserted>,
    /// Cell and slot of the samples inserted in the last iteration, sorted.
    detectors: Vec<u64>,
}

impl Default for GapBuffers {
    fn default() -> Self {
        Self {
            marked: Vec::new(),
            listed: Vec::new(),
            open: Vec::new(),
            open_index: Vec::new(),
            masks: Vec::new(),
            first_pixels: Vec::new(),
            pixels: Vec::new(),
            farthest: 0.0,
            near: Near::default(),
            wide: Near::default(),
            sites: [0; MOST_SITES],
            candidates: Vec::new(),
            todo: Vec::new(),
            inserted: Vec::new(),
            detectors: Vec::new(),
        }
    }
}

/// Which samples are detectors.
#[derive(Clone, Copy)]
enum Detectors {
    /// Those near lost samples.
    First,
    /// Those inserted in the iteration before.
    Inserted,
}

/// An answer that may have to wait for more of the plane.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Known {
    Yes,
    No,
    Unknown,
}

impl<const TAGS: bool> Region<TAGS> {
    /// Fills the gaps by circumcentres, as far as it can be known what happens.
    #[inline(always)]
    pub(crate) fn fill<S: Simd>(&mut self, simd: S, rules: &Rules) {
        let mut gaps = std::mem::take(&mut self.gaps);
        gaps.inserted.clear();
        self.mark(&mut gaps, rules.lost_reach);
        self.spread(&mut gaps, false);
        self.first_detection(simd, &mut gaps, rules);
        let mut iteration = 1;
        loop {
            let first = gaps.inserted.len();
            self.insert_candidates(simd, &mut gaps, rules, iteration);
            if gaps.inserted.len() == first && self.spread == self.unsure.len() {
                break;
            }
            iteration += 1;
            self.spread(&mut gaps, true);
            self.detect_again(simd, &mut gaps, first, rules);
        }
        self.gaps = gaps;
    }

    /// Marks the cells in which an uncovered place may lie.
    #[inline(always)]
    pub(crate) fn mark(&self, gaps: &mut GapBuffers, reach: i32) {
        let words = self.words();
        let rows = (self.frame.cells[1] + 2 * PAD) as usize;
        for bits in [&mut gaps.marked, &mut gaps.open] {
            bits.clear();
            bits.resize(words * rows, 0);
        }
        let ones = (1_u64 << (2 * reach + 1)) - 1;
        for lost in &self.lost {
            let column = ((lost.x >> CELL_BITS) + PAD - reach).max(0) as usize;
            let row = (lost.y >> CELL_BITS) + PAD;
            let (word, bit) = (column / 64, column % 64);
            for row in (row - reach).max(0)..=(row + reach).min(rows as i32 - 1) {
                let at = row as usize * words + word;
                gaps.marked[at] |= ones << bit;
                if bit + 2 * reach as usize >= 64 && word + 1 < words {
                    gaps.marked[at + 1] |= ones >> (64 - bit);
                }
            }
        }
    }

    /// Returns the words of a row of bits, one bit a cell.
    fn words(&self) -> usize {
        self.frame.stride().div_ceil(64)
    }

    /// Lists the marked cells of the frame with their columns and rows, row by row.
    #[inline(always)]
    pub(crate) fn list_marked(&self, marked: &[u64], list: &mut Vec<(u32, i32, i32)>) {
        list.clear();
        let words = self.words();
        for row in 0..self.frame.cells[1] {
            let start = (row + PAD) as usize * words;
            for (word, &bits) in marked[start..start + words].iter().enumerate() {
                let mut bits = bits;
                while bits != 0 {
                    let column = (word * 64) as i32 + bits.trailing_zeros() as i32 - PAD;
                    bits &= bits - 1;
                    if (0..self.frame.cells[0]).contains(&column) {
                        list.push((self.frame.cell(column, row) as u32, column, row));
                    }
                }
            }
        }
    }

    /// Returns the pixels of a cell that are not proven covered.
    #[inline(always)]
    pub(crate) fn open_pixels(&self, stamps: &Stamps, cell: usize, column: i32, row: i32) -> u64 {
        let stride = self.frame.stride();
        let mut covered = self.outside(column, row);
        // The cell itself, its sides, its corners.
        for (from, at) in [
            (4, cell),
            (1, cell - stride),
            (3, cell - 1),
            (5, cell + 1),
            (7, cell + stride),
            (0, cell - stride - 1),
            (2, cell - stride + 1),
            (6, cell + stride - 1),
            (8, cell + stride + 1),
        ] {
            let [a, b, c, _] = self.slots[at];
            covered |= stamps.stamp(from, a) | stamps.stamp(from, b) | stamps.stamp(from, c);
            if covered == u64::MAX {
                return 0;
            }
        }
        !covered
    }

    /// Returns the pixels of a cell that lie outside a bounded domain.
    #[inline(always)]
    fn outside(&self, column: i32, row: i32) -> u64 {
        let [width, height] = self.frame.end;
        let (left, bottom) = (column << CELL_BITS, row << CELL_BITS);
        if left + R <= width && bottom + R <= height {
            return 0;
        }
        let mut outside = 0;
        for pixel in 0..PIXELS * PIXELS {
            let (x, y) = corner(pixel as u8);
            outside |= u64::from(left + x >= width || bottom + y >= height) << pixel;
        }
        outside
    }

    /// Finds the open pixels and the candidates of iteration 1.
    #[inline(always)]
    fn first_detection<S: Simd>(&mut self, simd: S, gaps: &mut GapBuffers, rules: &Rules) {
        let stamps = Stamps::get();
        let words = self.words();
        gaps.first_pixels.clear();
        gaps.pixels.clear();
        gaps.farthest = 0.0;
        gaps.candidates.clear();
        gaps.open_index.resize(self.frame.cell_count(), 0);
        let mut unsure = Vec::new();
        self.list_marked(&gaps.marked, &mut gaps.listed);
        let mut masks = std::mem::take(&mut gaps.masks);
        masks.clear();
        for &(cell, column, row) in &gaps.listed {
            let open = self.open_pixels(stamps, cell as usize, column, row);
            if open != 0 {
                masks.push((cell, open));
            }
        }
        for &(cell, open) in &masks {
            let cell = cell as usize;
            gaps.near
                .gather(&self.slots, self.frame.stride(), cell, USUAL);
            if self.flags[cell] & flag::REACHED != 0 {
                if each_bit(open).any(|p| gaps.near.may_be_open(corner(p).0, corner(p).1)) {
                    unsure.push(cell);
                }
                continue;
            }
            let (column, row) = self.frame.column_row(cell);
            let column = (column + PAD) as usize;
            gaps.open[(row + PAD) as usize * words + column / 64] |= 1 << (column % 64);
            gaps.open_index[cell] = gaps.first_pixels.len() as u32;
            gaps.first_pixels.push(gaps.pixels.len() as u32);
            for number in each_bit(open) {
                if let Some(nearest) = self.search_pixel(
                    simd,
                    gaps,
                    rules,
                    cell,
                    number,
                    Detectors::First,
                    &mut unsure,
                ) {
                    gaps.pixels.push(Pixel { number, nearest });
                    gaps.farthest = gaps.farthest.max(nearest);
                }
            }
        }
        gaps.masks = masks;
        for cell in unsure {
            self.make_hot(cell);
        }
    }

    pub(crate) fn make_hot(&mut self, cell: usize) {
        self.make_unsure(cell);
        self.flag_around(cell, flag::HOT);
    }

    /// Lets unsure cells reach their surroundings: what is open there may be filled by samples that
    /// are not known. With `again` the open cells newly reached are judged; else detection does it.
    #[inline(always)]
    fn spread(&mut self, gaps: &mut GapBuffers, again: bool) {
        let reach = reach_cells(self.frame.periodic);
        let known = self.unsure.len();
        let (columns, rows) = (self.frame.cells[0], self.frame.cells[1]);
        for k in self.spread..known {
            let (column, row) = self.frame.column_row(self.unsure[k] as usize);
            for row in (row - reach).max(0)..=(row + reach).min(rows - 1) {
                for column in (column - reach).max(0)..=(column + reach).min(columns - 1) {
                    let cell = self.frame.cell(column, row);
                    if self.flags[cell] & flag::REACHED == 0 {
                        self.flags[cell] |= flag::REACHED;
                        if again && self.is_still_open(gaps, cell, column, row) {
                            self.make_hot(cell);
                        }
                    }
                }
            }
        }
        self.spread = known;
    }

    #[inline(always)]
    fn is_still_open(&self, gaps: &mut GapBuffers, cell: usize, column: i32, row: i32) -> bool {
        let (column, row) = ((column + PAD) as usize, (row + PAD) as usize);
        if gaps.open[row * self.words() + column / 64] >> (column % 64) & 1 == 0 {
            return false;
        }
        gaps.near
            .gather(&self.slots, self.frame.stride(), cell, USUAL);
        let (near, pixels) = (
            &gaps.near,
            pixels_of(&gaps.first_pixels, &gaps.pixels, gaps.open_index[cell]),
        );
        pixels
            .iter()
            .any(|p| near.may_be_open(corner(p.number).0, corner(p.number).1))
    }

    /// Finds the candidates that the samples inserted last have made: those from `first` on.
    #[inline(always)]
    fn detect_again<S: Simd>(
        &mut self,
        simd: S,
        gaps: &mut GapBuffers,
        first: usize,
        rules: &Rules,
    ) {
        let mut todo = std::mem::take(&mut gaps.todo);
        let mut unsure = Vec::new();
        todo.clear();
        gaps.candidates.clear();
        gaps.detectors.clear();
        for k in first..gaps.inserted.len() {
            let Inserted { x, y, .. } = gaps.inserted[k];
            gaps.detectors
                .push(site_key(self.frame.cell_at(x, y), pack(x, y)));
            self.concerned_pixels(gaps, x, y, &mut todo);
        }
        gaps.detectors.sort_unstable();
        todo.sort_unstable();
        todo.dedup();
        let mut gathered = usize::MAX;
        for &(cell, number) in &todo {
            let cell = cell as usize;
            if gathered != cell {
                gaps.near
                    .gather(&self.slots, self.frame.stride(), cell, USUAL);
                gathered = cell;
            }
            self.search_pixel(
                simd,
                gaps,
                rules,
                cell,
                number,
                Detectors::Inserted,
                &mut unsure,
            );
        }
        gaps.todo = todo;
        for cell in unsure {
            self.make_hot(cell);
        }
    }

    /// Appends the open pixels for which the sample at (x, y) may be one of a candidate's.
    #[inline(always)]
    fn concerned_pixels(&self, gaps: &GapBuffers, x: i32, y: i32, todo: &mut Vec<(u32, u8)>) {
        let words = self.words();
        let (column, row) = (x >> CELL_BITS, y >> CELL_BITS);
        // Three cells away everything is 2r away.
        let reach = if gaps.farthest + 2.0 * HALF_DIAGONAL + SITE_SLACK < (2 * R) as f32 {
            2
        } else {
            reach_cells(self.frame.periodic)
        };
        // The padding is never open: a row of bits has 2 reach + 1 of interest, in one word or two.
        let first = (column + PAD - reach) as usize;
        let ones = (1_u64 << (2 * reach + 1)) - 1;
        for row in row - reach..=row + reach {
            let start = (row + PAD) as usize * words + first / 64;
            let low = gaps.open[start] >> (first % 64);
            let high = gaps
                .open
                .get(start + 1)
                .map_or(0, |&next| next << 1 << (63 - first % 64));
            for bit in each_bit((low | high) & ones) {
                let column = column - reach + i32::from(bit);
                let cell = self.frame.cell(column, row);
                if self.flags[cell] & flag::REACHED != 0 {
                    continue;
                }
                let dx = (x - (column << CELL_BITS)) as f32;
                let dy = (y - (row << CELL_BITS)) as f32;
                for pixel in pixels_of(&gaps.first_pixels, &gaps.pixels, gaps.open_index[cell]) {
                    let (cx, cy) = centre(pixel.number);
                    let squared = (dx - cx) * (dx - cx) + (dy - cy) * (dy - cy);
                    let covers = R as f32 - HALF_DIAGONAL;
                    let limit = pixel.nearest + 2.0 * HALF_DIAGONAL + SITE_SLACK;
                    if squared > covers * covers && squared <= limit * limit {
                        todo.push((cell as u32, pixel.number));
                    }
                }
            }
        }
    }

    /// Looks for candidates in one pixel, adds them to `gaps.candidates`, and returns the distance from its
    /// centre to the nearest sample. `gaps.near` holds the samples around `cell`.
    #[inline(always)]
    fn search_pixel<S: Simd>(
        &self,
        simd: S,
        gaps: &mut GapBuffers,
        rules: &Rules,
        cell: usize,
        number: u8,
        detectors: Detectors,
        unsure: &mut Vec<usize>,
    ) -> Option<f32> {
        let (x, y) = centre(number);
        let measured = gaps.near.measure(simd, x, y);
        if measured.farthest_corner_squared <= SURELY_COVERED {
            return None;
        }
        let nearest = measured.squared.sqrt();
        let limit = nearest + 2.0 * HALF_DIAGONAL + SITE_SLACK;
        // Beyond 2r samples may lie outside the cells gathered.
        if limit >= (2 * R) as f32 {
            return Some(self.search_wide(simd, gaps, rules, cell, number, detectors, unsure));
        }
        let count = gaps.near.sites(simd, limit * limit, &mut gaps.sites);
        if count >= 3 || !rules.domain.is_periodic() {
            let spot = Spot {
                cell,
                number,
                detectors,
                wide: false,
                sites: count,
            };
            self.search_sites(simd, gaps, rules, spot, unsure);
        }
        Some(nearest)
    }

    #[cold]
    fn search_wide<S: Simd>(
        &self,
        simd: S,
        gaps: &mut GapBuffers,
        rules: &Rules,
        cell: usize,
        number: u8,
        detectors: Detectors,
        unsure: &mut Vec<usize>,
    ) -> f32 {
        let (x, y) = centre(number);
        gaps.wide
            .gather(&self.slots, self.frame.stride(), cell, WIDEST);
        let nearest = gaps.wide.measure(simd, x, y).squared.sqrt();
        let limit = nearest + 2.0 * HALF_DIAGONAL + SITE_SLACK;
        let sites = gaps.wide.sites(simd, limit * limit, &mut gaps.sites);
        self.search_sites(
            simd,
            gaps,
            rules,
            Spot {
                cell,
                number,
                detectors,
                wide: true,
                sites,
            },
            unsure,
        );
        nearest
    }

    /// Tries all that the sites may make in the pixel.
    #[inline(always)]
    fn search_sites<S: Simd>(
        &self,
        simd: S,
        gaps: &mut GapBuffers,
        rules: &Rules,
        spot: Spot,
        unsure: &mut Vec<usize>,
    ) {
        let n = spot.sites;
        let near = |gaps: &GapBuffers, k: usize| {
            if spot.wide {
                gaps.wide.offset(gaps.sites[k])
            } else {
                gaps.near.offset(gaps.sites[k])
            }
        };
        for i in 0..n {
            for m in i + 1..n {
                for k in m + 1..n {
                    let three = [near(gaps, i), near(gaps, m), near(gaps, k)];
                    if may_make(three, spot.number) {
                        let sites = three.map(exact);
                        let [a, b, c] = sites;
                        if let Some(centre) = circumcentre(minus(b, a), minus(c, a)) {
                            let centre = (centre.0 + a.0, centre.1 + a.1);
                            self.try_place(simd, gaps, rules, spot, centre, &sites, unsure);
                        }
                    }
                }
            }
        }
        if !rules.domain.is_periodic() && self.touches_border(spot) {
            self.search_border(simd, gaps, rules, spot, unsure);
        }
    }

    /// Returns whether a border line of a bounded domain runs through a pixel.
    fn touches_border(&self, spot: Spot) -> bool {
        let (column, row) = self.frame.column_row(spot.cell);
        let (x, y) = corner(spot.number);
        let low = [(column << CELL_BITS) + x, (row << CELL_BITS) + y];
        (0..2).any(|axis| {
            let first = i64::from(low[axis]) + self.frame.origin[axis];
            let last = i64::from(self.frame.sides[axis]);
            first == 0 || (first <= last && last < first + i64::from(PIXEL_SIDE))
        })
    }

    #[cold]
    fn search_border<S: Simd>(
        &self,
        simd: S,
        gaps: &mut GapBuffers,
        rules: &Rules,
        spot: Spot,
        unsure: &mut Vec<usize>,
    ) {
        let near = if spot.wide { &gaps.wide } else { &gaps.near };
        let sites: Vec<Site> = gaps.sites[..spot.sites]
            .iter()
            .map(|&k| exact(near.offset(k)))
            .collect();
        for (k, &a) in sites.iter().enumerate() {
            let border = Border::around(&rules.domain, self.site_point(spot.cell, a));
            for &m in &sites[k + 1..] {
                for place in border.as_far_from(minus(m, a)) {
                    let place = (place.0 + a.0, place.1 + a.1);
                    self.try_place(simd, gaps, rules, spot, place, &[a, m], unsure);
                }
            }
            for corner in border.corners() {
                let place = (corner.0 + a.0, corner.1 + a.1);
                self.try_place(simd, gaps, rules, spot, place, &[a], unsure);
            }
        }
    }

    /// Returns the domain's point of a site of a cell.
    fn site_point(&self, cell: usize, site: Site) -> Point {
        let (column, row) = self.frame.column_row(cell);
        self.frame.point(
            (column << CELL_BITS) + site.0 as i32,
            (row << CELL_BITS) + site.1 as i32,
        )
    }

    /// Adds a place to the candidates if it is one: the definition, word for word.
    fn try_place<S: Simd>(
        &self,
        simd: S,
        gaps: &mut GapBuffers,
        rules: &Rules,
        spot: Spot,
        place: Site,
        sites: &[Site],
        unsure: &mut Vec<usize>,
    ) {
        let (left, bottom) = corner(spot.number);
        let inside = |v: i64, low: i32| (0..i64::from(PIXEL_SIDE)).contains(&(v - i64::from(low)));
        if !inside(place.0, left) || !inside(place.1, bottom) {
            return;
        }
        let (column, row) = self.frame.column_row(spot.cell);
        let x = (column << CELL_BITS) + place.0 as i32;
        let y = (row << CELL_BITS) + place.1 as i32;
        if !self.frame.holds(x, y) {
            return;
        }
        let distance = |site: &Site| norm_squared(minus(*site, place));
        let nearest = sites.iter().map(distance).min().unwrap_or(0);
        let limit = (nearest - NEARER_SLACK).max(R_SQUARED + 1);
        let near = if spot.wide { &gaps.wide } else { &gaps.near };
        if near.any_nearer(simd, place, limit) {
            return;
        }
        match self.is_found(gaps, rules, spot, place, sites) {
            Known::No => {}
            Known::Unknown => unsure.push(spot.cell),
            Known::Yes => {
                let point = self.frame.point(x, y);
                gaps.candidates.push(Candidate {
                    rank: 0,
                    place: point.row_major(),
                    x,
                    y,
                });
            }
        }
    }

    /// Returns whether one of the sites is a detector that finds the place.
    fn is_found(
        &self,
        gaps: &GapBuffers,
        rules: &Rules,
        spot: Spot,
        place: Site,
        sites: &[Site],
    ) -> Known {
        let mut known = Known::No;
        for site in sites {
            // Only near closed borders does it matter where a detector is.
            let point = if self.frame.periodic {
                Point::default()
            } else {
                self.site_point(spot.cell, *site)
            };
            let reach = Reach::new(&rules.domain, rules.search, point);
            let within =
                |a: Site, reach: i32| norm_squared(a) <= i64::from(reach) * i64::from(reach);
            if !within(minus(*site, place), reach.radius)
                || !sites
                    .iter()
                    .all(|other| within(minus(*other, *site), reach.search))
            {
                continue;
            }
            match self.is_detector(gaps, spot, *site) {
                Known::Yes => return Known::Yes,
                Known::Unknown => known = Known::Unknown,
                Known::No => {}
            }
        }
        known
    }

    fn is_detector(&self, gaps: &GapBuffers, spot: Spot, site: Site) -> Known {
        let (column, row) = self.frame.column_row(spot.cell);
        let x = (column << CELL_BITS) + site.0 as i32;
        let y = (row << CELL_BITS) + site.1 as i32;
        match spot.detectors {
            Detectors::First => self.is_first_detector(spot.cell, x, y),
            Detectors::Inserted => {
                let key = site_key(self.frame.cell_at(x, y), pack(x, y));
                match gaps.detectors.binary_search(&key) {
                    Ok(_) => Known::Yes,
                    Err(_) => Known::No,
                }
            }
        }
    }

    /// Returns whether a lost sample is within [`DETECTOR_REACH`] of (x, y), a site of a place in `cell`.
    fn is_first_detector(&self, cell: usize, x: i32, y: i32) -> Known {
        let limit = i64::from(DETECTOR_REACH) * i64::from(DETECTOR_REACH);
        let reaches =
            |lost: &Lost| norm_squared((i64::from(lost.x - x), i64::from(lost.y - y))) <= limit;
        // The lost sample that covered the place is nearly always near enough to the site, too.
        let stride = self.frame.stride();
        let rows = [cell, cell - stride, cell + stride].into_iter();
        let mut around = rows.flat_map(|row| [row, row - 1, row + 1]);
        let proves = |lost: &Lost| lost.loss == Loss::Certain && reaches(lost);
        if around.any(|c| self.lost_in(c).any(proves)) {
            return Known::Yes;
        }
        let (column, row) = (x >> CELL_BITS, y >> CELL_BITS);
        let [columns, rows] = self.frame.cells;
        let [[left, right], [bottom, top]] = self.frame.goes_on;
        let mut known = Known::No;
        // Beyond the frame nothing is known.
        if left && column < 3
            || right && column >= columns - 3
            || bottom && row < 3
            || top && row >= rows - 3
        {
            known = Known::Unknown;
        }
        for row in (row - 3).max(-PAD)..=(row + 3).min(rows + PAD - 1) {
            for column in (column - 3).max(-PAD)..=(column + 3).min(columns + PAD - 1) {
                for lost in self.lost_in(self.frame.cell(column, row)) {
                    if reaches(lost) {
                        if lost.loss == Loss::Certain {
                            return Known::Yes;
                        }
                        known = Known::Unknown;
                    }
                }
            }
        }
        known
    }

    /// Inserts candidates in their turn.
    #[inline(always)]
    fn insert_candidates<S: Simd>(
        &mut self,
        simd: S,
        gaps: &mut GapBuffers,
        rules: &Rules,
        iteration: u32,
    ) {
        let key = rules.key.derive(Stream::Iteration, iteration);
        for candidate in &mut gaps.candidates {
            let (y, x) = candidate.place;
            candidate.rank = key.draw_at(x, y)[0];
        }
        gaps.candidates.sort_unstable();
        gaps.candidates.dedup();
        for k in 0..gaps.candidates.len() {
            let Candidate { x, y, .. } = gaps.candidates[k];
            if self.covered(simd, x, y) {
                continue;
            }
            let cell = self.frame.cell_at(x, y);
            if self.flags[cell] & flag::HOT != 0 {
                self.make_hot(cell);
                continue;
            }
            self.insert(x, y, inserted_tag(iteration));
            gaps.inserted.push(Inserted { x, y, iteration });
        }
    }
}

/// A pixel under search.
#[derive(Clone, Copy)]
struct Spot {
    cell: usize,
    number: u8,
    detectors: Detectors,
    /// Whether the wide gathering serves it.
    wide: bool,
    /// How many sites there are.
    sites: usize,
}

/// Returns the tag of a sample inserted in `iteration`.
pub(crate) fn inserted_tag(iteration: u32) -> u64 {
    u64::from(u32::MAX) << 32 | u64::from(iteration)
}

/// Returns the iteration that inserted the sample of a tag, or `None` for a tiled one.
pub(crate) const fn inserted_in(tag: u64) -> Option<u32> {
    if tag >> 32 == u32::MAX as u64 {
        Some(tag as u32)
    } else {
        None
    }
}

/// Returns how many cells away a sample may be from a candidate that it makes or unmakes: 2r and 16
/// units, or 3.5r where borders are closed.
pub(crate) const fn reach_cells(periodic: bool) -> i32 {
    if periodic { 3 } else { 4 }
}

fn site_key(cell: usize, packed: u32) -> u64 {
    (cell as u64) << 32 | u64::from(packed)
}

/// Returns the lowest corner of a pixel in its cell.
#[inline(always)]
pub(crate) const fn corner(number: u8) -> (i32, i32) {
    (
        (number as i32 % PIXELS as i32) * PIXEL_SIDE,
        (number as i32 / PIXELS as i32) * PIXEL_SIDE,
    )
}

/// Returns the middle of a pixel in its cell.
#[inline(always)]
fn centre(number: u8) -> (f32, f32) {
    let (x, y) = corner(number);
    ((x + PIXEL_SIDE / 2) as f32, (y + PIXEL_SIDE / 2) as f32)
}

#[inline(always)]
pub(crate) fn each_bit(mut bits: u64) -> impl Iterator<Item = u8> {
    std::iter::from_fn(move || {
        let bit = bits.trailing_zeros() as u8;
        (bits != 0).then(|| bits &= bits - 1)?;
        Some(bit)
    })
}

fn pixels_of<'a>(first: &[u32], pixels: &'a [Pixel], index: u32) -> &'a [Pixel] {
    let end = first
        .get(index as usize + 1)
        .map_or(pixels.len(), |&next| next as usize);
    &pixels[first[index as usize] as usize..end]
}

/// Returns whether the centre of three sites may, rounded, be an uncovered place of the pixel. The f64 products
/// are exact (17-bit offsets); two units and 8 R of squared distance are far more than the rest rounds.
#[inline(always)]
fn may_make([a, b, c]: [[f64; 2]; 3], pixel: u8) -> bool {
    let (bx, by, cx, cy) = (b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]);
    let d = 2.0 * (bx * cy - by * cx);
    let (b2, c2) = (bx * bx + by * by, cx * cx + cy * cy);
    // The centre, seen from a, times d.
    let (x, y) = (b2 * cy - c2 * by, c2 * bx - b2 * cx);
    let (mx, my) = centre(pixel);
    let (mx, my) = (f64::from(mx) - a[0], f64::from(my) - a[1]);
    let half = f64::from(PIXEL_SIDE / 2 + 2) * d.abs();
    let least = (R_SQUARED - 8 * i64::from(R)) as f64;
    (x - mx * d).abs() <= half && (y - my * d).abs() <= half && x * x + y * y > least * d * d
}

fn exact(site: [f64; 2]) -> Site {
    (site[0] as i64, site[1] as i64)
}

const fn minus(a: Site, b: Site) -> Site {
    (a.0 - b.0, a.1 - b.1)
}

const fn norm_squared(a: Site) -> i64 {
    a.0 * a.0 + a.1 * a.1
}
