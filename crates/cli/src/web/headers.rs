//! HTTP headers of the files that are served: type, caching, and security policy.

use std::path::Path;

use axum::http::header::{CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE};
use axum::http::header::{HeaderMap, HeaderName, HeaderValue};

/// The content security policy of the page, the same as in its meta element (`web/page/index.html`).
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; \
    img-src 'self' data: blob:; connect-src 'self'; worker-src 'self'; manifest-src 'self'; font-src 'self' data:; \
    base-uri 'none'; form-action 'none'";

/// The policy of the example, which shows the page in a frame, from this server or another one of this machine.
const EXAMPLE_POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; \
    frame-src 'self' http://localhost:* https://localhost:* http://127.0.0.1:* https://127.0.0.1:*; base-uri 'none'; form-action 'none'";

/// Browsers check each time whether the file has changed.
const CHECK: HeaderValue = HeaderValue::from_static("no-cache");
/// Browsers keep the file and do not check.
const KEEP: HeaderValue = HeaderValue::from_static("public, max-age=31536000, immutable");

/// Returns the media type of a file, by its extension.
fn kind(file: &Path) -> &'static str {
    match file.extension().and_then(|ending| ending.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("wasm") => "application/wasm",
        Some("webmanifest") => "application/manifest+json",
        Some("json") => "application/json",
        Some("txt" | "md") => "text/plain; charset=utf-8",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("webp") => "image/webp",
        Some("ico") => "image/x-icon",
        _ => "application/octet-stream",
    }
}

/// Returns whether a file's name ends with a hash of its content, as `web/build` names files: `main-0123456789ab.js`.
fn is_hashed(file: &Path) -> bool {
    let hash = file
        .file_stem()
        .and_then(|stem| stem.to_str())
        .and_then(|stem| stem.rsplit_once('-'));
    hash.is_some_and(|(_, hash)| {
        let is_digit = |byte: u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte);
        hash.len() >= 12 && hash.bytes().all(is_digit)
    })
}

/// Adds the headers of every response, also of refusals.
pub fn add_always(headers: &mut HeaderMap) {
    for (name, value) in [
        ("x-content-type-options", "nosniff"),
        ("referrer-policy", "no-referrer"),
        // Other origins may show the page in a frame; they may not read its files.
        ("cross-origin-resource-policy", "same-origin"),
        ("cross-origin-opener-policy", "same-origin"),
        (
            "permissions-policy",
            "camera=(), geolocation=(), microphone=()",
        ),
    ] {
        let name = HeaderName::from_static(name);
        headers.insert(name, HeaderValue::from_static(value));
    }
}

/// Adds the headers of the file `file`, whose path in the folder is `path`.
pub fn add(headers: &mut HeaderMap, file: &Path, path: &str) {
    let policy = if path.starts_with("/example/") {
        EXAMPLE_POLICY
    } else {
        POLICY
    };
    headers.insert(CONTENT_SECURITY_POLICY, HeaderValue::from_static(policy));
    headers.insert(CONTENT_TYPE, HeaderValue::from_static(kind(file)));
    let keep = if is_hashed(file) { KEEP } else { CHECK };
    headers.insert(CACHE_CONTROL, keep);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_told_from_names() {
        for (name, expected) in [
            ("main-0123456789ab.js", true),
            ("a-b-0123456789abcdef.wasm", true),
            ("main-0123456789a.js", false),
            ("main-0123456789AB.js", false),
            ("main-0123456789xy.js", false),
            ("0123456789ab.js", false),
            ("sw.js", false),
            ("index.html", false),
        ] {
            assert_eq!(is_hashed(Path::new(name)), expected, "{name}");
        }
    }
}
