//! The samples of a window in the end: those in the interiors of its blocks, copied eight at a time, and those that the
//! decisions near seams left or added.

use fearless_simd::{Simd, dispatch};

use crate::engine::parallel::claim::tiled_tag;
use crate::engine::parallel::clip::Clipper;
use crate::engine::parallel::counts::WindowCounts;
use crate::engine::parallel::gaps::inserted_tag;
use crate::engine::parallel::region::{Region, push, unpack};
use crate::engine::parallel::window_maker::WindowSamples;
use crate::exact::engine::iteration_of;
use crate::exact::seams::{FIRST_INSERTED, ListedSample, SeamTiling};
use crate::instructions::InstructionSet;
use crate::lattice::{Point, R, Rect64};

impl SeamTiling<'_> {
    /// Puts the window's samples into `out`, in canonical order, with their counts, and with tags of their sources if they
    /// are wanted. Puts the samples outside of the window but at most R from it on both axes into `around`, if they are wanted.
    pub(in crate::exact) fn emit(
        &mut self,
        clipper: &Clipper,
        with_tags: bool,
        out: &mut WindowSamples,
        around: Option<&mut Vec<Point>>,
    ) {
        out.clear();
        self.count(&mut out.counts);
        // The regions are taken out of the tiling, which is read meanwhile.
        if with_tags {
            let mut region = std::mem::take(&mut self.tagged);
            self.emit_region(clipper, &mut region, out, around);
            self.tagged = region;
        } else {
            let mut region = std::mem::take(&mut self.plain);
            self.emit_region(clipper, &mut region, out, around);
            self.plain = region;
        }
    }

    fn emit_region<const TAGS: bool>(
        &self,
        clipper: &Clipper,
        region: &mut Region<TAGS>,
        out: &mut WindowSamples,
        around: Option<&mut Vec<Point>>,
    ) {
        // A region marks cells whose candidates an unsure sample may affect, up to this many cells away. There are no
        // candidates here.
        let no_reach = 0;
        region.reset(self.ground.frame.clone(), no_reach);
        dispatch!(InstructionSet::best().level(), simd => {
            self.fill(simd, clipper, region);
            region.emit(&mut out.points, &mut out.tags, &mut out.rows);
        });
        if let Some(around) = around {
            self.around_window(region, around);
        }
    }

    /// Lays all samples into a region.
    #[inline(always)]
    fn fill<S: Simd, const TAGS: bool>(
        &self,
        simd: S,
        clipper: &Clipper,
        region: &mut Region<TAGS>,
    ) {
        let ground = self.ground.rect();
        for (index, tile) in (0..).zip(&self.tiles) {
            let block = &self.blocks[tile.placed as usize];
            let interior = self.interior(index);
            // Samples without tags are computed eight at a time. With tags they are inserted one by one, since the tag is kept
            // beside the slot.
            if TAGS {
                clipper.clip(block, &interior, &ground, |x, y, id| {
                    region.insert(x, y, tiled_tag(block.index, id));
                });
            } else {
                let slots = &mut region.slots;
                clipper.clip_slots(simd, block, &interior, &self.ground.frame, |cell, slot| {
                    push(&mut slots[cell], slot);
                });
            }
        }

        // The interiors were copied with the samples that are lost here.
        for lost in self.lost.iter().filter(|lost| lost.is_deep) {
            region.remove(lost.place.x, lost.place.y);
        }
        // Listed samples that are left out are lost or doubtful ones, and those that an interior has. A doubtful one
        // may depend on the plane beyond the ground. In the window there is none in the end: a window with one is made
        // again with a wider halo.
        for sample in self.samples.iter().filter(|sample| !sample.is_left_out) {
            let tag = if TAGS { self.tag(sample) } else { 0 };
            region.insert(sample.place.x, sample.place.y, tag);
        }
    }

    fn tag(&self, sample: &ListedSample) -> u64 {
        match sample.pattern() {
            Some(pattern) => tiled_tag(self.tiles[sample.tile as usize].block, pattern),
            None => inserted_tag(self.iteration(sample)),
        }
    }

    /// Returns the iteration in which a dart that is a sample here and not in the pattern counts as inserted.
    fn iteration(&self, sample: &ListedSample) -> u32 {
        iteration_of(self.inserted[(sample.number - FIRST_INSERTED) as usize].arrival)
    }

    /// Appends the samples outside of the window but at most R from it on both axes: strip by strip, each in canonical order if no
    /// end of a periodic domain crosses it.
    fn around_window<const TAGS: bool>(&self, region: &Region<TAGS>, around: &mut Vec<Point>) {
        let frame = &self.ground.frame;
        let window = frame.window;
        let reach = i64::from(R);
        for strip in Rect64::from(window)
            .grown(reach, reach)
            .without(&window.into())
        {
            // Beyond the end of a bounded domain there is nothing.
            let Some(strip) = strip.within(&self.ground.rect()) else {
                continue;
            };
            for row in strip.min.y / R..=(strip.max.y - 1) / R {
                for column in strip.min.x / R..=(strip.max.x - 1) / R {
                    // Of a cell's places those in lower rows come first, as their slots do.
                    let held = region.sorted_in(frame.cell(column, row));
                    let places = held.map(|slot| unpack(slot, column, row));
                    let inside = places.filter(|place| strip.contains(*place));
                    around.extend(inside.map(|place| frame.point(place.x, place.y)));
                }
            }
        }
    }

    /// Counts what the window has.
    fn count(&self, counts: &mut WindowCounts) {
        counts.clear();
        let window = self.ground.frame.window;
        // A block counts in the window that has its lowest corner, and so once in a run of many windows.
        let corners = self.blocks.iter().map(|block| block.rect.min);
        let inside = corners.filter(|&corner| Rect64::from(window).contains(corner));
        counts.blocks = inside.count() as u64;

        let lost = self.lost.iter();
        counts.eliminated = lost.filter(|lost| window.contains(lost.place)).count() as u64;

        // How many samples were tiled follows from the other counts and the number of samples.
        let inserted = self
            .samples
            .iter()
            .filter(|sample| sample.pattern().is_none());
        for sample in inserted.filter(|sample| window.contains(sample.place)) {
            // Iterations are numbered from 1.
            counts.insert(self.iteration(sample) as usize - 1, 1);
        }
    }
}
