//! Writes the two grey pictures that the program computes into a folder:
//!
//!     cargo run --release -p tilescope-sets --example pictures -- assets/pictures
//!
//! writes `still-life.png` and `landscape.png`. They have the same bytes on every machine, and a test holds the files that lie
//! there against the formulas.

use std::error::Error;
use std::path::PathBuf;

use tilescope_formats::write_whole;
use tilescope_sets::ComputedPicture;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".to_owned()));
    for picture in ComputedPicture::ALL {
        write_whole(&folder.join(picture.name()), &picture.image()?.to_png()?)?;
    }
    Ok(())
}
