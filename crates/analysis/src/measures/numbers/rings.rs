//! Numbers that are read from the rings of a spectrum, whose frequencies are in 1/r.

use super::super::measured::MeasuredSet;
use super::super::radial::Annulus;

/// The end of the low frequencies, in 1/r: the power of maximal sets begins to rise there.
const LOW: f64 = 0.3;

/// A ring and its frequency in 1/r.
struct Ring<'a> {
    frequency: f64,
    annulus: &'a Annulus,
}

/// Returns the rings as far as the spectrum was measured, the lowest first; `None` without a spectrum or without r.
fn rings(set: &MeasuredSet) -> Option<Vec<Ring<'_>>> {
    let profile = &set.spectrum.as_ref()?.profile;
    let cycles_per_r = (set.samples as f64 / set.region.area()).sqrt() * set.r()?;

    let frequencies = profile.relative_frequencies().into_iter();
    let rings = frequencies.zip(&profile.annuli);
    let ring = |(nu, annulus)| Ring {
        frequency: nu * cycles_per_r,
        annulus,
    };
    Some(rings.map(ring).collect())
}

/// Returns the frequency of the ring with the highest mean power.
pub(super) fn peak(set: &MeasuredSet) -> Option<f64> {
    let rings = rings(set)?;
    let power = |ring: &&Ring<'_>| ring.annulus.power;
    let highest = rings.iter().max_by(|a, b| power(a).total_cmp(&power(b)))?;
    Some(highest.frequency)
}

/// Returns the mean power below [`LOW`].
pub(super) fn low_power(set: &MeasuredSet) -> Option<f64> {
    let rings = rings(set)?;
    // A spectrum that ends before holds only a part of these frequencies.
    rings.last().filter(|last| last.frequency >= LOW)?;

    let (mut sum, mut count) = (0.0, 0.0);
    for ring in rings.iter().filter(|ring| ring.frequency < LOW) {
        let frequencies = ring.annulus.count as f64;
        sum += ring.annulus.power * frequencies;
        count += frequencies;
    }
    (count > 0.0).then_some(sum / count)
}

/// Returns the largest anisotropy from [`LOW`] on. Below there is so little power that its scatter says nothing.
pub(super) fn anisotropy(set: &MeasuredSet) -> Option<f64> {
    let rings = rings(set)?;
    let high = rings.iter().filter(|ring| ring.frequency >= LOW);
    let found = high.map(|ring| ring.annulus.anisotropy_db);
    found.filter(|value| value.is_finite()).reduce(f64::max)
}
