//! Measures the points of a stream as they were stored: verdict, rounding, digest.
//!
//! It gets positions decoded from the encoded bytes. If storing moves a position, the original positions are verified,
//! too, from that one on.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use tilescope_analysis::{Control, Progress, Report, StreamBand, StreamVerifier, VerifyError};

use crate::certificate::Rounding;
use crate::codecs::Target;
use crate::digest::{add_positions, digest_text};
use crate::export::{ExportContext, ExportError, statement};
use crate::format::{Format, Precision};

/// The verifiers and digests of one export.
#[derive(Debug)]
pub(super) struct Judges {
    target: Target,
    pub stored: StreamVerifier,
    /// Verifies the original positions. `None` as long as storing has not moved any.
    pub original: Option<StreamVerifier>,
    pub largest_shift: f64,
    /// The digest of the positions, if it is not simply that of the file's rows.
    positions: Option<blake3::Hasher>,
}

/// Whether the rows of a file are exactly the bytes that a positions digest hashes.
fn rows_are_positions(target: &Target) -> bool {
    matches!(target.format, Format::Npy | Format::UtkBinary)
        && target.precision == Precision::Double
}

impl Judges {
    pub fn new(target: Target, context: &ExportContext) -> Result<Self, ExportError> {
        let stored = StreamVerifier::new(context.region, context.radius, &context.verify);
        let positions = (!rows_are_positions(&target)).then(blake3::Hasher::new);
        Ok(Self {
            stored: stored.map_err(|source| unjudged(&target, source))?,
            original: None,
            largest_shift: 0.0,
            positions,
            target,
        })
    }

    pub fn with_band(self, band: StreamBand) -> Self {
        Self {
            stored: self.stored.with_band(band),
            original: self.original.map(|verifier| verifier.with_band(band)),
            ..self
        }
    }

    /// Sets the number of points of which progress is shown. That of the original positions is not shown, so that their
    /// verifier needs no number.
    pub fn expecting(self, count: u64) -> Self {
        Self {
            stored: self.stored.expecting(count),
            ..self
        }
    }

    /// Whether positions are digested here.
    pub fn digests(&self) -> bool {
        self.positions.is_some()
    }

    /// Adds positions that an interrupted export stored, in file coordinates, to the digest. The verifiers' saved state
    /// already has them.
    pub fn digest(&mut self, stored: &[[f64; 2]]) {
        if let Some(hasher) = &mut self.positions {
            add_positions(hasher, stored);
        }
    }

    /// Takes points as given and, in file coordinates, as stored.
    pub fn take(
        &mut self,
        points: &[[f64; 2]],
        stored: &[[f64; 2]],
        control: Control<'_>,
    ) -> Result<(), ExportError> {
        self.digest(stored);
        let mapping = self.target.mapping();

        let stored_in_domain = mapping.positions(stored);
        let shifts = points
            .iter()
            .zip(stored_in_domain.iter())
            .map(|(&a, &b)| mapping.shift(a, b));
        self.largest_shift = shifts.fold(self.largest_shift, f64::max);

        // Before these points storing has moved no position, so that the verifier of the stored positions has so far seen the
        // original ones, too: a copy of it goes on with these.
        if self.largest_shift > 0.0 && self.original.is_none() {
            self.original = Some(self.stored.clone());
        }

        let last = LastProgress::new(control);
        let judged = self
            .stored
            .push(&stored_in_domain, &|progress| last.report(progress));
        judged.map_err(|source| unjudged(&self.target, source))?;

        if let Some(original) = &mut self.original {
            // The original positions matter only if the stored set is invalid: other errors than a cancellation are reported
            // then, by `finish`.
            if let Err(source @ VerifyError::Cancelled) = original.push(points, &|_| last.repeat())
            {
                return Err(unjudged(&self.target, source));
            }
        }
        Ok(())
    }

    /// The verdict, the effect of rounding, and the positions digest, which is `rows` if the rows are the positions.
    pub fn finish(
        self,
        rows: String,
        control: Control<'_>,
    ) -> Result<(Report, Option<Rounding>, String), ExportError> {
        let target = self.target;
        let failed = |source| unjudged(&target, source);
        let last = LastProgress::new(control);
        let report = (self.stored)
            .finish(&|progress| last.report(progress))
            .map_err(failed)?;

        // Where the stored set is valid, storing has made neither conflicts nor gaps, whatever the original had.
        let (mut made_conflicts, mut made_gaps) = (false, false);
        if let (false, Some(original)) = (report.valid(), self.original) {
            let before = original.finish(&|_| last.repeat()).map_err(failed)?;
            made_conflicts = before.conflict_free() && !report.conflict_free();
            made_gaps = before.maximal() && !report.maximal();
        }

        let moved = self.largest_shift > 0.0;
        let rounding =
            moved.then(|| statement(&target, self.largest_shift, made_conflicts, made_gaps));
        let digest = self.positions.as_ref().map_or(rows, digest_text);
        Ok((report, rounding, digest))
    }
}

/// Keeps the last progress that was reported to a control function. A second verifier reports it again to ask whether to
/// go on, so that the progress bar shows the first verifier only.
struct LastProgress<'a> {
    control: Control<'a>,
    done: AtomicU64,
    total: AtomicU64,
}

impl<'a> LastProgress<'a> {
    fn new(control: Control<'a>) -> Self {
        Self {
            control,
            done: AtomicU64::new(0),
            total: AtomicU64::new(0),
        }
    }

    fn report(&self, progress: Progress) -> ControlFlow<()> {
        self.done.fetch_max(progress.done, Ordering::Relaxed);
        self.total.store(progress.total, Ordering::Relaxed);
        (self.control)(progress)
    }

    fn repeat(&self) -> ControlFlow<()> {
        (self.control)(Progress {
            done: self.done.load(Ordering::Relaxed),
            total: self.total.load(Ordering::Relaxed),
        })
    }
}

pub(super) fn unjudged(target: &Target, source: VerifyError) -> ExportError {
    let precision = target.format.precision(target.precision);
    ExportError::Verify { precision, source }
}
