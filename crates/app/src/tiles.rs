//! Converts between a layout and the tiles of `egui_tiles`. A panel's tile has the same number wherever it is.

use egui_tiles::{Container, Linear, LinearDir, Tabs, Tile, TileId, Tiles, Tree};

use tilescope_workbench::layout::{self, Direction, Layout, MAX_DEPTH, Panel};

/// Containers are numbered from here on; smaller numbers are panels.
const CONTAINERS: u64 = 1_000;

/// Returns the tile of a panel.
fn tile_of(panel: Panel) -> TileId {
    TileId::from_u64(1 + panel as u64)
}

/// Returns the panel of a tile, if it is a panel's.
#[must_use]
pub fn panel_of(tile: TileId) -> Option<Panel> {
    Panel::all().find(|panel| tile_of(*panel) == tile)
}

fn id() -> egui::Id {
    egui::Id::unique("layout")
}

/// Returns egui's id of a panel's tab.
#[must_use]
pub fn tab_id(panel: Panel) -> egui::Id {
    tile_of(panel).egui_id(id())
}

/// Returns the tiles of a layout.
#[must_use]
pub fn tree(layout: &Layout) -> Tree<Panel> {
    let mut maker = Maker {
        tiles: Tiles::default(),
        containers: 0,
    };
    let root = maker.insert(&layout.root);
    // A hidden panel keeps its place among the tiles, to which it comes back.
    for panel in layout.hidden().panels() {
        maker.tiles.set_visible(tile_of(panel), false);
    }
    Tree::new(id(), root, maker.tiles)
}

struct Maker {
    tiles: Tiles<Panel>,
    containers: u64,
}

impl Maker {
    /// Inserts a tile of a layout with all tiles within it, and returns its id.
    fn insert(&mut self, tile: &layout::LayoutTile) -> TileId {
        if let layout::LayoutTile::Panel(panel) = tile {
            let id = tile_of(*panel);
            self.tiles.insert(id, Tile::Pane(*panel));
            return id;
        }

        // Layouts of one shape get the same numbers, by which `with_shares_of` finds their containers.
        let id = TileId::from_u64(CONTAINERS + self.containers);
        self.containers += 1;
        let children: Vec<TileId> = tile.children().map(|tile| self.insert(tile)).collect();
        let container = match tile {
            layout::LayoutTile::Linear { axis, tiles } => {
                let dir = match axis {
                    Direction::Horizontal => LinearDir::Horizontal,
                    Direction::Vertical => LinearDir::Vertical,
                };
                let mut linear = Linear::new(dir, children.clone());
                for (child, (_, share)) in children.into_iter().zip(tiles) {
                    linear.shares.set_share(child, *share);
                }
                Container::Linear(linear)
            }
            layout::LayoutTile::Tabs { open, .. } => {
                let active = children.get(*open).copied();
                let mut tabs = Tabs::new(children);
                tabs.active = active;
                Container::Tabs(tabs)
            }
            // A panel has no container: its tile was inserted above.
            layout::LayoutTile::Panel(_) => return id,
        };

        self.tiles.insert(id, Tile::Container(container));
        id
    }
}

/// Returns the layout of these tiles, or `None` if they use a kind of container that layouts lack.
#[must_use]
pub fn layout(tree: &Tree<Panel>) -> Option<Layout> {
    let root = tile(&tree.tiles, tree.root()?, 0)?;
    let mut layout = Layout::new(root);
    let hidden = Panel::all().filter(|panel| !tree.tiles.is_visible(tile_of(*panel)));
    hidden.for_each(|panel| layout.hide(panel));
    Some(layout)
}

/// Returns the tile of a layout for the tile of this id, which lies `depth` containers below the root; `None` if
/// a layout cannot hold it.
fn tile(tiles: &Tiles<Panel>, id: TileId, depth: usize) -> Option<layout::LayoutTile> {
    // Deeper layouts would not be read back from a link or a file.
    if depth > MAX_DEPTH {
        return None;
    }

    let inner = |id: &TileId| tile(tiles, *id, depth + 1);
    Some(match tiles.get(id)? {
        Tile::Pane(panel) => layout::LayoutTile::Panel(*panel),
        Tile::Container(Container::Tabs(tabs)) => {
            let open = |id: &TileId| Some(*id) == tabs.active;
            layout::LayoutTile::Tabs {
                // Where egui has no open tab, the first one opens.
                open: tabs.children.iter().position(open).unwrap_or_default(),
                tiles: tabs.children.iter().map(inner).collect::<Option<_>>()?,
            }
        }
        Tile::Container(Container::Linear(linear)) => {
            let shared = |id: &TileId| Some((inner(id)?, linear.shares[*id]));
            layout::LayoutTile::Linear {
                axis: match linear.dir {
                    LinearDir::Horizontal => Direction::Horizontal,
                    LinearDir::Vertical => Direction::Vertical,
                },
                tiles: linear.children.iter().map(shared).collect::<Option<_>>()?,
            }
        }
        // The window makes no grids, and layouts have none.
        Tile::Container(Container::Grid(_)) => return None,
    })
}

/// Takes back what a small window did to shares: `shown` is `before` with tiles enlarged to fit, and `tree` is `shown`
/// after changes by the user. A row or column that is still as in `shown` gets its shares of `before`.
#[must_use]
pub fn with_shares_of(
    mut tree: Tree<Panel>,
    before: &Tree<Panel>,
    shown: &Tree<Panel>,
) -> Tree<Panel> {
    let ids: Vec<TileId> = tree.tiles.tile_ids().collect();
    let row_of = |tree: &Tree<Panel>, id| match tree.tiles.get(id) {
        Some(Tile::Container(Container::Linear(linear))) => Some(linear.clone()),
        _ => None,
    };
    for id in ids {
        if let (Some(row_before), Some(row_shown)) = (row_of(before, id), row_of(shown, id))
            && let Some(Tile::Container(Container::Linear(row))) = tree.tiles.get_mut(id)
            // A row that was resized differs from the one that was shown, and keeps its new shares.
            && *row == row_shown
        {
            // The rest is equal, as enlarging changes shares alone.
            *row = row_before;
        }
    }
    tree
}

#[cfg(test)]
mod tests {
    use egui::vec2;

    use super::*;

    #[test]
    fn layouts_come_back_from_tiles() {
        let mut whole = Layout::default();
        whole.open(Panel::Legend);
        assert_eq!(layout(&tree(&whole)), Some(whole.clone()));
        for panel in [Panel::Parameters, Panel::Legend, Panel::Timeline] {
            whole.hide(panel);
        }
        assert_eq!(layout(&tree(&whole)), Some(whole));
        let ids: Vec<_> = Panel::all().map(tile_of).collect();
        assert!(ids.iter().all(|id| id.0 < CONTAINERS));
        for (panel, id) in Panel::all().zip(ids) {
            assert_eq!(panel_of(id), Some(panel));
        }
    }

    #[test]
    fn enlargement_by_a_small_window_is_not_kept() {
        let whole = Layout::default();
        let mut small = whole.clone();
        small.enlarge(vec2(400.0, 300.0), [2.0, 20.0], |_| vec2(100.0, 50.0));
        assert_ne!(small, whole);
        // Panels opened there are kept.
        let mut opened = small.clone();
        opened.open(Panel::Events);
        let kept = with_shares_of(tree(&opened), &tree(&whole), &tree(&small));
        let mut expected = whole;
        expected.open(Panel::Events);
        assert_eq!(layout(&kept), Some(expected));
    }
}
