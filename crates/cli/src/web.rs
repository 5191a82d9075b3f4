//! `tilescope web`: hands a built page out, on this machine alone unless asked otherwise. It builds nothing and
//! changes nothing.

mod headers;
mod open;
mod site;
mod within;

use std::io::ErrorKind;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};
use clap::Args;
use tokio::net::TcpListener;

use crate::{EXIT_FINE, output};
use site::Site;

/// Arguments of `tilescope web`.
#[derive(Debug, Args)]
#[command(after_help = "Build the page first: web/build. Ctrl+C ends the server.")]
pub struct WebArguments {
    /// The port; 0 takes any free one
    #[arg(long, value_name = "N", default_value_t = 8080)]
    port: u16,
    /// The address to listen at; any but this machine's own lets other machines in
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
    let site = Site::new(&folder, arguments.host.is_loopback())?;
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .context("cannot start the server")?;
    runtime.block_on(serve(arguments, site))
}

async fn serve(arguments: &WebArguments, site: Site) -> Result<u8> {
    let listener = listen(arguments).await?;
    let address = listener.local_addr()?;
    if !arguments.host.is_loopback() {
        eprintln!(
            "warning: other machines can reach {address}. Without https their browsers give the page neither WebGPU \
             nor offline use."
        );
    }
    let page = format!("http://{}/", reachable(address));
    output::emit(&format!(
        "{page} serves {}; Ctrl+C ends it\n",
        site.folder().display()
    ))?;
    if arguments.open {
        // Some systems are done with it only when the browser is closed.
        std::thread::spawn(move || {
            if let Err(error) = open::in_browser(&page) {
                eprintln!("warning: {error:#}; open {page} yourself");
            }
        });
    }
    let served = axum::serve(listener, site.router());
    // A file that is on its way when Ctrl+C comes can be asked for again.
    tokio::select! {
        ended = served.into_future() => ended.context("the server ended")?,
        asked = tokio::signal::ctrl_c() => asked.context("cannot listen for Ctrl+C")?,
    }
    Ok(EXIT_FINE)
}

async fn listen(arguments: &WebArguments) -> Result<TcpListener> {
    let address = SocketAddr::new(arguments.host, arguments.port);
    TcpListener::bind(address)
        .await
        .map_err(|error| match error.kind() {
            ErrorKind::AddrInUse => anyhow!(
                "port {} of {} is taken; --port takes another, --port 0 any free one",
                arguments.port,
                arguments.host
            ),
            _ => anyhow::Error::new(error).context(format!("cannot listen at {address}")),
        })
}

/// Returns an address that a browser on this machine can go to.
fn reachable(address: SocketAddr) -> SocketAddr {
    if address.ip().is_unspecified() {
        SocketAddr::from((Ipv4Addr::LOCALHOST, address.port()))
    } else {
        address
    }
}

/// Returns the folder to serve.
fn folder(asked: Option<&Path>) -> Result<PathBuf> {
    let has_page = |folder: &Path| folder.join("index.html").is_file();
    if let Some(folder) = asked {
        if has_page(folder) {
            return Ok(folder.to_owned());
        }
        bail!(
            "there is no index.html in {}; web/build makes the page, in web/dist",
            folder.display()
        );
    }
    let mut places = vec![PathBuf::from("web/dist")];
    if let Ok(program) = std::env::current_exe()
        && let Some(beside) = program.parent()
    {
        places.push(beside.join("web"));
    }
    if let Some(folder) = places.iter().find(|folder| has_page(folder)) {
        return Ok(folder.clone());
    }
    let places: Vec<String> = places.iter().map(|p| p.display().to_string()).collect();
    bail!(
        "there is no page in {}; run web/build, or name its folder by --folder",
        places.join(" or ")
    )
}
