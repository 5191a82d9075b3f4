//! The processor's instruction sets for computing a plane. They change the speed, not the points.

use std::fmt;

use fearless_simd::Level;

/// A set of instructions that this processor has.
///
/// Engines use the best one by default; the others are for tests and measurements. A set that the processor lacks
/// cannot be constructed.
///
/// ```
/// use tilescope_core::InstructionSet;
///
/// let available = InstructionSet::available();
/// assert_eq!(available.last(), Some(&InstructionSet::best()));
/// ```
#[derive(Clone, Copy)]
pub struct InstructionSet(Level);

impl InstructionSet {
    /// Returns the set that engines use.
    #[must_use]
    pub fn best() -> Self {
        Self(Level::new())
    }

    /// Returns all sets of this processor that code was made for, the best last. In WebAssembly
    /// there is one, chosen when the program is built.
    #[must_use]
    pub fn available() -> Vec<Self> {
        let best = Level::new();
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        let x86_sets = [
            best.as_sse2().map(Level::Sse2),
            best.as_sse4_2().map(Level::Sse4_2),
            best.as_avx2().map(Level::Avx2),
            best.as_avx512().map(Level::Avx512),
        ];
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        let x86_sets: [Option<Level>; 0] = [];
        let mut all: Vec<Self> = x86_sets.into_iter().flatten().map(Self).collect();
        // The best may be none of these: NEON, that of WebAssembly, or none at all.
        if all.last() != Some(&Self(best)) {
            all.push(Self(best));
        }
        all
    }

    /// Returns its name, as `avx2`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self.0 {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Sse2(_) => "sse2",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Sse4_2(_) => "sse4.2",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Avx2(_) => "avx2",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Avx512(_) => "avx512",
            #[cfg(target_arch = "aarch64")]
            Level::Neon(_) => "neon",
            #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
            Level::WasmSimd128(_) => "simd128",
            // Code without vector instructions. On each processor only some of the names above exist.
            _ => "scalar",
        }
    }

    pub(crate) const fn level(self) -> Level {
        self.0
    }
}

impl PartialEq for InstructionSet {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for InstructionSet {}

impl fmt::Debug for InstructionSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
