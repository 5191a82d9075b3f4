//! Writes the ready-made patterns and the list of their digests: `cargo run --release -p
//! tilescope-tests --example patterns`. Equal programs write equal bytes.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use tilescope_core::{Pattern, READY_MADE, Unobserved};
use tilescope_formats::{bytes_digest, write_whole};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/patterns");
    let mut digests = String::new();
    let mut total = 0;
    for ready in READY_MADE {
        let packed = Pattern::generate(&ready.spec, &mut Unobserved)?.to_packed();
        write_whole(&folder.join(ready.name), &packed)?;
        writeln!(digests, "{}  {}", bytes_digest(&packed), ready.name)?;
        println!("{:>7} bytes  {}", packed.len(), ready.name);
        total += packed.len();
    }
    write_whole(&folder.join("DIGESTS"), digests.as_bytes())?;
    println!("{total:>7} bytes in all");
    Ok(())
}
