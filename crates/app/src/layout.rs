//! The layout of the window: which panels there are, where they stand at first, and how one comes into
//! view. Whoever shows it moves the tiles; what a panel shows is not known here.

use std::collections::HashSet;

use egui::{Vec2, vec2};
use egui_tiles::{Container, Linear, LinearDir, Tile, TileId, Tiles, Tree};
use serde::{Deserialize, Serialize};

/// A panel of the window. What it shows is in the registry of `panels`; all else is a row of [`ROWS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Panel {
    /// The parameters of the next run.
    Parameters,
    /// The layers and the picture.
    Canvas,
    /// What happened, and the clocks.
    Timeline,
    /// The selected sample or place and its history.
    Inspector,
    /// The listings, with breakpoints.
    Pseudocode,
    /// What each stage left behind.
    Statistics,
    /// The verdict.
    Verification,
    /// The events around the moment, and those that a query finds.
    Events,
    /// Events to come back to.
    Bookmarks,
    /// Watched expressions, and the conditions of breakpoints.
    Watches,
    /// What is measured of the moment.
    Analysis,
    /// The second run beside the first.
    Compare,
    /// The passes of the GPU.
    Passes,
    /// What symbols mean.
    Legend,
}

/// Where a panel stands at first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Slot {
    Left,
    Middle,
    /// The upper half of the right side.
    Upper,
    /// The lower half of the right side.
    Lower,
    Bottom,
}

/// What there is to know of a panel but for what it shows.
struct Row {
    panel: Panel,
    name: &'static str,
    /// Stands for it in links: the same in every version.
    letter: char,
    /// Where it stands at first, and its place among the tabs there.
    slot: (Slot, u8),
}

const fn row(panel: Panel, name: &'static str, letter: char, slot: (Slot, u8)) -> Row {
    Row {
        panel,
        name,
        letter,
        slot,
    }
}

/// Every panel, in the sequence of the enum: what is needed most comes first.
const ROWS: [Row; 14] = [
    row(Panel::Parameters, "Parameters", 'p', (Slot::Left, 0)),
    row(Panel::Canvas, "Canvas", 'c', (Slot::Middle, 0)),
    row(Panel::Timeline, "Timeline", 't', (Slot::Bottom, 0)),
    row(Panel::Inspector, "Inspector", 'i', (Slot::Lower, 1)),
    row(Panel::Pseudocode, "Pseudocode", 'l', (Slot::Upper, 0)),
    row(Panel::Statistics, "Statistics", 's', (Slot::Upper, 1)),
    row(Panel::Verification, "Verification", 'v', (Slot::Lower, 0)),
    row(Panel::Events, "Events", 'e', (Slot::Left, 1)),
    row(Panel::Bookmarks, "Bookmarks", 'b', (Slot::Left, 2)),
    row(Panel::Watches, "Watches", 'w', (Slot::Lower, 2)),
    row(Panel::Analysis, "Analysis", 'a', (Slot::Left, 3)),
    row(Panel::Compare, "Compare", 'x', (Slot::Upper, 2)),
    row(Panel::Passes, "GPU passes", 'g', (Slot::Middle, 1)),
    row(Panel::Legend, "Legend", 'k', (Slot::Lower, 3)),
];

impl Panel {
    /// Returns every panel; what is needed most comes first.
    #[must_use]
    pub fn all() -> impl DoubleEndedIterator<Item = Self> {
        ROWS.iter().map(|row| row.panel)
    }

