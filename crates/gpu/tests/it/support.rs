//! A harness that runs one WGSL function on a device for many inputs, and the inputs.

pub mod device;
pub mod inputs;

use tilescope_gpu::Gpu;
use tilescope_gpu::shader::compose;

pub use device::gpu;

/// The arguments or the answer of a function: four words; unused ones are 0.
pub type Words = [u32; 4];

/// Inputs of one dispatch: 2^14 workgroups, a quarter of what every device allows on one axis.
const BATCH: usize = 1 << 20;

/// The end of every test shader. `answer` calls the function under test.
const MAIN: &str = "
@group(0) @binding(0) var<storage, read> inputs: array<vec4<u32>>;
@group(0) @binding(1) var<storage, read_write> answers: array<vec4<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&inputs) {
        answers[id.x] = answer(inputs[id.x]);
    }
}
";

/// Returns the source of a test shader: the file `file` with all that it imports, and the body of
/// `fn answer(w: vec4<u32>) -> vec4<u32>`.
pub fn source(file: &str, body: &str) -> String {
    let library = compose(file, &[]);
    format!("{library}\nfn answer(w: vec4<u32>) -> vec4<u32> {{\n{body}\n}}\n{MAIN}")
}

/// Returns the source with one part, which must occur exactly once, replaced.
pub fn spoilt(source: &str, part: &str, other: &str) -> String {
    assert_eq!(source.matches(part).count(), 1, "{part}");
    source.replace(part, other)
}

/// Runs a test shader on the device and compares its answers with the expected ones. Returns the number of inputs, or a
/// sentence about the first difference.
pub fn compare(
    source: &str,
    inputs: &[Words],
    expected: impl Fn(Words) -> Words,
) -> Result<usize, String> {
    check(source, inputs, |input, answer| {
        let expected = expected(input);
        let message = || format!("of {input:x?} came {answer:x?}, not {expected:x?}");
        (expected == answer).then_some(()).ok_or_else(message)
    })
}

/// Runs a test shader on the device and checks each answer. Returns the number of inputs, or the first error.
pub fn check(
    source: &str,
    inputs: &[Words],
    judge: impl Fn(Words, Words) -> Result<(), String>,
) -> Result<usize, String> {
    let gpu = gpu();
    let (device, _) = gpu.device();
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("test"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("test"),
        layout: None,
        module: &module,
        entry_point: Some("main"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    for batch in inputs.chunks(BATCH) {
        for (input, answer) in batch.iter().zip(answers(gpu, &pipeline, batch)) {
            judge(*input, answer)?;
        }
    }
    Ok(inputs.len())
}

/// Returns the answers to one batch of inputs.
fn answers(gpu: &Gpu, pipeline: &wgpu::ComputePipeline, batch: &[Words]) -> Vec<Words> {
    let (device, queue) = gpu.device();
    let bytes = size_of_val(batch) as u64;
    let buffer = |usage| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("test"),
            size: bytes,
            usage: wgpu::BufferUsages::STORAGE | usage,
            mapped_at_creation: false,
        })
    };
    let inputs = buffer(wgpu::BufferUsages::COPY_DST);
    let outputs = buffer(wgpu::BufferUsages::COPY_SRC);
    queue.write_buffer(&inputs, 0, bytemuck::cast_slice(batch));
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("test"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[entry(0, &inputs), entry(1, &outputs)],
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(batch.len().div_ceil(64) as u32, 1, 1);
    drop(pass);
    queue.submit([encoder.finish()]);
    let read = pollster::block_on(gpu.read(&outputs, 0..bytes)).expect("the device answers");
    bytemuck::pod_collect_to_vec(&read)
}

fn entry(binding: u32, buffer: &wgpu::Buffer) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry {
        binding,
        resource: buffer.as_entire_binding(),
    }
}
