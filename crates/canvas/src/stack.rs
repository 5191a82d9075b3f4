//! The parts of a frame from bottom to top, each drawn by the GPU if it has the samples, else as meshes.

use egui::Painter;
use tilescope_core::Stage;
use tilescope_drawing::looks::Looks;
use tilescope_drawing::parts::Part;
use tilescope_drawing::scene::Scene;
use tilescope_session::layers::Layer;

use crate::MAX_SYMBOLS;
use crate::brushed::Edges;
use crate::resident::Resident;
use crate::sheet::Sheet;
use crate::sprites::Sprites;
use crate::strokes::KeptShapes;

/// Parts drawn when there are too many samples for symbols. Samples, perhaps as points, lie below lines.
const OF_CROWD: [Part; 14] = [
    Part::Field,
    Part::Outside,
    Part::Outline,
    Part::Tints,
    Part::Band,
    Part::Disks,
    Part::Samples,
    Part::Borders,
    Part::Numbers,
    Part::Seams,
    Part::Tree,
    Part::TreeNumbers,
    Part::Selection,
    Part::Inset,
];

/// Returns whether a part's shapes can be cached. Text cannot: its glyphs may move in the font texture.
const fn is_kept(part: Part) -> bool {
    !matches!(
        part,
        Part::Numbers | Part::TreeNumbers | Part::Step | Part::Selection | Part::Inset
    )
}

/// Returns whether a part belongs to the triangulation.
const fn is_net(part: Part) -> bool {
    matches!(
        part,
        Part::Delaunay
            | Part::Voronoi
            | Part::Circumcircles
            | Part::CoveredCircles
            | Part::GapBorders
    )
}

/// The parts of one frame.
pub struct Stack<'a, K> {
    pub painter: &'a Painter,
    pub scene: &'a Scene<'a>,
    pub looks: &'a Looks<'a>,
    pub sprites: &'a mut Sprites,
    pub kept: &'a mut KeptShapes<K>,
    /// The edges of brushed pairs.
    pub edges: &'a Edges,
    /// The samples on the GPU, if it has them.
    pub resident: Option<&'a Resident>,
}

impl<K: PartialEq> Stack<'_, K> {
    /// Returns whether there are too many samples in view for symbols.
    pub fn is_crowded(&self) -> bool {
        let scene = self.scene;
        let as_points = self
            .resident
            .is_some_and(|resident| resident.shows_points(self.painter, scene));
        as_points || scene.count_in_view() > MAX_SYMBOLS
    }

    /// Returns whether a crowd's samples are drawn as points, if at all.
    pub fn draws_points(&self) -> bool {
        let scene = self.scene;
        // Without the GPU one picture shows the samples of all origins, by the layer of samples alone (see `crowd`). The
        // GPU shows each by the layer of its origin.
        self.resident.map_or_else(
            || scene.has(Layer::Samples),
            |resident| {
                (scene.has(Layer::Samples) || scene.has(Layer::Inserted))
                    && resident.shows_points(self.painter, scene)
            },
        )
    }

    /// Draws the parts shown where every sample has its symbol.
    pub fn all(&mut self) {
        // Consecutive parts of the triangulation are drawn on one sheet: their edges are one mesh, which is copied
        // once.
        for parts in Part::ALL.chunk_by(|a, b| is_net(*a) && is_net(*b)) {
            self.parts(parts);
        }
    }

    /// Draws the parts shown of a crowd; `points` draws samples as points.
    pub fn crowd(&mut self, points: impl FnOnce()) {
        let mut points = Some(points);
        for part in OF_CROWD {
            match (part, self.resident) {
                // A crowd's disks are drawn by the GPU alone, and by it only if all have one radius.
                (Part::Disks, None) => {}
                (Part::Disks, Some(_)) if self.scene.session.has_own_disks() => {}
                (Part::Samples, None) => {
                    if let Some(points) = points.take().filter(|_| self.scene.has(Layer::Samples)) {
                        points();
                    }
                }
                _ => self.parts(&[part]),
            }
        }
    }

    /// Draws one part, or several of the triangulation on one sheet, clipped as the first of them that is on. They are
    /// either all cached or none.
    fn parts(&mut self, parts: &[Part]) {
        let scene = self.scene;
        let on = || parts.iter().copied().filter(|part| part.is_on(scene));
        let Some(part) = on().next() else {
            return;
        };

        let painter = &self.painter.with_clip_rect(part.clip(scene));
        // The GPU draws disks and samples itself, without shapes.
        match (part, self.resident) {
            // The GPU's disks have one radius.
            (Part::Disks, Some(resident)) if !scene.session.has_own_disks() => {
                return resident.disks(painter, scene);
            }
            (Part::Samples, Some(resident)) => return resident.symbols(painter, scene),
            _ => {}
        }

        let (looks, edges) = (self.looks, self.edges);
        let sprites = &mut *self.sprites;
        let mut make = || {
            let mut sheet = Sheet::new(painter, sprites);
            for part in on() {
                match part {
                    Part::Pairs => edges.draw(scene, &mut sheet),
                    part => part.draw(scene, looks, &mut sheet),
                }
            }
            sheet.into_shapes()
        };

        let shapes = if is_kept(part) {
            self.kept.layer(part as usize, make)
        } else {
            make()
        };
        painter.extend(shapes);
    }
}

/// Returns a remark on layers that are left out or simplified at this scale, if any are. `crowded` says that there are
/// too many samples in view for symbols, and `as_points` that they are points instead.
pub fn note(scene: &Scene<'_>, crowded: bool, as_points: bool) -> Option<String> {
    let has = |layer| scene.has(layer);
    if crowded && as_points {
        let others = if scene.session.has_stages() && has(Layer::Eliminated) {
            ", eliminated ones left out"
        } else {
            ""
        };
        return Some(format!(
            "Too many samples in view to tell apart: drawn as points{others}. Zoom in."
        ));
    }

    if crowded && leaves_out(scene) {
        let most = tilescope_session::words::grouped(MAX_SYMBOLS);
        return Some(format!(
            "More than {most} samples in view: conflicts, detectors, candidates and triangles are left out. Zoom in."
        ));
    }

    (!scene.is_fine() && (has(Layer::Disks) || has(Layer::Gaps)))
        .then(|| "Zoom in to see disks and gaps.".to_owned())
}

/// Returns whether a layer is on that is hidden in a crowd and would show something at this stage.
fn leaves_out(scene: &Scene<'_>) -> bool {
    let has = |layer| scene.has(layer);
    let by_stage = match scene.stage {
        Stage::Tile => has(Layer::Conflicts),
        Stage::Eliminate => has(Layer::Conflicts) || has(Layer::Detectors),
        Stage::Iterate(_) if scene.session.is_exact() => {
            has(Layer::Conflicts) || has(Layer::Detectors) || has(Layer::Candidates)
        }
        Stage::Iterate(_) => has(Layer::Detectors) || has(Layer::Candidates),
        _ => false,
    };
    by_stage || scene.stage >= Stage::Tile && Layer::NETS.into_iter().any(has)
}
