//! Re-verification in bounded memory; small files are read whole.
//!
//! A file that a stream cannot verify (points not in row order, a wide hole) is also read whole, up to a limit. The
//! result is the same as that of [`check`](crate::check).

use std::path::Path;

use tilescope_analysis::{Control, StreamVerifier};

use super::read::StreamReader;
use crate::certificate::Certificate;
use crate::check::{Check, CheckError, Contents, Judged, Overrides};
use crate::digest::{add_positions, digest_text};
use crate::error::io_error;
use crate::files::{MAX_IN_MEMORY, check};
use crate::pipe::Input;

/// Files up to this many bytes, 32 MiB, are read whole: that takes about 150 MB for two million points.
pub const WHOLE_FILE_BYTES: u64 = 32 << 20;

/// Re-verifies the file `path` against the certificate beside or inside it, as [`check`](crate::check) does, without
/// holding its points if it is large and in row order.
///
/// # Errors
///
/// As [`check`](crate::check), and [`CheckError::TooLarge`] for a file that a stream cannot verify and that has, or as
/// a text may have, more than [`MAX_IN_MEMORY`] points.
pub fn check_stream(
    path: &Path,
    overrides: &Overrides,
    control: Control<'_>,
) -> Result<Check, CheckError> {
    check_from(path, overrides, WHOLE_FILE_BYTES, control)
}

/// As [`check_stream`], with files of up to `whole` bytes read whole.
pub(super) fn check_from(
    path: &Path,
    overrides: &Overrides,
    whole: u64,
    control: Control<'_>,
) -> Result<Check, CheckError> {
    let in_memory = || check(path, overrides, control).map(|(_, check)| check);
    let length =
        (Input::open(path).and_then(|input| input.length())).map_err(|e| io_error(path, e))?;
    // Small files are read whole. So is a file of which one set is chosen. A set whose radius varies or that covers a
    // shape (`varying`) is judged by subdivision, which needs all samples at once.
    if length <= whole || overrides.set.is_some() || overrides.varying.is_some() {
        return in_memory();
    }

    let columns = overrides.chosen_columns();
    let digested = true;
    // The inner error is of a file that is not a head and rows, one for each point: it has to be read whole.
    let Ok(reader) = StreamReader::try_open(path, overrides.format, columns, digested)? else {
        return in_memory();
    };

    let reader = if overrides.without_certificate {
        reader.without_certificate()
    } else {
        reader
    };

    // Shuffled points, and those of levels, are not in the order of rows, and a stream would fail after it has read a
    // part of them. Their file is read whole at once, unless it states too many points. A text states no number:
    // whether it is too large shows when it is read.
    let is_not_in_rows =
        |stated: &Certificate| stated.shuffle_seed.is_some() || !stated.levels.is_empty();
    if reader.certificate().is_some_and(is_not_in_rows)
        && reader.count().is_none_or(|count| count <= MAX_IN_MEMORY)
    {
        return in_memory();
    }

    // A point of a text takes at least four bytes, as in `0,0` and its line end: a text has at most this many points.
    // The limit below is compared with this bound, so that some texts are refused that have fewer points.
    let count = reader.count().unwrap_or(length / 4);

    match in_pieces(reader, overrides, control) {
        Err(CheckError::Verify(source)) if source.needs_memory() => {
            let limit = MAX_IN_MEMORY;
            if count > limit {
                return Err(CheckError::TooLarge {
                    count,
                    limit,
                    source,
                });
            }
            in_memory()
        }
        outcome => outcome,
    }
}

/// Verifies a file piece by piece and compares it with its certificate.
fn in_pieces(
    mut reader: StreamReader,
    overrides: &Overrides,
    control: Control<'_>,
) -> Result<Check, CheckError> {
    let (detection, precision) = (reader.detection(), reader.precision());
    let certificate = reader.certificate().cloned();
    let judged = Judged::new(detection.format, precision, certificate.as_ref(), overrides)?;
    let mut verifier = StreamVerifier::new(judged.region, judged.radius, &judged.options)?
        .expecting(reader.expected());
    // Positions are hashed only if there is a certificate, which states their digest.
    let mut positions = certificate.as_ref().map(|_| blake3::Hasher::new());

    // The digest is of the positions as they are in the file; the verifier gets those in the domain.
    while let Some(mut points) = reader.next_stored()? {
        if let Some(hasher) = &mut positions {
            add_positions(hasher, &points);
        }
        for point in &mut points {
            *point = judged.mapping.domain_from_file(*point);
        }
        let pushed = verifier.push(&points, control);
        pushed.map_err(|error| judged.fault(error, detection.format))?;
    }

    let report = verifier.finish(control)?;
    let found = Contents {
        format: detection.format,
        precision,
        digest: reader.finish_digest()?,
        positions_digest: positions.as_ref().map_or_else(String::new, digest_text),
        count: report.count as u64,
    };

    // No set of levels comes this far, as its points are not in the order of rows.
    let levels = Vec::new();
    Ok(Check::new(
        detection,
        certificate,
        &judged,
        &found,
        report,
        levels,
    ))
}
