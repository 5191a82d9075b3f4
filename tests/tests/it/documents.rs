//! Checks the documents: the paths that they name exist, and their generated parts are up to date.
//!
//! With `TILESCOPE_RENEW=1` the generated parts are written anew.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use tilescope_session::glossary::terms;

use crate::arrows::{CrateMap, map};
use crate::circles::{graph, sources};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Returns the documents whose paths must exist.
fn documents() -> Vec<PathBuf> {
    let fixed = [
        "README.md",
        ".github/CONTRIBUTING.md",
        "crates/README.md",
        "crates/STYLE.md",
        "crates/c/README.md",
        "crates/cli/README.md",
        "crates/python/README.md",
        "crates/python/distributed.md",
        "web/ACCESSIBILITY.md",
        "web/README.md",
    ];
    let mut all = fixed.map(PathBuf::from).to_vec();
    let decisions = fs::read_dir(root().join("crates/decisions")).expect("decisions");
    all.extend(
        decisions
            .map(|entry| Path::new("crates/decisions").join(entry.expect("an entry").file_name())),
    );
    all
}

/// Folders that tests and commands make.
const MADE: [&str; 4] = [
    "lesson/NAME/",
    "lesson/NAME/de/",
    "web/dist",
    "tilescope-out/",
];

/// Returns whether a text between backquotes names a file or a folder of this tree. Where a paragraph is about a crate, it
/// names Rust files without their folder, too.
fn looks_like_a_path(text: &str, in_crate: bool) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-".contains(c);
    let extension = Path::new(text).extension().and_then(|e| e.to_str());
    if in_crate && extension == Some("rs") {
        return true;
    }
    if !text.contains('/') || text.starts_with('/') || !text.chars().all(plain) {
        return false;
    }
    let known = [
        "rs", "wgsl", "mjs", "js", "json", "md", "toml", "txt", "png", "html",
    ];
    let folders = ["crates", "tests", "web", "assets"];
    let first = text.split('/').next().unwrap_or_default();
    extension.is_some_and(|extension| known.contains(&extension))
        || folders.contains(&first)
        || text.ends_with('/')
        || root().join("crates").join(first).is_dir()
}

/// Returns the file or folder that a document means: paths begin at the root, in `crates`, beside the document, or in the
/// sources of the crate that a paragraph is about.
fn resolve(document: &Path, sources: Option<&Path>, path: &str) -> Option<PathBuf> {
    let beside = document.parent().expect("a folder");
    let bases = [Path::new(""), Path::new("crates"), beside];
    let bases = bases.into_iter().chain(sources);
    let mut candidates = bases.map(|base| root().join(base).join(path));
    candidates.find(|candidate| candidate.exists())
}

/// Returns the sources of the crate that a paragraph is about: it begins with the crate's name in bold.
fn sources_of(line: &str) -> Option<PathBuf> {
    let name = line.strip_prefix("**")?.split("**").next()?;
    let sources = Path::new("crates").join(name).join("src");
    root().join(&sources).is_dir().then_some(sources)
}

/// Returns the texts between single backquotes of a line, each with the text after it.
fn quoted(line: &str) -> Vec<(&str, &str)> {
    let pieces: Vec<&str> = line.split('`').collect();
    let odd = pieces.iter().skip(1).step_by(2).copied();
    let even = pieces.iter().skip(2).step_by(2).copied();
    odd.zip(even).collect()
}

/// Returns the paths between backquotes, the names in brackets behind a Rust file, and the links of a document that do
/// not exist.
fn missing(document: &Path, text: &str) -> Vec<String> {
    let mut missing = Vec::new();
    let mut code = false;
    // A name may stand on the line after its file.
    let mut file: Option<(PathBuf, String)> = None;
    let mut sources: Option<PathBuf> = None;
    for line in text.lines() {
        if line.starts_with("```") {
            code = !code;
        }
        if code || line.starts_with("```") {
            continue;
        }
        sources = sources_of(line).or(sources).filter(|_| !line.is_empty());
        let mut in_brackets = line.starts_with("  (`");
        for (text, follows) in quoted(line) {
            if looks_like_a_path(text, sources.is_some()) && !MADE.contains(&text) {
                let found = resolve(document, sources.as_deref(), text);
                if found.is_none() {
                    missing.push(text.to_owned());
                }
                file = found.map(|path| (path, text.to_owned()));
                in_brackets = follows.ends_with(" (") && follows.len() == 2;
            } else if in_brackets {
                if let Some((path, name)) = &file {
                    let source = fs::read_to_string(path).unwrap_or_default();
                    if !source.contains(text) {
                        missing.push(format!("{text} in {name}"));
                    }
                }
                in_brackets = follows.starts_with(", ") && follows.len() == 2;
            }
        }
        for link in line.split("](").skip(1) {
            let target = link.split([')', '#']).next().unwrap_or_default();
            let beside = document.parent().expect("a folder").join(target);
            if !target.contains("://") && !root().join(beside).exists() {
                missing.push(format!("link to {target}"));
            }
        }
    }
    missing
}

