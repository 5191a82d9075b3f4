//! Compares reading and checking in pieces with the same in memory.

use super::super::check::check_from;
use super::*;
use crate::check::{Check, CheckError, Overrides};
use crate::codecs::Hint;
use crate::error::FormatError;
use crate::files::{check, read};
use crate::mapping::Mapping;

fn pieces(path: &Path) -> Result<Vec<[f64; 2]>, FormatError> {
    let mut reader = StreamReader::open(path, None)?;
    let mut points = Vec::new();
    let region = reader.certificate().map(|stated| stated.region);
    let mapping = Mapping::new(reader.detection().format, region, reader.precision());
    while let Some(piece) = reader.next_stored()? {
        assert!(!piece.is_empty());
        points.extend(
            piece
                .into_iter()
                .map(|stored| mapping.domain_from_file(stored)),
        );
    }
    assert!(
        reader
            .count()
            .is_none_or(|count| count == points.len() as u64)
    );
    Ok(points)
}

fn streamed(path: &Path) -> Result<Check, CheckError> {
    check_from(path, &Overrides::default(), 0, &GO)
}

#[test]
fn a_file_read_in_pieces_has_the_points_of_the_whole() {
    for (format, precision) in cases() {
        let set = rows(Boundary::Periodic, 0.2);
        let context = context(Boundary::Periodic, precision);
        let (_folder, path, _) = whole(&set, &context, format);
        let expected = read(&path, &Hint::default()).expect("own file");
        assert_eq!(
            pieces(&path).expect("own file"),
            expected.set.points,
            "{format}"
        );
        let reader = StreamReader::open(&path, None).expect("own file");
        assert_eq!(reader.detection(), expected.detection);
        assert_eq!(reader.precision(), expected.precision);
        assert_eq!(reader.certificate(), expected.certificate.as_ref());
    }
}

/// Files longer than a block, so that a row and a line lie across two.
#[test]
fn rows_across_blocks_are_read_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let golden = |i: u32, step: f64| (f64::from(i) * step).fract();
    let points = (0..150_000).map(|i| [golden(i, 0.754_877), golden(i, 0.569_84)]);
    let mut set = PointSet::from_points(points.collect());
    set.provenance = Some((0..150_000).map(|i| Provenance::tiled(i, i)).collect());
    for (format, precision) in cases() {
        let target = crate::Target {
            precision,
            ..crate::Target::new(format)
        };
        let path = folder.path().join(name(format));
        fs::write(&path, crate::encode(&set, &target).expect("finite")).expect("writable");
        let expected = read(&path, &Hint::default()).expect("own file");
        assert_eq!(
            pieces(&path).expect("own file"),
            expected.set.points,
            "{format}"
        );
    }
}

#[test]
fn a_check_in_pieces_finds_what_a_check_in_memory_finds() {
    for (format, precision) in cases() {
        for jitter in [0.05, 0.25] {
            let set = rows(Boundary::Bounded, jitter);
            let context = context(Boundary::Bounded, precision);
            let (_folder, path, [data, certificate]) = whole(&set, &context, format);
            let same = |what: &str| {
                let (a, b) = (streamed(&path), check(&path, &Overrides::default(), &GO));
                match (a, b) {
                    (Ok(a), Ok((_, b))) => {
                        assert_eq!(a.passed(), b.passed());
                        assert_eq!(a.report, b.report, "{format} {what}");
                        assert_eq!(a.differences, b.differences, "{format} {what}");
                        assert_eq!(a.detection, b.detection);
                        assert_eq!(a.certificate, b.certificate);
                        !a.differences.is_empty()
                    }
                    (a, b) => {
                        let (a, b) = (a.expect_err("both fail"), b.expect_err("both fail"));
                        assert_eq!(a.to_string(), b.to_string(), "{format} {what}");
                        true
                    }
                }
            };
            assert!(!same("untouched"));
            let mut flipped = data.clone();
            let middle = data.len() / 2 + 1;
            flipped[middle] ^= 1;
            fs::write(&path, &flipped).expect("writable");
            assert!(same("flipped"));
            fs::write(&path, &data[..data.len() - 3]).expect("writable");
            assert!(same("truncated"));
            fs::write(&path, [&data[..], b"\n7,"].concat()).expect("writable");
            assert!(same("longer"));
            fs::write(&path, &data).expect("writable");
            let stated = String::from_utf8(certificate).expect("text");
            let falsified = stated.replacen("\"count\": 1", "\"count\": 2", 1);
            fs::write(certificate_path(&path), falsified).expect("writable");
            assert!(same("falsified"));
            fs::remove_file(certificate_path(&path)).expect("there");
            assert!(same("uncertified"));
        }
    }
}

