//! Files of sets in space: all samples, or those of a moment, with the third coordinate.

use std::path::Path;

use tilescope_formats::{SolidContext, SolidExportedBytes, certificate_path, export_solid_bytes};
#[cfg(not(target_arch = "wasm32"))]
use tilescope_formats::{SolidExported, export_solid};
use tilescope_session::incoming::NamedBytes;
use tilescope_session::jobs::Monitor;
use tilescope_session::solid::{MadeSolid, planar_report};

use tilescope_formats::ExportContext;
use tilescope_sets::{columns_of, region};

use super::{ExportContent, ExportJob, What, WriteError, go_on};
use crate::export::provenance::{method, parameter_map};

/// The samples of an export in user units, what their certificate states, and whether they are the result.
struct SolidExport {
    points: Vec<[f64; 3]>,
    context: SolidContext,
    is_result: bool,
}

impl SolidExport {
    /// Gathers the samples of a job. Fails if it is cancelled.
    fn of(job: &ExportJob, solid: &MadeSolid, monitor: &Monitor) -> Result<Self, WriteError> {
        // The activity is what the caller does after this, which takes longer than gathering the samples.
        monitor.set_activity("verifying what was written");
        go_on(monitor)?;
        let (session, run) = (&*job.session, job.session.run());
        let mut points = solid.positions(run);
        let mut columns = columns_of(&solid.levels);

        let mut planar = ExportContext::new(region(&run.domain), run.domain.radius());
        method(session).clone_into(&mut planar.method);
        planar.parameters = parameter_map(session);
        let mut is_result = true;
        // Pictures and animations have no samples, and do not come here.
        if let ExportContent::Samples {
            moment, precision, ..
        } = &job.content
        {
            planar.precision = *precision;
            if let Some(moment) = moment {
                // Samples stay once they are there, so that those of a moment are the first ones by their arrival.
                let there = moment.samples(session).len();
                planar.made = (there < points.len()).then_some(points.len() as u64);
                points.truncate(there);
                columns.truncate(there);
                let description = moment.description(session);
                planar.parameters.insert("moment".to_owned(), description);
                is_result = false;
            }
        }

        let depth = solid.depth();
        Ok(Self {
            points,
            context: SolidContext {
                planar,
                depth,
                columns,
            },
            is_result,
        })
    }
}

/// Writes the samples and their certificate beside them.
#[cfg(not(target_arch = "wasm32"))]
pub(super) fn write(
    job: &ExportJob,
    solid: &MadeSolid,
    monitor: &Monitor,
) -> Result<What, WriteError> {
    let SolidExport {
        points,
        context,
        is_result,
    } = SolidExport::of(job, solid, monitor)?;

    let control = |progress| monitor.follow(progress);
    let SolidExported {
        certificate_path,
        verdict,
        warnings,
        ..
    } = export_solid(&job.path, &points, &context, &control)?;
    Ok(What::Samples {
        certificate: certificate_path,
        valid: verdict.valid(),
        report: Box::new(planar_report(verdict)),
        warnings,
        result: is_result,
    })
}

/// Appends the file of a set and its certificate to `files`. Returns the contents that were written, with the verdict on them.
pub(super) fn render(
    job: &ExportJob,
    solid: &MadeSolid,
    name: &str,
    files: &mut Vec<NamedBytes>,
    monitor: &Monitor,
) -> Result<What, WriteError> {
    let SolidExport {
        points,
        context,
        is_result,
    } = SolidExport::of(job, solid, monitor)?;
    let control = |progress| monitor.follow(progress);
    let SolidExportedBytes {
        data,
        certificate_bytes,
        verdict,
        warnings,
    } = export_solid_bytes(name, &points, &context, &control)?;

    let certificate = certificate_path(Path::new(name));
    let beside = certificate.to_string_lossy().into_owned();
    // The set itself comes first: the archive for a download is named after it.
    files.push(NamedBytes::new(name, data));
    files.push(NamedBytes::new(beside, certificate_bytes));
    Ok(What::Samples {
        certificate,
        valid: verdict.valid(),
        report: Box::new(planar_report(verdict)),
        warnings,
        result: is_result,
    })
}
