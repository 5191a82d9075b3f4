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
mod shades;
mod tables;

use serde_json::json;

use crate::error::ReproduceError;
use crate::outcome::Outcome;
use crate::study::{Settings, Study};
use crate::texts::text;

use self::horizon::HorizonTask;
use self::looks::SpectrumTask;
use self::plate::PlateTask;
use self::results::SamplerResults;
use self::samplers::Sampler;

/// What is done for one sampler.
struct Tasks {
    sampler: Sampler,
    spectrum: SpectrumTask,
    plate: PlateTask,
    horizons: Vec<HorizonTask>,
}

impl Tasks {
    fn all(settings: &Settings) -> [Self; 5] {
        Sampler::ALL.map(|sampler| Self {
            sampler,
            spectrum: SpectrumTask::of(sampler, settings),
            plate: PlateTask::of(sampler, settings),
            horizons: HorizonTask::of(sampler, settings),
        })
    }

    fn units(&self) -> usize {
        1 + self.plate.sets as usize + self.horizons.len()
    }

    fn carry_out(&self, study: &Study<'_>) -> Result<SamplerResults, ReproduceError> {
        let settings = study.settings;
        let (name, key) = (self.sampler.name(), self.sampler.key());
        let what = format!("spectrum, {name}");
        let spectrum = study.unit(&format!("look-{key}"), &what, |control| {
            self.spectrum.carry_out(settings, control)
        })?;
        let plate = |index| {
            let what = format!("zone plate, {name}, set {}", index + 1);
            study.unit(&format!("plate-{key}-{index}"), &what, |control| {
                self.plate.carry_out(index, settings, control)
            })
        };
        let horizon = |task: &HorizonTask| {
            let per_pixel = task.per_pixel;
            let what = format!("horizon, {name}, {per_pixel} samples per pixel");
            study.unit(&format!("horizon-{key}-{per_pixel}"), &what, |control| {
                task.carry_out(settings, control)
            })
        };
        Ok(SamplerResults {
            sampler: self.sampler,
            spectrum,
            plates: (0..self.plate.sets).map(plate).collect::<Result<_, _>>()?,
            horizons: self
                .horizons
                .iter()
                .map(horizon)
                .collect::<Result<_, _>>()?,
        })
    }
}

pub fn units(settings: &Settings) -> usize {
    Tasks::all(settings).iter().map(Tasks::units).sum()
}

pub fn run(study: &Study<'_>) -> Result<Outcome, ReproduceError> {
    let settings = study.settings;
    let tasks = Tasks::all(settings);
    let results: Result<Vec<_>, _> = tasks.iter().map(|one| one.carry_out(study)).collect();
    let results = results?;
    let control = study.control("the pictures");
    let corner = |one: &Tasks| one.spectrum.corner(settings, &control);
    let corners: Result<Vec<_>, _> = tasks.iter().map(corner).collect();
    Ok(Outcome {
        claims: claims::claims(&results),
        pictures: pictures::pictures(&results, &corners?, settings)?,
        tables: tables::tables(&results),
        notes: notes().into(),
    })
}

fn notes() -> [String; 3] {
    let values = json!({
        "reach": filter::REACH, "sigma": filter::SIGMA, "cut_off": filter::CUT_OFF,
        "left_out": horizon::LEFT_OUT, "leaf": samplers::LEAF,
    });
    ["fig10/plates", "fig10/horizons", "fig10/sets"].map(|id| text(id, &values))
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
        let settings = |quick| Settings {
            quick,
            ..Settings::default()
        };
        let all = |quick| Tasks::all(&settings(quick));
        for (quick, whole) in all(true).iter().zip(all(false)) {
            assert!(whole.plate.count > 3 * quick.plate.count);
            assert!(whole.horizons.len() > quick.horizons.len());
        }
        assert!(units(&settings(false)) > units(&settings(true)));
    }
}
