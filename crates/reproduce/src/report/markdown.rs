//! The report as Markdown.

use std::fmt::Write;

use crate::finished::Finished;
use crate::numbers::readable;
use crate::outcome::{Claim, Table};

use super::{INTRODUCTION, Pages};

/// Returns the page.
pub fn page(pages: &Pages) -> String {
    let mut out = "# Reproduction of Wang & Suda 2017, \"Fast Maximal Poisson-Disk Sampling by Randomized Tiling\"\n\n".to_owned();
    let _ = write!(out, "{INTRODUCTION}\n\n");
    for line in &pages.broken {
        let _ = write!(out, "**{line}**\n\n");
    }
    claims(&mut out, "What the paper says", &pages.claims(true));
    claims(&mut out, "Beyond the paper", &pages.claims(false));
    for one in &pages.finished {
        experiment(&mut out, one);
    }
    out
}

fn claims(out: &mut String, title: &str, claims: &[(&Finished, &Claim)]) {
    if claims.is_empty() {
        return;
    }
    let _ = write!(
        out,
        "## {title}\n\n| claim | place | the paper | here | verdict |\n|---|---|---|---|---|\n"
    );
    for (one, claim) in claims {
        let linked = format!("[{}](#{})", claim.claim, one.experiment);
        let verdict = one.words(claim);
        let cells = [&linked, &claim.place, &claim.paper, &claim.ours, &verdict];
        let _ = writeln!(out, "| {} |", cells.map(cell).join(" | "));
    }
    out.push('\n');
}

fn experiment(out: &mut String, one: &Finished) {
    let _ = write!(
        out,
        "\n<a id=\"{}\"></a>\n\n## {}\n\nCommand: `{}`  \nSeed: {}  \nMachine: {}  \nProgram: tilescope {}{}\n",
        one.experiment,
        one.experiment.title(),
        one.command(),
        one.seed,
        one.machine.line(),
        one.version,
        if one.quick {
            "  \nQuick: small sets, few of them"
        } else {
            ""
        }
    );
    for claim in &one.claims {
        let _ = write!(
            out,
            "\n**{}** ({}). The paper: {}. Here: {}. Verdict: **{}**. {}\n",
            claim.claim,
            claim.place,
            claim.paper,
            claim.ours,
            one.words(claim),
            claim.reason
        );
    }
    for note in &one.notes {
        let _ = write!(out, "\n{note}\n");
    }
    for each in one.tables.iter().filter(|each| each.shown) {
        table(out, each);
    }
    for (name, caption) in &one.pictures {
        let of = one.experiment;
        let _ = write!(out, "\n![{name}](figures/{of}-{name}.png)\n\n{caption}\n");
    }
}

fn table(out: &mut String, table: &Table) {
    let heads: Vec<String> = table.columns.iter().map(|c| cell(&c.head)).collect();
    let rule = "---|".repeat(heads.len());
    let _ = write!(
        out,
        "\n{}\n\n| {} |\n|{rule}\n",
        table.title,
        heads.join(" | ")
    );
    for row in &table.rows {
        let cells = row.iter().zip(&table.columns);
        let cells: Vec<String> = cells
            .map(|(c, column)| cell(readable(c, column.digits)))
            .collect();
        let _ = writeln!(out, "| {} |", cells.join(" | "));
    }
}

/// Text in a cell has neither bars nor line ends.
fn cell(text: impl AsRef<str>) -> String {
    text.as_ref().replace('|', "\\|").replace('\n', " ")
}
