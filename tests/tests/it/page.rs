//! Counts how the code reads, crate by crate, and holds it at least as readable as it is: long functions without a paragraph,
//! and comments in bodies. `crates/STYLE.md` says what a page should be like.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::circles::sources;

/// From how many lines on a function needs a paragraph.
const LONG: usize = 25;
/// From how many lines on the comments of a body are counted.
const BODY: usize = 15;

/// For each crate the fewest comments in 1,000 lines of bodies: the counts of the day when the crate was last gone through. Raise
/// them with each pass.
const LIMITS: [(&str, usize); 26] = [
    ("crates/analysis", 95),
    ("crates/app", 67),
    ("crates/c", 73),
    ("crates/canvas", 81),
    ("crates/classroom", 88),
    ("crates/cli", 87),
    ("crates/core", 95),
    ("crates/debugger", 97),
    ("crates/drawing", 87),
    ("crates/figures", 82),
    ("crates/formats", 80),
    ("crates/gpu", 90),
    ("crates/lessons", 78),
    ("crates/live", 98),
    ("crates/passes", 76),
    ("crates/python", 87),
    ("crates/reproduce", 81),
    ("crates/session", 87),
    ("crates/sets", 90),
    ("crates/tilescope", 72),
    ("crates/trusted", 45),
    ("crates/ui", 66),
    ("crates/workbench", 84),
    ("web/app", 46),
    ("web/pack", 75),
    ("web/sampler", 70),
];

/// What is counted in a crate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Page {
    /// Functions of [`LONG`] lines and more without a blank line.
    bare: usize,
    /// The lines of functions of [`BODY`] lines and more, and the comments among them.
    lines: usize,
    comments: usize,
}

impl Page {
    /// Returns how many comments there are in 1,000 lines, rounded down.
    fn density(&self) -> usize {
        (1000 * self.comments).checked_div(self.lines).unwrap_or(0)
    }

    /// Counts the functions of a file. By rustfmt the last line of a function is a brace as far to the right as the first line.
    fn add(&mut self, text: &str) {
        let text = text.split("\n#[cfg(test)]\nmod tests {").next();
        let lines: Vec<&str> = text.unwrap_or_default().lines().collect();
        for (first, line) in lines.iter().enumerate() {
            if !is_function(line) {
                continue;
            }
            let indent = line.len() - line.trim_start().len();
            let end = format!("{}}}", &line[..indent]);
            let Some(length) = lines[first..].iter().position(|line| **line == end) else {
                continue;
            };

            let body = &lines[first..=first + length];
            if body.len() >= BODY {
                let comments = body.iter().filter(|line| line.trim().starts_with("//"));
                self.lines += body.len();
                self.comments += comments.count();
            }
            let has_paragraph = body.iter().any(|line| line.trim().is_empty());
            self.bare += usize::from(body.len() >= LONG && !has_paragraph);
        }
    }
}

/// Returns whether a function with a body begins in a line.
fn is_function(line: &str) -> bool {
    let code = line.trim_start();
    let code = code.strip_prefix("pub").map_or(code, |rest| {
        let visibility = rest.split_once(") ").filter(|_| rest.starts_with('('));
        visibility.map_or(rest, |(_, rest)| rest).trim_start()
    });
    let mut words = code
        .split(' ')
        .skip_while(|word| ["const", "async", "unsafe"].contains(word));
    let is_whole = line.ends_with('}') || line.ends_with(';');
    words.next() == Some("fn") && !is_whole
}

/// Returns the counts of all crates.
fn pages() -> BTreeMap<String, Page> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let crates = fs::read_dir(root.join("crates")).expect("the crates");
    let names = crates.map(|entry| entry.expect("an entry").file_name());
    let folders = names.map(|name| format!("crates/{}", name.to_string_lossy()));
    let folders = folders.chain(["web/app", "web/pack", "web/sampler"].map(str::to_owned));

    let mut pages = BTreeMap::new();
    for folder in folders.filter(|folder| root.join(folder).join("src").is_dir()) {
        let mut page = Page::default();
        for (_, text) in sources(&root.join(&folder).join("src"), "") {
            page.add(&text);
        }
        pages.insert(folder, page);
    }
    pages
}

/// Returns what is worse than its limit, in words.
fn worse(pages: &BTreeMap<String, Page>) -> Vec<String> {
    let mut found = Vec::new();
    for (name, page) in pages {
        if page.bare > 0 {
            found.push(format!(
                "{name}: {} functions of {LONG} lines and more have no blank line",
                page.bare
            ));
        }

        let Some((_, density)) = LIMITS.iter().find(|(limited, _)| limited == name) else {
            found.push(format!("{name} has no limit: {}", page.density()));
            continue;
        };
        if page.density() < *density {
            found.push(format!(
                "{name}: {} comments in 1,000 lines of bodies; the limit is {density}",
                page.density()
            ));
        }
    }
    found
}

#[test]
fn no_crate_reads_worse_than_it_did() {
    let mut pages = pages();
    assert_eq!(worse(&pages), Vec::<String>::new());

    // The control: one long function more, without paragraph and comment, in the smallest crate.
    let body = "    let x = 1;\n".repeat(100);
    pages
        .get_mut("crates/trusted")
        .expect("a crate")
        .add(&format!("fn f() {{\n{body}}}\n"));
    let found = worse(&pages);
    assert_eq!(found.len(), 2, "{found:?}");
}

#[test]
fn paragraphs_and_comments_are_counted_in_functions_only() {
    let of = |text: &str| {
        let mut page = Page::default();
        page.add(text);
        (page.bare, page.lines, page.comments)
    };
    let body = |indent: &str, line: &str| format!("{indent}    let x = 1;\n").repeat(24) + line;
    let long = |line: &str| {
        format!(
            "    pub(super) const fn f() {{\n{}    }}\n",
            body("    ", line)
        )
    };
    assert_eq!(of(&long("")), (1, 26, 0));
    assert_eq!(of(&long("\n")), (0, 27, 0));
    assert_eq!(of(&long("        // Why.\n")), (1, 27, 1));
    assert_eq!(of(&format!("struct S {{\n{}}}\n", body("", ""))), (0, 0, 0));
    assert_eq!(of("fn short() {\n    // Why.\n}\n"), (0, 0, 0));
    let tested = format!(
        "fn a() {{}}\n\n#[cfg(test)]\nmod tests {{\n{}}}\n",
        long("")
    );
    assert_eq!(of(&tested), (0, 0, 0));
}
