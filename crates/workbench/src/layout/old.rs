//! Reads layouts as earlier versions saved them: a table of tiles by number, each naming its children.

use std::collections::HashMap;

use serde::Deserialize;

use super::{Direction, Layout, LayoutTile, MAX_DEPTH, MAX_TILES, Panel};

/// A layout as earlier versions saved it. Other saved fields are ignored.
#[derive(Deserialize)]
pub struct OldLayout(Tree);

#[derive(Deserialize)]
struct Tree {
    root: Option<Id>,
    tiles: Tiles,
}

#[derive(Clone, Copy, PartialEq, Eq, Hash, Deserialize)]
struct Id(u64);

#[derive(Deserialize)]
struct Tiles {
    tiles: HashMap<Id, Saved>,
}

#[derive(Deserialize)]
enum Saved {
    Pane(Panel),
    Container(Container),
}

#[derive(Deserialize)]
enum Container {
    Tabs(Tabs),
    Linear(Linear),
}

#[derive(Deserialize)]
struct Tabs {
    children: Vec<Id>,
    active: Option<Id>,
}

#[derive(Deserialize)]
struct Linear {
    children: Vec<Id>,
    dir: Direction,
    shares: Shares,
}

#[derive(Deserialize)]
struct Shares {
    shares: HashMap<Id, f32>,
}

impl OldLayout {
    /// Returns the layout with all panels, if it is valid.
    #[must_use]
    pub fn completed(self) -> Option<Layout> {
        let mut left = MAX_TILES;
        let tree = self.0;
        let root = tree.tile(tree.root?, 0, &mut left)?;
        Layout::new(root).completed()
    }
}

impl Tree {
    /// Returns the tile of an id; `None` if a tile is missing, or they are too many or nested too deeply.
    fn tile(&self, id: Id, depth: usize, left: &mut usize) -> Option<LayoutTile> {
        *left = left.checked_sub(1)?;
        if depth > MAX_DEPTH {
            return None;
        }
        let mut tile = |id: &Id| self.tile(*id, depth + 1, left);
        Some(match self.tiles.tiles.get(&id)? {
            Saved::Pane(panel) => LayoutTile::Panel(*panel),
            Saved::Container(Container::Tabs(tabs)) => LayoutTile::Tabs {
                tiles: tabs.children.iter().map(tile).collect::<Option<_>>()?,
                open: {
                    let is_open = |id: &Id| Some(*id) == tabs.active;
                    tabs.children.iter().position(is_open).unwrap_or_default()
                },
            },
            Saved::Container(Container::Linear(linear)) => LayoutTile::Linear {
                axis: linear.dir,
                tiles: {
                    let share = |id| linear.shares.shares.get(id).copied().unwrap_or(1.0);
                    let tiles = linear
                        .children
                        .iter()
                        .map(|id| Some((tile(id)?, share(id))));
                    tiles.collect::<Option<_>>()?
                },
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    /// Returns the layout of a new window of an earlier version, with the events opened.
    fn saved() -> Value {
        serde_json::from_str(include_str!("old.json")).unwrap()
    }

    fn read(value: Value) -> Option<Layout> {
        serde_json::from_value::<OldLayout>(value).ok()?.completed()
    }

    #[test]
    fn a_layout_of_an_earlier_version_is_read() {
        let mut expected = Layout::default();
        expected.open(Panel::Events);
        assert_eq!(read(saved()), Some(expected));
    }

    #[test]
    fn cyclic_and_incomplete_layouts_are_rejected() {
        for (extra, why) in [
            (21, "in itself"),
            (5, "in two places"),
            (987_654, "not there"),
        ] {
            let mut value = saved();
            let root = &mut value["tiles"]["tiles"]["21"]["Container"]["Linear"];
            root["children"][1] = json!(extra);
            assert_eq!(read(value), None, "{why}");
        }
        let mut value = saved();
        value["tiles"]["tiles"]["20"]["Container"]["Linear"]["shares"]["shares"]["5"] = json!(-1.0);
        assert_eq!(read(value), None, "a negative share");
    }
}
