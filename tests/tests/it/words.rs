//! Every row of a table of words is used: the program or the page has the words of its English text.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use tilescope_session::language::{Language, TABLES};

/// Where texts are made, from the root of the repository.
const SOURCES: [&str; 3] = ["crates", "web/page", "assets/lesson-labels.json"];
/// The tables' own module, whose tests have examples of rows.
const READER: &str = "crates/session/src/language.rs";

/// Adds the words between quotation marks in a file, or in the files of a folder.
fn read(path: &Path, found: &mut BTreeSet<String>) {
    if path.is_dir() {
        let entries = fs::read_dir(path).expect("a folder");
        let entries = entries.map(|entry| entry.expect("an entry").path());
        // Tests may have words that the program has no more.
        let is_source =
            |path: &PathBuf| !path.ends_with("tests") && !path.ends_with("node_modules");
        entries
            .filter(is_source)
            .for_each(|path| read(&path, found));
        return;
    }
    let extension = path.extension().and_then(|name| name.to_str());
    if ["rs", "js", "json"].map(Some).contains(&extension) && !path.ends_with(READER) {
        add(&fs::read_to_string(path).expect("a text"), found);
    }
}

/// Adds the words between quotation marks of a text. A quotation that goes on in the next line has a backslash before it.
fn add(text: &str, found: &mut BTreeSet<String>) {
    let text = text.replace("\\\n", " ").replace("\\\"", "");
    for line in text
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
    {
        let quoted = line.split(['"', '`']).skip(1).step_by(2);
        found.extend(quoted.flat_map(words));
    }
}

/// Returns the words of a text in lower case, since sentences begin with a capital letter.
fn words(text: &str) -> impl Iterator<Item = String> {
    let words = text.split(|c: char| !c.is_alphabetic());
    words.filter(|word| word.len() > 2).map(str::to_lowercase)
}

/// Returns the rows of a language that have a word which no text has.
fn dead(language: &Language, known: &BTreeSet<String>) -> Vec<String> {
    let rows = language.english().map(|parts| parts.join(" "));
    let is_dead = |row: &String| words(row).any(|word| !known.contains(&word));
    rows.filter(is_dead).collect()
}

#[test]
fn every_row_of_a_table_of_words_is_used() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut known = BTreeSet::new();
    for source in SOURCES {
        read(&root.join(source), &mut known);
    }
    for (tag, _) in TABLES {
        let language = Language::of(tag).expect("the language of a table");
        let rows = language.english().count();
        assert!(rows > 400, "{tag}: {rows} rows were read");
        let dead = dead(language, &known);
        assert!(
            dead.is_empty(),
            "{tag}: no text has the words of\n{}",
            dead.join("\n")
        );
    }

    // Negative control: a word that the program has no more, or only in a remark, leaves a row behind.
    let table = "1,234.5%\n    1.234,5 %\n{#n} lost samples\n    {#n} Punkte\nNext\n    Weiter\n";
    let language = Language::read(table).expect("a table");
    for (source, expected) in [
        (
            "count(n, \"lost samples\")\n// \"more\"\nwords(\"Next\")",
            &[][..],
        ),
        (
            "count(n, \"samples\")\n// \"lost\"\nwords(\"next\")",
            &[" lost samples"][..],
        ),
    ] {
        let mut known = BTreeSet::new();
        add(source, &mut known);
        assert_eq!(dead(&language, &known), expected, "{source}");
    }
}
