//! Measures a moment for the analysis beside its picture.

use std::sync::Arc;

use tilescope_analysis::Control;
use tilescope_analysis::measures::{MeasureError, Periodogram, Spectrum};
use tilescope_drawing::picture::Beside;
use tilescope_session::moment::{Moment, Still};
use tilescope_session::sentence::name_in;
use tilescope_session::session::Session;
use tilescope_session::words::{counted, grouped};

use super::refusal::ExportRefusal;
use crate::analysis::measured::{Samples, refusal};
use crate::analysis::samples;

/// The most samples that an export measures, those of all pictures together: with the default 120 frames, those of runs of
/// 250,000 samples. At 15 microseconds a sample (57 frames of the default run, one core, the charts included) that is eight
/// minutes; drawing the samples takes twice as long.
pub const MAX_MEASURED: usize = 30_000_000;

/// The fewest samples that have a spectrum: the power of a single one is 1 at every frequency, wherever it is.
const MIN_SAMPLES: usize = 2;

/// Returns why this number of pictures of a session is not drawn with their analysis, if it is too large.
pub(crate) fn too_much(session: &Session, pictures: usize) -> Option<ExportRefusal> {
    let samples = session.summary.count;
    let is_too_much = pictures.saturating_mul(samples) > MAX_MEASURED;
    is_too_much.then_some(ExportRefusal::TooMuchMeasured { pictures, samples })
}

/// Returns what stands beside the picture of a moment.
///
/// # Errors
///
/// [`MeasureError::Cancelled`]. Any other reason for which there is no spectrum is written on the axes.
pub fn beside(
    session: &Arc<Session>,
    moment: Moment,
    control: Control<'_>,
) -> Result<Beside, MeasureError> {
    let set = samples(&Still::of(session, moment));
    let (shown, lack) = match spectrum(session, &set, control) {
        Ok(found) => (found, None),
        Err(error) => {
            // Cancellation alone has no words, and ends the export. Any other set without a spectrum still gets its axes, so that
            // the pictures of an animation have the same parts.
            let lack = refusal(&error).ok_or(MeasureError::Cancelled)?;
            (silence(session, &set)?, Some(lack))
        }
    };

    let stage = name_in(session, moment.stage);
    // Without a recording the cursor counts samples, not events.
    let event = match moment.cursor.filter(|_| session.recording().is_some()) {
        Some(cursor) => format!(", event {}", grouped(cursor)),
        None => String::new(),
    };
    let count = counted(set.points.len(), "sample", "samples");
    Ok(Beside {
        name: format!("{stage}{event}: {count}"),
        spectrum: shown,
        lack,
    })
}

/// Returns the spectrum of a set at the frequencies that the finished set has, in its unit: axes and cells of all moments are
/// then the same.
fn spectrum(
    session: &Session,
    set: &Samples,
    control: Control<'_>,
) -> Result<Spectrum, MeasureError> {
    let count = set.points.len();
    if count < MIN_SAMPLES {
        return Err(MeasureError::TooFew {
            count,
            limit: MIN_SAMPLES,
        });
    }

    let finished = session.summary.count as f64;
    let window = Spectrum::window(finished, set.region);
    let periodogram = Periodogram::of(&set.points, set.region, &window, control)?;

    // The number of samples, N, is that of the finished set, as the frequencies are, since nu is |k| / sqrt(N). With
    // the number of this moment the rings would move while samples come and go.
    Spectrum::of(&Periodogram {
        samples: finished,
        ..periodogram
    })
}

/// Returns the spectrum of no samples: no power at any frequency.
fn silence(session: &Session, set: &Samples) -> Result<Spectrum, MeasureError> {
    let finished = session.summary.count as f64;
    let window = Spectrum::window(finished, set.region);
    Spectrum::of(&Periodogram {
        power: vec![0.0; window.columns() * window.rows()],
        window,
        region: set.region,
        samples: finished,
        sets: 1,
    })
}

#[cfg(test)]
mod tests {
    use tilescope_core::{Parameters, Unobserved, sample};

    use super::*;

    #[test]
    fn pictures_are_measured_up_to_the_limit() {
        let parameters = Parameters {
            radius: 0.03,
            leaf: 8.0,
            ..Parameters::default()
        };
        let run = sample(&parameters, &mut Unobserved).expect("a run");
        let session = Session::from_run(run, 0);
        let samples = session.summary.count;
        let most = MAX_MEASURED / samples;
        assert_eq!(too_much(&session, most), None);
        let pictures = most + 1;
        let refusal = ExportRefusal::TooMuchMeasured { pictures, samples };
        assert_eq!(too_much(&session, pictures), Some(refusal));
    }
}
