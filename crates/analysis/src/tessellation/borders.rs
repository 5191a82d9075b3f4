//! Chains the arcs and border lines of a gap to closed loops. Each step follows from how the cells meet; positions are
//! not compared.
//!
//! A *part* is what a disk leaves uncovered of a side of its Voronoi cell, at the side's start (its *head*) or at its
//! end. A *run* is the parts of a cell that follow each other around an arc of its disk.

use std::f64::consts::TAU;

use glam::{DVec2, IVec2};

use super::gap_regions::{Edge, Part, Runs, head_of, side_of};

/// A piece of a border: the arc of a run, or a part of a side on the domain's border.
#[derive(Clone, Copy)]
enum Piece {
    Arc(usize),
    Line(Part),
}

/// Which pieces are in a loop already.
pub(super) struct Drawn {
    arcs: Vec<bool>,
    lines: Vec<bool>,
}

impl Drawn {
    pub fn new(runs: &Runs<'_>) -> Self {
        Self {
            arcs: vec![false; runs.list.len()],
            lines: vec![false; runs.run_of.len()],
        }
    }

    /// Returns the loops around a gap. `members` are the runs that make it, each with the periods by which it is moved.
    pub fn boundary(&mut self, runs: &Runs<'_>, members: &[(usize, IVec2)]) -> Vec<Vec<Edge>> {
        let mut loops = Vec::new();
        for &(run, shift) in members {
            let border = runs.list[run]
                .parts
                .iter()
                .filter(|&&part| runs.is_border(part));
            let pieces = border
                .map(|&part| Piece::Line(part))
                .chain([Piece::Arc(run)]);

            // Each loop is drawn once, from the first of its pieces that is met.
            for piece in pieces {
                if !*self.mark(piece) {
                    loops.push(self.chain(runs, piece, shift));
                }
            }
        }
        loops
    }

    /// Returns the mark of a piece: whether it is in a loop already.
    fn mark(&mut self, piece: Piece) -> &mut bool {
        match piece {
            Piece::Arc(run) => &mut self.arcs[run],
            Piece::Line(part) => &mut self.lines[part],
        }
    }

    /// Returns the loop that begins with a piece, and marks its pieces. It ends before a marked piece, which is the
    /// first one again, or where no piece follows.
    fn chain(&mut self, runs: &Runs<'_>, first: Piece, shift: IVec2) -> Vec<Edge> {
        let mut edges = Vec::new();
        let mut at = Some((first, shift));
        while let Some((piece, shift)) = at {
            let drawn = self.mark(piece);
            if *drawn {
                break;
            }
            *drawn = true;
            edges.push(runs.edge(piece, shift));
            at = runs.after(piece, shift);
        }
        edges
    }
}

impl Runs<'_> {
    /// Returns whether a part lies on the border of the domain.
    fn is_border(&self, part: Part) -> bool {
        self.cells.sides[side_of(part)].beyond.is_none()
    }

    /// Returns a piece as an edge, moved by periods.
    fn edge(&self, piece: Piece, shift: IVec2) -> Edge {
        match piece {
            Piece::Arc(run) => self.arc(run, shift),
            Piece::Line(part) => {
                let [from, to] = self.places(part).map(|p| self.cells.shifted(p, shift));
                Edge::Line { from, to }
            }
        }
    }

    /// Returns the arc of a run, from its last part back to its first.
    fn arc(&self, run: usize, shift: IVec2) -> Edge {
        let sample = self.cell(run);
        let place = self.cells.samples[sample];
        // The first value of `last` is never used, as a run has at least one part.
        let (mut last, mut angle) = (DVec2::X, 0.0);
        for &part in &self.list[run].parts {
            let [from, to] = self.places(part).map(|end| end - place);
            // On a border through the sample, rounding may turn the angle the other way.
            angle += from.perp_dot(to).atan2(from.dot(to)).max(0.0);
            last = to;
        }

        let from_angle = last.to_angle();
        // All around, the angles add up to a turn, but for rounding.
        let turn = if self.list[run].closed { TAU } else { angle };
        Edge::Arc {
            sample,
            center: self.cells.shifted(place, shift),
            from_angle,
            to_angle: from_angle - turn,
        }
    }

    /// The piece that begins where one ends, with the gap on the left, and the periods by which it is moved; none
    /// behind a whole circle, and where rounding left a side without a twin or the next one without a head.
    fn after(&self, piece: Piece, shift: IVec2) -> Option<(Piece, IVec2)> {
        match piece {
            // A whole circle is a loop by itself.
            Piece::Arc(run) if self.list[run].closed => None,
            Piece::Arc(run) => {
                // An arc goes backwards, and so ends where the run's first part begins. On the border, that part's line
                // follows.
                let part = *self.list[run].parts.first()?;
                if self.is_border(part) {
                    return Some((Piece::Line(part), shift));
                }
                // Seen from the cell beyond, the part is the last one of its run, and the arc of that run begins at the
                // part's end.
                let (other, by) = self.across(part)?;
                Some((Piece::Arc(self.run_of[other]), shift + by))
            }
            Piece::Line(part) if self.ends_at_corner(part) => self.after_corner(part, shift),
            // A line that ends before the corner of its cell ends on the cell's circle, as the last part of its run.
            Piece::Line(part) => Some((Piece::Arc(self.run_of[part]), shift)),
        }
    }

    /// The border line that begins where another ends: around a corner, or in the next cell along. None where rounding
    /// left a side without a twin, or the next border side without a head.
    fn after_corner(&self, part: Part, shift: IVec2) -> Option<(Piece, IVec2)> {
        let cells = self.cells;
        let mut side = cells.next(side_of(part));
        let mut total_shift = shift;
        // From cell to cell around the place, up to the next side on the border. Rarely more than two cells meet there,
        // and never all: the bound only keeps the loop from being endless.
        for _ in 0..cells.sides.len() {
            let Some(beyond) = cells.sides[side].beyond else {
                // The line goes on at the side's head, which is missing only by rounding: no disk covers the corner.
                return cells.sides[side]
                    .head
                    .map(|_| (Piece::Line(head_of(side)), total_shift));
            };
            total_shift += beyond.shift;
            side = cells.next(cells.sides[side].twin?);
        }
        None
    }
}
