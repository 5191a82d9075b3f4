//! `tilescope web` end to end: the real program serves a folder, and requests are written byte by byte.

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::support::{names, tilescope};
use assert_cmd::cargo::cargo_bin;
use predicates::prelude::*;
use predicates::str::contains;
use tempfile::{TempDir, tempdir};

/// A running server, which ends with this.
struct Server {
    child: Child,
    /// Its address and port.
    address: String,
    /// The first line that it printed.
    line: String,
}

impl Server {
    fn start(folder: &Path, arguments: &[&str]) -> Self {
        let mut child = Command::new(cargo_bin("tilescope"))
            .args(["web", "--port", "0", "--folder"])
            .arg(folder)
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        output.read_line(&mut line).unwrap();
        let address = line
            .strip_prefix("http://")
            .and_then(|l| l.split('/').next());
        let address = address.unwrap_or_else(|| panic!("{line}")).to_owned();
        Self {
            child,
            address,
            line,
        }
    }

    /// Sends `method path` with the server's own name, and headers, and returns the answer.
    fn ask(&self, method: &str, path: &str, headers: &[&str]) -> Answer {
        let mut lines = vec![format!("Host: {}", self.address)];
        lines.extend(headers.iter().map(|&line| line.to_owned()));
        self.ask_raw(method, path, &lines)
    }

    fn get(&self, path: &str) -> Answer {
        self.ask("GET", path, &[])
    }

