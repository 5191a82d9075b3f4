//! Regular sets whose measures are known in closed form, and the set of the fixture.

use tilescope_analysis::{Boundary, Region};

/// A periodic square lattice of spacing 1.
pub fn square(columns: u32, rows: u32) -> (Vec<[f64; 2]>, Region) {
    let points = (0..columns * rows)
        .map(|i| [f64::from(i % columns), f64::from(i / columns)])
        .collect();
    (points, torus(f64::from(columns), f64::from(rows)))
}

/// A periodic hexagonal lattice of spacing 1 with an even number of rows.
pub fn hexagonal(columns: u32, rows: u32) -> (Vec<[f64; 2]>, Region) {
    let height = 0.75_f64.sqrt();
    let points = (0..columns * rows)
        .map(|i| {
            let row = i / columns;
            [
                f64::from(i % columns) + 0.5 * f64::from(row % 2),
                f64::from(row) * height,
            ]
        })
        .collect();
    (points, torus(f64::from(columns), f64::from(rows) * height))
}

pub fn torus(width: f64, height: f64) -> Region {
    Region {
        width,
        height,
        boundary: Boundary::Periodic,
    }
}

pub fn bounded(width: f64, height: f64) -> Region {
    Region {
        boundary: Boundary::Bounded,
        ..torus(width, height)
    }
}

/// Radius of [`maximal`].
pub const MAXIMAL_RADIUS: f64 = 0.0119;

/// A maximal Poisson-disk set on the unit torus, made by the command line of this workspace:
/// `tilescope sample --method reference --radius 0.0119 --seed 7 --out maximal.csv`.
pub fn maximal() -> Vec<[f64; 2]> {
    include_str!("../data/maximal.csv")
        .lines()
        .skip(1)
        .map(|line| {
            let (x, y) = line.split_once(',').expect("two columns");
            [x, y].map(|text| text.parse().expect("a number"))
        })
        .collect()
}
