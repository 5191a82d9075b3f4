//! Makes combinations in the background: samples the sets or reads them from files, places them, has the core
//! glue them, and prepares the session.

mod band;
mod files;
mod progress;
mod saved;

use serde::{Deserialize, Serialize};
use tilescope_core::Run;
use tilescope_core::combine::file::{Layout, PieceSource, PlacedLayout, Set};
use tilescope_core::combine::{Piece, Seam, combine, combine_in_stages};
use tilescope_sets::set_of_piece;

pub use saved::{SavedCombination, SavedError};

use crate::combination::{Combination, CombinationError, MAX_COMBINED};
use crate::encoding::as_json;
use crate::incoming::Incoming;
use crate::jobs::Monitor;
use crate::limits::MAX_STAGED;
use crate::session::{MakeError, Session};
use crate::task::{SessionRef, Task};

use files::Files;
use progress::{Gluing, OneSet, Sets, stopped};

/// Makes a combination that needs no files.
#[derive(Serialize, Deserialize)]
pub struct CombineTask {
    /// The layout, whose sets come from no files.
    #[serde(with = "as_json")]
    pub layout: Layout,
    /// The generation that the session gets.
    pub generation: u64,
}

impl Task for CombineTask {
    type Outcome = Result<Session, MakeError>;
    const NAME: &'static str = "combine";

    fn run(self, monitor: &Monitor) -> Self::Outcome {
        let without_files = None;
        Ok(make(self.layout, without_files, self.generation, monitor)?)
    }

    fn cancelled(monitor: &Monitor) -> Option<Self::Outcome> {
        Some(Err(MakeError::cancelled_by(monitor)))
    }

    fn keep(made: Self::Outcome) {
        SessionRef::keep(made);
    }
}

/// Makes the combination of a layout. `around` is the file in which the layout came: the files of its sets came with
/// it, or are read from its folder. Without `around`, as for a layout that came as text, no set may lie in a file.
///
/// Fails as [`Layout::placed`] and [`combine`] do, when a set cannot be made or read, and when `monitor` is
/// cancelled.
pub fn make(
    layout: Layout,
    around: Option<&Incoming>,
    generation: u64,
    monitor: &Monitor,
) -> Result<Session, CombinationError> {
    let placed = layout.placed()?;
    // Too many samples are refused before any set is made, because that takes most of the time.
    if placed.expected > MAX_COMBINED as f64 {
        let expected = placed.expected;
        return Err(CombinationError::TooManySamples { expected });
    }

    let files = Files::of(around);
    let pieces = pieces(&placed, &files, monitor)?;

    // A small combination keeps its stages, so that the window shows what gluing did. The stages have the samples of
    // the result. `placed.expected` can be larger: where a piece is cut from a set with a size of its own, it also
    // counts that set.
    let options = layout.options();
    let mut observer = Gluing(monitor);
    let in_result = placed.domain.area_radii() * tilescope_core::MAXIMAL_DENSITY;
    let (run, seams): (Run, Vec<Seam>) = if in_result <= MAX_STAGED {
        let staged = combine_in_stages(placed.domain, &pieces, &options, &mut observer)?;
        (staged.run, staged.seams)
    } else {
        let combined = combine(placed.domain, &pieces, &options, &mut observer)?;
        let seams = combined.seams.clone();
        (combined.into_run(&pieces, &options), seams)
    };

    // Fails if the work was cancelled.
    observer.end()?;

    let stops = || monitor.is_cancelled();
    let band = band::of(&placed.domain, &pieces, &seams, &stops).ok_or_else(stopped)?;

    let stated = files.stated(&layout, &placed);
    let combination = Combination::of(layout, stated, &placed, seams, band);
    let session = Session::from_combination(run, combination, generation);

    // Preparing the session takes time as well, and the user may have cancelled it meanwhile.
    if stops() {
        return Err(stopped().into());
    }
    Ok(session)
}

/// Makes or reads all sets in parallel.
fn pieces(
    placed: &PlacedLayout,
    files: &Files<'_>,
    monitor: &Monitor,
) -> Result<Vec<Piece>, CombinationError> {
    let sets = Sets::new(monitor, placed.pieces.len());
    let make = |source: &PieceSource| {
        let mut observer = OneSet::of(source, &sets);
        set(source, files, monitor, &mut observer)
    };
    let pieces = placed.pieces(make, |count| sets.made(count));
    pieces.map_err(|error| CombinationError::Piece(Box::new(error)))
}

/// Returns the set of a piece, which is made or read. Fails for a piece with a file if the layout may use none.
fn set(
    source: &PieceSource,
    files: &Files<'_>,
    monitor: &Monitor,
    observer: &mut OneSet<'_>,
) -> Result<Set, CombinationError> {
    set_of_piece(source, observer, |path, given| {
        let none = || {
            let path = path.to_owned();
            Err(CombinationError::NoFiles { path })
        };
        files.set(path, given, monitor).unwrap_or_else(none)
    })
}
