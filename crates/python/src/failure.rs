//! Why a call failed, as the Python exception that says so. Made without Python's lock, raised with it.

use std::io::ErrorKind;

use pyo3::PyErr;
use pyo3::exceptions::{PyMemoryError, PyOSError, PyRuntimeError, PyValueError};
use tilescope_analysis::measures::MeasureError;
use tilescope_analysis::{SolidError, VerifyError, shown};
use tilescope_core::combine::CombineError;
use tilescope_core::combine::file::{LayoutError, PieceError};
use tilescope_core::memory::NoMemory;
use tilescope_core::{ParameterError, PatternError, SampleError};
use tilescope_figures::FigureError;
use tilescope_formats::{CheckError, ExportError, FormatError};
use tilescope_live::{CourseError, CurveError};
use tilescope_sets::{ReferencePatternError, VaryingError};

/// An exception to raise.
#[derive(Debug)]
pub enum Failure {
    /// `ValueError`: the arguments, or a file, are wrong. The text names the value and the limit.
    Value(String),
    /// `ValueError`: a certificate states a field or a shape that is not known here.
    NoField(String),
    /// `OSError`, or the subclass that Python has for its number.
    System {
        number: i32,
        text: String,
        path: String,
    },
    /// `MemoryError`: the system does not give the memory that the work takes.
    Memory(String),
    /// `RuntimeError`: the work could not be done, or was stopped.
    Runtime(String),
}

impl Failure {
    /// Returns the failure with the part of the input that it is about. A missing field counts as a wrong value then.
    /// Errors of the system name a path already, and a lack of memory is about no part: both stay as they are.
    pub fn of(self, part: &str) -> Self {
        match self {
            Self::Value(text) | Self::NoField(text) => Self::Value(format!("{part}: {text}")),
            Self::Runtime(text) => Self::Runtime(format!("{part}: {text}")),
            other @ (Self::System { .. } | Self::Memory(_)) => other,
        }
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Value(text) | Failure::NoField(text) => {
                PyValueError::new_err(shortened(&text))
            }
            Failure::System { number, text, path } => PyOSError::new_err((number, text, path)),
            Failure::Memory(text) => PyMemoryError::new_err(shortened(&text)),
            Failure::Runtime(text) => PyRuntimeError::new_err(shortened(&text)),
        }
    }
}

/// The longest text of an exception, in characters: the values of callers and files in it may be of any length.
const LONGEST: usize = 1000;

/// Returns a text as a terminal can show it, with its middle left out if it is too long: names and contents of files may
/// hold what a terminal obeys.
fn shortened(text: &str) -> String {
    let text = shown(text);
    let length = text.chars().count();
    if length <= LONGEST {
        return text.into_owned();
    }
    // The beginning names the argument or the file, and the end the limit or the remedy.
    let (start, end) = (LONGEST * 3 / 5, LONGEST * 2 / 5);
    let first: String = text.chars().take(start).collect();
    let last: String = text.chars().skip(length - end).collect();
    format!("{first}...{last}")
}

impl From<NoMemory> for Failure {
    fn from(missing: NoMemory) -> Self {
        Self::Memory(missing.to_string())
    }
}

impl From<ParameterError> for Failure {
    fn from(error: ParameterError) -> Self {
        Self::Value(error.to_string())
    }
}

impl From<PatternError> for Failure {
    fn from(error: PatternError) -> Self {
        Self::Value(error.to_string())
    }
}

impl From<SampleError> for Failure {
    fn from(error: SampleError) -> Self {
        match error {
            SampleError::Parameters(error) => error.into(),
            SampleError::Pattern(error) => error.into(),
            SampleError::Memory(missing) => missing.into(),
            other => Self::Runtime(other.to_string()),
        }
    }
}

impl From<ReferencePatternError> for Failure {
    fn from(error: ReferencePatternError) -> Self {
        match error {
            ReferencePatternError::Sample(error) => error.into(),
            other => Self::Value(format!("pattern: {other}")),
        }
    }
}

impl From<CombineError> for Failure {
    fn from(error: CombineError) -> Self {
        match error {
            CombineError::Sample(error) => error.into(),
            other => Self::Value(other.to_string()),
        }
    }
}

impl From<LayoutError> for Failure {
    fn from(error: LayoutError) -> Self {
        Self::Value(error.to_string())
    }
}

impl From<PieceError<Failure>> for Failure {
    fn from(PieceError { piece, error }: PieceError<Failure>) -> Self {
        error.of(&format!("pieces[{piece}]"))
    }
}

impl From<VerifyError> for Failure {
    fn from(error: VerifyError) -> Self {
        match error {
            // No argument is at fault for these: the judges differ or fail, or the caller stopped the work.
            VerifyError::Disagreement { .. }
            | VerifyError::Triangulation { .. }
            | VerifyError::Cancelled => Self::Runtime(error.to_string()),
            _ => Self::Value(error.to_string()),
        }
    }
}

