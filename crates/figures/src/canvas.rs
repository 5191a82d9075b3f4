//! A canvas for pictures of samples: user units with y upwards, one frame below a caption. It draws marks, disks and
//! blocks; `set` draws sets with it. Sizes were chosen, not measured, where no reason stands beside them.

use glam::DVec2;
use tilescope_core::Boundary;

use crate::palette::{Color, Palette, with_alpha};
use crate::scene::{Fill, Group, Marker, Rect, Scene, Shape, Stroke, Style, Text, View};

/// Height of the caption, in pixels at a picture width of 1000.
pub(crate) const CAPTION: f64 = 44.0;

/// Margin around the frame, in pixels at a picture width of 1000.
pub(crate) const MARGIN: f64 = 16.0;

/// Disks are left out if all have a smaller radius in pixels: their rings would be noise.
const MIN_DISK: f64 = 12.0;

/// The longest piece of an arc that is drawn as a straight line, in radians.
const ARC_STEP: f64 = 0.1;

/// How a picture looks.
#[derive(Clone, Debug)]
pub struct PictureOptions {
    /// Width of the picture in pixels; the height follows from the domain or the window.
    pub width: f64,
    /// Colours of marks, text and background.
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

/// A scene in the making: user units, y upwards, one frame below a caption.
pub(crate) struct Canvas<'a> {
    pub(crate) options: &'a PictureOptions,
    /// The width and the height of the domain, in user units.
    pub(crate) size: DVec2,
    pub(crate) periodic: bool,
    /// The radius of the disk of the sample that is drawn next: callers set it anew for each sample where radii vary.
    pub(crate) radius: f64,
    /// The part of the domain that is shown, in user units.
    pub(crate) shown: Rect,
    /// The rectangle of the picture that shows it, in pixels.
    pub(crate) frame: Rect,
    view: View,
    scene: Scene,
}

impl<'a> Canvas<'a> {
    /// Returns a canvas without shapes, for a domain of a size in user units.
    pub(crate) fn new(
        size: DVec2,
        boundary: Boundary,
        radius: f64,
        options: &'a PictureOptions,
    ) -> Self {
        let whole = Rect::new([0.0; 2], size);
        let shown = options.window.unwrap_or(whole);

        // Caption and margins are given for a width of 1000, so that pictures of any width look alike.
        let scale = options.width / 1000.0;
        let margin = MARGIN * scale;
        let top = margin + CAPTION * scale;
        let inner = options.width - 2.0 * margin;

        let height = inner * shown.size().y / shown.size().x;
        let frame = Rect::new([margin, top], [margin + inner, top + height]);

        // The scene's y points down. The view keeps that: `flip` mirrors positions within the shown part.
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

    pub(crate) fn palette(&self) -> &'a Palette {
        &self.options.palette
    }

    pub(crate) fn group(&self, name: &str) -> Group {
        Group {
            view: self.view,
            clip: Some(self.frame),
            ..Group::new(name)
        }
    }

    pub(crate) fn push(&mut self, groups: impl IntoIterator<Item = Group>) {
        self.scene
            .groups
            .extend(groups.into_iter().filter(|group| !group.shapes.is_empty()));
    }

    /// Returns a position with y pointing down, within the shown part.
    pub(crate) fn flip(&self, DVec2 { x, y }: DVec2) -> DVec2 {
        DVec2::new(x, self.shown.min.y + self.shown.max.y - y)
    }

    fn flip_rect(&self, rect: Rect) -> Rect {
        let (a, b) = (self.flip(rect.min), self.flip(rect.max));
        Rect::new([a.x, b.y], [b.x, a.y])
    }

    /// Returns the shifts that lead from a place to its images.
    fn shifts(&self) -> impl Iterator<Item = DVec2> + use<> {
        let periods: &[f64] = if self.periodic {
            &[0.0, -1.0, 1.0]
        } else {
            &[0.0]
        };
        let size = self.size;
        let along = move |&dx| periods.iter().map(move |&dy| DVec2::new(dx, dy) * size);
        periods.iter().flat_map(along)
    }

    /// Returns the images of a disk that touch the shown part.
    pub(crate) fn images(&self, point: DVec2) -> impl Iterator<Item = DVec2> + use<> {
        let Rect { min, max } = self.shown.padded(self.radius);
        let images = self.shifts().map(move |shift| shift + point);
        images.filter(move |p| (p.cmpge(min) & p.cmple(max)).all())
    }

    /// Returns the copies of a rectangle that reach into the shown part.
    fn copies(&self, rect: Rect) -> impl Iterator<Item = Rect> + use<> {
        let shown = self.shown;
        let copies =
            (self.shifts()).map(move |shift| Rect::new(shift + rect.min, shift + rect.max));
        copies.filter(move |copy| copy.meets(&shown))
    }

    /// Pixels of one radius.
    pub(crate) fn radius_px(&self) -> f64 {
        self.radius * self.view.scale
    }

    /// Width of a sample's dot in pixels.
    pub(crate) fn dot_px(&self) -> f64 {
        let px = self.options.width / 1000.0;
        // A third of the radius, which leaves neighbours well apart; of few samples no more than a spot, and of many at least
        // a pixel.
        if self.radius > 0.0 {
            (self.radius_px() * 0.34).min(9.0 * px).max(1.0)
        } else {
            3.0 * px
        }
    }

