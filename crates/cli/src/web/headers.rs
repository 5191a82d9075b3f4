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

/// Devices that pages cannot use.
const PERMISSIONS: &str = "camera=(), geolocation=(), microphone=()";

/// Browsers check each time whether the file has changed.
const CHECK: HeaderValue = HeaderValue::from_static("no-cache");
/// Browsers keep the file and do not check.
const KEEP: HeaderValue = HeaderValue::from_static("public, max-age=31536000, immutable");

/// Returns whether a file's name ends with a hash of its content, as `web/build` names files: `main-0123456789ab.js`.
fn is_hashed(file: &Path) -> bool {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    stem.rsplit_once('-').is_some_and(|(_, hash)| {
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
        ("permissions-policy", PERMISSIONS),
    ] {
        let name = HeaderName::from_static(name);
        headers.insert(name, HeaderValue::from_static(value));
    }
}

/// Adds the headers of the file `file`, which answers a request with the path `path`.
pub fn add(headers: &mut HeaderMap, file: &Path, path: &str) {
    // Only the example shows a page in a frame, so that only its policy allows frames.
    let is_example = path.starts_with("/example/");
    let policy = if is_example { EXAMPLE_POLICY } else { POLICY };
    headers.insert(CONTENT_SECURITY_POLICY, HeaderValue::from_static(policy));
    // The media type is there already, from the extension. All texts are UTF-8.
    let kind = headers
        .get(CONTENT_TYPE)
        .and_then(|kind| kind.to_str().ok());
    if let Some(kind) = kind.filter(|kind| kind.starts_with("text/"))
        && let Ok(with_charset) = HeaderValue::from_str(&format!("{kind}; charset=utf-8"))
    {
        headers.insert(CONTENT_TYPE, with_charset);
    }
    // A name that has the hash of its content never gets another content.
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
