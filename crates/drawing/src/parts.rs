//! The parts of a picture from bottom to top, each drawn by one function for both the window's canvas and
//! exported pictures. Begin with [`Part`].

mod blocks;
mod darts;
mod geometry;
mod ground;
mod inset;
mod pairs;
mod samples;
mod seams;
mod selection;
mod step;
mod tree;

use emath::Rect;
use tilescope_core::Stage;
use tilescope_session::layers::Layer;

use crate::looks::Looks;
use crate::scene::Scene;
use crate::subject::GroundView;
use crate::surface::Surface;

/// A part of a picture. Gaps are not listed: each surface draws them itself, between the domain and all parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The radius at each place, or in the picture of a shape the area inside.
    Field,
    /// The area outside of a shape.
    Outside,
    /// The outline of a shape.
    Outline,
    /// The tints of the blocks.
    Tints,
    /// The band that gluing may change.
    Band,
    /// The edges of the Delaunay triangulation.
    Delaunay,
    /// The edges of the Voronoi diagram.
    Voronoi,
    /// Circumcircles larger than r.
    Circumcircles,
    /// The circles around samples, and their exposed arcs.
    CoveredCircles,
    /// The borders of gaps.
    GapBorders,
    /// The disks around samples.
    Disks,
    /// The borders of the blocks.
    Borders,
    /// The numbers of the blocks.
    Numbers,
    /// The seams of a combination.
    Seams,
    /// The lines of the KD-tree.
    Tree,
    /// The clips around the blocks.
    Clips,
    /// Conflicts, and how they were resolved.
    Conflicts,
    /// The pairs at brushed distances.
    Pairs,
    /// Around a periodic domain, the copies of samples near its border.
    Copies,
    /// The symbols of the samples.
    Samples,
    /// The detectors and candidates of a search.
    Search,
    /// The numbers of the KD-tree's splits.
    TreeNumbers,
    /// The samples and points that the last event tests and changes.
    Step,
    /// The selected sample or place, and the one under the pointer.
    Selection,
    /// The pattern in a corner, with the window of the current block's clip.
    Inset,
}

impl Part {
    /// Every part, from bottom to top.
    pub const ALL: [Self; 25] = [
        Self::Field,
        Self::Outside,
        Self::Outline,
        Self::Tints,
        Self::Band,
        Self::Delaunay,
        Self::Voronoi,
        Self::Circumcircles,
        Self::CoveredCircles,
        Self::GapBorders,
        Self::Disks,
        Self::Borders,
        Self::Seams,
        Self::Tree,
        Self::Clips,
        Self::Conflicts,
        Self::Pairs,
        Self::Copies,
        Self::Samples,
        Self::Search,
        Self::Numbers,
        Self::TreeNumbers,
        Self::Step,
        Self::Selection,
        Self::Inset,
    ];

    /// Returns its name in exported pictures.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Field => "field",
            Self::Outside => "outside",
            Self::Outline => "outline",
            Self::Tints => "blocks",
            Self::Band => "band",

            Self::Delaunay => "Delaunay",
            Self::Voronoi => "Voronoi",
            Self::Circumcircles => "circumcircles",
            Self::CoveredCircles => "covered circles",
            Self::GapBorders => "gap borders",
            Self::Disks => "disks",

            Self::Borders => "block borders",
            Self::Numbers => "block numbers",
            Self::Seams => "seams",
            Self::Tree => "KD-tree",
            Self::Clips => "clips",

            Self::Conflicts => "conflicts",
            Self::Pairs => "brushed pairs",
            Self::Copies => "copies",
            Self::Samples => "samples",
            Self::Search => "search",

