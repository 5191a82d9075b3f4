//! The self-test: small runs on a device, compared with the CPU point by point.

use std::sync::Arc;

use tilescope_core::{
    Boundary, Insertion, Order, Parameters, Pattern, PatternHistory, PatternSpec, Run, Sampled,
    Sequential, Source, TilingMethod, Unobserved, exact_sample,
};

use crate::error::GpuError;
use crate::exact::exact_on_gpu;
use crate::opened::Gpu;
use crate::sweep::{GpuSweep, Options};

/// The result of the self-test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SelfTest {
    /// Whether all runs were equal to the CPU's.
    pub passed: bool,
    /// Samples compared, of all runs.
    pub samples: usize,
    /// A sentence with the extent of the comparison, or with the first difference.
    pub verdict: String,
}

/// The orders of the runs, chosen so that both insertions run with both boundaries.
const ORDERS: [Order; 4] = [
    Order::OwnBlockFirst,
    Order::Random,
    Order::Index,
    Order::PhaseGroup,
];

/// Runs the self-test: every order, both insertions, both boundaries, with and without symmetries of the pattern, and an exact
/// tiling, about two thousand samples each. A device with low limits computes a run of KDRT in several windows.
///
/// Fails when the device fails. A wrong result is not an error but a verdict.
pub async fn self_test(gpu: &Arc<Gpu>) -> Result<SelfTest, GpuError> {
    let (mut samples, mut runs) = (0, 0);
    for (order, k) in ORDERS.into_iter().zip(0..) {
        let parameters = Parameters {
            radius: 0.019,
            leaf: 8.0,
            seed: 20 + k,
            order,
            // Each insertion runs with each boundary.
            boundary: [Boundary::Periodic, Boundary::Bounded][k as usize % 2],
            insertion: [Insertion::Circumcentre, Insertion::Uniform][k as usize / 2],
            // Each insertion and each boundary runs once with symmetries and once without.
            dihedral: k == 1 || k == 2,
            pattern: SMALL_PATTERN,
            ..Parameters::default()
        };

        let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved)?;
        let options = Options {
            // Equal samples may still come from the wrong block.
            sources: true,
            ..Options::default()
        };

        let sweep = GpuSweep::new(Arc::clone(gpu), &parameters, &pattern, options).await?;
        let (gpu_set, _) = sweep.finish(&mut Unobserved).await?;
        let cpu_set = sequential(&parameters, pattern)?;

        if let Some(verdict) = difference(&gpu_set, &cpu_set) {
            let Parameters {
                insertion,
                boundary,
                ..
            } = parameters;
            let with = format!("with {order:?}, {insertion:?} and {boundary:?}: {verdict}");
            return Ok(failed(samples, with));
        }

        samples += cpu_set.points.len();
        runs += 1;
    }

    let (gpu_set, cpu_set) = exact_sets(gpu).await?;
    if let Some(verdict) = difference(&gpu_set, &cpu_set) {
        return Ok(failed(samples, format!("of an exact tiling: {verdict}")));
    }
    samples += cpu_set.points.len();
    runs += 1;

    Ok(SelfTest {
        passed: true,
        samples,
        verdict: format!("{samples} samples of {runs} runs are equal to the CPU's, bit for bit"),
    })
}

/// A small pattern, since the device stores it in each of its eight symmetries.
const SMALL_PATTERN: PatternSpec = PatternSpec {
    side: 30.0,
    seed: 0,
    boundary: Boundary::Periodic,
};

const fn failed(samples: usize, verdict: String) -> SelfTest {
    SelfTest {
        passed: false,
        samples,
        verdict,
    }
}

/// Returns an exact tiling as the device makes it, and as the CPU does.
async fn exact_sets(gpu: &Arc<Gpu>) -> Result<(Sampled, Sampled), GpuError> {
    let parameters = Parameters {
        method: TilingMethod::Exact,
        radius: 0.019,
        leaf: 8.0,
        seed: 24,
        dihedral: true,
        pattern: SMALL_PATTERN,
        ..Parameters::default()
    };
    let history = PatternHistory::of_spec(&parameters.pattern, &mut Unobserved)?;
    let run = exact_on_gpu(gpu, &parameters, history.arrived(), &mut Unobserved).await?;
    let cpu = exact_sample(&parameters, &history, &mut Unobserved)?;
    Ok((set_of(&run), set_of(&cpu)))
}

/// Returns the result of a run with its sources.
fn set_of(run: &Run) -> Sampled {
    let source = |&id: &u32| Source::from(run.samples.origins[id as usize]);
    Sampled {
        points: run.points(),
        sources: Some(run.result.iter().map(source).collect()),
    }
}

/// Returns the set of the sequential engine, which computes independently of the device.
fn sequential(parameters: &Parameters, pattern: Arc<Pattern>) -> Result<Sampled, GpuError> {
    let run = Sequential::new(parameters, pattern)?.finish(&mut Unobserved)?;
    Ok(set_of(&run))
}

/// Returns the first difference between two sets, in a sentence.
fn difference(gpu: &Sampled, cpu: &Sampled) -> Option<String> {
    let mut pairs = gpu.points.iter().zip(&cpu.points);
    if let Some(index) = pairs.position(|(a, b)| a != b) {
        let (a, b) = (gpu.points[index], cpu.points[index]);
        return Some(format!(
            "sample {index} is ({}, {}) on the device and ({}, {}) on the CPU, in lattice units",
            a.x, a.y, b.x, b.y
        ));
    }

    // The pairs end with the shorter set.
    if gpu.points.len() != cpu.points.len() {
        return Some(format!(
            "the device gives {} samples, the CPU {}",
            gpu.points.len(),
            cpu.points.len()
        ));
    }

    (gpu.sources != cpu.sources)
        .then(|| "the samples are equal but their sources differ".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use tilescope_core::Point;

    #[test]
    fn one_unit_is_a_difference() {
        let parameters = Parameters {
            radius: 0.05,
            ..Parameters::default()
        };
        let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
        let cpu = sequential(&parameters, pattern).unwrap();
        assert_eq!(difference(&cpu, &cpu), None);
        let mut other = cpu.clone();
        other.points[7] = Point::new(other.points[7].x + 1, other.points[7].y);
        assert!(difference(&other, &cpu).unwrap().contains("sample 7"));
        let mut other = cpu.clone();
        other.points.pop();
        assert!(
            difference(&other, &cpu)
                .unwrap()
                .contains("samples, the CPU")
        );
        let mut other = cpu.clone();
        other.sources = None;
        assert!(difference(&other, &cpu).unwrap().contains("sources differ"));
    }
}
