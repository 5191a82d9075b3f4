//! `tilescope gpu`: which GPU adapters there are, what they allow, and whether they compute what the CPU
//! does.

use std::fmt::Write;
use std::sync::Arc;

use anyhow::{Result, ensure};
use clap::Args;
use pollster::block_on;
use serde_json::{Value, json};
use tilescope_gpu::{AdapterReport, Choice, Gpu, Limits, adapters, self_test};

use crate::engine::AdapterArguments;
use crate::{interrupt, output, verdict_code};

/// Arguments of `tilescope gpu`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct GpuArguments {
    /// Only the adapters whose name has this part
    #[arg(long, value_name = "NAME")]
    gpu_adapter: Option<String>,
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

/// What the test of an adapter ended with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    Passed,
    Failed,
    /// It allows too little, or it cannot be told from another one.
    Untested,
}

/// An adapter and its test.
struct Tested {
    report: AdapterReport,
    verdict: Verdict,
    /// Samples compared.
    samples: usize,
    said: String,
}

pub fn run(arguments: &GpuArguments) -> Result<u8> {
    interrupt::listen();
    let wanted = AdapterArguments {
        gpu_adapter: arguments.gpu_adapter.clone(),
    };
    let part = arguments.gpu_adapter.as_deref().unwrap_or("");
    let part = part.to_lowercase();
    let mut reports = block_on(adapters());
    reports.retain(|report| report.name.to_lowercase().contains(&part));
    if reports.is_empty() {
        // Why there is none is said by whoever opens it.
        wanted.open()?;
    }
    let reports = reports.into_iter().take_while(|_| !interrupt::requested());
    let tested: Vec<Tested> = reports.map(Tested::of).collect();
    ensure!(!interrupt::requested(), "cancelled before the last test");
    output::emit(&if arguments.json {
        let adapters: Vec<Value> = tested.iter().map(Tested::json).collect();
        format!("{}\n", json!({ "adapters": adapters }))
    } else {
        let texts: Vec<String> = tested.iter().map(Tested::text).collect();
        texts.join("\n")
    })?;
    let is = |verdict| move |one: &Tested| one.verdict == verdict;
    let fine = tested.iter().any(is(Verdict::Passed)) && !tested.iter().any(is(Verdict::Failed));
    Ok(verdict_code(fine))
}

impl Tested {
    /// Tests an adapter.
    fn of(report: AdapterReport) -> Self {
        let choice = Choice {
            name: Some(report.name.clone()),
            ..Choice::default()
        };
        let (verdict, samples, said) = match block_on(Gpu::open(&choice)) {
            Err(error) => (Verdict::Untested, 0, error.to_string()),
            // Adapters are opened by name, and the first one of a name is opened.
            Ok(gpu) if *gpu.report() != report => {
                let said = "an adapter before it has the same name".to_owned();
                (Verdict::Untested, 0, said)
            }
            Ok(gpu) => match block_on(self_test(&Arc::new(gpu))) {
                Ok(test) if test.passed => (Verdict::Passed, test.samples, test.verdict),
                Ok(test) => (Verdict::Failed, test.samples, test.verdict),
                Err(error) => (Verdict::Failed, 0, error.to_string()),
            },
        };
        Self {
            report,
            verdict,
            samples,
            said,
        }
    }

    fn text(&self) -> String {
        let report = &self.report;
        let mut out = format!("{}\n", report.name);
        for (name, text) in [
            ("backend", report.backend.clone()),
            ("kind", report.kind.to_owned()),
            ("driver", report.driver.clone()),
            (
                "timestamps",
                if report.has_timestamps { "yes" } else { "no" }.to_owned(),
            ),
            ("limits", limits_text(&report.limits)),
            (
                "self-test",
                format!("{}: {}", self.verdict.text(), self.said),
            ),
        ] {
            let _ = writeln!(out, "  {name:<12} {text}");
        }
        out
    }

    fn json(&self) -> Value {
        let report = &self.report;
        let limits = &report.limits;
        json!({
            "name": report.name,
            "backend": report.backend,
            "kind": report.kind,
            "software": report.is_software,
            "driver": report.driver,
            "timestamps": report.has_timestamps,
            "limits": {
                "max_buffer_size": limits.max_buffer_size,
                "max_storage_buffer_binding_size": limits.max_storage_buffer_binding_size,
                "max_compute_workgroups_per_dimension": limits.max_compute_workgroups_per_dimension,
                "max_storage_buffers_per_shader_stage": limits.max_storage_buffers_per_shader_stage,
            },
            "self_test": {
                "verdict": self.verdict.text(),
                "passed": self.verdict == Verdict::Passed,
                "samples": self.samples,
                "said": self.said,
            },
        })
    }
}

impl Verdict {
    const fn text(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Failed => "FAILED",
            Self::Untested => "not run",
        }
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