    pub(crate) fn line_px(&self) -> f64 {
        // In a small picture the least width is above the largest, and counts.
        (self.radius_px() * 0.05)
            .min(1.6 * self.options.width / 1000.0)
            .max(0.3)
    }

    pub(crate) fn dot(&self, block: Option<u32>) -> Style {
        let color = match block {
            Some(block) => self.palette().block(block as usize).1,
            None => self.palette().sample,
        };
        Style::filled(color)
    }

    pub(crate) fn inserted(&self) -> Style {
        Style::filled(self.palette().inserted)
    }

    pub(crate) fn mark(&self, group: &mut Group, marker: Marker, point: DVec2, style: Style) {
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

    /// Draws the dot of a sample that lies so many radii of its ball above the plane; `radius` is that of its disk there.
    pub(crate) fn beside_plane(&self, group: &mut Group, point: DVec2, above: f64) {
        let [red, green, blue, _] = self.palette().of_height(above);
        // The farther from the plane, the paler, and the smaller with its disk. A quarter of the strength still shows.
        let strength = (255.0 * (1.0 - 0.75 * above.abs())).round() as u8;
        let style = Style::filled([red, green, blue, strength]);
        self.mark(group, Marker::Dot, point, style);
    }

    /// Draws parts of the circles around points. An arc is given by the index of its point and by its first and last
    /// angle.
    pub(crate) fn arcs(&mut self, points: &[DVec2], arcs: &[(usize, [f64; 2])]) {
        let mut group = self.group("exposed arcs");
        // Wider than the rings of disks, on which they lie.
        let stroke = Stroke::new(self.palette().gap, 3.0 * self.line_px());
        for &(index, [from, to]) in arcs {
            // An arc shorter than a step is one piece; for one of no length, the step would be a division by zero.
            let steps = ((to - from) / ARC_STEP).ceil().max(1.0);
            let angles = (0..=steps as u32).map(|k| from + (to - from) * f64::from(k) / steps);
            // The platform's sine would give other last bits on another one.
            let arc: Vec<DVec2> = angles
                .map(libm::sincos)
                .map(|(sin, cos)| self.radius * DVec2::new(cos, sin))
                .collect();

            for image in self.images(points[index]) {
                let places = arc.iter().map(|&offset| self.flip(image + offset));
                group.shapes.push(Shape::Polyline {
                    points: places.collect(),
                    stroke,
                });
            }
        }
        self.push([group]);
    }

    pub(crate) fn blocks(&mut self, blocks: impl Iterator<Item = Rect>) {
        let mut group = self.group("blocks");
        for (index, rect) in blocks.enumerate() {
            let (tint, border) = self.palette().block(index);
            let style = Style::filled(tint).with_stroke(Stroke::new(border, 1.0));
            for copy in self.copies(rect) {
                let rect = self.flip_rect(copy);
                group.shapes.push(Shape::Rect { rect, style });
            }
        }
        self.push([group]);
    }

    /// Returns the domain and those of its copies that are shown, filled.
    pub(crate) fn domain(&self, color: Color) -> impl Iterator<Item = Shape> {
        let style = Style::filled(color);
        let whole = Rect::new([0.0; 2], self.size);
        let copies = self.copies(whole).map(|copy| self.flip_rect(copy));
        copies.map(move |rect| Shape::Rect { rect, style })
    }

    /// Returns whether disks are drawn: where even the largest, which `radius` is of, are so small that their rings would be
    /// noise, they are left out.
    pub(crate) fn draws_disks(&self) -> bool {
        self.options.disks && self.radius_px() >= MIN_DISK
    }

    /// Returns the usual style of a disk with a fill: its ring is as thick as the radius that was set last makes it.
    pub(crate) fn ringed(&self, fill: Fill) -> Style {
        let ring = Stroke::new(with_alpha(self.palette().disk, 110), self.line_px());
        Style {
            fill: Some(fill),
            stroke: Some(ring),
        }
    }

    /// Returns the images of the disk around a sample.
    pub(crate) fn disk(&self, point: DVec2, style: Style) -> impl Iterator<Item = Shape> {
        let images = self.images(point);
        images.map(move |image| Shape::circle(self.flip(image), self.radius, style))
    }

    /// Returns the scene with its frame and its caption, which is also its title.
    pub(crate) fn finish(mut self, caption: &str) -> Scene {
        // Lines and letters grow with the picture: the lengths below are pixels of a picture that is 1000 wide.
        let px = self.options.width / 1000.0;
        let mut group = Group::new("frame");
        let border = Style::stroked(self.palette().line, 1.0 * px);
        group.shapes.push(Shape::Rect {
            rect: self.frame,
            style: border,
        });

        let at = self.frame.min - DVec2::new(0.0, 16.0 * px);
        let text = Text::new(at, caption, 20.0 * px, self.palette().text);
        group.shapes.push(Shape::Text(text));

        self.push([group]);
        caption.clone_into(&mut self.scene.title);
        self.scene
    }
}
