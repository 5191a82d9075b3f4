//! `tilescope gpu`: which GPU adapters there are, what they allow, and whether they compute the same as the CPU.

mod drivers;

use std::sync::Arc;

use anyhow::{Result, anyhow};
use clap::Args;
use pollster::block_on;
use serde::Serialize;
use serde_json::{Value, json};
use tilescope_gpu::{AdapterReport, Choice, Gpu, Limits, adapters, self_test};

use crate::engine::AdapterArguments;
use crate::{interrupt, output, verdict_code};
use drivers::Drivers;

/// Arguments of `tilescope gpu`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct GpuArguments {
    /// Only the adapters whose name has this part
    #[arg(long, value_name = "NAME")]
    gpu_adapter: Option<String>,
    /// Test the shaders with their checks of indices and loops
    #[arg(long)]
    checked_shaders: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Each adapter is tested: it makes small sets of every kind, which are compared with the CPU's point by
point. Exit code 1 if a test fails or no adapter serves, 2 if there is no adapter.

Examples:
  tilescope gpu
  tilescope gpu --gpu-adapter llvmpipe --json";

/// An adapter and its test.
struct Tested {
    report: AdapterReport,
    test: TestReport,
}

/// The result of the test of an adapter.
#[derive(Serialize)]
struct TestReport {
    /// `passed`, `FAILED`, or `not run` where the adapter allows too little or cannot be told from another one.
    verdict: &'static str,
    passed: bool,
    /// Samples compared.
    samples: usize,
    /// The comparison made, or why the test failed or was not run.
    #[serde(rename = "said")]
    detail: String,
}

pub fn run(arguments: &GpuArguments) -> Result<u8> {
    interrupt::listen();
    let part = arguments.gpu_adapter.as_deref().unwrap_or("");
    let part = part.to_lowercase();
    let mut reports = block_on(adapters());
    reports.retain(|report| report.name.to_lowercase().contains(&part));
    // Where no GPU computes, what of its driver is installed says why.
    let is_lacking = reports.iter().all(|report| report.is_software);
    let drivers = is_lacking.then(Drivers::find).flatten();
    if reports.is_empty() {
        let asked = AdapterArguments {
            gpu_adapter: arguments.gpu_adapter.clone(),
            checked_shaders: arguments.checked_shaders,
        };
        // The error says that there is no such adapter.
        asked.open().map(drop).map_err(|error| match &drivers {
            Some(drivers) => anyhow!("{error}\n{}", drivers.text()),
            None => error.into(),
        })?;
    }
    let reports = reports.into_iter().take_while(|_| !interrupt::requested());
    let test = |report| Tested::of(report, arguments.checked_shaders);
    let tested: Vec<Tested> = reports.map(test).collect();
    interrupt::check("the last test")?;
    let json = || {
        json!({
            "adapters": tested.iter().map(Tested::json).collect::<Vec<_>>(),
            "drivers": drivers.as_ref().map(Drivers::json),
        })
    };
    let mut texts: Vec<String> = tested.iter().map(Tested::text).collect();
    if let Some(drivers) = &drivers {
        texts.push(format!("No GPU was found.\n{}\n", drivers.text()));
    }
    output::report(arguments.json, json, || texts.join("\n"))?;
    let has = |verdict: &str| tested.iter().any(|one| one.test.verdict == verdict);
    Ok(verdict_code(has(PASSED) && !has(FAILED)))
}

const PASSED: &str = "passed";
const FAILED: &str = "FAILED";
const NOT_RUN: &str = "not run";

impl Tested {
    /// Tests an adapter.
    fn of(report: AdapterReport, checked_shaders: bool) -> Self {
        let choice = Choice {
            name: Some(report.name.clone()),
            checked_shaders,
            ..Choice::default()
        };
        let (verdict, samples, detail) = match block_on(Gpu::open(&choice)) {
            Err(error) => (NOT_RUN, 0, error.to_string()),
            // Adapters are opened by name, and the first one of a name is opened.
            Ok(gpu) if *gpu.report() != report => {
                let detail = "an adapter before it has the same name".to_owned();
                (NOT_RUN, 0, detail)
            }
            Ok(gpu) => match block_on(self_test(&Arc::new(gpu))) {
                Ok(test) if test.passed => (PASSED, test.samples, test.verdict),
                Ok(test) => (FAILED, test.samples, test.verdict),
                Err(error) => (FAILED, 0, error.to_string()),
            },
        };
        let test = TestReport {
            verdict,
            passed: verdict == PASSED,
            samples,
            detail,
        };
        Self { report, test }
    }

    fn text(&self) -> String {
        let (report, test) = (&self.report, &self.test);
        let timestamps = if report.has_timestamps { "yes" } else { "no" };
        format!(
            "{}\n  backend      {}\n  kind         {}\n  driver       {}\n  timestamps   {timestamps}\n  \
             limits       {}\n  self-test    {}: {}\n",
            report.name,
            report.backend,
            report.kind,
            report.driver,
            limits_text(&report.limits),
            test.verdict,
            test.detail,
        )
    }

    fn json(&self) -> Value {
        let report = &self.report;
        json!({
            "name": report.name,
            "backend": report.backend,
            "kind": report.kind,
            "software": report.is_software,
            "driver": report.driver,
            "timestamps": report.has_timestamps,
            "limits": report.limits,
            "self_test": self.test,
        })
    }
}

fn limits_text(limits: &Limits) -> String {
    format!(
        "buffers of {}, of which a pass sees {}; {} buffers a pass, {} workgroups a side",
        bytes_text(limits.max_buffer_size),
        bytes_text(limits.max_storage_buffer_binding_size),
        limits.max_storage_buffers_per_shader_stage,
        limits.max_compute_workgroups_per_dimension,
    )
}

/// Returns a number of bytes in the largest unit of which there is at least one.
fn bytes_text(bytes: u64) -> String {
    let mut value = bytes as f64;
    let mut units = ["bytes", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"].into_iter();
    let mut unit = units.next().unwrap_or_default();
    for next in units {
        if value < 1024.0 {
            break;
        }
        (value, unit) = (value / 1024.0, next);
    }
    let text = format!("{value:.1}");
    format!("{} {unit}", text.strip_suffix(".0").unwrap_or(&text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_told_in_units_that_can_be_read() {
        for (bytes, text) in [
            (0, "0 bytes"),
            (1023, "1023 bytes"),
            (128 << 20, "128 MiB"),
            ((4 << 30) - 4, "4 GiB"),
            (3 << 29, "1.5 GiB"),
            (u64::MAX, "16 EiB"),
        ] {
            assert_eq!(bytes_text(bytes), text);
        }
    }
}
