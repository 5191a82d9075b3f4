//! The sets of a layout that places several side by side, and the layout as certificates state it.

use serde_json::{Value, json};
use tilescope_core::combine::file::{Layout, PieceSource, PlacedLayout, Set};
use tilescope_core::{Observer, Pattern, SampleError};

use crate::domain::GivenDomain;
use crate::facts::Stated;

/// Makes the set of a piece, or has it read by `read`, which gets the file's path and what the layout says of its domain.
///
/// # Errors
///
/// [`SampleError`] when the set cannot be made, and those of `read`.
pub fn set_of_piece<E: From<SampleError>>(
    source: &PieceSource,
    observer: &mut dyn Observer,
    read: impl FnOnce(&str, &GivenDomain) -> Result<Set, E>,
) -> Result<Set, E> {
    match source {
        PieceSource::File {
            path,
            radius,
            size,
            boundary,
        } => {
            let given = GivenDomain {
                radius: *radius,
                size: *size,
                boundary: *boundary,
            };
            read(path, &given)
        }

        // A set that this program makes needs no check, unlike one from a file. `own` is the domain of the piece's
        // rectangle.
        PieceSource::Reference { seed, own } => Ok(Set::of_reference(*own, *seed, observer)?),
        PieceSource::Run { parameters, .. } => {
            let pattern = Pattern::of_spec(&parameters.pattern, observer)?;
            Ok(Set::of_run(parameters, &pattern, observer)?)
        }
    }
}

/// Returns a layout as certificates state it: each piece from a file with what `named` says of that, which may replace the
/// path.
///
/// # Errors
///
/// Those of `named`.
pub fn stated_layout<E>(
    layout: &Layout,
    placed: &PlacedLayout,
    named: impl Fn(&str) -> Result<Stated, E>,
) -> Result<Value, E> {
    let mut stated = json!(layout);
    let pieces = stated["pieces"].as_array_mut().into_iter().flatten();
    for (piece, place) in pieces.zip(&placed.pieces) {
        if let (PieceSource::File { path, .. }, Value::Object(piece)) = (&place.source, piece) {
            piece.extend(named(path)?);
        }
    }
    Ok(stated)
}
