//! Makes `web/dist` from a wasm module and the page: binds the module to JavaScript, names files by their content,
//! compresses them, and fails if the download is too large to start quickly. It does not compile the program.

mod binding;
mod budget;
mod compress;
mod cut;
mod folder;
mod names;
mod page;
mod rewrite;
mod script;
mod site;

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::Parser;
use tilescope_lessons::shipped;
use tilescope_session::language;

/// Packs the page and a wasm module into a folder for any static server.
#[derive(Debug, Parser)]
#[command(name = "tilescope-web-pack")]
struct Arguments {
    /// The module as cargo built it
    #[arg(long, value_name = "FILE")]
    wasm: PathBuf,
    /// The page's folder
    #[arg(long, value_name = "FOLDER", default_value = "web/page")]
    page: PathBuf,
    /// A folder that is copied as it is to `example/`
    #[arg(long, value_name = "FOLDER", default_value = "web/example")]
    example: PathBuf,
    /// The folder with the page of a package for course systems, which goes into one file
    #[arg(long, value_name = "FOLDER", default_value = "web/course")]
    course: PathBuf,
    /// The folder to write; the output of an earlier run is replaced
    #[arg(long, value_name = "FOLDER", default_value = "web/dist")]
    out: PathBuf,
    /// The folder's public address, as `https://example.org/tilescope/`: sites that show a preview picture of links
    /// need its full address
    #[arg(long, value_name = "ADDRESS", value_parser = address)]
    address: Option<String>,
    /// The record store, as `https://store.example`, to which the page may send answers where its address names it; without
    /// this the page's policy refuses every other server
    #[arg(long, value_name = "ORIGIN", value_parser = store)]
    xapi: Option<String>,
    /// The most bytes, compressed by brotli, that may be needed to start
    #[arg(long, value_name = "BYTES", default_value_t = budget::MAX_TO_START)]
    most: usize,
}

fn address(text: &str) -> Result<String, String> {
    let is_web = text.starts_with("https://") || text.starts_with("http://");
    if is_web && text.ends_with('/') && !text.contains(['"', '<', '&', '?', '#']) {
        Ok(text.to_owned())
    } else {
        Err("it begins with https:// or http:// and ends with a slash".to_owned())
    }
}

/// Returns the origin of a record store as it is written: `https://`, a host, and perhaps a colon and a port.
fn store(text: &str) -> Result<String, String> {
    // Without this beginning the host is empty, and is refused below.
    let after = text.strip_prefix("https://").unwrap_or_default();
    // Without a port, that of https stands in.
    let (host, port) = after.split_once(':').unwrap_or((after, "443"));

    // What would end the directive, or allow more than one server, is refused: blanks, semicolons and stars.
    let is_of_label = |c: char| c.is_ascii_alphanumeric() || c == '-';
    let is_label = |label: &str| !label.is_empty() && label.chars().all(is_of_label);
    let is_port = !port.is_empty() && port.chars().all(|c| c.is_ascii_digit());

    if host.split('.').all(is_label) && is_port {
        Ok(text.to_owned())
    } else {
        Err("it is https:// and a host, perhaps with a port, and no path".to_owned())
    }
}

fn main() -> ExitCode {
    match pack(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// Reads the page and the module, and writes the folder to be served.
fn pack(arguments: &Arguments) -> Result<()> {
    // The folder is checked first, since compressing the module takes half a minute.
    folder::may_replace(&arguments.out)?;
    let mut sources = page::read(&arguments.page)?;
    let module = std::fs::read(&arguments.wasm)
        .with_context(|| format!("cannot read the module {}", arguments.wasm.display()))?;
    let bound = binding::bind(module)?;
    for (name, bytes) in bound.files {
        sources.insert(name, page::Source::made(bytes));
    }

    // The program loads this file only when lessons are opened. Its words in other languages are in it, too.
    let tables = language::TABLES.iter();
    let lessons = shipped::to_json(&shipped::Loaded {
        lessons: shipped::all(),
        tables: tables
            .map(|&(tag, table)| (tag.to_owned(), table.to_owned()))
            .collect(),
    });
    sources.insert(
        names::LESSONS.to_owned(),
        page::Source::made(lessons.into_bytes()),
    );
    sources.insert(names::COURSE.to_owned(), page::course(&arguments.course)?);
    // A page without the program loads the words of one language alone.
    for &(language, table) in language::TABLES {
        sources.insert(format!("{language}.txt"), page::Source::made(table.into()));
    }

    if let Some(origin) = &arguments.xapi {
        page::allow_store(&mut sources, origin)?;
    }
    // An empty address stands for one that is not given.
    let address = arguments.address.as_deref().unwrap_or_default();
    site::add(&mut sources, address)?;
    let mut files = page::assemble(&sources, address)?;
    let first_page = site::first_page_sizes(&files)?;
    files.extend(page::example(&arguments.example)?);

    let packed = compress::all(files, &arguments.out);
    let table = budget::Table::of(&packed, first_page);
    println!("{}", bound.weights);
    print!("{table}");
    // The table is most useful where the budget is exceeded, so that it is printed before the check.
    table.check(arguments.most)?;
    folder::write(&arguments.out, &packed)?;
    println!("{} is ready", arguments.out.display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_store_is_one_host_by_https() {
        for right in ["https://store.example", "https://lrs.example.org:8443"] {
            assert_eq!(store(right).as_deref(), Ok(right));
        }
        for wrong in [
            "http://store.example",
            "https://",
            "https://store.example/xapi",
            "https://*",
            "https://a.example https://b.example",
            "https://a.example; script-src *",
            "https://:8443",
            "https://a:b:c",
            "https://..",
            "https://store.example:",
        ] {
            assert!(store(wrong).is_err(), "{wrong}");
        }
    }
}
