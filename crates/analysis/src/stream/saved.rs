//! A verifier's state as bytes, so that a long run can be interrupted and go on.
//! Numbers are little-endian 64-bit words, coordinates their bits; a checksum comes last.
//! It never restores what it did not write: anything else is refused.

use std::ops::Range;

use crate::cover::{Tile, Visit};
use crate::error::VerifyError;
use crate::grid::Entry;
use crate::pairs::Pairs;
use crate::region::Region;
use crate::verify::VerifyOptions;
use crate::witness::{Conflict, Gap, GapKind};

use super::StreamVerifier;
use super::bands::{Bands, Search};

/// First word of a state: its layout.
const LAYOUT: u64 = 0x7473_2073_6373_7402;

impl StreamVerifier {
    /// The state as bytes: about 24 for each sample held and few besides.
    ///
    /// # Errors
    ///
    /// What an earlier call found wrong: there is nothing to go on with.
    pub fn save(&self) -> Result<Vec<u8>, VerifyError> {
        if let Some(fault) = &self.fault {
            return Err(fault.clone());
        }
        let samples = self.bands.held.len() + self.bands.seam.len();
        let mut out = Writer(Vec::with_capacity(24 * samples + 4096));
        out.u64(LAYOUT);
        out.u64(question(&self.search));
        out.u64(self.expected);
        out.u64(self.intake.count as u64);
        out.f64(self.intake.highest);
        out.bands(&self.bands);
        let sum = checksum(&out.0);
        out.u64(sum);
        Ok(out.0)
    }

    /// The verifier that was saved as `state`, for the same question.
    ///
    /// # Errors
    ///
    /// As [`Self::new`], and [`VerifyError::BadState`] for bytes that are no state or of another question.
    pub fn restore(
        region: Region,
        radius: f64,
        options: &VerifyOptions,
        state: &[u8],
    ) -> Result<Self, VerifyError> {
        let mut verifier = Self::new(region, radius, options)?;
        let bad = |reason| VerifyError::BadState { reason };
        let (words, sum) = (state.split_last_chunk::<8>()).ok_or(bad("it is too short"))?;
        if u64::from_le_bytes(*sum) != checksum(words) {
            return Err(bad("its checksum is wrong"));
        }
        let mut from = Reader(words);
        if from.u64() != Some(LAYOUT) {
            return Err(bad("it is of another version"));
        }
        if from.u64() != Some(question(&verifier.search)) {
            return Err(bad("it is of another region, radius or tolerance"));
        }
        from.state(&mut verifier).ok_or(bad("it is incomplete"))?;
        Ok(verifier)
    }
}

/// A number that differs for another region, radius, tolerance or number of witnesses.
fn question(search: &Search) -> u64 {
    let Region { width, height, .. } = search.region;
    let numbers = [
        width,
        height,
        f64::from(u8::from(search.domain.periodic)),
        search.radius,
        search.options.covering_tolerance,
        search.options.witnesses as f64,
    ];
    checksum(&numbers.map(f64::to_le_bytes).concat())
}

/// FNV-1a over words and the remaining bytes. It finds damage, not malice.
fn checksum(bytes: &[u8]) -> u64 {
    let (words, rest) = bytes.as_chunks::<8>();
    let mix = |sum: u64, word: u64| (sum ^ word).wrapping_mul(0x0100_0000_01B3).rotate_left(29);
    let sum = (words.iter()).fold(0xCBF2_9CE4_8422_2325, |sum, word| {
        mix(sum, u64::from_le_bytes(*word))
    });
    (rest.iter()).fold(sum, |sum, &byte| mix(sum, u64::from(byte)))
}

struct Writer(Vec<u8>);

impl Writer {
    fn u64(&mut self, value: u64) {
        self.0.extend_from_slice(&value.to_le_bytes());
    }

    fn f64(&mut self, value: f64) {
        self.u64(value.to_bits());
    }

    fn point(&mut self, point: [f64; 2]) {
        self.f64(point[0]);
        self.f64(point[1]);
    }

    fn range(&mut self, range: &Range<usize>) {
        self.u64(range.start as u64);
        self.u64(range.end as u64);
    }

    fn list<T>(&mut self, list: &[T], mut item: impl FnMut(&mut Self, &T)) {
        self.u64(list.len() as u64);
        for value in list {
            item(self, value);
        }
    }

    fn entries(&mut self, entries: &[Entry]) {
        self.list(entries, |out, entry| {
            out.point(entry.position);
            out.u64(u64::from(entry.id));
        });
    }

    fn gaps(&mut self, gaps: &[Gap]) {
        self.list(gaps, |out, gap| {
            out.point(gap.center);
            out.f64(gap.distance);
            out.u64(gap.kind as u64);
        });
    }

