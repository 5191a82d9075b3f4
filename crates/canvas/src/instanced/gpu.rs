//! GPU resources: positions, styles and the three pipelines, stored in egui's callback resources. Which ranges are
//! drawn is decided in `instanced.rs`.

use std::cell::Cell;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use eframe::egui_wgpu::{CallbackResources, CallbackTrait, RenderState, ScreenDescriptor, wgpu};

use super::pipeline::pipelines;
use super::still::{Origin, Stills};

/// Bytes of a position and of a look.
pub const BYTES_PER_SAMPLE: u64 = 8;
/// Bytes of an id.
pub const BYTES_PER_ID: u64 = 4;
/// Number of parts whose parameters are kept at once: more than one frame of the window needs.
const SLOTS: u32 = 512;
/// Bytes from one slot to the next: the largest alignment that a device may ask for.
const SLOT_BYTES: u32 = 256;

/// The parameters of one layer, as the shader reads them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct LayerUniforms {
    /// Set when the target is known.
    pub target_size: [f32; 2],
    pub middle: [f32; 2],
    pub whole: [i32; 2],
    pub rest: [f32; 2],
    pub scale: [f32; 4],
    pub radii: [f32; 4],
    pub outline: [f32; 4],
    pub disk: [f32; 2],
    pub kinds: u32,
    pub shown: u32,
}

/// The mark of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstanceKind {
    Disk,
    Symbol,
    Point,
}

/// The buffers on the GPU, by canvas.
#[derive(Default)]
struct Residents(HashMap<u64, GpuBuffers>);

struct GpuBuffers {
    /// In the order of [`InstanceKind`].
    pipelines: [wgpu::RenderPipeline; 3],
    slots: wgpu::Buffer,
    parameters: wgpu::BindGroup,
    positions: wgpu::Buffer,
    looks: wgpu::Buffer,
    ids: wgpu::Buffer,
    stills: Stills,
}

/// The part of a canvas that is on the GPU.
pub struct Gpu {
    render: RenderState,
    key: u64,
    positions: wgpu::Buffer,
    looks: wgpu::Buffer,
    revision: Cell<u64>,
}

impl Gpu {
    /// Creates the resources of a canvas, without samples.
    pub fn new(render: &RenderState) -> Self {
        // All canvases keep their buffers in one map, each under its own key.
        static NEXT_KEY: AtomicU64 = AtomicU64::new(0);
        let device = &render.device;
        let slots = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("samples: slots"),
            size: u64::from(SLOTS * SLOT_BYTES),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let layout = bind_group_layout(device);
        // The buffers of samples are empty until `replace` is called.
        let resident = GpuBuffers {
            pipelines: pipelines(render, &layout),
            parameters: bind_group(device, &layout, &slots),
            slots,
            positions: sample_buffer(device, "samples: positions", 0),
            looks: sample_buffer(device, "samples: looks", 0),
            ids: vertex_buffer(device, "samples: ids", 0),
            stills: Stills::new(render),
        };

        let gpu = Self {
            render: render.clone(),
            key: NEXT_KEY.fetch_add(1, Ordering::Relaxed),
            positions: resident.positions.clone(),
            looks: resident.looks.clone(),
            revision: Cell::new(0),
        };

        // Callbacks find the buffers in egui's resources, since they can borrow nothing from the canvas.
        let mut renderer = render.renderer.write();
        let residents = renderer
            .callback_resources
            .entry::<Residents>()
            .or_insert_with(Residents::default);
        residents.0.insert(gpu.key, resident);
        gpu
    }

    /// Returns the most samples that a buffer of this device can hold.
    pub fn capacity(&self) -> u64 {
        self.render.device.limits().max_buffer_size / BYTES_PER_SAMPLE
    }

    /// Creates buffers for samples at `positions` with their ids; their styles are written later.
    pub fn replace(&mut self, positions: &[[i32; 2]], ids: &[u32]) {
        // The cached pictures show the old samples. Another revision has them drawn anew.
        self.revision.update(|revision| revision + 1);

        let device = &self.render.device;
        self.positions = sample_buffer(device, "samples: positions", positions.len());
        self.looks = sample_buffer(device, "samples: looks", positions.len());
        let bytes = bytemuck::cast_slice(positions);
        self.render.queue.write_buffer(&self.positions, 0, bytes);

        let id_buffer = vertex_buffer(device, "samples: ids", ids.len() as u64 * BYTES_PER_ID);
        let bytes = bytemuck::cast_slice(ids);
        self.render.queue.write_buffer(&id_buffer, 0, bytes);

        let mut renderer = self.render.renderer.write();
        let residents = renderer.callback_resources.get_mut::<Residents>();
        if let Some(resident) = residents.and_then(|all| all.0.get_mut(&self.key)) {
            // The layers of the next frame draw from these.
            resident.positions = self.positions.clone();
            resident.looks = self.looks.clone();
            resident.ids = id_buffer;
        }
    }

    /// Writes styles from the position `first` on.
    pub fn write_looks(&self, first: usize, looks: &[[u32; 2]]) {
        self.revision.update(|revision| revision + 1);
        let (offset, bytes) = (first as u64 * BYTES_PER_SAMPLE, bytemuck::cast_slice(looks));
        self.render.queue.write_buffer(&self.looks, offset, bytes);
    }

