//! What has a column in the tables and a curve in the charts: a set, or the average of several.
//! An average takes its sets one after another and keeps none of them.

use anyhow::Result;
use tilescope_analysis::Region;
use tilescope_analysis::measures::{
    Average, DifferenceCurve, MeanCurve, MeanPeriodogram, MeasureError, PowerCurve, RadialProfile,
    Spectrum,
};

use super::measured::{Common, Measured, Member};
use super::scalars::{Scalar, of_mean_power};

/// A number of a column.
pub struct Number {
    pub scalar: Scalar,
    /// What is known of it over several sets.
    pub spread: Option<Spread>,
}

/// A number over several sets.
#[derive(Clone, Copy)]
pub struct Spread {
    pub standard_error: f64,
    /// The ends of the interval that holds the true mean with probability 0.95.
    pub band: [f64; 2],
    pub least: f64,
    pub most: f64,
}

/// A column of the tables.
pub struct Subject {
    /// Its name in CSV and JSON: the file as it was given.
    pub name: String,
    /// Its name where people read: short, and of no other subject.
    pub label: String,
    pub region: Region,
    /// An average, of `members`; otherwise one set.
    pub average: bool,
    pub members: Vec<Member>,
    pub numbers: Vec<Number>,
    pub spectrum: Spectrum,
    /// Ends of the band of each annulus's mean power.
    pub power_bands: Option<Vec<[f64; 2]>>,
    /// Mean powers by the spread between sets.
    powers: MeanCurve,
    correlation: MeanCurve,
    correlation_bands: Option<Vec<[f64; 2]>>,
}

/// A place of a curve.
pub struct Place {
    pub x: f64,
    pub y: f64,
    pub band: Option<[f64; 2]>,
}

/// Returns the places of a curve, with a band if there is one.
pub fn places(curve: &[[f64; 2]], bands: Option<&Vec<[f64; 2]>>) -> Vec<Place> {
    let each = curve.iter().enumerate();
    each.map(|(index, [x, y])| Place {
        x: *x,
        y: *y,
        band: bands.map(|bands| bands[index]),
    })
    .collect()
}

impl Subject {
    /// Returns the column of one set.
    pub fn one(measured: Measured) -> Self {
        let Measured {
            member,
            spectrum,
            pairs,
            ..
        } = measured;
        let [nu, distances] = [spectrum.power(), pairs];
        Self {
            name: member.name.clone(),
            label: member.name.clone(),
            region: member.region,
            average: false,
            numbers: (member.scalars.iter().cloned())
                .map(|scalar| Number {
                    scalar,
                    spread: None,
                })
                .collect(),
            powers: curve(&nu),
            power_bands: spectrum.bands.clone(),
            correlation: curve(&distances),
            correlation_bands: None,
            members: vec![member],
            spectrum,
        }
    }

    /// Number of sets behind it.
    pub fn sets(&self) -> u64 {
        self.spectrum.profile.sets
    }

    /// Returns the mean powers as nu, power and, where there is one, the ends of its band.
    pub fn power(&self) -> Vec<Place> {
        places(&self.spectrum.power(), self.power_bands.as_ref())
    }

    /// Returns the anisotropies in decibels; annuli without one are left out.
    pub fn anisotropy(&self) -> Vec<Place> {
        places(&self.spectrum.anisotropy(), None)
    }

    /// Returns the pair correlation.
    pub fn correlation(&self) -> Vec<Place> {
        let MeanCurve { x, y, .. } = &self.correlation;
        let curve: Vec<[f64; 2]> = x.iter().zip(y).map(|(x, y)| [*x, *y]).collect();
        places(&curve, self.correlation_bands.as_ref())
    }

    /// Returns how its radial mean power and its pair correlation differ from a reference's.
    pub fn less(&self, reference: &Self) -> Result<[DifferenceCurve; 2], MeasureError> {
        // Bounded sets are tapered: neighbouring powers are not independent, but sets are.
        let independent = self.spectrum.bands.is_some() && reference.spectrum.bands.is_some();
        let level = Spectrum::LEVEL;
        let power = if independent {
            let profiles = [self, reference].map(|subject| &subject.spectrum.profile);
            DifferenceCurve::of_powers(profiles[0], profiles[1], level)?
        } else {
            DifferenceCurve::of_means(&self.powers, &reference.powers, level)?
        };
        let pairs = DifferenceCurve::of_means(&self.correlation, &reference.correlation, level)?;
        Ok([power, pairs])
    }
}

fn curve(places: &[[f64; 2]]) -> MeanCurve {
    MeanCurve {
        x: places.iter().map(|place| place[0]).collect(),
        y: places.iter().map(|place| place[1]).collect(),
        errors: None,
        sets: 1,
    }
}

/// An average in the making.
#[derive(Default)]
pub struct Population {
    common: Option<Common>,
    members: Vec<Member>,
    distances: Vec<f64>,
    periodograms: MeanPeriodogram,
    powers: Option<Average>,
    correlations: Option<Average>,
    smooth: Smooth,
}