    fn visits(&mut self, visits: &[Visit]) {
        self.list(visits, |out, visit| {
            let tile = &visit.tile;
            out.range(&tile.columns);
            out.range(&tile.rows);
            out.u64(tile.count as u64);
            out.point(tile.low);
            out.point(tile.high);
            out.f64(visit.halo);
            out.u64(visit.wants.start.cast_unsigned());
            out.u64(visit.wants.end.cast_unsigned());
        });
    }

    fn bands(&mut self, bands: &Bands) {
        self.range(&(bands.keep..bands.closed));
        self.u64(bands.next as u64);
        self.u64(bands.work);
        self.visits(&bands.postponed);
        self.u64(bands.pairs.conflicts);
        self.f64(bands.pairs.min_distance);
        self.list(bands.pairs.worst.kept(), |out, pair| {
            out.range(&(pair.first..pair.second));
            out.f64(pair.distance);
        });
        let (covering_radius, count) = bands.places.settled();
        self.f64(covering_radius);
        self.u64(count);
        let [worst, shared] = bands.places.lists();
        self.gaps(worst);
        self.gaps(shared);
        self.entries(&bands.held);
        self.entries(&bands.seam);
    }
}

struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn u64(&mut self) -> Option<u64> {
        let (word, rest) = self.0.split_first_chunk::<8>()?;
        self.0 = rest;
        Some(u64::from_le_bytes(*word))
    }

    fn usize(&mut self) -> Option<usize> {
        usize::try_from(self.u64()?).ok()
    }

    fn f64(&mut self) -> Option<f64> {
        self.u64().map(f64::from_bits)
    }

    fn point(&mut self) -> Option<[f64; 2]> {
        Some([self.f64()?, self.f64()?])
    }

    fn range(&mut self) -> Option<Range<usize>> {
        Some(self.usize()?..self.usize()?)
    }

    /// A list of items of at least eight bytes: a false length allocates nothing.
    fn list<T>(&mut self, mut item: impl FnMut(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        let count = self.usize()?;
        let mut list = Vec::with_capacity(count.min(self.0.len() / 8));
        for _ in 0..count {
            list.push(item(self)?);
        }
        Some(list)
    }

    fn entries(&mut self) -> Option<Vec<Entry>> {
        self.list(|from| {
            let position = from.point()?;
            let id = u32::try_from(from.u64()?).ok()?;
            Some(Entry { position, id })
        })
    }

    fn gaps(&mut self) -> Option<Vec<Gap>> {
        const KINDS: [GapKind; 3] = [GapKind::VoronoiVertex, GapKind::Border, GapKind::Corner];
        self.list(|from| {
            Some(Gap {
                center: from.point()?,
                distance: from.f64()?,
                kind: *KINDS.get(from.usize()?)?,
            })
        })
    }

    fn visits(&mut self) -> Option<Vec<Visit>> {
        self.list(|from| {
            let tile = Tile {
                columns: from.range()?,
                rows: from.range()?,
                count: from.usize()?,
                low: from.point()?,
                high: from.point()?,
            };
            let halo = from.f64()?;
            let wants = from.u64()?.cast_signed()..from.u64()?.cast_signed();
            Some(Visit { tile, halo, wants })
        })
    }

    fn state(&mut self, verifier: &mut StreamVerifier) -> Option<()> {
        verifier.expected = self.u64()?;
        let intake = &mut verifier.intake;
        intake.count = self.usize()?;
        intake.highest = self.f64()?;
        self.bands(&mut verifier.bands)?;
        self.0.is_empty().then_some(())
    }

    fn bands(&mut self, bands: &mut Bands) -> Option<()> {
        let Range { start, end } = self.range()?;
        (bands.keep, bands.closed) = (start, end);
        bands.next = self.usize()?;
        bands.work = self.u64()?;
        bands.postponed = self.visits()?;
        self.pairs(&mut bands.pairs)?;
        let settled = (self.f64()?, self.u64()?);
        bands.places.restore(settled, [self.gaps()?, self.gaps()?]);
        bands.held = self.entries()?;
        bands.seam = self.entries()?;
        Some(())
    }

    fn pairs(&mut self, pairs: &mut Pairs) -> Option<()> {
        pairs.conflicts = self.u64()?;
        pairs.min_distance = self.f64()?;
        let worst = self.list(|from| {
            let Range { start, end } = from.range()?;
            Some(Conflict {
                first: start,
                second: end,
                distance: from.f64()?,
            })
        })?;
        for pair in worst {
            pairs.worst.push(pair);
        }
        Some(())
    }
}
