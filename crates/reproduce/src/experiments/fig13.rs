//! Figure 13 and sections 4.1.1 to 4.1.3: radii and leaf sizes against the reference sampler, by their samples,
//! periodograms, radial means and anisotropies; and the rates of every engine. Only sets of one radius are compared.

mod against;
mod claims;
mod method;
mod peaks;
mod picture;
mod rates;
mod spectra;
mod speed;
mod tables;

use crate::error::ReproduceError;
use crate::machine::no_gpu;
use crate::numbers::number;
use crate::outcome::{Outcome, Picture};
use crate::study::{Settings, Study};

use super::timing::{LEAVES, TimingPlan};
use crate::rates::{self as engine_rates, ONE_LEAF, median};
use method::{Method, PATTERN, SetGroup};
use rates::RateRound;
use spectra::MethodSpectra;

/// The paper's radii, of the unit square, and sets of each.
fn groups(settings: &Settings) -> Vec<SetGroup> {
    let radii = settings.pick(vec![0.01, 0.005, 0.0025], vec![0.01, 0.005]);
    let sets = settings.pick(10, 3);
    let group = |radius| SetGroup::of(settings, radius, sets);
    radii.into_iter().map(group).collect()
}

/// The control stands with the smallest radius alone: what it shows does not depend on it.
fn methods(last: bool) -> Vec<Method> {
    let mut methods = vec![Method::Reference, Method::Again];
    for leaf in LEAVES {
        let default = Method::Kdrt {
            leaf,
            side: PATTERN,
        };
        methods.push(Method::kdrt(leaf));
        if !default.fits() {
            methods.push(default);
        }
    }
    methods.push(Method::OnePattern { leaf: ONE_LEAF });
    if last {
        methods.push(Method::Copies);
    }
    methods
}

fn spectra_units(settings: &Settings) -> Vec<(SetGroup, Method)> {
    let groups = groups(settings);
    let last = groups.len() - 1;
    let each = groups.iter().enumerate();
    each.flat_map(|(index, group)| methods(index == last).into_iter().map(|one| (*group, one)))
        .collect()
}

fn plan(settings: &Settings) -> TimingPlan {
    TimingPlan {
        samples: settings.pick(2_000_000, 200_000),
        rounds: settings.pick(10, 2),
    }
}

pub fn units(settings: &Settings) -> usize {
    spectra_units(settings).len() + plan(settings).rounds as usize
}

pub fn run(study: &Study<'_>) -> Result<Outcome, ReproduceError> {
    let units = spectra_units(study.settings).into_iter();
    let found: Result<Vec<MethodSpectra>, _> = units
        .map(|(group, method)| unit(study, &group, method))
        .collect();
    let found = found?;
    let plan = plan(study.settings);
    let rounds = rates::run(plan, study)?;
    let timed: Vec<_> = rounds.iter().map(|round| round.timed.as_slice()).collect();
    let rows = engine_rates::rows(&timed, None);
    let against = against::against(&found);
    let mut pictures = spectra_pictures(study, &found)?;
    pictures.push(picture::rates(&rows, plan.samples, plan.rounds)?);
    Ok(Outcome {
        claims: claims::claims(&against, &rows),
        pictures,
        tables: vec![
            tables::quality(&found, &against),
            tables::rates(&rows, rounds.len()),
            tables::curves(&found),
        ],
        notes: notes(&found, &rounds),
    })
}

fn unit(
    study: &Study<'_>,
    group: &SetGroup,
    method: Method,
) -> Result<MethodSpectra, ReproduceError> {
    // A name that no file of other measures has.
    let key = format!("groups-{}-{}", group.radius, method.key());
    let what = format!(
        "{} sets of radius {}, {}",
        group.sets,
        group.radius,
        method.name()
    );
    study.unit(&key, &what, |control| {
        spectra::measure(group, method, control)
    })
}

