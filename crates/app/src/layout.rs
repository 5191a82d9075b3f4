//! The layout of the window: which panels there are, where they stand at first, and how one comes into
//! view. Whoever shows it moves the tiles; what a panel shows is not known here.

use std::collections::HashSet;

use egui_tiles::{Container, Linear, LinearDir, Tile, TileId, Tiles, Tree};
use serde::{Deserialize, Serialize};

/// A panel of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Panel {
    /// The parameters of the next run.
    Parameters,
    /// What each stage left behind.
    Statistics,
    /// The events around the moment, and those that a query finds.
    Events,
    /// Events to come back to.
    Bookmarks,
    /// The layers and the picture.
    Canvas,
    /// The listings, with breakpoints.
    Pseudocode,
    /// The selected sample or place and its history.
    Inspector,
    /// Watched expressions, and the conditions of breakpoints.
    Watches,
    /// The verdict.
    Verification,
    /// What symbols mean.
    Legend,
    /// The passes of the GPU.
    Passes,
    /// The second run beside the first.
    Compare,
    /// What is measured of the moment.
    Analysis,
    /// What happened, and the clocks.
    Timeline,
}

impl Panel {
    /// Every panel.
    pub const ALL: [Self; 14] = [
        Self::Parameters,
        Self::Statistics,
        Self::Events,
        Self::Bookmarks,
        Self::Canvas,
        Self::Pseudocode,
        Self::Inspector,
        Self::Watches,
        Self::Verification,
        Self::Legend,
        Self::Passes,
        Self::Compare,
        Self::Analysis,
        Self::Timeline,
    ];

    /// Returns its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Parameters => "Parameters",
            Self::Statistics => "Statistics",
            Self::Events => "Events",
            Self::Bookmarks => "Bookmarks",
            Self::Canvas => "Canvas",
            Self::Pseudocode => "Pseudocode",
            Self::Inspector => "Inspector",
            Self::Watches => "Watches",
            Self::Verification => "Verification",
            Self::Legend => "Legend",
            Self::Passes => "GPU passes",
            Self::Compare => "Compare",
            Self::Analysis => "Analysis",
            Self::Timeline => "Timeline",
        }
    }
}

/// Panels that a layout lacks stand beside this one.
const NEIGHBOUR: Panel = Panel::Parameters;
/// More tiles than this no layout of this program has.
const MOST_TILES: usize = 200;

/// Where the panels stand.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Layout(pub Tree<Panel>);

impl Default for Layout {
    fn default() -> Self {
        let mut tiles = Tiles::default();
        let mut tabs = |panels: &[Panel]| {
            let panes = panels
                .iter()
                .map(|&panel| tiles.insert_pane(panel))
                .collect();
            tiles.insert_tab_tile(panes)
        };
        let left = tabs(&[
            Panel::Parameters,
            Panel::Events,
            Panel::Bookmarks,
            Panel::Analysis,
        ]);
        let canvas = tabs(&[Panel::Canvas, Panel::Passes]);
        let upper = tabs(&[Panel::Pseudocode, Panel::Statistics, Panel::Compare]);
        let lower = tabs(&[
            Panel::Verification,
            Panel::Inspector,
            Panel::Watches,
            Panel::Legend,
        ]);
        let timeline = tiles.insert_pane(Panel::Timeline);
        let right = linear(
            &mut tiles,
            LinearDir::Vertical,
            &[(upper, 0.44), (lower, 0.56)],
        );
        let middle = [(left, 0.195), (canvas, 0.605), (right, 0.2)];
        let middle = linear(&mut tiles, LinearDir::Horizontal, &middle);
        let rows = [(middle, 0.874), (timeline, 0.126)];
        let root = linear(&mut tiles, LinearDir::Vertical, &rows);
        Self(Tree::new(egui::Id::unique("layout"), root, tiles))
    }
}

impl Layout {
    /// Returns whether the panel can be seen: it is there, and its tab is the open one.
    #[must_use]
    pub fn shows(&self, panel: Panel) -> bool {
        let Some(tile) = self.0.tiles.find_pane(&panel) else {
            return false;
        };
        self.0.active_tiles().contains(&tile)
    }

    /// Brings a panel into view.
    pub fn open(&mut self, panel: Panel) {
        self.0
            .make_active(|_, tile| matches!(tile, Tile::Pane(pane) if *pane == panel));
    }

