//! Memory that a computation takes, asked for before it begins. A Rust program ends at once when an allocation fails, so
//! that callers which must not end ask first, and fail with an error instead.

use thiserror::Error;

/// Less than this is not asked for, 1 MiB: allocators keep about as much at hand.
const SMALL: u64 = 1 << 20;

/// The system does not give the memory that a computation takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error(
    "about {:.1} GB of memory are needed, and the system does not give so much: ask for fewer samples, or for a part of them",
    *.bytes as f64 / 1e9
)]
pub struct NoMemory {
    /// About how much the computation takes, in bytes.
    pub bytes: u64,
}

/// A way to make a whole set in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Making {
    /// The parallel engine makes it ([`crate::Sweep::finish`]).
    Sweep,
    /// By [`crate::Sequential`], which keeps the origin and the fate of every sample.
    Sequential,
    /// It has nested levels ([`crate::NestedRequest::make`]).
    Levels,
    /// It is tiled exactly ([`crate::exact_sample`]).
    Exact,
    /// The reference sampler makes it ([`crate::reference_sample`]).
    Reference,
    /// It is a set of balls ([`crate::solid_sample`]).
    Solid,
    /// Its radius varies, or it covers a shape ([`crate::varying_sample`]).
    Varying,
}

impl Making {
    /// Returns about how many bytes a sample takes while the set is made, with its position in user units: the largest
    /// that was measured of sets of one to four million samples, and a tenth.
    #[must_use]
    pub const fn bytes_a_sample(self) -> f64 {
        match self {
            Self::Sweep => 30.0,
            Self::Sequential => 110.0,
            Self::Levels => 250.0,
            Self::Exact => 190.0,
            Self::Reference => 80.0,
            Self::Solid => 370.0,
            // Measured of sets of 0.1 to 2 million samples: this at a contrast of 1:16, and 280 with one radius.
            Self::Varying => 800.0,
        }
    }
}

/// Returns an error if the system does not give this number of bytes now. They are given back at once.
///
/// Limits of a process or of the system are found; that other programs take the memory meanwhile is not.
pub fn ask(bytes: u64) -> Result<(), NoMemory> {
    if bytes < SMALL {
        return Ok(());
    }
    if is_given(bytes) {
        Ok(())
    } else {
        Err(NoMemory { bytes })
    }
}

/// Returns how much the system gives now, of a number of bytes that it does not give, to a thousandth of that number.
#[must_use]
pub fn given_of(bytes: u64) -> u64 {
    let (mut given, mut refused) = (0, bytes);
    for _ in 0..10 {
        let middle = u64::midpoint(given, refused);
        if is_given(middle) {
            given = middle;
        } else {
            refused = middle;
        }
    }
    given
}

fn is_given(bytes: u64) -> bool {
    let Ok(size) = usize::try_from(bytes) else {
        return false;
    };
    let mut asked = Vec::<u8>::new();
    let is_given = asked.try_reserve_exact(size).is_ok();
    // A compiler may leave out an allocation that nothing looks at.
    std::hint::black_box(asked.as_mut_ptr());
    is_given
}

/// Returns an error if the system does not give that much memory for about this number of samples. It is given back at
/// once.
pub fn ask_for(samples: f64, bytes_a_sample: f64) -> Result<(), NoMemory> {
    ask((samples * bytes_a_sample) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_machine_has_is_refused_in_words() {
        assert_eq!(ask(0), Ok(()));
        assert_eq!(ask(2 * SMALL), Ok(()));
        let bytes = 1 << 60;
        assert_eq!(ask(bytes), Err(NoMemory { bytes }));
        let given = given_of(bytes);
        assert!(given < bytes && is_given(given), "{given}");
        let bytes = u64::MAX;
        assert_eq!(ask_for(1e18, 24.0), Err(NoMemory { bytes }));
        let text = NoMemory {
            bytes: 2_400_000_000,
        };
        assert!(text.to_string().starts_with("about 2.4 GB of memory"));
    }
}
