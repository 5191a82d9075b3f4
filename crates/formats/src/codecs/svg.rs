//! SVG circles in domain units, for drawing and plotting tools.
//!
//! Each point is a disk of half the sampling radius, if that is known, so the disks of a conflict-free set do not overlap.
//! Reads back the circles that are drawn, in user units. What would draw them elsewhere, or draw points in another way, is
//! refused.
//!
//! A picture of dots on paper stands upright: its circles are in a group that is reflected in the middle of the view, where
//! y points up. Their centres are read by their attributes, without the reflection. The dots have radii of their own.

use roxmltree::{Document, Node, ParsingOptions};

use super::drawing::hex;
use super::{Columns, Drawing, Raw, Target};
use crate::error::{FilePlace, FormatError};
use crate::format::{Format, Precision};
use crate::text::{number, push, without_bom};

const FORMAT: Format = Format::Svg;

/// Elements whose content is drawn only where another element refers to it, if at all.
const NOT_DRAWN: [&str; 6] = ["defs", "symbol", "clipPath", "mask", "marker", "pattern"];

/// Elements that draw points of a plot as well as a circle does.
const OTHER_MARKS: [&str; 2] = ["use", "ellipse"];

/// Properties of a style that draw a circle elsewhere than its attributes cx and cy say.
const MOVING: [&str; 7] = [
    "transform",
    "-webkit-transform",
    "translate",
    "rotate",
    "scale",
    "cx",
    "cy",
];

/// Reads the centres of the circles of a drawing.
pub(super) fn read(bytes: &[u8]) -> Result<Raw, FormatError> {
    let bytes = without_bom(bytes);
    let text = std::str::from_utf8(bytes).map_err(|error| FormatError::Malformed {
        format: FORMAT,
        place: FilePlace::Offset(error.valid_up_to() as u64),
        reason: "the text is not UTF-8".to_owned(),
    })?;

    // A few entities can stand for any amount of text. Drawing programs write none that matter here.
    if let Some((before, _)) = text.split_once("<!ENTITY") {
        let line = before.matches('\n').count() + 1;
        let what = format!("the declaration of an entity (line {line})");
        return Err(unsupported(what, "plain SVG without entities can"));
    }

    // Older drawing programs write a document type. Only entities in it could do harm, and were refused above.
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    let document =
        Document::parse_with_options(text, options).map_err(|error| malformed(&error))?;
    if document.root_element().tag_name().name() != "svg" {
        return Err(FormatError::Magic {
            format: FORMAT,
            expected: "an <svg> element",
        });
    }

    refuse_sheets(&document)?;
    let points = circles(&document)?;
    // A drawing without any element is an empty set, which the caller refuses as for all formats. One of other elements is no
    // point set.
    let draws = document.root_element().first_element_child().is_some();
    if points.is_empty() && draws {
        let what = "a drawing without circles".to_owned();
        return Err(unsupported(what, "each <circle> is a point"));
    }
    Ok(Raw::new(points, Precision::Double))
}

fn unsupported(what: String, supported: &'static str) -> FormatError {
    FormatError::Unsupported {
        format: FORMAT,
        what,
        supported,
    }
}

fn malformed(error: &roxmltree::Error) -> FormatError {
    FormatError::Malformed {
        format: FORMAT,
        place: FilePlace::Line(error.pos().row.into()),
        // The error may quote a name of the file, of any length.
        reason: error.to_string().chars().take(120).collect(),
    }
}

