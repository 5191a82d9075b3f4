//! A page shown to headless Chromium, from a server that lives as long as the visit.

use std::collections::HashMap;
use std::ffi::OsString;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// The variable that names the browser's program.
const VARIABLE: &str = "TILESCOPE_CHROMIUM";
const PROGRAMS: [&str; 4] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
];

/// Headless, quiet, and with WebGPU on its own software renderer whatever hardware there is.
const FLAGS: [&str; 16] = [
    "--headless=new",
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--use-webgpu-adapter=swiftshader",
    "--enable-unsafe-swiftshader",
    "--enable-unsafe-webgpu",
    "--ignore-gpu-blocklist",
    "--enable-features=Vulkan",
    "--use-vulkan=swiftshader",
    "--disable-dev-shm-usage",
    "--disable-quic",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-default-browser-check",
    "--no-first-run",
];

/// A page's files, by their paths.
pub type Files = HashMap<&'static str, Vec<u8>>;

/// Shows the page `path` of `files` to a browser and returns what it posts to `/result` within the time. One page
/// at a time, so that it has the machine.
pub fn visit(files: &Arc<Files>, path: &str, time: Duration) -> Result<String, String> {
    static TURN: Mutex<()> = Mutex::new(());
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = Folder(tempfile::tempdir().expect("a folder"));
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a port");
    let address = listener.local_addr().expect("an address");
    let (sender, receiver) = channel();
    let served = Arc::clone(files);
    // It ends with the process: nothing tells a listener to stop.
    thread::spawn(move || serve(&listener, &served, &sender));
    let mut browser = Browser::start(folder.0.path(), &format!("http://{address}{path}"))?;
    let end = Instant::now() + time;
    loop {
        match receiver.recv_timeout(Duration::from_millis(200)) {
            Ok(line) => return Ok(line),
            Err(RecvTimeoutError::Disconnected) => return Err("the server ended".to_owned()),
            Err(RecvTimeoutError::Timeout) => {}
        }
        let wrong = match browser.0.try_wait().expect("a state") {
            Some(status) => format!("the browser ended with {status}"),
            None if Instant::now() > end => format!("no result within {} s", time.as_secs()),
            None => continue,
        };
        let log = std::fs::read(folder.0.path().join("log")).unwrap_or_default();
        return Err(format!("{wrong}:\n{}", String::from_utf8_lossy(&log)));
    }
}

/// A browser's folder.
struct Folder(TempDir);

impl Drop for Folder {
    fn drop(&mut self) {
        // The browser's other processes end a little later than the first, and write to the last.
        let gone = |_: &u32| {
            thread::sleep(Duration::from_millis(100));
            std::fs::remove_dir_all(self.0.path()).is_ok()
        };
        let _ = (0..50).find(gone);
    }
}

/// A running browser, which ends with this.
struct Browser(Child);

impl Browser {
    /// Starts the first browser that there is, with a profile of its own.
    fn start(folder: &Path, address: &str) -> Result<Self, String> {
        let log = File::create(folder.join("log")).expect("a file");
        let named = std::env::var_os(VARIABLE);
        let programs = named.map_or_else(
            || PROGRAMS.map(OsString::from).to_vec(),
            |program| vec![program],
        );
        for program in &programs {
            let mut profile = OsString::from("--user-data-dir=");
            profile.push(folder.join("profile"));
            let started = Command::new(program)
                .args(FLAGS)
                .args([profile, address.into()])
                .env("TMPDIR", folder)
                .stdin(Stdio::null())
                .stdout(log.try_clone().expect("a file"))
                .stderr(log.try_clone().expect("a file"))
                .spawn();
            if let Ok(child) = started {
                return Ok(Self(child));
            }
        }
        Err(format!(
            "there is no Chromium, looked for as {programs:?}; on Debian run: sudo apt-get install chromium; \
             elsewhere set {VARIABLE} to its program"
        ))
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // If it has ended already, all is well.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn serve(listener: &TcpListener, files: &Arc<Files>, results: &Sender<String>) {
    for stream in listener.incoming().flatten() {
        let (files, results) = (Arc::clone(files), results.clone());
        // A browser opens connections that it may never use.
        thread::spawn(move || {
            // One that breaks off has shown what it could.
            let _ = answer(&stream, &files, &results);
        });
    }
}

/// Answers one request and closes the connection.
fn answer(stream: &TcpStream, files: &Files, results: &Sender<String>) -> std::io::Result<()> {
    let mut reader = BufReader::new(stream);
    let mut first = String::new();
    reader.read_line(&mut first)?;
    let mut length = 0;
    loop {
        let mut line = String::new();
        if reader.read_line(&mut line)? == 0 || line == "\r\n" {
            break;
        }
        if let Some((name, value)) = line.split_once(':')
            && name.eq_ignore_ascii_case("content-length")
        {
            length = value.trim().parse().unwrap_or(0);
        }
    }
    let mut words = first.split_whitespace();
    let (method, path) = (words.next().unwrap_or(""), words.next().unwrap_or(""));
    let path = path.split('?').next().unwrap_or("");
    let (state, body) = match (method, path, files.get(path)) {
        ("POST", "/result", _) => {
            let mut line = vec![0; length];
            reader.read_exact(&mut line)?;
            // A visit that is over wants no second line.
            let _ = results.send(String::from_utf8_lossy(&line).into_owned());
            ("200 OK", &[][..])
        }
        ("GET", _, Some(file)) => ("200 OK", &file[..]),
        _ => ("404 Not Found", &[][..]),
    };
    let kind = match Path::new(path).extension().and_then(|e| e.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("wasm") => "application/wasm",
        _ => "text/plain; charset=utf-8",
    };
    let mut stream = stream;
    write!(
        stream,
        "HTTP/1.1 {state}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
        body.len()
    )?;
    stream.write_all(body)
}
