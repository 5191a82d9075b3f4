//! The live analysis: measures the samples of the current moment of each run ([`Measuring`]), compares them with a reference, and
//! finds the causes of a brush. It works in the background, and only while its panel is visible.

pub mod brush;
pub mod measured;
mod measuring;
pub mod reference;
pub mod reference_file;
pub mod solid;

use std::sync::Arc;

use tilescope_core::Stage;

use brush::{Brush, Marks};
use measured::Samples;
pub use measuring::{ContinueMeasuringTask, Known, MAX_KEPT, Measuring, StartMeasuringTask};
pub use reference::Reference;
use reference_file::ReferenceFile;
use tilescope_session::jobs::Wake;
use tilescope_session::moment::{ShownMoment, Still};
use tilescope_session::sentence::name_in;
use tilescope_session::session::Session;
use tilescope_session::units::radii;
use tilescope_session::words::grouped;
use tilescope_sets::region_in_radii;

/// An action of the analysis.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AnalysisCommand {
    /// Stops measuring this moment.
    Stop,
    /// Resumes measuring this moment.
    Resume,
    /// Removes the reference file.
    Clear,
    /// Sets the brush whose causes are looked for, or removes it.
    Brush(Option<Brush>),
}

/// What the moments of runs are compared with, and the brush.
#[derive(Default)]
pub struct Analysis {
    /// The measures of a typical maximal set.
    pub reference: Reference,
    /// The file that moments are compared with.
    pub reference_file: Option<Arc<ReferenceFile>>,
    /// The range of frequencies or distances whose causes are looked for; `None` without a brush.
    pub brush: Option<Brush>,
    /// The causes of the brush.
    pub marks: Marks,
}

impl Analysis {
    /// Starts measuring the reference, and looking for the causes of the brush at a moment.
    pub fn want(&mut self, session: &Arc<Session>, shown: &ShownMoment<'_>, wake: &Wake) {
        self.reference.want(wake);
        self.marks.want(session, shown, self.brush, wake);
    }

    /// Stops the work, since the panel is hidden.
    pub fn rest(&mut self) {
        self.marks.rest();
        self.reference.rest();
    }

    /// Waits for the running work; returns whether there was any.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&mut self) -> bool {
        let found = self.marks.settle();
        self.reference.settle() || found
    }
}

/// Returns the samples that cover their disks at a moment, in r.
#[must_use]
pub fn samples(still: &Still) -> Samples {
    let covering = still.covering().into_iter();
    let points = covering.map(|(point, _)| [radii(point.x), radii(point.y)]);
    Samples {
        points: points.collect(),
        region: region_in_radii(&still.session().run().domain),
        radius: 1.0,
    }
}

/// Returns the name of a moment: its stage, and the number of its event if the run has events.
#[must_use]
pub fn name_of(shown: &ShownMoment<'_>) -> String {
    let stage = match shown.stage {
        Stage::Iterate(k) => format!("iteration {k}"),
        stage => name_in(shown.session, stage).to_lowercase(),
    };
    match shown.debugger {
        Some(_) => format!("event {}, {stage}", grouped(shown.cursor())),
        None => format!("after {stage}"),
    }
}
