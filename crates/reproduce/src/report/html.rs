//! The report as one page that needs nothing from elsewhere.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use tilescope_figures::escape;

use crate::finished::Finished;
use crate::numbers::readable;
use crate::outcome::{Claim, Table, Verdict};

use super::{INTRODUCTION, Pages};

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
pub fn page(pages: &Pages, figures: &Path) -> String {
    let title = "Reproduction of Wang &amp; Suda 2017";
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n<p>{}</p>\n",
        escape(INTRODUCTION)
    );
    for line in &pages.broken {
        let _ = writeln!(out, "<p class=\"v no\">{}</p>", escape(line));
    }
    claims(&mut out, "What the paper says", &pages.claims(true));
    claims(&mut out, "Beyond the paper", &pages.claims(false));
    for one in &pages.finished {
        experiment(&mut out, one, figures);
    }
    out.push_str("</body>\n</html>\n");
    out
}

fn claims(out: &mut String, title: &str, claims: &[(&Finished, &Claim)]) {
    if claims.is_empty() {
        return;
    }
    let _ = write!(
        out,
        "<h2>{title}</h2>\n<div class=\"wide\"><table>\n<thead><tr><th>claim</th><th>place</th><th>the paper</th>\
         <th>here</th><th>verdict</th></tr></thead>\n<tbody>\n"
    );
    for (one, claim) in claims {
        row(out, one, claim);
    }
    out.push_str("</tbody></table></div>\n");
}

fn row(out: &mut String, one: &Finished, claim: &Claim) {
    let _ = writeln!(
        out,
        "<tr><td><a href=\"#{}\">{}</a></td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
        one.experiment,
        escape(&claim.claim),
        escape(&claim.place),
        escape(&claim.paper),
        escape(&claim.ours),
        verdict(one, claim)
    );
}

fn verdict(one: &Finished, claim: &Claim) -> String {
    let class = match claim.verdict {
        Verdict::Reproduced => "yes",
        Verdict::NotReproduced => "no",
        Verdict::NotComparable => "open",
    };
    format!("<span class=\"v {class}\">{}</span>", one.words(claim))
}

fn experiment(out: &mut String, one: &Finished, figures: &Path) {
    let _ = write!(
        out,
        "<h2 id=\"{}\">{}</h2>\n<dl><dt>Command</dt><dd><code>{}</code></dd><dt>Seed</dt><dd>{}</dd>\
         <dt>Machine</dt><dd>{}</dd><dt>Program</dt><dd>tilescope {}{}</dd></dl>\n",
        one.experiment,
        escape(one.experiment.title()),
        escape(&one.command()),
        one.seed,
        escape(&one.machine.line()),
        escape(&one.version),
        if one.quick {
            ", quick: small sets, few of them"
        } else {
            ""
        }
    );
    for claim in &one.claims {
        let _ = writeln!(
            out,
            "<p><strong>{}</strong> ({}). The paper: {}. Here: {}. {}. {}</p>",
            escape(&claim.claim),
            escape(&claim.place),
            escape(&claim.paper),
            escape(&claim.ours),
            verdict(one, claim),
            escape(&claim.reason)
        );
    }
    for note in &one.notes {
        let _ = writeln!(out, "<p>{}</p>", escape(note));
    }
    for each in one.tables.iter().filter(|each| each.shown) {
        table(out, each);
    }
    for (name, caption) in &one.pictures {
        let path = figures.join(format!("{}-{name}.svg", one.experiment));
        picture(out, &path, caption);
    }
}

/// A picture stands in the page itself, as an image of its own: names within it meet nobody else's.
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
    let mut out = String::with_capacity(text.len() + text.len() / 8);
    for letter in text.chars() {
        match letter {
            '%' => out.push_str("%25"),
            '#' => out.push_str("%23"),
            '"' => out.push_str("%22"),
            '<' => out.push_str("%3C"),
            '>' => out.push_str("%3E"),
            '&' => out.push_str("%26"),
            '\n' | '\r' | '\t' => out.push(' '),
            _ => out.push(letter),
        }
    }
    out
}

fn table(out: &mut String, table: &Table) {
    let _ = write!(
        out,
        "<h3>{}</h3>\n<div class=\"wide\"><table>\n<thead><tr>",
        escape(&table.title)
    );
    for column in &table.columns {
        let _ = write!(out, "<th class=\"n\">{}</th>", escape(&column.head));
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    for row in &table.rows {
        out.push_str("<tr>");
        for (cell, column) in row.iter().zip(&table.columns) {
            let text = escape(&readable(cell, column.digits));
            let _ = write!(out, "<td class=\"n\">{text}</td>");
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody></table></div>\n");
}
