//! Figure 10 and section 4.1.3: zone plates and a horizon from the samples of each sampler, against exact images; samples and
//! spectra beside them. It ranks by error, never by looks.

mod claims;
mod curves;
mod filter;
mod found;
mod horizon;
mod looks;
mod pictures;
mod plate;
mod rules;
mod samplers;
mod shades;
mod sheet;
mod tables;

use crate::error::ReproduceError;
use crate::numbers::count;
use crate::outcome::Outcome;
use crate::study::{Settings, Study};
use crate::work::Work;

use self::found::Found;
use self::samplers::Sampler;

/// What is done for one sampler.
struct Tasks {
    sampler: Sampler,
    look: Option<looks::Task>,
    plate: Option<plate::Task>,
    /// KDRT with as many samples, for a file that has fewer than the others.
    beside: Option<plate::Task>,
    horizons: Vec<horizon::Task>,
}

impl Tasks {
    fn all(settings: &Settings) -> Vec<Self> {
        let full = plate::Task::of(Sampler::Kdrt, settings);
        let tasks = |sampler| {
            let plate = plate::Task::of(sampler, settings);
            let smaller = plate.filter(|task| Some(task.plate) != full.map(|full| full.plate));
            Self {
                sampler,
                look: looks::Task::of(sampler, settings),
                plate,
                beside: smaller.map(|task| plate::Task {
                    sampler: Sampler::Kdrt,
                    sets: full.map_or(1, |full| full.sets),
                    ..task
                }),
                horizons: horizon::Task::of(sampler, settings),
            }
        };
        Sampler::all(settings).into_iter().map(tasks).collect()
    }

    fn work(&self) -> Work {
        let plates = [self.plate, self.beside].into_iter().flatten();
        let plates = plates.map(|task| task.work() * task.sets as f64);
        (self.look.iter().map(looks::Task::work))
            .chain(plates)
            .chain(self.horizons.iter().map(horizon::Task::work))
            .sum()
    }

    fn carry_out(&self, study: &Study<'_>) -> Result<Found, ReproduceError> {
        let settings = study.settings;
        let (name, key) = (self.sampler.name(settings), self.sampler.key());
        let looked = |task: &looks::Task| {
            let names = (&*format!("look-{key}"), &*format!("spectrum, {name}"));
            study.unit(names, task.work(), |control| {
                task.carry_out(settings, control)
            })
        };
        let horizon = |task: &horizon::Task| {
            let per_pixel = task.per_pixel;
            let key = format!("horizon-{key}-{per_pixel}");
            let what = format!("horizon, {name}, {per_pixel} samples per pixel");
            study.unit((&key, &what), task.work(), |control| {
                task.carry_out(settings, control)
            })
        };
        let horizons: Result<Vec<_>, _> = self.horizons.iter().map(horizon).collect();
        Ok(Found {
            look: self.look.as_ref().map(looked).transpose()?,
            plates: plates(self.plate, (&format!("plate-{key}"), &name), study)?,
            beside: plates(
                self.beside,
                (
                    &format!("plate-beside-{key}"),
                    &format!("KDRT beside {name}"),
                ),
                study,
            )?,
            horizons: horizons?,
            sampler: self.sampler,
            name,
        })
    }
}

/// Renders the zone plates of all sets of a task.
fn plates(
    task: Option<plate::Task>,
    (key, name): (&str, &str),
    study: &Study<'_>,
) -> Result<Vec<plate::Plated>, ReproduceError> {
    let Some(task) = task else {
        return Ok(Vec::new());
    };
    (0..task.sets)
        .map(|index| {
            let key = format!("{key}-{index}");
            let what = format!("zone plate, {name}, set {}", index + 1);
            study.unit((&key, &what), task.work(), |control| {
                task.carry_out(index, study.settings, control)
            })
        })
        .collect()
}

pub fn work(settings: &Settings) -> Work {
    Tasks::all(settings).iter().map(Tasks::work).sum()
}

pub fn run(study: &Study<'_>) -> Result<Outcome, ReproduceError> {
    let settings = study.settings;
    let tasks = Tasks::all(settings);
    let found: Result<Vec<Found>, _> = tasks.iter().map(|one| one.carry_out(study)).collect();
    let found = found?;
    let control = study.control("the pictures");
    let corner = |one: &Tasks| match &one.look {
        None => Ok(Vec::new()),
        Some(task) => task.corner(settings, &control),
    };
    let corners: Result<Vec<_>, _> = tasks.iter().map(corner).collect();
    Ok(Outcome {
        claims: claims::claims(&found),
        pictures: pictures::pictures(&found, &corners?, settings)?,
        tables: tables::tables(&found),
        notes: notes(&found, settings),
    })
}

