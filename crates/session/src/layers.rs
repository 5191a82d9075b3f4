//! The layers of the canvas, sets of them, and the meaning of samples' colours.

use tilescope_core::Stage;

use crate::glossary;
use crate::words::slug;

/// The kind of a session, which decides the layers and their meanings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum SessionKind {
    /// A run of KDRT, from one pattern.
    Run,
    /// An exact tiling of a pattern's darts.
    Exact,
    /// A combination of several sets.
    Combination,
    /// A set with nested levels.
    Nested,
    /// A set whose radius depends on the place, or whose domain is a shape.
    Varying,
    /// A set of balls in space, seen in a plane.
    Solid,
}

impl SessionKind {
    /// Returns whether it is made of parameters, block by block: by KDRT or by exact tiling.
    #[must_use]
    pub const fn is_run(self) -> bool {
        matches!(self, Self::Run | Self::Exact)
    }
}

/// A layer of the canvas.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Layer {
    /// The clip rectangle: the enlarged block that receives a clip of the pattern.
    Pattern,
    /// The borders of the building blocks.
    Blocks,
    /// Samples that are valid at the moment.
    Samples,
    /// Disks of radius r.
    Disks,
    /// Pairs of samples in each other's disks.
    Conflicts,
    /// Samples that were eliminated by the moment.
    Eliminated,
    /// Samples that look for gaps.
    Detectors,
    /// The area that no disk covers.
    Gaps,
    /// Uncovered places where a sample may be inserted.
    Candidates,
    /// Samples that were inserted by the moment.
    Inserted,
    /// Delaunay triangles of the valid samples.
    Delaunay,
    /// Voronoi cells of the valid samples.
    Voronoi,
    /// Circumcircles of Delaunay triangles that are larger than r.
    Circumcircles,
    /// The splits of the KD-tree.
    Tree,
    /// The seams of a combination, and the band that gluing can have changed.
    Seams,
    /// The circles around samples, and the arcs of them that no other disk covers.
    CoveredCircles,
    /// The radius at each place, as a shade.
    Field,
}

impl Layer {
    /// Every layer, in the order of the chips.
    pub const ALL: [Self; 17] = [
        Self::Pattern,
        Self::Blocks,
        Self::Tree,
        Self::Seams,
        Self::Samples,
        Self::Disks,
        Self::Conflicts,
        Self::Eliminated,
        Self::Gaps,
        Self::Detectors,
        Self::Candidates,
        Self::Inserted,
        Self::Delaunay,
        Self::Voronoi,
        Self::Circumcircles,
        Self::CoveredCircles,
        Self::Field,
    ];

    /// The layers that are computed from a moment's triangulation and circles.
    pub const NETS: [Self; 4] = [
        Self::Delaunay,
        Self::Voronoi,
        Self::Circumcircles,
        Self::CoveredCircles,
    ];

    /// Returns its name in links, lessons and requests of pages.
    #[must_use]
    pub fn key(self) -> String {
        match self {
            Self::Circumcircles => "circumcircles".to_owned(),
            layer => slug(layer.name()),
        }
    }

