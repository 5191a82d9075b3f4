//! Open devices: finds adapters, opens one, reads buffers back, and notes failures.

use std::sync::{Arc, Mutex, PoisonError};

use tilescope_trusted::Checks;

use crate::adapter::{AdapterReport, Choice, Limits};
use crate::error::GpuError;
use crate::kernels::Kernels;

/// The most bytes read back at once. Chosen, not measured.
const STAGING: u64 = 64 << 20;

/// An open device with its queue and its compiled passes.
pub struct Gpu {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    report: AdapterReport,
    trouble: Arc<Mutex<Option<Trouble>>>,
    /// How shaders are compiled, unless the stages of the run are recorded: those always have checks.
    pub(crate) checks: Checks,
    pub(crate) kernels: Kernels,
}

/// A failure that a device reported.
#[derive(Clone, Debug)]
enum Trouble {
    Lost(String),
    OutOfMemory,
    Refused(String),
}

impl std::fmt::Debug for Gpu {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Gpu")
            .field("report", &self.report)
            .finish_non_exhaustive()
    }
}

/// The backends that run compute passes.
const BACKENDS: wgpu::Backends = wgpu::Backends::PRIMARY;

fn instance() -> wgpu::Instance {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = BACKENDS;
    wgpu::Instance::new(descriptor)
}

/// Returns the adapters, the fastest kind first. In a browser there is at most one.
pub async fn adapters() -> Vec<AdapterReport> {
    let instance = instance();
    found(&instance).await.iter().map(report_of).collect()
}

/// Returns the adapters of this machine, the fastest kind first.
async fn found(instance: &wgpu::Instance) -> Vec<wgpu::Adapter> {
    // A browser offers one adapter and lists no others.
    #[cfg(target_arch = "wasm32")]
    let mut adapters: Vec<wgpu::Adapter> = instance
        .request_adapter(&wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        })
        .await
        .into_iter()
        .collect();
    #[cfg(not(target_arch = "wasm32"))]
    let mut adapters = instance.enumerate_adapters(BACKENDS).await;

    let slowness = |adapter: &wgpu::Adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    };
    adapters.sort_by_key(slowness);
    adapters
}

/// Returns the report of an adapter that need not be open, with its own limits.
fn report_of(adapter: &wgpu::Adapter) -> AdapterReport {
    let info = adapter.get_info();
    let limits = adapter.limits();
    let is_software = info.device_type == wgpu::DeviceType::Cpu || is_known_software(&info.name);

    AdapterReport {
        backend: info.backend.to_string(),
        kind: match info.device_type {
            _ if is_software => "software",
            wgpu::DeviceType::DiscreteGpu => "discrete GPU",
            wgpu::DeviceType::IntegratedGpu => "integrated GPU",
            wgpu::DeviceType::VirtualGpu => "virtual GPU",
            // `Cpu` is software, which was named above.
            wgpu::DeviceType::Other | wgpu::DeviceType::Cpu => "GPU",
        },
        is_software,
        driver: format!("{} {}", info.driver, info.driver_info)
            .trim()
            .to_owned(),
        has_timestamps: adapter.features().contains(wgpu::Features::TIMESTAMP_QUERY),
        limits: Limits {
            max_buffer_size: limits.max_buffer_size,
            max_storage_buffer_binding_size: limits.max_storage_buffer_binding_size,
            max_compute_workgroups_per_dimension: limits.max_compute_workgroups_per_dimension,
            max_storage_buffers_per_shader_stage: limits.max_storage_buffers_per_shader_stage,
        },
        // Not every browser gives a name.
        name: if info.name.is_empty() {
            format!("{} adapter", info.backend)
        } else {
            info.name
        },
    }
}

/// Browsers do not report whether an adapter is software, but its name shows it, where they give one.
fn is_known_software(name: &str) -> bool {
    let name = name.to_lowercase();
    ["llvmpipe", "swiftshader", "softpipe", "basic render"]
        .iter()
        .any(|known| name.contains(known))
}

