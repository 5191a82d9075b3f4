//! The sequence of the layers, from the ground up, and who draws each: the GPU where samples are on it, meshes else.

use egui::{Painter, Rect, Shape};
use tilescope_core::Stage;
use tilescope_session::layers::Layer;

use super::brushed::Edges;
use super::paint::Scene;
use super::resident::Resident;
use super::sprites::Sprites;
use super::strokes::Kept;
use super::{MAX_SYMBOLS, MIN_DISK_SCALE, blocks, geometry, now, seams, symbols, tree};
use tilescope_drawing::looks::Looks;

/// What is kept as meshes from frame to frame.
#[derive(Clone, Copy)]
enum Part {
    Tints,
    Geometry,
    Disks,
    Borders,
    Tree,
    Clips,
    Conflicts,
    Brushed,
    Samples,
    Search,
    Band,
    Seams,
}

/// The layers of one frame.
pub struct Stack<'a, K> {
    pub scene: &'a Scene<'a>,
    pub looks: &'a Looks<'a>,
    pub sprites: &'a mut Sprites,
    pub kept: &'a mut Kept<K>,
    /// The edges of brushed pairs.
    pub edges: &'a Edges,
    /// The samples on the GPU, if it has them.
    pub resident: Option<&'a Resident>,
}

impl<K: PartialEq> Stack<'_, K> {
    /// Returns whether there is more in view than can be shown symbol by symbol.
    pub fn is_crowded(&self) -> bool {
        let scene = self.scene;
        let as_points = self
            .resident
            .is_some_and(|resident| resident.shows_points(scene));
        as_points || scene.session.index.count_in(scene.low, scene.high) > MAX_SYMBOLS
    }

    /// Returns whether a crowd's samples are drawn as points, if they are drawn.
    pub fn draws_points(&self) -> bool {
        let scene = self.scene;
        self.resident.map_or_else(
            || scene.has(Layer::Samples),
            |resident| {
                (scene.has(Layer::Samples) || scene.has(Layer::Inserted))
                    && resident.shows_points(scene)
            },
        )
    }

    /// Tints the blocks.
    pub fn tints(&mut self) {
        if self.scene.has(Layer::Blocks) {
            self.keep(Part::Tints, self.scene.painter, |s| blocks::tints(s.scene));
        }
        if self.scene.session.combination.is_some() {
            self.keep(Part::Band, self.scene.painter, |s| seams::band(s.scene));
        }
    }

    /// Draws all symbols and lines.
    pub fn all(&mut self) {
        let scene = self.scene;
        self.geometry();
        self.disks();
        self.borders();
        if scene.has(Layer::Pattern) {
            self.keep(Part::Clips, scene.painter, |s| {
                blocks::clips(s.scene, s.sprites)
            });
        }
        if scene.has(Layer::Conflicts) {
            self.keep(Part::Conflicts, scene.painter, |s| {
                symbols::conflicts(s.scene, s.sprites)
            });
        }
        let edges = self.edges;
        self.keep(Part::Brushed, scene.painter, |s| {
            edges.shapes(s.scene, s.sprites)
        });
        match self.resident {
            Some(resident) => resident.symbols(scene),
            None => self.keep(Part::Samples, scene.painter, |s| {
                symbols::samples(s.scene, s.looks, s.sprites)
            }),
        }
        self.keep(Part::Search, scene.painter, |s| {
            symbols::search(s.scene, s.sprites)
        });
        if scene.has(Layer::Tree) {
            tree::numbers(scene);
        }
        now::paint(scene);
        symbols::highlight(scene, self.sprites);
    }

    /// Draws what can be shown of a crowd; `points` is called where samples are to be drawn as a picture of points.
    pub fn crowd(&mut self, points: impl FnOnce(&Scene<'_>)) {
        let scene = self.scene;
        match self.resident {
            Some(resident) => {
                self.disks();
                resident.symbols(scene);
            }
            None if scene.has(Layer::Samples) => points(scene),
            None => {}
        }
        self.borders();
        if scene.has(Layer::Tree) {
            tree::numbers(scene);
        }
        symbols::highlight(scene, self.sprites);
    }

    fn geometry(&mut self) {
        let scene = self.scene;
        let tessellation = scene.subject.geometry.of(&scene.shown);
        if let Some(tessellation) = tessellation.filter(|_| scene.stage >= Stage::Tile) {
            let painter = scene.painter.with_clip_rect(self.clip());
            self.keep(Part::Geometry, &painter, |s| {
                geometry::shapes(s.scene, tessellation, s.sprites)
            });
        }
    }

    fn disks(&mut self) {
        let scene = self.scene;
        let fine = scene.subject.camera.scale >= MIN_DISK_SCALE;
        if !(fine && scene.has(Layer::Disks) && scene.stage >= Stage::Tile) {
            return;
        }
        let clip = self.clip();
        match self.resident {
            Some(resident) => resident.disks(scene, clip),
            None => self.keep(Part::Disks, &scene.painter.with_clip_rect(clip), |s| {
                symbols::disks(s.scene, s.looks, s.sprites)
            }),
        }
    }

    fn borders(&mut self) {
        if self.scene.has(Layer::Blocks) {
            self.keep(Part::Borders, self.scene.painter, |s| {
                blocks::borders(s.scene)
            });
            blocks::numbers(self.scene);
        }
        if self.scene.session.combination.is_some() {
            self.keep(Part::Seams, self.scene.painter, |s| {
                seams::lines(s.scene, s.sprites)
            });
        }
        if self.scene.has(Layer::Tree) {
            self.keep(Part::Tree, self.scene.painter, |s| {
                tree::lines(s.scene, s.sprites)
            });
        }
    }

    /// Returns where what reaches over the border of a periodic domain is seen: within it, as it comes in again at the
    /// other side.
    fn clip(&self) -> Rect {
        let scene = self.scene;
        if scene.session.run().domain.is_periodic() {
            let domain = scene.screen_rect([0.0; 2], scene.session.size_radii());
            domain.intersect(scene.rect)
        } else {
            scene.rect
        }
    }

    fn keep(
        &mut self,
        part: Part,
        painter: &Painter,
        make: impl FnOnce(&mut Makers<'_>) -> Vec<Shape>,
    ) {
        let mut makers = Makers {
            scene: self.scene,
            looks: self.looks,
            sprites: self.sprites,
        };
        painter.extend(self.kept.layer(part as usize, || make(&mut makers)));
    }
}

/// What layers are made from.
struct Makers<'a> {
    scene: &'a Scene<'a>,
    looks: &'a Looks<'a>,
    sprites: &'a mut Sprites,
}

/// Returns a remark about what is left out or simplified at this scale.
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
    let coarse = scene.subject.camera.scale < MIN_DISK_SCALE;
    (coarse && (has(Layer::Disks) || has(Layer::Gaps)))
        .then(|| format!("Disks and gaps appear from {MIN_DISK_SCALE} points per r: zoom in."))
}

/// Returns whether a layer is on that a crowd hides and that would show something at this stage.
fn leaves_out(scene: &Scene<'_>) -> bool {
    let has = |layer| scene.has(layer);
    let by_stage = match scene.stage {
        Stage::Tile => has(Layer::Conflicts),
        Stage::Eliminate => has(Layer::Conflicts) || has(Layer::Detectors),
        Stage::Iterate(_) => has(Layer::Detectors) || has(Layer::Candidates),
        _ => false,
    };
    let net = [Layer::Delaunay, Layer::Voronoi, Layer::Circumcircles];
    by_stage || scene.stage >= Stage::Tile && net.into_iter().any(has)
}
