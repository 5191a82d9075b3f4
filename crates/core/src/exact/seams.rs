//! The fast engine of exact tiling. It makes windows of the same set as the engine to be read ([`super::engine`]), in the same
//! order of arrival, and differs in what it touches: *only what is near a seam is worked on*, and the rest of each block is
//! copied as KDRT's parallel engine copies it.
//!
//! Samples deeper than [`DEEP`] in their block are not even looked at until a cell that their disks touch is asked about. What
//! covers a place is read from lists that hold eight samples in a vector ([`disks`]); so is which quarters of a cell one sample
//! covers ([`open`]).
//!
//! A window may lie on a ground beyond which all is unknown. A dart that no certain earlier sample covers is *doubtful* there if
//! something unknown, or something doubtful that is earlier, may cover it ([`doubt`]).

#![allow(clippy::inline_always)]

mod disks;
mod doubt;
mod emit;
mod open;

use fearless_simd::{Simd, dispatch};
use glam::{I64Vec2, IVec2};

use crate::engine::parallel::clip::{Clipper, PlacedBlock};
use crate::engine::parallel::instructions::InstructionSet;
use crate::engine::parallel::region::Region;
use crate::error::SampleError;
use crate::exact::agenda::{Agenda, What};
use crate::exact::bare::{MarkedCells, PieceCell};
use crate::exact::cells::NumberCells;
use crate::exact::darts::{DrawnDart, PlacedDart};
use crate::exact::filter::SampleFilter;
use crate::exact::ground::{Ground, LATE_MARGIN};
use crate::exact::history::{LATE_LEVEL, PatternHistory};
use crate::exact::pieces::pieces;
use crate::exact::present::FIRST_INSERTED;
use crate::lattice::{Point, R, Rect, Rect64, covers_offset};
use crate::pattern::Symmetry;
use crate::stages::darts::LAST_LEVEL;

use disks::{Coverage, DOUBTFUL, DiskLists};
use doubt::Zone;
use open::OpenCell;

/// Samples deeper in their block than this are listed only where they are asked about; where something is unknown, those deeper
/// than [`LATE_REACH`], if that is more. So deep no disk touches a cell that
/// two blocks share, so that a cell's list has deep samples of one block alone.
const DEEP: i64 = 5 * R as i64 / 2;

/// Late samples of the pattern this near to the end of what is known may depend on what is beyond, and must be listed.
const LATE_REACH: i64 = (LATE_MARGIN + R) as i64;

/// No place of a frame is so far from another one, and sums of two still fit.
const FAR: i64 = 1 << 28;

/// A part of a block in the frame.
#[derive(Clone, Copy)]
struct SeamTile {
    /// The index of the block, and its index among those of the frame.
    block: u32,
    placed: u32,
    /// The part of the block in the frame.
    rect: Rect,
    /// The block, cut off far outside of the frame; if something is unknown, the part in the frame, so that the end of what is
    /// known is a seam.
    whole: Rect,
    symmetry: Symmetry,
    /// How far it is moved from where the domain has it.
    moved: IVec2,
    /// The first of its pieces, and the first of the next tile.
    first_piece: u32,
    end_piece: u32,
    /// The pattern's samples that are lost here.
    missing: SampleFilter,
}

/// A sample that a list has.
#[derive(Clone, Copy)]
struct ListedSample {
    place: Point,
    tile: u32,
    /// Its index in the pattern; from [`FIRST_INSERTED`] on, that among the darts that are samples here alone.
    number: u32,
    /// Whether an interior has it, or it is lost or doubtful: then it is not handed out with the listed ones.
    is_left_out: bool,
}

impl ListedSample {
    const fn pattern(&self) -> Option<u32> {
        if self.number < FIRST_INSERTED {
            Some(self.number)
        } else {
            None
        }
    }
}

/// A sample of the pattern that an earlier one covers.
struct MissingSample {
    place: Point,
    /// Whether an interior has it.
    is_deep: bool,
}