/// The figures show one set of each method, made anew.
fn spectra_pictures(
    study: &Study<'_>,
    found: &[MethodSpectra],
) -> Result<Vec<Picture>, ReproduceError> {
    let control = study.control("the pictures");
    let picture = |group: SetGroup, names, columns: Vec<(Method, Method)>| {
        let of = |method: Method| {
            let same = |one: &&MethodSpectra| one.radius.to_bits() == group.radius.to_bits();
            found.iter().filter(same).find(|one| one.method == method)
        };
        let columns = columns.into_iter();
        let columns: Vec<(&MethodSpectra, &MethodSpectra)> = columns
            .filter_map(|(one, below)| Some((of(one)?, of(below)?)))
            .collect();
        let sets: Result<Vec<_>, _> = (columns.iter())
            .map(|(one, _)| group.set(one.method, 0, &control))
            .collect();
        picture::spectra(names, &columns, &sets?)
    };
    let groups = groups(study.settings);
    let each = groups.iter().map(|group| {
        let names = ("spectra", "Reference and KDRT");
        picture(*group, names, picture::columns(&LEAVES))
    });
    let mut pictures: Vec<Picture> = each.collect::<Result<_, _>>()?;
    if let Some(group) = groups.last() {
        let names = ("regular", "Where regularity shows");
        pictures.push(picture(*group, names, picture::regular())?);
    }
    Ok(pictures)
}

fn notes(found: &[MethodSpectra], rounds: &[RateRound]) -> Vec<String> {
    let mut notes = vec![HOW.to_owned()];
    let whole: Vec<String> = (found.iter())
        .filter(|one| one.method.leaf().is_some() && !one.method.tiles(one.radius))
        .map(|one| format!("{} at radius {}", one.method.name(), one.radius))
        .collect();
    if !whole.is_empty() {
        notes.push(format!(
            "A block is split only where both halves can be as long as the leaf. Here the domain is a single block, a part of the pattern or \
             all of it: nothing was tiled, and no verdict on tiles rests on it: {}.",
            whole.join(", ")
        ));
    }
    let shared: Vec<String> = (found.iter())
        .filter_map(|one| match one.method {
            Method::OnePattern { .. } => Some(format!(
                "{} dB at radius {}",
                number(one.excess, 2),
                one.radius
            )),
            _ => None,
        })
        .collect();
    notes.push(format!(
        "Sets with one pattern in common repeat each other as well as themselves: with a leaf of {ONE_LEAF} r their anisotropy is {} above that of noise. \
         The table has them beside sets of the same leaf whose patterns differ.",
        shared.join(", ")
    ));
    let sides = rounds.iter().take(1).flat_map(|round| &round.patterns);
    let pattern = |(side, _): &(f64, f64)| {
        let all = rounds.iter().flat_map(|round| &round.patterns);
        let seconds = all.filter(|(of, _)| of.to_bits() == side.to_bits());
        let median = median(seconds.map(|(_, seconds)| 1e3 * seconds));
        let median = median.unwrap_or(f64::NAN);
        format!("that of {side} r takes {} ms", number(median, 3))
    };
    let patterns: Vec<String> = sides.map(pattern).collect();
    notes.push(format!(
        "Rates are those of making a set in memory, on the lattice and in canonical order. In each round every engine makes one set with one seed; \
         those of KDRT must be the same points, of which one copy is verified. Making a pattern, once, is not in the rates: {}. On all \
         threads the reference sampler makes nine sets, which are combined.",
        patterns.join(", ")
    ));
    notes.extend(no_gpu().map(|why| format!("No rate of a GPU: {why}.")));
    notes
}

const HOW: &str = "Periodic unit square. The paper's patterns are larger than the largest block (section 3.1.2), and blocks may be twice as long as the \
leaf: leaves of 20 and 40 r have the default pattern of 100 r, those of 80 r one of 200 r. A leaf of 80 r with the default pattern is looked at, too: \
that pattern is periodic, so that a run succeeds, but its blocks contain parts of it twice. Every set has its own seed and its own pattern, but where one pattern for all is \
said; every set is verified. The control is a small reference set side by side with itself, a valid set with the regularity that tilings are feared for: it \
shows that the measures find it. Frequencies are nu = |k| / sqrt(N), so that radii are on one scale.";

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
        assert_eq!(outcome.tables[0].rows.len(), 15);
    }
}