impl From<SolidError> for Failure {
    fn from(error: SolidError) -> Self {
        match error {
            SolidError::NoMemory { .. } => Self::Memory(error.to_string()),
            // No argument is at fault for these either.
            SolidError::Disagreement { .. }
            | SolidError::Farther { .. }
            | SolidError::Cancelled => Self::Runtime(error.to_string()),
            _ => Self::Value(error.to_string()),
        }
    }
}

impl From<MeasureError> for Failure {
    fn from(error: MeasureError) -> Self {
        match error {
            MeasureError::Set(error) => error.into(),
            MeasureError::Cancelled => Self::Runtime(error.to_string()),
            _ => Self::Value(error.to_string()),
        }
    }
}

impl From<CourseError> for Failure {
    fn from(error: CourseError) -> Self {
        match error {
            CourseError::Sample(error) => error.into(),
            CourseError::TooMany { .. } | CourseError::Steep => Self::Value(error.to_string()),
            CourseError::Ground(error) => error.into(),
        }
    }
}

impl From<CurveError> for Failure {
    fn from(error: CurveError) -> Self {
        match error {
            CurveError::Measure(error) => error.into(),
            CurveError::TooMany { .. }
            | CurveError::NotHere { .. }
            | CurveError::TooFewMoments { .. } => Self::Value(error.to_string()),
        }
    }
}

impl From<FormatError> for Failure {
    fn from(error: FormatError) -> Self {
        match error {
            error @ FormatError::NoMemory { .. } => Self::Memory(error.to_string()),
            FormatError::Io { path, source } => match source.raw_os_error() {
                Some(number) => Self::System {
                    number,
                    // Python shows the number itself.
                    text: without_number(&source.to_string()).to_owned(),
                    path,
                },
                // A failed allocation in Rust has no number of the system.
                None if source.kind() == ErrorKind::OutOfMemory => {
                    Self::Memory(format!("{path}: {source}"))
                }
                // A path that no file can have.
                None if source.kind() == ErrorKind::InvalidInput => {
                    Self::Value(format!("{path}: {source}"))
                }
                None => Self::Runtime(format!("{path}: {source}")),
            },
            other => Self::Value(other.to_string()),
        }
    }
}

/// Returns the text of an error of the system without the number that Rust adds to it: " (os error 2)".
fn without_number(text: &str) -> &str {
    text.split(" (os error").next().unwrap_or(text)
}

impl From<CheckError> for Failure {
    fn from(error: CheckError) -> Self {
        match error {
            CheckError::Format(error) => error.into(),
            CheckError::Verify(error) => error.into(),
            CheckError::Solid(error) => error.into(),
            error @ CheckError::NoField => Self::NoField(error.to_string()),
            other => Self::Value(other.to_string()),
        }
    }
}

impl From<ExportError> for Failure {
    fn from(error: ExportError) -> Self {
        match error {
            ExportError::Format(error) => error.into(),
            ExportError::Verify { source, .. } => source.into(),
            ExportError::Solid { source, .. } => source.into(),
            ExportError::ShuffledLevels { .. } => Self::Value(error.to_string()),
            other => Self::Runtime(other.to_string()),
        }
    }
}

impl From<VaryingError> for Failure {
    fn from(error: VaryingError) -> Self {
        let needed = |what: &str, argument: String| {
            Self::Value(format!(
                "the certificate states {what}, which must be given to judge the set: {argument}"
            ))
        };
        match error {
            VaryingError::Domain(error) => error.into(),
            VaryingError::Judge(error) => error.into(),
            VaryingError::Sample(error) => error.into(),

            // Options of the command line have other names here.
            VaryingError::Needed { what, file, option } => {
                // The crate of sets writes FILE where a certificate states no name: the pixels came from an array.
                let (from, value) = match &*file {
                    "FILE" => ("an array".to_owned(), "the same array".to_owned()),
                    _ => (shortened(&file), format!("pathlib.Path({file:?})")),
                };
                let name = match option {
                    "--radius-image" => "radius",
                    "--density-image" => "density",
                    // The option is --mask.
                    _ => "mask",
                };
                let argument = match name {
                    // Stipples are made from an image as well.
                    "density" => format!("density={value}, or image={value} of a stipple"),
                    _ => format!("{name}={value}"),
                };
                needed(&format!("{what} from {from}"), argument)
            }
            VaryingError::NeedsGrid { name } => {
                let what = "a field from an array or a function";
                let argument = match name {
                    "density-grid" => "density=the same array",
                    _ => "radius=the same array or function",
                };
                needed(what, argument.to_owned())
            }
            error @ VaryingError::Degrees { .. } => {
                Self::Value(format!("{error}; planar=True takes them as they are"))
            }
            other => Self::Value(other.to_string()),
        }
    }
}

impl From<FigureError> for Failure {
    fn from(error: FigureError) -> Self {
        Self::Value(error.to_string())
    }
}
