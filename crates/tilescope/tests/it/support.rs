//! Helpers of the end-to-end tests: the real binary in a folder of its own.

pub mod analysis;
pub mod runs;

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use png::{BitDepth, ColorType};
use tempfile::TempDir;

/// Returns the program, to run in `folder`.
pub fn tilescope(folder: &TempDir) -> Command {
    let mut command = Command::cargo_bin("tilescope").expect("the binary is built");
    command
        .current_dir(folder.path())
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY");
    command
}

/// Returns the names of a folder's files, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let name = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string();
    let mut names: Vec<String> = entries.map(|entry| name(entry).unwrap()).collect();
    names.sort();
    names
}

/// Writes an image of 8 bits.
pub fn image(folder: &TempDir, name: &str, size: [u32; 2], color: ColorType, data: &[u8]) {
    let file = fs::File::create(folder.path().join(name)).unwrap();
    let mut encoder = png::Encoder::new(file, size[0], size[1]);
    encoder.set_color(color);
    encoder.set_depth(BitDepth::Eight);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(data).unwrap();
}
