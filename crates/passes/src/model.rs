//! The passes of a run as data: their reports, how they compare with the CPU, and the lines of their list.

use tilescope_core::{MAXIMAL_DENSITY, Parameters, Rect, Stage};
use tilescope_gpu::PassReport;
use tilescope_gpu::cpu_reference::RunDifference;
use tilescope_gpu::layout::{Access, Name};
use tilescope_session::limits::MAX_STAGED;
use tilescope_session::words::{grouped, sentence};

use super::placed::PlacedRows;
use super::table::BufferTable;

/// How a pass compares with the CPU.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Badge {
    /// It ended a stage, and the device equals the CPU.
    Equal,
    /// It ended a stage, and the device differs from the CPU; the first difference.
    Differs(RunDifference),
    /// It did not end a stage, so the CPU has no state to compare with.
    Intermediate,
}

impl Badge {
    /// Returns the text of the badge.
    #[must_use]
    pub fn text(&self) -> String {
        match self {
            Self::Equal => "equal to the CPU".to_owned(),
            Self::Differs(difference) => format!("differs from CPU: {difference}"),
            Self::Intermediate => "not comparable (intermediate)".to_owned(),
        }
    }
}

/// A pass of the run.
#[derive(Clone, Debug, PartialEq)]
pub struct PassEntry {
    /// Its dispatch and timing.
    pub report: PassReport,
    /// How it compares with the CPU.
    pub badge: Badge,
}

impl PassEntry {
    /// Returns the readable buffers that it is bound to, each once, with its access. The dispatch's four numbers, which
    /// the host writes for every pass, are not included.
    #[must_use]
    pub fn buffers(&self) -> Vec<(Name, Access, u64)> {
        let mut buffers: Vec<(Name, Access, u64)> = Vec::new();
        for &(name, access, bytes) in &self.report.bindings {
            if name != Name::Job && buffers.iter().all(|(known, ..)| *known != name) {
                buffers.push((name, access, bytes));
            }
        }
        buffers
    }
}

/// A line of the list of passes.
#[derive(Clone, Debug, PartialEq)]
pub enum PassLine {
    /// The heading of a stage.
    Stage {
        /// The stage that begins.
        stage: Stage,
        /// How many passes it has.
        passes: usize,
        /// The seconds of its timed passes; `None` if none was timed.
        seconds: Option<f64>,
    },
    /// A pass, by its index in the run.
    Pass(usize),
}

/// Returns the lines of the list: every stage, and the passes that belong to it.
#[must_use]
pub fn lines(passes: &[PassEntry]) -> Vec<PassLine> {
    let mut lines = Vec::new();
    let mut first = 0;
    for group in passes.chunk_by(|a, b| a.report.stage == b.report.stage) {
        let timed = group.iter().filter_map(|pass| pass.report.seconds);
        lines.push(PassLine::Stage {
            stage: group[0].report.stage,
            passes: group.len(),
            // The sum is None, not zero, where the device measures no times.
            seconds: timed.fold(None, |sum, seconds| Some(sum.unwrap_or(0.0) + seconds)),
        });
        lines.extend((first..first + group.len()).map(PassLine::Pass));
        first += group.len();
    }
    lines
}

/// A visited pass: its buffers before and after it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Visit {
    /// Its index in the run.
    pub pass: usize,
    /// The tables of its buffers.
    pub buffers: Vec<BufferTable>,
    /// Where the rows of each lie.
    pub placed: Vec<PlacedRows>,
    /// The rectangle of the domain.
    pub domain: Rect,
    /// Whether the run was restarted to get there.
    pub replayed: bool,
}

/// Returns why the passes of a run cannot be inspected, in a sentence.
#[must_use]
pub fn refusal(parameters: &Parameters) -> Option<String> {
    let expected = match parameters.validate() {
        Ok(domain) => domain.area_radii() * MAXIMAL_DENSITY,
        Err(error) => return Some(sentence(&error.to_string())),
    };
    let [count, most] = [expected.round(), MAX_STAGED].map(|count| grouped(count as usize));
    (expected > MAX_STAGED).then(|| {
        format!("About {count} samples are expected; passes can be inspected in runs of up to {most} samples.")
    })
}

/// Returns a time with its unit, in three digits.
#[must_use]
pub fn duration_text(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s < 1e-3 => (s * 1e6, "\u{b5}s"),
        s if s < 1.0 => (s * 1e3, "ms"),
        s => (s, "s"),
    };
    let digits = usize::from(value < 10.0) + usize::from(value < 100.0);
    format!("{value:.digits$} {unit}")
}

/// Returns the access of a pass to a buffer, in a word.
#[must_use]
pub const fn access_text(access: Access) -> &'static str {
    match access {
        Access::Uniform => "uniform",
        Access::Read => "read",
        Access::Write => "written",
        Access::Update => "updated",
        Access::Atomic => "atomic",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pass(stage: Stage, seconds: Option<f64>) -> PassEntry {
        PassEntry {
            report: PassReport {
                stage,
                name: "some",
                indirect: false,
                workgroups: None,
                invocations: None,
                bindings: vec![
                    (Name::Job, Access::Uniform, 0),
                    (Name::Grid, Access::Read, 16),
                    (Name::Grid, Access::Update, 16),
                ],
                seconds,
            },
            badge: Badge::Intermediate,
        }
    }

    #[test]
    fn passes_are_grouped_by_stage() {
        let passes = [
            pass(Stage::Tile, Some(1e-3)),
            pass(Stage::Tile, Some(2e-3)),
            pass(Stage::Iterate(1), None),
        ];
        let lines = lines(&passes);
        assert_eq!(lines.len(), 5);
        assert!(
            matches!(lines[0], PassLine::Stage { passes: 2, seconds: Some(s), .. } if (s - 3e-3).abs() < 1e-9)
        );
        assert_eq!(lines[2], PassLine::Pass(1));
        assert!(matches!(lines[3], PassLine::Stage { seconds: None, .. }));
        assert_eq!(lines[4], PassLine::Pass(2));
        assert_eq!(passes[0].buffers(), [(Name::Grid, Access::Read, 16)]);
    }

    #[test]
    fn times_have_three_digits() {
        assert_eq!(duration_text(1.234e-6), "1.23 \u{b5}s");
        assert_eq!(duration_text(45.67e-3), "45.7 ms");
        assert_eq!(duration_text(1.5), "1.50 s");
        assert_eq!(duration_text(321e-6), "321 \u{b5}s");
    }

    #[test]
    fn a_large_run_is_refused_with_the_limit() {
        let small = Parameters::default();
        assert_eq!(refusal(&small), None);
        let large = Parameters {
            radius: small.radius / 10.0,
            ..small
        };
        assert!(refusal(&large).unwrap().contains("up to 500,000 samples"));
        let bad = Parameters {
            radius: 0.0,
            ..small
        };
        assert!(refusal(&bad).is_some());
    }
}
