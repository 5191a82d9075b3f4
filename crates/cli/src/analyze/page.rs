//! The report as one HTML file without external resources: tables, figures and the command that made it.

use std::ffi::OsString;
use std::fmt::Write;

use tilescope_analysis::lossy;
use tilescope_figures::{Font, escape, font_faces};

use super::gather::Analysis;
use super::table::{self, Column, Table};

const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;color:#1a1d21;margin:2rem auto;max-width:1240px;padding:0 1rem}\
table{border-collapse:collapse;font-variant-numeric:tabular-nums;margin:1rem 0}\
th,td{padding:.2rem .8rem;border-bottom:1px solid #d5dae0;text-align:right}\
th:first-child,td:first-child,.units td:nth-child(2),.units th:nth-child(2){text-align:left}\
td{white-space:nowrap}thead th{border-bottom:2px solid #5b6470}svg{max-width:100%;height:auto}\
pre{background:#f6f7f9;padding:.8rem;overflow-x:auto}.wide{overflow-x:auto}";

/// Returns a page with the tables, the figures and the command that made it.
pub fn html(analysis: &Analysis, figures: &[String]) -> String {
    let mut out = opening();
    let measures = table::measures(&analysis.subjects);
    page_table(&mut out, &measures);
    if let Some(reference) = analysis.reference() {
        out.push_str("<h2>Differences</h2>\n");
        let table = table::differences(
            &reference.label,
            analysis.compared().iter().map(|one| one.label.as_str()),
            &analysis.differences,
        );
        page_table(&mut out, &table);
    }

    curves(&mut out, figures);
    out.push_str(NOTES);
    files(&mut out, analysis);
    list(&mut out, "Notes", analysis.notes.iter());
    let reasons = analysis.failures.iter().map(|failure| &failure.reason);
    list(&mut out, "Not analysed", reasons);

    close(&mut out);
    out
}

/// Returns the beginning of a page, up to its heading.
pub fn opening() -> String {
    let title = "Analysis of point sets";
    let fonts = font_faces(&[Font::Regular, Font::SemiBold]);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n\
         <style>{STYLE}{fonts}</style>\n</head>\n<body>\n<h1>{title}</h1>\n"
    )
}

/// Appends the figures, which are SVG.
pub fn curves(out: &mut String, figures: &[String]) {
    out.push_str("<h2>Curves</h2>\n");
    // Figures on one page share its ids, and each numbers its own from the start.
    for (index, svg) in figures.iter().enumerate() {
        let svg = with_own_ids(svg, index);
        let _ = writeln!(out, "<div class=\"wide\">\n{svg}</div>");
    }
}

/// Appends the command that made a page, and the page's end.
pub fn close(out: &mut String) {
    // The first word is the path of the program on this machine, which the page has no use for.
    let _ = write!(
        out,
        "<h2>Command</h2>\n<pre>{}</pre>\n<p>tilescope {}</p>\n</body>\n</html>\n",
        escape(&command_line(std::env::args_os().skip(1))),
        env!("CARGO_PKG_VERSION")
    );
}

/// Renames the ids of a figure, which are those of clip paths and of layers, so that the ids of several figures on one
/// page differ.
pub(crate) fn with_own_ids(svg: &str, index: usize) -> String {
    svg.replace("id=\"clip-", &format!("id=\"f{index}-clip-"))
        .replace("url(#clip-", &format!("url(#f{index}-clip-"))
        .replace("id=\"layer-", &format!("id=\"f{index}-layer-"))
}

/// Writes the files behind averages with their numbers, and those whose label is not their name.
fn files(out: &mut String, analysis: &Analysis) {
    for subject in analysis.subjects.iter().filter(|subject| subject.average) {
        let _ = writeln!(out, "<h2>{}</h2>", escape(&capital(&subject.label)));
        page_table(out, &table::files(&subject.members));
    }
    let sets = analysis.subjects.iter().filter(|subject| !subject.average);
    let names = sets.map(|subject| (&subject.label, &subject.members[0].name));
    let renamed = names.filter(|(label, name)| label != name);
    let lines: Vec<String> = renamed
        .map(|(label, name)| format!("{label}: {name}"))
        .collect();
    list(out, "Files", lines.iter());
}

/// Appends lines under a heading; nothing without lines.
pub fn list<'a>(out: &mut String, heading: &str, lines: impl Iterator<Item = &'a String>) {
    let mut lines = lines.peekable();
    if lines.peek().is_none() {
        return;
    }
    let _ = writeln!(out, "<h2>{heading}</h2>\n<ul>");
    for line in lines {
        let _ = writeln!(out, "<li>{}</li>", escape(line));
    }
    out.push_str("</ul>\n");
}

fn capital(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().map(|letter| letter.to_ascii_uppercase());
    first.into_iter().chain(characters).collect()
}

const NOTES: &str = "<p>Frequencies are given as nu = |k| / sqrt(N), distances over r_max, the smallest distance in \
the hexagonal lattice of as many samples. Shaded bands hold the true mean with probability 0.95: those of power follow from the \
number of frequencies and sets and hold where powers are independent; for bounded sets, which are tapered, and for \
pair correlations they follow from the spread between sets and need several sets. Bands about zero hold the \
difference of equal curves with probability 0.95. Periodograms are white where there is no power, and black from \
three times the power of white noise on. The zero frequency is left out; if it has a cell of its own, a ring marks it.</p>\n";

/// Appends a table in HTML.
pub fn page_table(out: &mut String, table: &Table) {
    // Tables of files have no units, and an empty column of units is left out.
    let has_units = table.rows.iter().any(|(_, unit)| !unit.is_empty());
    let class = if has_units { " class=\"units\"" } else { "" };
    let _ = write!(out, "<div class=\"wide\"><table{class}>\n<thead>");

    // The heading is a line as any other, with the tag of headings.
    let line = |tag: &str, label: &str, unit: &str, cell: &dyn Fn(&Column) -> String| {
        let unit = has_units.then(|| unit.to_owned());
        let cells = table.columns.iter().map(|column| escape(&cell(column)));
        let all: Vec<String> = (std::iter::once(escape(label)).chain(unit))
            .chain(cells)
            .collect();
        let inner = all.join(&format!("</{tag}><{tag}>"));
        format!("<tr><{tag}>{inner}</{tag}></tr>")
    };

    *out += &line("th", &table.head, "unit", &|column| column.name.clone());
    out.push_str("</thead>\n<tbody>\n");
    for (row, (label, unit)) in table.rows.iter().enumerate() {
        *out += &line("td", label, unit, &|column| column.cells[row].clone());
        out.push('\n');
    }
    out.push_str("</tbody></table></div>\n");
}

/// Returns the command as a shell takes it. An argument that is not UTF-8 cannot be repeated; `lossy` marks it.
fn command_line(arguments: impl Iterator<Item = OsString>) -> String {
    // Of these characters none means anything else to a POSIX shell: they need no quotes.
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=+,:@%".contains(c);
    let mut line = "tilescope".to_owned();
    for argument in arguments {
        let argument = lossy(&argument);
        line.push(' ');
        if !argument.is_empty() && argument.chars().all(plain) {
            line.push_str(&argument);
        } else {
            // Between single quotes a shell takes everything as it is, but for a single quote, which stands outside.
            let _ = write!(line, "'{}'", argument.replace('\'', "'\\''"));
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_break_neither_markup_nor_shell() {
        assert_eq!(escape("<b>&\""), "&lt;b&gt;&amp;&quot;");
        let words = ["analyze", "it's here.csv", ""].map(OsString::from);
        let line = command_line(words.into_iter());
        assert_eq!(line, "tilescope analyze 'it'\\''s here.csv' ''");
    }
}
