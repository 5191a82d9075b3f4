//! Properties every codec has: exact round trips, typed refusals, no panic on any bytes.

use proptest::prelude::*;
use tilescope_analysis::Boundary;

use super::*;
use crate::detect::Evidence;
use crate::point_set::Provenance;

fn told(format: Format) -> Hint<'static> {
    Hint {
        format: Some(format),
        ..Hint::default()
    }
}

/// Every combination of format and precision that gives different bytes.
fn targets() -> Vec<Target> {
    let mut targets = Vec::new();
    for format in Format::ALL {
        for precision in [Precision::Double, Precision::Single] {
            if format.precision(precision) == precision {
                targets.push(Target {
                    precision,
                    ..Target::new(format)
                });
            }
        }
    }
    targets
}

fn bits(points: &[[f64; 2]]) -> Vec<[u64; 2]> {
    points.iter().map(|p| p.map(f64::to_bits)).collect()
}

fn sample() -> PointSet {
    PointSet {
        points: vec![[0.1, 0.25], [0.5, 0.75], [1.0 / 3.0, 0.0]],
        provenance: Some(vec![
            Provenance::tiled(3, 17),
            Provenance::inserted(2),
            Provenance::tiled(0, 0),
        ]),
    }
}

fn any_points() -> impl Strategy<Value = Vec<[f64; 2]>> {
    let finite = prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO;
    prop::collection::vec([finite, finite], 1..40)
}

fn unit_points() -> impl Strategy<Value = Vec<[f64; 2]>> {
    prop::collection::vec([0.0..1.0_f64, 0.0..1.0_f64], 1..40)
}

proptest! {
    #[test]
    fn f64_formats_return_every_bit(points in any_points()) {
        let set = PointSet::from_points(points);
        for target in targets().iter().filter(|t| t.precision == Precision::Double) {
            let bytes = encode(&set, target).expect("finite points");
            let decoded = decode(&bytes, &told(target.format)).expect("own file");
            prop_assert_eq!(bits(&decoded.set.points), bits(&set.points), "{}", target.format);
        }
    }

    #[test]
    fn f32_formats_round_to_nearest(points in unit_points()) {
        let rounded: Vec<_> = points.iter().map(|p| p.map(|v| f64::from(v as f32))).collect();
        let set = PointSet::from_points(points);
        for target in targets().iter().filter(|t| t.precision == Precision::Single) {
            let bytes = encode(&set, target).expect("finite points");
            let decoded = decode(&bytes, &told(target.format)).expect("own file");
            prop_assert_eq!(decoded.precision, Precision::Single);
            prop_assert_eq!(bits(&decoded.set.points), bits(&rounded), "{}", target.format);
        }
    }

    #[test]
    fn provenance_returns_where_it_is_carried(rows in prop::collection::vec(any::<[u32; 3]>(), 1..20)) {
        let provenance: Vec<_> = rows
            .iter()
            .map(|&[block, pattern_index, iteration]| Provenance { block, pattern_index, iteration })
            .collect();
        let set = PointSet { points: vec![[0.5, 0.25]; rows.len()], provenance: Some(provenance) };
        for target in targets() {
            let bytes = encode(&set, &target).expect("finite points");
            let decoded = decode(&bytes, &told(target.format)).expect("own file");
            let expected = set.provenance.clone().filter(|_| target.format.carries_provenance());
            prop_assert_eq!(decoded.set.provenance, expected);
        }
    }

    #[test]
    fn unit_torus_files_hold_the_position_over_the_width(points in unit_points(), width in 0.1..100.0_f64) {
        let region = Region { width, height: width, boundary: Boundary::Periodic };
        let points: Vec<_> = points.iter().map(|p| p.map(|v| (v * width).min(width.next_down()))).collect();
        let set = PointSet::from_points(points);
        for format in Format::ALL.into_iter().filter(|f| f.is_unit_torus()) {
            let target = Target { region: Some(region), ..Target::new(format) };
            let bytes = encode(&set, &target).expect("finite points");
            let decoded = decode(&bytes, &told(format)).expect("own file");
            for (stored, original) in decoded.set.points.iter().zip(&set.points) {
                prop_assert!(stored.iter().all(|v| (0.0..1.0).contains(v)));
                let back = target.mapping().domain_from_file(*stored);
                prop_assert!(region.contains(back));
                prop_assert!(target.mapping().shift(back, *original) <= width * 1e-7);
            }
        }
    }

    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = decode(&bytes, &Hint::default());
        for format in Format::ALL {
            if let Ok(decoded) = decode(&bytes, &told(format)) {
                prop_assert!(decoded.set.points.iter().flatten().all(|v| v.is_finite()));
            }
        }
    }

    #[test]
    fn mutated_files_never_panic(
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4), 1..6),
        cut in any::<prop::sample::Index>(),
    ) {
        for target in targets() {
            let mut bytes = encode(&sample(), &target).expect("finite points");
            for (at, value, kind) in &edits {
                let at = at.index(bytes.len());
                match kind {
                    0 => bytes[at] = *value,
                    1 => bytes.insert(at, *value),
                    2 => bytes[at] ^= 1 << (value % 8),
                    _ => bytes.insert(at, b"0123456789-.\n ,"[usize::from(*value) % 15]),
                }
            }
            let _ = decode(&bytes, &told(target.format));
            bytes.truncate(cut.index(bytes.len()));
            let _ = decode(&bytes, &told(target.format));
            let _ = decode(&bytes, &Hint::from_name("points"));
        }
    }
}

