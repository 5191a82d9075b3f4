//! A set in space, or the average of several, as a column of the table and a curve in each chart.

use anyhow::Result;
use tilescope_analysis::measures::{Average, DifferenceCurve, MeanCurve, MeasureError, Spectrum};
use tilescope_analysis::{PlanePower, SolidShell};

use super::measured::Measured;
use crate::analyze::curve::Curve;
use crate::analyze::differences::Differences;
use crate::analyze::measure::Measure;
use crate::analyze::names;
use crate::solid::box_text;

/// As many standard errors to both sides hold the mean with probability 0.95.
const REACH: f64 = 1.96;

/// A column of the table and a curve in each chart: a set, or the average of several.
pub struct SolidSubject {
    /// The path of the file, or the name of the average.
    pub name: String,
    pub label: String,
    /// The domain, and where the radius is from.
    pub words: [String; 2],
    pub numbers: Vec<Measure>,
    pub curves: [(&'static str, Curve); 3],
    /// The power without a cycle along x, along y, and along z.
    pub planes: [PlanePower; 3],
    /// The power and the pair correlation, with the spread between the sets of an average.
    means: [MeanCurve; 2],
    /// The squared errors of the powers of one set, from the scatter between its frequencies.
    scatter: Option<MeanCurve>,
}

impl SolidSubject {
    /// Returns the column of one set.
    pub fn one(set: Measured, label: String) -> Self {
        let [power, anisotropy, pairs] = set.curves();
        let band =
            |shell: &SolidShell| [-REACH, REACH].map(|by| shell.power + by * shell.standard_error);
        let shells = &set.spectrum.shells;
        let bands = shells.iter().map(band).collect();
        let squared = |shell: &SolidShell| [shell.nu, shell.standard_error.powi(2)];
        let scatter: Vec<[f64; 2]> = shells.iter().map(squared).collect();
        Self {
            words: words(&set),
            name: set.name,
            label,
            planes: set.planes,
            numbers: set.numbers,
            means: [of_one(&power), of_one(&pairs)],
            scatter: Some(of_one(&scatter)),
            // Of one set only the powers have a known error: the other two curves have no bands.
            curves: named_curves([
                Curve::new(power, Some(bands)),
                Curve::new(anisotropy, None),
                Curve::new(pairs, None),
            ]),
        }
    }

    /// Returns the column of the average of some sets, at least one.
    pub fn average(sets: &[Measured]) -> Result<Self> {
        // All sets have the same numbers, of which some may be undefined.
        let numbers = (0..sets[0].numbers.len()).map(|index| {
            let all: Vec<&Measure> = sets.iter().map(|set| &set.numbers[index]).collect();
            Measure::mean(&all)
        });
        let curves: Vec<[Vec<[f64; 2]>; 3]> = sets.iter().map(Measured::curves).collect();
        let [power, anisotropy, pairs] = [0, 1, 2].map(|which| -> Result<(MeanCurve, Curve)> {
            let of_sets: Vec<&[[f64; 2]]> = curves.iter().map(|own| &own[which][..]).collect();
            mean_curve(&of_sets)
        });

        let ((power, power_curve), (_, anisotropy_curve), (pairs, pairs_curve)) =
            (power?, anisotropy?, pairs?);
        let names: Vec<&str> = sets.iter().map(|set| set.name.as_str()).collect();
        Ok(Self {
            // All sets have the box of the first set. Distances are in radii of the first set, so that the words say
            // where that radius is from. The radii of the other sets may be from elsewhere.
            words: words(&sets[0]),
            name: names::pattern(&names),
            label: format!("mean of {}", sets.len()),
            numbers: numbers.collect::<Result<_, _>>()?,
            planes: mean_planes(sets)?,
            curves: named_curves([power_curve, anisotropy_curve, pairs_curve]),
            means: [power, pairs],
            scatter: None,
        })
    }

    /// Returns the differences from a reference.
    pub fn less(&self, reference: &Self) -> Result<Differences> {
        let of_curve = |which: usize| {
            DifferenceCurve::of_means(&self.means[which], &reference.means[which], Spectrum::LEVEL)
        };
        let (mut power, pairs) = (of_curve(0)?, of_curve(1)?);

        // Two single sets have no spread between sets, but each has the scatter between its frequencies. The squared
        // error of their difference is the sum of their squared errors. `DifferenceCurve` can only subtract, but it
        // does so at the frequencies of `power`. The reference's squared errors are therefore negated first.
        if let (Some(own), Some(base)) = (&self.scatter, &reference.scatter) {
            let opposite = MeanCurve {
                y: base.y.iter().map(|square| -square).collect(),
                ..base.clone()
            };
            let sums = DifferenceCurve::of_means(own, &opposite, Spectrum::LEVEL)?;
            let band = |point: &[f64; 2]| [-REACH, REACH].map(|by| by * point[1].sqrt());
            power.bands = Some(sums.points.iter().map(band).collect());
        }

        let points_and_unit = ["shells", "r"];
        Ok(Differences::between(
            &self.numbers,
            &reference.numbers,
            [power, pairs],
            points_and_unit,
        ))
    }
}

/// Returns the mean of each plane over some sets.
fn mean_planes(sets: &[Measured]) -> Result<[PlanePower; 3], MeasureError> {
    let mean = |which: usize| {
        let all: Vec<&PlanePower> = sets.iter().map(|set| &set.planes[which]).collect();
        PlanePower::mean(&all)
    };
    Ok([mean(0)?, mean(1)?, mean(2)?])
}

/// Returns a curve of one set, which has no spread.
fn of_one(points: &[[f64; 2]]) -> MeanCurve {
    let column = |axis: usize| points.iter().map(|point| point[axis]).collect();
    MeanCurve {
        x: column(0),
        y: column(1),
        errors: None,
        sets: 1,
    }
}

/// Returns the words of a set in the table.
fn words(set: &Measured) -> [String; 2] {
    let origin = if set.has_radius {
        "known"
    } else {
        "smallest distance"
    };
    [box_text(&set.region), origin.to_owned()]
}

/// Returns curves with the names that those of planar sets have in files.
fn named_curves([power, anisotropy, pairs]: [Curve; 3]) -> [(&'static str, Curve); 3] {
    [
        ("power", power),
        ("anisotropy", anisotropy),
        ("pair_correlation", pairs),
    ]
}

/// Returns the mean of some curves in two forms: with its errors, for differences; and with its band, to be drawn.
fn mean_curve(curves: &[&[[f64; 2]]]) -> Result<(MeanCurve, Curve)> {
    // Rounding may cost one of the curves its last shell: the mean ends where the shortest curve does.
    let length = curves.iter().map(|curve| curve.len()).min().unwrap_or(0);
    let [mut x, mut y] = [Average::new(length), Average::new(length)];
    for curve in curves {
        let column =
            |axis: usize| -> Vec<f64> { curve[..length].iter().map(|point| point[axis]).collect() };
        x.add(&column(0))?;
        y.add(&column(1))?;
    }
    let points = x.means().iter().zip(y.means()).map(|(x, y)| [*x, *y]);
    let mean = MeanCurve {
        x: x.means().to_vec(),
        y: y.means().to_vec(),
        errors: y.standard_errors(),
        sets: y.sets(),
    };
    Ok((mean, Curve::new(points.collect(), y.band(Spectrum::LEVEL)?)))
}
