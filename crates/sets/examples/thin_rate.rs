//! The stages of thinning a cloud of random points, each with its time.
//!
//!     cargo run --release -p tilescope-sets --example thin_rate -- [POINTS] [RADIUS] [PRIORITY] [ROUNDS]
//!
//! POINTS (default 10 million) lie anywhere in a square with ten to a unit of area, RADIUS is 0.5 if not given, PRIORITY `order`
//! or `random 7`. The cloud is read from and written to a binary PLY in memory. Run it with `RAYON_NUM_THREADS=1` for processor
//! time; of ROUNDS (default 3) the shortest counts.

use std::error::Error;
use std::ops::ControlFlow;
use std::time::Instant;

use tilescope_analysis::Progress;
use tilescope_core::{Key, Stream};
use tilescope_formats::{Hint, KeptRows};
use tilescope_sets::RadiusSource;
use tilescope_sets::thinning::{PointFile, ThinRadius, ThinRecipe};

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Returns a binary PLY of so many points.
fn cloud(count: u32) -> Vec<u8> {
    let side = (f64::from(count) / 10.0).sqrt() / f64::from(u32::MAX);
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {count}\nproperty float x\nproperty float y\nend_header\n"
    )
    .into_bytes();
    let key = Key::from_seed(5);
    for index in 0..count {
        let draw = key.draw(Stream::Priority, index);
        for word in draw {
            bytes.extend(((f64::from(word) * side) as f32).to_le_bytes());
        }
    }
    bytes
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut next = |default: &str| arguments.next().unwrap_or_else(|| default.to_owned());
    let bytes = cloud(next("10000000").parse()?);
    let recipe = ThinRecipe {
        radius: ThinRadius::Source(RadiusSource::Constant(next("0.5").parse()?)),
        priority: next("order").parse()?,
        domain: None,
    };
    let rounds: usize = next("3").parse()?;

    let mut least = [f64::INFINITY; 4];
    for _ in 0..rounds {
        let mut stages = Vec::new();
        let mut lap = Instant::now();
        let mut end_of_stage = || {
            stages.push(lap.elapsed().as_secs_f64());
            lap = Instant::now();
        };

        let file = PointFile::new(&bytes, Hint::from_name("cloud.ply"))?;
        let with_ranks = true;
        let thinning = recipe.prepare(&file, with_ranks)?;
        end_of_stage();
        let kept = thinning.choose(file.points(), &go_on)?;
        end_of_stage();
        let report = thinning.judge(file.points(), &kept, &go_on)?;
        end_of_stage();
        let mut rows = KeptRows::default();
        let chosen = file.keep(&kept, &mut rows, "kept.ply")?;
        let certificate = thinning.certificate(file.points(), &chosen, &report)?;
        end_of_stage();

        println!("{} kept, valid: {}", certificate.count, certificate.valid);
        for (least, seconds) in least.iter_mut().zip(stages) {
            *least = least.min(seconds);
        }
    }
    let [read, thin, verify, write] = least;
    println!("read {read:.2} s, thin {thin:.2} s, verify {verify:.2} s, write {write:.2} s");
    Ok(())
}
