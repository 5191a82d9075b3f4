//! Point-set files of the field, certificates and validated export.
//!
//! Everything that turns positions into bytes and back: twelve file formats, detection of a file's format, the
//! certificate beside a file, and the re-verification of both. Invariants: this crate does not depend on
//! `tilescope-core`, so that a set is judged by its positions alone, no bytes make it panic, and roundings are reported: a
//! certificate states what the *written* file holds.
//!
//! ```
//! use tilescope_formats::{Format, Hint, PointSet, Target, decode, encode};
//!
//! let set = PointSet::from_points(vec![[0.25, 0.5], [0.75, 0.125]]);
//! let bytes = encode(&set, &Target::new(Format::Csv)).unwrap();
//! assert_eq!(bytes, b"x,y\n0.25,0.5\n0.75,0.125\n");
//! assert_eq!(decode(&bytes, &Hint::default()).unwrap().set, set);
//! ```

mod binary;
mod certificate;
mod check;
mod codecs;
mod column_names;
#[cfg(not(target_arch = "wasm32"))]
mod destination;
mod detect;
mod digest;
mod error;
mod export;
mod fields;
#[cfg(not(target_arch = "wasm32"))]
mod files;
mod format;
mod indented;
mod mapping;
#[cfg(not(target_arch = "wasm32"))]
mod pipe;
mod point_set;
mod read;
#[cfg_attr(
    target_arch = "wasm32",
    allow(dead_code, reason = "a page reads and writes planar sets alone")
)]
mod solid;
#[cfg(not(target_arch = "wasm32"))]
mod stream;
mod text;
mod thinned;
mod varying;

pub use certificate::{
    CERTIFICATE_FORMAT_VERSION, CERTIFICATE_SUFFIX, Certificate, CertifiedLevel, CertifiedPrefix,
    CertifiedRadius, CertifiedShape, Depth, MAX_CERTIFICATE_BYTES, RadiusColumn, RadiusField,
    RadiusRule, Rounding, Thinned,
};
pub use check::{
    CertificateDifference, Check, CheckError, MEASURE_TOLERANCE, Overrides, check_bytes, is_valid,
};
pub use codecs::{
    CertificateUse, ColumnUse, Dots, Drawing, Hint, KeptRows, ReadSet, Target, decode, encode,
    keep_rows, may_be_degrees, read_column, read_ranks, refuse_degrees,
};
#[cfg(not(target_arch = "wasm32"))]
pub use destination::{certificate_beside, destination};
pub use detect::{Detection, Evidence, detect};
pub use digest::{PassingDigest, bytes_digest, positions_digest, solid_digest};
pub use error::{FilePlace, FormatError};
pub use export::{ExportContext, ExportError, ExportedBytes, Warning, export_bytes};
#[cfg(not(target_arch = "wasm32"))]
pub use files::{
    Exported, MAX_IN_MEMORY, check, export, export_unverified, read, read_whole, write_certified,
    write_through, write_whole,
};
pub use format::{Format, Precision, UnknownFormatName};
pub use mapping::Mapping;
pub use point_set::{PointSet, Provenance};
pub use read::{certificate_path, read_bytes};
pub use solid::{
    SolidCheck, SolidColumns, SolidContext, SolidExported, SolidExportedBytes, SolidRaw, SolidSet,
    ThinnedSolidFacts, check_solid_bytes, check_solid_format, decode_solid, export_solid_bytes,
    in_space,
};
#[cfg(not(target_arch = "wasm32"))]
pub use solid::{
    check_solid, export_solid, export_solid_unverified, read_solid, solid_certificate,
};
#[cfg(not(target_arch = "wasm32"))]
pub use stream::{
    StreamExport, StreamOptions, StreamReader, Streamed, WHOLE_FILE_BYTES, check_stream,
    checkpoint_token, finish_interrupted, first_points, partial_path, resume_path,
};
pub use thinned::{ThinnedFacts, implied_kept};
pub use varying::VaryingDomain;
