//! The ready-made patterns are what generation makes, their files are what the program holds, and
//! a damaged one is refused.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use tilescope_core::{PackedError, Pattern, READY_MADE, Unobserved};
use tilescope_formats::bytes_digest;

/// What all files together may take in every program, the web page included.
const MAX_BYTES: usize = 450_000;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/patterns")
}

fn file(name: &str) -> Vec<u8> {
    fs::read(folder().join(name)).expect(name)
}

/// Digests by file name, as `DIGESTS` lists them.
fn listed() -> BTreeMap<String, String> {
    let list = fs::read_to_string(folder().join("DIGESTS")).expect("the list");
    let lines = list.lines().map(|line| line.split_once("  "));
    lines
        .map(|pair| pair.expect("a digest and a name"))
        .map(|(digest, name)| (name.to_owned(), digest.to_owned()))
        .collect()
}

#[test]
fn every_file_has_its_digest_and_is_built_in() {
    let found: BTreeMap<String, String> = fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".pattern"))
        .map(|name| (name.clone(), bytes_digest(&file(&name))))
        .collect();
    assert_eq!(found, listed());
    let built_in: BTreeSet<&str> = READY_MADE.iter().map(|ready| ready.name).collect();
    assert_eq!(built_in, found.keys().map(String::as_str).collect());
    for ready in READY_MADE {
        assert!(ready.packed == file(ready.name), "{}", ready.name);
    }
    let total: usize = READY_MADE.iter().map(|ready| ready.packed.len()).sum();
    assert!(total < MAX_BYTES, "{total}");
}

#[test]
fn every_file_is_the_generated_pattern_bit_for_bit() {
    for ready in READY_MADE {
        let generated = Pattern::generate(&ready.spec, &mut Unobserved).unwrap();
        assert!(generated.to_packed() == file(ready.name), "{}", ready.name);
        let unpacked = Pattern::from_packed(ready.packed).unwrap();
        assert_eq!(unpacked, generated, "{}", ready.name);
        assert!(unpacked.is_of(&ready.spec), "{}", ready.name);
    }
}

#[test]
fn a_flipped_byte_is_refused_and_has_another_digest() {
    let digests = listed();
    for ready in READY_MADE {
        for at in [9, 20, 24, ready.packed.len() / 2, ready.packed.len() - 1] {
            let mut bytes = ready.packed.to_vec();
            bytes[at] ^= 0x10;
            let refused = Pattern::from_packed(&bytes);
            let named = matches!(
                refused,
                Err(PackedError::Checksum { .. } | PackedError::Version { .. })
            );
            assert!(named, "{} byte {at}: {refused:?}", ready.name);
            assert_ne!(bytes_digest(&bytes), digests[ready.name]);
        }
    }
}

/// A pattern under another's name: each knows its own spec only.
#[test]
fn files_cannot_be_confused() {
    for (k, ready) in READY_MADE.iter().enumerate() {
        let pattern = Pattern::from_packed(ready.packed).unwrap();
        let fits = READY_MADE.iter().map(|other| pattern.is_of(&other.spec));
        let own: Vec<usize> = (0..).zip(fits).filter(|f| f.1).map(|f| f.0).collect();
        assert_eq!(own, [k], "{}", ready.name);
    }
}
