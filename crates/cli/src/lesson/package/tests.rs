use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{Cursor, Read as _};

use roxmltree::{Document, Node};
use tempfile::TempDir;
use tilescope_lessons::Lesson;
use zip::ZipArchive;

use super::*;

/// The one script of the built page below.
const SCRIPT: &str =
    "import('./lessons-0123456789ab.json'); import('./tilescope-0123456789ab.wasm');";

/// Makes a folder that looks like a built page.
fn built_page() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let lessons = tilescope_lessons::shipped::to_json(&tilescope_lessons::shipped::Loaded {
        lessons: Vec::new(),
        tables: [("de".to_owned(), "Words\n    Wörter".to_owned())].into(),
    });
    // The texts of the page of a package, as the packer puts them into one file.
    let course = [
        "index.html",
        "course.css",
        "course.js",
        "record.js",
        "scorm.js",
        "cmi5.js",
    ];
    let texts = course.map(|name| {
        let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../web/course")).join(name);
        (name, fs::read_to_string(file).unwrap())
    });
    let course = serde_json::to_string(&BTreeMap::from(texts)).unwrap();
    // What the first document leads to, and what a package has no use for.
    for (name, text) in [
        (
            "index.html",
            "<meta content=\"course-0123456789ab.json\"><script src=\"main-0123456789ab.js\"></script><div id=\"site\"><img src=\"hero-0123456789ab.svg\"></div>\
             <template id=\"program\">Program</template>",
        ),
        ("course-0123456789ab.json", &course),
        ("main-0123456789ab.js", SCRIPT),
        ("main-0123456789ab.js.br", "compressed"),
        ("lessons-0123456789ab.json", &lessons),
        ("tilescope-0123456789ab.wasm", "module"),
        ("hero-0123456789ab.svg", "only the first page shows it"),
        ("sw.js", "a service worker"),
        ("robots.txt", "for search engines"),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    fs::create_dir(folder.path().join("example")).unwrap();
    folder
}

/// Returns the arguments of a package that is made of such a folder, with others as on the command line.
fn arguments(folder: &TempDir, lesson: &str, others: &[&str]) -> PackageArguments {
    #[derive(Debug, clap::Parser)]
    struct Line {
        #[command(flatten)]
        arguments: PackageArguments,
    }
    let out = folder.path().join("out.zip");
    let fixed = [
        "package",
        lesson,
        "--out",
        &named(&out),
        "--folder",
        &named(folder.path()),
    ]
    .map(str::to_owned);
    let line = fixed
        .into_iter()
        .chain(others.iter().map(|&other| other.to_owned()));
    <Line as clap::Parser>::try_parse_from(line)
        .unwrap()
        .arguments
}

/// Makes a package; returns its files by their paths.
fn made(folder: &TempDir, lesson: &str, others: &[&str]) -> BTreeMap<String, String> {
    let said = package(&arguments(folder, lesson, others)).unwrap();
    assert!(
        said.contains("out.zip: ") && said.contains("question"),
        "{said}"
    );

    // Read back by the names that the archive itself lists.
    let bytes = fs::read(folder.path().join("out.zip")).unwrap();
    let mut archive = ZipArchive::new(Cursor::new(bytes)).unwrap();
    let mut files = BTreeMap::new();
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index).unwrap();
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).unwrap();
        let name = entry.name().unwrap().into_owned();
        files.insert(name, String::from_utf8(bytes).unwrap());
    }
    files
}

/// Returns the data of a package's page.
fn lesson_of(files: &BTreeMap<String, String>) -> serde_json::Value {
    let text = files["lesson.js"].trim_start_matches("export const LESSON = ");
    serde_json::from_str(text.trim_end().trim_end_matches(';')).unwrap()
}

/// The text of the first element at a path, or its attribute where the path ends in `@NAME`; `None` if there is none. Names
/// count without their namespaces.
fn at<'a>(document: &'a Document<'_>, path: &str) -> Option<&'a str> {
    // Of several children of a name the first counts: manifests have one of each that is asked for here.
    let mut node = document.root();
    for name in path.split('/') {
        if let Some(attribute) = name.strip_prefix('@') {
            let mut attributes = node.attributes();
            return attributes
                .find(|one| one.name() == attribute)
                .map(|one| one.value());
        }
        node = node
            .children()
            .find(|child: &Node<'_, '_>| child.has_tag_name_of(name))?;
    }
    node.text()
}

