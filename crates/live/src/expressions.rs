//! Numbers of the moment in watches and conditions: `gaps > 0`.

use std::sync::{Arc, LazyLock};

use tilescope_analysis::measures::SetNumber;
use tilescope_debugger::{MomentNumbers, NumberAt, NumberName, NumberValue, Recording};

use crate::course::Course;
use crate::curve::MAX_SAMPLES_OF_SPECTRUM;
use crate::moment::{LiveMoment, MAX_SAMPLES};
use crate::numbers::{all_live_numbers, is_of_spectrum, number_of_run, wanted_for};

/// The numbers of the catalogue that can be had at every moment, by their keys, for
/// [`give_numbers`](Recording::give_numbers). Nothing is measured before an expression names one.
///
/// A value takes at most the time of measuring its moment from nothing, and that of the changes since the value before where
/// these are fewer; a watch waits for it no longer than the steps that it has in a frame. All conditions of a run from its start to
/// its end take the time of the run's curve.
pub static MOMENT_NUMBERS: LazyLock<MomentNumbers> = LazyLock::new(|| MomentNumbers {
    names: all_live_numbers().map(name).collect(),
    follow,
});

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
fn follow(recording: &Recording) -> NumberAt {
    let samples = recording.run().samples.len();
    // These are all samples that the run ever has. How many there are at once is known only after its events are read below.
    if samples > MAX_SAMPLES {
        let why = format!(
            "the run has {samples} samples; moments of at most {MAX_SAMPLES} are measured: take a larger radius"
        );
        return Box::new(move |_, _, _| Err(why.clone()));
    }

    // In a field or a shape, conflicts and open places are found by the judge of this field and shape. No such judge is
    // made here, and the other measures know one radius in a rectangle alone.
    if recording.run().locality.is_some() {
        let why = "it is of one radius in a rectangle, which a set in a field or a shape does not have; the analysis follows its \
                   conflicts and open places";
        return Box::new(move |_, _, _| Err(why.to_owned()));
    }

    let mut moment = LiveMoment::new(Arc::new(Course::of_recording(recording)));
    Box::new(move |key, cursor, steps| {
        // Expressions name only numbers of the list above. Some of these are of planar sets alone, and some of sets in
        // space alone: in a run of the other kind such a number is not defined.
        let Some(found) = number_of_run(key, moment.course().is_in_space()) else {
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
