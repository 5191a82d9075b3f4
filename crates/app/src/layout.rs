//! The layout of the window: which panels there are, where they stand at first, and how one comes into
//! view. Whoever shows it moves the tiles; what a panel shows is not known here.

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
    /// What happened, and the clocks.
    Timeline,
}

impl Panel {
    /// Every panel.
    pub const ALL: [Self; 13] = [
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
            Self::Timeline => "Timeline",
        }
    }
}

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
        let left = tabs(&[Panel::Parameters, Panel::Events, Panel::Bookmarks]);
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

    /// Returns whether every panel is there once, as in every layout that this program made. A remembered layout
    /// may come from another version.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        let count = |panel: Panel| {
            let panes = self.0.tiles.tiles();
            panes
                .filter(|tile| matches!(tile, Tile::Pane(pane) if *pane == panel))
                .count()
        };
        self.0.root().is_some() && Panel::ALL.into_iter().all(|panel| count(panel) == 1)
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
}