/// Compares names without their namespaces.
trait HasName {
    fn has_tag_name_of(&self, name: &str) -> bool;
}

impl HasName for Node<'_, '_> {
    fn has_tag_name_of(&self, name: &str) -> bool {
        self.is_element() && self.tag_name().name() == name
    }
}

/// The options of a package, and what its manifest must have.
type Needed = (
    &'static [&'static str],
    &'static [(&'static str, &'static str)],
);

/// What a course system needs of each kind of manifest: the path of an element or attribute, and what stands there.
const NEEDED: [Needed; 3] = [
    (
        &["--scorm", "1.2"],
        &[
            ("manifest/@identifier", "tilescope.gaps"),
            ("manifest/metadata/schema", "ADL SCORM"),
            ("manifest/metadata/schemaversion", "1.2"),
            ("manifest/organizations/@default", "course"),
            ("manifest/organizations/organization/@identifier", "course"),
            (
                "manifest/organizations/organization/title",
                "Why three samples",
            ),
            (
                "manifest/organizations/organization/item/@identifierref",
                "page",
            ),
            (
                "manifest/organizations/organization/item/title",
                "Why three samples",
            ),
            ("manifest/resources/resource/@identifier", "page"),
            ("manifest/resources/resource/@type", "webcontent"),
            ("manifest/resources/resource/@scormtype", "sco"),
            ("manifest/resources/resource/@href", "index.html"),
        ],
    ),
    (
        &["--scorm", "2004"],
        &[
            ("manifest/@identifier", "tilescope.gaps"),
            ("manifest/metadata/schemaversion", "2004 4th Edition"),
            ("manifest/organizations/@default", "course"),
            (
                "manifest/organizations/organization/item/@identifierref",
                "page",
            ),
            (
                "manifest/organizations/organization/item/sequencing/deliveryControls/@completionSetByContent",
                "true",
            ),
            (
                "manifest/organizations/organization/item/sequencing/deliveryControls/@objectiveSetByContent",
                "true",
            ),
            (
                "manifest/organizations/organization/sequencing/controlMode/@flow",
                "true",
            ),
            ("manifest/resources/resource/@scormType", "sco"),
            ("manifest/resources/resource/@href", "index.html"),
        ],
    ),
    (
        &["--cmi5"],
        &[
            ("courseStructure/course/@id", "urn:tilescope:course:gaps"),
            (
                "courseStructure/course/title/langstring",
                "Why three samples",
            ),
            ("courseStructure/course/title/langstring/@lang", "en"),
            ("courseStructure/au/@id", "urn:tilescope:lesson:gaps"),
            ("courseStructure/au/@moveOn", "Completed"),
            ("courseStructure/au/title/langstring", "Why three samples"),
            ("courseStructure/au/url", "index.html"),
        ],
    ),
];

#[test]
fn a_manifest_has_what_its_system_needs() {
    let folder = built_page();
    for (system, needed) in NEEDED {
        let files = made(&folder, "gaps", system);
        let name = if system == ["--cmi5"] {
            "cmi5.xml"
        } else {
            "imsmanifest.xml"
        };
        let document = Document::parse(&files[name]).unwrap();
        for (path, value) in needed {
            assert_eq!(at(&document, path), Some(*value), "{system:?} {path}");
        }
    }

    // The control: what another system needs is not there.
    let files = made(&folder, "gaps", &["--scorm", "1.2"]);
    let document = Document::parse(&files["imsmanifest.xml"]).unwrap();
    assert_eq!(
        at(&document, "manifest/resources/resource/@scormType"),
        None
    );
    assert_eq!(at(&document, "courseStructure/au/url"), None);
}

#[test]
fn an_archive_has_the_files_of_its_manifest_and_no_other() {
    let folder = built_page();
    for version in ["1.2", "2004"] {
        let files = made(&folder, "gaps", &["--scorm", version]);
        let document = Document::parse(&files["imsmanifest.xml"]).unwrap();
        let listed = document
            .descendants()
            .filter(|node| node.has_tag_name_of("file"));
        let listed: BTreeSet<&str> = listed.filter_map(|file| file.attribute("href")).collect();
        let mut there: BTreeSet<&str> = files.keys().map(String::as_str).collect();
        assert!(there.remove("imsmanifest.xml"));
        assert_eq!(listed, there);

        // What the program needs in a frame is there; what only the first page, a server or a service worker needs is not.
        assert!(
            there.contains("program/tilescope-0123456789ab.wasm"),
            "{there:?}"
        );
        assert_eq!(there.len(), 6 + 4, "{there:?}");
        assert!(!files["program/index.html"].contains("hero"));
        assert!(files["program/index.html"].contains("Program"));
        assert!(!files.keys().any(|path| path.ends_with("cmi5.js")));
    }
}