    const fn row(self) -> &'static Row {
        &ROWS[self as usize]
    }

    /// Returns its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// Returns the letter that stands for it in links: the same in every version.
    #[must_use]
    pub const fn letter(self) -> char {
        self.row().letter
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
        let mut tabs = |slot| {
            let mut rows: Vec<&Row> = ROWS.iter().filter(|row| row.slot.0 == slot).collect();
            rows.sort_by_key(|row| row.slot.1);
            let panes = rows
                .iter()
                .map(|row| tiles.insert_pane(row.panel))
                .collect();
            tiles.insert_tab_tile(panes)
        };
        let [left, canvas, upper, lower] =
            [Slot::Left, Slot::Middle, Slot::Upper, Slot::Lower].map(&mut tabs);
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

    /// Enlarges tiles that are smaller than `least` says of their panels at the cost of the others, where `size`, between
    /// whose tiles lie `gap` and above whose tabs lies a bar of `bar`, has room for all.
    pub fn enlarge(&mut self, size: Vec2, [gap, bar]: [f32; 2], least: impl Fn(Panel) -> Vec2) {
        let Some(root) = self.0.root() else {
            return;
        };
        let room = Room { gap, bar, least };
        room.enlarge(&mut self.0.tiles, root, size);
    }

    /// Returns this layout with the shares that `before` has in rows and columns that are as in `shown`, which was made of
    /// it: what was not resized keeps its share in a window of another size.
    #[must_use]
    pub fn with_shares_of(mut self, before: &Self, shown: &Self) -> Self {
        let ids: Vec<TileId> = self.0.tiles.tile_ids().collect();
        for id in ids {
            let shares = |layout: &Self| match layout.0.tiles.get(id) {
                Some(Tile::Container(Container::Linear(linear))) => Some(linear.clone()),
                _ => None,
            };
            let (Some(old), Some(seen)) = (shares(before), shares(shown)) else {
                continue;
            };
            if let Some(Tile::Container(Container::Linear(linear))) = self.0.tiles.get_mut(id)
                && *linear == seen
            {
                *linear = old;
            }
        }
        self
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
            .is_some_and(|panels| panels.len() == ROWS.len())
    }

    /// Returns the layout with every panel in it, the missing ones as tabs, if it is sound: a remembered layout may come
    /// from a version with fewer panels, and one of a file from anywhere.
    #[must_use]
    pub fn completed(mut self) -> Option<Self> {
        let there = self.reached()?;
        let missing = Panel::all().filter(|panel| !there.contains(panel));
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

/// The room that tiles need.
struct Room<L> {
    gap: f32,
    bar: f32,
    least: L,
}

impl<L: Fn(Panel) -> Vec2> Room<L> {
    /// Returns the least size of a tile.
    fn of(&self, tiles: &Tiles<Panel>, id: TileId) -> Vec2 {
        let container = match tiles.get(id) {
            Some(Tile::Pane(panel)) => return (self.least)(*panel),
            Some(Tile::Container(container)) => container,
            None => return Vec2::ZERO,
        };
        let sizes = container.children().map(|child| self.of(tiles, *child));
        let Container::Linear(linear) = container else {
            let bar = vec2(0.0, self.bar);
            return sizes.fold(Vec2::ZERO, Vec2::max) + bar;
        };
        let axis = axis_of(linear.dir);
        let gaps = self.gap * linear.children.len().saturating_sub(1) as f32;
        let mut all = Vec2::ZERO;
        for size in sizes {
            all[1 - axis] = all[1 - axis].max(size[1 - axis]);
            all[axis] += size[axis];
        }
        all[axis] += gaps;
        all
    }

    fn enlarge(&self, tiles: &mut Tiles<Panel>, id: TileId, size: Vec2) {
        let Some(Tile::Container(container)) = tiles.get(id) else {
            return;
        };
        let children: Vec<TileId> = container.children().copied().collect();
        let Container::Linear(linear) = container else {
            let below = (size - vec2(0.0, self.bar)).max(Vec2::ZERO);
            for child in children {
                self.enlarge(tiles, child, below);
            }
            return;
        };
        let axis = axis_of(linear.dir);
        let gaps = self.gap * children.len().saturating_sub(1) as f32;
        let room = (size[axis] - gaps).max(0.0);
        let lengths = linear.shares.split(&children, room);
        let least: Vec<f32> = children
            .iter()
            .map(|&child| self.of(tiles, child)[axis])
            .collect();
        let enlarged = enlarged(&lengths, &least);
        if enlarged != lengths
            && let Some(Tile::Container(Container::Linear(linear))) = tiles.get_mut(id)
        {
            let total: f32 = children.iter().map(|&child| linear.shares[child]).sum();
            for (&child, length) in children.iter().zip(&enlarged) {
                linear.shares.set_share(child, total * length / room);
            }
        }
        for (child, length) in children.into_iter().zip(enlarged) {
            let mut inner = size;
            inner[axis] = length;
            self.enlarge(tiles, child, inner);
        }
    }
}

const fn axis_of(dir: LinearDir) -> usize {
    match dir {
        LinearDir::Horizontal => 0,
        LinearDir::Vertical => 1,
    }
}

/// Returns lengths of the same sum that are no smaller than `least`, those that are larger in the same proportions; the
/// lengths themselves where there is no room for it.
fn enlarged(lengths: &[f32], least: &[f32]) -> Vec<f32> {
    let (room, needed) = (lengths.iter().sum::<f32>(), least.iter().sum::<f32>());
    if needed > room
        || lengths
            .iter()
            .zip(least)
            .all(|(length, least)| length >= least)
    {
        return lengths.to_vec();
    }
    let mut is_small = vec![false; lengths.len()];
    loop {
        let sum = |of: &[f32], small: bool| -> f32 {
            let parts = of.iter().zip(&is_small);
            parts
                .filter(|(_, is)| **is == small)
                .map(|(part, _)| *part)
                .sum()
        };
        let left = room - sum(least, true);
        let shared = sum(lengths, false).max(f32::MIN_POSITIVE);
        let at = |k: usize| {
            if is_small[k] {
                least[k]
            } else {
                lengths[k] * left / shared
            }
        };
        let found: Vec<f32> = (0..lengths.len()).map(at).collect();
        // Of many that share what is left, another may now be too small.
        let Some(small) = (0..found.len()).find(|&k| !is_small[k] && found[k] < least[k]) else {
            return found;
        };
        is_small[small] = true;
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
    fn every_panel_has_one_row_one_letter_and_a_place_of_its_own() {
        for (place, row) in ROWS.iter().enumerate() {
            assert_eq!(row.panel as usize, place, "{}", row.name);
        }
        let letters: HashSet<char> = ROWS.iter().map(|row| row.letter).collect();
        assert_eq!(letters.len(), ROWS.len());
        let mut places: Vec<_> = ROWS
            .iter()
            .map(|row| (row.slot.0 as u8, row.slot.1))
            .collect();
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), ROWS.len());
    }

    #[test]
    fn every_panel_can_be_brought_into_view() {
        let mut layout = Layout::default();
        assert!(layout.is_whole());
        for panel in Panel::all() {
            layout.open(panel);
            assert!(layout.shows(panel), "{panel:?}");
        }
        assert!(!layout.shows(Panel::Parameters));
    }

    #[test]
    fn small_tiles_are_enlarged_at_the_cost_of_large_ones() {
        let same = [30.0, 60.0, 10.0];
        assert_eq!(enlarged(&same, &[30.0, 10.0, 10.0]), same);
        assert_eq!(enlarged(&same, &[0.0, 0.0, 28.0]), [24.0, 48.0, 28.0]);
        // One of those that give becomes too small itself.
        assert_eq!(enlarged(&same, &[29.0, 0.0, 40.0]), [29.0, 31.0, 40.0]);
        assert_eq!(enlarged(&[0.0, 100.0], &[25.0, 25.0]), [25.0, 75.0]);
        // There is no room for all.
        assert_eq!(enlarged(&same, &[50.0, 50.0, 50.0]), same);
    }

    #[test]
    fn a_window_of_any_size_shows_the_layout_that_it_has_room_for() {
        let least = |_| vec2(100.0, 50.0);
        let enlarge = |size| {
            let mut layout = Layout::default();
            layout.enlarge(size, [2.0, 20.0], least);
            layout
        };
        let whole = Layout::default();
        assert_eq!(enlarge(vec2(2_000.0, 1_500.0)), whole);
        // No tile has a size without room.
        assert_eq!(enlarge(Vec2::ZERO), whole);
        let small = enlarge(vec2(400.0, 300.0));
        assert_ne!(small, whole);
        // What was enlarged for a small window alone is not kept, and what was opened there is.
        let mut opened = small.clone();
        opened.open(Panel::Events);
        let kept = opened.with_shares_of(&whole, &small);
        assert!(kept.shows(Panel::Events));
        let mut expected = whole.clone();
        expected.open(Panel::Events);
        assert_eq!(kept, expected);
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
        for panel in Panel::all() {
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
