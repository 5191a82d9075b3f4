//! What stands where: panels, the one panel of a compact window, the list of actions.

use super::FullScreen;
use crate::arrangement::{Arrangement, Drawer, DrawerCommand};
use crate::command::WindowCommand;
use crate::embedding::Embedding;
use crate::finder::Finder;
use crate::layout::{Layout, Panel};

/// What stands where.
#[derive(Default)]
pub struct WindowState {
    /// Where the panels stand.
    pub layout: Layout,
    /// What a window shows that is too small for them.
    pub drawer: Drawer,
    /// The list of all actions, when open.
    pub finder: Option<Finder>,
    /// What of the window is left where it is part of another page.
    pub embedding: Option<Embedding>,
    /// Whether the bar on top is left out, as where the window is part of something else.
    pub bare: bool,
    /// Whether the window may have the full screen.
    pub full_screen: FullScreen,
}

impl WindowState {
    pub(super) fn apply(&mut self, command: WindowCommand) {
        match command {
            WindowCommand::ToggleFullScreen => self.full_screen = FullScreen::Asked,
            WindowCommand::OpenPanel(panel) => self.open_panel(panel),
            WindowCommand::Drawer(DrawerCommand::Arrange(arrangement)) => {
                self.drawer.arrangement = arrangement;
            }
            WindowCommand::Drawer(DrawerCommand::Show(panel)) => self.drawer.open = panel,
            WindowCommand::Drawer(DrawerCommand::Tall(is_tall)) => self.drawer.is_tall = is_tall,
            WindowCommand::ResetLayout => self.layout = Layout::default(),
            WindowCommand::ToggleFinder => {
                self.finder = match self.finder {
                    None => Some(Finder::default()),
                    Some(_) => None,
                }
            }
            WindowCommand::CloseFinder => self.finder = None,
            WindowCommand::FinderText(text) => self.finder = Some(Finder { text, choice: 0 }),
            WindowCommand::FinderChoice(choice) => {
                if let Some(finder) = &mut self.finder {
                    finder.choice = choice;
                }
            }
        }
    }

    /// Returns whether a panel can be seen.
    #[must_use]
    pub fn shows(&self, panel: Panel) -> bool {
        match (self.drawer.arrangement, panel) {
            (Arrangement::Tiles, _) => self.layout.shows(panel),
            (_, Panel::Canvas | Panel::Timeline) => true,
            _ => self.drawer.open == Some(panel),
        }
    }

    /// Brings a panel into view; in a compact window the tiles are left as they are.
    pub(super) fn open_panel(&mut self, panel: Panel) {
        if !self.drawer.arrangement.is_compact() {
            self.layout.open(panel);
            return;
        }
        // The canvas is there: it gets all the room.
        self.drawer.open = (panel != Panel::Canvas).then_some(panel);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_compact_window_shows_one_panel_and_leaves_the_tiles() {
        let mut window = WindowState::default();
        let tiles = window.layout.clone();
        window.apply(WindowCommand::Drawer(DrawerCommand::Arrange(
            Arrangement::Portrait,
        )));
        window.apply(WindowCommand::OpenPanel(Panel::Statistics));
        assert!(window.shows(Panel::Statistics) && !window.shows(Panel::Legend));
        window.apply(WindowCommand::OpenPanel(Panel::Canvas));
        assert!(window.shows(Panel::Canvas) && !window.shows(Panel::Statistics));
        assert_eq!(window.layout, tiles);
    }

    #[test]
    fn the_list_of_actions_opens_empty() {
        let mut window = WindowState::default();
        window.apply(WindowCommand::FinderText("run".to_owned()));
        window.apply(WindowCommand::FinderChoice(2));
        let found = Finder {
            text: "run".to_owned(),
            choice: 2,
        };
        assert_eq!(window.finder, Some(found));
        window.apply(WindowCommand::ToggleFinder);
        window.apply(WindowCommand::ToggleFinder);
        assert_eq!(window.finder, Some(Finder::default()));
    }
}
