//! Checks that modules of a crate do not import each other in circles.
//!
//! A module is a file or a folder directly in `src`, with everything below it; an import is any path that begins in the
//! crate's root, also through a name that `lib.rs` re-exports. Tests may import anything.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// What each module imports.
pub type Graph = BTreeMap<String, BTreeSet<String>>;

/// Returns the files of a folder with their paths in `src`, except those of tests.
pub fn sources(folder: &Path, above: &str) -> Vec<(String, String)> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        let stem = path.file_stem().expect("a name").to_string_lossy();
        let name = format!("{above}{stem}");
        if stem == "tests" || stem.ends_with("_tests") {
            continue;
        }
        if path.is_dir() {
            all.extend(sources(&path, &format!("{name}/")));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            all.push((name, fs::read_to_string(&path).expect("UTF-8")));
        }
    }
    all
}

/// Returns the code without comments and without items under `#[cfg(test)]`, whose last line has, by rustfmt, the same
/// indentation as the first.
pub fn product(text: &str) -> String {
    let indent = |line: &str| line.len() - line.trim_start().len();
    let mut code = String::new();
    let mut test: Option<usize> = None;
    for line in text.lines() {
        let line = line.split("//").next().unwrap_or_default().trim_end();
        match test {
            Some(depth) if indent(line) == depth && line.ends_with([';', '}', ',']) => test = None,
            Some(_) => {}
            None if line.trim_start() == "#[cfg(test)]" => test = Some(indent(line)),
            None => code = code + line + "\n",
        }
    }
    code
}

/// Returns the identifiers of some code.
fn words(code: &str) -> impl Iterator<Item = &str> {
    let pieces = code.split(|c: char| !c.is_alphanumeric() && c != '_');
    pieces.filter(|word| !word.is_empty())
}

/// Returns the first names of a path after `crate::`; a group in braces has several.
fn heads(path: &str) -> Vec<&str> {
    if !path.starts_with('{') {
        return words(path).take(1).collect();
    }
    let (mut depth, mut start, mut heads) = (0, 0, Vec::new());
    for (at, c) in path.char_indices() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        if depth == 0 || (depth == 1 && c == ',') {
            heads.extend(words(&path[start..at]).next());
            start = at;
        }
        if depth == 0 {
            break;
        }
    }
    heads
}

/// Returns which top-level modules import which.
pub fn graph(sources: &[(String, String)]) -> Graph {
    let top = |name: &str| name.split('/').next().unwrap_or_default().to_owned();
    let is_root = |name: &str| name == "lib" || name == "main";
    let modules = sources.iter().map(|(name, _)| top(name));
    let mut graph: Graph = modules
        .filter(|name| !is_root(name))
        .map(|name| (name, BTreeSet::new()))
        .collect();
    let mut exported = BTreeMap::new();
    for (_, text) in sources.iter().filter(|(name, _)| is_root(name)) {
        for statement in product(text).split("use ").skip(1) {
            let names = words(statement.split(';').next().unwrap_or_default());
            let mut names = names.skip_while(|&name| name == "crate");
            let module = names.next().unwrap_or_default().to_owned();
            exported.extend(names.map(|name| (name.to_owned(), module.clone())));
        }
    }
    for (name, text) in sources.iter().filter(|(name, _)| !is_root(name)) {
        let depth = name.split('/').filter(|&part| part != "mod").count();
        let code = product(text).replace(&"super::".repeat(depth), "crate::");
        for head in code.split("crate::").skip(1).flat_map(heads) {
            let known = graph.contains_key(head).then_some(head);
            let meant = known.or_else(|| exported.get(head).map(String::as_str));
            let meant = meant.filter(|&meant| meant != top(name) && graph.contains_key(meant));
            if let Some(meant) = meant.map(str::to_owned) {
                graph.entry(top(name)).or_default().insert(meant);
            }
        }
    }
    graph
}

/// Returns all modules that a module imports, directly or indirectly.
fn reached<'a>(graph: &'a Graph, from: &'a str) -> BTreeSet<&'a str> {
    let mut found = BTreeSet::new();
    let mut ahead = vec![from];
    while let Some(module) = ahead.pop() {
        let next = graph[module].iter().map(String::as_str);
        ahead.extend(next.filter(|&next| found.insert(next)));
    }
    found
}

/// Returns the modules of the largest circle; empty if there is none.
fn largest_circle(graph: &Graph) -> Vec<&str> {
    let all = graph
        .keys()
        .map(|from| (from.as_str(), reached(graph, from)));
    let all: BTreeMap<&str, BTreeSet<&str>> = all.collect();
    // The modules that a module reaches and that reach it, including itself if it is in a circle.
    let circle = |from: &&str| -> Vec<&str> {
        let both = all[from].iter().filter(|&to| all[to].contains(from));
        both.copied().collect()
    };
    let circles = all.keys().map(circle);
    circles.max_by_key(Vec::len).unwrap_or_default()
}

#[test]
fn no_crate_has_a_circle_of_modules() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates");
    let folders = fs::read_dir(crates).expect("the crates");
    let folders = folders.map(|entry| entry.expect("an entry").path());
    for folder in folders.filter(|folder| folder.join("src").is_dir()) {
        let name = folder.file_name().expect("a name").to_string_lossy();
        let graph = graph(&sources(&folder.join("src"), ""));
        let circle = largest_circle(&graph).join(", ");
        assert_eq!(
            circle, "",
            "{name}: these modules import each other in a circle"
        );
    }
}

#[test]
fn a_circle_is_found_however_it_is_written() {
    let lib = (
        "lib",
        "mod a;\nmod b;\nmod c;\npub use c::{Deep, Other as Same};",
    );
    let circle_of = |files: &[(&str, &str)]| {
        let owned = |&(name, text): &(&str, &str)| (name.to_owned(), text.to_owned());
        let sources: Vec<_> = files.iter().chain([&lib]).map(owned).collect();
        largest_circle(&graph(&sources)).join(" ")
    };
    let a = ("a", "use crate::{b::{X, Y}, z::W};");
    assert_eq!(circle_of(&[a, ("b", ""), ("c", "use super::a::Z;")]), "");
    assert_eq!(circle_of(&[a, ("b", "use crate::a::Z;")]), "a b");
    assert_eq!(
        circle_of(&[a, ("b/d", "let z = super::super::a::z();")]),
        "a b"
    );
    assert_eq!(
        circle_of(&[a, ("b/mod", "use crate::Deep;"), ("c", "use super::a;")]),
        "a b c"
    );
    let tested = "// crate::a\n#[cfg(test)]\nmod tests {\n    use crate::a;\n}\nuse crate::c;";
    assert_eq!(circle_of(&[a, ("b", tested), ("c", "")]), "");
    assert_eq!(
        circle_of(&[a, ("b", tested), ("c", "use crate::a;")]),
        "a b c"
    );
}
