//! Manifests of packages: what a course system reads first. SCORM lists all files, cmi5 names the page alone. Begin with [`of`].

use std::io;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, BytesText, Event};

use super::CourseSystem;

/// What a course system shows of a package, and how it counts.
#[derive(Clone, Debug)]
pub struct Description {
    /// Its name among the packages of a course: letters, digits, hyphens, underscores and dots.
    pub id: String,
    /// The title of the lesson.
    pub title: String,
    /// What a learner can do afterwards.
    pub objective: String,
    /// The language of both.
    pub language: String,
    /// The share of the score from which on the lesson counts as passed, if there is one.
    pub mastery: Option<f64>,
}

/// Returns the name that the manifest has in a package, and its bytes. `files` are the paths of all other files.
///
/// # Errors
///
/// None that can occur: it is written into memory.
pub fn of(
    system: CourseSystem,
    package: &Description,
    files: &[&str],
) -> io::Result<(&'static str, Vec<u8>)> {
    let (name, root) = match system {
        CourseSystem::Scorm12 => ("imsmanifest.xml", scorm_12(package, files)),
        CourseSystem::Scorm2004 => ("imsmanifest.xml", scorm_2004(package, files)),
        CourseSystem::Cmi5 => ("cmi5.xml", cmi5(package)),
    };

    // Indented, since lecturers look into it when a system refuses a package.
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
    writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    root.write(&mut writer)?;
    let mut bytes = writer.into_inner();
    bytes.push(b'\n');
    Ok((name, bytes))
}

/// An element of a manifest.
struct Element {
    name: &'static str,
    attributes: Vec<(&'static str, String)>,
    text: String,
    children: Vec<Element>,
}

/// Returns an element with attributes.
fn element(name: &'static str, attributes: &[(&'static str, &str)]) -> Element {
    let attributes = attributes.iter();
    Element {
        name,
        attributes: attributes
            .map(|&(name, value)| (name, value.to_owned()))
            .collect(),
        text: String::new(),
        children: Vec::new(),
    }
}

/// Returns an element that holds a text alone.
fn saying(name: &'static str, text: &str) -> Element {
    // XML 1.0 has no place for most control characters, not even as references, and these texts need none.
    let clean = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    Element {
        text: text.chars().map(clean).collect(),
        ..element(name, &[])
    }
}

impl Element {
    /// Returns it with children.
    fn holding(self, children: impl IntoIterator<Item = Self>) -> Self {
        Self {
            children: children.into_iter().collect(),
            ..self
        }
    }

    /// Writes the element with its attributes, text and children.
    fn write(&self, writer: &mut Writer<Vec<u8>>) -> io::Result<()> {
        // Quotes and signs of markup in values and texts are escaped by the writer.
        let attributes = self.attributes.iter();
        let pairs = attributes.map(|(name, value)| (*name, value.as_str()));
        let start = BytesStart::new(self.name).with_attributes(pairs);
        if self.children.is_empty() && self.text.is_empty() {
            return writer.write_event(Event::Empty(start));
        }

        writer.write_event(Event::Start(start))?;
        if !self.text.is_empty() {
            writer.write_event(Event::Text(BytesText::new(&self.text)))?;
        }
        for child in &self.children {
            child.write(writer)?;
        }
        writer.write_event(Event::End(BytesEnd::new(self.name)))
    }
}

/// Returns the kind of the package and its version.
fn metadata(version: &str) -> Element {
    element("metadata", &[]).holding([
        saying("schema", "ADL SCORM"),
        saying("schemaversion", version),
    ])
}

/// Returns the page with all of its files. The name of the attribute that says that it reports differs between versions.
fn resources(kind: &'static str, files: &[&str]) -> Element {
    let page = [
        ("identifier", "page"),
        ("type", "webcontent"),
        (kind, "sco"),
        ("href", "index.html"),
    ];
    let listed = files.iter().map(|file| element("file", &[("href", file)]));
    element("resources", &[]).holding([element("resource", &page).holding(listed)])
}

