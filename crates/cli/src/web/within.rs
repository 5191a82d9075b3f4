//! From the path of a request to a file within a folder. Paths that are not plain file names are refused before the file
//! system is asked; so are links that lead out of the folder. `ServeDir` would serve hidden files and follow such links.

use std::path::{Path, PathBuf};

/// The longest path, in bytes, as it is written in a request.
const MAX_BYTES: usize = 1024;

/// Returns the decoded parts of a request's path, or `None` if one of them is not a plain name. Names that begin with a
/// dot are not plain, nor are names with characters that are special on some system: slashes of either kind, colons,
/// control characters.
fn parts(path: &str) -> Option<Vec<String>> {
    if path == "/" {
        return Some(vec!["index.html".to_owned()]);
    }
    if path.len() > MAX_BYTES {
        return None;
    }
    let is_plain = |part: &String| {
        !part.is_empty()
            && !part.starts_with('.')
            && !part.contains(['/', '\\', ':'])
            && !part.chars().any(char::is_control)
    };
    let parts = path.strip_prefix('/')?.split('/');
    parts.map(|part| decoded(part).filter(is_plain)).collect()
}

/// Decodes percent escapes, once; `None` if one is broken or the text is not UTF-8.
fn decoded(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        if byte != b'%' {
            bytes.push(byte);
            continue;
        }
        let mut digit = || char::from(rest.next()?).to_digit(16);
        bytes.push((digit()? * 16 + digit()?) as u8);
    }
    String::from_utf8(bytes).ok()
}

/// Returns the file that a request's path means. It and its compressed copies lie within `folder`, links followed;
/// `folder` is canonical.
pub fn file(folder: &Path, path: &str) -> Option<PathBuf> {
    let mut named = folder.to_owned();
    named.extend(parts(path)?);
    let file = named.canonicalize().ok()?;
    if !file.starts_with(folder) || !file.is_file() {
        return None;
    }
    for ending in [".br", ".gz"] {
        let mut copy = file.clone().into_os_string();
        copy.push(ending);
        let copy = PathBuf::from(copy);
        match copy.canonicalize() {
            Ok(copy) if !copy.starts_with(folder) => return None,
            // Without a copy the file itself is served; a broken link fails when it is opened.
            Ok(_) | Err(_) => {}
        }
    }
    Some(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_names_are_found() {
        let parts = |path| parts(path).map(|parts| parts.join("|"));
        assert_eq!(parts("/").as_deref(), Some("index.html"));
        assert_eq!(parts("/a-1.js").as_deref(), Some("a-1.js"));
        assert_eq!(
            parts("/example/a%20b.js").as_deref(),
            Some("example|a b.js")
        );
        assert_eq!(parts("/%C3%A4.js").as_deref(), Some("\u{e4}.js"));
    }

    #[test]
    fn everything_else_is_refused() {
        for path in [
            "",
            "a",
            "*",
            "//",
            "/a/",
            "//a",
            "/a//b",
            "/.",
            "/..",
            "/../a",
            "/a/../b",
            "/%2e%2e/a",
            "/%2E./a",
            "/..%2fa",
            "/%2fetc",
            "/a%2fb",
            "/a%5cb",
            "/a\\b",
            "/..\\a",
            "/a%00",
            "/a%0a",
            "/c:/a",
            "/c%3A",
            "/.git",
            "/%",
            "/%2",
            "/%zz",
            "/%+1",
            "/%ff",
            "/%c0%ae%c0%ae/a",
        ] {
            assert_eq!(parts(path), None, "{path}");
        }
        assert_eq!(parts(&format!("/{}", "a".repeat(MAX_BYTES))), None);
        // Decoded once: what is left is a strange but plain name.
        assert_eq!(parts("/%252e%252e"), Some(vec!["%2e%2e".to_owned()]));
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_within_the_folder_alone() {
        let outer = tempfile::tempdir().unwrap();
        let outer = outer.path().canonicalize().unwrap();
        let folder = outer.join("site");
        std::fs::create_dir_all(folder.join("sub")).unwrap();
        let link = |to: &Path, name: &str| {
            std::os::unix::fs::symlink(to, folder.join(name)).unwrap();
        };
        for path in [
            outer.join("secret"),
            folder.join("a.js"),
            folder.join("b.js"),
        ] {
            std::fs::write(path, "x").unwrap();
        }
        link(&outer.join("secret"), "out.js");
        link(&outer, "outside");
        link(&folder.join("a.js"), "in.js");
        link(&outer.join("secret"), "b.js.br");
        assert_eq!(file(&folder, "/a.js"), Some(folder.join("a.js")));
        assert_eq!(file(&folder, "/in.js"), Some(folder.join("a.js")));
        for path in [
            "/out.js",
            "/outside/secret",
            "/b.js",
            "/sub",
            "/none.js",
            "/outside/site/a.js",
        ] {
            let found = file(&folder, path);
            let back_inside = path == "/outside/site/a.js";
            assert_eq!(found.is_some(), back_inside, "{path}");
        }
    }
}