#[test]
fn a_page_has_no_script_or_style_within_it_and_reaches_the_network_for_cmi5_alone() {
    let folder = built_page();
    for (system, reached) in [
        (["--scorm", "1.2"].as_slice(), "connect-src 'none'"),
        (["--cmi5"].as_slice(), "connect-src 'self' https: http:"),
    ] {
        let files = made(&folder, "gaps", system);
        let page = files["index.html"].replace("&apos;", "'");
        assert!(
            page.contains(reached) && page.contains("script-src 'self';"),
            "{page}"
        );
        assert!(!page.contains("[[") && !page.contains("style=") && !page.contains("unsafe"));
        assert_eq!(
            page.matches("<script").count(),
            page.matches("></script>").count()
        );
    }
}

#[test]
fn the_page_knows_all_questions_of_the_lesson_or_of_the_chosen_steps() {
    let folder = built_page();
    let whole = lesson_of(&made(&folder, "survivors", &["--scorm", "1.2"]));
    let all = tilescope_lessons::shipped::lessons();
    let survivors = all.iter().find(|one| one.name == "survivors").unwrap();
    let lesson = Lesson::read("survivors", &survivors.text).unwrap();
    let gates: Vec<&str> = lesson.gates().map(|(_, gate)| &*gate.name).collect();
    let names = |told: &serde_json::Value| -> Vec<String> {
        let questions = told["questions"].as_array().unwrap().iter();
        questions
            .map(|one| one["gate"].as_str().unwrap().to_owned())
            .collect()
    };
    assert_eq!(names(&whole), gates);
    assert_eq!(
        (&whole["mastery"], &whole["languages"]),
        (&serde_json::Value::Null, &serde_json::json!(["en", "de"]))
    );

    let steps = [
        "--scorm",
        "1.2",
        "--steps",
        "too-close,chain",
        "--pass",
        "60",
        "--language",
        "de",
    ];
    let files = made(&folder, "survivors", &steps);
    let part = lesson_of(&files);
    assert_eq!(names(&part), ["chain"]);
    assert_eq!(
        (&part["mastery"], &part["language"]),
        (&serde_json::json!(0.6), &serde_json::json!("de"))
    );
    let seed = whole["questions"]
        .as_array()
        .unwrap()
        .iter()
        .find(|one| one["gate"] == "chain")
        .unwrap()["seed"]
        .clone();
    assert_eq!(
        (&part["questions"][0]["seed"], seed.as_u64()),
        (&seed, Some(12))
    );

    // The program in the frame has this lesson alone, with its translation and the words of the page.
    let list =
        tilescope_lessons::shipped::from_json(&files["program/lessons-0123456789ab.json"]).unwrap();
    assert_eq!((list.lessons.len(), list.tables.len()), (1, 1));
    assert_eq!(list.lessons[0].german, survivors.german);
    let in_frame = Lesson::read("survivors", &list.lessons[0].text).unwrap();
    assert_eq!(
        (in_frame.steps.len(), &*in_frame.hash),
        (2, part["hash"].as_str().unwrap())
    );
    let document = Document::parse(&files["imsmanifest.xml"]).unwrap();
    assert_eq!(
        at(&document, "manifest/organizations/organization/title"),
        Some("Wer übrig bleibt")
    );
    assert_eq!(
        at(&document, "manifest/@identifier"),
        Some("tilescope.survivors.too-close.chain")
    );
}

#[test]
fn a_score_to_pass_with_decides_when_a_course_goes_on() {
    let folder = built_page();
    let files = made(&folder, "gaps", &["--cmi5", "--pass", "60"]);
    let document = Document::parse(&files["cmi5.xml"]).unwrap();
    assert_eq!(
        at(&document, "courseStructure/au/@moveOn"),
        Some("CompletedAndPassed")
    );
    assert_eq!(
        at(&document, "courseStructure/au/@masteryScore"),
        Some("0.6")
    );
}

