//! Answers to requests: the files of one folder, if the request uses an allowed host name.

use std::io::{self, ErrorKind};
use std::net::IpAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Result};
use axum::Router;
use axum::body::Body;
use axum::extract::{Request, State};
use axum::http::header::{ALLOW, HOST, HeaderValue, RANGE, RETRY_AFTER};
use axum::http::uri::Authority;
use axum::http::{Method, StatusCode};
use axum::response::{IntoResponse, Response};
use tower_http::services::ServeFile;

use super::{headers, within};
use crate::paths::named;

/// A folder that is served.
#[derive(Clone, Debug)]
pub struct ServedFolder {
    /// Its path, absolute and without links.
    pub folder: PathBuf,
    /// Whether requests must name this machine as their host. Otherwise a foreign page could point its own host name at
    /// this machine's address and read the served files (DNS rebinding).
    local: bool,
}

impl ServedFolder {
    /// Returns the site of a folder; a `local` one answers only requests whose host is this machine.
    pub fn new(folder: &Path, local: bool) -> Result<Self> {
        let folder = folder
            .canonicalize()
            .with_context(|| format!("cannot read the folder {}", named(folder)))?;
        Ok(Self { folder, local })
    }

    /// Returns the router, which answers every request.
    pub fn router(self) -> Router {
        Router::new().fallback(answer).with_state(Arc::new(self))
    }

    /// Returns whether the host of a request is allowed.
    fn allows_host(&self, request: &Request) -> bool {
        if !self.local {
            return true;
        }
        // A request has one host in its headers (RFC 9112, section 3.2), and may have one in its first line, too. Of several
        // that differ, a browser and this server might each take another.
        let mut names = request.headers().get_all(HOST).iter();
        let (name, more) = (names.next(), names.next());
        let header = name.and_then(|name| name.to_str().ok());
        let in_line = request.uri().authority();
        more.is_none()
            && header.is_some_and(is_local)
            && in_line.is_none_or(|name| is_local(name.as_str()))
    }
}

/// Returns whether `HOST` or `HOST:PORT` always means this machine.
fn is_local(name: &str) -> bool {
    let Ok(name) = name.parse::<Authority>() else {
        return false;
    };
    // A user name before the host is not allowed in requests.
    if name.as_str().contains('@') {
        return false;
    }
    let host = name.host();
    // An IPv6 address stands in brackets, as its colons would be taken for that of the port.
    let address = (host.trim_start_matches('['))
        .trim_end_matches(']')
        .parse::<IpAddr>();
    host.eq_ignore_ascii_case("localhost") || address.is_ok_and(|address| address.is_loopback())
}

async fn answer(State(site): State<Arc<ServedFolder>>, request: Request) -> Response {
    let mut response = if !site.allows_host(&request) {
        let reason = "The host must be localhost, 127.0.0.1 or [::1].\n";
        (StatusCode::MISDIRECTED_REQUEST, reason).into_response()
    } else if ![Method::GET, Method::HEAD].contains(request.method()) {
        let (status, allowed) = (StatusCode::METHOD_NOT_ALLOWED, [(ALLOW, "GET, HEAD")]);
        (status, allowed, "Files can only be read.\n").into_response()
    } else {
        file(&site, request).await
    };
    headers::add_always(response.headers_mut());
    response
}

/// Removes a range that is in another unit than bytes: such a one is to be ignored (RFC 9110, section 14.2), and the library
/// refuses it.
fn without_unknown_range(mut request: Request) -> Request {
    let is_unknown = |value: &HeaderValue| {
        let unit = value.as_bytes().split(|byte| *byte == b'=').next();
        !unit.is_some_and(|unit| unit.trim_ascii().eq_ignore_ascii_case(b"bytes"))
    };
    if request.headers().get(RANGE).is_some_and(is_unknown) {
        request.headers_mut().remove(RANGE);
    }
    request
}

fn missing() -> Response {
    (StatusCode::NOT_FOUND, "There is no such file.\n").into_response()
}

/// Returns the answer for a file that was there and cannot be opened.
fn unreadable(error: &io::Error) -> Response {
    // A new build may have removed it since, and one that may not be read is none to the reader.
    if matches!(
        error.kind(),
        ErrorKind::NotFound | ErrorKind::PermissionDenied
    ) {
        return missing();
    }

    // As when the process has no file handles left: the file may be read later.
    let (status, retry) = (StatusCode::SERVICE_UNAVAILABLE, [(RETRY_AFTER, "1")]);
    (status, retry, "The file cannot be read now.\n").into_response()
}

/// Answers a request with the file of its path.
async fn file(site: &ServedFolder, request: Request) -> Response {
    let path = request.uri().path().to_owned();
    let Some(file) = within::file(&site.folder, &path) else {
        return missing();
    };
    // Copies that `web/build` compressed lie beside the files; a browser that does not take them gets the file itself.
    let mut service = ServeFile::new(&file)
        .precompressed_br()
        .precompressed_gzip();
    let response = match service.try_call(without_unknown_range(request)).await {
        Ok(response) => response,
        Err(error) => return unreadable(&error),
    };
    let mut response = response.map(Body::new);
    let status = response.status();
    // An answer that the file is unchanged renews its headers, too. A refusal, as of a range beyond the file's end, is
    // not about the file.
    if status.is_success() || status == StatusCode::NOT_MODIFIED {
        headers::add(response.headers_mut(), &file, &path);
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_cannot_be_read_now_are_not_called_missing() {
        let status = |error: io::Error| unreadable(&error).status();
        // EMFILE: the process has no file handles left.
        let answer = unreadable(&io::Error::from_raw_os_error(24));
        assert_eq!(answer.status(), StatusCode::SERVICE_UNAVAILABLE);
        assert!(answer.headers().contains_key(RETRY_AFTER));
        for kind in [ErrorKind::NotFound, ErrorKind::PermissionDenied] {
            assert_eq!(status(kind.into()), StatusCode::NOT_FOUND);
        }
    }

    #[test]
    fn names_of_this_machine_are_told_from_others() {
        for name in [
            "localhost",
            "LocalHost:80",
            "127.0.0.1",
            "127.0.0.1:8080",
            "[::1]",
            "[::1]:8080",
        ] {
            assert!(is_local(name), "{name}");
        }
        for name in [
            "",
            "example.org",
            "localhost.example.org",
            "127.0.0.1.example.org:80",
            "10.0.0.1",
            "[::2]",
            "user@localhost",
            "localhost:80:80",
            "::1x",
            "local host",
            "0.0.0.0",
        ] {
            assert!(!is_local(name), "{name}");
        }
    }
}