/// Windows of an exact tiling. Its buffers are used again from window to window.
pub(super) struct SeamTiling<'a> {
    history: &'a PatternHistory,
    ground: Ground,
    blocks: Vec<PlacedBlock>,
    tiles: Vec<SeamTile>,
    samples: Vec<ListedSample>,
    inserted: Vec<PlacedDart>,
    disks: DiskLists,
    lost: Vec<MissingSample>,
    /// Where doubtful samples are.
    doubtful: Vec<Point>,
    zones: Vec<Zone>,
    /// The indices of the zones, at their lowest places.
    zone_cells: NumberCells,
    /// Samples that a zone reaches.
    reached: Vec<u32>,
    agenda: Agenda,
    marked: MarkedCells,
    /// Where the frame has each piece of the tiles.
    bounds: Vec<Rect>,
    /// Marked cells that were not cut.
    fresh: Vec<PieceCell>,
    open: Vec<OpenCell>,
    spare: Vec<OpenCell>,
    drawn: Vec<DrawnDart>,
    plain: Region<false>,
    tagged: Region<true>,
}

impl<'a> SeamTiling<'a> {
    /// Returns buffers for windows of tilings with a pattern.
    pub(super) fn new(history: &'a PatternHistory) -> Self {
        Self {
            history,
            ground: Ground::default(),
            blocks: Vec::new(),
            tiles: Vec::new(),
            samples: Vec::new(),
            inserted: Vec::new(),
            disks: DiskLists::default(),
            lost: Vec::new(),
            doubtful: Vec::new(),
            zones: Vec::new(),
            zone_cells: NumberCells::default(),
            reached: Vec::new(),

            agenda: Agenda::default(),
            marked: MarkedCells::default(),
            bounds: Vec::new(),
            fresh: Vec::new(),
            open: Vec::new(),
            spare: Vec::new(),
            drawn: Vec::new(),
            plain: Region::default(),
            tagged: Region::default(),
        }
    }

    /// Computes what a ground has near its seams.
    pub(super) fn run(&mut self, clipper: &Clipper, ground: Ground) -> Result<(), SampleError> {
        clipper.blocks(&ground.frame, &mut self.blocks)?;
        self.ground = ground;
        dispatch!(InstructionSet::best().level(), simd => self.compute(simd, clipper));
        Ok(())
    }

    /// Lays down what is near the seams, and follows the differences level by level.
    #[inline(always)]
    fn compute<S: Simd>(&mut self, simd: S, clipper: &Clipper) {
        self.reset();
        for index in 0..self.blocks.len() {
            let block = self.blocks[index];
            // Some blocks reach into the frame with their margins alone.
            if let Some(rect) = block.rect.within(&self.ground.rect()) {
                self.add_tile(&block, index as u32, rect);
                self.clip(clipper, &block);
            }
        }

        for level in 0..=LAST_LEVEL {
            if level == LATE_LEVEL {
                self.open_borders();
            }
            if level >= LATE_LEVEL {
                self.cut(simd, clipper, level);
                // Nothing is left to do: no cell throws, and no question waits for this level or a later one.
                if self.open.is_empty() && self.agenda.is_empty_from(level) {
                    return;
                }
                let (first_cell, after) = (0, None);
                self.throw(simd, clipper, first_cell, level, after);
            }
            self.settle(simd, clipper, level);
        }
    }

    fn reset(&mut self) {
        self.tiles.clear();
        self.samples.clear();
        self.inserted.clear();
        self.lost.clear();
        self.doubtful.clear();
        self.zones.clear();
        self.agenda.clear();
        self.marked.clear();
        self.bounds.clear();
        self.fresh.clear();
        self.open.clear();
        let end = self.ground.rect().max;
        self.disks.reset(end);
        if self.ground.has_unknown() {
            self.zone_cells.reset(end);
        }
    }