    /// Returns the callback that draws `parts`, through the cached picture of a layer if one is given.
    pub const fn drawing(
        &self,
        kind: InstanceKind,
        parts: Vec<InstanceRange>,
        still: Option<u32>,
    ) -> Drawing {
        Drawing {
            key: self.key,
            revision: self.revision.get(),
            kind,
            parts,
            still,
        }
    }
}

impl Drop for Gpu {
    fn drop(&mut self) {
        let mut renderer = self.render.renderer.write();
        if let Some(residents) = renderer.callback_resources.get_mut::<Residents>() {
            residents.0.remove(&self.key);
        }
    }
}

/// The draw call of one layer in one frame.
pub struct Drawing {
    key: u64,
    revision: u64,
    kind: InstanceKind,
    parts: Vec<InstanceRange>,
    still: Option<u32>,
}

/// Positions to draw and the parameters for them.
pub struct InstanceRange {
    /// How many parts the canvas had drawn before: an index among the parts of a frame.
    pub number: u32,
    pub uniforms: LayerUniforms,
    pub ranges: Vec<Range<u32>>,
}

impl InstanceRange {
    const fn offset(&self) -> u32 {
        (self.number % SLOTS) * SLOT_BYTES
    }
}

impl Drawing {
    /// Draws the samples in a pass over the whole target.
    fn draw(&self, resident: &GpuBuffers, pass: &mut wgpu::RenderPass<'static>) {
        pass.set_pipeline(&resident.pipelines[self.kind as usize]);
        pass.set_vertex_buffer(0, resident.positions.slice(..));
        pass.set_vertex_buffer(1, resident.looks.slice(..));
        pass.set_vertex_buffer(2, resident.ids.slice(..));
        // A frame laid out before the samples were replaced must not draw beyond the new buffer.
        let count = (resident.positions.size() / BYTES_PER_SAMPLE) as u32;

        for part in &self.parts {
            pass.set_bind_group(0, &resident.parameters, &[part.offset()]);
            for range in part.ranges.iter().filter(|range| range.end <= count) {
                // A point is one vertex; disks and symbols have four, and the sample is their instance.
                match self.kind {
                    InstanceKind::Point => pass.draw(range.clone(), 0..1),
                    InstanceKind::Disk | InstanceKind::Symbol => pass.draw(0..4, range.clone()),
                }
            }
        }
    }

    fn origin(&self, uniforms: impl Fn(&InstanceRange) -> LayerUniforms) -> Origin {
        let parts = self.parts.iter();
        Origin {
            kind: self.kind,
            revision: self.revision,
            parts: parts
                .map(|part| (uniforms(part), part.ranges.clone()))
                .collect(),
        }
    }
}

impl CallbackTrait for Drawing {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        screen: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let residents = resources.get_mut::<Residents>();
        // The canvas may have been dropped since the frame was laid out.
        let Some(resident) = residents.and_then(|all| all.0.get_mut(&self.key)) else {
            return Vec::new();
        };

        // The size of the target was not known when the frame was laid out.
        let uniforms = |part: &InstanceRange| LayerUniforms {
            target_size: screen.size_in_pixels.map(|side| side as f32),
            ..part.uniforms
        };

        for part in &self.parts {
            let offset = u64::from(part.offset());
            queue.write_buffer(&resident.slots, offset, bytemuck::bytes_of(&uniforms(part)));
        }

        // A cached picture that is outdated is drawn in a separate pass, which comes before that of the window.
        if let Some(layer) = self.still {
            let (size, origin) = (screen.size_in_pixels, self.origin(uniforms));
            if let Some(mut pass) = resident.stills.renew(device, encoder, layer, size, origin) {
                self.draw(resident, &mut pass);
            }
        }

        Vec::new()
    }

    fn paint(
        &self,
        info: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        let residents = resources.get::<Residents>();
        // The canvas may have been dropped since the frame was laid out.
        let Some(resident) = residents.and_then(|all| all.0.get(&self.key)) else {
            return;
        };

        // Positions are pixels of the target; the clip rectangle is set already.
        let [width, height] = info.screen_size_px.map(|side| side as f32);
        pass.set_viewport(0.0, 0.0, width, height, 0.0, 1.0);

        match self.still {
            Some(layer) => resident.stills.copy(pass, layer),
            None => self.draw(resident, pass),
        }
    }
}

fn sample_buffer(device: &wgpu::Device, label: &str, count: usize) -> wgpu::Buffer {
    vertex_buffer(device, label, count as u64 * BYTES_PER_SAMPLE)
}

fn vertex_buffer(device: &wgpu::Device, label: &str, bytes: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        // A run without samples is drawn from buffers, too, and a buffer of no bytes cannot be bound.
        size: bytes.max(BYTES_PER_SAMPLE),
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Returns the layout by which shaders find the parameters of a layer.
fn bind_group_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("samples"),
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                // One buffer holds the parameters of all parts; the offset chooses.
                has_dynamic_offset: true,
                min_binding_size: wgpu::BufferSize::new(size_of::<LayerUniforms>() as u64),
            },
            count: None,
        }],
    })
}

/// Returns the binding of the buffer of parameters, from which each draw call chooses its slot.
fn bind_group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    parameters: &wgpu::Buffer,
) -> wgpu::BindGroup {
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("samples"),
        layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: parameters,
                offset: 0,
                size: wgpu::BufferSize::new(size_of::<LayerUniforms>() as u64),
            }),
        }],
    })
}
