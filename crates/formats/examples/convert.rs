//! Converts a point set to the format of another file's name: `cargo run -p tilescope-formats --example convert -- set.csv set.npy`.

use std::error::Error;
use std::path::Path;

use tilescope_formats::{Format, Hint, Target, encode, read, write_whole};

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [from, to] = words.as_slice() else {
        return Err("give two files".into());
    };
    let to = Path::new(to);
    let format = Format::from_path(to).ok_or("the second name has no known ending")?;

    let found = read(Path::new(from), &Hint::from_name(from))?;
    // Formats of the unit torus divide positions by the width, which a file alone does not always say.
    if format.is_unit_torus() {
        return Err(
            "psa and UTK have positions of the unit square: `tilescope convert` asks for the width"
                .into(),
        );
    }
    write_whole(to, &encode(&found.set, &Target::new(format))?)?;
    println!("{} points as {}", found.set.points.len(), format.name());
    Ok(())
}
