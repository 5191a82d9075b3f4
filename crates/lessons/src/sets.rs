//! The point sets of questions, in r, with their measures and spectra.

use std::ops::ControlFlow;

use glam::DVec2;
use tilescope_analysis::measures::{
    CATALOGUE, MeasureError, MeasuredSet, Part, Periodogram, SetNumber, Spectrum, number,
};
use tilescope_analysis::{Progress, Region};
use tilescope_core::{Key, Point, R, Run, Stream};
use tilescope_debugger::Recording;
use tilescope_sets::region_in_radii;

use crate::error::LessonError;

/// A point set in r.
#[derive(Debug)]
pub(crate) struct PointSet {
    /// The ids of its samples; empty if it was not taken from a recording.
    pub ids: Vec<u32>,
    pub points: Vec<[f64; 2]>,
    pub region: Region,
}

/// The highest relative frequency nu of spectra: 3 / r for maximal sets, as far as the plots of lessons reach.
const REACH_NU: f64 = 3.7;

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Returns the number of the catalogue with a key.
pub(crate) fn named(key: &str) -> Result<&'static SetNumber, String> {
    let keys = || CATALOGUE.iter().map(|number| number.key);
    let unknown = || LessonError::unknown(0, "measure", key, &keys().collect::<Vec<_>>());
    number(key).ok_or_else(|| unknown().message)
}

/// Returns a length of lattice units in r.
pub(crate) fn radii(units: impl Into<f64>) -> f64 {
    units.into() / f64::from(R)
}

/// Returns a point of the lattice in r.
pub(crate) fn position(point: Point) -> [f64; 2] {
    [radii(point.x), radii(point.y)]
}

/// Returns a number from 0 to 1 that is drawn from a word.
fn share(word: u32) -> f64 {
    f64::from(word) / 4_294_967_296.0
}

impl PointSet {
    /// Returns the samples that are valid at a cursor.
    pub fn at(recording: &Recording, cursor: usize) -> Self {
        let samples = &recording.run().samples.points;
        let all = 0..samples.len() as u32;
        let ids: Vec<u32> = all
            .filter(|&id| recording.status(id, cursor).is_valid())
            .collect();

        let points = ids
            .iter()
            .map(|&id| position(samples[id as usize]))
            .collect();

        let region = region_in_radii(recording.domain());
        Self {
            ids,
            points,
            region,
        }
    }

    /// Returns the result of a run.
    pub fn of_run(run: &Run) -> Self {
        Self {
            ids: run.result.clone(),
            points: run.points().into_iter().map(position).collect(),
            region: region_in_radii(&run.domain),
        }
    }

    /// Returns as many samples as this set has, drawn independently and uniformly: white noise.
    pub fn white(&self, seed: u64) -> Self {
        let key = Key::from_seed(seed).derive(Stream::Dart, 0);
        let drawn = (0..self.points.len() as u32).map(|index| {
            let [x, y] = key.draw(Stream::Dart, index).map(share);
            [x * self.region.width, y * self.region.height]
        });
        self.with(drawn.collect())
    }

    /// Returns other positions in the same region.
    fn with(&self, points: Vec<[f64; 2]>) -> Self {
        let (ids, region) = (Vec::new(), self.region);
        Self {
            ids,
            points,
            region,
        }
    }

    /// Returns about as many samples as this set has, one at a random place of each cell of a grid: jittered.
    pub fn jittered(&self, seed: u64) -> Self {
        // White noise has the number 0 of the stream, so that the two draw independently.
        let key = Key::from_seed(seed).derive(Stream::Dart, 1);
        // The side of a square cell that holds one sample in the mean; whole cells must fit the region.
        let side = (self.region.area() / self.points.len().max(1) as f64).sqrt();
        let [columns, rows] =
            [self.region.width, self.region.height].map(|extent| (extent / side).round().max(1.0));

        let cells =
            (0..rows as u32).flat_map(|row| (0..columns as u32).map(move |column| (column, row)));

        let drawn = cells.zip(0..).map(|((column, row), index)| {
            let [x, y] = key.draw(Stream::Dart, index).map(share);
            [
                (f64::from(column) + x) / columns * self.region.width,
                (f64::from(row) + y) / rows * self.region.height,
            ]
        });

        self.with(drawn.collect())
    }

