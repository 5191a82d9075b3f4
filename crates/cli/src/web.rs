//! `tilescope web`: serves the built page, by default to this machine only.

mod headers;
mod site;
mod within;

use std::io::ErrorKind;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket};
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, anyhow, bail, ensure};
use axum::Router;
use axum::serve::Listener;
use clap::Args;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tilescope_session::page_folder::{has_page, page_folder};
use tokio::net::TcpListener;

use crate::paths::named;
use crate::{EXIT_FINE, interrupt, output};
use site::ServedFolder;

/// A connection is closed if the head of a request takes longer than this to arrive. Chosen, not measured.
const HEAD_LIMIT: Duration = Duration::from_secs(20);

/// Arguments of `tilescope web`.
#[derive(Debug, Args)]
#[command(after_help = "Build the page first: web/build. Ctrl+C ends the server.")]
pub struct WebArguments {
    /// The port; 0 takes any free one
    #[arg(long, value_name = "N", default_value_t = 8080)]
    port: u16,
    /// The address to listen at; with any but the default, other machines can reach the page
    #[arg(long, value_name = "ADDR", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    host: IpAddr,
    /// The built page [default: web/dist, or the folder `web` beside the program]
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,
    /// Show the page in the browser
    #[arg(long)]
    open: bool,
}

pub fn run(arguments: &WebArguments) -> Result<u8> {
    let folder = folder(arguments.folder.as_deref())?;
    let site = ServedFolder::new(&folder, arguments.host.is_loopback())?;
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .context("cannot start the server")?;
    runtime.block_on(serve(arguments, site))
}

/// Serves the page until a signal asks to end.
async fn serve(arguments: &WebArguments, site: ServedFolder) -> Result<u8> {
    let listener = listen(arguments).await?;
    let address = listener.local_addr()?;
    let page = format!("http://{}/", reachable(address));
    let mut text = format!("{page} serves {}; Ctrl+C ends it\n", named(&site.folder));

    // A loopback address can be reached from this machine only.
    if !address.ip().is_loopback() {
        text += &elsewhere(address, outward(address.ip()));
        text += " is its address for other machines\n";
        output::note(
            "warning: other machines can reach this server. Without https their browsers give the page neither WebGPU \
             nor offline use.",
        );
    }

    output::emit(&text)?;
    if arguments.open {
        // On some systems this returns only when the browser is closed.
        std::thread::spawn(move || {
            if let Err(error) = open::that(&page) {
                output::note(&format!("warning: {error}; open {page} yourself"));
            }
        });
    }

    // No answer ends the server; only the request to end does.
    let served = answer_all(listener, site.router(), HEAD_LIMIT);
    tokio::select! {
        () = served => {}
        asked = interrupt::asked() => asked.context("cannot listen for Ctrl+C")?,
    }
    Ok(EXIT_FINE)
}

/// Answers requests forever. Closes connections whose next head is not complete after `limit`.
async fn answer_all(mut listener: TcpListener, router: Router, limit: Duration) {
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(limit);
    loop {
        // Waits while there are too many connections.
        let (stream, _) = Listener::accept(&mut listener).await;
        let service = TowerToHyperService::new(router.clone());
        let connection = http.serve_connection(TokioIo::new(stream), service);
        tokio::spawn(async move {
            // If the connection breaks, the browser reports it.
            let _ = connection.await;
        });
    }
}

async fn listen(arguments: &WebArguments) -> Result<TcpListener> {
    let address = SocketAddr::new(arguments.host, arguments.port);
    let (port, host) = (arguments.port, arguments.host);
    match TcpListener::bind(address).await {
        Err(error) if error.kind() == ErrorKind::AddrInUse => {
            bail!("port {port} of {host} is taken; --port takes another, --port 0 any free one")
        }
        listener => listener.with_context(|| format!("cannot listen at {address}")),
    }
}

/// Returns an address that a browser on this machine can open.
fn reachable(mut address: SocketAddr) -> SocketAddr {
    if address.ip().is_unspecified() {
        address.set_ip(Ipv4Addr::LOCALHOST.into());
    }
    address
}

