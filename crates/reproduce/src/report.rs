//! The report of a folder: every experiment that was finished there, whenever that was. It is composed once, as
//! blocks, and written as HTML and as Markdown.

mod html;
mod markdown;

use std::fs;
use std::path::Path;

use tilescope_formats::write_whole;

use crate::error::Result;
use crate::experiment::Experiment;
use crate::numbers::readable;
use crate::outcome::{Claim, Finished, Verdict};

const TITLE: &str =
    "Reproduction of Wang & Suda 2017, \"Fast Maximal Poisson-Disk Sampling by Randomized Tiling\"";

/// The first paragraph of every report.
const INTRODUCTION: &str = "Sets by KDRT, by exact tiling and by the reference sampler were made by the commands below, on the machines named there, and \
judged by an independent verifier before anything was concluded from them; sets that are by design not maximal Poisson-disk sets (random, \
jittered, controls) are measured as they are. A verdict follows from the numbers by the rule beside it. \"Not comparable\" \
means that the numbers decide nothing. Rates are the machine's; the paper's are of an Intel Core i7-4930K and an NVIDIA GTX 1080.";

/// A piece of text.
enum Span {
    Plain(String),
    Strong(String),
    Code(String),
    Verdict(Verdict, String),
    /// Leads to the section of an experiment.
    Link(Experiment, String),
}

/// A part of the report.
enum Block {
    /// The heading of an experiment's section.
    Section(Experiment),
    Text(Vec<Span>),
    Facts(Vec<(&'static str, Span)>),
    Table {
        title: String,
        /// Whether its cells are numbers.
        numbers: bool,
        heads: Vec<String>,
        rows: Vec<Vec<Span>>,
    },
    /// The name of its files, without extension, and its caption.
    Picture(String, String),
}

/// Writes `REPORT.md` and `report.html` of a folder.
pub fn write(out: &Path) -> Result<()> {
    let blocks = blocks_of(out);
    let page = html::page(&blocks, &out.join("figures"));
    write_whole(&out.join("REPORT.md"), markdown::page(&blocks).as_bytes())?;
    write_whole(&out.join("report.html"), page.as_bytes())?;
    Ok(())
}

fn plain(text: &str) -> Span {
    Span::Plain(text.to_owned())
}

/// Returns the blocks of the report on the experiments whose results are in a folder.
fn blocks_of(out: &Path) -> Vec<Block> {
    let mut blocks = vec![Block::Text(vec![plain(INTRODUCTION)])];
    let mut finished: Vec<Finished> = Vec::new();

    for experiment in Experiment::ALL {
        match read(out, experiment) {
            Some(Ok(one)) => finished.push(one),
            // A file that cannot be read leaves the other experiments in the report.
            Some(Err(error)) => blocks.push(Block::Text(vec![Span::Strong(error)])),
            None => {}
        }
    }

    let (of_the_paper, of_others) = (true, false);
    blocks.extend(claims("What the paper says", &finished, of_the_paper));
    blocks.extend(claims("Beyond the paper", &finished, of_others));
    blocks.extend(finished.iter().flat_map(section));
    blocks
}

/// Returns the kept results of an experiment, if there are any.
fn read(out: &Path, experiment: Experiment) -> Option<Result<Finished, String>> {
    let path = out.join("data").join(format!("{experiment}.json"));
    let bytes = fs::read(path).ok()?;
    let found = serde_json::from_slice(&bytes);
    Some(found.map_err(|error| {
        format!("The kept results of {experiment} cannot be read ({error}); run tilescope reproduce {experiment} again.")
    }))
}

/// Returns the table of claims of the paper, or of those beyond it, if there are any.
fn claims(title: &str, finished: &[Finished], of_the_paper: bool) -> Option<Block> {
    let row = |one: &Finished, claim: &Claim| {
        vec![
            Span::Link(one.experiment, claim.claim.clone()),
            plain(&claim.place),
            plain(&claim.paper),
            plain(&claim.ours),
            Span::Verdict(claim.verdict, one.words(claim)),
        ]
    };

    let rows: Vec<_> = (finished.iter())
        .flat_map(|one| {
            let claims =
                (one.claims.iter()).filter(|claim| claim.is_of_the_paper() == of_the_paper);
            claims.map(move |claim| row(one, claim))
        })
        .collect();

    let heads = ["claim", "place", "the paper", "here", "verdict"];
    // Without claims the report has no table, not even its title.
    (!rows.is_empty()).then(|| Block::Table {
        title: title.to_owned(),
        numbers: false,
        heads: heads.map(str::to_owned).to_vec(),
        rows,
    })
}

/// Returns the blocks of an experiment's section.
fn section(one: &Finished) -> Vec<Block> {
    let mut facts = vec![
        ("Command", Span::Code(one.command())),
        ("Seed", Span::Plain(one.seed.to_string())),
        ("Machine", Span::Plain(one.machine.line())),
        ("Program", Span::Plain(format!("tilescope {}", one.version))),
    ];

    // Small sets are weaker evidence, which the report has to say.
    if one.quick {
        facts.push(("Quick", plain("small sets, few of them")));
    }

    let mut blocks = vec![Block::Section(one.experiment), Block::Facts(facts)];
    blocks.extend(one.claims.iter().map(|claim| {
        let Claim {
            place, paper, ours, ..
        } = claim;
        Block::Text(vec![
            Span::Strong(claim.claim.clone()),
            Span::Plain(format!(
                " ({place}). The paper: {paper}. Here: {ours}. Verdict: "
            )),
            Span::Verdict(claim.verdict, one.words(claim)),
            Span::Plain(format!(". {}", claim.reason)),
        ])
    }));

    blocks.extend(one.notes.iter().map(|note| Block::Text(vec![plain(note)])));

    // Tables that are not shown, such as long curves, are in data files alone.
    for table in one.tables.iter().filter(|table| table.shown) {
        let rows = table.rows.iter().map(|row| {
            let cells = row.iter().zip(&table.columns);
            cells
                .map(|(cell, column)| Span::Plain(readable(cell, column.digits)))
                .collect()
        });

        blocks.push(Block::Table {
            title: table.title.clone(),
            numbers: true,
            heads: table.columns.iter().map(|c| c.head.clone()).collect(),
            rows: rows.collect(),
        });
    }

    blocks.extend(one.pictures.iter().map(|(name, caption)| {
        Block::Picture(format!("{}-{name}", one.experiment), caption.clone())
    }));
    blocks
}

#[cfg(test)]
mod tests;