            Self::TreeNumbers => "split numbers",
            Self::Step => "step",
            Self::Selection => "selection",
            Self::Inset => "inset",
        }
    }

    /// Returns whether the part is drawn: its layer, if it has one, is on, and the run and the moment have something
    /// for it.
    #[must_use]
    pub fn is_on(self, scene: &Scene<'_>) -> bool {
        let has = |layer| scene.has(layer);
        let is_tiled = scene.stage >= Stage::Tile;
        // Beside the set other pictures have what they are named after, and the selection.
        let is_set = scene.subject.view == GroundView::Set;

        // Disks and gaps are drawn only where disks are large enough on the screen: `is_fine`.
        match self {
            Self::Field => {
                let is_shape = scene.subject.view == GroundView::Shape;
                scene.session.ground.is_some() && (has(Layer::Field) || is_shape)
            }
            // The domain of a field alone has no outside.
            Self::Outside | Self::Outline => scene.session.has_shape(),
            Self::Tints | Self::Borders | Self::Numbers => has(Layer::Blocks),
            Self::Band | Self::Seams => scene.session.combination.is_some() && has(Layer::Seams),
            Self::Delaunay => is_tiled && has(Layer::Delaunay),
            Self::Voronoi => is_tiled && has(Layer::Voronoi),
            Self::Circumcircles => is_tiled && has(Layer::Circumcircles),
            Self::CoveredCircles => is_tiled && has(Layer::CoveredCircles),
            // While blocks are tiled, the area of a block without samples yet is not a gap.
            Self::GapBorders => {
                scene.stage >= Stage::Eliminate && scene.is_fine() && has(Layer::Gaps)
            }
            Self::Disks => is_tiled && scene.is_fine() && has(Layer::Disks),
            Self::Tree | Self::TreeNumbers => has(Layer::Tree),
            Self::Clips => has(Layer::Pattern),
            // Which stages have conflicts is decided where they are drawn.
            Self::Conflicts => has(Layer::Conflicts),
            Self::Pairs => is_tiled && is_set && scene.subject.causes.is_some(),
            // At the end of a stage the whole stage is shown, not its last event.
            Self::Step => is_set && !scene.shown.ends_stage(),
            // The inset shows from where the block that is being tiled gets its samples.
            Self::Inset => {
                scene.stage == Stage::Tile && has(Layer::Pattern) && !scene.shown.ends_stage()
            }
            Self::Copies => is_tiled && scene.session.run().domain.is_periodic(),
            // These parts themselves find out whether there is something to draw.
            Self::Samples | Self::Search | Self::Selection => true,
        }
    }

    /// Returns the rectangle that the part is clipped to.
    #[must_use]
    pub fn clip(self, scene: &Scene<'_>) -> Rect {
        match self {
            Self::Delaunay | Self::Voronoi | Self::Circumcircles | Self::CoveredCircles => {
                scene.inside()
            }
            Self::GapBorders | Self::Disks => scene.around(),
            _ => scene.rect,
        }
    }

    /// Draws the part on a surface, whether it is on or not.
    pub fn draw(self, scene: &Scene<'_>, looks: &Looks<'_>, surface: &mut impl Surface) {
        match self {
            Self::Field => ground::field(scene, surface),
            Self::Outside => ground::outside(scene, surface),
            Self::Outline => ground::outline(scene, surface),
            Self::Tints => blocks::tints(scene, surface),
            Self::Band => seams::band(scene, surface),

            Self::Delaunay => geometry::delaunay(scene, surface),
            Self::Voronoi => geometry::voronoi(scene, surface),
            Self::Circumcircles => geometry::circumcircles(scene, surface),
            Self::CoveredCircles => geometry::covered_circles(scene, surface),
            Self::GapBorders => geometry::gap_borders(scene, surface),

            Self::Disks => samples::disks(scene, looks, surface),
            Self::Borders => blocks::borders(scene, surface),
            Self::Numbers => blocks::numbers(scene, surface),
            Self::Seams => seams::lines(scene, surface),
            Self::Tree => tree::lines(scene, surface),
            Self::Clips => blocks::clips(scene, surface),

            Self::Conflicts => samples::conflicts(scene, surface),
            Self::Pairs => pairs::draw(scene, surface),
            Self::Copies => samples::copies(scene, looks, surface),
            Self::Samples => samples::draw(scene, looks, surface),
            Self::Search => samples::search(scene, surface),

            Self::TreeNumbers => tree::numbers(scene, surface),
            Self::Step => step::draw(scene, surface),
            Self::Selection => selection::draw(scene, surface),
            Self::Inset => inset::draw(scene, surface),
        }
    }
}

pub use pairs::{draw_these as draw_pairs, in_view as pairs_in_view};
pub use samples::{pattern, visit};
