//! Numbers of the moment in watches and conditions: `gaps > 0`.

use std::sync::{Arc, LazyLock};

use tilescope_analysis::measures::SetNumber;
use tilescope_debugger::{MomentNumbers, NumberAt, NumberName, NumberValue, Recording};

use crate::course::Course;
use crate::curve::MAX_SAMPLES_OF_SPECTRUM;
use crate::moment::{LiveMoment, MAX_SAMPLES};
use crate::numbers::{all_live_numbers, is_of_spectrum, wanted_for};
use crate::setting::{LiveGround, Setting};

/// The numbers of the catalogue that can be had at every moment, by their keys, for
/// [`give_numbers`](Recording::give_numbers). Nothing is measured before an expression names one.
///
/// A value takes at most the time of measuring its moment from nothing, and that of the changes since the value before where
/// these are fewer; a watch waits for it no longer than the steps that it has in a frame. All conditions of a run from its start to
/// its end take the time of the run's curve.
pub static MOMENT_NUMBERS: LazyLock<Arc<MomentNumbers>> =
    LazyLock::new(|| Arc::new(numbers_of(all_live_numbers(), of_box)));

/// The same for recordings of sets in space: numbers that are defined there have their meaning by distances in space.
pub static SPACE_MOMENT_NUMBERS: LazyLock<Arc<MomentNumbers>> = LazyLock::new(|| {
    // Planar numbers stay among the names, so that a watch of one that was kept from a planar run says that there is none.
    let in_space = |number: &'static SetNumber| Setting::Space.number(number.key).unwrap_or(number);
    Arc::new(numbers_of(all_live_numbers().map(in_space), of_box))
});

/// Returns the course of a recording in a rectangle or in space.
fn of_box(recording: &Recording) -> Result<Course, String> {
    // A recording in a field or a shape has the numbers of `moment_numbers_in`. Without them its judge is not known.
    let is_in_ground = recording.run().locality.is_some();
    let why = "it has no judge of its field or its shape here";
    let course = || Course::of_recording(recording);
    (!is_in_ground).then(course).ok_or_else(|| why.to_owned())
}

/// Returns the numbers of recordings in a field or a shape. `ground` makes what measures need of it, once for each evaluator
/// that names a number, or says why it cannot.
pub fn moment_numbers_in(
    ground: impl Fn() -> Result<LiveGround, String> + Send + Sync + 'static,
) -> MomentNumbers {
    let course_of = move |recording: &_| Ok(Course::of_recording(recording).in_ground(ground()?));
    numbers_of(all_live_numbers(), course_of)
}

/// Returns these numbers of recordings whose course is made by `course_of`.
fn numbers_of(
    numbers: impl Iterator<Item = &'static SetNumber>,
    course_of: impl Fn(&Recording) -> Result<Course, String> + Send + Sync + 'static,
) -> MomentNumbers {
    MomentNumbers {
        names: numbers.map(name).collect(),
        follow: Box::new(move |recording| follow(recording, &course_of)),
    }
}

fn name(number: &'static SetNumber) -> NumberName {
    let why = "its spectrum would be read again at every breakpoint";
    NumberName {
        name: number.key,
        meaning: number.meaning,
        is_count: number.decimals == 0,
        // Reading the rings takes 0.4 ms at 10,000 samples: two minutes at the 300,000 breakpoints of such a run, whose other
        // numbers take some seconds.
        not_in_conditions: is_of_spectrum(number).then_some(why),
    }
}

/// Returns the function that gives the value of a number at a cursor of a recording. Its last argument is the most
/// steps that it may take. Where the run has too many samples, it returns an error instead.
fn follow(
    recording: &Recording,
    course_of: &dyn Fn(&Recording) -> Result<Course, String>,
) -> NumberAt {
    let samples = recording.run().samples.len();
    // These are all samples that the run ever has. How many there are at once is known only after its events are read below.
    if samples > MAX_SAMPLES {
        let why = format!(
            "the run has {samples} samples; moments of at most {MAX_SAMPLES} are measured: take a larger radius"
        );
        return Box::new(move |_, _, _| Err(why.clone()));
    }

    // A field that is too steep to be followed says so in the place of every value.
    let course = match course_of(recording) {
        Ok(course) => course,
        Err(why) => return Box::new(move |_, _, _| Err(why.clone())),
    };
    // Each evaluator has a moment of its own, at the cursor that it was asked for last.
    let mut moment = LiveMoment::new(Arc::new(course));
    Box::new(move |key, cursor, steps| {
        // Expressions name only numbers of the list above. Some of these are of planar sets alone, some of sets in space
        // alone, and some of one radius: in a run of another kind such a number is not defined.
        let Some(found) = moment.course().setting().number(key) else {
            return Ok(NumberValue::Undefined);
        };

        // A watch is evaluated in every frame of a run that plays. The cost of a spectrum depends on how many samples there are at
        // once, which may be fewer than the run ever has.
        let most = moment.course().most_samples();
        if is_of_spectrum(found) && most > MAX_SAMPLES_OF_SPECTRUM {
            return Err(format!(
                "the run has up to {most} samples at once; it can be watched in runs of at most {MAX_SAMPLES_OF_SPECTRUM}: take a larger radius"
            ));
        }

        let moved = moment.seek(cursor, wanted_for(&[found]), steps);
        if !moved.map_err(|error| error.to_string())?.arrived {
            return Ok(NumberValue::Pending);
        }

        let value = found.of(&moment.measured());
        Ok(value.map_or(NumberValue::Undefined, NumberValue::Known))
    })
}
