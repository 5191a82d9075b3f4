//! What becomes of a sample: whether it is there at this moment and in the end and, of an exact tiling, when it arrived and why
//! it is there, in one line.

use egui::{Label, Ui};
use tilescope_core::{Arrival, Fate, Standing};
use tilescope_debugger::{arrival_text, why_here};
use tilescope_session::moment::ShownMoment;
use tilescope_ui::language::Worded;
use tilescope_ui::widgets::{Known, row};
use tilescope_workbench::command::Command;

use super::others;
use crate::panels::context::PanelContext;

/// Shows the rows of a sample's arrival, its state at this moment and in the end, and the line of why it is there.
pub(super) fn show(
    ui: &mut Ui,
    context: &PanelContext<'_>,
    shown: &ShownMoment<'_>,
    id: u32,
    commands: &mut Vec<Command>,
) {
    let (palette, session) = (context.palette, shown.session);
    let (run, is_exact) = (session.run(), session.is_exact());

    // Lessons on exact tiling ask who came first: while a question is open, arrivals are not shown.
    if let Some(arrival) = run.arrival_of(id).filter(|_| !context.is_veiled) {
        row(ui, "Arrival", &arrival_text(arrival), palette);
        row(ui, "Rank in the throw", &rank_text(arrival), palette);
    }

    let standing = standing_name(shown.standing(id), is_exact);
    row(ui, "At this moment", standing, palette);

    match run.samples.fates[id as usize] {
        Fate::Undecided => row(ui, "In the end", "undecided", palette),
        Fate::Kept => row(ui, "In the end", "kept", palette),
        Fate::Dropped => row(ui, "In the end", "dropped", palette),
        Fate::Eliminated { by } => {
            let name = if is_exact { "Lost to" } else { "Eliminated by" };
            others(ui, name, &[by], palette, commands);
        }
    }

    let debugger = context.run.debugger.as_ref();
    let line = debugger.and_then(|debugger| why_here(debugger.recording(), id));
    if let Some(line) = line.filter(|_| !context.is_veiled) {
        let text = Label::new(ui.words(line)).wrap();
        ui.add(text).known_as("why-here");
    }
}

/// Returns the level of a sample that came in an iteration of exact tiling, the first of which has two levels.
pub(super) fn level(iteration: u32) -> String {
    match iteration {
        1 => "level 0 or 1".to_owned(),
        level => format!("level {level}"),
    }
}

/// Returns the rank of a dart in its throw as a number from 0 to below 1, as the clock of the throw.
fn rank_text(arrival: Arrival) -> String {
    // Ranks are drawn from all 32-bit numbers.
    format!("{:.6}", f64::from(arrival.rank()) / 2_f64.powi(32))
}

const fn standing_name(standing: Standing, is_exact: bool) -> &'static str {
    match standing {
        Standing::Absent => "not there yet",
        Standing::Tiled if is_exact => "tiled, yet to arrive",
        Standing::Tiled => "tiled, undecided",
        Standing::Valid => "valid",
        Standing::Eliminated { .. } if is_exact => "lost",
        Standing::Eliminated { .. } => "eliminated",
        Standing::Dropped => "outside the domain",
    }
}