impl Gpu {
    /// Returns the device of the adapter that `choice` names.
    ///
    /// Fails when there is no such adapter, when only software adapters exist and `choice` neither names nor allows one, when a
    /// limit is too low for any run, and when the adapter gives no device.
    pub async fn open(choice: &Choice) -> Result<Self, GpuError> {
        let instance = instance();
        let adapter = choose(found(&instance).await, choice)?;

        let mut report = report_of(&adapter);
        if let Some(limits) = choice.limits {
            report.limits = report.limits.within(&limits);
        }
        report.check()?;

        // Without timestamps the reports have no times, and all else is the same.
        let features = adapter.features() & wgpu::Features::TIMESTAMP_QUERY;

        // The limits are those that WebGPU guarantees, and higher only where this lets the engine compute larger parts of the
        // domain at once. The sizes of textures, which the engine does not use, are the adapter's own, so that none is refused for
        // them.
        let mut limits = wgpu::Limits::default().using_resolution(adapter.limits());
        limits.max_buffer_size = report.limits.max_buffer_size;
        limits.max_storage_buffer_binding_size = report.limits.max_storage_buffer_binding_size as _;
        limits.max_compute_workgroups_per_dimension =
            report.limits.max_compute_workgroups_per_dimension;

        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("tilescope"),
                required_features: features,
                required_limits: limits,
                // Less memory rather than quicker allocation: chosen, not measured.
                memory_hints: wgpu::MemoryHints::MemoryUsage,
                ..Default::default()
            })
            .await
            .map_err(|error| GpuError::NoDevice {
                name: report.name.clone(),
                reason: error.to_string(),
            })?;

        let trouble = Arc::new(Mutex::new(None));
        watch(&device, &trouble);

        // The engine's shaders end and stay within their buffers without checks (`tilescope_trusted` has the argument).
        let checks = if choice.checked_shaders {
            Checks::Checked
        } else {
            Checks::Trusted
        };

        Ok(Self {
            device,
            queue,
            report,
            trouble,
            checks,
            kernels: Kernels::default(),
        })
    }

    /// Returns the adapter's report.
    #[must_use]
    pub const fn report(&self) -> &AdapterReport {
        &self.report
    }

    /// Returns the device and its queue, for passes other than the engine's.
    #[must_use]
    pub const fn device(&self) -> (&wgpu::Device, &wgpu::Queue) {
        (&self.device, &self.queue)
    }

    /// Fails when the device is lost, has rejected a command, or has run out of memory. The last is reported once,
    /// since memory may be free later.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        // A lost device rejects all commands, and may do so before it reports the loss.
        #[cfg(not(target_arch = "wasm32"))]
        if matches!(*self.trouble(), Some(Trouble::Refused(_))) {
            let _ = self.device.poll(wgpu::PollType::Poll);
        }

        let mut trouble = self.trouble();
        match &*trouble {
            None => Ok(()),
            Some(Trouble::Lost(reason)) => Err(GpuError::DeviceLost {
                reason: reason.clone(),
            }),
            Some(Trouble::Refused(reason)) => Err(GpuError::Refused {
                reason: reason.clone(),
            }),
            Some(Trouble::OutOfMemory) => {
                *trouble = None;
                Err(GpuError::OutOfMemory)
            }
        }
    }

    fn trouble(&self) -> std::sync::MutexGuard<'_, Option<Trouble>> {
        self.trouble.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns bytes of a buffer, which must have the usage `COPY_SRC`. Waits for all submitted commands.
    pub async fn read(
        &self,
        buffer: &wgpu::Buffer,
        range: std::ops::Range<u64>,
    ) -> Result<Vec<u8>, GpuError> {
        self.check()?;

        let mut bytes = Vec::with_capacity((range.end - range.start) as usize);
        // In parts, so that a large result needs no staging buffer of its own size.
        for start in range.clone().step_by(STAGING as usize) {
            let end = (start + STAGING).min(range.end);
            self.read_part(buffer, start..end, &mut bytes).await?;
        }
        Ok(bytes)
    }

    /// Appends bytes of a buffer to `bytes`, through a staging buffer of their length.
    async fn read_part(
        &self,
        buffer: &wgpu::Buffer,
        range: std::ops::Range<u64>,
        bytes: &mut Vec<u8>,
    ) -> Result<(), GpuError> {
        let length = range.end - range.start;
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let staging = self.buffer("staging", length, usage)?;

        let mut encoder = self.encoder();
        encoder.copy_buffer_to_buffer(buffer, range.start, &staging, 0, length);
        self.queue.submit([encoder.finish()]);

        let (sender, receiver) = futures_channel::oneshot::channel();
        staging.map_async(wgpu::MapMode::Read, .., move |result| {
            // Sending fails only when the reading was given up, and then the result is not needed.
            let _ = sender.send(result);
        });
        self.drain();
        let mapped = receiver.await;

        // A failure of the device says more than the readback that fails because of it.
        self.check()?;
        let lost = |reason: String| GpuError::DeviceLost { reason };
        mapped
            .map_err(|_| lost("a readback was dropped".to_owned()))?
            .map_err(|error| lost(error.to_string()))?;

        let view = staging
            .get_mapped_range(..)
            .map_err(|error| lost(error.to_string()))?;
        bytes.extend_from_slice(&view);
        Ok(())
    }

    /// Copies `bytes` bytes, or the most that a buffer of the device can have, `times` times on the device and waits for
    /// the end. A caller that times this gets the device's memory bandwidth: every copy reads and writes all bytes.
    pub async fn copy(&self, bytes: u64, times: u32) -> Result<(), GpuError> {
        let usage = wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        // Devices copy whole words.
        let length = bytes.min(self.report.limits.max_buffer_size) / 4 * 4;
        let (from, to) = (
            self.buffer("copy", length, usage)?,
            self.buffer("copy", length, usage)?,
        );

        let mut encoder = self.encoder();
        for _ in 0..times {
            encoder.copy_buffer_to_buffer(&from, 0, &to, 0, length);
        }
        self.queue.submit([encoder.finish()]);
        // Reading waits for the copies.
        self.read(&to, 0..4).await.map(|_| ())
    }

    pub(crate) fn encoder(&self) -> wgpu::CommandEncoder {
        self.device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    /// Waits for the device. In a browser, where waiting is impossible, the event loop delivers the results.
    pub(crate) fn drain(&self) {
        // A failure shows later, as a missing result.
        #[cfg(not(target_arch = "wasm32"))]
        let _ = self.device.poll(wgpu::PollType::wait_indefinitely());
    }

    /// Returns a new buffer of `bytes` bytes, all 0.
    pub(crate) fn buffer(
        &self,
        label: &str,
        bytes: u64,
        usage: wgpu::BufferUsages,
    ) -> Result<wgpu::Buffer, GpuError> {
        self.check()?;
        Ok(self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes,
            usage,
            mapped_at_creation: false,
        }))
    }
}

