//! Packing loses nothing, and no bytes whatever make unpacking panic or accept another form.

use proptest::prelude::*;

use super::*;
use crate::parameters::PatternSpec;
use crate::progress::Unobserved;

fn pattern(side: f64, boundary: Boundary) -> Pattern {
    let spec = PatternSpec {
        side,
        boundary,
        seed: 77,
    };
    Pattern::generate(&spec, &mut Unobserved).unwrap()
}

/// Bytes with a checksum that is right.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.truncate(bytes.len() - CHECKSUM_BYTES);
    bytes.extend(checksum(&bytes).to_le_bytes());
    bytes
}

/// Packed samples without regard to what they must be; each with its cell's number of them.
fn forged(pattern: &Pattern, cells: &[(u32, &[u32])]) -> Vec<u8> {
    let mut bits = BitWriter {
        bytes: header(pattern),
        word: 0,
        held: 0,
    };
    for &(count, places) in cells {
        bits.put(count, COUNT_BITS);
        for &place in places {
            bits.put(place, PLACE_BITS);
        }
    }
    let mut bytes = bits.finish();
    bytes.extend([0; CHECKSUM_BYTES]);
    sealed(bytes)
}

#[test]
fn packing_loses_nothing() {
    for side in [10.0, 12.34, 23.5, 40.0] {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let made = pattern(side, boundary);
            let packed = made.to_packed();
            let unpacked = Pattern::from_packed(&packed).unwrap();
            assert_eq!(unpacked, made);
            assert_eq!(unpacked.seed, Some(77));
            assert_eq!(unpacked.to_packed(), packed);
        }
    }
}

#[test]
fn a_given_pattern_packs_without_a_seed() {
    let made = pattern(14.5, Boundary::Bounded);
    let positions: Vec<[f64; 2]> = made
        .samples
        .iter()
        .map(|&p| made.domain.user_from_lattice(p))
        .collect();
    let size = made.domain.size();
    let given = Pattern::from_positions(&positions, size, 1.0, Boundary::Bounded).unwrap();
    let unpacked = Pattern::from_packed(&given.to_packed()).unwrap();
    assert_eq!(unpacked, made);
    assert_eq!(unpacked.seed, None);
    assert_ne!(given.to_packed(), made.to_packed());
}

#[test]
fn only_its_own_spec_is_its_spec() {
    let spec = PatternSpec {
        side: 14.5,
        boundary: Boundary::Periodic,
        seed: 77,
    };
    let made = pattern(14.5, Boundary::Periodic);
    assert!(made.is_of(&spec));
    for other in [
        PatternSpec { side: 14.6, ..spec },
        PatternSpec { seed: 78, ..spec },
        PatternSpec {
            boundary: Boundary::Bounded,
            ..spec
        },
        PatternSpec {
            side: f64::NAN,
            ..spec
        },
    ] {
        assert!(!made.is_of(&other), "{other:?}");
    }
}

fn refused(bytes: &[u8]) -> PackedError {
    Pattern::from_packed(bytes).unwrap_err()
}

/// Asserts that bytes are refused for a cause.
macro_rules! assert_refused {
    ($bytes:expr, $($cause:tt)+) => {
        let refused = refused($bytes);
        assert!(matches!(refused, PackedError::$($cause)+), "{refused:?}");
    };
}

#[test]
fn a_bad_header_is_refused_for_its_cause() {
    let packed = pattern(10.0, Boundary::Periodic).to_packed();
    let with = |at: usize, byte: u8| {
        let mut bytes = packed.clone();
        bytes[at] = byte;
        sealed(bytes)
    };
    assert_refused!(&[], Mark);
    assert_refused!(b"\x89PNG\r\n\x1a\n", Mark);
    assert_refused!(&packed[..20], TooShort { bytes: 20, .. });
    assert_refused!(&with(8, 9), Version { found: 9, .. });
    assert_refused!(&packed[..300], Checksum { .. });
    assert_refused!(&with(12, 4), Flags { flags: 4, .. });
    assert_refused!(&with(12, 0), Flags { seed: 77, .. });
    assert_refused!(
        &with(18, 0),
        Side {
            name: "width",
            units: 0,
            ..
        }
    );
    assert_refused!(&with(23, 255), Side { name: "height", .. });
}

#[test]
fn bad_samples_are_refused_for_their_cause() {
    let made = pattern(10.0, Boundary::Periodic);
    let mut taller = made.to_packed();
    // Twenty rows of cells instead of ten.
    taller[22] = 10;
    assert_refused!(&sealed(taller), Ended { .. });
    let mut longer = made.to_packed();
    longer.insert(longer.len() - CHECKSUM_BYTES, 0);
    assert_refused!(&sealed(longer), Trailing { bytes: 1 });
    let nothing = vec![(0, &[][..]); 100];
    assert_refused!(&forged(&made, &nothing), Empty);
    assert_refused!(&forged(&made, &[(2, &[9, 9])]), Order { index: 1 });
    assert_refused!(&forged(&made, &[(1, &[])]), Ended { samples: 0 });
}

#[test]
fn samples_beyond_the_domain_are_refused() {
    let made = pattern(10.5, Boundary::Periodic);
    let mut cells = vec![(0, &[][..]); 11];
    cells[10] = (1, &[20_000]);
    let point = Point::new(10 * R + 20_000, 0);
    assert_eq!(
        refused(&forged(&made, &cells)),
        PackedError::Outside { index: 0, point }
    );
}

#[test]
fn every_flipped_bit_and_every_cut_is_found() {
    let packed = pattern(10.0, Boundary::Bounded).to_packed();
    for bit in 0..packed.len() * 8 {
        let mut bytes = packed.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        assert!(Pattern::from_packed(&bytes).is_err(), "bit {bit}");
    }
    for length in 0..packed.len() {
        assert!(Pattern::from_packed(&packed[..length]).is_err(), "{length}");
    }
}

proptest! {
    #[test]
    fn no_bytes_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        prop_assert!(Pattern::from_packed(&bytes).is_err());
    }

    /// Damage under a right checksum: refused, or another pattern's one and only form.
    #[test]
    fn what_is_accepted_is_the_only_form(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in 0..40_usize,
    ) {
        let mut bytes = pattern(10.5, Boundary::Periodic).to_packed();
        bytes.truncate(bytes.len() - cut.saturating_sub(30));
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        let bytes = sealed(bytes);
        if let Ok(pattern) = Pattern::from_packed(&bytes) {
            let rect = pattern.domain.rect();
            prop_assert!(pattern.samples.iter().all(|&p| rect.contains(p)));
            prop_assert_eq!(pattern.to_packed(), bytes);
        }
    }

    /// The same with nothing but the mark and the version given.
    #[test]
    fn any_content_under_a_right_checksum_is_judged(
        words in prop::array::uniform4(any::<u32>()),
        flags in 0..4_u32,
        body in prop::collection::vec(any::<u8>(), 0..300),
    ) {
        let mut bytes = MARK.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(flags.to_le_bytes());
        bytes.extend(words.into_iter().flat_map(|w| (w % (MAX_SIDE + 9)).to_le_bytes()));
        bytes.extend(body);
        bytes.extend([0; CHECKSUM_BYTES]);
        let bytes = sealed(bytes);
        if let Ok(pattern) = Pattern::from_packed(&bytes) {
            prop_assert_eq!(pattern.to_packed(), bytes);
        }
    }
}
