//! Pictures of sets and of the stages of a run, with the colours and marks of the window.
//! They show a run as it stood after a stage, and compute nothing of it.

use std::convert::Infallible;

use glam::DVec2;
use tilescope_core::{Boundary, Origin, Parameters, Point, Run, Search, Stage, Standing, Variant};

use crate::canvas::{Canvas, PictureOptions};
use crate::control::{Control, Steps};
use crate::error::FigureError;
use crate::palette::with_alpha;
use crate::scene::{Fill, Marker, Rect, Scene, Shape, Stroke, Style};

/// A set to draw without its run.
#[derive(Clone, Debug)]
pub struct SetPicture<'a> {
    /// Positions in user units.
    pub points: &'a [[f64; 2]],
    /// Width and height of the domain in user units.
    pub size: [f64; 2],
    /// How the domain ends.
    pub boundary: Boundary,
    /// Radius of the disks, if known.
    pub radius: Option<f64>,
    /// Building blocks in user units, if known.
    pub blocks: Vec<Rect>,
    /// The block of each sample, where known; a sample without one was inserted.
    pub block_of: Option<Vec<Option<u32>>>,
    /// Parts of the circles around samples that lie in no other disk: the sample's index, and where the part begins and ends,
    /// as angles from the x axis, anticlockwise, in radians.
    pub exposed: Vec<(usize, [f64; 2])>,
    /// A line above the picture.
    pub caption: String,
}

/// Returns the picture of a point set.
#[must_use]
pub fn set_scene(set: &SetPicture<'_>, options: &PictureOptions) -> Scene {
    let Ok(scene) = laid_out::<Infallible>(set, options, &mut || Ok(()));
    scene
}

/// Returns the picture of a point set. Calls `control` while samples are laid out.
///
/// # Errors
///
/// [`FigureError::Cancelled`] when `control` breaks.
pub fn set_scene_controlled(
    set: &SetPicture<'_>,
    options: &PictureOptions,
    control: Control<'_>,
) -> Result<Scene, FigureError> {
    // Disks, where they are drawn, and marks.
    let mut steps = Steps::new(2 * set.points.len(), control);
    laid_out(set, options, &mut || steps.shape())
}

/// Calls `step` for each sample of each layer, and fails as it does.
fn laid_out<E>(
    set: &SetPicture<'_>,
    options: &PictureOptions,
    step: &mut dyn FnMut() -> Result<(), E>,
) -> Result<Scene, E> {
    let mut canvas = Canvas::new(
        set.size.into(),
        set.boundary,
        set.radius.unwrap_or(0.0),
        options,
    );
    canvas.blocks(set.blocks.iter().copied());
    let points: Vec<DVec2> = set.points.iter().copied().map(DVec2::from).collect();

    if let Some(style) = canvas.ring(Some(Fill::Solid(options.palette.disk_fill))) {
        let mut disks = canvas.group("disks");
        for point in &points {
            step()?;
            disks
                .shapes
                .extend(canvas.disks(std::slice::from_ref(point), style));
        }
        canvas.push([disks]);
    }

    let mut samples = canvas.group("samples");
    let mut inserted = canvas.group("inserted");
    for (index, &point) in points.iter().enumerate() {
        step()?;
        let block = set.block_of.as_ref().map(|of| of[index]);
        match block {
            Some(None) => canvas.mark(&mut inserted, Marker::Diamond, point, canvas.inserted()),
            _ => canvas.mark(
                &mut samples,
                Marker::Dot,
                point,
                canvas.dot(block.flatten()),
            ),
        }
    }
    canvas.push([samples, inserted]);

    canvas.arcs(&points, &set.exposed);
    Ok(canvas.finish(&set.caption))
}

/// Returns the picture of a run after `stage`.
#[must_use]
pub fn stage_scene(run: &Run, stage: Stage, options: &PictureOptions) -> Scene {
    let domain = &run.domain;
    if stage == Stage::Pattern {
        return pattern_scene(run, options);
    }
    let mut canvas = Canvas::new(
        domain.size().into(),
        domain.boundary(),
        domain.radius(),
        options,
    );
    if stage <= Stage::Tile {
        canvas.blocks(blocks(run));
    }
    let samples = standings(run, stage);
    if stage >= Stage::Eliminate {
        let valid = samples
            .iter()
            .filter(|(.., standing)| *standing == Standing::Valid);
        let valid: Vec<DVec2> = valid.map(|(at, ..)| *at).collect();
        canvas.coverage(&valid);
        canvas.block_borders(blocks(run));
    }
    if stage == Stage::Tile {
        canvas.conflicts(run);
    }
    canvas.standings(run, stage, &samples);
    canvas.finish(&caption(run, stage))
}

