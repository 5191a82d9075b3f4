//! Pictures of sets and of the stages of a run, in the visual language that the window shares.
//! They show a run as it stood after a stage; they never compute one.

use tilescope_core::{Boundary, Domain, Origin, Point, Run, Stage, Standing};

use crate::palette::{Palette, with_alpha};
use crate::scene::{
    Anchor, Baseline, Fill, Group, Hatch, Marker, Rect, Scene, Shape, Stroke, Style, Text, View,
};

/// Height of the caption, in pixels at a picture width of 1000.
const CAPTION: f64 = 44.0;

/// Disks of a smaller radius in pixels are left out.
const SMALLEST_DISK: f64 = 12.0;

/// How a picture looks.
#[derive(Clone, Debug)]
pub struct PictureOptions {
    /// Width of the picture in pixels; the height follows from the domain or the window.
    pub width: f64,
    /// Colours.
    pub palette: Palette,
    /// The part of the domain that is shown, in user units; `None` shows it whole.
    pub window: Option<Rect>,
    /// Whether disks are drawn.
    pub disks: bool,
}

impl Default for PictureOptions {
    fn default() -> Self {
        Self {
            width: 1200.0,
            palette: Palette::LIGHT,
            window: None,
            disks: true,
        }
    }
}

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
    /// A line above the picture.
    pub caption: String,
}

