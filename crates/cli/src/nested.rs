//! Nested levels for `tilescope sample`.

use anyhow::{Result, ensure};
use serde_json::{Value, json};
use tilescope_analysis::PrefixClaim;
use tilescope_core::memory::Making;
use tilescope_core::{NestedRequest, Parameters, radius_estimate};
use tilescope_formats::{ExportContext, PointSet};

use crate::facts::Facts;
use crate::make::{Made, ask_for_whole};
use crate::progress::Stopwatch;
use crate::sample_arguments::{SampleArguments, SamplingMethod};

/// Makes a set of nested levels, and what its file is to state.
pub fn make(arguments: &SampleArguments, levels: u32) -> Result<(Made, ExportContext)> {
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
    let asked = arguments.run.parameters()?;

    // Levels that cannot be are refused before memory is asked for: another number of samples would not help.
    nested.check(&asked)?;
    let mut expected = asked;
    if let Some(count) = nested.exactly {
        expected.radius = radius_estimate(&asked, count as u64)?;
    }
    ask_for_whole(Making::Levels, &expected)?;

    let mut watch = Stopwatch::start();
    let made = match arguments.run.count {
        Some(count) => nested.of_count(&asked, count, &mut watch)?,
        None => nested.make(&asked, &mut watch)?,
    };

    let domain = *made.domain();
    let parameters = Parameters {
        radius: domain.radius(),
        ..asked
    };
    let mut facts = Facts {
        seconds: watch.take(),
        ..Facts::of_run(&parameters, &domain)?
    };
    if let Value::Object(stated) = json!(nested) {
        facts.parameters.extend(stated);
    }
    let context = ExportContext {
        levels: made.claims().map(PrefixClaim::from).collect(),
        ..arguments.context(&facts)
    };
    let set = PointSet::from_points(made.positions());
    Ok((Made { facts, set }, context))
}
