//! Cached pictures of layers at rest: drawn once, then copied to the target until the view, the samples or their styles
//! change.

use std::collections::HashMap;
use std::ops::Range;

use eframe::egui_wgpu::{RenderState, wgpu};

use super::gpu::{InstanceKind, LayerUniforms};
use super::pipeline::pipeline;

/// Everything a cached picture depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct Origin {
    pub kind: InstanceKind,
    /// Version of positions and styles: counts their uploads.
    pub revision: u64,
    /// The copies of the domain in view: the shader's parameters for each, and the ranges of samples that are drawn.
    pub parts: Vec<(LayerUniforms, Vec<Range<u32>>)>,
}

struct StillPicture {
    origin: Option<Origin>,
    size: [u32; 2],
    view: wgpu::TextureView,
    group: wgpu::BindGroup,
}

/// The pictures of a canvas, one per layer.
pub struct Stills {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    format: wgpu::TextureFormat,
    pictures: HashMap<u32, StillPicture>,
}

impl Stills {
    /// Creates the pipeline that copies kept pictures, without pictures.
    pub fn new(render: &RenderState) -> Self {
        let device = &render.device;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("samples at rest"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Texture {
                    // Each pixel is copied to the pixel at the same place, so that nothing is filtered.
                    sample_type: wgpu::TextureSampleType::Float { filterable: false },
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                },
                count: None,
            }],
        });

        let shader = device.create_shader_module(wgpu::include_wgsl!("still.wgsl"));
        // The vertices are computed from their numbers, so that no buffer is needed.
        let triangles = wgpu::PrimitiveTopology::TriangleList;
        let entries = ["corner", "color"];

        Self {
            pipeline: pipeline(render, &layout, &shader, entries, &[], triangles),
            layout,
            format: render.target_format,
            pictures: HashMap::new(),
        }
    }

    /// Returns the pass that redraws the picture of `layer`, cleared, in which the caller must draw it; `None` if it is
    /// up to date.
    pub fn renew(
        &mut self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        layer: u32,
        size: [u32; 2],
        origin: Origin,
    ) -> Option<wgpu::RenderPass<'static>> {
        // After a change of the window's size the texture no longer fits.
        if self.pictures.get(&layer).is_none_or(|old| old.size != size) {
            let picture = self.blank(device, size);
            self.pictures.insert(layer, picture);
        }

        let picture = self.pictures.get_mut(&layer)?;
        if picture.origin.as_ref() == Some(&origin) {
            return None;
        }
        picture.origin = Some(origin);

        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("samples at rest"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &picture.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..wgpu::RenderPassDescriptor::default()
        });
        // The pass can only be returned without its borrow of the encoder: the caller drops it before it uses the encoder again.
        Some(pass.forget_lifetime())
    }

    /// Copies the picture of `layer` to the target, within the clip rectangle that is set.
    pub fn copy(&self, pass: &mut wgpu::RenderPass<'static>, layer: u32) {
        if let Some(picture) = self.pictures.get(&layer) {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &picture.group, &[]);
            pass.draw(0..3, 0..1);
        }
    }

    /// Returns an empty picture of this size, in pixels.
    fn blank(&self, device: &wgpu::Device, [width, height]: [u32; 2]) -> StillPicture {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("samples at rest"),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.format,
            // The layer is drawn into the texture, and the copy reads from it.
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });

        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("samples at rest"),
            layout: &self.layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&view),
            }],
        });

        StillPicture {
            origin: None,
            size: [width, height],
            view,
            group,
        }
    }
}
