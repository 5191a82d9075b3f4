//! The field of radii in which the run of a lesson's step was made. A recording holds the radii and not their formula, which the
//! session of a field shows. Begin with [`LessonField::session`].

use std::sync::Arc;

use tilescope_debugger::Recording;
use tilescope_lessons::StepRun;
use tilescope_session::ground::GroundRequest;
use tilescope_session::recipe::Recipe;
use tilescope_session::session::Session;
use tilescope_session::varying::with_ground;

/// The field of radii of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct LessonField {
    recipe: Recipe,
    request: GroundRequest,
    /// Whether a coin thins the darts where the radius is larger than the side of their cell, as in every run of a field. A
    /// step may show what comes of darts without it.
    has_coin: bool,
}

impl LessonField {
    /// Returns the field of a step's run, if the radius depends on the place there.
    #[must_use]
    pub fn of(run: &StepRun) -> Option<Self> {
        // Formulas of lessons have their coordinates from the domain's lower corner.
        let request = GroundRequest {
            radius: Some(run.recipe()?.radius),
            shape: None,
            origin: [0.0; 2],
            stipple: None,
        };
        let ground = Some(Box::new(request.clone()));
        Some(Self {
            recipe: Recipe {
                ground,
                ..Recipe::from(run.parameters)
            },
            request,
            has_coin: true,
        })
    }

    /// Returns the field of the shown set, with or without the coin that thins its darts.
    #[must_use]
    pub(crate) fn with_coin(self, has_coin: bool) -> Self {
        Self { has_coin, ..self }
    }

    /// Returns the recipe of a step's run, in a field or not.
    #[must_use]
    pub fn recipe_of(run: &StepRun) -> Recipe {
        match Self::of(run) {
            Some(field) => field.recipe,
            None => Recipe {
                nested: run.levels,
                ..Recipe::from(run.parameters)
            },
        }
    }

    /// Returns the session of a recording that was made in this field, or in none.
    #[must_use]
    pub fn session(field: Option<&Self>, recording: Arc<Recording>, generation: u64) -> Session {
        let session = Session::from_recording(recording, generation);
        let Some(field) = field else {
            return session;
        };

        let mut session = with_ground(session, &field.recipe, &field.request);
        // Darts without the coin make other samples than the recipe, so that the session does not offer it.
        if let Some(ground) = &mut session.ground {
            ground.is_as_asked = field.has_coin;
        }
        session
    }
}
