//! Numbers in conditions and watches: `gaps() > 0`.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use tilescope_debugger::{Evaluator, Recording};

use crate::course::Course;
use crate::moment::LiveMoment;
use crate::numbers::{is_of_spectrum, live_numbers, wanted_for};

/// Lets expressions of an evaluator call the numbers of the catalogue by their keys, as in `gaps() > 0`: those that need no
/// spectrum, which would take too long at every breakpoint of a run. Nothing is measured before one is called.
pub fn add_numbers(evaluator: &mut Evaluator, recording: &Arc<Recording>) {
    let moment: Arc<OnceLock<Mutex<LiveMoment>>> = Arc::default();
    for number in live_numbers().filter(|number| !is_of_spectrum(number)) {
        let (moment, recording) = (Arc::clone(&moment), Arc::clone(recording));
        let wanted = wanted_for(&[number]);

        let is_count = number.decimals == 0;
        evaluator.add_number(number.key, is_count, move |cursor| {
            let moment = moment.get_or_init(|| {
                let course = Course::of_recording(&recording);
                Mutex::new(LiveMoment::new(Arc::new(course)))
            });
            let mut moment = moment.lock().unwrap_or_else(PoisonError::into_inner);
            moment.seek(cursor, wanted, u64::MAX).ok()?;
            number.of(&moment.measured())
        });
    }
}
