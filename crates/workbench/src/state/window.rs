//! The window in the state: layout of panels, the drawer of a compact window, the list of actions, full screen.

use super::{FullScreen, RunView};
use crate::arrangement::{Arrangement, Drawer, DrawerCommand};
use crate::command::WindowCommand;
use crate::embedding::Embedding;
use crate::finder::Finder;
use crate::help::HelpPage;
use crate::layout::{Layout, Panel, PanelSet};

/// The state of the window.
#[derive(Default)]
pub struct WindowState {
    /// The layout of the panels.
    pub layout: Layout,
    /// The panels beside the canvas that were hidden together, to bring them back together.
    put_away: PanelSet,
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
    /// Whether the window can use full screen, or was asked to enter or leave it.
    pub full_screen: FullScreen,
    /// Whether the user asked to close the window, which the program then does.
    pub quits: bool,
    /// Whether the window fills the screen, where that is known.
    pub is_full: Option<bool>,
    /// The address of the page, without a fragment, that copied links begin with; `None` natively.
    pub address: Option<String>,
    /// Text to be put on the clipboard.
    pub copied: Option<String>,
}

/// The panels as they were before a lesson or the tour hid some.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct KeptPanels {
    layout: Layout,
    put_away: PanelSet,
    /// The panel of a compact window.
    drawer: Option<Panel>,
}

impl KeptPanels {
    pub(super) const fn layout(&self) -> &Layout {
        &self.layout
    }
}

impl WindowState {
    pub(super) fn kept_panels(&self) -> KeptPanels {
        KeptPanels {
            layout: self.layout.clone(),
            put_away: self.put_away,
            drawer: self.drawer.open,
        }
    }

    pub(super) fn put_back(&mut self, kept: KeptPanels) {
        self.layout = kept.layout;
        self.put_away = kept.put_away;
        self.drawer.open = kept.drawer;
    }

    /// Hides the panels beside the canvas, if any are visible, and the one of a compact window.
    pub(super) fn hide_sides(&mut self) {
        if self.shows_sides() {
            self.toggle_sides();
        }
        self.drawer.open = None;
    }

    /// Applies a command of the window.
    pub(super) fn apply(&mut self, command: WindowCommand) {
        match command {
            // Panels and their layout.
            WindowCommand::OpenPanel(panel) => self.open_panel(panel),
            WindowCommand::Drawer(DrawerCommand::Arrange(arrangement)) => {
                self.drawer.arrangement = arrangement;
            }
            WindowCommand::Drawer(DrawerCommand::Show(panel)) => self.drawer.open = panel,
            WindowCommand::Drawer(DrawerCommand::Tall(is_tall)) => self.drawer.is_tall = is_tall,
            WindowCommand::HidePanel(panel) => self.hide_panel(panel),
            WindowCommand::ToggleSides => self.toggle_sides(),

            WindowCommand::ResetLayout => {
                self.layout = Layout::default();
                // The panels that were put away to be brought back together are in the layout again.
                self.put_away = PanelSet::default();
            }

            // The list of actions, and help.
            WindowCommand::ToggleFinder => {
                self.finder = match self.finder {
                    None => Some(Finder::default()),
                    Some(_) => None,
                }
            }

            WindowCommand::CloseFinder => self.finder = None,
            // Another search begins at its first action.
            WindowCommand::FinderText(text) => self.finder = Some(Finder { text, choice: 0 }),

            WindowCommand::FinderChoice(choice) => {
                if let Some(finder) = &mut self.finder {
                    finder.choice = choice;
                }
            }
            WindowCommand::Help(page) => self.help = Some(page),
            WindowCommand::CloseHelp => self.help = None,

            // The window itself.
            // The program carries these two out.
            WindowCommand::ToggleFullScreen => self.full_screen = FullScreen::Asked,
            WindowCommand::Quit => self.quits = true,
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

    /// Returns whether a command can hide the panel: it is visible, and the window works without it.
    #[must_use]
    pub fn can_hide(&self, panel: Panel) -> bool {
        match self.drawer.arrangement {
            Arrangement::Tiles => panel != Panel::Canvas && self.layout.shows(panel),
            _ => self.drawer.open == Some(panel),
        }
    }

    fn hide_panel(&mut self, panel: Panel) {
        if !self.drawer.arrangement.is_compact() {
            self.layout.hide(panel);
        } else if self.drawer.open == Some(panel) {
            self.drawer.open = None;
        }
    }

    /// Returns whether any panel beside the canvas is visible.
    #[must_use]
    pub fn shows_sides(&self) -> bool {
        let mut sides = self.layout.sides().panels();
        sides.any(|panel| self.layout.shows(panel))
    }

    /// Hides the panels beside the canvas; or, if all of them are hidden, brings back those that were hidden together,
    /// or else all. Which tabs are open stays.
    fn toggle_sides(&mut self) {
        let (tabs, hidden) = (self.layout.root.clone(), self.layout.hidden());
        let sides = self.layout.sides();
        if self.shows_sides() {
            // A panel that was hidden by itself does not come back with the panels that are put away together now.
            // Panels that were put away earlier and are still hidden stay in the set, so that they do come back.
            let shown = sides.panels().filter(|panel| !hidden.has(*panel));
            self.put_away = self.put_away.panels().chain(shown).collect();
            sides.panels().for_each(|panel| self.layout.hide(panel));
            // The open tabs stay open for when the panels come back.
            self.layout.root = tabs;
            return;
        }

        let away = std::mem::take(&mut self.put_away);
        let back = if away.is_empty() { sides } else { away };
        self.layout.show_all(back);
    }

    /// Opens the inspector, if something of a run is selected and the window has panels. No run is given if the selection
    /// answers a question: the inspector would take room from the picture, and may show the answer.
    pub(super) fn inspect(&mut self, run: Option<&RunView>) {
        let is_selected = run.is_some_and(|run| run.selected.is_some() || run.place.is_some());
        if is_selected && self.embedding.is_none() {
            self.open_panel(Panel::Inspector);
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
    fn the_panels_beside_the_canvas_are_hidden_together_and_come_back() {
        let mut window = WindowState::default();
        window.apply(WindowCommand::OpenPanel(Panel::Events));
        window.apply(WindowCommand::HidePanel(Panel::Legend));
        let before = window.layout.clone();
        window.apply(WindowCommand::ToggleSides);
        assert!(!window.shows_sides() && window.shows(Panel::Canvas));
        assert!(window.shows(Panel::Timeline));
        window.apply(WindowCommand::ToggleSides);
        assert_eq!(window.layout, before, "the legend stays hidden");
        // A panel that was opened meanwhile does not replace the others.
        window.apply(WindowCommand::ToggleSides);
        window.apply(WindowCommand::OpenPanel(Panel::Inspector));
        assert!(window.shows(Panel::Inspector) && !window.shows(Panel::Events));
        window.apply(WindowCommand::ToggleSides);
        window.apply(WindowCommand::ToggleSides);
        assert!(window.shows(Panel::Inspector) && window.shows(Panel::Events));
        assert_eq!(window.layout.hidden(), before.hidden());
        window.apply(WindowCommand::ResetLayout);
        assert_eq!(window.layout, Layout::default());
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