    fn ask_raw(&self, method: &str, path: &str, headers: &[String]) -> Answer {
        let mut request = format!("{method} {path} HTTP/1.1\r\nConnection: close\r\n");
        for line in headers {
            request.push_str(line);
            request.push_str("\r\n");
        }
        request.push_str("\r\n");
        let mut stream = TcpStream::connect(&self.address).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        Answer::parse(&bytes)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[derive(Debug)]
struct Answer {
    status: u16,
    headers: BTreeMap<String, String>,
    body: Vec<u8>,
}

impl Answer {
    fn parse(bytes: &[u8]) -> Self {
        let end = bytes.windows(4).position(|four| four == b"\r\n\r\n");
        let end = end.unwrap_or_else(|| panic!("{}", String::from_utf8_lossy(bytes)));
        let head = std::str::from_utf8(&bytes[..end]).unwrap();
        let mut lines = head.split("\r\n");
        let status = lines.next().unwrap().split(' ').nth(1).unwrap();
        let header = |line: &str| {
            let (name, value) = line.split_once(": ").unwrap();
            (name.to_ascii_lowercase(), value.to_owned())
        };
        Self {
            status: status.parse().unwrap(),
            headers: lines.map(header).collect(),
            body: bytes[end + 4..].to_vec(),
        }
    }

    fn header(&self, name: &str) -> &str {
        self.headers.get(name).map_or("", String::as_str)
    }
}

/// A folder to be served, beside a file that must not be served.
fn site() -> (TempDir, std::path::PathBuf) {
    let outer = tempdir().unwrap();
    let folder = outer.path().join("site");
    fs::create_dir_all(folder.join("example")).unwrap();
    fs::write(outer.path().join("secret.js"), "secret").unwrap();
    for (name, text) in [
        ("index.html", "the page"),
        ("sw.js", "worker"),
        ("manifest.webmanifest", "{}"),
        ("main-0123456789ab.js", "plain script"),
        ("main-0123456789ab.js.gz", "gzip script"),
        ("main-0123456789ab.js.br", "brotli script"),
        ("style-0123456789ab.css", "style"),
        ("tilescope_bg-0123456789ab.wasm", "\0asm"),
        ("still-0123456789ab.png", "png"),
        ("example/lecture.html", "lecture"),
        (".hidden.js", "hidden"),
    ] {
        fs::write(folder.join(name), text).unwrap();
    }
    (outer, folder)
}

#[test]
fn files_come_with_their_kinds_and_times() {
    let (_outer, folder) = site();
    let server = Server::start(&folder, &[]);
    assert!(server.address.starts_with("127.0.0.1:"), "{}", server.line);
    let check = "no-cache";
    let keep = "public, max-age=31536000, immutable";
    for (path, body, kind, time) in [
        ("/", "the page", "text/html; charset=utf-8", check),
        ("/index.html", "the page", "text/html; charset=utf-8", check),
        (
            "/?embed=player",
            "the page",
            "text/html; charset=utf-8",
            check,
        ),
        ("/sw.js", "worker", "text/javascript; charset=utf-8", check),
        (
            "/manifest.webmanifest",
            "{}",
            "application/manifest+json",
            check,
        ),
        (
            "/main-0123456789ab.js",
            "plain script",
            "text/javascript; charset=utf-8",
            keep,
        ),
        (
            "/style-0123456789ab.css",
            "style",
            "text/css; charset=utf-8",
            keep,
        ),
        (
            "/tilescope_bg-0123456789ab.wasm",
            "\0asm",
            "application/wasm",
            keep,
        ),
        ("/still-0123456789ab.png", "png", "image/png", keep),
        (
            "/example/lecture.html",
            "lecture",
            "text/html; charset=utf-8",
            check,
        ),
    ] {
        let answer = server.get(path);
        assert_eq!(answer.status, 200, "{path}");
        assert_eq!(answer.body, body.as_bytes(), "{path}");
        assert_eq!(answer.header("content-type"), kind, "{path}");
        assert_eq!(answer.header("cache-control"), time, "{path}");
        assert_eq!(answer.header("x-content-type-options"), "nosniff");
        assert_eq!(answer.header("referrer-policy"), "no-referrer");
        assert_eq!(
            answer.header("x-frame-options"),
            "",
            "pages may show it in frames"
        );
    }
    let head = server.ask("HEAD", "/main-0123456789ab.js", &[]);
    assert_eq!((head.status, head.body.len()), (200, 0));
    assert_eq!(head.header("content-length"), "12");
    let part = server.ask("GET", "/main-0123456789ab.js", &["Range: bytes=6-8"]);
    assert_eq!((part.status, &part.body[..]), (206, &b"scr"[..]));
    // A range in a unit that the server does not know is to be ignored.
    for range in ["items=0-1", "pages=2", "=0-1", "bytes-0"] {
        let whole = server.ask(
            "GET",
            "/main-0123456789ab.js",
            &[&format!("Range: {range}")],
        );
        assert_eq!((whole.status, whole.body.len()), (200, 12), "{range}");
    }
    let beyond = server.ask("GET", "/main-0123456789ab.js", &["Range: bytes=99-"]);
    assert_eq!(beyond.status, 416);
    let before: Vec<String> = names(&folder);
    drop(server);
    assert_eq!(names(&folder), before, "it writes nothing");
}

#[test]
fn what_has_not_changed_is_not_sent_again() {
    let (_outer, folder) = site();
    let server = Server::start(&folder, &[]);
    let first = server.get("/");
    let since = format!("If-Modified-Since: {}", first.header("last-modified"));
    let again = server.ask("GET", "/", &[&since]);
    assert_eq!((again.status, again.body.len()), (304, 0));
    assert_eq!(again.header("cache-control"), "no-cache");
    let old = "If-Modified-Since: Sat, 01 Jan 2000 00:00:00 GMT";
    assert_eq!(server.ask("GET", "/", &[old]).status, 200);
}

#[test]
fn compressed_copies_go_to_those_who_read_them() {
    let (_outer, folder) = site();
    let server = Server::start(&folder, &[]);
    for (accepted, body, encoding) in [
        ("gzip", "gzip script", "gzip"),
        ("br", "brotli script", "br"),
        ("gzip, deflate, br, zstd", "brotli script", "br"),
        ("br;q=0, gzip", "gzip script", "gzip"),
        ("identity", "plain script", ""),
    ] {
        let header = format!("Accept-Encoding: {accepted}");
        let answer = server.ask("GET", "/main-0123456789ab.js", &[&header]);
        assert_eq!(answer.body, body.as_bytes(), "{accepted}");
        assert_eq!(answer.header("content-encoding"), encoding, "{accepted}");
        assert_eq!(
            answer.header("content-type"),
            "text/javascript; charset=utf-8"
        );
        assert!(
            answer.header("vary").contains("accept-encoding"),
            "{answer:?}"
        );
    }
    let answer = server.ask("GET", "/still-0123456789ab.png", &["Accept-Encoding: br"]);
    assert_eq!(
        (answer.status, answer.header("content-encoding")),
        (200, "")
    );
}

#[test]
fn nothing_outside_the_folder_is_found() {
    let (outer, folder) = site();
    let server = Server::start(&folder, &[]);
    let secret = outer.path().join("secret.js");
    assert_eq!(fs::read(&secret).unwrap(), b"secret");
    let absolute = secret.to_str().unwrap();
    for path in [
        "/none.js",
        "/../secret.js",
        "/example/../../secret.js",
        "/%2e%2e/secret.js",
        "/%2E%2E%2Fsecret.js",
        "/..%2fsecret.js",
        "/..%5csecret.js",
        "/..\\secret.js",
        "/example/..%2f..%2fsecret.js",
        "/%252e%252e/secret.js",
        "/%c0%ae%c0%ae/secret.js",
        "/main-0123456789ab.js%00",
        "/%00",
        "/./index.html",
        "//index.html",
        "/index.html/",
        "/.hidden.js",
        "/%2ehidden.js",
        "/etc/passwd",
        "/%2fetc%2fpasswd",
    ] {
        let answer = server.get(path);
        assert_eq!(answer.status, 404, "{path}");
        assert_eq!(answer.body, b"There is no such file.\n", "{path}");
    }
    for path in [absolute.to_owned(), format!("/{absolute}")] {
        assert_eq!(server.get(&path).status, 404, "{path}");
    }
}

#[test]
fn folders_are_not_listed() {
    let (_outer, folder) = site();
    let server = Server::start(&folder, &[]);
    for path in ["/example", "/example/", "/example/."] {
        let answer = server.get(path);
        assert_eq!(answer.status, 404, "{path}");
        assert!(!String::from_utf8_lossy(&answer.body).contains("lecture"));
    }
}

#[cfg(unix)]
#[test]
fn links_do_not_lead_out() {
    use std::os::unix::fs::symlink;
    let (outer, folder) = site();
    symlink(outer.path().join("secret.js"), folder.join("out.js")).unwrap();
    symlink(outer.path(), folder.join("outside")).unwrap();
    symlink(folder.join("sw.js"), folder.join("in.js")).unwrap();
    symlink(outer.path().join("secret.js"), folder.join("sw.js.gz")).unwrap();
    let server = Server::start(&folder, &[]);
    for path in ["/out.js", "/outside/secret.js", "/sw.js", "/in.js"] {
        let answer = server.ask("GET", path, &["Accept-Encoding: gzip"]);
        assert_eq!(answer.status, 404, "{path}");
    }
    fs::remove_file(folder.join("sw.js.gz")).unwrap();
    assert_eq!(server.get("/in.js").body, b"worker");
}

#[test]
fn files_can_only_be_read() {
    let (_outer, folder) = site();
    let server = Server::start(&folder, &[]);
    for method in ["POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "BREW"] {
        let answer = server.ask(method, "/index.html", &["Content-Length: 0"]);
        assert_eq!(answer.status, 405, "{method}");
        assert_eq!(answer.header("allow"), "GET, HEAD", "{method}");
    }
    assert_eq!(server.get("/").body, b"the page");
}

#[test]
fn names_that_are_not_this_machines_are_refused() {
    let (_outer, folder) = site();
    let server = Server::start(&folder, &[]);
    let port = server.address.rsplit_once(':').unwrap().1;
    for (host, status) in [
        (format!("localhost:{port}"), 200),
        (format!("127.0.0.1:{port}"), 200),
        (format!("[::1]:{port}"), 200),
        ("evil.example".to_owned(), 421),
        (format!("evil.example:{port}"), 421),
        (format!("127.0.0.1.evil.example:{port}"), 421),
        (format!("192.168.0.1:{port}"), 421),
        (String::new(), 421),
    ] {
        let answer = server.ask_raw("GET", "/", &[format!("Host: {host}")]);
        assert_eq!(answer.status, status, "{host}");
    }
    let two = [
        format!("Host: {}", server.address),
        "Host: evil.example".to_owned(),
    ];
    assert_eq!(server.ask_raw("GET", "/", &two).status, 421);
    assert_eq!(server.ask_raw("GET", "/", &[]).status, 421);
    assert_eq!(server.get("http://evil.example/").status, 421);
}

/// The policy of a page's meta element.
fn policy(page: &str) -> String {
    let at = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../web")
        .join(page);
    let text = fs::read_to_string(at).unwrap();
    let behind = text
        .split_once("http-equiv=\"Content-Security-Policy\"")
        .unwrap()
        .1;
    let content = behind.split_once("content=\"").unwrap().1;
    content.split_once('"').unwrap().0.to_owned()
}

#[test]
fn the_policy_is_the_pages_own() {
    let (_outer, folder) = site();
    let server = Server::start(&folder, &[]);
    for (path, page) in [
        ("/", "page/index.html"),
        ("/main-0123456789ab.js", "page/index.html"),
        ("/example/lecture.html", "example/lecture.html"),
    ] {
        let answer = server.get(path);
        assert_eq!(
            answer.header("content-security-policy"),
            policy(page),
            "{path}"
        );
    }
    assert!(policy("page/index.html").starts_with("default-src 'none'; "));
    assert!(!policy("page/index.html").contains("unsafe-inline"));
}

#[test]
fn a_taken_port_is_named() {
    let (outer, folder) = site();
    let other = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let port = other.local_addr().unwrap().port().to_string();
    tilescope(&outer)
        .args(["web", "--port", &port, "--folder"])
        .arg(&folder)
        .assert()
        .code(2)
        .stderr(contains(format!("port {port} of 127.0.0.1 is taken")));
}

#[test]
fn without_a_page_it_says_how_to_make_one() {
    let folder = tempdir().unwrap();
    for arguments in [
        &["web"][..],
        &["web", "--folder", "."],
        &["web", "--folder", "none"],
    ] {
        tilescope(&folder)
            .args(arguments)
            .assert()
            .code(2)
            .stderr(contains("web/build").and(contains("error: ")));
    }
}

#[test]
fn the_page_in_web_dist_is_found_by_itself() {
    let (outer, folder) = site();
    fs::create_dir(outer.path().join("web")).unwrap();
    fs::rename(&folder, outer.path().join("web/dist")).unwrap();
    let mut child = Command::new(cargo_bin("tilescope"))
        .args(["web", "--port", "0"])
        .current_dir(outer.path())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    let mut output = BufReader::new(child.stdout.take().unwrap());
    output.read_line(&mut line).unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(line.contains("dist; Ctrl+C ends it"), "{line}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_it() {
    let (_outer, folder) = site();
    let mut server = Server::start(&folder, &[]);
    assert_eq!(server.get("/").status, 200);
    // A connection that is kept open does not keep the program.
    let _open = TcpStream::connect(&server.address).unwrap();
    let id = server.child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &id])
            .status()
            .unwrap()
            .success()
    );
    assert_eq!(server.child.wait().unwrap().code(), Some(0));
    assert!(TcpStream::connect(&server.address).is_err());
}

