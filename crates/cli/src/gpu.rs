//! `tilescope gpu`: lists the GPU adapters with their limits, and tests whether they compute the same as the CPU.

mod drivers;

use std::sync::Arc;

use anyhow::{Result, anyhow};
use clap::Args;
use pollster::block_on;
use serde_json::{Value, json};
use tilescope_gpu::{AdapterReport, Choice, Gpu, GpuError, Limits, adapters, self_test};

use crate::{interrupt, output, verdict_code};
use drivers::Drivers;

/// Arguments of `tilescope gpu`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct GpuArguments {
    /// Only the adapters whose name contains this
    #[arg(long, value_name = "NAME")]
    gpu_adapter: Option<String>,
    /// Test the shaders compiled with checks of indices and loops
    #[arg(long)]
    checked_shaders: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Each adapter is tested: it makes small sets of every kind, which are compared with the CPU's point by
point. Exit code 1 if a test fails or no adapter can be used, 2 if there is no adapter.

Examples:
  tilescope gpu
  tilescope gpu --gpu-adapter llvmpipe --json";

/// An adapter and its test.
struct TestedAdapter {
    report: AdapterReport,
    /// [`PASSED`], [`FAILED`], or [`NOT_RUN`] if the adapter's limits are too low or an earlier one has the same name.
    verdict: &'static str,
    /// The samples that were compared with the CPU's.
    samples: usize,
    /// The comparison made, or why the test failed or was not run.
    detail: String,
}

/// Lists the GPUs of this machine, and tests whether each computes the right points.
pub fn run(arguments: &GpuArguments) -> Result<u8> {
    interrupt::listen();
    // Every name contains the empty one: without the option all adapters stay.
    let part = (arguments.gpu_adapter.as_deref())
        .unwrap_or("")
        .to_lowercase();

    let mut reports = block_on(adapters());
    reports.retain(|report| report.name.to_lowercase().contains(&part));

    // If no GPU computes, the installed parts of its driver show why.
    let is_lacking = reports.iter().all(|report| report.is_software);
    let drivers = is_lacking.then(Drivers::find).flatten();

    let open = |name| {
        block_on(Gpu::open(&Choice {
            name,
            checked_shaders: arguments.checked_shaders,
            ..Choice::default()
        }))
    };

    if reports.is_empty() {
        // The error says that there is no such adapter.
        let opened = open(arguments.gpu_adapter.clone());
        opened.map_err(|error| match &drivers {
            // A build without the GPU's engine would not use a driver either, so that advice on it would mislead.
            Some(drivers) if error != GpuError::NotBuilt => {
                anyhow!("{error}. {}", drivers.text().replace('\n', " "))
            }
            _ => error.into(),
        })?;
    }

    let found = reports.len();
    // After a request to end no further adapter is tested; the check below then ends the command.
    let reports = reports.into_iter().take_while(|_| !interrupt::requested());
    let test = |report: AdapterReport| TestedAdapter::of(open(Some(report.name.clone())), report);
    let tested: Vec<TestedAdapter> = reports.map(test).collect();
    // A request that came during the last test is too late: all results are there.
    if tested.len() < found {
        interrupt::check("the last test")?;
    }

    let objects = || tested.iter().map(TestedAdapter::json).collect::<Vec<_>>();
    let json = || json!({ "adapters": objects(), "drivers": drivers });
    let mut texts: Vec<String> = tested.iter().map(TestedAdapter::text).collect();
    if let Some(drivers) = &drivers {
        texts.push(format!("No GPU was found.\n{}\n", drivers.text()));
    }

    output::report(arguments.json, json, || texts.join("\n"))?;
    // A single wrong adapter is a fault, although others may be right: users can choose any.
    let has = |verdict: &str| tested.iter().any(|one| one.verdict == verdict);
    Ok(verdict_code(has(PASSED) && !has(FAILED)))
}

const PASSED: &str = "passed";
const FAILED: &str = "FAILED";
const NOT_RUN: &str = "not run";

impl TestedAdapter {
    /// Tests an adapter that was opened by its name.
    fn of(opened: Result<Gpu, GpuError>, report: AdapterReport) -> Self {
        let (verdict, samples, detail) = match opened {
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
        Self {
            report,
            verdict,
            samples,
            detail,
        }
    }

    fn json(&self) -> Value {
        let mut object = json!(self.report);
        object["self_test"] = json!({
            "verdict": self.verdict,
            "passed": self.verdict == PASSED,
            "samples": self.samples,
            "said": self.detail,
        });
        object
    }

    /// Returns the adapter with its verdict, in lines.
    fn text(&self) -> String {
        let (verdict, detail) = (self.verdict, &self.detail);
        let report = &self.report;
        let AdapterReport {
            name,
            backend,
            kind,
            driver,
            ..
        } = report;
        let timestamps = if report.has_timestamps { "yes" } else { "no" };
        let limits = limits_text(&report.limits);
        format!(
            "{name}\n  backend      {backend}\n  kind         {kind}\n  driver       {driver}\n  \
             timestamps   {timestamps}\n  limits       {limits}\n  self-test    {verdict}: {detail}\n"
        )
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
    // Each unit is 2^10 of the one before; u64 ends within the last.
    let power = bytes.max(1).ilog2() / 10;
    let unit = ["bytes", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"][power as usize];
    let text = format!("{:.1}", bytes as f64 / 1024_f64.powi(power as i32));
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
