//! Adapters: the report of each, the choice among them, and whether its limits suffice. [`crate::opened`] opens them.

use crate::error::GpuError;

/// An adapter and its limits.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct AdapterReport {
    /// Its name, from the driver.
    pub name: String,
    /// The programming interface: vulkan, metal, dx12, webgpu.
    pub backend: String,
    /// Its kind: a discrete, integrated or virtual GPU, or software on the CPU.
    pub kind: &'static str,
    /// Whether it computes on the CPU.
    #[serde(rename = "software")]
    pub is_software: bool,
    /// The driver and its version.
    pub driver: String,
    /// Whether it can time passes.
    #[serde(rename = "timestamps")]
    pub has_timestamps: bool,
    /// The limits that matter to the engine.
    pub limits: Limits,
}

/// The limits that decide how large a window may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Limits {
    /// The longest buffer, in bytes.
    pub max_buffer_size: u64,
    /// The longest part of a buffer that a pass may bind, in bytes.
    pub max_storage_buffer_binding_size: u64,
    /// Workgroups along one axis.
    pub max_compute_workgroups_per_dimension: u32,
    /// Storage buffers that a pass may bind.
    pub max_storage_buffers_per_shader_stage: u32,
}

/// The most storage buffers that a pass binds, which is what WebGPU guarantees.
pub(crate) const MAX_STORAGE_BUFFERS: u32 = 8;

/// Rows of workgroups for the largest frame. It has 2^28 open cells with 8 rows of pixels each, and an invocation for
/// each row of pixels: 2^31. A row of `GROUP_COLUMNS` (1024) workgroups of 64 has 2^16 of them, which makes 2^15 rows
/// of workgroups. One more is to spare.
const MAX_GROUP_ROWS: u64 = 32_769;

/// Which adapter to open.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Choice {
    /// Its name or a part of it, ignoring case. If not given, the fastest adapter.
    pub name: Option<String>,
    /// Whether a software adapter may be chosen if no name is given.
    pub software: bool,
    /// Further limits, besides the adapter's own.
    pub limits: Option<Limits>,
    /// Whether shaders check their indices and loops as they run. They compute the same, and slower; browsers always check.
    pub checked_shaders: bool,
}

impl Limits {
    /// Returns for each limit the lower one of the two.
    #[must_use]
    pub fn within(&self, other: &Self) -> Self {
        Self {
            max_buffer_size: self.max_buffer_size.min(other.max_buffer_size),
            max_storage_buffer_binding_size: self
                .max_storage_buffer_binding_size
                .min(other.max_storage_buffer_binding_size),
            max_compute_workgroups_per_dimension: self
                .max_compute_workgroups_per_dimension
                .min(other.max_compute_workgroups_per_dimension),
            max_storage_buffers_per_shader_stage: self
                .max_storage_buffers_per_shader_stage
                .min(other.max_storage_buffers_per_shader_stage),
        }
    }
}

impl AdapterReport {
    /// Fails when a limit is lower than the engine takes for granted.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        // The other two limits only make windows smaller (`fit.rs`). These two are not fitted: passes bind that many buffers, and
        // have workgroups for the largest frame, even where a smaller one needs fewer.
        let needed: [(&'static str, u64, u64); 2] = [
            (
                "maxStorageBuffersPerShaderStage",
                self.limits.max_storage_buffers_per_shader_stage.into(),
                MAX_STORAGE_BUFFERS.into(),
            ),
            (
                "maxComputeWorkgroupsPerDimension",
                self.limits.max_compute_workgroups_per_dimension.into(),
                MAX_GROUP_ROWS,
            ),
        ];

        for (limit, value, minimum) in needed {
            if value < minimum {
                return Err(GpuError::LimitTooLow {
                    name: self.name.clone(),
                    limit,
                    value,
                    minimum,
                });
            }
        }
        Ok(())
    }
}