    /// Returns the name on its chip.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pattern => "Pattern",
            Self::Blocks => "Blocks",
            Self::Tree => "KD-tree",
            Self::Seams => "Seams",
            Self::Samples => "Samples",
            Self::Disks => "Disks",
            Self::Conflicts => "Conflicts",
            Self::Eliminated => "Eliminated",
            Self::Gaps => "Gaps",
            Self::Detectors => "Detectors",
            Self::Candidates => "Candidates",
            Self::Inserted => "Inserted",
            Self::Delaunay => "Delaunay",
            Self::Voronoi => "Voronoi",
            Self::Circumcircles => "Empty circles",
            Self::CoveredCircles => "Covered circles",
            Self::Field => "Field",
        }
    }

    /// Returns whether a kind of session has this layer: seams belong to combinations, the tree to runs; nested levels
    /// have samples, disks and triangulations alone. Sets of varying radius have these, too, with their field, gaps,
    /// darts, inserted samples and active cells. Planes through sets in space have samples, the disks that they cut
    /// from balls, gaps, darts and active cubes.
    #[must_use]
    pub const fn is_of(self, kind: SessionKind) -> bool {
        match (self, kind) {
            // A plane through space has neither blocks nor triangles of its own.
            (_, SessionKind::Solid) => matches!(
                self,
                Self::Samples | Self::Disks | Self::Gaps | Self::Detectors | Self::Eliminated
            ),
            (Self::Samples | Self::Disks | Self::Delaunay | Self::Voronoi, _) => true,
            (_, SessionKind::Nested) => false,
            (Self::Field, _) => matches!(kind, SessionKind::Varying),
            (_, SessionKind::Varying) => matches!(
                self,
                Self::Eliminated | Self::Detectors | Self::Inserted | Self::Gaps
            ),
            (Self::Seams, _) => matches!(kind, SessionKind::Combination),
            (Self::Tree, _) => kind.is_run(),
            // Runs, exact tilings and combinations have all other layers.
            _ => true,
        }
    }

    /// Returns the name in a session: the blocks of a combination are its pieces, and exact tiling has darts and cells where
    /// others have candidates and detectors.
    #[must_use]
    pub const fn name_in(self, kind: SessionKind) -> &'static str {
        match (self, kind) {
            (Self::Blocks, SessionKind::Combination) => "Pieces",
            (Self::Eliminated, SessionKind::Exact) => "Lost, refused",
            (Self::Detectors, SessionKind::Exact | SessionKind::Varying) => "Active cells",
            (Self::Candidates, SessionKind::Exact) => "Waiting darts",
            (Self::Detectors, SessionKind::Solid) => "Active cubes",
            (Self::Eliminated, SessionKind::Varying | SessionKind::Solid) => "Darts",
            _ => self.name(),
        }
    }

    /// Returns the meaning of its symbol in a few words, in a kind of session.
    #[must_use]
    pub const fn meaning(self, kind: SessionKind) -> &'static str {
        match (self, kind) {
            (Self::Blocks, SessionKind::Combination) => return "rectangle of a piece",
            (Self::Pattern, SessionKind::Combination) => return "rectangle enlarged by r",
            (Self::Disks, SessionKind::Nested) => return "disk of the last whole level's radius",
            (Self::Pattern, SessionKind::Exact) => return "block laid on the pattern",
            (Self::Eliminated, SessionKind::Exact) => return "lost sample, refused dart",
            (Self::Detectors, SessionKind::Exact | SessionKind::Varying) => {
                return "active cell: darts fall there";
            }
            (Self::Candidates, SessionKind::Exact) => return "dart that will arrive",
            (Self::Inserted, SessionKind::Exact) => return "sample that the pattern lacks",
            (Self::Disks, SessionKind::Varying) => return "disk of the sample's own radius",
            (Self::Disks, SessionKind::Solid) => return "cut of a ball of radius r",
            (Self::Samples, SessionKind::Solid) => {
                return "sample within r of the plane: the paler, the farther";
            }
            (Self::Gaps, SessionKind::Solid) => return "gap: in no ball",
            (Self::Detectors, SessionKind::Solid) => return "active cube that the plane cuts",
            (Self::Eliminated, SessionKind::Solid) => return "dart near the plane, refused",
            (Self::Eliminated, SessionKind::Varying) => return "dart that became no sample",

            // All other layers mean the same in every session.
            _ => {}
        }

        match self {
            Self::Samples => "sample",
            Self::Disks => "disk of radius r",
            Self::Blocks => "building block",
            Self::Tree => "split of the KD-tree",
            Self::Seams => "seam, and how far gluing may reach",
            Self::Pattern => "clip: block enlarged by r",
            Self::Conflicts => "conflict: closer than r",
            Self::Eliminated => "eliminated sample",
            Self::Gaps => "gap: covered by no disk",
            Self::Detectors => "gap detector",
            Self::Candidates => "candidate place",
            Self::Inserted => "inserted sample",
            Self::Delaunay => "Delaunay triangle",
            Self::Voronoi => "border of a Voronoi cell",
            Self::Circumcircles => "empty circle larger than r",
            Self::CoveredCircles => "exposed arc: covered by no disk",
            Self::Field => "the darker, the smaller the radius",
        }
    }

    /// Returns the explanation of its content, in a sentence or two: mostly that of the glossary, which is about
    /// tilings. What differs in another kind of session, [`Self::meaning`] says.
    #[must_use]
    pub const fn explanation(self) -> &'static str {
        match self {
            Self::Pattern => glossary::CLIP.meaning,
            Self::Blocks => glossary::BLOCK.meaning,
            Self::Tree => {
                "The splits of the KD-tree, numbered as they were made; the thicker, the fewer lie above."
            }
            Self::Seams => {
                "The lines along which the sets of a combination meet, and the band around them that gluing may touch."
            }
            Self::Samples => "The samples that are valid at this stage.",
            Self::Disks => glossary::DISK.meaning,
            Self::Conflicts => glossary::CONFLICT.meaning,
            Self::Eliminated => glossary::ELIMINATED.meaning,
            Self::Gaps => glossary::GAP.meaning,
            Self::Detectors => glossary::DETECTOR.meaning,
            Self::Candidates => glossary::CANDIDATE.meaning,
            Self::Inserted => glossary::INSERTED.meaning,
            Self::Delaunay => glossary::DELAUNAY.meaning,
            Self::Voronoi => glossary::VORONOI.meaning,
            Self::Circumcircles => glossary::CIRCUMCIRCLE.meaning,
            Self::CoveredCircles => glossary::COVERED_CIRCLE.meaning,

            // It is of sets in a field or a shape alone, whose words the glossary lacks.
            Self::Field => {
                "The radius at each place: the darker, the smaller, and so the denser the samples."
            }
        }
    }
}

