//! A point set from a file that moments are compared with. It must have the domain of the run: curves of other
//! domains are measured differently.

use std::sync::Arc;

use tilescope_analysis::measures::MeasuredSet;
use tilescope_analysis::{Boundary, Region};
use tilescope_formats::{ReadSet, refuse_degrees};
use tilescope_session::jobs::Monitor;
use tilescope_session::words::last_part;

use super::measured::{self, Samples};

/// A set from a file and its measures.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ReferenceFile {
    /// The path or name by which the file was opened.
    pub path: String,
    /// Whether its domain is assumed: a unit square with the boundary of the run's domain.
    pub guessed: bool,
    /// Its measures, in the unit of the file's domain.
    pub measured: Arc<MeasuredSet>,
}

impl ReferenceFile {
    /// Returns the last part of its path.
    #[must_use]
    pub fn name(&self) -> &str {
        last_part(&self.path)
    }

    /// Returns why it cannot be compared with a run on `run`, or `None` if it can.
    #[must_use]
    pub fn refusal(&self, run: Region) -> Option<String> {
        refusal(self.name(), self.measured.region, self.guessed, run)
    }
}

/// Returns a domain in words, in user units.
pub(crate) fn domain_text(region: Region) -> String {
    let border = match region.boundary {
        Boundary::Periodic => "periodic",
        Boundary::Bounded => "bounded",
    };
    format!("{} \u{d7} {} {border}", region.width, region.height)
}

/// Returns why a set from a file is not compared with the run, or `None` if it is.
fn refusal(name: &str, region: Region, guessed: bool, run: Region) -> Option<String> {
    // A side may differ by rounding: the run's is computed from its radius, the file's was written by any program.
    // The relative difference of 1e-9 is chosen, not measured.
    let same = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(b.abs());
    let fits = region.boundary == run.boundary
        && same(region.width, run.width)
        && same(region.height, run.height);
    let guess = if guessed {
        ", taken for one of the unit square because it has no certificate,"
    } else {
        ""
    };

    let [own, other] = [region, run].map(domain_text);
    (!fits).then(|| {
        format!(
            "{name}{guess} is a set on a domain of {own}, and this run's domain is {other}: only sets on the same domain can be compared."
        )
    })
}

/// Measures the point set of a file called `name`. `run` is the domain and `radius` the radius of the run, both
/// in user units. The run's radius is used even if the file states its own, so that r means the same for both.
///
/// Fails when the set has another domain or cannot be measured.
pub fn of(
    read: ReadSet,
    name: &str,
    run: Region,
    radius: f64,
    monitor: &Monitor,
) -> Result<ReferenceFile, String> {
    let named = |text: &str| format!("{name}: {text}");
    // A format that is defined on the unit torus says its domain. Any other file without a certificate is taken to be
    // on a unit square that ends as the run's domain does.
    let torus = read.detection.format.is_unit_torus();
    let unit = Region::new([1.0, 1.0], torus || run.is_periodic());
    let certificate = read.certificate.as_ref();
    let region = certificate.map_or(unit, |certificate| certificate.region);
    let guessed = certificate.is_none() && !torus;

    // Another domain is refused before anything that takes long: its curves would be measured differently, and could not be compared.
    if let Some(why) = refusal(last_part(name), region, guessed, run) {
        return Err(why);
    }
    // Longitudes and latitudes are no positions in a plane. The points that were read lie in the domain, whose lower
    // corner is 0.
    let lower_corner = [0.0; 2];
    refuse_degrees(&read, region, lower_corner).map_err(|error| named(&error.to_string()))?;

    let points = read.set.points;
    // Fewer samples have no pair correlation.
    if points.len() < 3 {
        return Err(named(
            "fewer than 3 samples, which are too few to be measured",
        ));
    }

    let set = Samples {
        points,
        region,
        radius,
    };
    let measured = set
        .measured(&|progress| monitor.follow(progress))
        .map_err(|error| {
            // Only a cancelled measurement has no reason.
            let why = measured::refusal(&error);
            named(why.as_deref().unwrap_or("cancelled"))
        })?;

    Ok(ReferenceFile {
        path: name.to_owned(),
        guessed,
        measured: Arc::new(measured),
    })
}
