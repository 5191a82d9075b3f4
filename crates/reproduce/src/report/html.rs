//! The report as one HTML page that needs no other file.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use tilescope_figures::escape;

use super::{Block, Span, TITLE};
use crate::outcome::Verdict;

const STYLE: &str = "body{font:15px/1.55 system-ui,sans-serif;color:#1a1d21;margin:2rem auto;max-width:1240px;padding:0 1rem}\
h2{margin-top:3rem;border-top:1px solid #d5dae0;padding-top:1.5rem}\
table{border-collapse:collapse;font-variant-numeric:tabular-nums;margin:1rem 0}\
th,td{padding:.25rem .8rem;border-bottom:1px solid #d5dae0;text-align:left;vertical-align:top}\
td.n,th.n{text-align:right}thead th{border-bottom:2px solid #5b6470}\
figure{margin:1.5rem 0}figure img{max-width:100%;height:auto}figcaption{color:#5b6470}\
.wide{overflow-x:auto}.v{white-space:nowrap;font-weight:600}.yes::before{content:'\\2713\\00a0'}\
.no::before{content:'\\2717\\00a0'}.open::before{content:'\\2013\\00a0'}\
.yes{color:#00684a}.no{color:#a33f00}.open{color:#5b6470}\
dl{display:grid;grid-template-columns:max-content 1fr;gap:.1rem 1rem}dd{margin:0}code{background:#f6f7f9;padding:.1rem .3rem}";

/// Returns the page; pictures are read from `figures`.
pub fn page(blocks: &[Block], figures: &Path) -> String {
    let title = escape(TITLE);
    // The style is a part of the page, so that the page needs no other file.
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n"
    );

    for block in blocks {
        // Writing to a String cannot fail.
        let _ = match block {
            Block::Section(one) => {
                writeln!(out, "<h2 id=\"{one}\">{}</h2>", escape(one.title()))
            }
            Block::Text(spans) => {
                let text: String = spans.iter().map(span_text).collect();
                writeln!(out, "<p>{text}</p>")
            }
            Block::Facts(facts) => {
                // The names are words of this program, without letters that would have to be escaped.
                let fact = |(name, value): &(&str, Span)| {
                    format!("<dt>{name}</dt><dd>{}</dd>", span_text(value))
                };
                let items: String = facts.iter().map(fact).collect();
                writeln!(out, "<dl>{items}</dl>")
            }
            Block::Table {
                title,
                numbers,
                heads,
                rows,
            } => {
                // A table of claims is a section of its own; one of numbers stands in an experiment's section. Numbers are set
                // to the right by the class.
                let (level, class) = if *numbers {
                    (3, " class=\"n\"")
                } else {
                    (2, "")
                };

                let head = |head: &String| format!("<th{class}>{}</th>", escape(head));
                let head_cells: String = heads.iter().map(head).collect();
                let cell = |one: &Span| format!("<td{class}>{}</td>", span_text(one));
                let row = |row: &Vec<Span>| {
                    let cells: String = row.iter().map(cell).collect();
                    format!("<tr>{cells}</tr>\n")
                };

                let body: String = rows.iter().map(row).collect();
                writeln!(
                    out,
                    "<h{level}>{}</h{level}>\n<div class=\"wide\"><table>\n<thead><tr>{head_cells}</tr></thead>\n\
                     <tbody>\n{body}</tbody></table></div>",
                    escape(title)
                )
            }
            Block::Picture(file, caption) => {
                picture(&mut out, &figures.join(format!("{file}.svg")), caption);
                Ok(())
            }
        };
    }

    out.push_str("</body>\n</html>\n");
    out
}

/// Returns a span of text in HTML.
fn span_text(span: &Span) -> String {
    match span {
        Span::Plain(text) => escape(text),
        Span::Strong(text) => format!("<strong>{}</strong>", escape(text)),
        Span::Code(text) => format!("<code>{}</code>", escape(text)),
        Span::Link(experiment, text) => format!("<a href=\"#{experiment}\">{}</a>", escape(text)),
        Span::Verdict(verdict, text) => {
            let class = match verdict {
                Verdict::Reproduced => "yes",
                Verdict::NotReproduced => "no",
                Verdict::NotComparable => "open",
            };
            format!("<span class=\"v {class}\">{}</span>", escape(text))
        }
    }
}

/// Puts a picture into the page itself, as an image of its own, so that ids within it do not clash with those of
/// others.
fn picture(out: &mut String, path: &Path, caption: &str) {
    let caption = escape(caption);
    let Ok(svg) = fs::read_to_string(path) else {
        let _ = writeln!(out, "<p>The picture is missing: {caption}</p>");
        return;
    };
    let _ = writeln!(
        out,
        "<figure><img alt=\"{caption}\" src=\"data:image/svg+xml;charset=utf-8,{}\"><figcaption>{caption}</figcaption></figure>",
        in_address(&svg)
    );
}

/// Returns text as it may stand in a data address between double quotes.
fn in_address(text: &str) -> String {
    let mut out = text.replace(['\n', '\r', '\t'], " ");
    for letter in ['%', '#', '"', '<', '>', '&'] {
        out = out.replace(letter, &format!("%{:02X}", letter as u32));
    }
    out
}
