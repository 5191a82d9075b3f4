//! What stands beside a point stays with it.

use super::*;
use crate::codecs::decode;

/// Returns a file with the points of these flags, as text.
fn kept(name: &str, text: &str, flags: &[bool]) -> String {
    let rows = keep_rows(text.as_bytes(), &hint(name), flags).expect(text);
    let again = decode(&rows.bytes, &hint(name)).expect("readable");
    let count = flags.iter().filter(|kept| **kept).count();
    assert_eq!(again.set.len(), count, "{text}");
    String::from_utf8(rows.bytes).expect("text")
}

fn hint(name: &str) -> Hint<'_> {
    Hint {
        any_z: true,
        ..Hint::from_name(name)
    }
}

#[test]
fn rows_of_tables_stay_to_the_byte() {
    let text = "\u{feff}# made by hand\r\nid;x;\"y\" ;note\r\n7;1.50;2;\"a; b\"\r\n\r\n8;0;-0.0;é\r\n# end\r\n9;3;4;";
    assert_eq!(
        kept("a.csv", text, &[true, false, true]),
        "\u{feff}# made by hand\r\nid;x;\"y\" ;note\r\n7;1.50;2;\"a; b\"\r\n\r\n# end\r\n9;3;4;"
    );
    let text = "3\n1 2 7 255\n3 4 8 0\n5 6 9 1";
    assert_eq!(
        kept("a.xyz", text, &[true, false, true]),
        "2\n1 2 7 255\n5 6 9 1"
    );
    assert_eq!(
        kept("a.txt", "2\n1 2\n0.50 4\n", &[false, true]),
        "1\n0.50 4\n"
    );
    assert_eq!(kept("a.dat", "# a\n1 2\n3 4\n", &[false, true]), "3 4\n");
}

#[test]
fn one_set_of_several_is_kept() {
    let text = b"1 2\n#\n3 4\n5 6\n#\n7 8\n";
    let second = Hint {
        set: Some(1),
        ..hint("a.dat")
    };
    let rows = keep_rows(text, &second, &[false, true]).expect("kept");
    assert_eq!(rows.bytes, b"5 6\n");
}

#[test]
fn arrays_keep_type_and_order() {
    for (descr, order) in [
        ("<f8", "False"),
        (">f8", "True"),
        (">f4", "False"),
        ("<f4", "True"),
    ] {
        let values = [1.0, 2.0, 7.0, 3.0, 4.0, 8.0_f64];
        let bytes = values.iter().flat_map(|&value| match descr {
            "<f8" => value.to_le_bytes().to_vec(),
            ">f8" => value.to_be_bytes().to_vec(),
            ">f4" => (value as f32).to_be_bytes().to_vec(),
            _ => (value as f32).to_le_bytes().to_vec(),
        });
        let head = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': (2, 3), }}\n");
        let mut file = b"\x93NUMPY\x01\x00".to_vec();
        file.extend((head.len() as u16).to_le_bytes());
        file.extend(head.bytes());
        file.extend(bytes);

        let given = decode(&file, &hint("a.npy")).expect("readable").set.points;
        let rows = keep_rows(&file, &hint("a.npy"), &[false, true]).expect("kept");
        let again = decode(&rows.bytes, &hint("a.npy")).expect("readable");
        assert_eq!(again.set.points, given[1..]);
        let text = String::from_utf8_lossy(&rows.bytes).into_owned();
        assert!(
            text.contains(descr) && text.contains(order) && text.contains("(1, 3)"),
            "{text}"
        );
    }
}