/// A set of layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub struct Layers(u32);

impl Default for Layers {
    fn default() -> Self {
        let hidden = [
            Layer::Pattern,
            Layer::Tree,
            Layer::Disks,
            Layer::Delaunay,
            Layer::Voronoi,
            Layer::Circumcircles,
            Layer::CoveredCircles,
            Layer::Field,
        ];
        let shown = Layer::ALL.into_iter().filter(|l| !hidden.contains(l));
        Self(shown.fold(0, |bits, layer| bits | 1 << layer as u32))
    }
}

impl Layers {
    /// Returns the layers that explain a stage: the default ones, with the tree while blocks are cut and the clips while
    /// they are placed.
    #[must_use]
    pub fn of_stage(stage: Stage) -> Self {
        let mut layers = Self::default();
        match stage {
            Stage::Blocks => layers.toggle(Layer::Tree),
            Stage::Tile => layers.toggle(Layer::Pattern),
            // The default layers suit all other stages.
            _ => {}
        }
        layers
    }

    /// Returns the layers that explain a stage of a kind of session: in a plane through a set in space the disks, too.
    #[must_use]
    pub fn of_stage_in(kind: SessionKind, stage: Stage) -> Self {
        let layers = Self::of_stage(stage);
        match kind {
            SessionKind::Solid => Self(layers.0 | 1 << Layer::Disks as u32),
            SessionKind::Run
            | SessionKind::Exact
            | SessionKind::Combination
            | SessionKind::Nested
            | SessionKind::Varying => layers,
        }
    }

    /// Returns the layers of any stage.
    #[must_use]
    pub fn of_any_stage() -> Self {
        Self(Self::default().0 | Self::of_stage(Stage::Blocks).0 | Self::of_stage(Stage::Tile).0)
    }

    /// Returns whether `layer` is on.
    #[must_use]
    pub const fn has(self, layer: Layer) -> bool {
        self.0 & 1 << layer as u32 != 0
    }

