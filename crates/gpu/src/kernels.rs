//! Pipelines: the compiled shader of a pass with the layout of its bindings, made once for each device.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use tilescope_trusted::{Checks, shader_module};

use crate::layout::{Access, Binding};
use crate::passes::Pass;
use crate::shader::compose;

/// The pipelines of a device, by pass and checks.
#[derive(Default)]
pub(crate) struct Kernels(Mutex<HashMap<(&'static str, Checks), Arc<Kernel>>>);

/// A pass compiled for a device.
pub(crate) struct Kernel {
    pub pipeline: wgpu::ComputePipeline,
    pub layout: wgpu::BindGroupLayout,
}

impl Kernels {
    /// Returns the pipeline of a pass, compiling it on first use.
    pub(crate) fn get(
        &self,
        device: &wgpu::Device,
        pass: &'static Pass,
        checks: Checks,
    ) -> Arc<Kernel> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let kernel = known
            .entry((pass.name, checks))
            .or_insert_with(|| Arc::new(Kernel::new(device, pass, checks)));
        Arc::clone(kernel)
    }
}

impl Kernel {
    /// Returns a pass compiled for a device. Its bindings are numbered in their order, as in the declarations of its shader.
    fn new(device: &wgpu::Device, pass: &Pass, checks: Checks) -> Self {
        let numbered = pass.bindings.iter().zip(0..);
        let entries: Vec<_> = numbered
            .map(|(binding, number)| entry(binding, number))
            .collect();
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(pass.name),
            entries: &entries,
        });

        let source = compose(pass.shader, pass.bindings);
        let module = shader_module(device, pass.name, source, checks);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(pass.name),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });

        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(pass.name),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });

        Self { pipeline, layout }
    }
}

/// Returns the entry of a layout for a binding.
fn entry(binding: &Binding, number: u32) -> wgpu::BindGroupLayoutEntry {
    let ty = match binding.access {
        Access::Uniform => wgpu::BufferBindingType::Uniform,
        Access::Read => wgpu::BufferBindingType::Storage { read_only: true },
        Access::Write | Access::Update | Access::Atomic => {
            wgpu::BufferBindingType::Storage { read_only: false }
        }
    };

    wgpu::BindGroupLayoutEntry {
        binding: number,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    }
}
