//! The panel that a compact window shows, and panels that are brought into view.

use super::State;
use crate::arrangement::{Arrangement, DrawerCommand};
use crate::layout::Panel;

impl State {
    pub(crate) const fn apply_to_drawer(&mut self, command: DrawerCommand) {
        match command {
            DrawerCommand::Arrange(arrangement) => self.window.drawer.arrangement = arrangement,
            DrawerCommand::Show(panel) => self.window.drawer.open = panel,
            DrawerCommand::Tall(is_tall) => self.window.drawer.is_tall = is_tall,
        }
    }

    /// Returns whether a panel can be seen.
    #[must_use]
    pub fn shows(&self, panel: Panel) -> bool {
        match (self.window.drawer.arrangement, panel) {
            (Arrangement::Tiles, _) => self.window.layout.shows(panel),
            (_, Panel::Canvas | Panel::Timeline) => true,
            _ => self.window.drawer.open == Some(panel),
        }
    }

    /// Brings what is known of the selection into view, if there is a selection and the window has panels.
    pub(crate) fn inspect(&mut self) {
        let is_selected = self.runs.first.selected.is_some() || self.runs.first.place.is_some();
        if is_selected && self.window.embedding.is_none() {
            self.open_panel(Panel::Inspector);
        }
    }

    /// Brings a panel into view; in a compact window the tiles are left as they are.
    pub(crate) fn open_panel(&mut self, panel: Panel) {
        if !self.window.drawer.arrangement.is_compact() {
            self.window.layout.open(panel);
            return;
        }
        // The canvas is there: it gets all the room.
        self.window.drawer.open = (panel != Panel::Canvas).then_some(panel);
    }
}