fn notes(found: &[Found], settings: &Settings) -> Vec<String> {
    let methods = [
        format!(
            "Zone plates: a pixel is the mean of the samples within {} pixels along each axis, weighted by a Gaussian of standard deviation \
             {} pixels, over the sum of weights; samples reach beyond the image on all sides. The exact image is the zone plate's integral \
             with a Gaussian that goes on for ever, in closed form; that changes no value by more than {:e}.",
            filter::REACH,
            filter::SIGMA,
            filter::CUT_OFF
        ),
        format!(
            "Horizon: a pixel is the mean of the samples in it; where there is none, it is the nearest in the smallest square of pixels \
             about it that has some. The exact image is the board's integral over each pixel, piece by piece where it is linear; in the row \
             that touches the horizon it is wrong by at most {:.1e}.",
            horizon::LEFT_OUT
        ),
        format!(
            "KDRT: leaf {} r, periodic patterns of 100 r, one of eight for each set. Every set of KDRT and of the reference sampler has been \
             verified: no conflict, no gap. Grid and jittered samples have cells that at 1, 4 and 16 samples per pixel are parts of \
             pixels: the best case for them.",
            samplers::LEAF
        ),
    ];
    let files = found.iter();
    let files = files.filter(|one| matches!(one.sampler, Sampler::Given(_)));
    let wanted = found.first().map_or(0, |one| one.horizons.len());
    let files = files.map(|one| file_note(one, wanted, settings));
    methods.into_iter().chain(files).collect()
}

fn file_note(one: &Found, wanted: usize, settings: &Settings) -> String {
    let Some(plate) = one.plates.first() else {
        let most = count(one.sampler.most(settings) as u64);
        return format!("{}: {most} samples are too few for an image.", one.name);
    };
    let beside = if one.beside.is_empty() {
        ""
    } else {
        ", and is compared with KDRT of as many"
    };
    format!(
        "{}: scaled from its region; its zone plate of {} samples has {} pixels a side, so that a pixel has as many samples as in the \
         others{beside}. Its samples suffice for {} of {wanted} horizons.",
        one.name,
        count(plate.count as u64),
        plate.side,
        one.horizons.len(),
    )
}

#[cfg(test)]
mod tests {
    use super::samplers::tests::given;
    use super::*;
    use crate::experiment::Experiment;
    use crate::outcome::Verdict;
    use crate::study::tests::{alone, studied};

    #[test]
    fn a_quick_run_with_a_file_is_the_work_it_said_and_fills_all_tables() {
        let mut points = Vec::new();
        alone(&Settings::default(), |control| {
            points = Sampler::Jittered.points((22_500, 7), &Settings::default(), control)?;
            Ok(())
        });
        let settings = Settings {
            given: vec![
                given("bnot-or-so.csv", &points),
                given("few.csv", &points[..300]),
            ],
            ..Settings::default()
        };
        let outcome = studied(Experiment::Fig10, &settings, |study| {
            let outcome = run(study)?;
            let (told, said) = (study.told(), work(&settings));
            let off = study.rates.seconds(&told) / study.rates.seconds(&said) - 1.0;
            assert!(off.abs() < 1e-9, "{told:?} is not {said:?}");
            Ok(outcome)
        })
        .unwrap();
        checked(&outcome);
        assert_ne!(outcome.claims[3].verdict, Verdict::NotComparable);
        assert!(outcome.claims[3].ours.contains("bnot-or-so.csv"));
        assert_eq!(outcome.claims[5].verdict, Verdict::NotComparable);
        assert!(
            outcome
                .notes
                .iter()
                .any(|note| note.starts_with("few.csv: 300 samples are too few"))
        );
    }

    /// Tables are whole, and pictures small enough to be sent.
    fn checked(outcome: &Outcome) {
        assert_eq!((outcome.claims.len(), outcome.pictures.len()), (6, 5));
        for table in &outcome.tables {
            assert!(table.rows.len() > 4, "{}", table.name);
            let columns = table.columns.len();
            let whole = table.rows.iter().all(|row| row.len() == columns);
            assert!(whole, "{}", table.name);
        }
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
        let (quick, whole) = (work(&settings(true)), work(&settings(false)));
        assert!(whole.reference > 3.0 * quick.reference && whole.other > 3.0 * quick.other);
    }
}
