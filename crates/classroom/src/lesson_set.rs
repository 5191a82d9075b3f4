//! How the set of a lesson's step was made, where its recording does not say it: in a field of radii, whose formula the session
//! shows, or in a box. Begin with [`LessonSet::session`].

use std::sync::Arc;

use tilescope_debugger::Recording;
use tilescope_lessons::StepRun;
use tilescope_session::ground::GroundRequest;
use tilescope_session::packing;
use tilescope_session::recipe::Recipe;
use tilescope_session::session::Session;
use tilescope_session::varying::with_ground;

/// The set of a step in a field of radii or in a box.
#[derive(Clone, Debug, PartialEq)]
pub struct LessonSet {
    recipe: Recipe,
    /// Whether a coin thins the darts where the radius is larger than the side of their cell, as in every run of a field. A
    /// step may show what comes of darts without it.
    has_coin: bool,
}

impl LessonSet {
    /// Returns the set of a step's run, if the radius depends on the place there or it is in space.
    #[must_use]
    pub fn of(run: &StepRun) -> Option<Self> {
        let recipe = Self::recipe_of(run);
        let is_meant = recipe.ground.is_some() || recipe.depth.is_some();
        is_meant.then_some(Self {
            recipe,
            has_coin: true,
        })
    }

    /// Returns the same set, with or without the coin that thins the darts of a field.
    #[must_use]
    pub(crate) fn with_coin(self, has_coin: bool) -> Self {
        Self { has_coin, ..self }
    }

    /// Returns the recipe of a step's run of any kind.
    #[must_use]
    pub fn recipe_of(run: &StepRun) -> Recipe {
        // Formulas of lessons have their coordinates from the domain's lower corner.
        let request = run.recipe().map(|recipe| GroundRequest {
            radius: Some(recipe.radius),
            shape: None,
            origin: [0.0; 2],
            stipple: None,
        });
        Recipe {
            nested: run.levels,
            ground: request.map(Box::new),
            depth: run.depth,
            ..Recipe::from(run.parameters)
        }
    }

    /// Returns the session of a recording that was made as this set, or as a planar one with one radius.
    #[must_use]
    pub fn session(set: Option<&Self>, recording: Arc<Recording>, generation: u64) -> Session {
        let Some(set) = set else {
            return Session::from_recording(recording, generation);
        };

        // A set of this type is in a field or in a box (see `of`): one without a field is in a box.
        let Some(request) = &set.recipe.ground else {
            return packing::recorded(recording, set.recipe.parameters, generation);
        };
        let session = Session::from_recording(recording, generation);
        let mut session = with_ground(session, &set.recipe, request);
        // Darts without the coin make other samples than the recipe asks for. The session must not offer this recipe as
        // that of its samples.
        if let Some(ground) = &mut session.ground {
            ground.is_as_asked = set.has_coin;
        }
        session
    }
}