/// Returns the centres of the circles that are drawn, in the order of the document.
fn circles(document: &Document<'_>) -> Result<Vec<[f64; 2]>, FormatError> {
    let mut points = Vec::new();
    // The outermost element around the current node that draws its content elsewhere, if there is one.
    let mut mover: Option<Node<'_, '_>> = None;
    // The group around the last circle, if it is one in which y points up.
    let mut last_upward: Option<Node<'_, '_>> = None;
    let root = document.root_element();
    let mut next = Some(root);

    while let Some(node) = next {
        let enters = is_drawn(node);
        let name = node.tag_name().name();
        // Elements of other namespaces are notes of the program that wrote the file.
        if enters && node.tag_name().namespace() == root.tag_name().namespace() {
            // Inside the mover no other one counts; behind its end the next may begin.
            let is_behind = mover.is_none_or(|mover| node.range().start >= mover.range().end);
            if is_behind {
                mover = Some(node).filter(|node| moves(*node, root));
            }

            if name == "circle" {
                let index = points.len() as u64;
                // A circle right inside a group where y points up is read as it stands there.
                let upward_group = mover.filter(|&mover| {
                    let is_inside = node.parent_element() == Some(mover);
                    is_inside && turns_upward(mover, root) && !moves(node, root)
                });
                // A drawing that turns only some of its circles has no common units.
                let are_alike = index == 0 || upward_group.is_some() == last_upward.is_some();
                let mixed = upward_group.or(last_upward).filter(|_| !are_alike);
                let elsewhere = mover.filter(|_| upward_group.is_none());
                if let Some(mover) = elsewhere.or(mixed) {
                    return Err(moved(mover, index));
                }

                last_upward = upward_group;
                points.push(circle(node, index)?);
            } else if OTHER_MARKS.contains(&name) {
                let what = format!("<{name}> (line {})", line_of(node));
                return Err(unsupported(what, "of all marks only <circle> can"));
            }
        }

        // Elements may be nested to any depth, for which recursion could lack the stack. The next node is the first one inside,
        // or else the next behind this one or behind the nearest ancestor that has one.
        let inside = node.first_child().filter(|_| enters);
        next = inside.or_else(|| node.ancestors().find_map(|node| node.next_sibling()));
    }
    Ok(points)
}

/// Whether a node is an element that may draw something where it stands.
fn is_drawn(node: Node<'_, '_>) -> bool {
    let is_hidden = node.attribute("display") == Some("none")
        || (node.attribute("style")).is_some_and(|style| hides(&without_comments(style)));
    node.is_element() && !is_hidden && !NOT_DRAWN.contains(&node.tag_name().name())
}

/// Whether an element draws the circles in it, or itself, elsewhere than their attributes say.
fn moves(node: Node<'_, '_>, root: Node<'_, '_>) -> bool {
    let is_transformed =
        (node.attribute("transform")).is_some_and(|value| !matches!(value.trim(), "" | "none"));
    let style = node.attribute("style").map(without_comments);
    let is_styled = style.is_some_and(|style| moving(&style).is_some());
    // A drawing within the drawing has user units of its own.
    is_transformed || is_styled || (node.tag_name().name() == "svg" && node != root)
}

/// Whether a group of the root is reflected in the middle of the root's view, so that y points up in it. Only what
/// `write` writes is taken for such a group: a view with single blanks between its numbers, and this one text of a
/// transform.
fn turns_upward(group: Node<'_, '_>, root: Node<'_, '_>) -> bool {
    let numbers = root.attribute("viewBox").unwrap_or_default().split(' ');
    let view: Vec<f64> = numbers.filter_map(|number| number.parse().ok()).collect();
    let [_, y, _, height] = view[..] else {
        return false;
    };
    let is_plain = group.tag_name().name() == "g" && group.attribute("style").is_none();
    let is_own = group.parent_element() == Some(root);
    is_plain && is_own && group.attribute("transform") == Some(upward(y, height).as_str())
}

/// Returns the transform that turns a view around, from its lowest y and its height.
fn upward(y: f64, height: f64) -> String {
    format!("matrix(1 0 0 -1 0 {})", 2.0 * y + height)
}

fn moved(mover: Node<'_, '_>, index: u64) -> FormatError {
    let (name, line) = (mover.tag_name().name(), line_of(mover));
    let what = match name {
        "svg" if mover.parent_element().is_some() => {
            format!("an <svg> within another (line {line}), in which circle {index} lies,")
        }
        "circle" => format!("a transform of circle {index} (line {line})"),
        _ => format!("a transform of <{name}> (line {line}), in which circle {index} lies,"),
    };
    unsupported(what, "circles in plain user units can")
}

fn line_of(node: Node<'_, '_>) -> u32 {
    node.document().text_pos_at(node.range().start).row
}

/// Refuses style sheets that draw elements elsewhere, or not at all, wherever they stand: which elements they are for is not
/// found out.
fn refuse_sheets(document: &Document<'_>) -> Result<(), FormatError> {
    let sheets = (document.descendants()).filter(|node| node.tag_name().name() == "style");
    for sheet in sheets {
        let text: String = sheet.children().filter_map(|child| child.text()).collect();
        let (css, line) = (without_comments(&text), line_of(sheet));
        if let Some(property) = moving(&css) {
            let what =
                format!("a style sheet that sets {property}, such as a transform, (line {line})");
            return Err(unsupported(what, "circles in plain user units can"));
        }
        if hides(&css) {
            let what = format!("a style sheet that hides elements by display: none (line {line})");
            return Err(unsupported(
                what,
                "circles that are hidden by their own attributes can",
            ));
        }
    }
    Ok(())
}