#[test]
fn what_documents_name_exists() {
    for document in documents() {
        let text = fs::read_to_string(root().join(&document)).expect("a document");
        assert_eq!(missing(&document, &text), [""; 0], "{}", document.display());
    }
}

#[test]
fn what_does_not_exist_is_found() {
    let found = |text| missing(Path::new("crates/README.md"), text);
    assert_eq!(found("`core/src/nowhere.rs`"), ["core/src/nowhere.rs"]);
    assert_eq!(found("`core/src/nowhere/`"), ["core/src/nowhere/"]);
    assert_eq!(found("`tests/nowhere`"), ["tests/nowhere"]);
    assert_eq!(
        found("**core** has `run.rs`\nand `stages/`, not `walk.rs`.\n\n`walk.rs`"),
        ["walk.rs"]
    );
    assert_eq!(
        found("a `x` in `core/src/run.rs` (`Run`, `Walk`)"),
        ["Walk in core/src/run.rs"]
    );
    assert_eq!(found("[a](nowhere.md)"), ["link to nowhere.md"]);
    assert_eq!(
        found("`core/src/run.rs` (`Run`), `application/wasm`, `1/2`, [b](core/PERFORMANCE.md)"),
        [""; 0]
    );
}

/// Returns the crates that `from` leads to.
fn reached<'a>(map: &'a CrateMap, from: &'a str) -> BTreeSet<&'a str> {
    let mut found = BTreeSet::new();
    let mut waiting = vec![from];
    while let Some(name) = waiting.pop() {
        for used in map.get(name).into_iter().flatten() {
            if found.insert(used.as_str()) {
                waiting.push(used);
            }
        }
    }
    found
}

/// Draws the map as a Mermaid graph, without the arrows that another way makes needless.
fn picture(map: &CrateMap) -> String {
    let short = |name: &str| name.trim_start_matches("tilescope-").to_owned();
    let mut text = "```mermaid\ngraph TD\n".to_owned();
    for (from, used) in map {
        let needed = |to: &&String| {
            let mut others = used.iter().filter(|other| other != to);
            !others.any(|other| reached(map, other).contains(to.as_str()))
        };
        let drawn: Vec<&String> = used.iter().filter(needed).collect();
        if drawn.is_empty() {
            let _ = writeln!(text, "  {}", short(from));
        }
        for to in drawn {
            let _ = writeln!(text, "  {} --> {}", short(from), short(to));
        }
    }
    text + "```\n"
}

fn glossary() -> String {
    let mut text = "| term | meaning | paper |\n|---|---|---|\n".to_owned();
    for term in terms() {
        let _ = writeln!(
            text,
            "| **{}** | {} | {} |",
            term.name, term.meaning, term.paper
        );
    }
    text
}

/// Replaces the text between the marks of a generated part.
fn replaced(document: &str, name: &str, part: &str) -> String {
    let begin = format!("<!-- generated: {name} -->\n");
    let (before, rest) = document.split_once(&begin).expect(name);
    let (_, after) = rest.split_once("<!-- end -->").expect("an end");
    format!("{before}{begin}{part}<!-- end -->{after}")
}

#[test]
fn what_is_generated_is_up_to_date() {
    let path = root().join("crates/README.md");
    let document = fs::read_to_string(&path).expect("the document");
    let mut new = replaced(&document, "picture", &picture(&map()));
    for name in ["core", "workbench"] {
        let modules = graph(&sources(&root().join("crates").join(name).join("src"), ""));
        new = replaced(&new, &format!("modules of {name}"), &picture(&modules));
    }
    let new = replaced(&new, "glossary", &glossary());
    if std::env::var_os("TILESCOPE_RENEW").is_some() {
        fs::write(&path, &new).expect("the document, written");
    } else {
        assert!(
            document == new,
            "crates/README.md is out of date: run this test with TILESCOPE_RENEW=1"
        );
    }
}

#[test]
fn a_picture_has_the_arrows_that_are_needed() {
    let mut map = CrateMap::new();
    let arrows = [("a", "b"), ("a", "c"), ("b", "c"), ("d", "c")];
    for (from, to) in arrows {
        let used = map.entry(format!("tilescope-{from}")).or_default();
        used.insert(format!("tilescope-{to}"));
    }
    let drawn = "```mermaid\ngraph TD\n  a --> b\n  b --> c\n  d --> c\n```\n";
    assert_eq!(picture(&map), drawn);
}
