//! Nested levels for `tilescope sample`, and prefixes for `tilescope verify`.

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};
use tilescope_analysis::{PrefixClaim, verify_prefix};
use tilescope_core::{NestedRequest, Parameters};
use tilescope_formats::{CertifiedLevel, ExportContext, PointSet};

use crate::facts::Facts;
use crate::make::Made;
use crate::options::{JudgeArguments, SetArguments};
use crate::output;
use crate::progress::{Stopwatch, verifying};
use crate::sample_arguments::{SampleArguments, SamplingMethod};
use crate::verdict_code;

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
    let mut watch = Stopwatch::start();
    let made = nested.make(&asked, &mut watch)?;
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

/// Judges the first `count` samples of a file, by the levels that its certificate states, and prints the verdict.
pub fn verify(
    file: &Path,
    count: usize,
    set: &SetArguments,
    judge: &JudgeArguments,
    as_json: bool,
) -> Result<u8> {
    let read = set.read(file)?;
    let name = file.display();
    let Some(certificate) = read.certificate else {
        bail!("{name}: there is no certificate, which states the levels of a set");
    };
    let Some(claim) = certificate.prefix(count) else {
        bail!("{name}: the certificate states no levels, or fewer than {count} samples");
    };
    let region = set.region_over(certificate.region);
    let options = judge.options();
    let found =
        verifying(|control| verify_prefix(&read.set.points, region, claim, &options, control));
    let found = found.with_context(|| name.to_string())?;
    let level = CertifiedLevel::of(&found);
    output::report(as_json, || json!(level), || output::level_row(&level))?;
    Ok(verdict_code(level.valid))
}
