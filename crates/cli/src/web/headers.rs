//! What is said of a file beside its bytes: its kind, how long it may be kept, and what a page may do.

use std::path::Path;

use axum::http::header::{CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, REFERRER_POLICY};
use axum::http::header::{HeaderMap, HeaderName, HeaderValue, X_CONTENT_TYPE_OPTIONS};

/// What the page may load and do, as its meta element says too (`web/page/index.html`).
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; \
    img-src 'self' data: blob:; connect-src 'self'; worker-src 'self'; manifest-src 'self'; font-src 'self' data:; \
    base-uri 'none'; form-action 'none'";

/// The same for the example, which shows the page of this place, or of this machine, in a frame.
const EXAMPLE_POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; \
    frame-src 'self' http://localhost:* https://localhost:* http://127.0.0.1:* https://127.0.0.1:*; base-uri 'none'; form-action 'none'";

/// Asked for again each time; a server's answer that nothing has changed is short.
const CHECK: HeaderValue = HeaderValue::from_static("no-cache");
/// Never asked for again.
const KEEP: HeaderValue = HeaderValue::from_static("public, max-age=31536000, immutable");

/// Returns the kind of a file, by its ending.
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

/// Whether a file's name ends with a hash of its content, as `web/build` names files: `main-0123456789ab.js`.
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

/// Adds what is said with every answer, also with a refusal.
pub fn add_always(headers: &mut HeaderMap) {
    for (name, value) in [
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (REFERRER_POLICY, "no-referrer"),
        // Other origins may show the page in a frame; they may not take its files apart.
        (
            HeaderName::from_static("cross-origin-resource-policy"),
            "same-origin",
        ),
        (
            HeaderName::from_static("cross-origin-opener-policy"),
            "same-origin",
        ),
        (
            HeaderName::from_static("permissions-policy"),
            "camera=(), geolocation=(), microphone=()",
        ),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
}

/// Adds what is said of the file `file`, whose path in the folder is `path`.
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
