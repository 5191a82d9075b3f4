//! Compiles the GPU engine's own shaders without the checks that wgpu adds to every shader, since it may come from
//! anywhere. This crate holds the one `unsafe` of the programs and nothing else; the library for C, which is no part of them,
//! has others.
//!
//! # The argument
//!
//! wgpu adds to a shader a counter to each loop, so that it ends, a check of each index, so that none reads or writes
//! beyond its buffer or array, and a check of each divisor. A shader may go without them if all its loops end, all its
//! indices are in range and all its divisors differ from 0 *for every input that it can be given*. The engine's shaders
//! are part of the program, and so are the plans that size their buffers:
//!
//! - **Elements.** A pass has one invocation for each element and those of the last workgroup beyond them, which return first.
//! - **Cells.** A frame has four cells of padding around those that are computed, and no pass looks at neighbours farther away.
//! - **Lists.** A list whose length is found as it is made counts on beyond its capacity but writes below it, and
//!   readers take the smaller of both. The host then makes it longer and repeats the window. The starts of cells in the
//!   list of tiled samples end with that list; a list that was too short still holds indices of an earlier window, so
//!   an image's index from it is compared with the number of images.
//! - **Chains.** The proposals of a cell are chained by `heads` and `next`. `heads` is cleared before each iteration, and each
//!   proposal is added once, so a chain ends.
//! - **Darts** of an exact tiling are chained likewise: each is linked once when it is added, chains are not changed by
//!   passes that follow them, and the pass that takes darts out of a cell's chain has the chain to itself. Indices of
//!   darts are listed only if there was room for the dart, and none twice in a throw, so that the list of questions is
//!   no longer than that of darts.
//! - **Loops** run over a range known before them, over the bits of a word that lose one each time, over such a chain,
//!   on by one or more up to an end, over halves of a range until one entry is left, or over the quarters of a cell,
//!   each of which comes once.
//! - **Divisors** are sides of the domain, of the frame and of the pattern, which the host has checked to be above 0,
//!   and the columns of a piece, which has a cell at least.
//!
//! None of this holds for buffers that are changed from outside. A run whose stages are inspected, and may be changed,
//! has checked shaders (`Recording::Stages` in the engine). The counter that a check adds to a loop ends it after 2^64 rounds,
//! so that chains and ranges that are read from buffers are also bounded by the length of a buffer: one changed word
//! neither closes a chain to an endless ring nor makes a range of 2^32.
//!
//! `tests/it/device/windows.rs` and `exact.rs` of the engine compare the results of trusted and of checked shaders with the CPU's,
//! bit for bit. In a browser shaders are always checked, by the browser.

/// How a shader is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Checks {
    /// With checks of indices, loops and divisors.
    Checked,
    /// Without checks, as this crate argues that none would ever fail.
    Trusted,
}

/// Returns a shader of the engine as a module of `device`.
///
/// Only for the shaders that the argument above is about: never for a text from outside the program.
#[must_use]
pub fn shader_module(
    device: &wgpu::Device,
    label: &str,
    source: String,
    checks: Checks,
) -> wgpu::ShaderModule {
    let descriptor = wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    };
    match checks {
        Checks::Checked => device.create_shader_module(descriptor),
        #[expect(unsafe_code, reason = "the argument is at the head of this crate")]
        Checks::Trusted => {
            // SAFETY: all loops end, all indices are in range and no divisor is 0, as argued at the head of this crate.
            unsafe {
                let unchecked = wgpu::ShaderRuntimeChecks::unchecked();
                device.create_shader_module_trusted(descriptor, unchecked)
            }
        }
    }
}