/// Returns the first property of some CSS, without comments, that draws an element elsewhere.
fn moving(css: &str) -> Option<&'static str> {
    declarations(css)
        .filter(|(_, value)| !matches!(*value, "" | "none"))
        .find_map(|(name, _)| {
            let mut known = MOVING.into_iter();
            known.find(|known| known.eq_ignore_ascii_case(name))
        })
}

/// Whether some CSS, without comments, hides an element.
fn hides(css: &str) -> bool {
    declarations(css).any(|(name, value)| {
        // A value may end with `!important`.
        let value = value.split('!').next().unwrap_or_default().trim();
        name.eq_ignore_ascii_case("display") && value.eq_ignore_ascii_case("none")
    })
}

/// The names and values of the declarations in some CSS without comments. The selectors of a sheet are among them, with
/// whatever follows their colon.
fn declarations(css: &str) -> impl Iterator<Item = (&str, &str)> {
    css.split([';', '{', '}'])
        .filter_map(|part| part.split_once(':'))
        .map(|(name, value)| (name.trim(), value.trim()))
}

fn without_comments(css: &str) -> String {
    let mut parts = css.split("/*");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        // A comment without an end reaches to the end of the text.
        out.push_str(part.split_once("*/").map_or("", |(_, after)| after));
    }
    out
}

fn circle(node: Node<'_, '_>, index: u64) -> Result<[f64; 2], FormatError> {
    let place = FilePlace::Point(index);
    // A coordinate that is left out is 0.
    let axis = |name| {
        let value = node.attribute(name).unwrap_or("0");
        number(value.trim().as_bytes(), FORMAT, place)
    };
    Ok([axis("cx")?, axis("cy")?])
}

