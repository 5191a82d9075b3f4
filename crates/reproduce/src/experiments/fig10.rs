//! Figure 10 and section 4.1.3: zone plates and a horizon from the samples of each sampler, against exact images; samples and
//! spectra beside them. Samplers are ranked by error.

mod claims;
mod curves;
mod filter;
mod horizon;
mod looks;
mod pictures;
mod plate;
mod results;
mod samplers;
mod tables;

use serde_json::json;

use crate::error::Result;
use crate::outcome::Outcome;
use crate::study::{Settings, Study};
use crate::texts::text;

use self::results::SamplerResults;
use self::samplers::Sampler;

pub fn units(settings: &Settings) -> usize {
    let units_beside_horizons =
        |sampler: Sampler| 1 + sampler.sets(plate::amounts(settings).2) as usize;
    let horizons = horizon::per_pixel(settings).len();
    Sampler::ALL
        .into_iter()
        .map(|sampler| units_beside_horizons(sampler) + horizons)
        .sum()
}

/// Carries out the experiment for each sampler, and draws one set of each.
pub fn run(study: &Study<'_>) -> Result<Outcome> {
    let settings = study.settings;
    let each = Sampler::ALL.into_iter();
    let results: Vec<SamplerResults> = each
        .map(|one| results_of(one, study))
        .collect::<Result<_>>()?;

    // The sets behind the results are not kept: those of the pictures are made anew.
    let control = study.control("the pictures");
    let corner = |sampler| looks::corner(sampler, settings, &control);
    let corners: Vec<_> = Sampler::ALL
        .into_iter()
        .map(corner)
        .collect::<Result<_>>()?;

    let values = json!({
        "reach": filter::REACH, "sigma": filter::SIGMA, "cut_off": filter::CUT_OFF,
        "left_out": horizon::LEFT_OUT, "leaf": samplers::LEAF,
    });

    Ok(Outcome {
        claims: claims::claims(&results),
        pictures: pictures::pictures(&results, &corners, settings)?,
        tables: tables::tables(&results),
        notes: ["plates", "horizons", "sets"]
            .map(|one| text(&format!("fig10/{one}"), &values))
            .into(),
    })
}

/// Carries out everything for one sampler.
fn results_of(sampler: Sampler, study: &Study<'_>) -> Result<SamplerResults> {
    let settings = study.settings;
    let (name, key) = (sampler.name(), sampler.key());
    let what = format!("spectrum, {name}");

    // The spectrum, each plate and each horizon are units: an interrupted run loses one of them at most.
    let spectrum = study.unit(&format!("look-{key}"), &what, |control| {
        let (count, sets) = looks::amounts(settings);
        looks::spectrum(sampler, count, sets, settings, control)
    })?;

    let (zone_plate, count, sets) = plate::amounts(settings);
    let plate = |index| {
        let what = format!("zone plate, {name}, set {}", index + 1);
        study.unit(&format!("plate-{key}-{index}"), &what, |control| {
            plate::errors(sampler, count, index, zone_plate, settings, control)
        })
    };

    let horizon = |per_pixel: &usize| {
        let what = format!("horizon, {name}, {per_pixel} samples per pixel");
        study.unit(&format!("horizon-{key}-{per_pixel}"), &what, |control| {
            let (board, sets) = horizon::amounts(settings);
            horizon::errors(sampler, *per_pixel, board, sets, settings, control)
        })
    };

    let per_pixel = horizon::per_pixel(settings).iter();
    Ok(SamplerResults {
        sampler,
        spectrum,
        // A sampler without chance has a single set.
        plates: (0..sampler.sets(sets)).map(plate).collect::<Result<_>>()?,
        horizons: per_pixel.map(horizon).collect::<Result<_>>()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Experiment;
    use crate::outcome::Verdict;
    use crate::study::tests::quick_run;

    /// Tables are whole, and pictures small enough to be sent.
    #[test]
    fn a_quick_run_has_the_units_it_said_and_fills_all_tables() {
        let outcome = quick_run(Experiment::Fig10, &Settings::default());
        assert_eq!((outcome.claims.len(), outcome.pictures.len()), (6, 5));
        for claim in [3, 5] {
            assert_eq!(outcome.claims[claim].verdict, Verdict::NotComparable);
        }
        assert!(outcome.tables.iter().all(|table| table.rows.len() > 4));
        for picture in &outcome.pictures {
            let svg = tilescope_figures::to_svg(&picture.scene).unwrap();
            assert!(svg.len() < 2_000_000, "{}: {}", picture.name, svg.len());
        }
    }

    #[test]
    fn a_whole_run_is_more_work_than_a_quick_one() {
        let [quick, whole] = [true, false].map(|quick| Settings {
            quick,
            ..Settings::default()
        });
        assert!(plate::amounts(&whole).1 > 3 * plate::amounts(&quick).1);
        assert!(horizon::per_pixel(&whole).len() > horizon::per_pixel(&quick).len());
        assert!(units(&whole) > units(&quick));
    }
}
