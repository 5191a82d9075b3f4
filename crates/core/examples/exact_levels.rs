//! How much of a pattern with nested levels would remain if exact tiling made it: every dart of the pattern arrives by level, the
//! coarsest first, then by time, and stays where nothing lies within the level's radius. The answer bounds the work of an engine for it:
//! `PERFORMANCE.md`, "Nested levels".
//!
//!     cargo run --release -p tilescope-core --example exact_levels -- [LEVELS] [LEAF] [BLOCKS] [SEED]
//!
//! LEAF is in radii of the finest level (default 160), BLOCKS the number of blocks of that side along each axis of a periodic domain
//! (default 2), LEVELS the number of levels (default 8). The radius of each level is the square root of two times that of the next
//! finer one, as in `--levels`. It prints, level by level and in all, which samples are not of their block's pattern.

use std::error::Error;

/// Side of the periodic pattern, in radii of the finest level: 18 radii of the coarsest of eight.
const PATTERN_SIDE: f64 = 200.0;
/// Darts for each square of a level's radius. Fewer than 1% of the samples of a maximal set are missing then, and with 60 instead the
/// shares below are the same to a tenth.
const DARTS: f64 = 100.0;

/// Samples in a periodic square, by square cells of about one finest radius.
struct Samples {
    side: f64,
    across: usize,
    cells: Vec<Vec<[f64; 2]>>,
}

impl Samples {
    fn new(side: f64) -> Self {
        let across = side as usize;
        let cells = vec![Vec::new(); across * across];
        Self {
            side,
            across,
            cells,
        }
    }

    fn cell(&self, place: f64) -> usize {
        // Rounding may put a place just below the side into a cell beyond the last one.
        let cell = (place / self.side * self.across as f64) as usize;
        cell.min(self.across - 1)
    }

    /// Returns whether no sample lies within the radius. Near cells come first, as most darts are refused by a near sample.
    fn is_free(&self, place: [f64; 2], radius: f64) -> bool {
        let across = self.across as isize;
        let [x, y] = place.map(|part| self.cell(part) as isize);
        let reach = (radius * self.across as f64 / self.side).ceil() as isize;

        (0..=reach).all(|ring| {
            let offsets = (-ring..=ring).flat_map(|dy| (-ring..=ring).map(move |dx| [dx, dy]));
            offsets
                .filter(|offset| offset.iter().any(|part| part.abs() == ring))
                .all(|[dx, dy]| {
                    let [column, row] =
                        [x + dx, y + dy].map(|part| part.rem_euclid(across) as usize);
                    let near = &self.cells[row * self.across + column];
                    near.iter()
                        .all(|&sample| self.distance2(sample, place) >= radius * radius)
                })
        })
    }

    /// Returns the square of the distance of two places, around the borders too.
    fn distance2(&self, a: [f64; 2], b: [f64; 2]) -> f64 {
        [0, 1]
            .map(|axis| {
                let straight = (a[axis] - b[axis]).abs();
                straight.min(self.side - straight).powi(2)
            })
            .iter()
            .sum()
    }

    fn add(&mut self, place: [f64; 2]) {
        let index = self.cell(place[1]) * self.across + self.cell(place[0]);
        self.cells[index].push(place);
    }
}

/// The generator `SplitMix64`, which needs no library. Only shares are printed, so that nothing depends on its bits.
struct Random(u64);

impl Random {
    /// Returns a number in [0, 1).
    fn draw(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut word = self.0;
        word = (word ^ (word >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        word = (word ^ (word >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((word ^ (word >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<f64> = std::env::args()
        .skip(1)
        .map(|text| text.parse())
        .collect::<Result<_, _>>()?;
    let number = |index: usize, default: f64| arguments.get(index).copied().unwrap_or(default);
    let (levels, leaf) = (number(0, 8.0) as i32, number(1, 160.0));
    let blocks = number(2, 2.0) as usize;
    if levels < 1 || !(2.0..=PATTERN_SIDE).contains(&leaf) || blocks < 1 {
        return Err(
            format!("LEVELS and BLOCKS are at least 1, LEAF is 2 to {PATTERN_SIDE}").into(),
        );
    }

    let mut random = Random(number(3, 1.0) as u64);
    let offsets: Vec<[f64; 2]> = (0..blocks * blocks)
        .map(|_| [0; 2].map(|_| random.draw() * PATTERN_SIDE))
        .collect();
    let mut pattern = Samples::new(PATTERN_SIDE);
    let mut tiled = Samples::new(leaf * blocks as f64);
    let (mut all, mut all_foreign) = (0_u64, 0_u64);

    for level in (0..levels).rev() {
        let radius = 2_f64.powf(f64::from(level) / 2.0);
        let (mut added, mut foreign, mut lost) = (0_u64, 0_u64, 0_u64);
        for _ in 0..(DARTS * (PATTERN_SIDE / radius).powi(2)) as usize {
            let dart = [0; 2].map(|_| random.draw() * PATTERN_SIDE);
            let is_own = pattern.is_free(dart, radius);
            if is_own {
                pattern.add(dart);
            }

            // The dart arrives in each block whose clip of the pattern has its place; a clip has no place twice, as a leaf is no
            // wider than the pattern.
            for (block, offset) in offsets.iter().enumerate() {
                let inside =
                    [0, 1].map(|axis| (dart[axis] - offset[axis]).rem_euclid(PATTERN_SIDE));
                if inside.iter().any(|&part| part >= leaf) {
                    continue;
                }
                let corner = [block % blocks, block / blocks].map(|index| index as f64 * leaf);
                let place = [0, 1].map(|axis| corner[axis] + inside[axis]);
                if tiled.is_free(place, radius) {
                    tiled.add(place);
                    added += 1;
                    foreign += u64::from(!is_own);
                } else {
                    lost += u64::from(is_own);
                }
            }
        }

        println!(
            "level {level}: {added} samples, {foreign} not of their block's pattern, {lost} of it lost"
        );
        all += added;
        all_foreign += foreign;
    }
    let share = 100.0 * all_foreign as f64 / all as f64;
    println!("{all} samples, {share:.1}% not of their block's pattern");
    Ok(())
}