/// Returns the picture of a point set.
#[must_use]
pub fn set_scene(set: &SetPicture<'_>, options: &PictureOptions) -> Scene {
    let mut canvas = Canvas::new(set.size, set.boundary, set.radius.unwrap_or(0.0), options);
    canvas.blocks(set.blocks.iter().copied());
    canvas.rings(set.points, Some(Fill::Solid(options.palette.disk_fill)));
    let mut samples = canvas.group("samples");
    let mut inserted = canvas.group("inserted");
    for (index, &point) in set.points.iter().enumerate() {
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
    canvas.finish(&set.caption)
}

/// Returns the picture of a run after `stage`.
#[must_use]
pub fn stage_scene(run: &Run, stage: Stage, options: &PictureOptions) -> Scene {
    let domain = &run.domain;
    if stage == Stage::Pattern {
        return pattern_scene(run, options);
    }
    let mut canvas = Canvas::new(domain.size(), domain.boundary(), domain.radius(), options);
    if stage <= Stage::Tile {
        canvas.blocks(blocks(run));
    }
    let samples = Standings::of(run, stage);
    if stage >= Stage::Eliminate {
        canvas.coverage(&samples.valid());
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
    let user = |p: &Point| domain.user_from_lattice(*p);
    let points: Vec<[f64; 2]> = run.pattern.samples().iter().map(user).collect();
    let set = SetPicture {
        points: &points,
        size: domain.size(),
        boundary: domain.boundary(),
        radius: Some(domain.radius()),
        blocks: Vec::new(),
        block_of: None,
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
    let size = run.domain.size();
    let from_middle = |p: &[f64; 2]| (p[0] - size[0] / 2.0).hypot(p[1] - size[1] / 2.0);
    let corner = blocks(run)
        .map(|rect| rect.min)
        .min_by(|a, b| from_middle(a).total_cmp(&from_middle(b)));
    let half = 0.5 * radii * run.domain.radius();
    let [x, y] = corner.unwrap_or([size[0] / 2.0, size[1] / 2.0]);
    Rect::new([x - half, y - half], [x + half, y + half])
}

/// Returns one line that says what a stage did.
#[must_use]
pub fn caption(run: &Run, stage: Stage) -> String {
    let s = run.summary();
    let side = f64::from(run.pattern.domain().width()) / f64::from(tilescope_core::R);
    match stage {
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
        Stage::Finish => format!("The result: {} samples, maximal and conflict-free", s.count),
    }
}

/// Samples by how they stand after a stage.
struct Standings {
    rows: Vec<([f64; 2], u32, Standing)>,
}

impl Standings {
    fn of(run: &Run, stage: Stage) -> Self {
        let rows = (0..run.samples.len() as u32)
            .map(|id| (run.samples.points[id as usize], id, run.standing(id, stage)))
            .filter(|(_, _, standing)| !matches!(standing, Standing::Absent | Standing::Dropped))
            .map(|(p, id, standing)| (run.domain.user_from_lattice(p), id, standing));
        Self {
            rows: rows.collect(),
        }
    }

    fn valid(&self) -> Vec<[f64; 2]> {
        let valid = |(_, _, standing): &&(_, _, Standing)| *standing == Standing::Valid;
        self.rows.iter().filter(valid).map(|(p, _, _)| *p).collect()
    }
}

/// A scene in the making: user units, y upwards, one frame below a caption.
struct Canvas<'a> {
    options: &'a PictureOptions,
    size: [f64; 2],
    periodic: bool,
    radius: f64,
    shown: Rect,
    frame: Rect,
    view: View,
    scene: Scene,
}

impl<'a> Canvas<'a> {
    fn new(size: [f64; 2], boundary: Boundary, radius: f64, options: &'a PictureOptions) -> Self {
        let whole = Rect::new([0.0; 2], size);
        let shown = options.window.unwrap_or(whole);
        let scale = options.width / 1000.0;
        let margin = 16.0 * scale;
        let top = margin + CAPTION * scale;
        let inner = options.width - 2.0 * margin;
        let height = inner * (shown.max[1] - shown.min[1]) / (shown.max[0] - shown.min[0]);
        let frame = Rect::new([margin, top], [margin + inner, top + height]);
        // The scene's y points down: positions are mirrored about the shown part.
        let view = View::fit(shown, frame);
        let scene = Scene::new(
            options.width,
            top + height + margin,
            options.palette.background,
        );
        let periodic = boundary == Boundary::Periodic;
        Self {
            options,
            size,
            periodic,
            radius,
            shown,
            frame,
            view,
            scene,
        }
    }

    fn palette(&self) -> &'a Palette {
        &self.options.palette
    }

    fn group(&self, name: &str) -> Group {
        Group {
            view: self.view,
            clip: Some(self.frame),
            ..Group::new(name)
        }
    }

    fn push(&mut self, groups: impl IntoIterator<Item = Group>) {
        self.scene
            .groups
            .extend(groups.into_iter().filter(|group| !group.shapes.is_empty()));
    }

    /// Returns a position with y pointing down, within the shown part.
    fn flip(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x, self.shown.min[1] + self.shown.max[1] - y]
    }

    fn flip_rect(&self, rect: Rect) -> Rect {
        let (a, b) = (self.flip(rect.min), self.flip(rect.max));
        Rect::new([a[0], b[1]], [b[0], a[1]])
    }

    /// Returns the images of a disk that touch the shown part.
    fn images(&self, point: [f64; 2]) -> impl Iterator<Item = [f64; 2]> {
        let shifts: &[f64] = if self.periodic {
            &[0.0, -1.0, 1.0]
        } else {
            &[0.0]
        };
        let (size, shown, radius) = (self.size, self.shown, self.radius);
        shifts
            .iter()
            .flat_map(move |dx| {
                shifts
                    .iter()
                    .map(move |dy| [point[0] + dx * size[0], point[1] + dy * size[1]])
            })
            .filter(move |p| {
                (0..2).all(|k| shown.min[k] - radius <= p[k] && p[k] <= shown.max[k] + radius)
            })
    }

    /// Pixels of one radius.
    fn radius_px(&self) -> f64 {
        self.radius * self.view.scale
    }

    /// Width of a sample's dot in pixels.
    fn dot_px(&self) -> f64 {
        let px = self.options.width / 1000.0;
        if self.radius > 0.0 {
            (self.radius_px() * 0.34).clamp(1.0, 9.0 * px)
        } else {
            3.0 * px
        }
    }

    fn line_px(&self) -> f64 {
        (self.radius_px() * 0.05).clamp(0.3, 1.6 * self.options.width / 1000.0)
    }

    fn dot(&self, block: Option<u32>) -> Style {
        let color = match block {
            Some(block) => self.palette().block(block as usize).1,
            None => self.palette().sample,
        };
        Style::filled(color)
    }

    fn inserted(&self) -> Style {
        Style::filled(self.palette().inserted)
    }

    fn mark(&self, group: &mut Group, marker: Marker, point: [f64; 2], style: Style) {
        let size = match marker {
            Marker::Dot => self.dot_px(),
            _ => self.dot_px() * 1.7,
        };
        for image in self.images(point) {
            group
                .shapes
                .push(Shape::marker(marker, self.flip(image), size, style));
        }
    }

    fn blocks(&mut self, blocks: impl Iterator<Item = Rect>) {
        let mut group = self.group("blocks");
        for (index, rect) in blocks.enumerate() {
            let (tint, border) = self.palette().block(index);
            let style = Style::filled(tint).with_stroke(Stroke::new(border, 1.0));
            group.shapes.push(Shape::Rect {
                rect: self.flip_rect(rect),
                style,
            });
        }
        self.push([group]);
    }

    fn block_borders(&mut self, blocks: impl Iterator<Item = Rect>) {
        let mut group = self.group("block borders");
        let stroke = Stroke::new(with_alpha(self.palette().muted, 130), 1.0);
        for rect in blocks {
            let style = Style {
                fill: None,
                stroke: Some(stroke),
            };
            group.shapes.push(Shape::Rect {
                rect: self.flip_rect(rect),
                style,
            });
        }
        self.push([group]);
    }

    /// Draws disks, unless they are so small that their rings would be noise.
    fn rings(&mut self, points: &[[f64; 2]], fill: Option<Fill>) {
        if !self.options.disks || self.radius_px() < SMALLEST_DISK {
            return;
        }
        let mut group = self.group("disks");
        let ring = Stroke::new(with_alpha(self.palette().disk, 110), self.line_px());
        let style = Style {
            fill,
            stroke: Some(ring),
        };
        for &point in points {
            for image in self.images(point) {
                group
                    .shapes
                    .push(Shape::circle(self.flip(image), self.radius, style));
            }
        }
        self.push([group]);
    }

    /// Hatches the domain and lays the disks on top: what stays hatched is a gap, exactly.
    fn coverage(&mut self, points: &[[f64; 2]]) {
        let mut gaps = self.group("gaps");
        let hatch = Hatch {
            color: self.palette().gap,
            spacing: 5.0,
            width: 2.0,
        };
        let rect = self.flip_rect(Rect::new([0.0; 2], self.size));
        let solid = Style::filled(with_alpha(self.palette().gap, 170));
        gaps.shapes.push(Shape::Rect { rect, style: solid });
        let style = Style {
            fill: Some(Fill::Hatch(hatch)),
            stroke: None,
        };
        gaps.shapes.push(Shape::Rect { rect, style });
        let mut disks = self.group("disks");
        let covered = Style::filled(self.palette().background);
        for &point in points {
            for image in self.images(point) {
                disks
                    .shapes
                    .push(Shape::circle(self.flip(image), self.radius, covered));
            }
        }
        self.push([gaps, disks]);
        // Their overlapping fills would veil the gaps.
        self.rings(points, None);
    }

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
            let (dx, dy) = run.domain.difference(a, b);
            let [x, y] = run.domain.user_from_lattice(a);
            let [ux, uy] = unit(&run.domain);
            let to = [x + f64::from(dx) * ux, y + f64::from(dy) * uy];
            segments.push([self.flip([x, y]), self.flip(to)]);
        }
        if !segments.is_empty() {
            group.shapes.push(Shape::Segments { segments, stroke });
        }
        self.push([group]);
    }

    fn standings(&mut self, run: &Run, stage: Stage, standings: &Standings) {
        let names = ["eliminated", "samples", "detectors", "inserted"];
        let [mut eliminated, mut samples, mut rings, mut inserted] = names.map(|n| self.group(n));
        let cross = Style::stroked(with_alpha(self.palette().eliminated, 200), self.line_px());
        for &(point, id, standing) in &standings.rows {
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
                for image in self.images(point) {
                    let at = self.flip(image);
                    rings
                        .shapes
                        .push(Shape::marker(Marker::Dot, at, self.dot_px() * 2.0, style));
                }
            }
        }
        self.push([eliminated, rings, samples, inserted]);
    }

    fn finish(mut self, caption: &str) -> Scene {
        let px = self.options.width / 1000.0;
        let mut group = Group::new("frame");
        let border = Style::stroked(self.palette().line, 1.0 * px);
        group.shapes.push(Shape::Rect {
            rect: self.frame,
            style: border,
        });
        let at = [self.frame.min[0], self.frame.min[1] - 16.0 * px];
        let mut text = Text::new(at, caption, 20.0 * px, self.palette().text);
        text.anchor = Anchor::Start;
        text.baseline = Baseline::Alphabetic;
        group.shapes.push(Shape::Text(text));
        self.push([group]);
        caption.clone_into(&mut self.scene.title);
        self.scene
    }
}

fn unit(domain: &Domain) -> [f64; 2] {
    let [width, height] = domain.size();
    [
        width / f64::from(domain.width()),
        height / f64::from(domain.height()),
    ]
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
