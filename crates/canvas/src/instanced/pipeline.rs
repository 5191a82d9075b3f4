//! The render pipelines of the instanced canvas: vertex layouts, shaders and blending.

use eframe::egui_wgpu::{RenderState, wgpu};

use super::gpu::{BYTES_PER_ID, BYTES_PER_SAMPLE, InstanceKind};

const POSITION: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![0 => Sint32x2];
const LOOK: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![1 => Unorm8x4, 2 => Uint32];
const ID: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![3 => Uint32];

/// Returns the pipelines of disks, symbols and points, in the order of [`InstanceKind`].
pub fn pipelines(
    render: &RenderState,
    layout: &wgpu::BindGroupLayout,
) -> [wgpu::RenderPipeline; 3] {
    let source = wgpu::include_wgsl!("shader.wgsl");
    let shader = render.device.create_shader_module(source);
    // The interface blends encoded colours, and so do the shaders. A target that encodes colours by itself is given linear ones.
    let names = if render.target_format.is_srgb() {
        ["disk_linear", "symbol_linear", "point_linear"]
    } else {
        ["disk_gamma", "symbol_gamma", "point_gamma"]
    };

    [
        (InstanceKind::Disk, "disk_corner"),
        (InstanceKind::Symbol, "symbol_corner"),
        (InstanceKind::Point, "point"),
    ]
    .map(|(kind, vertex)| {
        // A point is drawn as one vertex, because as an instance it would cost far more on some devices.
        let (step_mode, topology) = match kind {
            InstanceKind::Point => (
                wgpu::VertexStepMode::Vertex,
                wgpu::PrimitiveTopology::PointList,
            ),
            InstanceKind::Disk | InstanceKind::Symbol => (
                wgpu::VertexStepMode::Instance,
                wgpu::PrimitiveTopology::TriangleStrip,
            ),
        };

        let buffer = |array_stride, attributes| {
            Some(wgpu::VertexBufferLayout {
                array_stride,
                step_mode,
                attributes,
            })
        };
        let buffers = [
            buffer(BYTES_PER_SAMPLE, &POSITION[..]),
            buffer(BYTES_PER_SAMPLE, &LOOK),
            buffer(BYTES_PER_ID, &ID),
        ];

        let entries = [vertex, names[kind as usize]];
        pipeline(render, layout, &shader, entries, &buffers, topology)
    })
}

/// Returns a pipeline that blends onto the window's target as egui's own does; `vertex` and `fragment` are entry points of the shader.
pub fn pipeline(
    render: &RenderState,
    layout: &wgpu::BindGroupLayout,
    shader: &wgpu::ShaderModule,
    [vertex, fragment]: [&str; 2],
    buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
    topology: wgpu::PrimitiveTopology,
) -> wgpu::RenderPipeline {
    let device = &render.device;
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("samples"),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });

    let target = wgpu::ColorTargetState {
        format: render.target_format,
        // The shaders return premultiplied colours, as egui's do.
        blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        write_mask: wgpu::ColorWrites::ALL,
    };

    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(vertex),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: shader,
            entry_point: Some(vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers,
        },
        primitive: wgpu::PrimitiveState {
            topology,
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: shader,
            entry_point: Some(fragment),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(target)],
        }),
        multiview_mask: None,
        cache: None,
    })
}