    /// Returns the layers that are on, in the order of the chips.
    pub fn iter(self) -> impl Iterator<Item = Layer> {
        Layer::ALL.into_iter().filter(move |&layer| self.has(layer))
    }

    /// Returns whether a layer is on that shows what the disks of the moment leave uncovered, or its triangulation.
    #[must_use]
    pub fn wants_geometry(self) -> bool {
        self.has_gaps() || self.has_net()
    }

    /// Returns those that a stage shows. The layers of nets need samples, which there are from tiling on. Gaps are shown from
    /// elimination on, since a block without samples during tiling is no gap.
    #[must_use]
    pub fn drawn_at(self, stage: Stage) -> Self {
        let is_drawn = |layer: &Layer| match layer {
            Layer::Gaps => stage >= Stage::Eliminate,
            layer => stage >= Stage::Tile || !Layer::NETS.contains(layer),
        };
        let drawn = self.iter().filter(is_drawn);
        Self(drawn.fold(0, |bits, layer| bits | 1 << layer as u32))
    }

    /// Returns whether a layer is on that shows what the disks leave uncovered.
    #[must_use]
    pub fn has_gaps(self) -> bool {
        self.has(Layer::Gaps) || self.has(Layer::CoveredCircles)
    }

    /// Returns whether a layer is on that needs the triangulation of the moment: covered circles and gaps do without.
    #[must_use]
    pub fn has_net(self) -> bool {
        self.has(Layer::Delaunay) || self.has(Layer::Voronoi) || self.has(Layer::Circumcircles)
    }

    /// Returns those that a kind of session has.
    #[must_use]
    pub fn of_kind(self, kind: SessionKind) -> Self {
        let own = self.iter().filter(|layer| layer.is_of(kind));
        Self(own.fold(0, |bits, layer| bits | 1 << layer as u32))
    }

    /// Returns those other than one layer.
    #[must_use]
    pub const fn without(self, layer: Layer) -> Self {
        Self(self.0 & !(1 << layer as u32))
    }

    /// Returns those that `others` has, too.
    #[must_use]
    pub const fn within(self, others: Self) -> Self {
        Self(self.0 & others.0)
    }

    /// Returns the set without any layer.
    #[must_use]
    pub const fn none() -> Self {
        Self(0)
    }

    /// Switches a layer on or off.
    pub const fn toggle(&mut self, layer: Layer) {
        self.0 ^= 1 << layer as u32;
    }
}

/// The property of a sample that its colour shows.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Colouring {
    /// The block it was tiled into.
    #[default]
    Block,
    /// Where it comes from: its block, the margin around it, or an insertion.
    Provenance,
    /// When it came: tiled early to late, then iteration by iteration. Of nested levels its place in the order.
    Age,
    /// The level that added it.
    Level,
    /// How far it lies above the plane, or below it. Only sets in space have it.
    Depth,
}

impl Colouring {
    /// Returns this colouring, or the one that a kind of session has in its place: nested levels have no blocks, others no
    /// levels, and only sets in space a depth.
    #[must_use]
    pub const fn of(self, kind: SessionKind) -> Self {
        match (self, kind) {
            (Self::Block | Self::Provenance | Self::Depth, SessionKind::Nested) => Self::Level,
            (
                Self::Level | Self::Depth,
                SessionKind::Run | SessionKind::Exact | SessionKind::Combination,
            ) => Self::Block,
            // All samples are inserted, and what tells them apart is when,
            (_, SessionKind::Varying) | (Self::Age, SessionKind::Solid) => Self::Age,
            // or, in space, what the plane does not show: on which side of it they lie.
            (_, SessionKind::Solid) => Self::Depth,
            _ => self,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_toggle_changes_one_layer() {
        let before = Layers::default();
        for layer in Layer::ALL {
            let mut after = before;
            after.toggle(layer);
            for other in Layer::ALL {
                assert_eq!(after.has(other) != before.has(other), other == layer);
            }
        }
    }
}