/// The mean of smooth spectra, while every set has one.
#[derive(Default)]
enum Smooth {
    #[default]
    Nothing,
    Mean {
        frequencies: Vec<f64>,
        powers: Average,
    },
    Missing,
}

impl Smooth {
    fn add(&mut self, curve: Option<&PowerCurve>) -> Result<(), MeasureError> {
        let Some(curve) = curve else {
            *self = Self::Missing;
            return Ok(());
        };
        if matches!(self, Self::Nothing) {
            *self = Self::Mean {
                frequencies: curve.frequencies().to_vec(),
                powers: Average::new(curve.powers().len()),
            };
        }
        match self {
            Self::Mean { powers, .. } => powers.add(curve.powers()),
            Self::Nothing | Self::Missing => Ok(()),
        }
    }

    fn mean(self) -> Option<PowerCurve> {
        match self {
            Self::Mean {
                frequencies,
                powers,
            } => PowerCurve::new(frequencies, powers.means().to_vec()).ok(),
            Self::Nothing | Self::Missing => None,
        }
    }
}

impl Population {
    /// Returns what the first set decided for the others.
    pub fn common(&self) -> Option<&Common> {
        self.common.as_ref()
    }

    /// Adds a set that was measured with [`Self::common`].
    pub fn add(&mut self, measured: Measured) -> Result<(), MeasureError> {
        if self.common.is_none() {
            self.common = Some(Common::of(&measured));
            let places = measured.pairs.iter();
            self.distances = places.map(|place| place[0]).collect();
        }
        let Measured {
            member,
            spectrum,
            curve,
            pairs,
            periodogram,
            ..
        } = measured;
        self.smooth.add(curve.as_ref())?;
        self.periodograms.add(&periodogram)?;
        let powers = spectrum.profile.powers();
        self.powers
            .get_or_insert_with(|| Average::new(powers.len()))
            .add(&powers)?;
        let correlation: Vec<f64> = pairs.iter().map(|place| place[1]).collect();
        self.correlations
            .get_or_insert_with(|| Average::new(correlation.len()))
            .add(&correlation)?;
        self.members.push(member);
        Ok(())
    }

    /// Returns the column of the average; none without a set.
    pub fn finish(self) -> Result<Option<Subject>, MeasureError> {
        let (Some(mean), Some(powers), Some(correlations)) =
            (self.periodograms.mean(), self.powers, self.correlations)
        else {
            return Ok(None);
        };
        let spectrum = Spectrum::of(&mean)?;
        let power_bands = match &spectrum.bands {
            Some(bands) => Some(bands.clone()),
            None => powers.band(Spectrum::LEVEL)?,
        };
        let label = match self.members.len() {
            1 => "average of 1 set".to_owned(),
            sets => format!("average of {sets} sets"),
        };
        let mut numbers = numbers(&self.members)?;
        numbers.extend(
            of_mean_power(self.smooth.mean().as_ref())
                .into_iter()
                .map(|scalar| Number {
                    scalar,
                    spread: None,
                }),
        );
        Ok(Some(Subject {
            name: label.clone(),
            label,
            region: mean.region,
            average: true,
            numbers,
            powers: averaged(&powers, nus(&spectrum.profile)),
            power_bands,
            correlation_bands: correlations.band(Spectrum::LEVEL)?,
            correlation: averaged(&correlations, self.distances),
            members: self.members,
            spectrum,
        }))
    }
}

fn nus(profile: &RadialProfile) -> Vec<f64> {
    profile.relative_frequencies()
}

fn averaged(average: &Average, x: Vec<f64>) -> MeanCurve {
    MeanCurve {
        x,
        y: average.means().to_vec(),
        errors: average.standard_errors(),
        sets: average.sets(),
    }
}

/// Returns the numbers of an average: means over the sets in which they are defined.
fn numbers(members: &[Member]) -> Result<Vec<Number>, MeasureError> {
    let rows = members.first().map_or(0, |first| first.scalars.len());
    (0..rows)
        .map(|row| {
            let scalars: Vec<&Scalar> = (members.iter())
                .map(|member| &member.scalars[row])
                .collect();
            number(&scalars)
        })
        .collect()
}

fn number(scalars: &[&Scalar]) -> Result<Number, MeasureError> {
    let mut average = Average::new(1);
    let [mut least, mut most] = [f64::INFINITY, f64::NEG_INFINITY];
    for value in scalars.iter().filter_map(|scalar| scalar.value) {
        average.add(&[value])?;
        (least, most) = (least.min(value), most.max(value));
    }
    let errors = average.standard_errors();
    let band = average.band(Spectrum::LEVEL)?;
    Ok(Number {
        scalar: Scalar {
            value: (average.sets() > 0).then(|| average.means()[0]),
            ..scalars[0].clone()
        },
        spread: errors.zip(band).map(|(errors, band)| Spread {
            standard_error: errors[0],
            band: band[0],
            least,
            most,
        }),
    })
}
