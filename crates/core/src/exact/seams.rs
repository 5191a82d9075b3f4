//! The fast engine of exact tiling. It makes windows of the same set as the engine to be read ([`super::engine`]), in the same
//! order of arrival, and differs in the samples it touches: *it works only on those near a seam*, and copies the rest
//! of each block as KDRT's parallel engine does.
//!
//! Samples deeper than [`lay::DEEP`] in their block are not even looked at until a cell that their disks touch is asked
//! about. Near the end of the known part, those at most R inside the part where late darts are known, or outside of it,
//! are listed, too. What covers a place is read from lists that hold eight samples in a vector ([`disks`]); so is which
//! quarters of a cell one sample covers ([`open`]).
//!
//! A window may lie on a ground beyond which all is unknown. A dart that no certain earlier sample covers is *doubtful* there if
//! something unknown, or something doubtful that is earlier, may cover it ([`doubt`]).

#![allow(clippy::inline_always)]

mod decide;
mod disks;
mod doubt;
mod emit;
mod halves;
mod keyed;
mod lay;
mod open;

use fearless_simd::{Simd, dispatch};
use glam::IVec2;

use crate::engine::parallel::clip::{Clipper, PlacedBlock};
use crate::engine::parallel::region::Region;
use crate::error::SampleError;
use crate::exact::agenda::Agenda;
use crate::exact::bare::{MarkedCells, PieceCell};
use crate::exact::cells::NumberCells;
use crate::exact::darts::{DrawnDart, PlacedDart};
use crate::exact::filter::SampleFilter;
use crate::exact::ground::Ground;
use crate::exact::history::{LATE_LEVEL, PatternHistory};
use crate::exact::present::FIRST_INSERTED;
use crate::instructions::InstructionSet;
use crate::lattice::{Point, Rect};
use crate::pattern::Symmetry;
use crate::stages::darts::LAST_LEVEL;
use crate::varying::{Class, Shape};

use disks::DiskLists;
use doubt::Zone;
use keyed::KeyedLists;
use open::OpenCell;

/// A part of a block in the frame.
#[derive(Clone, Copy)]
struct SeamTile {
    /// The index of the block, and its index among those of the frame.
    block: u32,
    placed: u32,
    /// The part of the block in the frame.
    rect: Rect,
    /// The block, cut off far outside of the frame; if something is unknown, the part in the frame, so that the border
    /// of the known part is a seam.
    whole: Rect,
    symmetry: Symmetry,
    /// How far it is moved from where the domain has it.
    moved: IVec2,
    /// The first of its pieces, and the first of the next tile.
    first_piece: u32,
    end_piece: u32,
    /// Whether places of the tile may lie outside of the shape. All samples of such a tile are listed at once.
    is_cut: bool,
    /// The pattern's samples that are lost here, or lie outside of the shape.
    missing: SampleFilter,
}

