//! The first stage of exact tiling: each block's own samples are laid down.

use glam::I64Vec2;

use crate::engine::parallel::clip::{Clipper, PlacedBlock};
use crate::error::SampleError;
use crate::exact::agenda::What;
use crate::exact::engine::{ExactTile, ExactTiling};
use crate::exact::filter::SampleFilter;
use crate::exact::pieces::pieces;
use crate::lattice::{Point, R, Rect, Rect64};
use crate::pattern::Symmetry;
use crate::progress::{Meter, Observer};
use crate::record::{Recorder, RunEvent};
use crate::stage::Stage;

impl ExactTiling<'_> {
    /// Lays down every block's own samples.
    pub(super) fn tile<T: Recorder>(
        &mut self,
        clipper: &Clipper,
        observer: &mut dyn Observer,
        recorder: &mut T,
    ) -> Result<(), SampleError> {
        recorder.record(RunEvent::Begin(Stage::Tile));
        self.tiles.clear();
        self.cells.clear();
        self.fresh.clear();
        self.open.clear();
        self.side = R;

        // The list is taken out of the tiling, which changes meanwhile.
        let blocks = std::mem::take(&mut self.blocks);
        let all = self.present.ground().rect();
        let mut meter = Meter::begin(observer, Stage::Tile, blocks.len() as u64)?;

        for block in &blocks {
            // Some blocks reach onto the ground with their margins alone.
            if let Some(rect) = block.rect.within(&all) {
                recorder.record(RunEvent::Clip { block: block.index });
                self.add_tile(block, rect);
                self.clip(clipper, block, recorder);
            }
            meter.tick()?;
        }

        self.blocks = blocks;
        meter.end()
    }

    /// Adds the tile of the part of a block that lies on the ground.
    fn add_tile(&mut self, block: &PlacedBlock, rect: Rect) {
        let (tile, first_piece) = (self.tiles.len() as u32, self.cells.pieces().len() as u32);
        let symmetry = Symmetry(block.symmetry);
        let moved = self.present.ground().moved(block);
        self.present.add_tile(moved);

        // `block.start` is where the turned pattern has the lowest corner of the block enlarged by r. `start` is where
        // it has that of `rect` enlarged by r.
        let start = I64Vec2::from(block.start) + I64Vec2::from(rect.min) - block.rect.min;
        let pattern_rect = self.history.pattern().domain().rect();
        let in_domain = self.present.rect_in_domain(tile, &rect);
        for piece in pieces(tile, &in_domain, start, symmetry, &pattern_rect) {
            self.cells.add(piece);
        }

        self.tiles.push(ExactTile {
            block: block.index,
            rect,
            symmetry,
            first_piece,
            end_piece: self.cells.pieces().len() as u32,
            missing: SampleFilter::default(),
        });
    }

    /// Lays down the samples of a clip that lie in the last tile. Those around the tile count as lost from the beginning: the
    /// darts that they refused are woken.
    fn clip<T: Recorder>(&mut self, clipper: &Clipper, block: &PlacedBlock, recorder: &mut T) {
        let tile = self.tiles.len() as u32 - 1;
        let rect = self.tiles[tile as usize].rect;

        // A sample at most r outside may be the first blocker of darts inside.
        let reach = i64::from(R);
        let around = Rect64::from(rect).grown(reach, reach);
        let ground = self.present.ground().rect();
        let target = Rect {
            min: Point::new(ground.min.x - R, ground.min.y - R),
            max: Point::new(ground.max.x + R, ground.max.y + R),
        };

        clipper.clip(block, &around, &target, |x, y, pattern| {
            let place = Point::new(x, y);
            if !rect.contains(place) {
                let no_id = u32::MAX;
                self.wake(tile, place, pattern, no_id, recorder);
                return;
            }

            // Outside of the shape there are no darts: the sample is missing, as one that is lost.
            if !self.shape.inside(self.present.in_domain(tile, place)) {
                let no_id = u32::MAX;
                self.release(tile, place, pattern, no_id, recorder);
                return;
            }

            let id = self.present.add(place, tile, pattern);
            recorder.record(RunEvent::Tiled {
                sample: id,
                block: block.index,
                // A tile has no place outside of the domain.
                inside: true,
            });
            // Samples of other blocks cover only places within r of the border. A sample deeper than r is decided about
            // only if a dart that becomes a sample covers it (`decide_dart`). The others are decided about when they
            // arrive, and in a recording all are.
            if T::ENABLED || rect.depth(place) <= R {
                let dart = self.present.dart(self.present.get(id));
                self.agenda.add(dart, What::Sample(id));
            }
        });
    }
}
