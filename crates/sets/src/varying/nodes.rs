//! Nodes of fields: where they lie, and the lattice that follows from the radii at them.

use tilescope_core::{Boundary, MAX_FIELD_RADIUS, MAX_PITCH_BITS, R};

use super::error::VaryingError;

/// The nodes along the longer side of an expression's domain: a radius that changes on a thousandth of it is followed.
const EXPRESSION_NODES: usize = 1024;

/// Radii that differ by a share of less than this are the same but for rounding.
const ROUNDED: f64 = 1e-9;

/// The largest radius is at most this many times the least.
pub(super) const MAX_CONTRAST: f64 = 64.0;

/// A radius is made smaller by this share of it when it stands for a lattice unit, so that a side of whole units is not rounded down to
/// one less. It is less than a unit of the largest domain.
pub(super) const HAIR: f64 = 1.0 / (1_u64 << 38) as f64;

/// Ratios of sides that differ by less are equal: each side is rounded.
pub(super) const SAME_RATIO: f64 = 2e-12;

/// The squares that fill a domain.
#[derive(Clone, Copy)]
pub(super) struct Squares {
    /// How many a row and a column have.
    pub counts: [usize; 2],
    /// Their side in user units.
    pub pitch: f64,
}

/// Radii at nodes as they are asked for, and the lattice that follows from the least.
pub(super) struct RequestedRadii {
    asked: Vec<f64>,
    /// The distance between nodes in user units.
    pub pitch: f64,
    /// The binary logarithm of that distance in lattice units.
    pub bits: u32,
    pub least: f64,
    pub greatest: f64,
    /// The largest radius that is possible, in the least one.
    pub limit: f64,
}

impl RequestedRadii {
    /// Returns radii at nodes of a pitch. Fails if no lattice is fine enough for the least.
    pub fn new(asked: Vec<f64>, pitch: f64) -> Result<Self, VaryingError> {
        let least = asked.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = asked.iter().copied().fold(0.0, f64::max);
        // The coarsest lattice in which the least radius has R units or more. A side has at most 2^31 units, so that a
        // finer lattice would allow only smaller domains.
        let in_units = |bits: u32| least / pitch * f64::from(1_u32 << bits);
        let bits = (0..=MAX_PITCH_BITS)
            .find(|&bits| in_units(bits) >= f64::from(R))
            .ok_or(VaryingError::Fine { least, pitch })?;

        // The least radius may have up to 2^16 units, so that 64 times as much may be beyond the lattice's limit.
        let most = f64::from(MAX_FIELD_RADIUS);
        Ok(Self {
            asked,
            pitch,
            bits,
            least,
            greatest,
            limit: MAX_CONTRAST.min(most / in_units(bits)),
        })
    }

    /// Returns a length in lattice units.
    fn in_units(&self, length: f64) -> f64 {
        length / self.pitch * f64::from(1_u32 << self.bits)
    }

    /// Whether the greatest radius is beyond the limit, by more than rounding.
    pub fn are_too_unlike(&self) -> bool {
        self.greatest > self.limit * self.least * (1.0 + ROUNDED)
    }

    /// Refuses radii that differ too much. If nodes are the corners of pixels, the error names a least radius that would allow it.
    pub fn refuse_contrast(&self, has_pixels: bool) -> Result<(), VaryingError> {
        if !self.are_too_unlike() {
            return Ok(());
        }
        // A least radius of 2^16 units is one of 2^15 in a lattice with half as many.
        let allowing = 2.0 * f64::from(R) / self.in_units(self.least) * self.least;
        // A contrast above that of all lattices has no such remedy.
        let is_beyond_all = self.greatest > MAX_CONTRAST * self.least;
        Err(VaryingError::Contrast {
            least: self.least,
            greatest: self.greatest,
            // Of an expression, whose nodes may lie anywhere, the limit of these nodes says nothing.
            limit: if is_beyond_all && !has_pixels {
                MAX_CONTRAST
            } else {
                self.limit
            },
            allowing: (has_pixels && !is_beyond_all).then_some(allowing),
        })
    }

    /// Returns the radii in lattice units.
    pub fn units(&self) -> Vec<i32> {
        // Rounded down: samples are then no farther apart than was asked for. Radii beyond the limit are those of a
        // density, as others were refused.
        let most = self.limit * self.in_units(self.least);
        let unit = |&length: &f64| self.in_units(length).min(most).floor() as i32;
        self.asked.iter().map(unit).collect()
    }
}

/// Returns the squares at whose corners an expression is evaluated. They fill a periodic domain exactly; of a bounded
/// one the last may reach beyond the border.
pub(super) fn squares_of(size: [f64; 2], boundary: Boundary) -> Result<Squares, VaryingError> {
    let longer = size[0].max(size[1]);
    let pitch_of = |along: usize| longer / along as f64;
    if boundary == Boundary::Bounded {
        return Ok(bounded_squares(size, pitch_of(EXPRESSION_NODES)));
    }

    // The largest number of squares for which both sides are whole.
    let along = (1..=EXPRESSION_NODES).rev();
    let mut fitting = along.filter_map(|along| periodic_squares(size, pitch_of(along)));
    let limit = EXPRESSION_NODES;
    fitting.next().ok_or(VaryingError::Ratio { size, limit })
}

/// Returns the squares of some width over a bounded domain, of which the last may reach beyond the border.
fn bounded_squares(size: [f64; 2], pitch: f64) -> Squares {
    // A count that is whole but for rounding is whole.
    let whole = |count: f64| (count - SAME_RATIO).ceil().max(1.0) as usize;
    let counts = size.map(|side| whole(side / pitch));
    Squares { counts, pitch }
}

/// Returns the squares of some width in a periodic domain, if they fill it: nodes then go around without a step between them.
fn periodic_squares(size: [f64; 2], pitch: f64) -> Option<Squares> {
    // A side of less than half a square would be rounded to none.
    let counts = size.map(|side| side / pitch);
    let is_whole = |count: &f64| *count >= 0.5 && (count / count.round() - 1.0).abs() < SAME_RATIO;
    counts.iter().all(is_whole).then(|| Squares {
        counts: counts.map(|count| count.round() as usize),
        pitch,
    })
}

/// Returns the squares in whose lattice a least radius has the fewest units above R, from half as many along the longer side as an
/// expression has otherwise to twice as many; `None` if none fill the domain.
pub(super) fn squares_for(size: [f64; 2], boundary: Boundary, least: f64) -> Option<Squares> {
    let longer = size[0].max(size[1]);
    let usual = longer / EXPRESSION_NODES as f64;
    // How many times R units the least radius has in the coarsest lattice in which it has as many.
    let excess = |pitch: f64| {
        let quotient = least / pitch / f64::from(R);
        quotient / quotient.log2().floor().exp2()
    };
    if boundary == Boundary::Bounded {
        // A hair less, so that rounding does not leave less than R units.
        let pitch = usual * excess(usual) / 2.0 * (1.0 - HAIR);
        return Some(bounded_squares(size, pitch));
    }
    // Here only whole numbers of squares are possible.
    let along = EXPRESSION_NODES / 2..=2 * EXPRESSION_NODES;
    let fitting = along.filter_map(|along| periodic_squares(size, longer / along as f64));
    fitting.min_by(|a, b| excess(a.pitch).total_cmp(&excess(b.pitch)))
}
