//! Samples and disks drawn by GPU instancing: positions and styles stay on the GPU between frames, so a frame costs a
//! few draw calls. Without a `wgpu` device it draws nothing. Begin with `InstancedCanvas`; styles are chosen in
//! `resident.rs`.

mod gpu;
mod order;
mod pipeline;
mod set;
mod still;
mod view;

use std::cell::Cell;
use std::ops::Range;

use eframe::egui_wgpu::{Callback, RenderState, wgpu};
use egui::{Painter, Rect};
use glam::DVec2;
use tilescope_core::{Domain, Point};
use tilescope_session::units;

use gpu::{Gpu, InstanceKind, InstanceRange};
use order::CellOrder;
pub use set::Symbols;
use tilescope_drawing::camera::Camera;
use tilescope_drawing::look::SampleLook;
use view::{Copy, PlaneView};
pub use view::{Marks, PaintOptions};

/// Disks of a smaller radius, in pixels, are not drawn.
pub const MIN_DISK_PIXELS: f64 = 1.0;
/// Up to this many samples in view are drawn as symbols at any scale. Chosen, not measured.
const UNCROWDED: usize = 90_000;
/// From this many pixels per r on, more samples are drawn as symbols, as far as the limits allow. Chosen, not measured.
const MIN_SYMBOL_SCALE: f64 = 3.0;
/// Changed ranges closer than this, in samples, are uploaded together, as one longer upload is taken to cost less than two. Chosen,
/// not measured.
const MAX_UPLOAD_GAP: usize = 128;
/// The least opacity of a point where many lie on one pixel. Chosen, not measured.
const MIN_POINT_OPACITY: f32 = 0.25;

/// Why samples cannot be drawn by instancing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum InstancedError {
    /// A buffer of the device cannot hold them.
    #[error("{count} samples are more than the {limit} that the device draws at once")]
    TooMany {
        /// The number of samples.
        count: u64,
        /// The most samples that the device can hold.
        limit: u64,
    },
}

/// How much is drawn in a frame at most. A software renderer cannot draw 200,000 points in every frame of a drag; the numbers below
/// were chosen, not measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// The most samples drawn as symbols; more in view become points.
    pub symbols: usize,
    /// The most symbols and disks while the camera moves.
    pub moving_symbols: usize,
    /// The most points while the camera moves.
    pub moving_points: usize,
    /// From this many samples on, a layer at rest is kept as a picture of the window's size and not drawn anew until
    /// it changes.
    pub still: usize,
}

impl Limits {
    /// The limits of a GPU.
    pub const GPU: Self = Self {
        symbols: 1_000_000,
        moving_symbols: 400_000,
        moving_points: 4_000_000,
        still: 200_000,
    };
    /// For a device that computes on the CPU.
    pub const SOFTWARE: Self = Self {
        symbols: 90_000,
        moving_symbols: 20_000,
        moving_points: 150_000,
        still: 10_000,
    };
}

/// How the camera moved between the last two frames.
#[derive(Clone, Copy, Default)]
struct Motion {
    frame: u64,
    /// The view, and how many samples of nested levels it showed.
    view: Option<(PlaneView, u32)>,
    moving: bool,
    /// Layers drawn so far in this frame.
    layers: u32,
}

/// The samples of a session on the GPU.
pub struct InstancedCanvas {
    gpu: Gpu,
    limits: Limits,
    /// The generation of the session whose samples are on the GPU.
    generation: Option<u64>,
    /// The version of their looks.
    version: Option<u64>,
    order: CellOrder,
    size: DVec2,
    periodic: bool,
    /// The looks by index in the buffers.
    looks: Vec<[u32; 2]>,
    /// The number of the next part that is drawn.
    drawn: Cell<u32>,
    motion: Cell<Motion>,
}