#[test]
fn own_files_are_recognised_by_name_and_by_content() {
    for target in targets() {
        let bytes = encode(&sample(), &target).expect("finite points");
        let name = format!("set.{}", target.format.extension());
        let named = decode(&bytes, &Hint::from_name(&name)).expect("own file");
        assert_eq!(named.detection.format, target.format);
        assert_eq!(named.detection.evidence, Evidence::Extension);
        let nameless = decode(&bytes, &Hint::default()).expect("own file");
        assert_eq!(nameless.detection.format, target.format);
        assert_eq!(nameless.set, named.set);
    }
}

#[test]
fn every_truncation_is_refused_or_a_shorter_valid_text() {
    for target in targets() {
        let bytes = encode(&sample(), &target).expect("finite points");
        let counted = !matches!(
            target.format,
            Format::Csv | Format::UtkText | Format::Xyz | Format::Svg | Format::PsaRps
        );
        // The last byte of a counted text is its newline, which may be missing.
        let end = bytes.len() - if bytes.ends_with(b"\n") { 2 } else { 1 };
        for length in 0..end {
            let shorter = decode(&bytes[..length], &told(target.format));
            let kept = shorter.map_or(0, |d| d.set.len());
            let limit = if counted { 0 } else { 3 };
            // Without the last digits a counted text is still a valid file, with another last number.
            let other_number = kept == 3 && length + 20 > end;
            assert!(
                kept <= limit || other_number,
                "{} cut at {length}",
                target.format
            );
        }
    }
}

#[test]
fn remarks_line_ends_and_utf_16_change_nothing_in_tables() {
    for format in [Format::Csv, Format::PsaText, Format::UtkText, Format::Xyz] {
        let bytes = encode(&sample(), &Target::new(format)).expect("finite points");
        let plain = decode(&bytes, &told(format)).expect("own file");
        let text = String::from_utf8(bytes).expect("a text format");
        for remark in ["# made by hand", "% made by hand", "//made by hand"] {
            let old = format!("{remark}\n\n{text}").replace('\n', "\r");
            let read = decode(old.as_bytes(), &told(format)).expect("the same file");
            assert_eq!(read.set, plain.set, "{format}, {remark}");
            let marked = std::iter::once(0xFEFF).chain(old.encode_utf16());
            let wide: Vec<u8> = marked.flat_map(u16::to_be_bytes).collect();
            let read = decode(&wide, &told(format)).expect("the same file");
            assert_eq!(read.set, plain.set, "{format}, {remark}");
        }
    }
}

#[test]
fn windows_line_ends_and_bom_change_nothing() {
    for format in [
        Format::Csv,
        Format::PsaText,
        Format::UtkText,
        Format::PlyAscii,
        Format::Xyz,
        Format::Json,
        Format::Svg,
    ] {
        let bytes = encode(&sample(), &Target::new(format)).expect("finite points");
        let text = String::from_utf8(bytes.clone()).expect("a text format");
        let mut windows = text.trim_end().replace('\n', " \r\n");
        if format != Format::PlyAscii {
            windows.insert(0, '\u{feff}');
        }
        let plain = decode(&bytes, &told(format)).expect("own file");
        let read = decode(windows.as_bytes(), &told(format)).expect("the same file");
        assert_eq!(read.set, plain.set, "{format}");
    }
}

#[test]
fn no_points_is_an_error_both_ways() {
    for target in targets() {
        let format = target.format;
        let error = encode(&PointSet::default(), &target).expect_err("no points");
        assert!(matches!(error, FormatError::Empty { .. }));
        assert!(decode(b"", &told(format)).is_err(), "{format}");
    }
    for (format, bytes) in [
        (Format::Csv, &b"x,y\n"[..]),
        (Format::PsaText, b"0\n"),
        (Format::UtkText, b"#\n#\n"),
        (Format::Json, b"{\"points\": []}"),
        (Format::Svg, b"<svg></svg>"),
    ] {
        let error = decode(bytes, &told(format)).expect_err("no points");
        assert!(matches!(error, FormatError::Empty { .. }), "{format}");
    }
}

#[test]
fn what_cannot_be_written_is_refused() {
    let target = Target::new(Format::PsaRps);
    let one = |x| PointSet::from_points(vec![[0.5, 0.5], [x, 0.5]]);
    for x in [f64::NAN, f64::INFINITY, 1e300] {
        let error = encode(&one(x), &target).expect_err("not an f32");
        assert!(
            error.to_string().contains("point 1: the coordinate"),
            "{error}"
        );
    }
    let mut ragged = sample();
    ragged.points.pop();
    let error = encode(&ragged, &target).expect_err("ragged");
    assert_eq!(error.to_string(), "3 provenance entries for 2 points");
    let zero = Target {
        radius: Some(0.0),
        ..target
    };
    let error = encode(&sample(), &zero).expect_err("no radius");
    assert_eq!(
        error.to_string(),
        "the radius is 0; it must be finite and above 0"
    );
}

#[test]
fn nan_in_binary_files_is_refused() {
    for target in targets() {
        let width = target.precision.bytes();
        if !matches!(
            target.format,
            Format::PsaRps | Format::UtkBinary | Format::Npy
        ) {
            continue;
        }
        let mut bytes = encode(&sample(), &target).expect("finite points");
        let end = bytes.len();
        bytes[end - width..].fill(0xFF);
        let error = decode(&bytes, &told(target.format)).expect_err("NaN");
        assert!(error.to_string().contains("point 2: the coordinate NaN"));
    }
}
