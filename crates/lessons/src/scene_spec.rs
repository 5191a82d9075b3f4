//! What a step of a lesson shows: the run, the moment, the layers and the camera, as they are in its file. `scene.rs` finds
//! the moment in a recording.

use tilescope_core::{NestedRequest, Parameters};
use tilescope_sets::Expression;

use crate::moment::Moment;
use crate::step_run::StepRun;
use crate::text::Text;

/// The names of the layers of the canvas, as lessons name them.
pub const LAYERS: [&str; 17] = [
    "pattern",
    "blocks",
    "kd-tree",
    "seams",
    "samples",
    "disks",
    "conflicts",
    "eliminated",
    "gaps",
    "detectors",
    "candidates",
    "inserted",
    "delaunay",
    "voronoi",
    "circumcircles",
    "covered-circles",
    "field",
];

/// The run, the moment and the view of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSpec {
    /// The parameters of the run.
    pub parameters: Parameters,
    /// The levels, if nested ones are shown and not a run with its stages.
    pub levels: Option<NestedRequest>,
    /// The radius as a function of x and y, if it depends on the place.
    pub radius: Option<Expression>,
    /// The third side in user units, if a set in space is shown.
    pub depth: Option<f64>,
    /// The expression of where the plane lies through a set in space, in r; none for a plane that follows the events.
    pub plane: Option<Text>,
    /// Whether a coin thins the darts of a field, as it must: lessons also show sets that are made without it.
    pub has_coin: bool,
    /// The density at a place x, y below which ranks are kept, if only some samples of the levels are.
    pub density: Option<Text>,
    /// The moment of the run that is shown.
    pub moment: Moment,
    /// The condition that must hold there, if there is one.
    pub condition: Option<Text>,
    /// The layers of the canvas; those of the stage, if none are named.
    pub layers: Option<Vec<String>>,
    /// The part of the domain that is shown.
    pub camera: Camera,
    /// General claims of the lesson that are tested at this moment, in the runs of many seeds.
    pub claims: Vec<Claim>,
    /// The line of the directive, or of the title.
    pub line: usize,
}

impl SceneSpec {
    /// Returns the run, with the seed of practice if one is given. In exact tiling the pattern's seed follows it, so that each
    /// practice has darts of its own.
    #[must_use]
    pub fn run(&self, seed: Option<u64>) -> StepRun {
        let mut parameters = Parameters {
            seed: seed.unwrap_or(self.parameters.seed),
            ..self.parameters
        };
        parameters.pattern = parameters.pattern_following(&self.parameters);
        StepRun {
            parameters,
            levels: self.levels,
            radius: self.radius.clone(),
            depth: self.depth,
        }
    }
}

/// A general claim of a lesson. `check` tests it in the runs of many seeds.
#[derive(Clone, Debug, PartialEq)]
pub enum Claim {
    /// True in each run.
    Each(Text),
    /// The mean over the runs is on one side of a bound.
    Mean {
        /// The expression of the number whose mean is taken.
        of: Text,
        /// Whether the mean is above the bound, not below it.
        is_above: bool,
        /// The number with which the mean is compared.
        bound: f64,
    },
}

/// What the camera shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Camera {
    /// It shows the whole domain.
    #[default]
    Fit,
    /// The sample or place that an expression gives, with this many r around it.
    At(Text, f64),
}
