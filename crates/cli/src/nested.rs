//! Nested levels for `tilescope sample`.

use anyhow::{Result, ensure};
use tilescope_core::memory::Making;
use tilescope_core::{NestedRequest, radius_estimate};

use crate::make::{Worked, ask_for_whole};
use crate::output::Work;
use crate::progress::Stopwatch;
use crate::sample_arguments::{SampleArguments, SamplingMethod};

/// Makes a set of nested levels.
pub fn make(arguments: &SampleArguments, levels: u32) -> Result<Worked> {
    ensure!(
        arguments.method == SamplingMethod::Kdrt,
        "--levels needs randomized tiling: the reference sampler makes one set"
    );
    ensure!(
        !arguments.engine.wants_gpu(),
        "--engine gpu and --gpu-adapter make one set; --levels runs on the CPU"
    );
    let nested = NestedRequest {
        levels,
        order_within: arguments.nested.order_within,
        exactly: arguments.nested.exactly,
    };
    let recipe = arguments.run.recipe()?;

    // Levels that cannot be are refused before memory is asked for: another number of samples would not help.
    nested.check(&recipe.parameters)?;
    let mut expected = recipe.parameters;
    if let Some(count) = nested.exactly {
        expected.radius = radius_estimate(&expected, count as u64)?;
    }
    ask_for_whole(Making::Levels, &expected)?;

    let mut watch = Stopwatch::start();
    let made = recipe.levels(&nested, &mut watch)?;
    let work = Work::on_cpu(&mut watch);
    Ok(Worked { made, work })
}