impl InstancedCanvas {
    /// Returns a canvas without samples that draws through `render_state`, which must not use multisampling or a
    /// depth buffer.
    #[must_use]
    pub fn new(render_state: &RenderState) -> Self {
        // A device that computes on the CPU draws less in a frame.
        let software = render_state.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        Self {
            gpu: Gpu::new(render_state),
            limits: if software {
                Limits::SOFTWARE
            } else {
                Limits::GPU
            },
            generation: None,
            version: None,
            order: CellOrder::default(),
            size: DVec2::ZERO,
            periodic: false,
            looks: Vec::new(),
            drawn: Cell::new(0),
            motion: Cell::default(),
        }
    }

    /// Returns how much is drawn in a frame.
    #[must_use]
    pub const fn limits(&self) -> Limits {
        self.limits
    }

    /// Sets how much is drawn in a frame.
    pub const fn set_limits(&mut self, limits: Limits) {
        self.limits = limits;
    }

    /// Uploads the samples of a session, all hidden; their ids are indices of `points`. `nested` are the ends of nested
    /// levels; of a stipple, the ends of its beginnings that stand for levels; it is empty for other sets. Does nothing
    /// if `generation` is already loaded.
    ///
    /// Fails when they are too many for the device; the canvas is then empty.
    pub fn set_points(
        &mut self,
        generation: u64,
        points: &[Point],
        domain: &Domain,
        nested: &[usize],
    ) -> Result<(), InstancedError> {
        let (count, limit) = (points.len() as u64, self.gpu.capacity());
        if self.generation == Some(generation) {
            return Ok(());
        }

        // If the samples are too many, no generation must count as loaded.
        (self.generation, self.version) = (None, None);
        // Positions in the buffers are numbers of 32 bits.
        if count > limit.min(u64::from(u32::MAX)) {
            self.order = CellOrder::default();
            self.looks = Vec::new();
            self.gpu.replace(&[], &[]);
            return Err(InstancedError::TooMany { count, limit });
        }

        self.order = CellOrder::new(domain, points, nested);
        self.size = units::size(domain);
        self.periodic = domain.is_periodic();
        let at = |&id: &u32| [points[id as usize].x, points[id as usize].y];
        let ordered: Vec<[i32; 2]> = self.order.ids.iter().map(at).collect();
        self.gpu.replace(&ordered, &self.order.ids);
        self.looks = vec![SampleLook::HIDDEN.packed(); ordered.len()];
        self.gpu.write_looks(0, &self.looks);

        self.generation = Some(generation);
        Ok(())
    }

    /// Returns the generation of the samples on the GPU.
    #[must_use]
    pub const fn generation(&self) -> Option<u64> {
        self.generation
    }

    /// Gives every sample the style that `look` returns for its id, unless the styles are already those of `version`;
    /// uploads the changed ones and returns their number.
    pub fn set_looks(&mut self, version: u64, look: impl Fn(u32) -> SampleLook) -> usize {
        if self.version == Some(version) {
            return 0;
        }
        self.version = Some(version);
        let mut changed = Vec::new();
        for index in 0..self.looks.len() {
            changed.extend(self.restyle(index, look(self.order.ids[index])));
        }
        self.upload(&changed);
        changed.len()
    }

    /// Updates the styles of the listed samples and sets `version`; uploads the changed ones and returns their number.
    /// Unknown ids are ignored.
    pub fn change_looks(&mut self, version: u64, looks: &[(u32, SampleLook)]) -> usize {
        self.version = Some(version);
        let mut changed = Vec::new();
        for &(id, look) in looks {
            if let Some(&index) = self.order.positions.get(id as usize) {
                changed.extend(self.restyle(index as usize, look));
            }
        }

        // A sample may be listed twice, and `upload` needs ascending indices.
        changed.sort_unstable();
        changed.dedup();
        self.upload(&changed);
        changed.len()
    }

    /// Sets the look at an index of the buffers; returns the index if that was another look.
    fn restyle(&mut self, index: usize, look: SampleLook) -> Option<usize> {
        let packed = look.packed();
        let before = std::mem::replace(&mut self.looks[index], packed);
        (before != packed).then_some(index)
    }

