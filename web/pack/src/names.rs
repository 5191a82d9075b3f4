//! The names under which files are served: some keep their names, others are named by their content, so that browsers
//! may cache them forever.

/// Hexadecimal digits of a hash in a name.
pub const DIGITS: usize = 12;

/// Files whose addresses must not change.
const STABLE: [&str; 5] = [
    "index.html",
    "manifest.webmanifest",
    "robots.txt",
    "sitemap.xml",
    "sw.js",
];

/// The endings of files that are text.
const TEXT: [&str; 8] = [
    "css",
    "html",
    "js",
    "json",
    "svg",
    "txt",
    "webmanifest",
    "xml",
];

/// The endings of files that are pictures.
const PICTURES: [&str; 5] = ["ico", "jpg", "png", "svg", "webp"];

/// Returns the part of a name after its last dot, or an empty text.
fn ending(name: &str) -> &str {
    name.rsplit_once('.').map_or("", |(_, ending)| ending)
}

/// Whether a file keeps its name. In folders lie pages, which are asked for by the names of their folders.
pub fn is_stable(name: &str) -> bool {
    STABLE.contains(&name) || name.contains('/')
}

/// Whether a file is a script.
pub fn is_script(name: &str) -> bool {
    ending(name) == "js"
}

/// Whether a file is text, which may have placeholders.
pub fn is_text(name: &str) -> bool {
    TEXT.contains(&ending(name))
}

/// Whether a file is a picture, which the program does not need to start.
pub fn is_picture(name: &str) -> bool {
    PICTURES.contains(&ending(name))
}

/// Whether a file is loaded only on demand, though other files name it.
pub fn is_later(name: &str) -> bool {
    let is_table = ending(name) == "txt";
    is_picture(name) || is_table || name.ends_with(".webmanifest") || LATER.contains(&name)
}

/// The later part of the program, the lessons, the texts of packages, the voting card, the notes of a talk, what sends
/// answers to a record store, the texts of these three, and what only the pages before the program use.
const LATER: [&str; 9] = [
    LATER_PART,
    LESSONS,
    COURSE,
    "card.js",
    "notes.js",
    "report.js",
    "site.css",
    "site.js",
    "words.js",
];

/// The file that holds the part of the program that the start does without.
pub const LATER_PART: &str = "tilescope_later.wasm";

/// The file that holds the lessons and their translations.
pub const LESSONS: &str = "lessons.json";

/// The file that holds the texts of the page around a lesson in a course system, for packages.
pub const COURSE: &str = "course.json";

/// Whether compressed copies of a file are made.
pub fn is_compressed(name: &str) -> bool {
    is_text(name) || ending(name) == "wasm"
}

/// Returns the hash of some bytes as it is written in names and versions.
pub fn digest(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex()[..DIGITS].to_owned()
}

/// Returns the name under which a file is served.
pub fn final_name(name: &str, bytes: &[u8]) -> String {
    if is_stable(name) {
        return name.to_owned();
    }
    let hash = digest(bytes);
    match name.rsplit_once('.') {
        Some((stem, ending)) => format!("{stem}-{hash}.{ending}"),
        None => format!("{name}-{hash}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_follow_the_content_and_nothing_else() {
        let name = final_name("main.js", b"one");
        assert_eq!(name, final_name("main.js", b"one"));
        assert_ne!(name, final_name("main.js", b"two"));
        let hash = name
            .strip_prefix("main-")
            .and_then(|rest| rest.strip_suffix(".js"));
        let hash = hash.expect("the stem and the ending stay");
        assert_eq!(hash.len(), DIGITS);
        assert!(hash.bytes().all(|byte| byte.is_ascii_hexdigit()));
    }

    #[test]
    fn what_is_asked_for_by_name_keeps_it() {
        for name in STABLE {
            assert_eq!(final_name(name, b"anything"), name);
        }
        assert!(!is_stable("main.js"));
    }

    #[test]
    fn endings_tell_what_a_file_is() {
        assert!(is_text("a.b.js") && !is_text("a.png") && !is_text("js"));
        assert!(is_compressed("a_bg.wasm") && !is_compressed("still.png"));
        assert!(is_picture("still.webp") && !is_picture("main.js"));
        assert!(is_later(LESSONS) && is_compressed(LESSONS) && !is_later("main.js"));
        assert!(is_later("de.txt") && is_text("de.txt"));
    }
}
