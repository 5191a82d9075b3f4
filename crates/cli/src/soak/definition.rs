//! The first levels of an exact tiling by the definition: all darts of all blocks, in the order of their arrival, each a
//! sample unless an earlier sample covers it. No differences are followed, and no cell is left out.

use glam::{I64Vec2, IVec2};
use tilescope_core::stages::blocks::Block;
use tilescope_core::{
    Origin, PatternHistory, PlacedDart, Point, R, Rect, Run, SampleGrid, Stream, Symmetry, below,
};

/// The levels that are looked at: most samples arrive with them, and the changes at seams begin there. Those of later ones
/// would be far more darts.
const LEVELS: u32 = 2;

/// Returns whether the samples of a run that arrived with the first levels are those of the definition.
pub fn agrees(run: &Run, history: &PatternHistory) -> bool {
    let mut expected = first_samples(run, history);
    expected.sort_unstable_by_key(|place| place.row_major());

    let is_early = |id: &&u32| match run.samples.origins[**id as usize] {
        Origin::Tiled { pattern, .. } => history.arrival(pattern).level() < LEVELS,
        // The engine counts what it inserted with the first two levels as iteration 1.
        Origin::Inserted { iteration, .. } => iteration == 1,
    };
    let early = run.result.iter().filter(is_early);
    let mut found: Vec<Point> = early.map(|&id| run.samples.points[id as usize]).collect();
    found.sort_unstable_by_key(|place| place.row_major());
    found == expected
}

/// Returns the samples of the first levels by the definition of exact tiling: the darts of all blocks are taken by
/// their arrival, and one that no sample covers becomes a sample.
fn first_samples(run: &Run, history: &PatternHistory) -> Vec<Point> {
    let mut darts = Vec::new();
    for block in &run.blocks.leaves {
        add_darts(block, run.parameters.dihedral, history, &mut darts);
    }
    // Darts compare by their arrival, and those that arrive together by their places.
    darts.sort_unstable();

    let mut grid = SampleGrid::with_capacity(run.domain, run.result.len());
    let mut samples = Vec::new();
    for dart in darts {
        if !grid.covers(dart.place) {
            grid.insert(samples.len() as u32, dart.place);
            samples.push(dart.place);
        }
    }
    samples
}

/// Adds all darts of the first levels that a block has.
fn add_darts(block: &Block, dihedral: bool, history: &PatternHistory, all: &mut Vec<PlacedDart>) {
    let Rect { min, max } = block.rect;
    // A rectangle excludes its upper corner; its last place lies one unit before it.
    let last = Point::new(max.x - 1, max.y - 1);
    for copy in copies(block, dihedral, history) {
        let [a, b] = [min, last].map(|corner| copy.nearest(corner));
        // A symmetry may exchange the corners.
        let (low, high) = (a.min(b), a.max(b));

        for level in 0..LEVELS {
            let side = R >> level;
            // Cells begin at multiples of their side, a power of two.
            let along = |low: i32, high: i32| (low & -side..=high).step_by(side as usize);
            let rows = along(low.y, high.y);
            let cells = rows.flat_map(|y| along(low.x, high.x).map(move |x| Point::new(x, y)));
            let darts = cells.flat_map(|cell| history.darts().of_cell(level, cell));
            let placed = darts.map(|(arrival, source)| PlacedDart {
                arrival,
                source,
                place: copy.place(source),
            });
            // Cells that reach over the border of the block hold darts of others as well.
            all.extend(placed.filter(|dart| block.rect.contains(dart.place)));
        }
    }
}

/// A copy of the turned pattern: the repeated pattern is made of them.
struct PatternCopy {
    symmetry: Symmetry,
    /// How far the turned pattern moves to have its lowest corner at 0.
    corner: I64Vec2,
    /// Where the domain has that corner.
    origin: I64Vec2,
    side: i64,
}

impl PatternCopy {
    /// Returns where the domain has a place of the pattern.
    fn place(&self, source: Point) -> Point {
        let turned = self.symmetry.turn(IVec2::new(source.x, source.y));
        let at = self.origin + self.corner + turned.as_i64vec2();
        Point::new(at.x as i32, at.y as i32)
    }

    /// Returns which place of the pattern lies at a place of the domain, or nearest to it on both axes.
    fn nearest(&self, place: Point) -> IVec2 {
        let [first, last] = [I64Vec2::ZERO, I64Vec2::splat(self.side - 1)];
        let within = (I64Vec2::from(place) - self.origin).clamp(first, last);
        self.symmetry.turn_back((within - self.corner).as_ivec2())
    }
}

/// Returns the copies of the pattern that a block has parts of.
fn copies(block: &Block, dihedral: bool, history: &PatternHistory) -> Vec<PatternCopy> {
    // The square has eight symmetries, and the first of them leaves the pattern as it is.
    let symmetries = if dihedral { 8 } else { 1 };
    let symmetry = Symmetry(below(block.key.draw(Stream::Dihedral, 0)[0], symmetries) as u8);
    let pattern = history.pattern().domain();
    let extent = pattern.rect().max;
    let side = i64::from(extent.x);

    // The clip, r larger than the block on every side, begins at a drawn place; a bounded pattern has to hold it.
    let size = [block.rect.width(), block.rect.height()].map(i64::from);
    let draw = block.key.draw(Stream::Offset, 0);
    let first = [0, 1].map(|axis| {
        let fitting = side - (size[axis] + 2 * i64::from(R)) + 1;
        let starts = if pattern.is_periodic() { side } else { fitting };
        i64::from(below(draw[axis], starts as u32)) + i64::from(R)
    });

    // `first` is where the block begins in the repeated pattern: r after the clip. A block that reaches over the end of
    // a periodic pattern goes on in the next copies of it.
    let along = |axis: usize| first[axis] / side..=(first[axis] + size[axis] - 1) / side;
    let all = along(1).flat_map(|row| along(0).map(move |column| I64Vec2::new(column, row)));
    let corner = symmetry.corner(extent).as_i64vec2();
    all.map(|copy| PatternCopy {
        symmetry,
        corner,
        origin: I64Vec2::from(block.rect.min) - I64Vec2::from(first) + copy * side,
        side,
    })
    .collect()
}
