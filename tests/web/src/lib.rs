//! The GPU engine's self-test and one more run behind a single export: the page beside this file calls
//! [`check`] in a browser and sends the line that it returns to the test in `tests/tests/web.rs`.

use std::sync::Arc;

use tilescope_core::{Parameters, Pattern, Point, Sequential, Unobserved};
use tilescope_gpu::{AdapterReport, Choice, Gpu, GpuError, GpuSweep, Options, self_test};
use wasm_bindgen::prelude::wasm_bindgen;

/// Too little memory for the whole domain in one window, so that windows are joined.
const MEMORY: u64 = 2 << 20;

#[wasm_bindgen]
extern "C" {
    /// The page's function that takes the line when the promise of [`check`] cannot.
    fn report(line: String);
}

/// Has a panic reported: in a browser it would only leave a promise that is never kept.
#[wasm_bindgen(start)]
pub fn start() {
    std::panic::set_hook(Box::new(|panic| report(format!("ERROR {panic}"))));
}

/// Returns one line that begins with PASSED when the device gives the CPU's points, with FAILED when it gives
/// others, and with ERROR when it gives none. To see that a difference would be found, `spoil` has one of
/// the device's points moved by one unit.
#[wasm_bindgen]
pub async fn check(spoil: bool) -> String {
    match verdict(spoil).await {
        Ok(line) => line,
        Err(error) => format!("ERROR {error}"),
    }
}

async fn verdict(spoil: bool) -> Result<String, GpuError> {
    let choice = Choice {
        software: true,
        ..Choice::default()
    };
    let gpu = Arc::new(Gpu::open(&choice).await?);
    let parameters = Parameters {
        radius: 0.007,
        leaf: 12.0,
        seed: 77,
        dihedral: true,
        ..Parameters::default()
    };
    let (bands, mut device, cpu) = both(&gpu, &parameters).await?;
    let middle = device.len() / 2;
    if let Some(point) = device.get_mut(middle).filter(|_| spoil) {
        point.x += 1;
    }
    let tested = self_test(&gpu).await?;
    let differ = device.len().max(cpu.len()) - equal(&device, &cpu);
    let equal = tested.passed && differ == 0 && !cpu.is_empty();
    let word = if equal { "PASSED" } else { "FAILED" };
    let count = cpu.len();
    let (verdict, adapter) = (tested.verdict, described(gpu.report()));
    Ok(format!(
        "{word} {verdict}; {differ} of {count} samples of another run in {bands} bands differ; {adapter}"
    ))
}

/// Returns in how many bands of windows the device computes a run, the points that it gives, and those of the
/// sequential engine.
async fn both(
    gpu: &Arc<Gpu>,
    parameters: &Parameters,
) -> Result<(u32, Vec<Point>, Vec<Point>), GpuError> {
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved)?;
    let options = Options {
        memory: Some(MEMORY),
        ..Options::default()
    };
    let mut sweep = GpuSweep::new(Arc::clone(gpu), parameters, &pattern, options).await?;
    let (mut bands, mut points) = (0, Vec::new());
    while let Some(mut band) = sweep.step(&mut Unobserved).await? {
        points.append(&mut band.points);
        bands += 1;
    }
    let cpu = Sequential::new(parameters, pattern)?.finish(&mut Unobserved)?;
    Ok((bands, points, cpu.points()))
}

/// Returns at how many places both have the same point.
fn equal(a: &[Point], b: &[Point]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a == b).count()
}

fn described(report: &AdapterReport) -> String {
    let AdapterReport {
        name,
        backend,
        kind,
        driver,
        has_timestamps,
        limits,
        ..
    } = report;
    format!(
        "adapter {name:?}, {backend}, {kind}, driver {driver:?}, timestamps {has_timestamps}, {limits:?}"
    )
}