#[test]
fn what_a_stream_cannot_judge_is_judged_in_memory() {
    let mut set = rows(Boundary::Periodic, 0.1);
    let mut context = context(Boundary::Periodic, Precision::Double);
    context.shuffle_seed = Some(3);
    let (_folder, path, _) = whole(&set, &context, Format::Npy);
    let found = streamed(&path).expect("a verdict");
    assert!(found.differences.is_empty(), "{:?}", found.differences);
    // Shuffled, though no certificate says so.
    context.shuffle_seed = None;
    set.points.reverse();
    for format in STREAMED {
        let (_folder, path, _) = whole(&set, &context, format);
        let found = streamed(&path).expect("a verdict");
        assert!(found.differences.is_empty(), "{:?}", found.differences);
    }
    for format in [Format::Json, Format::Xyz, Format::PsaText, Format::PlyAscii] {
        context.format = Some(format);
        let (_folder, path, _) = whole(&set, &context, format);
        assert!(streamed(&path).expect("a verdict").differences.is_empty());
        let error = StreamReader::open(&path, None).expect_err("not in pieces");
        assert!(matches!(error, FormatError::Unsupported { .. }));
    }
}

#[test]
fn foreign_text_is_read_in_pieces_as_in_memory() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("set.csv");
    for text in [
        "\u{feff}id,\"y\",\"x\"\r\n7,0.25,0.5\r\n\r\n# note\n8,0.5,0.5",
        "sep=;\r\n\"x\";\"y\"\r\n\"0.5\";0.25\r\n0.5;0.75",
        "X Y\r0.5 0.25\r\r% note\r0.5   0.75\r",
        "2\n0.5\t0.25\t0\n0.5\t0.75\t0\n",
    ] {
        fs::write(&path, text).expect("writable");
        let expected = read(&path, &Hint::default()).expect("readable");
        assert_eq!(pieces(&path).expect("readable"), expected.set.points);
    }
    for text in [
        "",
        "x,y\n",
        "x,y\n1,2\n3\n",
        "a,b\n1,2",
        "no points here",
        "x,y\n1,NaN\n",
        "12,5,7,3\n",
        "x;y\r0.5;0.25\r0,5;0,25\r",
        "3\n1 2 0\n",
        "x,y\n1,\"2\n",
    ] {
        fs::write(&path, text).expect("writable");
        let expected = read(&path, &Hint::default()).expect_err(text).to_string();
        assert_eq!(pieces(&path).expect_err(text).to_string(), expected);
    }
    let line_ends = format!("x;y\r{}", "0.125;\"0.75\"\r\r".repeat(100_000));
    fs::write(&path, line_ends).expect("writable");
    assert_eq!(
        pieces(&path).expect("readable"),
        vec![[0.125, 0.75]; 100_000]
    );

    let endless = format!("x,y\n{}", "1".repeat(3 << 20));
    fs::write(&path, endless).expect("writable");
    let error = pieces(&path).expect_err("a long line").to_string();
    assert!(error.contains("a line of more than"), "{error}");
}

#[test]
fn what_no_stream_reads_is_checked_in_memory() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("set.csv");
    let text = "x,y,z\n0.25,0.25,7\n0.75,0.75,8\n";
    let overrides = Overrides {
        region: Some(Region::UNIT_SQUARE),
        radius: Some(0.7),
        columns: Some(["x", "2"].map(str::to_owned)),
        ..Overrides::default()
    };

    fs::write(&path, text).expect("writable");
    let expected = check_from(&path, &overrides, 0, &GO).expect("columns are chosen in a stream");
    assert_eq!(expected.report.count, 2);

    let marked = std::iter::once(0xFEFF).chain(text.encode_utf16());
    let wide: Vec<u8> = marked.flat_map(u16::to_le_bytes).collect();
    fs::write(&path, wide).expect("writable");
    let found = check_from(&path, &overrides, 0, &GO).expect("UTF-16");
    assert_eq!(found.report, expected.report);
    let error = StreamReader::open(&path, None).expect_err("not in pieces");
    assert!(matches!(error, FormatError::Unsupported { .. }));
    let error = check_from(
        &path,
        &Overrides {
            columns: None,
            ..overrides
        },
        0,
        &GO,
    );
    assert!(error.expect_err("z is 7").to_string().contains("z is 7"));
}