fn pattern_scene(run: &Run, options: &PictureOptions) -> Scene {
    let domain = run.pattern.domain();
    let points = domain.users_from_lattice(run.pattern.samples());
    let set = SetPicture {
        points: &points,
        size: domain.size(),
        boundary: domain.boundary(),
        radius: Some(domain.radius()),
        blocks: Vec::new(),
        block_of: None,
        exposed: Vec::new(),
        caption: caption(run, Stage::Pattern),
    };
    set_scene(
        &set,
        &PictureOptions {
            window: None,
            ..options.clone()
        },
    )
}

fn blocks(run: &Run) -> impl Iterator<Item = Rect> {
    let user = |p: Point| run.domain.user_from_lattice(p);
    run.blocks
        .leaves
        .iter()
        .map(move |b| Rect::new(user(b.rect.min), user(b.rect.max)))
}

/// Returns a square part of a run's domain, `radii` wide, around the corner of a block that is
/// nearest to the domain's middle: the place where most happens.
#[must_use]
pub fn seam_window(run: &Run, radii: f64) -> Rect {
    let middle = DVec2::from(run.domain.size()) / 2.0;
    let from_middle = |p: &DVec2| (p.x - middle.x).hypot(p.y - middle.y);
    let corner = blocks(run)
        .map(|rect| rect.min)
        .min_by(|a, b| from_middle(a).total_cmp(&from_middle(b)));
    let corner = corner.unwrap_or(middle);
    Rect::new(corner, corner).padded(0.5 * radii * run.domain.radius())
}

/// Returns one line that says what a stage did.
#[must_use]
pub fn caption(run: &Run, stage: Stage) -> String {
    let s = run.summary();
    let side = f64::from(run.pattern.domain().width()) / f64::from(tilescope_core::R);
    let glued = is_combination(run);
    match stage {
        Stage::Blocks if glued => format!("{} pieces, each a maximal set of its own", s.blocks),
        Stage::Tile if glued => format!(
            "Each piece brings its set, up to r beyond its rectangle: {} samples",
            s.tiled
        ),
        Stage::Pattern => format!(
            "The pattern: {} samples on {side:.1} r, maximal, made once",
            run.pattern.samples().len()
        ),
        Stage::Blocks => format!(
            "{} building blocks: the leaves of a random KD-tree",
            s.blocks
        ),
        Stage::Tile => format!(
            "Each block receives a clip of the pattern: {} samples",
            s.tiled
        ),
        Stage::Eliminate => {
            format!(
                "{} samples in conflict are eliminated; gaps (hatched) remain",
                s.eliminated
            )
        }
        Stage::Iterate(k) => {
            let n = s.inserted.get(k as usize - 1).copied().unwrap_or(0);
            format!("Iteration {k} inserts {n} samples into the gaps")
        }
        Stage::Regions | Stage::Finish => {
            let Parameters {
                search, variant, ..
            } = run.parameters;
            // Results of other searches and variants are not proved; the verifier judges them.
            let proved = match (search, variant) {
                (Search::Complete, Variant::Staged) => ", maximal and conflict-free",
                _ => "",
            };
            format!("The result: {} samples{proved}", s.count)
        }
    }
}

/// Returns whether a run's blocks are the pieces of a combination, which no tree split.
fn is_combination(run: &Run) -> bool {
    run.blocks.splits.len() + 1 < run.blocks.leaves.len()
}

/// Returns where samples are after a stage, their ids, and how they stand, but not those that are absent or dropped.
fn standings(run: &Run, stage: Stage) -> Vec<(DVec2, u32, Standing)> {
    let samples = (0..).zip(&run.samples.points);
    let samples = samples.map(|(id, &point)| {
        let at = run.domain.user_from_lattice(point).into();
        (at, id, run.standing(id, stage))
    });
    let gone = |standing: &Standing| matches!(standing, Standing::Absent | Standing::Dropped);
    samples.filter(|(.., standing)| !gone(standing)).collect()
}

