//! The subject of a canvas: a moment of a run with everything that its drawing depends on. Two canvases side by
//! side have one subject each.

use glam::DVec2;

use tilescope_session::geometry::Geometry;
use tilescope_session::layers::{Colouring, Layers};
use tilescope_session::moment::ShownMoment;
use tilescope_session::session::Session;
use tilescope_session::verification::WitnessMark;

use crate::brushed::BrushedCause;
use crate::camera::Camera;

/// A moment, and how it is drawn.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// The moment that is shown.
    pub shown: ShownMoment<'a>,
    /// The visible part of the plane.
    pub camera: Camera,
    /// The layers that are on.
    pub layers: Layers,
    /// The property of samples that their colour shows.
    pub colouring: Colouring,
    /// The sample under the pointer.
    pub hovered: Option<u32>,
    /// The id of the selected sample.
    pub selected: Option<u32>,
    /// The selected place of the plane, in r.
    pub place: Option<DVec2>,
    /// The witness of a verdict that the user flew to.
    pub witness_mark: Option<WitnessMark>,
    /// The gaps and the triangulation of the moment, as far as they are known.
    pub geometry: &'a Geometry,
    /// The samples that only one of two compared runs has.
    pub contrast: Option<Contrast<'a>>,
    /// The causes of the brush.
    pub causes: Option<&'a BrushedCause>,
    /// What of a set in a field or a shape is shown.
    pub view: GroundView,
    /// How far the animation of the last event has come, from 0 to 1.
    pub drawn_in: f32,
}

/// What a picture of a set in a field or a shape shows. Pictures of all other sets show the set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroundView {
    /// The radius at each place.
    Radii,
    /// The places that are to be covered.
    Shape,
    /// The set with the layers that were chosen.
    Set,
    /// The samples as dots of one colour, as a stipple is printed.
    Dots,
}

/// The samples that only one of two compared runs has, seen from one of them.
#[derive(Clone, Copy)]
pub struct Contrast<'a> {
    /// The samples of this run alone.
    pub here: &'a [u32],
    /// The samples of the other run alone.
    pub there: &'a [u32],
    /// The run that is compared with.
    pub other: &'a Session,
}
