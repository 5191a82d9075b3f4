//! What a canvas shows and how: a moment of a run, seen through a camera. Two canvases side by side have one each;
//! neither knows which of two runs it shows.

use glam::DVec2;

use tilescope_session::geometry::Geometry;
use tilescope_session::layers::{Colouring, Layers};
use tilescope_session::moment::ShownMoment;
use tilescope_session::session::Session;
use tilescope_session::verification::WitnessMark;

use crate::brushed::BrushedCause;
use crate::camera::Camera;

/// A moment, and how it is seen.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// The moment.
    pub shown: ShownMoment<'a>,
    /// The view.
    pub camera: Camera,
    /// The layers shown.
    pub layers: Layers,
    /// What the colour of samples means.
    pub colouring: Colouring,
    /// The sample under the pointer.
    pub hovered: Option<u32>,
    /// The selected sample.
    pub selected: Option<u32>,
    /// The selected place, in r.
    pub place: Option<DVec2>,
    /// The place that a verdict was followed to.
    pub witness_mark: Option<WitnessMark>,
    /// The triangulation of the moment, as far as it is known.
    pub geometry: &'a Geometry,
    /// What only one of two compared runs has.
    pub contrast: Option<Contrast<'a>>,
    /// The causes of what is brushed.
    pub causes: Option<&'a BrushedCause>,
}

/// The samples that only one of two compared runs has, seen from one of them.
#[derive(Clone, Copy)]
pub struct Contrast<'a> {
    /// Those that this run alone has.
    pub here: &'a [u32],
    /// Those that the other run alone has.
    pub there: &'a [u32],
    /// The other run.
    pub other: &'a Session,
}
