//! Nested levels for `tilescope sample`.

use anyhow::{Result, ensure};
use tilescope_core::memory::Making;
use tilescope_core::{NestedRequest, Parameters, radius_estimate};

use crate::make::{Worked, ask_for_whole};
use crate::output::Work;
use crate::progress::Stopwatch;
use crate::sample_arguments::{SampleArguments, SamplingMethod};

/// Why the other methods are refused.
pub const NEEDS_KDRT: &str =
    "--levels needs --method kdrt: exact tiling and the reference sampler make one set";

/// Makes a set of nested levels.
pub fn make(arguments: &SampleArguments, nested: NestedRequest) -> Result<Worked> {
    ensure!(arguments.method() == SamplingMethod::Kdrt, "{NEEDS_KDRT}");
    ensure!(
        !arguments.engine.wants_gpu(),
        "--engine gpu and --gpu-adapter make one set; --levels runs on the CPU"
    );
    let recipe = arguments.run.recipe()?;
    ask_for_levels(&nested, &recipe.parameters)?;

    let mut watch = Stopwatch::start();
    let made = recipe.levels(&nested, &mut watch)?;
    let work = Work::on_cpu(&mut watch);
    Ok(Worked { made, work })
}

/// Asks for the memory that nested levels take. Fails as [`ask_for_whole`], and if there cannot be such levels.
pub fn ask_for_levels(nested: &NestedRequest, parameters: &Parameters) -> Result<()> {
    // Levels that cannot be are refused before memory is asked for: another number of samples would not help.
    nested.check(parameters)?;
    let mut expected = *parameters;
    if let Some(count) = nested.exactly {
        expected.radius = radius_estimate(&expected, count as u64)?;
    }
    ask_for_whole(Making::Levels, &expected)
}