/// A sample that a list has.
#[derive(Clone, Copy)]
struct ListedSample {
    place: Point,
    tile: u32,
    /// Its index in the pattern; from [`FIRST_INSERTED`] on, that among the darts that are samples here and not in the
    /// pattern.
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

/// That a sample of the pattern is lost or, if not, doubtful.
#[derive(Clone, Copy)]
struct PatternFate {
    place: Point,
    is_lost: bool,
}

/// Windows of an exact tiling. Its buffers are used again from window to window.
pub(super) struct SeamTiling<'a> {
    history: &'a PatternHistory,
    /// The places of the domain that darts can lie at.
    shape: &'a Shape,
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
    /// Darts whose first blocker is missing, by their second one: they are asked about only if that is lost, too. More than half of
    /// the darts behind missing samples are not.
    deferred: KeyedLists<PlacedDart>,
    /// The pattern's samples that are lost or doubtful.
    fates: KeyedLists<PatternFate>,
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
    /// Returns buffers for windows of tilings of a shape with a pattern.
    pub(super) fn new(history: &'a PatternHistory, shape: &'a Shape) -> Self {
        Self {
            history,
            shape,
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
            deferred: KeyedLists::default(),
            fates: KeyedLists::default(),
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

    /// Lays down the samples near the seams, and follows the differences level by level.
    #[inline(always)]
    fn compute<S: Simd>(&mut self, simd: S, clipper: &Clipper) {
        self.reset();
        for index in 0..self.blocks.len() {
            let block = self.blocks[index];
            // Some blocks reach into the frame with their margins alone.
            let Some(rect) = block.rect.within(&self.ground.rect()) else {
                continue;
            };
            // Outside of the shape there are no darts.
            let class = self.class(self.ground.moved(&block), &rect);
            if class != Class::Outside {
                let is_cut = class == Class::Mixed;
                self.add_tile(&block, index as u32, rect, is_cut);
                self.clip(clipper, &block);
            }
        }

        // The history keeps the refused darts of levels before `LATE_LEVEL`: they are looked up where the sample that
        // refused them is missing. Refused darts of later levels are not kept, and are thrown again in the cells that
        // may be bare. Cells along the borders of blocks are among these cells, since samples that the pattern has
        // beyond a border are missing in the block.
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
                // All open cells throw, and all darts of the level count.
                let (first_cell, after) = (0, None);
                self.throw(simd, clipper, first_cell, level, after);
            }
            self.settle(simd, clipper, level);
        }
    }

    /// Removes what the window before left. The blocks are those of this window already; `reached`, `spare`, `drawn`
    /// and the regions are emptied where they are used.
    fn reset(&mut self) {
        self.tiles.clear();
        self.samples.clear();
        self.inserted.clear();
        self.lost.clear();
        self.doubtful.clear();
        self.zones.clear();
        self.agenda.clear();
        self.deferred.clear();
        self.fates.clear();
        self.marked.clear();
        self.bounds.clear();
        self.fresh.clear();
        self.open.clear();
        let end = self.ground.rect().max;
        self.disks.reset(end);
        // Where everything is known, nothing is doubtful, and there are no zones.
        if self.ground.has_unknown() {
            self.zone_cells.reset(end);
        }
    }

    /// Returns the dart that a sample is.
    fn dart(&self, id: u32) -> PlacedDart {
        let sample = &self.samples[id as usize];
        match sample.pattern() {
            Some(pattern) => {
                let SeamTile { moved, .. } = self.tiles[sample.tile as usize];
                self.history.dart(pattern, in_domain(moved, sample.place))
            }
            None => self.inserted[(sample.number - FIRST_INSERTED) as usize],
        }
    }

    /// Returns which places of a rectangle of the frame, moved so far from where the domain has it, are in the shape.
    fn class(&self, moved: IVec2, rect: &Rect) -> Class {
        self.shape.class_of(&Rect {
            min: in_domain(moved, rect.min),
            max: in_domain(moved, rect.max),
        })
    }

    /// Returns whether all places of a rectangle of the frame, in a tile, lie outside of the shape: no dart is thrown there.
    #[inline(always)]
    fn is_all_outside(&self, tile: u32, rect: &Rect) -> bool {
        let SeamTile { is_cut, moved, .. } = self.tiles[tile as usize];
        is_cut && self.class(moved, rect) == Class::Outside
    }

    /// Returns whether a place of the frame in a tile lies outside of the shape.
    #[inline(always)]
    fn is_outside(&self, tile: u32, place: Point) -> bool {
        let SeamTile { is_cut, moved, .. } = self.tiles[tile as usize];
        is_cut && !self.shape.inside(in_domain(moved, place))
    }

    /// Returns where the frame has a place that the domain has in a tile.
    fn in_frame(&self, tile: u32, place: Point) -> Point {
        let IVec2 { x, y } = self.tiles[tile as usize].moved;
        // The domain may begin so far below the frame that only the sum fits into the integers.
        Point::new(place.x.wrapping_add(x), place.y.wrapping_add(y))
    }
}

/// Returns where the domain has a place of the frame, in a tile that is moved so far.
fn in_domain(IVec2 { x, y }: IVec2, place: Point) -> Point {
    Point::new(place.x.wrapping_sub(x), place.y.wrapping_sub(y))
}
