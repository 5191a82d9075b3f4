//! What is read, and what is refused and why.

use super::*;

fn points(text: &str) -> Result<Vec<[f64; 2]>, FormatError> {
    super::read(text.as_bytes(), Format::Csv, None, false).map(|raw| raw.set.points)
}

fn message(text: &str) -> String {
    points(text).expect_err(text).to_string()
}

#[test]
fn columns_are_found_by_name_or_by_order() {
    for text in [
        "x,y\n0.5,0.25\n",
        "\u{feff}X , Y\r\n 0.5 , 0.25 \r\n",
        "id,\"y\",\"x\"\n7,0.25,0.5",
        "# made by hand\n\n5e-1,.25",
        "x,y\n0.5,0.25,\n",
        "x,y,name\n0.5,0.25,\"a, b\"\n",
        ",x,y\n0,0.5,0.25\n",
        "\tx\ty\n0\t0.5\t0.25\n",
        "x,y,2020\n0.5,0.25,7\n",
    ] {
        assert_eq!(points(text).expect(text), [[0.5, 0.25]]);
    }
}

#[test]
fn separators_line_ends_and_quotation_marks_are_seen() {
    let expected = [[0.5, 0.25], [0.75, 0.125]];
    for text in [
        "x;y\n0.5;0.25\n0.75;0.125\n",
        "x\ty\r0.5\t0.25\r0.75\t0.125\r",
        "0.5 0.25\n0.75   0.125\n",
        "0.5;0.25\n0.75;0.125\n",
        "\"x\",\"y\"\n\"0.5\",\"0.25\"\n0.75,\"0.125\"\n",
        "\"x\" \"y\"\n\"0.5\"  0.25\n0.75 0.125\n",
        "sep=,\nx,y\n0.5,0.25\n0.75,0.125\n",
        "sep=;\r\nx;y\r\n0.5;0.25\r\n0.75;0.125",
        "0.5, 0.25\n0.75, 0.125\n",
        "0.5,0.25,0\n0.75,0.125,0.0\n",
        "0.5 0.25 0 255 12\n0.75 0.125 0 1 2\n",
        "2\n0.5 0.25 0 -1200\n0.75 0.125 0 7\n",
        "//X Y Z\n0.5 0.25 0\n0.75 0.125 0\n",
        "# y x\n0.25 0.5\n0.125 0.75\n",
        "# x, y\n0.5 0.25\n0.75 0.125\n",
        "% of x and y\n0.5 0.25\n0.75 0.125\n",
    ] {
        assert_eq!(points(text).expect(text), expected);
    }
}

#[test]
fn decimal_commas_are_refused_by_their_line() {
    assert_eq!(
        message("12,5,7,3\n"),
        "CSV: line 1: 4 columns and no header: the point may be (12, 5), or (12.5, 7.3) with decimal commas; write \
         decimal points, and a first line that names the columns x and y"
    );
    assert_eq!(
        message("x,y\n0,5,0,25\n"),
        "CSV: line 2: 4 columns where 2 are needed; numbers must have decimal points, as 0.5 has"
    );
    let comma = |line: u32, token: &str| {
        format!(
            "CSV: line {line}: \"{token}\" has a decimal comma; numbers must have decimal points, as 0.5 has"
        )
    };
    assert_eq!(message("0,5;0,25\n"), comma(1, "0,5"));
    assert_eq!(message("x;y\n0.5;0.25\n0.5;0,25\n"), comma(3, "0,25"));
    assert_eq!(message("x\ty\n0,5\t0,25\n"), comma(2, "0,5"));
    assert_eq!(message("0,5 0,25\n"), comma(1, "0,5"));
    assert_eq!(message("x y\n12,5 7\n"), comma(2, "12,5"));
    assert_eq!(message("\"x\",\"y\"\n\"0,5\",\"0,25\"\n"), comma(2, "0,5"));
    // A header's separator holds: these are not the points (12, 5).
    assert_eq!(
        message("x;y\n12,5\n"),
        "CSV: line 2: 1 columns where 2 are needed"
    );
    assert!(message("0.5,0.25\n0,5,0,25\n").starts_with("CSV: line 2: 4 columns where 2"));
    for text in ["1,2,3,4,5\n", "1,2,3,4,5,6\n", "0.5,0.25,red,blue\n"] {
        assert!(message(text).contains("columns and no header"), "{text}");
    }
}

