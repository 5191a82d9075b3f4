//! Indented JSON in which the corners of polygons take a line each.

use std::io;

use serde::Serialize;
use serde_json::Serializer;
use serde_json::ser::{Formatter, PrettyFormatter};

/// A list in this many lists, itself counted, stands on one line: rings are lists of corners, and corners of numbers. A number on
/// each line would make the certificate of a polygon twice as long as the polygon's own file.
const IN_LINE: usize = 3;

/// Returns a value as indented JSON.
///
/// Fails should serialisation fail, which plain data do not.
pub(crate) fn indented(value: &impl Serialize) -> Result<Vec<u8>, serde_json::Error> {
    let mut bytes = Vec::new();
    let formatter = CornerLines {
        pretty: PrettyFormatter::new(),
        lists: 0,
        outer: Vec::new(),
    };
    value.serialize(&mut Serializer::with_formatter(&mut bytes, formatter))?;
    Ok(bytes)
}

/// Indents all but the innermost lists.
struct CornerLines {
    pretty: PrettyFormatter<'static>,
    /// In how many lists the place is, up to the object around them.
    lists: usize,
    /// The same of each object around that one.
    outer: Vec<usize>,
}

impl CornerLines {
    const fn is_in_line(&self) -> bool {
        self.lists >= IN_LINE
    }
}

impl Formatter for CornerLines {
    fn begin_array<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.lists += 1;
        if self.is_in_line() {
            return writer.write_all(b"[");
        }
        self.pretty.begin_array(writer)
    }

    fn end_array<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        let is_in_line = self.is_in_line();
        self.lists -= 1;
        if is_in_line {
            return writer.write_all(b"]");
        }
        self.pretty.end_array(writer)
    }

    fn begin_array_value<W: ?Sized + io::Write>(
        &mut self,
        writer: &mut W,
        first: bool,
    ) -> io::Result<()> {
        if self.is_in_line() {
            return writer.write_all(if first { b"" } else { b", " });
        }
        self.pretty.begin_array_value(writer, first)
    }

    fn end_array_value<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        if self.is_in_line() {
            return Ok(());
        }
        self.pretty.end_array_value(writer)
    }

    fn begin_object<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.outer.push(std::mem::take(&mut self.lists));
        self.pretty.begin_object(writer)
    }

    fn end_object<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.lists = self.outer.pop().unwrap_or_default();
        self.pretty.end_object(writer)
    }

    fn begin_object_key<W: ?Sized + io::Write>(
        &mut self,
        writer: &mut W,
        first: bool,
    ) -> io::Result<()> {
        self.pretty.begin_object_key(writer, first)
    }

    fn begin_object_value<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.pretty.begin_object_value(writer)
    }

    fn end_object_value<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.pretty.end_object_value(writer)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    #[test]
    fn corners_take_a_line_each_and_all_else_is_indented() {
        let text = |value: &Value| String::from_utf8(indented(value).expect("JSON")).expect("text");
        let rings = json!({ "shape": { "rings": [[[0.5, 1], [2, -3], [4, 5]], []] }, "z": [1, 2] });
        assert_eq!(
            text(&rings),
            "{\n  \"shape\": {\n    \"rings\": [\n      [\n        [0.5, 1],\n        [2, -3],\n        [4, 5]\n      ],\n      []\n    ]\n  },\n  \"z\": [\n    1,\n    2\n  ]\n}"
        );
        assert_eq!(
            serde_json::from_str::<Value>(&text(&rings)).expect("JSON"),
            rings
        );
        // The control: what has no list in lists is as everywhere.
        for value in [
            json!({ "a": [{ "b": [[1], {}] }], "c": {} }),
            json!([]),
            json!(1.5),
        ] {
            assert_eq!(
                text(&value),
                serde_json::to_string_pretty(&value).expect("JSON")
            );
        }
    }
}