    /// Uploads the looks at `changed` indices, which ascend; ranges that are close together are joined.
    fn upload(&self, changed: &[usize]) {
        // Many small writes would cost more than one of everything. The quarter is an estimate.
        if changed.len() > self.looks.len() / 4 {
            self.gpu.write_looks(0, &self.looks);
            return;
        }
        for run in changed.chunk_by(|a, b| b - a <= MAX_UPLOAD_GAP) {
            let (first, last) = (run[0], run[run.len() - 1]);
            self.gpu.write_looks(first, &self.looks[first..=last]);
        }
    }

    /// Draws a layer of the view that `camera` has in `rect`, within the painter's clip rectangle; call it once per
    /// layer, from the ground up. While the camera moves a layer may be thinned out: returns whether it was, and
    /// another frame is due.
    pub fn paint(
        &self,
        painter: &Painter,
        rect: Rect,
        camera: Camera,
        options: &PaintOptions,
    ) -> bool {
        let view = PlaneView::of(painter, rect, camera);
        let frame = painter.ctx().cumulative_frame_nr();
        // A layer is counted even if it draws nothing, so that its number does not depend on the view.
        let (moving, layer) = self.next_layer(frame, (view, options.shown));
        let clip = painter.clip_rect().intersect(rect);
        let copies = view.copies(clip, self.size, self.periodic, options);
        if !clip.is_positive() || copies.is_empty() || self.order.ids.is_empty() {
            return false;
        }

        // Samples are in levels of increasing density (`order.rs`), of which the first ones alone are a thinner
        // picture.
        let (all_levels, seen) = self.seen(&copies, options);
        let Some((kind, limit)) = self.kind(options, view.scale(), seen, moving) else {
            return false;
        };

        let levels = self.levels_within(all_levels, &copies, limit, options.cull);
        let ranges_by_copy = self.parts(&copies, levels, options.cull);
        let drawn = count(&ranges_by_copy);
        // The picture of a layer is worth keeping only while the camera rests.
        let still = (!moving && drawn >= self.limits.still).then_some(layer);

        // Where samples are left out, fewer points share a pixel, and each is more opaque. `seen` is an estimate, and
        // `shown` may exceed the number of samples: both shares end at 1.
        let shown_share = f64::from(options.shown) / self.order.ids.len() as f64;
        let share = (drawn as f32 / seen.max(1) as f32).min(1.0) * shown_share.min(1.0) as f32;
        let opacity = self.point_opacity(view.scale(), share);

        let parts = copies.iter().zip(ranges_by_copy).map(|(copy, ranges)| {
            let mut uniforms = view.frame(copy.shift, options);
            // The last number of the scale is the opacity of points.
            uniforms.scale[3] = opacity;
            // Each part of a frame needs a slot of its own for its parameters, which its number chooses.
            let number = self.drawn.replace(self.drawn.get().wrapping_add(1));
            InstanceRange {
                number,
                uniforms,
                ranges,
            }
        });

        let drawing = self.gpu.drawing(kind, parts.collect(), still);
        painter.add(Callback::new_paint_callback(rect, drawing));
        let is_thinned = levels < all_levels;
        moving && is_thinned
    }

    /// Returns whether a layer of the view that `camera` has in `rect` would be drawn as points of one pixel, once the
    /// view is at rest.
    #[must_use]
    pub fn shows_points(
        &self,
        painter: &Painter,
        rect: Rect,
        camera: Camera,
        options: &PaintOptions,
    ) -> bool {
        let view = PlaneView::of(painter, rect, camera);
        let clip = painter.clip_rect().intersect(rect);
        let copies = view.copies(clip, self.size, self.periodic, options);
        let (_, seen) = self.seen(&copies, options);
        let moving = false;
        let kind = self.kind(options, view.scale(), seen, moving);
        kind.is_some_and(|(kind, _)| kind == InstanceKind::Point)
    }

