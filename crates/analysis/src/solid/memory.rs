//! Memory that judging takes, asked for before it begins: a program ends at once when an allocation fails. The verifier
//! shares no code with the samplers, which ask in the same way.

use super::error::SolidError;

/// Bytes a sample that pairs, cubes and the farthest place take one after another, at most: measured of sets of half a million to a million
/// samples, and a tenth.
pub(super) const JUDGING: f64 = 100.0;

/// Less than this is not asked for: allocators keep about as much at hand.
const LEAST: u64 = 1 << 20;

/// Returns an error if the system does not give the memory that judging this number of samples takes. It is given back at once.
pub(super) fn ask(count: usize) -> Result<(), SolidError> {
    let bytes = (count as f64 * JUDGING) as u64;
    if bytes < LEAST || is_given(bytes) {
        return Ok(());
    }

    // Ten halvings find the free memory to a thousandth of the need.
    let (mut given, mut refused) = (0, bytes);
    for _ in 0..10 {
        let middle = u64::midpoint(given, refused);
        if is_given(middle) {
            given = middle;
        } else {
            refused = middle;
        }
    }
    Err(SolidError::NoMemory {
        count,
        bytes,
        given,
    })
}

/// Whether the system gives this number of bytes now.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_machine_has_is_refused_with_need_and_limit() {
        assert_eq!(ask(1_000), Ok(()));
        assert_eq!(ask(100_000), Ok(()));
        // 2^50 samples take more than 2^56 bytes, beyond every address space.
        let count = 1 << 50;
        let refused = ask(count).expect_err("no memory");
        let SolidError::NoMemory { bytes, given, .. } = refused else {
            panic!("{refused}");
        };
        assert!(bytes > given && !is_given(bytes), "{refused}");
        let text = SolidError::NoMemory {
            count: 2_000_000,
            bytes: 320_000_000,
            given: 100_000_000,
        };
        let text = text.to_string();
        assert!(
            text.contains("0.32 GB") && text.contains("gives 0.10 GB"),
            "{text}"
        );
    }
}
