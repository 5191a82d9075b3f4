//! Ways to place dots as dense as an image is dark: that of this program, and small ones of others, beside which it is held.

use tilescope_analysis::VerifyOptions;
use tilescope_core::{Key, Stream};
use tilescope_sets::{DEFAULT_WHITE, GrayImage, Made, StippleRecipe};

use super::images::Darkness;
use crate::control::Control;
use crate::error::{ReproduceError, Result};

/// Steps of Lloyd's method. More than that change little: Secord (2002) stops by eye.
pub const LLOYD_STEPS: usize = 60;
/// Tries to meet the number of dots by error diffusion, which loses some of the ink at the borders.
const TRIES: usize = 8;
/// Parts of a cell of error diffusion along each side, whose mean is its tone.
const PARTS: usize = 4;

/// A way to place dots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DotMethod {
    /// Stipples of this program.
    Stipple,
    /// Weighted Voronoi stippling (Secord 2002).
    Voronoi,
    /// Error diffusion (Floyd and Steinberg 1976).
    Diffusion,
    /// Independent dots.
    Random,
}

impl DotMethod {
    pub const ALL: [Self; 4] = [Self::Stipple, Self::Voronoi, Self::Diffusion, Self::Random];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Stipple => "stipple",
            Self::Voronoi => "weighted Voronoi",
            Self::Diffusion => "error diffusion",
            Self::Random => "random",
        }
    }

    /// Returns about `dots` dots in pixels of the image.
    pub fn dots(
        self,
        image: &GrayImage,
        dark: &Darkness,
        dots: usize,
        seed: u64,
        control: &Control<'_>,
    ) -> Result<Vec<[f64; 2]>> {
        match self {
            Self::Stipple => Ok(stipple(image, dots, seed, control)?.set.points),
            Self::Voronoi => {
                // As Secord: from dots that are as dense as the image, but independent.
                let mut sites = scattered(dark, dots, seed);
                for _ in 0..LLOYD_STEPS {
                    control.go_on()?;
                    sites = centroids(dark, &sites);
                }
                Ok(sites)
            }
            Self::Diffusion => Ok(diffused(dark, dots)),
            Self::Random => Ok(scattered(dark, dots, seed)),
        }
    }
}

/// Returns a stipple as users make it.
fn stipple(image: &GrayImage, dots: usize, seed: u64, control: &Control<'_>) -> Result<Made> {
    let recipe = StippleRecipe {
        image: image.clone(),
        white: DEFAULT_WHITE,
        dots: dots as u64,
        width: None,
        runs_on: false,
        seed,
    };
    Ok(recipe.make(&mut control.observer())?.made)
}

/// Fails unless the judge finds a stipple valid. It is made again, so that the time of the judge is not that of the dots.
pub fn check(image: &GrayImage, dots: usize, seed: u64, control: &Control<'_>) -> Result<()> {
    let made = stipple(image, dots, seed, control)?;
    let report = made.judge(&VerifyOptions::default(), &control.analysis())?;
    if report.valid() {
        return Ok(());
    }
    Err(ReproduceError::invalid("a stipple", &report))
}

/// Returns independent dots, as dense as the image is dark.
fn scattered(dark: &Darkness, dots: usize, seed: u64) -> Vec<[f64; 2]> {
    // The key differs from that of the seed, which the sampler uses.
    let key = Key::from_seed(seed).derive(Stream::Pattern, u32::MAX);
    let unit = |word: u32| f64::from(word) / (f64::from(u32::MAX) + 1.0);
    let side = dark.side as f64;

    let mut placed = Vec::with_capacity(dots);
    // A place takes two draws: its coordinates, and its coin.
    for index in (0_u32..).step_by(2) {
        if placed.len() == dots {
            break;
        }
        let place = key.draw(Stream::Dart, index).map(|word| side * unit(word));
        let [coin, _] = key.draw(Stream::Dart, index + 1);
        // A place is kept with a probability of its darkness.
        if unit(coin) < dark.pixels[dark.index(place)] {
            placed.push(place);
        }
    }
    placed
}

/// Sites in square cells, for the nearest of a place.
struct SiteGrid<'a> {
    sites: &'a [[f64; 2]],
    side: f64,
    columns: usize,
    cells: Vec<Vec<u32>>,
}

impl<'a> SiteGrid<'a> {
    /// Returns the grid of the sites of an image, with about as many cells as sites.
    fn new(sites: &'a [[f64; 2]], length: usize) -> Self {
        let columns = sites.len().isqrt().max(1);
        let mut grid = Self {
            sites,
            side: length as f64 / columns as f64,
            columns,
            cells: vec![Vec::new(); columns * columns],
        };
        for (index, &site) in sites.iter().enumerate() {
            let [column, row] = grid.cell(site);
            grid.cells[row * columns + column].push(index as u32);
        }
        grid
    }

    fn cell(&self, place: [f64; 2]) -> [usize; 2] {
        place.map(|at| ((at / self.side) as usize).min(self.columns - 1))
    }