#[test]
fn other_machines_are_let_in_only_when_asked_for() {
    let (_outer, folder) = site();
    let mut child = Command::new(cargo_bin("tilescope"))
        .args(["web", "--port", "0", "--host", "0.0.0.0", "--folder"])
        .arg(&folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    let mut output = BufReader::new(child.stdout.take().unwrap());
    output.read_line(&mut line).unwrap();
    let mut second = String::new();
    output.read_line(&mut second).unwrap();
    let named = second.strip_suffix(" is its address for other machines\n");
    let named = named.unwrap_or_else(|| panic!("{second}"));
    assert!(
        !named.contains("0.0.0.0") && !named.contains("127.0.0.1"),
        "{named}"
    );
    let mut warning = String::new();
    let mut errors = BufReader::new(child.stderr.take().unwrap());
    errors.read_line(&mut warning).unwrap();
    let address = line
        .strip_prefix("http://")
        .and_then(|l| l.split('/').next());
    let mut server = Server {
        address: address.unwrap().to_owned(),
        child,
        line,
    };
    assert!(
        warning.contains("warning: other machines can reach"),
        "{warning}"
    );
    let answer = server.ask_raw("GET", "/", &["Host: lecture.example".to_owned()]);
    assert_eq!(answer.status, 200);
    assert!(server.child.try_wait().unwrap().is_none());
}
