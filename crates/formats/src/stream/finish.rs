//! The end of a streamed export: final head, verdict, reading back, certificate, renaming.

use std::ops::ControlFlow;
use std::path::PathBuf;

use tilescope_analysis::{Control, Progress, Report, VerifyError};

use super::export::StreamExport;
use super::judge::unjudged;
use super::resume;
use crate::certificate::Certificate;
use crate::error::FormatError;
use crate::export::{ExportError, Warning, certificate, notes, warnings};
use crate::files::Exported;

/// The outcome of a finished [`StreamExport`].
#[derive(Clone, Debug)]
pub struct Streamed {
    /// The path of the data file.
    pub path: PathBuf,
    /// The number of points written.
    pub count: u64,
    /// The length of the data file in bytes.
    pub bytes: u64,
    /// The result that [`export`](crate::export) would have returned; `None` if the stream was not verified.
    pub verified: Option<Exported>,
    /// Warnings for the user.
    pub warnings: Vec<Warning>,
}

impl StreamExport {
    /// Reads the file back, gives it its final name and writes the certificate.
    ///
    /// A set need not be valid: an invalid one is exported with `valid: false` and a warning.
    ///
    /// # Errors
    ///
    /// [`ExportError`]. An existing file is unchanged, and a resumable export can still be resumed.
    pub fn finish(mut self, control: Control<'_>) -> Result<Streamed, ExportError> {
        let streamed = self.guarded(|this| this.complete(control))?;
        resume::remove(&self.file);
        Ok(streamed)
    }

    /// Writes the final head, judges, reads back, and gives the files their names.
    fn complete(&mut self, control: Control<'_>) -> Result<Streamed, ExportError> {
        let (format, count) = (self.target.format, self.count);

        if count == 0 {
            return Err(FormatError::Empty { format }.into());
        }

        let head = self.head(count)?;
        self.partial.complete(head)?;
        let certificate = self.certify(control)?;
        // The file gets its name only after it was read back and compared with the bytes that were written. Its digest is for the
        // certificate, and not needed without one.
        let digest = self.read_back(certificate.is_some(), control)?;
        let bytes = self.partial.bytes();

        let (path, mut verified) = (self.path.clone(), None);
        match certificate {
            Some((mut certificate, report)) => {
                certificate.digest = digest;
                self.put(Some(&certificate.to_bytes()?))?;
                verified = Some(Exported {
                    certificate_path: self.place.certificate.clone(),
                    path: path.clone(),
                    warnings: warnings(self.provenance, format, &certificate),
                    certificate,
                    report,
                });
            }
            None => self.put(None)?,
        }

        let warnings = match &verified {
            Some(exported) => exported.warnings.clone(),
            None => notes(self.provenance, format),
        };

        Ok(Streamed {
            path,
            count,
            bytes,
            verified,
            warnings,
        })
    }

    fn certify(
        &mut self,
        control: Control<'_>,
    ) -> Result<Option<(Certificate, Report)>, ExportError> {
        let Some(judges) = self.judges.take() else {
            return Ok(None);
        };
        let rows = self.partial.rows_digest()?;
        let (report, rounding, digest) = judges.finish(rows, control)?;
        let (name, context) = (&self.name, &self.context);
        let certificate = certificate(name, &self.target, context, &report, rounding, digest);
        Ok(Some((certificate, report)))
    }

    /// Reads the written file once more, and returns its digest if it is asked for.
    fn read_back(
        &mut self,
        is_digested: bool,
        control: Control<'_>,
    ) -> Result<Option<String>, ExportError> {
        // Progress counts each sample twice, as the verifier does, and is at its end before the file is read back.
        let total = 2 * self.count;
        let at_the_end = Progress { done: total, total };
        self.partial
            .read_back(is_digested, &|| match control(at_the_end) {
                ControlFlow::Continue(()) => Ok(()),
                ControlFlow::Break(()) => {
                    let cancelled = VerifyError::Cancelled;
                    Err(unjudged(&self.target, cancelled))
                }
            })
    }

    /// Puts the data file in its place, with a certificate of these bytes or without one.
    fn put(&self, certificate: Option<&[u8]>) -> Result<(), FormatError> {
        self.place.put(&self.partial.path, certificate)
    }
}
