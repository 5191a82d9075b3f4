//! What is found out about the points of a stream as they were stored: verdict, rounding, digest.
//!
//! It is handed positions decoded from the encoded bytes. Where storing moves positions, the ones before are judged,
//! too, from the first that moved on. Never judges what was not stored in place of what was.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use tilescope_analysis::{Progress, Report, StreamBand, StreamVerifier, VerifyError};

use crate::certificate::Rounding;
use crate::codecs::Target;
use crate::digest::{add_positions, digest_text};
use crate::export::{Control, ExportContext, ExportError, statement};
use crate::format::{Format, Precision};

/// The judges of one export.
#[derive(Debug)]
pub(super) struct Judges {
    target: Target,
    pub stored: StreamVerifier,
    /// Judges the positions before storing. None as long as they are the same.
    pub original: Option<StreamVerifier>,
    pub largest_shift: f64,
    /// Of the positions in the file, where the file's rows are not just that.
    positions: Option<blake3::Hasher>,
}

/// Whether the rows of a file are the very bytes that a positions digest is of.
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

    pub fn expecting(self, count: u64) -> Self {
        Self {
            stored: self.stored.expecting(count),
            ..self
        }
    }

    /// Whether [`Self::remember`] does anything.
    pub fn remembers(&self) -> bool {
        self.positions.is_some()
    }

    /// Takes positions in file coordinates as an interrupted export stored them; the verifiers have
    /// them already.
    pub fn remember(&mut self, stored: &[[f64; 2]]) {
        if let Some(hasher) = &mut self.positions {
            add_positions(hasher, stored);
        }
    }

    /// Takes points as they were and, in file coordinates, as they are stored.
    pub fn take(
        &mut self,
        points: &[[f64; 2]],
        stored: &[[f64; 2]],
        control: Control<'_>,
    ) -> Result<(), ExportError> {
        self.remember(stored);
        let mapping = self.target.mapping();
        let domain: Vec<_> = stored
            .iter()
            .map(|&p| mapping.domain_from_file(p))
            .collect();
        let shifts = points
            .iter()
            .zip(&domain)
            .map(|(&a, &b)| mapping.shift(a, b));
        self.largest_shift = shifts.fold(self.largest_shift, f64::max);
        if self.largest_shift > 0.0 && self.original.is_none() {
            self.original = Some(self.stored.clone());
        }
        let told = Told::new(control);
        let judged = self.stored.push(&domain, &|progress| told.tell(progress));
        judged.map_err(|source| unjudged(&self.target, source))?;
        if let Some(original) = &mut self.original {
            // What else is wrong with them matters only if the stored set is invalid; it is told then.
            if let Err(source @ VerifyError::Cancelled) = original.push(points, &|_| told.ask()) {
                return Err(unjudged(&self.target, source));
            }
        }
        Ok(())
    }

    /// The verdict, what rounding had to do with it, and the positions digest, which is `rows` where
    /// the rows are the positions.
    pub fn finish(
        self,
        rows: String,
        control: Control<'_>,
    ) -> Result<(Report, Option<Rounding>, String), ExportError> {
        let target = self.target;
        let failed = |source| unjudged(&target, source);
        let told = Told::new(control);
        let report = (self.stored)
            .finish(&|progress| told.tell(progress))
            .map_err(failed)?;
        let (mut made_conflicts, mut made_gaps) = (false, false);
        if let (false, Some(original)) = (report.valid(), self.original) {
            let before = original.finish(&|_| told.ask()).map_err(failed)?;
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

/// Remembers what a control function was told last, so that a second verifier can ask it whether to go on
/// and tell nothing new: one bar shows one verdict's progress.
struct Told<'a> {
    control: Control<'a>,
    done: AtomicU64,
    total: AtomicU64,
}

impl<'a> Told<'a> {
    fn new(control: Control<'a>) -> Self {
        Self {
            control,
            done: AtomicU64::new(0),
            total: AtomicU64::new(0),
        }
    }

    fn tell(&self, progress: Progress) -> ControlFlow<()> {
        self.done.fetch_max(progress.done, Ordering::Relaxed);
        self.total.store(progress.total, Ordering::Relaxed);
        (self.control)(progress)
    }

    fn ask(&self) -> ControlFlow<()> {
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
