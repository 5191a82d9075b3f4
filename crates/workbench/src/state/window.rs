//! The window in the state: layout of panels, the drawer of a compact window, the list of actions, full screen.

use super::FullScreen;
use crate::arrangement::{Arrangement, Drawer, DrawerCommand};
use crate::command::WindowCommand;
use crate::embedding::Embedding;
use crate::finder::Finder;
use crate::help::HelpPage;
use crate::layout::{Layout, Panel};

/// The state of the window.
#[derive(Default)]
pub struct WindowState {
    /// The layout of the panels.
    pub layout: Layout,
    /// The drawer of a window that is too small for the layout.
    pub drawer: Drawer,
    /// The list of all actions, if open.
    pub finder: Option<Finder>,
    /// The page of the help sheet, if open.
    pub help: Option<HelpPage>,
    /// The parts shown if the window is embedded in another page.
    pub embedding: Option<Embedding>,
    /// Whether the bar at the top is left out.
    pub bare: bool,
    /// Whether the window can use full screen.
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
            WindowCommand::Help(page) => self.help = Some(page),
            WindowCommand::CloseHelp => self.help = None,
            WindowCommand::CloseFinder => self.finder = None,
            WindowCommand::FinderText(text) => self.finder = Some(Finder { text, choice: 0 }),
            WindowCommand::FinderChoice(choice) => {
                if let Some(finder) = &mut self.finder {
                    finder.choice = choice;
                }
            }
        }
    }

    /// Returns whether a panel is visible.
    #[must_use]
    pub fn shows(&self, panel: Panel) -> bool {
        match (self.drawer.arrangement, panel) {
            (Arrangement::Tiles, _) => self.layout.shows(panel),
            (_, Panel::Canvas | Panel::Timeline) => true,
            _ => self.drawer.open == Some(panel),
        }
    }

    /// Brings a panel into view; a compact window keeps the layout unchanged.
    pub(super) fn open_panel(&mut self, panel: Panel) {
        if !self.drawer.arrangement.is_compact() {
            self.layout.open(panel);
            return;
        }
        // The canvas is always shown; closing the drawer gives it all the room.
        self.drawer.open = (panel != Panel::Canvas).then_some(panel);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_compact_window_shows_one_panel_and_keeps_the_layout() {
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