    /// Returns the distance of two places, around the domain if it is periodic.
    pub fn distance(&self, a: [f64; 2], b: [f64; 2]) -> f64 {
        let mut offset = DVec2::from(a) - DVec2::from(b);
        if self.region.is_periodic() {
            let sides = DVec2::from(self.region.size());
            offset -= (offset / sides).round() * sides;
        }
        offset.x.hypot(offset.y)
    }

    /// Returns the sample nearest to a place, and its distance.
    pub fn nearest(&self, place: [f64; 2]) -> Option<(u32, f64)> {
        let all = self.ids.iter().zip(&self.points);
        let distances = all.map(|(&id, &point)| (id, self.distance(point, place)));
        distances.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    fn spectrum(&self) -> Result<Spectrum, MeasureError> {
        let window = Spectrum::window_to(REACH_NU, self.points.len() as f64, self.region)?;
        Spectrum::of(&Periodogram::of(
            &self.points,
            self.region,
            &window,
            &go_on,
        )?)
    }

    /// Returns the factor from a relative frequency nu to cycles per r.
    fn cycles_per_r(&self) -> f64 {
        (self.points.len() as f64 / self.region.area()).sqrt()
    }

    /// Returns the mean power by frequency in 1/r, with the number of frequencies behind each mean and their
    /// anisotropy, or why there is no spectrum.
    pub fn power(&self) -> Result<Vec<MeanPower>, String> {
        let spectrum = self.spectrum();
        let profile = spectrum.map_err(|error| error.to_string())?.profile;

        let unit = self.cycles_per_r();
        let annuli = profile
            .relative_frequencies()
            .into_iter()
            .zip(&profile.annuli);

        Ok(annuli
            .map(|(nu, annulus)| MeanPower {
                frequency: nu * unit,
                mean: annulus.power,
                count: annulus.count,
                anisotropy_db: annulus.anisotropy_db,
            })
            .collect())
    }

    /// Returns a number of the set, whose r is 1. Only what it needs is measured.
    pub fn number(&self, number: &SetNumber) -> Result<f64, String> {
        let mut set = MeasuredSet::new(self.points.len(), self.region, Some(1.0));

        let measured = match number.needs {
            None => Ok(()),
            // Questions show the spectrum farther than tables do.
            Some(Part::Spectrum) => self.spectrum().map(|found| set.take_spectrum(found)),
            Some(part) => set.measure(part, &self.points, &go_on),
        };
        measured.map_err(|error| error.to_string())?;

        // A report that was refused says why. Any other number that is missing is not defined for such a set.
        let refusal = || match &set.report {
            Some(Err(why)) => why.clone(),
            _ => format!("this set has no {}", number.key),
        };
        number.of(&set).ok_or_else(refusal)
    }
}

/// The mean power at a frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MeanPower {
    /// The frequency in 1/r.
    pub frequency: f64,
    pub mean: f64,
    /// How many frequencies it is the mean of.
    pub count: u64,
    pub anisotropy_db: f64,
}

/// Returns the mean power over a band of frequencies in 1/r, and its standard error: half of the frequencies are
/// independent, since opposite ones have the same power, and each power varies as much as its mean. Both are 0 in a
/// band without frequencies.
pub(crate) fn mean(power: &[MeanPower], [low, high]: [f64; 2]) -> (f64, f64) {
    let band = power
        .iter()
        .filter(|at| (low..high).contains(&at.frequency));

    let (mut sum, mut count) = (0.0, 0.0);
    for at in band {
        sum += at.mean * at.count as f64;
        count += at.count as f64;
    }

    let mean = sum / f64::max(count, 1.0);
    // In a band of one or two frequencies the error is the mean itself.
    (mean, mean / (0.5 * count).sqrt().max(1.0))
}

/// Returns the root of the mean squared difference of two curves, at the frequencies of the first.
pub(crate) fn rms(a: &[MeanPower], b: &[MeanPower]) -> f64 {
    // The two curves may have different frequencies: each of the first is compared with the nearest one of the second.
    let nearest = |at: f64| {
        b.iter().min_by(|p, q| {
            (p.frequency - at)
                .abs()
                .total_cmp(&(q.frequency - at).abs())
        })
    };

    let squares = a
        .iter()
        .filter_map(|p| Some((p.mean - nearest(p.frequency)?.mean).powi(2)));
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| {
        (sum + square, count + 1.0)
    });

    // Curves do not differ if one of them is empty.
    (sum / f64::max(count, 1.0)).sqrt()
}
