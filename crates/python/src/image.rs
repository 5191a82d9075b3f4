//! Images as Python passes them: pixels, or files.

use std::path::{Path, PathBuf};

use numpy::PyReadonlyArray3;
use pyo3::prelude::*;
use tilescope_analysis::lossy;
use tilescope_formats::read_whole;
use tilescope_sets::GrayImage;

use crate::failure::Failure;

/// An image as Python passes it: pixels of 16 bits, of shape (rows, columns, channels) from the highest row down, or a PNG or
/// JPEG file.
#[derive(FromPyObject)]
pub enum Picture<'py> {
    Array(PyReadonlyArray3<'py, u16>),
    File(PathBuf),
}

impl Picture<'_> {
    pub fn image(&self) -> Result<GrayImage, Failure> {
        match self {
            Self::Array(pixels) => {
                let [_, columns, channels] = pixels.as_array().dim().into();
                // Python passes contiguous arrays. Of any other array no pixels are read, and an image without any is
                // refused.
                let words = pixels.as_slice().unwrap_or_default();
                Ok(GrayImage::from_channels(columns, channels, words)?)
            }
            Self::File(path) => image(path),
        }
    }
}

/// Reads a PNG or JPEG file.
pub fn image(path: &Path) -> Result<GrayImage, Failure> {
    // Certificates name a file without its folders.
    let name = lossy(path.file_name().unwrap_or_default());
    Ok(GrayImage::read(&name, &read_whole(path)?)?)
}
