//! Writes the manual pages of `tilescope` and of its commands into a folder: `cargo run -p tilescope-cli --example man -- FOLDER`.
//! `tests/package` puts them into releases.

use std::error::Error;
use std::path::Path;

use clap::CommandFactory;
use tilescope_cli::Arguments;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).ok_or("name a folder")?;
    std::fs::create_dir_all(&folder)?;
    clap_mangen::generate_to(Arguments::command(), Path::new(&folder))?;
    Ok(())
}
