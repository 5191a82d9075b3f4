//! All kinds of errands by name, for a worker that is sent one.

use tilescope_session::errand::{Errand, Refused, carry_out};
use tilescope_session::jobs::Monitor;

macro_rules! errands {
    ($($errand:ty,)*) => {
        /// Carries out the errand called `name` and returns its outcome as bytes.
        ///
        /// # Errors
        ///
        /// [`Refused`]: sessions that it is about are not here, or it is no errand of this program.
        pub fn perform(name: &str, input: &[u8], monitor: &Monitor) -> Result<Vec<u8>, Refused> {
            match name {
                $(<$errand>::NAME => carry_out::<$errand>(input, monitor),)*
                other => Err(Refused::Fault(format!("there is no job called {other:?}"))),
            }
        }

        /// Their names.
        #[cfg(test)]
        const NAMES: &[&str] = &[$(<$errand>::NAME,)*];
    };
}

errands! {
    tilescope_session::sampling::Patterning,
    tilescope_session::sampling::Sampling,
    tilescope_session::sampling::Twin,
    tilescope_session::combining::Combining,
    tilescope_session::verification::Judging,
    tilescope_session::geometry::Triangulating,
    crate::state::run_view::Counting,
    crate::state::run_view::Looking,
    crate::analysis::Beginning,
    crate::analysis::GoingOn,
    crate::analysis::reference::Measuring,
    crate::analysis::brush::Causing,
    crate::compare::Dividing,
    crate::compare::difference::Differing,
    crate::files::ReadTask,
    crate::state::export::Delivering,
}

#[cfg(test)]
mod tests;
