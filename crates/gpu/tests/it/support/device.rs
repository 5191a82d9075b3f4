//! The device that tests run on.

use std::sync::{Arc, OnceLock};

use tilescope_gpu::{Choice, Gpu, GpuError};

/// Returns the device.
///
/// # Panics
///
/// When there is no device: without one a test proves nothing and must not pass.
pub fn demand<T>(found: Result<T, GpuError>) -> T {
    found.unwrap_or_else(|error| {
        panic!(
            "these tests need a GPU adapter, and cannot pass without one; a software one will do \
             (Mesa's lavapipe, for instance): {error}"
        )
    })
}

/// Returns the device that all tests share: the fastest adapter, or a software one if there is no other.
pub fn gpu() -> &'static Arc<Gpu> {
    static GPU: OnceLock<Result<Arc<Gpu>, GpuError>> = OnceLock::new();
    opened(&GPU, false)
}

/// Returns the same adapter as another device, whose shaders check their indices and loops.
pub fn checked_gpu() -> &'static Arc<Gpu> {
    static GPU: OnceLock<Result<Arc<Gpu>, GpuError>> = OnceLock::new();
    opened(&GPU, true)
}

fn opened(
    gpu: &'static OnceLock<Result<Arc<Gpu>, GpuError>>,
    checked_shaders: bool,
) -> &'static Arc<Gpu> {
    let opened = gpu.get_or_init(|| {
        pollster::block_on(Gpu::open(&Choice {
            software: true,
            checked_shaders,
            ..Choice::default()
        }))
        .map(Arc::new)
    });
    demand(opened.as_ref().map_err(Clone::clone))
}
