//! SVG circles in domain units, for drawing and plotting tools.
//!
//! Each point is a disk of half the sampling radius, so the disks of a conflict-free set do not overlap. Reads back
//! circles in user units; a file with transforms is refused, since they are not applied.

use super::{Raw, Target};
use crate::error::{FilePlace, FormatError};
use crate::format::{Format, Precision};
use crate::text::{number, push, without_bom};

const FORMAT: Format = Format::Svg;

pub(super) fn read(bytes: &[u8]) -> Result<Raw, FormatError> {
    let bytes = without_bom(bytes);
    let mut points = Vec::new();
    let mut in_comment = false;
    let mut is_svg = false;
    for piece in bytes.split(|&b| b == b'<').skip(1) {
        in_comment |= piece.starts_with(b"!--");
        if in_comment {
            in_comment = !contains(piece, b"-->");
            continue;
        }
        let tag = piece.split(|&b| b == b'>').next().unwrap_or_default();
        let name = tag
            .split(|b| b.is_ascii_whitespace() || *b == b'/')
            .next()
            .unwrap_or_default();
        is_svg |= name == b"svg";
        if attribute(tag, b"transform").is_some() {
            return Err(FormatError::Unsupported {
                format: FORMAT,
                what: format!("a transform at circle {}", points.len()),
                supported: "circles in plain user units can",
            });
        }
        if name == b"circle" {
            points.push(circle(tag, points.len() as u64)?);
        }
    }
    if !is_svg {
        return Err(FormatError::Magic {
            format: FORMAT,
            expected: "an <svg> element",
        });
    }
    Ok(Raw::new(points, Precision::Double))
}

fn contains(text: &[u8], part: &[u8]) -> bool {
    text.windows(part.len()).any(|window| window == part)
}

fn circle(tag: &[u8], index: u64) -> Result<[f64; 2], FormatError> {
    let place = FilePlace::Point(index);
    let axis = |name: &str| {
        let value = attribute(tag, name.as_bytes()).ok_or_else(|| FormatError::Header {
            format: FORMAT,
            place,
            reason: format!("the circle has no {name}"),
        })?;
        number(value.trim_ascii(), FORMAT, place)
    };
    Ok([axis("cx")?, axis("cy")?])
}

/// The value of attribute `name` in the text of a tag.
fn attribute<'a>(tag: &'a [u8], name: &[u8]) -> Option<&'a [u8]> {
    let mut rest = tag;
    loop {
        let equals = rest.iter().position(|&b| b == b'=')?;
        let found = rest[..equals]
            .trim_ascii_end()
            .rsplit(u8::is_ascii_whitespace)
            .next()?;
        let value = rest[equals + 1..].trim_ascii_start();
        let (&quote, value) = value
            .split_first()
            .filter(|(q, _)| matches!(q, b'"' | b'\''))?;
        let end = value.iter().position(|&b| b == quote)?;
        if found == name {
            return Some(&value[..end]);
        }
        rest = &value[end + 1..];
    }
}

pub(super) fn write(points: &[[f64; 2]], target: &Target) -> Vec<u8> {
    let [width, height] = match target.region {
        Some(region) => [region.width, region.height],
        None => bounds(points),
    };
    // Without a radius: dots of about a tenth of the mean spacing.
    let spacing = (width * height / points.len() as f64).sqrt();
    let disk = target.radius.map_or(spacing / 10.0, |radius| radius / 2.0);
    let mut out = Vec::with_capacity(points.len() * 64);
    push(
        &mut out,
        format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\">\n\
             <title>{} samples</title>\n<g fill=\"#0072b2\">\n",
            points.len()
        ),
    );
    for [x, y] in points {
        push(
            &mut out,
            format_args!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{disk}\"/>\n"),
        );
    }
    out.extend_from_slice(b"</g>\n</svg>\n");
    out
}

/// A view that shows every point with non-negative coordinates, of size above 0.
fn bounds(points: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|axis| {
        let largest = points.iter().map(|p| p[axis]).fold(0.0, f64::max);
        if largest > 0.0 { largest } else { 1.0 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circles_of_other_hands_are_read() {
        let text = "<?xml version='1.0'?>\n<svg xmlns='x'>\n<!-- <circle cx='9' cy='9'/> a > b <i> -->\
            <rect x='1'/><circle  r = '1' cy='0.25' cx=\"0.5\" style='a=b'/>\r\n<circle\ncx='1'\ncy='2'></circle></svg>";
        let raw = read(text.as_bytes()).expect("two circles");
        assert_eq!(raw.set.points, [[0.5, 0.25], [1.0, 2.0]]);
    }

    #[test]
    fn the_drawing_has_disjoint_disks_and_the_region_as_view() {
        let mut target = Target::new(Format::Svg);
        target.radius = Some(0.5);
        let text = String::from_utf8(write(&[[0.25, 1.0]], &target)).expect("text");
        assert!(text.contains("viewBox=\"0 0 0.25 1\""));
        assert!(text.contains("<circle cx=\"0.25\" cy=\"1\" r=\"0.25\"/>"));
    }

    #[test]
    fn faults_are_named() {
        let message = |text: &str| read(text.as_bytes()).err().expect(text).to_string();
        assert!(message("<html></html>").contains("does not begin with an <svg>"));
        assert!(message("<svg><circle cx='1'/>").contains("point 0: the circle has no cy"));
        assert!(message("<svg><circle cx='1' cy='5%'/>").contains("\"5%\" is not a number"));
        assert!(message("<svg><g transform='scale(2)'>").contains("a transform"));
    }
}
