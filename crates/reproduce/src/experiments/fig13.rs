//! Figure 13 and sections 4.1.1 to 4.1.3: radii and leaf sizes against the reference sampler, by their samples,
//! periodograms, radial means and anisotropies; and the rates of every engine. Only sets of one radius are compared.

mod against;
mod claims;
mod method;
mod rates;
mod shown;
mod spectra;

use serde_json::json;

use crate::error::Result;
use crate::machine::no_gpu;
use crate::numbers::number;
use crate::outcome::{Outcome, Picture};
use crate::sets::Set;
use crate::study::{Settings, Study};

use super::timing::{LEAVES, TimingPlan};
use crate::rates::{self as engine_rates, ONE_LEAF, distinct, median};
use crate::texts::text;
use method::{Method, PATTERN, SetGroup};
use rates::RateRound;
use spectra::MethodSpectra;

/// The paper's radii, of the unit square, and sets of each.
fn groups_of(settings: &Settings) -> Vec<SetGroup> {
    let radii: &[f64] = settings.pick(&[0.01, 0.005, 0.0025], &[0.01, 0.005]);
    let (sets, seed) = (settings.pick(10, 3), settings.seed);
    let group = |&radius| SetGroup { radius, sets, seed };
    radii.iter().map(group).collect()
}

/// Returns the methods that are measured for a radius. The control, copies side by side, is measured for the last and
/// smallest radius alone (`is_last_radius`), since what it shows does not depend on the radius.
fn methods_of(is_last_radius: bool) -> Vec<Method> {
    // Two groups of reference sets, which differ by chance alone: how much they differ is the measure of chance.
    let mut methods = vec![Method::Reference, Method::Again];
    for leaf in LEAVES {
        methods.push(Method::kdrt(leaf));
        // For large leaves the pattern of usual size is measured, too. It is periodic, so that runs succeed, but it is
        // smaller than the largest blocks, which then contain parts of it twice.
        let with_usual_pattern = Method::Kdrt {
            leaf,
            side: PATTERN,
        };
        if !with_usual_pattern.fits() {
            methods.push(with_usual_pattern);
        }
    }

    // Exact tiling is measured with the smallest leaf, with which it has the most seams.
    methods.push(Method::Exact { leaf: LEAVES[0] });
    // Sets of one pattern show how much more regular sets are that have parts in common.
    methods.push(Method::OnePattern { leaf: ONE_LEAF });
    if is_last_radius {
        methods.push(Method::Copies);
    }
    methods
}

/// Returns each radius with each method that is measured for it.
fn spectra_units(settings: &Settings) -> Vec<(SetGroup, Method)> {
    let groups = groups_of(settings);
    let numbered = (1..).zip(&groups);
    let with_methods = |(number, group): (usize, &SetGroup)| {
        let is_last_radius = number == groups.len();
        let group = *group;
        let methods = methods_of(is_last_radius).into_iter();
        methods.map(move |method| (group, method))
    };
    numbered.flat_map(with_methods).collect()
}

/// Returns how the engines are timed: how many samples a set has, and in how many rounds each of them makes one.
fn plan_of(settings: &Settings) -> TimingPlan {
    let (samples, rounds) = settings.pick((2_000_000, 10), (50_000, 2));
    TimingPlan { samples, rounds }
}

/// Returns in how many units of work [`run`] measures.
pub fn units(settings: &Settings) -> usize {
    spectra_units(settings).len() + plan_of(settings).rounds as usize
}

/// Measures the spectra of all methods, times all engines, and compares the methods with the reference sampler.
pub fn run(study: &Study<'_>) -> Result<Outcome> {
    let mut found: Vec<MethodSpectra> = Vec::new();
    for (group, method) in spectra_units(study.settings) {
        let SetGroup { radius, sets, .. } = group;
        // The prefix sets these units apart from those of other measures in the same folder.
        let key = format!("groups-{radius}-{}", method.key());
        let what = format!("{sets} sets of radius {radius}, {}", method.name());
        found.push(study.unit(&key, &what, |control| {
            spectra::measure(&group, method, control)
        })?);
    }

    let plan = plan_of(study.settings);
    let rounds = rates::run(plan, study)?;
    let timed: Vec<_> = rounds.iter().map(|round| round.timed.as_slice()).collect();
    // Without a named baseline the first engine of a round is the baseline, which is the reference sampler.
    let baseline = None;
    let rows = engine_rates::rows(&timed, baseline);
    let against = against::against(&found);

    let mut pictures = spectra_pictures(study, &found)?;
    pictures.push(shown::rates(&rows, plan)?);

    Ok(Outcome {
        claims: claims::claims(&against, &rows),
        pictures,
        tables: vec![
            shown::quality(&found, &against),
            shown::rate_table(&rows),
            shown::curves(&found),
        ],
        notes: notes(&found, &rounds),
    })
}