    /// Returns whether every panel can be reached once, as in every layout that this program made.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.reached()
            .is_some_and(|panels| panels.len() == Panel::ALL.len())
    }

    /// Returns the layout with every panel in it, the missing ones as tabs, if it is sound: a remembered layout may come
    /// from a version with fewer panels, and one of a file from anywhere.
    #[must_use]
    pub fn completed(mut self) -> Option<Self> {
        let there = self.reached()?;
        let missing = Panel::ALL
            .into_iter()
            .filter(|panel| !there.contains(panel));
        for panel in missing {
            let tabs = self.tabs_of(NEIGHBOUR)?;
            let pane = self.0.tiles.insert_pane(panel);
            if let Some(Tile::Container(Container::Tabs(tabs))) = self.0.tiles.get_mut(tabs) {
                tabs.add_child(pane);
            }
        }
        self.is_whole().then_some(self)
    }

    /// Returns the tabs that hold a panel, else any tabs that can be reached.
    fn tabs_of(&self, panel: Panel) -> Option<TileId> {
        let tiles = &self.0.tiles;
        let is_tabs = |id: &TileId| {
            let tile = tiles.get(*id);
            matches!(tile, Some(Tile::Container(Container::Tabs(_))))
        };
        let pane = tiles.find_pane(&panel);
        let around = pane.and_then(|pane| tiles.parent_of(pane));
        around.filter(is_tabs).or_else(|| {
            let reached = self.0.active_tiles();
            reached.into_iter().find(is_tabs)
        })
    }

    /// Returns the panels that can be reached; none if the tiles are not sound or a panel is there twice.
    fn reached(&self) -> Option<Vec<Panel>> {
        let tiles = &self.0.tiles;
        let (Some(root), true) = (self.0.root(), tiles.iter().count() <= MOST_TILES) else {
            return None;
        };
        let mut seen = HashSet::new();
        let mut panels = Vec::new();
        let mut waiting = vec![root];
        while let Some(id) = waiting.pop() {
            // A tile that is reached twice is in two places, or in itself.
            if !seen.insert(id) {
                return None;
            }
            match tiles.get(id) {
                Some(Tile::Pane(panel)) => panels.push(*panel),
                Some(Tile::Container(container)) => {
                    if !has_sound_shares(container) {
                        return None;
                    }
                    waiting.extend(container.children().copied());
                }
                None => return None,
            }
        }
        let kinds: HashSet<Panel> = panels.iter().copied().collect();
        (kinds.len() == panels.len()).then_some(panels)
    }
}

/// Returns whether the shares of a row or column can be divided by.
fn has_sound_shares(container: &Container) -> bool {
    let sound = |share: f32| share.is_finite() && share >= 0.0;
    match container {
        Container::Linear(linear) => linear.shares.iter().all(|(_, &share)| sound(share)),
        Container::Grid(grid) => {
            let shares = grid.col_shares.iter().chain(&grid.row_shares);
            shares.into_iter().all(|&share| sound(share))
        }
        Container::Tabs(_) => true,
    }
}

fn linear(tiles: &mut Tiles<Panel>, dir: LinearDir, shares: &[(TileId, f32)]) -> TileId {
    let mut linear = Linear::new(dir, shares.iter().map(|(tile, _)| *tile).collect());
    for &(tile, share) in shares {
        linear.shares.set_share(tile, share);
    }
    tiles.insert_container(Container::Linear(linear))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_panel_can_be_brought_into_view() {
        let mut layout = Layout::default();
        assert!(layout.is_whole());
        for panel in Panel::ALL {
            layout.open(panel);
            assert!(layout.shows(panel), "{panel:?}");
        }
        assert!(!layout.shows(Panel::Parameters));
    }

    #[test]
    fn a_layout_is_remembered_and_a_broken_one_is_known() {
        let mut layout = Layout::default();
        layout.open(Panel::Events);
        let text = serde_json::to_string(&layout).unwrap();
        assert_eq!(serde_json::from_str::<Layout>(&text).unwrap(), layout);
        let tile = layout.0.tiles.find_pane(&Panel::Canvas).unwrap();
        layout.0.remove_recursively(tile);
        assert!(!layout.is_whole());
    }

    #[test]
    fn a_layout_of_a_version_with_fewer_panels_gets_the_new_ones() {
        let mut old = Layout::default();
        old.open(Panel::Events);
        for panel in [Panel::Analysis, Panel::Parameters] {
            let tile = old.0.tiles.find_pane(&panel).unwrap();
            old.0.remove_recursively(tile);
        }
        assert!(!old.is_whole());
        let mut new = old.completed().unwrap();
        assert!(new.is_whole() && new.shows(Panel::Events));
        for panel in Panel::ALL {
            new.open(panel);
            assert!(new.shows(panel), "{panel:?}");
        }
        let whole = Layout::default();
        assert_eq!(whole.clone().completed(), Some(whole.clone()));
        // A single panel has nowhere to put others.
        let id = egui::Id::unique("one");
        let mut tiles = Tiles::default();
        let root = tiles.insert_pane(Panel::Canvas);
        assert_eq!(Layout(Tree::new(id, root, tiles)).completed(), None);
        // Twice the same is no layout of any version.
        let mut twice = whole;
        let tabs = twice.tabs_of(Panel::Events).unwrap();
        let pane = twice.0.tiles.insert_pane(Panel::Canvas);
        if let Some(Tile::Container(Container::Tabs(tabs))) = twice.0.tiles.get_mut(tabs) {
            tabs.add_child(pane);
        }
        assert_eq!(twice.completed(), None);
    }

    #[test]
    fn layouts_that_hold_themselves_or_lack_what_they_name_are_known() {
        let whole = Layout::default();
        let root = whole.0.root().unwrap();
        let children = |layout: &Layout| -> Vec<TileId> {
            match layout.0.tiles.get(layout.0.root().unwrap()) {
                Some(Tile::Container(container)) => container.children().copied().collect(),
                _ => Vec::new(),
            }
        };
        let with = |extra: TileId| {
            let mut layout = whole.clone();
            if let Some(Tile::Container(Container::Linear(linear))) = layout.0.tiles.get_mut(root) {
                linear.children.push(extra);
            }
            layout
        };
        assert!(!with(root).is_whole(), "in itself");
        assert!(!with(children(&whole)[0]).is_whole(), "in two places");
        assert!(!with(TileId::from_u64(987_654)).is_whole(), "not there");
        let mut broken = whole.clone();
        if let Some(Tile::Container(Container::Linear(linear))) = broken.0.tiles.get_mut(root) {
            linear.shares.set_share(root, f32::NAN);
        }
        assert!(!broken.is_whole(), "no share");
        assert!(whole.is_whole());
    }
}