    /// Returns the index of the site nearest to a place.
    fn nearest(&self, place: [f64; 2]) -> usize {
        let center = self.cell(place);
        let (mut nearest, mut least) = (0, f64::INFINITY);

        for ring in 0..=self.columns {
            // All places beyond the rings before are at least this far away.
            let beyond = ring.saturating_sub(1) as f64 * self.side;
            if beyond * beyond > least {
                break;
            }
            let range = |at: usize| at.saturating_sub(ring)..(at + ring + 1).min(self.columns);
            for row in range(center[1]) {
                for column in range(center[0]) {
                    // Cells within the ring were looked at before.
                    if row.abs_diff(center[1]).max(column.abs_diff(center[0])) < ring {
                        continue;
                    }
                    for &index in &self.cells[row * self.columns + column] {
                        let [x, y] = self.sites[index as usize];
                        let squared = (x - place[0]).powi(2) + (y - place[1]).powi(2);
                        if squared < least {
                            (nearest, least) = (index as usize, squared);
                        }
                    }
                }
            }
        }

        nearest
    }
}

/// Returns each site moved to the centroid of the darkness in its cell: a step of Lloyd's method, pixel by pixel.
fn centroids(dark: &Darkness, sites: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let grid = SiteGrid::new(sites, dark.side);
    let mut sums = vec![[0.0; 3]; sites.len()];
    for (index, &weight) in dark.pixels.iter().enumerate() {
        // White pixels weigh nothing.
        if weight == 0.0 {
            continue;
        }
        let [x, y] = [index % dark.side, index / dark.side].map(|at| at as f64 + 0.5);
        let sum = &mut sums[grid.nearest([x, y])];
        sum[0] += weight * x;
        sum[1] += weight * y;
        sum[2] += weight;
    }
    // A site stays where it is if it is nearest to no pixel, or to white ones alone.
    let moved = sites.iter().zip(sums);
    moved
        .map(|(&site, [x, y, all])| if all > 0.0 { [x / all, y / all] } else { site })
        .collect()
}

/// Returns the dots of error diffusion: the middles of the black cells of a raster. About `dots` cells are black.
fn diffused(dark: &Darkness, dots: usize) -> Vec<[f64; 2]> {
    // The share of cells that become black is the mean darkness of the image. The raster has as many cells as `dots`
    // divided by this share.
    let length = dark.side as f64;
    let columns = (dots as f64 * length * length / dark.sum())
        .sqrt()
        .round()
        .max(1.0) as usize;
    let pitch = length / columns as f64;
    let part_middle = |part: usize| (part as f64 + 0.5) / PARTS as f64;
    let place = |cell: usize, part: usize| (cell as f64 + part_middle(part)) * pitch;
    let tone = |index: usize| {
        let [column, row] = [index % columns, index / columns];
        let parts = (0..PARTS * PARTS).map(|part| {
            let at = [place(column, part % PARTS), place(row, part / PARTS)];
            dark.pixels[dark.index(at)]
        });
        parts.sum::<f64>() / (PARTS * PARTS) as f64
    };
    let tones: Vec<f64> = (0..columns * columns).map(tone).collect();

    // Ink that goes beyond a border is lost, so that some dots are missing. A factor makes all tones a little darker.
    // Each try corrects the factor by the number of dots that it gave.
    let (mut factor, mut best) = (1.0, Vec::new());
    for _ in 0..TRIES {
        let found = black_cells(&tones, columns, factor);
        // The 1 stands in where no cell is black.
        factor *= dots as f64 / found.len().max(1) as f64;
        if found.len().abs_diff(dots) < best.len().abs_diff(dots) {
            best = found;
        }
        if best.len() == dots {
            break;
        }
    }
    let middle = |at: usize| (at as f64 + 0.5) * pitch;
    best.into_iter()
        .map(|index: usize| [middle(index % columns), middle(index / columns)])
        .collect()
}

/// Returns the cells that are black after error diffusion, with the weights of Floyd and Steinberg. Each tone is
/// multiplied by `factor` before.
fn black_cells(tones: &[f64], columns: usize, factor: f64) -> Vec<usize> {
    let mut left: Vec<f64> = tones.iter().map(|tone| tone * factor).collect();
    let mut black = Vec::new();
    for index in 0..left.len() {
        let is_black = left[index] >= 0.5;
        let error = left[index] - f64::from(u8::from(is_black));
        if is_black {
            black.push(index);
        }

        let (is_first, is_last) = (index % columns == 0, (index + 1) % columns == 0);
        // The next cell of the row and three of the row below. Beyond the ends of a row, where no receiver exists, and
        // below the last row, where no cell is found, the error is lost.
        let receivers = [
            (!is_last, 1, 7.0),
            (!is_first, columns - 1, 3.0),
            (true, columns, 5.0),
            (!is_last, columns + 1, 1.0),
        ];
        for (exists, ahead, weight) in receivers {
            if let Some(next) = left.get_mut(index + ahead).filter(|_| exists) {
                *next += error * weight / 16.0;
            }
        }
    }
    black
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_site_is_that_of_a_search_through_all() {
        let dark = Darkness {
            side: 40,
            pixels: vec![0.5; 1600],
        };
        let sites = scattered(&dark, 60, 3);
        let grid = SiteGrid::new(&sites, 40);
        for place in scattered(&dark, 200, 4) {
            let squared =
                |site: &[f64; 2]| (site[0] - place[0]).powi(2) + (site[1] - place[1]).powi(2);
            let all = sites.iter().map(squared).fold(f64::INFINITY, f64::min);
            assert!((squared(&sites[grid.nearest(place)]) - all).abs() < 1e-12);
        }
    }

    #[test]
    fn error_diffusion_makes_half_of_grey_cells_black() {
        let found = black_cells(&[0.5_f64; 1].repeat(10_000), 100, 1.0).len();
        assert!((4900..5100).contains(&found), "{found}");
        assert_eq!(black_cells(&[0.0; 100], 10, 1.0).len(), 0);
    }
}