#[test]
fn texts_of_a_lesson_are_no_markup_and_no_part_of_names() {
    let folder = built_page();
    // Signs of markup in the title, letters that identifiers cannot have in the names of the file and of the question.
    let text = "---\ntitle: A < B & \"C\"\nobjective: x\n---\n# One\n```run\nradius: 0.1\nleaf: 6\n```\n\
                ```gate größer\ntype: number\nask: How many?\nanswer: 1\n```\n";
    let file = folder.path().join("my lesson ü.md");
    fs::write(&file, text).unwrap();
    for system in [["--scorm", "2004"].as_slice(), ["--cmi5"].as_slice()] {
        let files = made(&folder, &named(&file), system);
        let manifest = files
            .iter()
            .find(|(name, _)| ["imsmanifest.xml", "cmi5.xml"].contains(&name.as_str()))
            .unwrap()
            .1;
        let document = Document::parse(manifest).unwrap();
        let titles = document
            .descendants()
            .filter(|node| node.text() == Some("A < B & \"C\""));
        assert!(titles.count() >= 2, "{manifest}");
        assert!(manifest.contains("my_20lesson_20_c3_bc"), "{manifest}");
        assert!(files["index.html"].contains("<title>A &lt; B &amp; &quot;C&quot;</title>"));
        let told = lesson_of(&files);
        assert_eq!(
            (&told["questions"][0]["id"], &told["languages"]),
            (&serde_json::json!("question-1"), &serde_json::json!(["en"]))
        );
    }
}

#[test]
fn the_same_lesson_gives_the_same_bytes() {
    let folder = built_page();
    // The second package replaces the first one in its place.
    let bytes = |others: &[&str]| {
        package(&arguments(&folder, "gaps", others)).unwrap();
        fs::read(folder.path().join("out.zip")).unwrap()
    };
    let first = bytes(&["--scorm", "1.2"]);
    assert_eq!(first, bytes(&["--scorm", "1.2"]));
    assert_ne!(first, bytes(&["--scorm", "2004"]));
}

#[test]
fn what_cannot_be_packed_is_named_and_leaves_no_file() {
    let folder = built_page();
    let plain = folder.path().join("plain.md");
    fs::write(
        &plain,
        "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.1\nleaf: 6\n```\nWords.\n",
    )
    .unwrap();
    // A translation that is there is not left out if it cannot be read, even if the package begins in English.
    let translated = folder.path().join("translated.md");
    fs::copy(&plain, &translated).unwrap();
    fs::write(folder.path().join("translated.de.md"), b"\xc3\x28").unwrap();
    let translated = named(&translated);

    let empty = tempfile::tempdir().unwrap();
    let (plain, empty_folder) = (named(&plain), named(empty.path()));

    for (lesson, others, said) in [
        ("nothing", vec!["--cmi5"], "\"nothing\" is no file"),
        (plain.as_str(), vec!["--cmi5"], "the lesson has no question"),
        (
            "gaps",
            vec!["--cmi5", "--steps", "nowhere"],
            "there is no step \"nowhere\"",
        ),
        ("gaps", vec!["--cmi5", "--language", "fr"], "en and de"),
        (
            plain.as_str(),
            vec!["--cmi5", "--language", "de"],
            "plain.de.md",
        ),
        (translated.as_str(), vec!["--cmi5"], "translated.de.md"),
    ] {
        let error = package(&arguments(&folder, lesson, &others)).unwrap_err();
        assert!(format!("{error:#}").contains(said), "{error:#}");
    }

    // A folder without a page, and one with a page that has no part for the program.
    let mut without_page = arguments(&folder, "gaps", &["--cmi5"]);
    without_page.folder = Some(empty.path().to_owned());
    let error = format!("{:#}", package(&without_page).unwrap_err());
    assert!(
        error.contains(&empty_folder) && error.contains("web/build"),
        "{error}"
    );
    fs::write(empty.path().join("index.html"), "an older page").unwrap();
    let error = format!("{:#}", package(&without_page).unwrap_err());
    assert!(error.contains("another version"), "{error}");

    // A name that systems would not take for an archive.
    let mut elsewhere = arguments(&folder, "gaps", &["--cmi5"]);
    elsewhere.out = folder.path().join("out.pdf");
    assert!(
        package(&elsewhere)
            .unwrap_err()
            .to_string()
            .contains(".zip")
    );
    assert!(!folder.path().join("out.zip").exists());
}