    /// Adds the tile of the part of a block that lies in the frame.
    fn add_tile(&mut self, block: &PlacedBlock, placed: u32, rect: Rect) {
        let (tile, first_piece) = (self.tiles.len() as u32, self.bounds.len() as u32);
        let symmetry = Symmetry(block.symmetry);
        // Late darts at places that something unknown may cover are not thrown.
        if let Some(core) = Rect64::from(rect).within(&self.ground.core()) {
            let start = I64Vec2::from(block.start) + I64Vec2::from(core.min) - block.rect.min;
            let held = self.history.pattern().domain().rect();
            for piece in pieces(tile, &core, start, symmetry, &held) {
                self.bounds.push(piece.placed(&piece.sources));
                self.marked.add(piece);
            }
        }

        let near = |at: I64Vec2| {
            let at = at.clamp(I64Vec2::splat(-FAR), I64Vec2::splat(FAR));
            Point::new(at.x as i32, at.y as i32)
        };
        let whole = Rect {
            min: near(block.rect.min),
            max: near(block.rect.max),
        };
        let has_unknown = self.ground.has_unknown();
        self.tiles.push(SeamTile {
            block: block.index,
            placed,
            rect,
            whole: if has_unknown { rect } else { whole },
            symmetry,
            moved: self.ground.moved(block),
            first_piece,
            end_piece: self.bounds.len() as u32,
            missing: SampleFilter::default(),
        });
    }

    /// Lists the samples of the last tile that are near its border. Those around it count as lost from the beginning: the darts
    /// that they refused are woken.
    #[inline(always)]
    fn clip(&mut self, clipper: &Clipper, block: &PlacedBlock) {
        let tile = self.tiles.len() as u32 - 1;
        let SeamTile { whole, .. } = self.tiles[tile as usize];
        let target = self.ground.rect();

        for part in Rect64::from(whole).without(&self.interior(&whole)) {
            clipper.clip(block, &part, &target, |x, y, pattern| {
                let place = Point::new(x, y);
                let id = self.list_near(place, tile, pattern);
                // A sample deeper than r stays, since samples of other blocks cover only places within r of the border.
                if whole.depth(place) <= R || self.is_late_near_unknown(place, pattern) {
                    self.agenda.add(self.dart(id), What::Sample(id));
                }
            });
        }

        // A sample at most r outside may be the first blocker of darts inside.
        let reach = i64::from(R);
        let around = Rect {
            min: Point::new(target.min.x - R, target.min.y - R),
            max: Point::new(target.max.x + R, target.max.y + R),
        };
        let whole = Rect64::from(whole);
        for part in whole.grown(reach, reach).without(&whole) {
            clipper.clip(block, &part, &around, |x, y, pattern| {
                self.wake(tile, Point::new(x, y), pattern);
            });
        }
    }

    /// Lists a sample of the pattern in all cells that its disk touches, and returns its id.
    #[inline(always)]
    fn list_near(&mut self, place: Point, tile: u32, pattern: u32) -> u32 {
        let id = self.samples.len() as u32;
        self.samples.push(ListedSample {
            place,
            tile,
            number: pattern,
            is_left_out: false,
        });
        self.disks
            .add(place, self.history.arrival(pattern).when(), id);
        id
    }

    /// Returns the dart that a sample is.
    fn dart(&self, id: u32) -> PlacedDart {
        let sample = &self.samples[id as usize];
        match sample.pattern() {
            Some(pattern) => PlacedDart {
                arrival: self.history.arrival(pattern),
                source: self.history.pattern().samples()[pattern as usize],
                place: self.in_domain(sample.tile, sample.place),
            },
            None => self.inserted[(sample.number - FIRST_INSERTED) as usize],
        }
    }

    /// Returns where the domain has a place of the frame.
    fn in_domain(&self, tile: u32, place: Point) -> Point {
        let IVec2 { x, y } = self.tiles[tile as usize].moved;
        Point::new(place.x.wrapping_sub(x), place.y.wrapping_sub(y))
    }

    /// Returns where the frame has a place that the domain has in a tile.
    fn in_frame(&self, tile: u32, place: Point) -> Point {
        let IVec2 { x, y } = self.tiles[tile as usize].moved;
        // The domain may begin so far below the frame that only the sum fits into the integers.
        Point::new(place.x.wrapping_add(x), place.y.wrapping_add(y))
    }