    /// Returns how many levels hold the samples shown, and about how many of these samples are in view.
    fn seen(&self, copies: &[Copy], options: &PaintOptions) -> (usize, usize) {
        let (levels, held) = self.order.levels_of(options.shown);
        let seen = count(&self.parts(copies, levels, options.cull));
        // The last of these levels may be shown in part, and is taken to be spread evenly.
        let shown = u64::from(options.shown.min(held));
        (
            levels,
            (seen as u64 * shown / u64::from(held.max(1))) as usize,
        )
    }

    /// Returns whether the view differs from the last frame's, and the number of this layer in its frame. Keeps the
    /// view and the number for the layer that is drawn next.
    fn next_layer(&self, frame: u64, view: (PlaneView, u32)) -> (bool, u32) {
        // The first layer of a frame compares its view with that of the frame before; for the other layers the answer
        // is the same.
        let last = self.motion.get();
        let next = if last.view.is_some() && last.frame == frame {
            Motion {
                layers: last.layers + 1,
                ..last
            }
        } else {
            Motion {
                frame,
                view: Some(view),
                moving: last.view.is_some_and(|before| before != view),
                layers: 0,
            }
        };

        self.motion.set(next);
        (next.moving, next.layers)
    }

    /// Returns the kind of instance that stands for `seen` samples, and the most that are drawn; `None` if none are.
    fn kind(
        &self,
        options: &PaintOptions,
        scale: f64,
        seen: usize,
        moving: bool,
    ) -> Option<(InstanceKind, usize)> {
        // A picture at rest is drawn whole.
        let limit = |moving_limit| if moving { moving_limit } else { usize::MAX };
        let (symbols, points) = (self.limits.moving_symbols, self.limits.moving_points);

        // Of nested levels, only one in `thinning` samples may be shown. These are farther apart, by the root of that
        // number, and have as much more room for their symbols.
        let thinning = (self.order.ids.len() as f64 / f64::from(options.shown.max(1))).max(1.0);
        let room = scale * thinning.sqrt();

        match options.marks {
            Marks::Disks if scale * options.disk_radius < MIN_DISK_PIXELS => None,
            Marks::Disks => Some((InstanceKind::Disk, limit(symbols))),
            Marks::Symbols(_) => {
                let fine = room >= MIN_SYMBOL_SCALE && seen <= self.limits.symbols;
                if fine || seen <= UNCROWDED {
                    Some((InstanceKind::Symbol, limit(symbols)))
                } else {
                    Some((InstanceKind::Point, limit(points)))
                }
            }
        }
    }

    /// Returns the ranges of positions to draw, for each copy of the domain: with `cull` those of the cells in view,
    /// otherwise all of the levels.
    fn parts(&self, copies: &[Copy], levels: usize, cull: bool) -> Vec<Vec<Range<u32>>> {
        let ranges = |copy: &Copy| {
            if cull {
                self.order.ranges(copy.low, copy.high, levels)
            } else {
                self.order.ranges(DVec2::ZERO, self.size, levels)
            }
        };
        copies.iter().map(ranges).collect()
    }

    /// Returns how many levels, of at most `most`, can be drawn within a limit of samples.
    fn levels_within(&self, most: usize, copies: &[Copy], limit: usize, cull: bool) -> usize {
        let fits = |levels: &usize| count(&self.parts(copies, *levels, cull)) <= limit;
        // The coarsest level is drawn in any case.
        (1..=most).rev().find(fits).unwrap_or(1)
    }

    /// Returns the opacity of points when `share` of all samples are drawn: less than 1 where several are expected
    /// on a pixel, so that all of them are seen in the mixture.
    fn point_opacity(&self, scale: f64, share: f32) -> f32 {
        let per_pixel = self.order.ids.len() as f64 / (self.size.element_product() * scale * scale);
        (1.0 / (per_pixel as f32 * share)).clamp(MIN_POINT_OPACITY, 1.0)
    }
}

fn count(parts: &[Vec<Range<u32>>]) -> usize {
    parts.iter().map(|ranges| order::count(ranges)).sum()
}