#[test]
fn sets_that_are_not_planar_are_refused_with_their_z() {
    let planar = |line: u32, z: &str| {
        format!("CSV: line {line}: z is {z}, and only planar sets (z = 0) are read")
    };
    assert_eq!(
        message("x,y,z\n0.5,0.25,0\n0.5,0.5,0.1\n"),
        planar(3, "0.1")
    );
    assert_eq!(message("0.5,0.25,3\n"), planar(1, "3"));
    assert_eq!(message("0.5;0.25;12.5\n"), planar(1, "12.5"));
    assert_eq!(message("2\n0.5 0.25 0 1\n0.5 0.5 2 1\n"), planar(3, "2"));
    assert!(message("0.5,0.25,red\n").contains("\"red\" is not a number"));
    assert!(message("x,y,z\n0.5,0.25\n").contains("2 columns where 3"));
}

#[test]
fn other_faults_are_named_with_their_line() {
    assert!(
        message("a,b\n1,2\n")
            .starts_with("CSV: header, line 1: no column is named x; the columns are \"a\", \"b\"")
    );
    for (text, reason) in [
        ("x,y\n1,2\n3\n", "line 3: 1 columns where 2"),
        ("x,y\n1,two\n", "line 2: \"two\" is not a number"),
        (
            "x,y\r1,2\r\r#\r1,1.0D-02\r",
            "line 5: \"1.0D-02\" is not a number",
        ),
        (
            "x,y\n1,NaN\n",
            "line 2: the coordinate NaN is not a finite number",
        ),
        ("nan,1\n", "line 1: the coordinate NaN"),
        ("x y z\n1 2\n", "line 2: 2 columns where 3"),
        ("1 2 0\n1 2\n", "line 2: 2 columns where 3"),
        ("1,2\n1,2,0\n", "line 2: 3 columns where 2"),
        ("\0\u{1}no points here", "line 1: no column is named x"),
        ("sep=|\nx|y\n1|2\n", "line 1: sep=| is not a separator"),
        (
            "x,y,name\n1,2,\"red\n2,3,blue\"\n",
            "line 2: a quotation mark is open",
        ),
        ("x\0,\0y\0\n", "UTF-16 without a byte-order mark"),
        ("3\n0.5 0.25 0 1\n", "states 3 points and holds 1"),
        ("lon,lat\n1,2\n", "project them"),
        ("# lon lat\n1 2\n", "project them"),
        ("\"x\" \"y\"\n\"1\" 0.5 0.25\n", "line 2: 3 columns where 2"),
    ] {
        let found = message(text);
        assert!(found.contains(reason), "{text:?}: {found}");
    }
}

#[test]
fn chosen_columns_are_read_whatever_the_others_hold() {
    let read = |text: &str, a, b| {
        super::read(text.as_bytes(), Format::Csv, Some([a, b]), false).map(|raw| raw.set.points)
    };
    let cloud = "x,y,z\n0.5,0.25,7\n";
    assert_eq!(read(cloud, "x", "z").expect("by name"), [[0.5, 7.0]]);
    assert_eq!(read(cloud, "2", "1").expect("by number"), [[0.25, 0.5]]);
    assert_eq!(
        read("7,0.5,0.25,9\n", "2", "3").expect("no header"),
        [[0.5, 0.25]]
    );
    // R leaves out the name of the first column.
    let of_r = "\"x\" \"y\"\n\"1\" 0.5 0.25\n";
    assert_eq!(read(of_r, "2", "3").expect("by number"), [[0.5, 0.25]]);
    assert_eq!(
        read("lon,lat\n1,2\n", "lon", "lat").expect("as asked"),
        [[1.0, 2.0]]
    );
    let error = read(cloud, "x", "w").expect_err("no such column");
    assert_eq!(
        error.to_string(),
        "CSV: header, line 1: there is no column \"w\"; the columns are \"x\", \"y\", \"z\", or by number 1 to 3"
    );
}

#[test]
fn a_table_that_is_cut_between_lines_reads_as_a_whole_one() {
    for text in [
        "# y x\n\n0.25 0.5\n#\n0.125 0.75\n",
        "sep=;\r\n\"x\";y\r\n0.5;\"0.25\"\r\n0.75;0.125",
    ] {
        let mut table = TextTable::new(Format::Csv, None);
        let mut points = Vec::new();
        for piece in text.split_inclusive('\n') {
            table.take(piece.as_bytes(), &mut points).expect(text);
        }
        assert_eq!(points, [[0.5, 0.25], [0.75, 0.125]]);
        let faulty = format!("{}\nfault", text.trim_end());
        let lines = faulty.lines().count();
        assert!(
            message(&faulty).contains(&format!("line {lines}:")),
            "{}",
            message(&faulty)
        );
    }
}
