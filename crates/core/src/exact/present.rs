//! The samples that are present while darts arrive, with what covers a place and what covers a cell.

use glam::IVec2;

use crate::exact::darts::{Arrival, PlacedDart};
use crate::grid::SampleGrid;
use crate::lattice::{Domain, Point, R, Rect, covers_offset};

/// A sample that is or was present.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ArrivedSample {
    /// The dart that it is.
    pub(crate) dart: PlacedDart,
    /// The block that has it.
    pub(crate) block: u32,
    /// Its index in the pattern; none of a dart that is a sample here alone.
    pub(crate) pattern: Option<u32>,
    /// Whether an earlier sample covers it, so that it is none.
    pub(crate) is_lost: bool,
}

/// Samples by place, some of them lost. An id is the number of a sample in the sequence in which they were added.
pub(crate) struct PresentSamples {
    samples: Vec<ArrivedSample>,
    grid: SampleGrid,
}

impl PresentSamples {
    /// Returns no samples, with room for `capacity`.
    pub(crate) fn with_capacity(domain: Domain, capacity: usize) -> Self {
        Self {
            samples: Vec::with_capacity(capacity),
            grid: SampleGrid::with_capacity(domain, capacity),
        }
    }

    /// Returns all samples, also lost ones.
    pub(crate) fn samples(&self) -> &[ArrivedSample] {
        &self.samples
    }

    /// Returns a sample.
    pub(crate) fn get(&self, id: u32) -> &ArrivedSample {
        &self.samples[id as usize]
    }

    /// Adds a sample and returns its id.
    pub(crate) fn add(&mut self, dart: PlacedDart, block: u32, pattern: Option<u32>) -> u32 {
        let id = self.samples.len() as u32;
        self.grid.insert(id, dart.place);
        self.samples.push(ArrivedSample {
            dart,
            block,
            pattern,
            is_lost: false,
        });
        id
    }

    /// Makes a sample a lost one.
    pub(crate) fn lose(&mut self, id: u32) {
        self.samples[id as usize].is_lost = true;
    }

    /// Returns those that arrived before `end`.
    pub(crate) const fn before(&self, end: Arrival) -> SamplesBefore<'_> {
        SamplesBefore { all: self, end }
    }

    /// Returns whether a present sample that is earlier than `dart` covers it.
    pub(crate) fn precedes(&self, dart: &PlacedDart) -> bool {
        self.any_covering(dart.place, |sample| sample.dart < *dart)
    }

    /// Returns whether `dart` is a present sample already, or an earlier one covers it.
    pub(crate) fn refuses(&self, dart: &PlacedDart) -> bool {
        self.any_covering(dart.place, |sample| sample.dart <= *dart)
    }

    fn any_covering(&self, place: Point, test: impl Fn(&ArrivedSample) -> bool) -> bool {
        self.grid.any_near(place, R, |near| {
            covers_offset(near.offset) && {
                let sample = self.get(near.id);
                !sample.is_lost && test(sample)
            }
        })
    }

    /// Calls `visit` with the ids of the samples that are present, later than `dart`, and covered by it.
    pub(crate) fn later(&self, dart: &PlacedDart, mut visit: impl FnMut(u32)) {
        self.grid.any_near(dart.place, R, |near| {
            let sample = self.get(near.id);
            if covers_offset(near.offset) && !sample.is_lost && sample.dart > *dart {
                visit(near.id);
            }
            false
        });
    }
}

/// The present samples that arrived before some arrival. Once all darts before it are decided, they stay.
#[derive(Clone, Copy)]
pub(crate) struct SamplesBefore<'a> {
    all: &'a PresentSamples,
    end: Arrival,
}

impl SamplesBefore<'_> {
    /// Returns whether one of them covers a place.
    pub(crate) fn covers(&self, place: Point) -> bool {
        let is_before = |sample: &ArrivedSample| sample.dart.arrival < self.end;
        self.all.any_covering(place, is_before)
    }

    /// Puts into `near` the offsets, from the rectangle's lowest place, of those that may cover a part of a rectangle of the
    /// domain, which is at most R wide and high.
    pub(crate) fn near_rect(&self, rect: &Rect, near: &mut Vec<IVec2>) {
        near.clear();
        let extent = IVec2::new(rect.width() - 1, rect.height() - 1);
        let middle = extent / 2;
        let centre = Point::new(rect.min.x + middle.x, rect.min.y + middle.y);
        let reach = R + 1 + middle.max_element();

        self.all.grid.any_near(centre, reach, |found| {
            let offset = found.offset + middle;
            // The nearest place of the rectangle must lie in the disk.
            let nearest = offset.clamp(IVec2::ZERO, extent);
            if covers_offset(offset - nearest) {
                let sample = self.all.get(found.id);
                if !sample.is_lost && sample.dart.arrival < self.end {
                    near.push(offset);
                }
            }
            false
        });
    }
}