    /// Puts on the agenda the darts whose first blocker, a sample of the pattern at `place`, is missing.
    fn wake(&mut self, tile: u32, place: Point, pattern: u32) {
        let history = self.history;
        let SeamTile { rect, symmetry, .. } = self.tiles[tile as usize];
        for waiting in history.waiting(pattern) {
            let IVec2 { x, y } = symmetry.turn(waiting.offset);
            let dart_place = Point::new(place.x + x, place.y + y);
            // Outside of the tile another block has darts of its own.
            if rect.contains(dart_place) {
                let dart = PlacedDart {
                    arrival: waiting.arrival,
                    source: history.source(pattern, waiting.offset),
                    place: self.in_domain(tile, dart_place),
                };
                self.agenda.add(dart, What::Dart(tile));
            }
        }
    }

    /// Decides what arrives with a level, in order.
    #[inline(always)]
    fn settle<S: Simd>(&mut self, simd: S, clipper: &Clipper, level: u32) {
        self.agenda.begin(level);
        while let Some(next) = self.agenda.next() {
            match next.what {
                What::Sample(id) => self.decide_sample(simd, clipper, id, &next.dart),
                What::Dart(tile) => self.decide_dart(simd, clipper, &next.dart, tile),
            }
        }
    }

    /// Loses a sample of the pattern if an earlier one covers it. Everything earlier is final.
    #[inline(always)]
    fn decide_sample<S: Simd>(&mut self, simd: S, clipper: &Clipper, id: u32, dart: &PlacedDart) {
        let ListedSample { place, tile, .. } = self.samples[id as usize];
        let cell = self.whole_cell(clipper, place, tile);
        let is_earlier = |other: u32| other != id && self.dart(other) < *dart;
        let when = dart.arrival.when();
        let is_changed = match self.disks.coverage(simd, cell, place, when, is_earlier) {
            Coverage::Certain => self.disks.remove(simd, place) && self.lose(id),
            coverage => {
                let is_doubtful =
                    coverage == Coverage::Doubtful || self.is_in_doubt(place, dart.arrival);
                is_doubtful && self.disks.doubt(simd, place) && self.doubt(id)
            }
        };

        let level = dart.arrival.level();
        if is_changed && level >= LATE_LEVEL {
            // Darts of the cells that its disk touches and that are earlier were refused by other samples.
            let first = self.open.len();
            self.cut_fresh(simd, clipper, level, dart.arrival);
            self.throw(simd, clipper, first, level, Some(dart));
        }
    }

    /// Keeps account of a lost sample, which has been removed from the lists. Returns `true`.
    #[inline(never)]
    fn lose(&mut self, id: u32) -> bool {
        let sample = &mut self.samples[id as usize];
        let is_deep = std::mem::replace(&mut sample.is_left_out, true);
        let place = sample.place;
        self.lost.push(MissingSample { place, is_deep });
        self.release(id);
        true
    }

    /// Opens what a sample that is lost or doubtful refused.
    fn release(&mut self, id: u32) {
        let ListedSample {
            place,
            tile,
            number,
            ..
        } = self.samples[id as usize];
        self.tiles[tile as usize].missing.add(number);

        // The darts that it refused are decided again, and its disk may be bare. Cells are marked in its own block alone: in
        // other blocks its disk reaches only cells within r of the border, and all of those are marked.
        self.wake(tile, place, number);
        // Cells that another sample covers stay closed; should it be lost, its disk marks them.
        let (history, tile) = (self.history, &self.tiles[tile as usize]);
        for piece in tile.first_piece..tile.end_piece {
            let inside = self.marked.pieces()[piece as usize].sources_around(&tile.whole, R);
            let is_closed = |column, row| history.is_covered(column, row, &inside, &tile.missing);
            self.marked
                .mark_disk(piece, place, is_closed, &mut self.fresh);
        }
    }