/// Writes a circle for each point, in the order of the points.
pub(super) fn write(points: &[[f64; 2]], target: &Target, columns: &Columns) -> Vec<u8> {
    let [width, height] = match target.region {
        Some(region) => [region.width, region.height],
        None => bounds(points),
    };
    // Adding 0 turns -0 into 0. Otherwise the same place would have two texts.
    let [x, y] = target.origin.map(|at| at + 0.0);
    // Without a sampling radius, the radius of a dot is a tenth of the mean spacing, which was chosen and not measured.
    let spacing = (width * height / points.len() as f64).sqrt();
    let disk = target.radius.map_or(spacing / 10.0, |radius| radius / 2.0);

    // A circle takes about 64 bytes.
    let mut out = Vec::with_capacity(points.len() * 64);
    push(
        &mut out,
        format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{x} {y} {width} {height}\">\n\
             <title>{} samples</title>\n",
            points.len()
        ),
    );
    match &columns.drawing {
        // The blue of Okabe and Ito's palette.
        None => push(&mut out, format_args!("<g fill=\"#0072b2\">\n")),
        Some(Drawing { paper, ink, .. }) => {
            let ([paper, ink], turned) = ([paper, ink].map(|&color| hex(color)), upward(y, height));
            push(
                &mut out,
                format_args!(
                    "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{paper}\"/>\n\
                     <g fill=\"{ink}\" transform=\"{turned}\">\n"
                ),
            );
        }
    }

    // In a picture of dots each dot has a radius that follows from its sample's own.
    for (index, [cx, cy]) in points.iter().enumerate() {
        let own = columns.radii.get(index).copied();
        let dot = columns.drawing.as_ref().zip(own);
        let shown = dot.map_or(disk, |(drawing, own)| drawing.dots.radius(own));
        push(
            &mut out,
            format_args!("<circle cx=\"{cx}\" cy=\"{cy}\" r=\"{shown}\"/>\n"),
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
    use crate::codecs::Dots;

    fn points(text: &str) -> Vec<[f64; 2]> {
        read(text.as_bytes()).expect(text).set.points
    }

    fn message(text: &str) -> String {
        read(text.as_bytes()).err().expect(text).to_string()
    }

    #[test]
    fn circles_of_other_hands_are_read() {
        let text = "<?xml version='1.0'?>\n<!DOCTYPE svg PUBLIC '-//W3C//DTD SVG 1.1//EN' 'svg11.dtd'>\n<svg xmlns='x'>\n\
            <!-- <circle cx='9' cy='9'/> a > b <i> --><rect x='1'/>\
            <circle  r = '1' cy='0.25' cx=\"0.5\" style='a=b'/>\r\n<circle\ncx='1'\ncy='2'></circle></svg>";
        assert_eq!(points(text), [[0.5, 0.25], [1.0, 2.0]]);
    }

    #[test]
    fn only_what_is_drawn_is_a_point() {
        let text = "<svg><defs><g><circle cx='9'/></g></defs><symbol><circle cx='8'/></symbol>\
            <clipPath><circle cx='7'/></clipPath><g display='none'><circle cx='6'/></g>\
            <circle style='fill: red; display: none' cx='5'/><text>&lt;circle cx='4'/></text>\
            <desc><![CDATA[<circle cx='3'/>]]></desc><n:circle xmlns:n='notes' cx='2'/>\
            <g><circle cx='1' cy='0.5'/></g></svg>";
        assert_eq!(points(text), [[1.0, 0.5]]);
    }

    #[test]
    fn coordinates_left_out_are_0() {
        let text = "<svg><circle r='1'/><circle cx='5'/><circle cy='5'/></svg>";
        assert_eq!(points(text), [[0.0, 0.0], [5.0, 0.0], [0.0, 5.0]]);
    }

    #[test]
    fn transforms_of_circles_are_refused_by_their_place() {
        let in_group = |group: &str| format!("<svg>\n<{group}>\n<a><circle cx='1'/></a></g></svg>");
        let refusal = "SVG: a transform of <g> (line 2), in which circle 0 lies, cannot be read; \
                       circles in plain user units can";
        for group in [
            "g transform='scale(2)'",
            "g style='fill:red;transform: scale(2)'",
            "g style='/* a: b */ Rotate:4deg'",
            "g style='-webkit-transform:scale(2)'",
        ] {
            assert_eq!(message(&in_group(group)), refusal, "{group}");
        }
        for group in ["g transform=''", "g style='transform:none; /* scale: 2 */'"] {
            assert_eq!(points(&in_group(group)), [[1.0, 0.0]], "{group}");
        }

        let own = "<svg><circle cx='1'/><circle transform='translate(1 2)'/></svg>";
        assert!(message(own).contains("a transform of circle 1 (line 1)"));
        let moved = message("<svg><circle style='cx: 4px'/></svg>");
        assert!(moved.contains("a transform of circle 0"), "{moved}");
        let root = message("<svg transform='scale(2)'><circle/></svg>");
        assert!(root.contains("a transform of <svg> (line 1)"), "{root}");
        let within = message("<svg><svg x='4'><circle/></svg></svg>");
        assert!(within.contains("an <svg> within another (line 1), in which circle 0 lies"));
    }

    #[test]
    fn what_moves_no_circle_may_be_transformed() {
        let text = "<svg><g transform='scale(2)'><text>a</text></g><circle cx='1'/>\
            <g transform='scale(2)'><defs><circle/></defs></g><circle cx='2'/></svg>";
        assert_eq!(points(text), [[1.0, 0.0], [2.0, 0.0]]);
    }

    #[test]
    fn style_sheets_that_move_are_refused() {
        let sheet = |css: &str| format!("<svg><defs><style>{css}</style></defs><circle/></svg>");
        for css in [
            "circle { fill: red; transform: scale(2) }",
            "<![CDATA[ .a{translate:1px} ]]>",
            "@media print { circle { cx: 3px } }",
        ] {
            assert!(
                message(&sheet(css)).contains("a style sheet that sets"),
                "{css}"
            );
        }
        let css = "a:hover { text-transform: none; transform-origin: 0 } /* transform: scale(2) */";
        assert_eq!(points(&sheet(css)), [[0.0, 0.0]]);
    }

    #[test]
    fn style_sheets_that_hide_are_refused() {
        let sheet = |css: &str| format!("<svg><style>{css}</style><circle class='a'/></svg>");
        for css in [
            ".a{display:none}",
            ".a { fill: red; DISPLAY: none !important }",
        ] {
            assert!(
                message(&sheet(css)).contains("a style sheet that hides elements"),
                "{css}"
            );
        }
        let css = ".a{display:inline; text-decoration: none} /* display: none */";
        assert_eq!(points(&sheet(css)), [[0.0, 0.0]]);
        let own = "<svg><circle style='Display: none!important'/><circle cx='1'/></svg>";
        assert_eq!(points(own), [[1.0, 0.0]]);
    }

    #[test]
    fn other_marks_are_refused_by_name() {
        let used = "<svg>\n<defs><path id='m'/></defs>\n<g><use href='#m' x='1'/></g></svg>";
        assert_eq!(
            message(used),
            "SVG: <use> (line 3) cannot be read; of all marks only <circle> can"
        );
        assert!(message("<svg><circle/><ellipse cx='1'/></svg>").contains("<ellipse> (line 1)"));
        assert!(message("<svg><path d='M0 0'/></svg>").contains("each <circle> is a point"));
    }

    #[test]
    fn deep_and_vast_documents_are_harmless() {
        let deep = format!("<svg>{}", "<g>".repeat(100_000));
        assert!(message(&deep).contains("SVG: line 1: "));
        let closed = format!("{deep}<circle/>{}</svg>", "</g>".repeat(100_000));
        assert_eq!(points(&closed), [[0.0, 0.0]]);
        let entities = "<!DOCTYPE svg [\n<!ENTITY a 'aaaa'>]><svg>&a;<circle/></svg>";
        assert!(message(entities).contains("the declaration of an entity (line 2)"));
    }

    #[test]
    fn the_drawing_has_disjoint_disks_and_the_region_as_view() {
        let mut target = Target::new(Format::Svg);
        target.radius = Some(0.5);
        let bytes = write(&[[0.25, 1.0]], &target, &Columns::default());
        let text = String::from_utf8(bytes).expect("text");
        assert!(text.contains("viewBox=\"0 0 0.25 1\""));
        assert!(text.contains("<circle cx=\"0.25\" cy=\"1\" r=\"0.25\"/>"));
    }

    #[test]
    fn dots_on_paper_stand_upright_and_are_read_as_they_are() {
        let drawing = |dots| Drawing {
            paper: [0, 16, 255],
            ink: [255, 255, 255],
            dots,
        };
        let target = Target {
            region: Some(tilescope_analysis::Region::new([4.0, 3.0], false)),
            origin: [0.0, 10.0],
            ..Target::new(Format::Svg)
        };
        let set = [[1.0, 10.5], [2.0, 12.0]];
        let text = |dots| {
            let columns = Columns {
                radii: vec![0.5, 0.25],
                drawing: Some(drawing(dots)),
                ..Columns::default()
            };
            String::from_utf8(write(&set, &target, &columns)).expect("text")
        };

        let constant = text(Dots::Constant(0.125));
        assert!(constant.contains("fill=\"#0010ff\"/>\n<g fill=\"#ffffff\""));
        assert!(constant.contains("transform=\"matrix(1 0 0 -1 0 23)\""));
        assert!(constant.contains("<circle cx=\"1\" cy=\"10.5\" r=\"0.125\"/>"));
        assert_eq!(points(&constant), set);
        let dense = text(Dots::ByDensity(0.0625));
        assert!(dense.contains("r=\"0.125\"/>\n") && dense.contains("r=\"0.25\"/>\n"));
        assert_eq!(points(&dense), set);

        // Another reflection, a circle that is moved in the group, and one outside of it are refused.
        let other = constant.replace("0 23)", "0 24)");
        assert!(message(&other).contains("a transform of <g>"), "{other}");
        let moved = constant.replacen("cx=\"1\"", "transform=\"scale(2)\" cx=\"1\"", 1);
        assert!(message(&moved).contains("a transform of <g>"));
        let outside = constant.replace("</svg>", "<circle/></svg>");
        assert!(message(&outside).contains("in which circle 2 lies"));
        let before = constant.replace("<title>", "<circle/><title>");
        assert!(message(&before).contains("in which circle 1 lies"));
    }

    #[test]
    fn faults_are_named() {
        assert!(message("<html></html>").contains("does not begin with an <svg>"));
        let number = message("<svg><circle cx='1' cy='5%'/></svg>");
        assert!(
            number.contains("point 0: \"5%\" is not a number"),
            "{number}"
        );
        let open = message("<svg>\n<circle cx='1'>\n</svg>");
        assert!(open.starts_with("SVG: line 3: "), "{open}");
        let bytes = read(b"<svg>\xFF</svg>").err().expect("no text").to_string();
        assert_eq!(bytes, "SVG: byte 5: the text is not UTF-8");
    }
}
