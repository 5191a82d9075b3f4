//! The report as Markdown.

use std::fmt::Write;

use super::{Block, Span, TITLE};

/// Returns the report; pictures are read from `figures` beside it.
pub fn page(blocks: &[Block]) -> String {
    let mut out = format!("# {TITLE}\n");
    for block in blocks {
        // Writing to a String cannot fail.
        let _ = match block {
            // Claims link to the section by this id.
            Block::Section(one) => write!(out, "\n<a id=\"{one}\"></a>\n\n## {}\n", one.title()),
            Block::Text(spans) => {
                let text: String = spans.iter().map(span_text).collect();
                write!(out, "\n{text}\n")
            }
            Block::Facts(facts) => {
                let fact = |(name, value): &(&str, Span)| format!("{name}: {}", span_text(value));
                let lines: Vec<String> = facts.iter().map(fact).collect();
                // Two spaces at the end of a line break it in Markdown.
                write!(out, "\n{}\n", lines.join("  \n"))
            }
            Block::Table {
                title,
                numbers,
                heads,
                rows,
            } => {
                // A table of claims is a section of its own; one of numbers stands in an experiment's section.
                let heading = if *numbers {
                    title
                } else {
                    &format!("## {title}")
                };

                let head_cells: Vec<String> = heads.iter().map(|head| cell(head)).collect();
                let rule = "---|".repeat(heads.len());
                let row = |spans: &Vec<Span>| {
                    let cells: Vec<String> =
                        spans.iter().map(|one| cell(&span_text(one))).collect();
                    format!("| {} |\n", cells.join(" | "))
                };

                let body: String = rows.iter().map(row).collect();
                write!(
                    out,
                    "\n{heading}\n\n| {} |\n|{rule}\n{body}",
                    head_cells.join(" | ")
                )
            }
            Block::Picture(file, caption) => {
                write!(out, "\n![{file}](figures/{file}.png)\n\n{caption}\n")
            }
        };
    }
    out
}

fn span_text(span: &Span) -> String {
    match span {
        Span::Plain(text) => text.clone(),
        Span::Strong(text) | Span::Verdict(_, text) => format!("**{text}**"),
        Span::Code(text) => format!("`{text}`"),
        Span::Link(experiment, text) => format!("[{text}](#{experiment})"),
    }
}

/// Text in a cell has neither bars nor line ends.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}
