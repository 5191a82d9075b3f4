//! The radius between four nodes of a field, where it is bilinear.

/// The nodes around a cell of a field.
#[derive(Clone, Copy)]
pub(super) struct FieldPatch {
    /// The lowest place of the cell.
    pub x: i64,
    pub y: i64,
    /// The cell is two to the power `bits` units wide.
    pub bits: u32,
    /// The radii at its corners: the lowest one, the one to the right, the one above, the highest one.
    pub nodes: [i32; 4],
}

impl FieldPatch {
    /// Returns the radius at a place that is not below the lowest one; beyond the far sides it is that at the nearest place on
    /// them.
    #[inline]
    pub fn at(&self, x: i64, y: i64) -> i32 {
        let pitch = 1_i64 << self.bits;
        let right = (x - self.x).min(pitch);
        let up = (y - self.y).min(pitch);

        let [a, b, c, d] = self.nodes.map(i64::from);
        let below = a * (pitch - right) + b * right;
        let above = c * (pitch - right) + d * right;
        // The sum is at most 2^21 times 2^40, which fits 64 bits.
        ((below * (pitch - up) + above * up) >> (2 * self.bits)) as i32
    }
}