    /// Makes a dart a sample, unless it is one or an earlier sample covers it.
    #[inline(always)]
    fn decide_dart<S: Simd>(&mut self, simd: S, clipper: &Clipper, dart: &PlacedDart, tile: u32) {
        let place = self.in_frame(tile, dart.place);
        let cell = self.whole_cell(clipper, place, tile);
        let when = dart.arrival.when();
        let mut is_present = false;
        let is_earlier = |other: u32| {
            let order = self.dart(other).cmp(dart);
            is_present |= order.is_eq();
            order.is_le()
        };
        let coverage = self.disks.coverage(simd, cell, place, when, is_earlier);
        // The dart of a present sample does not become a second sample.
        if coverage == Coverage::Certain || is_present {
            return;
        }
        let is_doubtful = coverage == Coverage::Doubtful || self.is_in_doubt(place, dart.arrival);

        // Samples of the pattern that arrive later may be covered by it: they are decided again when their turn comes.
        let mut later = Vec::new();
        self.disks
            .each_later(simd, cell, place, when, |id| later.push(id));
        for id in later {
            let other = self.dart(id);
            if self.samples[id as usize].pattern().is_some() && other > *dart {
                self.agenda.add(other, What::Sample(id));
            }
        }

        let id = self.samples.len() as u32;
        self.samples.push(ListedSample {
            place,
            tile,
            number: FIRST_INSERTED + self.inserted.len() as u32,
            is_left_out: false,
        });
        self.inserted.push(*dart);
        self.disks.add(place, when, id);
        if is_doubtful {
            self.disks.doubt(simd, place);
            self.doubt_inserted(id);
        }
    }

    /// Returns the cell of a place of a tile, whose list has samples deep in the block, too, from now on.
    #[inline(always)]
    fn whole_cell(&mut self, clipper: &Clipper, place: Point, tile: u32) -> usize {
        let cell = self.disks.cell(place);
        if !self.disks.make_whole(cell) {
            self.complete(clipper, cell, place, tile);
        }
        cell
    }

    /// Adds to a cell's list the samples deep in a block whose disks touch the cell.
    #[inline(never)]
    fn complete(&mut self, clipper: &Clipper, cell: usize, place: Point, tile: u32) {
        let SeamTile { placed, whole, .. } = self.tiles[tile as usize];
        let min = Point::new(place.x & -R, place.y & -R);
        // Samples beyond the frame are in no list.
        let ground = self.ground.rect().max;
        let around = Rect {
            min: Point::new((min.x - R).max(0), (min.y - R).max(0)),
            max: Point::new((min.x + 2 * R).min(ground.x), (min.y + 2 * R).min(ground.y)),
        };
        // Most cells that are asked about lie near the border.
        let deepest = whole.depth(Point::new(min.x + R / 2, min.y + R / 2)) + R / 2;
        if i64::from(deepest + R) < self.deep() {
            return;
        }

        let block = self.blocks[placed as usize];
        let interior = self.interior(&whole);
        clipper.clip(&block, &interior, &around, |x, y, pattern| {
            let at = Point::new(x, y);
            // Disks of samples in the corners may pass the cell by.
            let nearest = Point::new(x.clamp(min.x, min.x + R - 1), y.clamp(min.y, min.y + R - 1));
            if !covers_offset(at - nearest) {
                return;
            }

            // Other samples may have the filter's bits of a lost or doubtful one.
            let may_be_missing = self.tiles[tile as usize].missing.may_have(pattern);
            if may_be_missing && self.lost.iter().any(|lost| lost.place == at) {
                return;
            }
            // It may have become doubtful while other cells alone listed it.
            let is_doubtful = may_be_missing && self.doubtful.contains(&at);

            let id = self.samples.len() as u32;
            self.samples.push(ListedSample {
                place: at,
                tile,
                number: pattern,
                is_left_out: true,
            });
            let when = self.history.arrival(pattern).when();
            let listed = if is_doubtful { id | DOUBTFUL } else { id };
            self.disks.add_to(cell, at, when, listed);
        });
    }

    /// Returns how deep in their tiles samples are listed.
    fn deep(&self) -> i64 {
        if self.ground.has_unknown() {
            DEEP.max(LATE_REACH)
        } else {
            DEEP
        }
    }

    /// Returns the places that are deeper in a tile than those that are listed; none, at its lowest place, of a small tile.
    #[inline(always)]
    fn interior(&self, whole: &Rect) -> Rect64 {
        let (whole, deep) = (Rect64::from(*whole), self.deep());
        let Rect64 { min, max } = whole.grown(-deep - 1, -deep);
        if min.cmplt(max).all() {
            Rect64 { min, max }
        } else {
            Rect64 {
                min: whole.min,
                max: whole.min,
            }
        }
    }
}