/// Returns the manifest of SCORM 1.2. It names no score to pass with: systems would count a lesson as failed from the first wrong
/// answer on, and the page says itself whether it is passed, once all is done.
fn scorm_12(package: &Description, files: &[&str]) -> Element {
    let item = element(
        "item",
        &[("identifier", "lesson"), ("identifierref", "page")],
    );
    let course = element("organization", &[("identifier", "course")]).holding([
        saying("title", &package.title),
        item.holding([saying("title", &package.title)]),
    ]);

    // A system that holds several packages distinguishes them by this.
    let id = format!("tilescope.{}", package.id);
    let root = [
        ("identifier", &*id),
        ("version", "1.0"),
        ("xmlns", "http://www.imsproject.org/xsd/imscp_rootv1p1p2"),
        ("xmlns:adlcp", "http://www.adlnet.org/xsd/adlcp_rootv1p2"),
    ];
    element("manifest", &root).holding([
        metadata("1.2"),
        element("organizations", &[("default", "course")]).holding([course]),
        resources("adlcp:scormtype", files),
    ])
}

/// Returns the manifest of SCORM 2004, fourth edition. Its sequencing says how the lesson is reached, and that the page
/// itself reports completion and success.
fn scorm_2004(package: &Description, files: &[&str]) -> Element {
    let by_page = [
        ("completionSetByContent", "true"),
        ("objectiveSetByContent", "true"),
    ];
    // Otherwise a system would take the lesson for completed as soon as it is left.
    let delivery = element("imsss:deliveryControls", &by_page);
    let item = element(
        "item",
        &[("identifier", "lesson"), ("identifierref", "page")],
    );
    // A learner may choose the lesson in a list, and come to it from the one before.
    let ways = element("imsss:controlMode", &[("choice", "true"), ("flow", "true")]);
    let course = element("organization", &[("identifier", "course")]).holding([
        saying("title", &package.title),
        item.holding([
            saying("title", &package.title),
            element("imsss:sequencing", &[]).holding([delivery]),
        ]),
        element("imsss:sequencing", &[]).holding([ways]),
    ]);

    let id = format!("tilescope.{}", package.id);
    let root = [
        ("identifier", &*id),
        ("version", "1"),
        ("xmlns", "http://www.imsglobal.org/xsd/imscp_v1p1"),
        ("xmlns:adlcp", "http://www.adlnet.org/xsd/adlcp_v1p3"),
        ("xmlns:imsss", "http://www.imsglobal.org/xsd/imsss"),
    ];
    element("manifest", &root).holding([
        metadata("2004 4th Edition"),
        element("organizations", &[("default", "course")]).holding([course]),
        resources("adlcp:scormType", files),
    ])
}

/// Returns the course of cmi5, with the lesson as its only unit.
fn cmi5(package: &Description) -> Element {
    let in_language = |name: &'static str, text: &str| {
        let mut said = saying("langstring", text);
        said.attributes.push(("lang", package.language.clone()));
        element(name, &[]).holding([said])
    };
    // The course and its one unit have the same texts, and cmi5 asks for both.
    let texts = || {
        [
            in_language("title", &package.title),
            in_language("description", &package.objective),
        ]
    };

    let [course, unit] =
        ["course", "lesson"].map(|kind| format!("urn:tilescope:{kind}:{}", package.id));
    // Without a score to pass with, no learner passes, and a system that waited for it would never go on.
    let mastery = package.mastery.map(|mastery| mastery.to_string());
    let mut attributes = vec![("id", &*unit)];
    match &mastery {
        Some(mastery) => {
            attributes.extend([("moveOn", "CompletedAndPassed"), ("masteryScore", mastery)]);
        }
        None => attributes.push(("moveOn", "Completed")),
    }

    let page = [saying("url", "index.html")];
    let namespace = "https://w3id.org/xapi/profiles/cmi5/v1/CourseStructure.xsd";
    element("courseStructure", &[("xmlns", namespace)]).holding([
        element("course", &[("id", &course)]).holding(texts()),
        element("au", &attributes).holding(texts().into_iter().chain(page)),
    ])
}