/// Returns the page's address for other machines; `outward` is the address of this machine, if it is known.
fn elsewhere(address: SocketAddr, outward: Option<IpAddr>) -> String {
    let port = address.port();
    match outward {
        _ if !address.ip().is_unspecified() => format!("http://{address}/"),
        Some(ip) => format!("http://{}/", SocketAddr::new(ip, port)),
        None => format!("http://NAME:{port}/ with this machine's name"),
    }
}

/// Returns the address from which this machine reaches others, if it can. No packet is sent.
fn outward(listening: IpAddr) -> Option<IpAddr> {
    // To connect this kind of socket only chooses a way to the far address, and with it one's own. The far ones are reserved
    // for documentation (RFC 5737, RFC 3849); any port would do.
    let (own, far) = if listening.is_ipv4() {
        ("0.0.0.0:0", "192.0.2.1:9")
    } else {
        ("[::]:0", "[2001:db8::1]:9")
    };
    let socket = UdpSocket::bind(own).ok()?;
    socket.connect(far).ok()?;
    Some(socket.local_addr().ok()?.ip())
}

/// Returns the folder of the built page: the one that was asked for, or one of the usual ones.
///
/// # Errors
///
/// There is no page.
pub fn folder(asked: Option<&Path>) -> Result<PathBuf> {
    if let Some(folder) = asked {
        // The server serves the files of any folder. In a wrong one the browser would find no page, and the files there
        // would be open to read.
        ensure!(
            has_page(folder),
            "there is no index.html in {}; web/build makes the page, in web/dist",
            named(folder)
        );
        return Ok(folder.to_owned());
    }
    page_folder().map_err(|tried| {
        let folders: Vec<_> = tried.iter().map(|p| p.to_string_lossy()).collect();
        anyhow!(
            "there is no page in {}; run web/build, or name its folder by --folder",
            folders.join(" or ")
        )
    })
}

#[cfg(test)]
mod tests {
    use std::io::{Read, Write};
    use std::net::TcpStream;

    use super::*;

    #[test]
    fn other_machines_are_given_an_address_that_is_theirs_to_reach() {
        let any = SocketAddr::from(([0, 0, 0, 0], 80));
        let own = Some(IpAddr::from([10, 0, 0, 7]));
        assert_eq!(elsewhere(any, own), "http://10.0.0.7:80/");
        assert!(elsewhere(any, None).contains(":80/"));
        let one = SocketAddr::from(([10, 0, 0, 9], 80));
        assert_eq!(elsewhere(one, own), "http://10.0.0.9:80/");
        assert_eq!(reachable(any), SocketAddr::from((Ipv4Addr::LOCALHOST, 80)));
    }

    #[test]
    fn half_a_request_is_not_waited_for_for_ever() {
        let listener = std::net::TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        listener.set_nonblocking(true).unwrap();
        let address = listener.local_addr().unwrap();
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .unwrap();
        let answer = |request: &str| {
            let mut stream = TcpStream::connect(address).unwrap();
            // If the server keeps waiting, the test fails instead of hanging.
            stream
                .set_read_timeout(Some(Duration::from_secs(10)))
                .unwrap();
            stream.write_all(request.as_bytes()).unwrap();
            let mut bytes = Vec::new();
            stream.read_to_end(&mut bytes).map(|_| bytes)
        };
        let asks = std::thread::scope(|scope| {
            let asks = scope.spawn(|| {
                let half = answer("GET / HTTP/1.1\r\nHost: x\r\n").expect("closed");
                let silent = answer("").expect("closed");
                let whole = answer("GET / HTTP/1.1\r\nHost: x\r\n\r\n").expect("closed when idle");
                [half, silent, whole]
            });
            runtime.block_on(async {
                let listener = TcpListener::from_std(listener).unwrap();
                let router = Router::new().fallback(|| async { "served" });
                let served = answer_all(listener, router, Duration::from_millis(10));
                let ended = async {
                    while !asks.is_finished() {
                        tokio::time::sleep(Duration::from_millis(1)).await;
                    }
                };
                tokio::select! {
                    () = served => {}
                    () = ended => {}
                }
            });
            asks.join().unwrap()
        });
        let text = asks.map(|bytes| String::from_utf8(bytes).unwrap());
        assert!(!text[0].contains("served") && !text[1].contains("served"));
        assert!(text[2].ends_with("served"));
    }
}