impl Canvas<'_> {
    fn conflicts(&mut self, run: &Run) {
        let mut group = self.group("conflicts");
        let stroke = Stroke::new(self.palette().conflict, self.line_px() * 1.4).dashed(4.0, 2.0);
        let mut segments = Vec::new();
        for id in 0..run.samples.len() as u32 {
            let Standing::Eliminated { by } = run.standing(id, Stage::Finish) else {
                continue;
            };
            let (a, b) = (
                run.samples.points[id as usize],
                run.samples.points[by as usize],
            );
            let from = DVec2::from(run.domain.user_from_lattice(a));
            let to = from + run.domain.difference(a, b).as_dvec2() * run.domain.unit();
            segments.push([from, to].map(|end| self.flip(end)));
        }
        if !segments.is_empty() {
            group.shapes.push(Shape::Segments { segments, stroke });
        }
        self.push([group]);
    }

    fn standings(&mut self, run: &Run, stage: Stage, standings: &[(DVec2, u32, Standing)]) {
        let names = ["eliminated", "samples", "detectors", "inserted"];
        let [mut eliminated, mut samples, mut rings, mut inserted] = names.map(|n| self.group(n));
        let cross = Style::stroked(with_alpha(self.palette().eliminated, 200), self.line_px());
        for &(point, id, standing) in standings {
            let now = matches!(stage, Stage::Iterate(k) if is_inserted(run, id, Some(k)));
            match standing {
                Standing::Eliminated { .. } if stage == Stage::Eliminate => {
                    self.mark(&mut eliminated, Marker::Cross, point, cross);
                }
                Standing::Eliminated { .. } => {}
                _ if now || (stage == Stage::Finish && is_inserted(run, id, None)) => {
                    self.mark(&mut inserted, Marker::Diamond, point, self.inserted());
                }
                _ => self.mark(
                    &mut samples,
                    Marker::Dot,
                    point,
                    self.dot(block_of(run, id)),
                ),
            }
        }
        if let Stage::Iterate(k) = stage {
            let style = Style::stroked(self.palette().detector, self.line_px() * 1.5);
            for &id in &run.iterations[k as usize - 1].detectors {
                let point = run
                    .domain
                    .user_from_lattice(run.samples.points[id as usize]);
                for image in self.images(point.into()) {
                    let at = self.flip(image);
                    rings
                        .shapes
                        .push(Shape::marker(Marker::Dot, at, self.dot_px() * 2.0, style));
                }
            }
        }
        self.push([eliminated, rings, samples, inserted]);
    }
}

fn is_inserted(run: &Run, id: u32, by: Option<u32>) -> bool {
    match run.samples.origins[id as usize] {
        Origin::Inserted { iteration, .. } => by.is_none_or(|k| k == iteration),
        Origin::Tiled { .. } => false,
    }
}

fn block_of(run: &Run, id: u32) -> Option<u32> {
    match run.samples.origins[id as usize] {
        Origin::Tiled { block, .. } => Some(block),
        Origin::Inserted { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use tilescope_core::{Unobserved, sample};

    use super::*;
    use crate::to_pixels;

    fn run() -> Run {
        let parameters = Parameters {
            radius: 0.02,
            leaf: 12.0,
            ..Parameters::default()
        };
        sample(&parameters, &mut Unobserved).unwrap()
    }

    /// Pixels of a stage's picture that are nearer to the gap's colour than to any other.
    fn gap_pixels(run: &Run, stage: Stage) -> usize {
        let options = PictureOptions {
            width: 500.0,
            disks: false,
            ..PictureOptions::default()
        };
        let scene = stage_scene(run, stage, &options);
        let pixels = to_pixels(&scene, 1.0).unwrap();
        let gap = options.palette.gap;
        let is_gap = |p: &[u8]| (0..3).all(|k| p[k].abs_diff(gap[k]) < 50);
        pixels.rgba.chunks_exact(4).filter(|p| is_gap(p)).count()
    }

    #[test]
    fn gaps_are_seen_after_elimination_and_gone_in_the_end() {
        let run = run();
        assert!(gap_pixels(&run, Stage::Eliminate) > 30);
        assert!(gap_pixels(&run, Stage::Iterate(1)) < gap_pixels(&run, Stage::Eliminate));
        assert_eq!(gap_pixels(&run, Stage::Finish), 0);
    }

    #[test]
    fn every_stage_has_a_picture_of_its_own_with_a_caption() {
        let run = run();
        let scenes: Vec<Scene> = run
            .stages()
            .into_iter()
            .map(|stage| stage_scene(&run, stage, &PictureOptions::default()))
            .collect();
        assert!(scenes.len() >= 6);
        for (k, scene) in scenes.iter().enumerate() {
            assert!(scene.validate().is_ok());
            assert!(!scene.title.is_empty());
            assert!(scenes[k + 1..].iter().all(|other| other != scene));
        }
    }

    #[test]
    fn a_caption_claims_what_is_proved() {
        let mut run = run();
        assert!(caption(&run, Stage::Finish).contains("maximal and conflict-free"));
        run.parameters.search = Search::TwoRadii;
        assert!(!caption(&run, Stage::Finish).contains("maximal"));
    }

    #[test]
    fn a_conflict_joins_the_two_samples_by_the_shortest_way() {
        let run = run();
        let scene = stage_scene(&run, Stage::Tile, &PictureOptions::default());
        let conflicts = scene.groups.iter().find(|g| g.name == "conflicts").unwrap();
        let Shape::Segments { segments, .. } = &conflicts.shapes[0] else {
            panic!("segments")
        };
        assert_eq!(segments.len(), run.summary().eliminated);
        for [a, b] in segments {
            assert!(a.distance(*b) <= run.domain.radius() * 1.0001);
        }
    }

    #[test]
    fn the_seam_window_has_its_width_and_shows_a_corner() {
        let run = run();
        let window = seam_window(&run, 8.0);
        assert!((window.size().x - 0.16).abs() < 1e-12);
        let inside = |p: DVec2| (window.min.cmplt(p) & p.cmplt(window.max)).all();
        assert!(blocks(&run).any(|rect| inside(rect.min)));
    }
}
