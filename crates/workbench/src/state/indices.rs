//! The numbers by which commands name samples, events, stages, breakpoints, scenes and passes ([`crate::rules`]). A command
//! that names one that is not there is refused: it may come from a script, or from a file or page of others.

use tilescope_session::words::counted;

use super::Runs;
use super::run_view::RunView;
use crate::command::Command;
use crate::rules::Numbered;
use crate::scenes::SceneList;

const SAMPLE: [&str; 2] = ["sample", "samples"];
const EVENT: [&str; 2] = ["event", "events"];

impl Runs {
    /// Returns why a command is refused, or `None` if everything that it names by a number is there. Without a run there is
    /// nothing to compare with, and such commands do nothing.
    pub(super) fn index_refusal(&self, command: &Command) -> Option<String> {
        // Other commands concern the run that the panels show.
        let run = if let Command::View(which, _) = command {
            self.get(*which)?
        } else {
            &self.first
        };
        let mut names = command.rules().names.into_iter().flatten();
        names.find_map(|item| run.number_refusal(item))
    }
}

impl RunView {
    /// Returns why there is no item of this number; `None` if there is one, or if the session, the debugger or the passes that
    /// would have it are missing.
    fn number_refusal(&self, item: Numbered) -> Option<String> {
        let session = self.session.as_ref();
        let debugger = self.debugger.as_ref();
        let ([one, many], index, count) = match item {
            Numbered::Sample(id) => (SAMPLE, id as usize, session?.run().samples.len()),
            Numbered::Event(index) => (EVENT, index, debugger?.recording().len()),
            Numbered::Moment(at) => {
                let (_cursor, count) = self.cursor()?;
                // A moment is how many events have happened, or how many samples of a prefix are shown. So the number
                // of all events or samples is a moment, too.
                if at == count {
                    return None;
                }
                // Nested levels and stipples have prefixes of their samples in the place of events.
                let what = if session?.has_prefixes() {
                    SAMPLE
                } else {
                    EVENT
                };
                (what, at, count)
            }
            Numbered::Stage(index) => {
                // Of nested levels a command names the end of a level in the place of a stage.
                let count = match &session?.nested {
                    Some(nested) => nested.ends().count(),
                    None => session?.stages.len(),
                };
                (["stage", "stages"], index, count)
            }
            Numbered::Scene(index) => {
                let count = SceneList::Own.scenes(self).len();
                (["scene", "scenes"], index, count)
            }
            Numbered::Breakpoint(index) => {
                let count = debugger?.breakpoints().len();
                (["breakpoint", "breakpoints"], index, count)
            }
            Numbered::Watch(index) => (["watch", "watches"], index, debugger?.watches.len()),
            Numbered::Pass(index) => {
                let count = self.passes.as_ref()?.entries().len();
                (["pass", "passes"], index, count)
            }
        };

        let owner = match item {
            Numbered::Scene(_) | Numbered::Breakpoint(_) | Numbered::Watch(_) => "the session",
            Numbered::Sample(_)
            | Numbered::Event(_)
            | Numbered::Moment(_)
            | Numbered::Stage(_)
            | Numbered::Pass(_) => "the run",
        };
        let there = counted(count, one, many);
        (index >= count).then(|| format!("{one} {index}: {owner} has {there}, numbered from 0"))
    }
}