#[test]
fn json_keeps_properties_and_lists_of_points() {
    let own = r#"{"points": [[1, 2], [3, 4.5]], "provenance": [[0, 1, 0], [0, 2, 0]], "note": [7], "certificate": null}"#;
    assert_eq!(
        kept("a.json", own, &[false, true]),
        "{\"note\":[7],\"points\":[[3,4.5]],\"provenance\":[[0,2,0]]}\n"
    );
    let feature = |geometry: &str, height: u8| {
        format!(
            r#"{{"type":"Feature","geometry":{geometry},"properties":{{"height":{height},"rgb":[1,2,3]}}}}"#
        )
    };
    let point = feature(r#"{"type":"Point","coordinates":[1,2,9]}"#, 4);
    let several = feature(r#"{"type":"MultiPoint","coordinates":[[3,4],[5,6]]}"#, 5);
    let all = format!(r#"{{"type":"FeatureCollection","features":[{point},{several}]}}"#);
    let found = kept("a.geojson", &all, &[true, false, true]);
    assert!(found.contains("[1,2,9]") && found.contains("[[5,6]]") && found.contains("[1,2,3]"));
    assert!(!kept("a.geojson", &all, &[true, false, false]).contains("MultiPoint"));

    // Documents that are a point themselves.
    for lone in [r#"{"type":"Point","coordinates":[1,2]}"#, &point] {
        assert!(kept("a.geojson", lone, &[true]).contains("[1,2"));
        let none = keep_rows(lone.as_bytes(), &hint("a.geojson"), &[false]).expect(lone);
        let none = String::from_utf8(none.bytes).expect("text");
        assert_eq!(none, "{\"features\":[],\"type\":\"FeatureCollection\"}\n");
    }

    let column = read_column(
        all.as_bytes(),
        &hint("a.geojson"),
        "height",
        ColumnUse::Order,
    )
    .expect("numbers");
    assert_eq!(column, [4.0, 5.0, 5.0]);
}

/// A mesh with a material and properties of several types, in an encoding.
fn mesh(encoding: &str) -> Vec<u8> {
    let mut file = format!(
        "ply\nformat {encoding} 1.0\ncomment a mesh\nelement material 1\nproperty uchar shade\nelement vertex 3\n\
         property double x\nproperty float y\nproperty short z\nproperty uchar red\nelement face 2\n\
         property list uchar int vertex_indices\nelement tag 2\nproperty list ushort float values\nend_header\n"
    )
    .into_bytes();
    if encoding == "ascii" {
        file.extend(b"9\n0.5 1 3 255\n\n1.5 2 -3 0\n2.5 3 0 7\n3 0 1 2\n3 2 1 0\n2 0.5 0.25\n0\n");
        return file;
    }

    let is_big = encoding.contains("big");
    let mut put = |bytes: &[u8]| {
        if is_big {
            file.extend(bytes.iter().rev());
        } else {
            file.extend(bytes);
        }
    };
    put(&[9]);
    for (x, y, z, red) in [
        (0.5_f64, 1.0_f32, 3_i16, 255_u8),
        (1.5, 2.0, -3, 0),
        (2.5, 3.0, 0, 7),
    ] {
        put(&x.to_le_bytes());
        put(&y.to_le_bytes());
        put(&z.to_le_bytes());
        put(&[red]);
    }
    for face in [[0, 1, 2], [2, 1, 0_i32]] {
        put(&[3]);
        for at in face {
            put(&at.to_le_bytes());
        }
    }
    put(&2_u16.to_le_bytes());
    for value in [0.5_f32, 0.25] {
        put(&value.to_le_bytes());
    }
    put(&0_u16.to_le_bytes());
    file
}

#[test]
fn vertices_keep_their_properties_and_faces_are_left_out() {
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let file = mesh(encoding);
        let rows = keep_rows(&file, &hint("a.ply"), &[true, false, true]).expect(encoding);
        assert_eq!(rows.left_out, ["face (2 rows)"]);
        let again = decode(&rows.bytes, &hint("a.ply")).expect(encoding);
        assert_eq!(again.set.points, [[0.5, 1.0], [2.5, 3.0]]);
        for (name, values) in [("z", [3.0, 0.0]), ("red", [255.0, 7.0])] {
            let column =
                read_column(&rows.bytes, &hint("a.ply"), name, ColumnUse::Order).expect(name);
            assert_eq!(column, values, "{encoding}");
        }

        // A row of vertices and two of faces are gone, and all else is there.
        let all = keep_rows(&file, &hint("a.ply"), &[true; 3]).expect(encoding);
        let (row, faces) = if encoding == "ascii" {
            (11, 16)
        } else {
            (15, 26)
        };
        assert_eq!(all.bytes.len() - rows.bytes.len(), row);
        let header = "element face 2\nproperty list uchar int vertex_indices\n".len();
        assert_eq!(file.len() - all.bytes.len(), faces + header);
        let unplanar = decode(&file, &Hint::from_name("a.ply")).expect_err("z is 3");
        assert!(unplanar.to_string().contains("z is 3"));
    }
}

#[test]
fn lists_that_a_file_has_no_bytes_for_are_refused() {
    let mut file = mesh("binary_little_endian");
    let faces = file.len() - 26 - 12;
    file[faces] = 255;
    let error = keep_rows(&file, &hint("a.ply"), &[true; 3]).expect_err("255 items");
    assert!(error.to_string().contains("truncated"), "{error}");
}

#[test]
fn what_has_no_columns_is_refused_by_name() {
    let refused = |error: FormatError| error.to_string();
    let svg = br#"<svg><circle cx="1" cy="2" r="1"/></svg>"#;
    let said = refused(keep_rows(svg, &hint("a.svg"), &[true]).expect_err("circles"));
    assert!(said.contains("convert the file to csv first"), "{said}");
    let column = |name: &str, text: &str, column: &str| {
        refused(
            read_column(text.as_bytes(), &hint(name), column, ColumnUse::Order).expect_err(text),
        )
    };
    assert!(column("a.txt", "1\n1 2\n", "w").contains("no column beside"));
    // Lines count from 1, with the header and what is above it.
    let wrong = column("a.csv", "x,y,w\n1,2,3\n", "v");
    assert!(
        wrong.contains("line 1: there is no column \"v\""),
        "{wrong}"
    );
    let wrong = column("a.csv", "sep=;\nx;y;w\n1;2;3\n", "v");
    assert!(
        wrong.contains("line 2: there is no column \"v\""),
        "{wrong}"
    );
    let wrong = column("a.csv", "\n1,2,3\n", "v");
    assert!(wrong.contains("line 2: "), "{wrong}");
    assert!(
        column("a.csv", "x,y,w\n1,2,3\n4,5,nan\n", "w").contains("line 3: \"nan\" in column w")
    );
    assert!(column("a.json", "[[1, 2]]", "w").contains("only the features"));
    let said = column(
        "a.ply",
        std::str::from_utf8(&mesh("ascii")).expect("text"),
        "w",
    );
    assert!(said.contains("they have x, y, z, red"), "{said}");
}