/// Returns the pictures of spectra: one for each radius, and one of the tilings whose regularity shows. Each column
/// shows the first set of its method, which is made anew, as sets are not kept.
fn spectra_pictures(study: &Study<'_>, found: &[MethodSpectra]) -> Result<Vec<Picture>> {
    let control = study.control("the pictures");
    // Each column shows a method, whose curves are drawn over those of another one. It is left out if one of the two
    // was not measured.
    let picture = |group: SetGroup, name: &str, title: &str, methods: Vec<(Method, Method)>| {
        let spectra_of = |method: Method| spectra::find(found, group.radius, method);
        let spectra_of_column = |(one, below)| Some((spectra_of(one)?, spectra_of(below)?));
        let columns: Vec<_> = methods.into_iter().filter_map(spectra_of_column).collect();
        let first = 0;
        let set = |(one, _): &(&MethodSpectra, _)| group.set(one.method, first, &control);
        let sets: Vec<Set> = columns.iter().map(set).collect::<Result<_>>()?;
        shown::spectra(name, title, &columns, &sets)
    };

    let groups = groups_of(study.settings);
    let each = groups.iter().map(|group| {
        picture(
            *group,
            "spectra",
            "Reference and KDRT",
            shown::columns(&LEAVES),
        )
    });
    let mut pictures: Vec<Picture> = each.collect::<Result<_>>()?;

    // This picture needs the copies side by side, which were measured with the last radius alone.
    if let Some(group) = groups.last() {
        let title = "Where regularity shows";
        pictures.push(picture(*group, "regular", title, shown::regular())?);
    }
    Ok(pictures)
}

/// Returns the notes: how sets were made and measured, which results are no evidence, how long patterns take to be
/// made, and why no GPU was measured, if none was.
fn notes(found: &[MethodSpectra], rounds: &[RateRound]) -> Vec<String> {
    let mut notes = vec![text("fig13/how", &json!({}))];

    // Methods whose blocks are as large as the domain tiled nothing, so that no verdict rests on them.
    let is_whole =
        |one: &&MethodSpectra| one.method.leaf().is_some() && !one.method.tiles(one.radius);
    let whole: Vec<String> = (found.iter().filter(is_whole))
        .map(|one| format!("{} at radius {}", one.method.name(), one.radius))
        .collect();

    if !whole.is_empty() {
        notes.push(text("fig13/whole", &json!({ "methods": whole.join(", ") })));
    }

    // Sets that share one pattern have parts of it in common, so that their mean has fewer independent samples than it
    // seems to have, and no verdict rests on them. There are some at each radius, so that the list is never empty.
    let shared = (found.iter())
        .filter(|one| matches!(one.method, Method::OnePattern { .. }))
        .map(|one| format!("{} dB at radius {}", number(one.excess, 2), one.radius));
    let excess = shared.collect::<Vec<_>>().join(", ");
    notes.push(text(
        "fig13/shared",
        &json!({ "leaf": ONE_LEAF, "excess": excess }),
    ));

    // The median time of making a pattern of each side, in milliseconds.
    let all_patterns = || rounds.iter().flat_map(|round| &round.patterns);
    let pattern = |side: f64| {
        let seconds = all_patterns().filter(|(of, _)| of.to_bits() == side.to_bits());
        let milliseconds = median(seconds.map(|(_, seconds)| 1e3 * seconds));
        // Sides are those of patterns that were made, so that each has a time.
        format!(
            "that of {side} r takes {} ms",
            number(milliseconds.unwrap_or(f64::NAN), 3)
        )
    };

    let sides = distinct(all_patterns().map(|(side, _)| *side)).into_iter();
    let patterns = sides.map(pattern).collect::<Vec<_>>().join(", ");
    notes.push(text("fig13/rates", &json!({ "patterns": patterns })));
    notes.extend(no_gpu().map(|why| text("fig13/no-gpu", &json!({ "why": why }))));
    notes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Experiment;
    use crate::outcome::Verdict;
    use crate::study::tests::quick_run;

    #[test]
    fn a_quick_run_has_the_units_it_said_and_fills_figures_and_tables() {
        let outcome = quick_run(Experiment::Fig13, &Settings::default());
        assert_eq!(outcome.claims.len(), 7);
        // Copies side by side are what the regularity of the others is held against; leaves of 80 r make few blocks.
        for claim in &outcome.claims[3..] {
            assert!(claim.ours.contains("copies side by side"));
            assert_eq!(claim.verdict, Verdict::NotComparable, "{}", claim.claim);
        }
        assert_eq!(outcome.claims[2].verdict, Verdict::Reproduced);
        assert_eq!(outcome.pictures.len(), 4);
        assert_eq!(outcome.tables[0].rows.len(), 17);
    }
}
