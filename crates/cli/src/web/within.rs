//! From the path of a request to a file within a folder. `ServeDir` would serve hidden files, and follow links that lead
//! out of the folder.

use std::path::{Path, PathBuf};

use percent_encoding::percent_decode_str;

/// Returns the file of a request's path, if the file and its compressed copies lie within `folder`, links followed.
/// `folder` is canonical. Names that begin with a dot are refused; so are characters that are special on some system:
/// slashes of either kind, colons, control characters. A path that ends with a slash names the page of a folder.
pub fn file(folder: &Path, path: &str) -> Option<PathBuf> {
    let page = if path.ends_with('/') {
        "index.html"
    } else {
        ""
    };
    let path = format!("{path}{page}");

    let mut named = folder.to_owned();
    for part in path.strip_prefix('/')?.split('/') {
        let part = percent_decode_str(part).decode_utf8().ok()?;
        let is_special = |c: char| "/\\:".contains(c) || c.is_control();
        // The dot also keeps out `..`, which would lead out of the folder.
        if part.is_empty() || part.starts_with('.') || part.contains(is_special) {
            return None;
        }
        named.push(&*part);
    }

    let file = named.canonicalize().ok()?;
    // A copy that is missing, or that is a broken link, does not lie outside: the file itself is then served, or the
    // copy fails when it is opened.
    let is_outside = |ending| {
        let mut copy = file.clone().into_os_string();
        copy.push(ending);
        let copy = Path::new(&copy).canonicalize();
        copy.is_ok_and(|copy| !copy.starts_with(folder))
    };
    // The file itself and its copies, compressed with brotli and gzip.
    let is_served = file.is_file() && !["", ".br", ".gz"].into_iter().any(is_outside);
    is_served.then_some(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_names_are_found() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().canonicalize().unwrap();
        std::fs::create_dir(folder.join("example")).unwrap();
        std::fs::create_dir_all(folder.join("lesson/gaps")).unwrap();
        for (path, name) in [
            ("/", "index.html"),
            ("/lesson/gaps/", "lesson/gaps/index.html"),
            ("/a-1.js", "a-1.js"),
            ("/example/a%20b.js", "example/a b.js"),
            ("/%C3%A4.js", "\u{e4}.js"),
            // Decoded once: the rest is a strange but plain name.
            ("/%252e%252e", "%2e%2e"),
        ] {
            assert_eq!(file(&folder, path), None, "{path}");
            std::fs::write(folder.join(name), "x").unwrap();
            assert_eq!(file(&folder, path), Some(folder.join(name)), "{path}");
        }
    }

    #[test]
    fn everything_else_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().canonicalize().unwrap();
        std::fs::create_dir_all(folder.join("a/b")).unwrap();
        // Each of these files exists, and would be served by a plain name.
        for name in ["a/c", "a/b/d", "a/b/index.html", ".git", "etc"] {
            std::fs::write(folder.join(name), "x").unwrap();
        }
        assert!(file(&folder, "/a/c").is_some() && file(&folder, "/etc").is_some());
        assert!(file(&folder, "/a/b/").is_some());
        for path in [
            "",
            "etc",
            "*",
            "//",
            "/a/",
            "/a/b",
            "/a/b//",
            "//a/b/",
            "/a/b/./",
            "/a/../a/b/",
            "//etc",
            "/a//c",
            "/.",
            "/..",
            "/../etc",
            "/a/../etc",
            "/a/b/../c",
            "/a/%2e%2e/etc",
            "/a/%2E./etc",
            "/a/..%2fetc",
            "/%2fetc",
            "/a%2fc",
            "/a%5cc",
            "/a\\c",
            "/..\\etc",
            "/etc%00",
            "/etc%0a",
            "/c:/etc",
            "/c%3A",
            "/.git",
            "/%2egit",
            "/%",
            "/%2",
            "/%zz",
            "/%+1",
            "/%ff",
            "/%c0%ae%c0%ae/etc",
            &format!("/{}", "a".repeat(5000)),
        ] {
            assert_eq!(file(&folder, path), None, "{path}");
        }
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
