//! The report of a folder: every experiment that was finished there, whenever that was.
//! It reads what was kept and computes nothing.

mod html;
mod markdown;

use std::fs;
use std::path::Path;

use tilescope_formats::write_whole;

use crate::error::ReproduceError;
use crate::experiment::Experiment;
use crate::finished::Finished;
use crate::outcome::Claim;

/// What every report begins with.
const INTRODUCTION: &str = "Sets by KDRT and by the reference sampler were made by the commands below, on the machines named there, and \
judged by an independent verifier before anything was concluded from them; sets that are no maximal Poisson-disk sets by design (random, \
jittered, controls, files) are measured as they are. A verdict follows from the numbers by the rule beside it. \"Not comparable\" \
means that the numbers decide nothing. Rates are the machine's; the paper's are of an Intel Core i7-4930K and an NVIDIA GTX 1080.";

/// What a report is made of.
struct Pages {
    finished: Vec<Finished>,
    /// What was kept and cannot be read, a sentence each.
    broken: Vec<String>,
}

impl Pages {
    /// Returns claims of the paper, or those beyond it, with their experiments.
    fn claims(&self, of_the_paper: bool) -> Vec<(&Finished, &Claim)> {
        let each = self.finished.iter();
        let each = each.flat_map(|one| one.claims.iter().map(move |claim| (one, claim)));
        each.filter(|(_, claim)| claim.is_of_the_paper() == of_the_paper)
            .collect()
    }
}

/// Writes `REPORT.md` and `report.html` of a folder.
pub fn write(out: &Path) -> Result<(), ReproduceError> {
    let mut pages = Pages {
        finished: Vec::new(),
        broken: Vec::new(),
    };
    for experiment in Experiment::ALL {
        match read(out, experiment) {
            Some(Ok(finished)) => pages.finished.push(finished),
            Some(Err(error)) => pages.broken.push(error),
            None => {}
        }
    }
    write_whole(&out.join("REPORT.md"), markdown::page(&pages).as_bytes())?;
    let figures = out.join("figures");
    write_whole(
        &out.join("report.html"),
        html::page(&pages, &figures).as_bytes(),
    )?;
    Ok(())
}

/// Returns what was kept of an experiment, if anything was.
fn read(out: &Path, experiment: Experiment) -> Option<Result<Finished, String>> {
    let path = out.join("data").join(format!("{experiment}.json"));
    let bytes = fs::read(path).ok()?;
    let found = serde_json::from_slice(&bytes);
    Some(found.map_err(|error| {
        format!("What was kept of {experiment} cannot be read ({error}); tilescope reproduce {experiment} makes it anew.")
    }))
}

#[cfg(test)]
mod tests;