/// Notes failures of a device. Without these callbacks wgpu would panic.
fn watch(device: &wgpu::Device, trouble: &Arc<Mutex<Option<Trouble>>>) {
    let note = |trouble: &Mutex<Option<Trouble>>, new: Trouble| {
        let mut known = trouble.lock().unwrap_or_else(PoisonError::into_inner);
        // Later failures follow from the first, except a loss, which always counts.
        if known.is_none() || matches!(new, Trouble::Lost(_)) {
            *known = Some(new);
        }
    };

    let noted = Arc::clone(trouble);
    device.set_device_lost_callback(move |_, reason| note(&noted, Trouble::Lost(reason)));

    let noted = Arc::clone(trouble);
    device.on_uncaptured_error(Arc::new(move |error| {
        let new = match error {
            wgpu::Error::OutOfMemory { .. } => Trouble::OutOfMemory,
            other => Trouble::Refused(other.to_string()),
        };
        note(&noted, new);
    }));
}

/// Returns why there is no adapter.
const fn missing(is_page: bool) -> &'static str {
    if is_page {
        "the browser has no WebGPU, or offers it only to pages that come by https"
    } else {
        "the system has no Vulkan, Metal, DirectX 12 or WebGPU driver"
    }
}

/// Returns the adapter that `choice` names or, without a name, the first that it allows.
fn choose(adapters: Vec<wgpu::Adapter>, choice: &Choice) -> Result<wgpu::Adapter, GpuError> {
    let reports: Vec<AdapterReport> = adapters.iter().map(report_of).collect();
    let Some(first) = reports.first() else {
        return Err(GpuError::NoAdapter {
            reason: missing(cfg!(target_arch = "wasm32")).to_owned(),
        });
    };

    let index = match &choice.name {
        Some(wanted) => {
            // A whole name wins over a part of a name, since one adapter's name may contain another's.
            let lower = wanted.to_lowercase();
            let is_called = |report: &AdapterReport| report.name.to_lowercase() == lower;
            let contains = |report: &AdapterReport| report.name.to_lowercase().contains(&lower);
            reports
                .iter()
                .position(is_called)
                .or_else(|| reports.iter().position(contains))
                .ok_or_else(|| GpuError::NoSuchAdapter {
                    wanted: wanted.clone(),
                    found: reports.iter().map(|report| report.name.clone()).collect(),
                })?
        }
        // A software adapter is slower than the threads, so it must be asked for.
        None => reports
            .iter()
            .position(|report| choice.software || !report.is_software)
            .ok_or_else(|| GpuError::SoftwareOnly {
                name: first.name.clone(),
            })?,
    };

    adapters
        .into_iter()
        .nth(index)
        .ok_or_else(|| GpuError::NoAdapter {
            // This does not occur: there are as many reports as adapters.
            reason: "the adapter is gone".to_owned(),
        })
}
