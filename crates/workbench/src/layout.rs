//! The layout of the window as data: the panels, their default positions, and how a panel is brought into view. Begin with
//! [`Layout`]. `tilescope-app` shows it as tiles that can be dragged, and draws the panels.
//!
//! [`mod@text`] writes a layout as a short text, for links and files.

use emath::{Vec2, vec2};
use serde::{Deserialize, Serialize};

pub mod text;

/// A default position in the window.
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

/// Everything about a panel except its content.
struct PanelRow {
    panel: Panel,
    name: &'static str,
    letter: char,
    key: &'static str,
    slot: Slot,
    tab: u8,
}

/// Gives a macro the table of all panels, the most useful first. A row says what the panel shows, and has its variant of
/// [`Panel`]; its file in `app/src/panels`, whose `CONTENT` shows it; its name; its letter in links, the same in every
/// version; the digit of its key, empty if it has none; its default position, and its index among the tabs there.
#[macro_export]
macro_rules! for_panels {
    ($receive:ident) => {
        $receive! {
            "The parameters of the next run." Parameters parameters "Parameters" 'p' "1" Left 0;
            "The layers and the picture." Canvas layers "Canvas" 'c' "" Middle 0;
            "The last event, and the playback controls." Timeline timeline "Timeline" 't' "" Bottom 0;
            "The selected sample or place and its history." Inspector inspector "Inspector" 'i' "2" Lower 1;
            "The listings, with breakpoints." Pseudocode pseudocode "Pseudocode" 'l' "3" Upper 0;
            "The statistics of each stage." Statistics stages "Statistics" 's' "4" Upper 1;
            "The verdict." Verification verification "Verification" 'v' "5" Lower 0;
            "The events around the moment, and those that a query finds." Events events "Events" 'e' "6" Left 1;
            "Scenes, and breakpoints." Scenes scenes "Scenes" 'b' "7" Left 2;
            "Watched expressions, and the conditions of breakpoints." Watches watches "Watches" 'w' "8" Lower 2;
            "The measures of the moment." Analysis analysis "Analysis" 'a' "" Left 3;
            "The second run beside the first." Compare compare "Compare" 'x' "9" Upper 2;
            "The passes of the GPU." Passes passes "GPU passes" 'g' "" Middle 1;
            "The meaning of the symbols." Legend legend "Legend" 'k' "0" Lower 3;
        }
    };
}

macro_rules! declare {
    ($($shows:literal $panel:ident $file:ident $name:literal $letter:literal $key:literal $slot:ident $tab:literal;)*) => {
        /// A panel of the window. The table [`for_panels`](crate::for_panels) has everything about it but its content.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum Panel {
            $(#[doc = $shows] $panel,)*
        }

        /// Every panel, in the order of the enum.
        const ROWS: &[PanelRow] = &[$(PanelRow {
            panel: Panel::$panel,
            name: $name,
            letter: $letter,
            key: $key,
            slot: Slot::$slot,
            tab: $tab,
        },)*];
    };
}

for_panels!(declare);

impl Panel {
    /// Returns every panel, the most useful first.
    #[must_use]
    pub fn all() -> impl DoubleEndedIterator<Item = Self> {
        ROWS.iter().map(|row| row.panel)
    }

    const fn bit(self) -> u32 {
        1 << self as u32
    }

    const fn row(self) -> &'static PanelRow {
        &ROWS[self as usize]
    }

    /// Returns the name, as tabs and menus show it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// Returns its letter in links; the same in every version.
    #[must_use]
    pub const fn letter(self) -> char {
        self.row().letter
    }

    /// Returns the digit that brings it into view; empty if none does.
    #[must_use]
    pub const fn key(self) -> &'static str {
        self.row().key
    }
}

/// Panels missing from a layout are added beside this one.
const NEIGHBOUR: Panel = Panel::Parameters;
/// The deepest nesting of tiles that is read; layouts of this program are shallower.
pub const MAX_DEPTH: usize = 24;
/// The most tiles that are read; layouts of this program have fewer.
pub const MAX_TILES: usize = 100;

/// The direction in which the tiles of a container are arranged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Side by side, from left to right.
    Horizontal,
    /// One above the other.
    Vertical,
}

/// A part of the window.
#[derive(Clone, Debug, PartialEq)]
pub enum LayoutTile {
    /// A panel, which has no tiles inside.
    Panel(Panel),
    /// Tiles in the same place, one of them visible.
    Tabs {
        /// The tiles, in the order of their tabs.
        tiles: Vec<LayoutTile>,
        /// The index of the visible one.
        open: usize,
    },
    /// Tiles that divide the room in proportion to their shares.
    Linear {
        /// The direction in which the tiles follow each other.
        axis: Direction,
        /// The tiles and their shares, which are finite and not negative.
        tiles: Vec<(LayoutTile, f32)>,
    },
}

impl LayoutTile {
    /// Returns the direct children.
    pub fn children(&self) -> impl Iterator<Item = &Self> {
        let (tabs, linear): (&[Self], &[(Self, f32)]) = match self {
            Self::Panel(_) => (&[], &[]),
            Self::Tabs { tiles, .. } => (tiles, &[]),
            Self::Linear { tiles, .. } => (&[], tiles),
        };
        tabs.iter().chain(linear.iter().map(|(tile, _)| tile))
    }

    fn children_mut(&mut self) -> impl Iterator<Item = &mut Self> {
        let (tabs, linear): (&mut [Self], &mut [(Self, f32)]) = match self {
            Self::Panel(_) => (&mut [], &mut []),
            Self::Tabs { tiles, .. } => (tiles, &mut []),
            Self::Linear { tiles, .. } => (&mut [], tiles),
        };
        tabs.iter_mut()
            .chain(linear.iter_mut().map(|(tile, _)| tile))
    }

    /// Adds the panels inside to a bit set; `None` if one is in it already.
    fn add_panels(&self, set: u32) -> Option<u32> {
        match self {
            Self::Panel(panel) => (set & panel.bit() == 0).then_some(set | panel.bit()),
            _ => self
                .children()
                .try_fold(set, |set, tile| tile.add_panels(set)),
        }
    }

    /// Returns whether all panels inside are hidden.
    fn is_hidden(&self, hidden: PanelSet) -> bool {
        match self {
            Self::Panel(panel) => hidden.has(*panel),
            _ => self.children().all(|tile| tile.is_hidden(hidden)),
        }
    }

    /// Opens another tab wherever the open one is hidden: the next one to the left, or else to the right. Where all tabs are hidden,
    /// the open one stays.
    fn leave(&mut self, hidden: PanelSet) {
        if let Self::Tabs { tiles, open } = self
            && tiles.get(*open).is_some_and(|tile| tile.is_hidden(hidden))
        {
            let seen = |index: &usize| !tiles[*index].is_hidden(hidden);
            let near = (0..*open).rev().chain(*open..tiles.len()).find(seen);
            *open = near.unwrap_or(*open);
        }
        for tile in self.children_mut() {
            tile.leave(hidden);
        }
    }

    fn has(&self, panel: Panel) -> bool {
        match self {
            Self::Panel(own) => *own == panel,
            _ => self.children().any(|tile| tile.has(panel)),
        }
    }

    fn shows(&self, panel: Panel) -> bool {
        match self {
            Self::Panel(own) => *own == panel,
            Self::Tabs { tiles, open } => tiles.get(*open).is_some_and(|tile| tile.shows(panel)),
            Self::Linear { tiles, .. } => tiles.iter().any(|(tile, _)| tile.shows(panel)),
        }
    }

    fn open(&mut self, panel: Panel) {
        if let Self::Tabs { tiles, open } = self
            && let Some(index) = tiles.iter().position(|tile| tile.has(panel))
        {
            *open = index;
        }
        for tile in self.children_mut() {
            tile.open(panel);
        }
    }

    /// Returns the tabs that directly contain a panel, to be changed; `None` if it stands in a row or a column, or
    /// nowhere.
    fn tabs_around(&mut self, panel: Panel) -> Option<&mut Vec<Self>> {
        let is_here = self.children().any(|tile| *tile == Self::Panel(panel));
        match self {
            Self::Panel(_) => None,
            Self::Tabs { tiles, .. } => {
                if is_here {
                    return Some(tiles);
                }
                tiles.iter_mut().find_map(|tile| tile.tabs_around(panel))
            }
            Self::Linear { tiles, .. } => {
                let mut tiles = tiles.iter_mut();
                tiles.find_map(|(tile, _)| tile.tabs_around(panel))
            }
        }
    }

    /// Returns the tabs that directly contain a panel.
    fn tabs_with(&self, panel: Panel) -> Option<&[Self]> {
        match self {
            Self::Tabs { tiles, .. } if tiles.contains(&Self::Panel(panel)) => Some(tiles),
            _ => self.children().find_map(|tile| tile.tabs_with(panel)),
        }
    }

    /// Returns the first visible tabs.
    fn seen_tabs(&mut self) -> Option<&mut Vec<Self>> {
        match self {
            Self::Panel(_) => None,
            Self::Tabs { tiles, .. } => Some(tiles),
            Self::Linear { tiles, .. } => tiles.iter_mut().find_map(|(tile, _)| tile.seen_tabs()),
        }
    }

    /// Returns the tile without empty containers.
    fn pruned(self) -> Option<Self> {
        match self {
            Self::Panel(_) => Some(self),
            Self::Tabs { tiles, open } => {
                // Tabs before the open one may go, so that its index moves.
                let before = tiles.iter().take(open);
                let empty = before.filter(|tile| (*tile).clone().pruned().is_none());
                let open = open - empty.count();
                let tiles: Vec<Self> = tiles.into_iter().filter_map(Self::pruned).collect();
                // The open tab may have gone itself, as the last one.
                let open = open.min(tiles.len().saturating_sub(1));
                (!tiles.is_empty()).then_some(Self::Tabs { tiles, open })
            }
            Self::Linear { axis, tiles } => {
                let kept = |(tile, share): (Self, f32)| Some((tile.pruned()?, share));
                let tiles: Vec<(Self, f32)> = tiles.into_iter().filter_map(kept).collect();
                (!tiles.is_empty()).then_some(Self::Linear { axis, tiles })
            }
        }
    }

    /// Returns whether a tile and all tiles in it have an open tab that is there, and shares that are numbers from 0 on.
    fn is_sound(&self) -> bool {
        let of_itself = match self {
            Self::Panel(_) => true,
            // Tabs may be empty, with 0 as the open one; `pruned` removes them.
            Self::Tabs { tiles, open } => *open < tiles.len().max(1),
            Self::Linear { tiles, .. } => {
                let sound = |share: f32| share.is_finite() && share >= 0.0;
                !tiles.is_empty() && tiles.iter().all(|(_, share)| sound(*share))
            }
        };
        of_itself && self.children().all(Self::is_sound)
    }
}

/// A set of panels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PanelSet(u32);

impl PanelSet {
    /// Returns whether a panel is in the set.
    #[must_use]
    pub const fn has(self, panel: Panel) -> bool {
        self.0 & panel.bit() != 0
    }

    /// Returns whether the set is empty.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Adds a panel, which may be in the set already.
    pub const fn insert(&mut self, panel: Panel) {
        self.0 |= panel.bit();
    }

    /// Removes a panel, if it is in the set.
    pub const fn remove(&mut self, panel: Panel) {
        self.0 &= !panel.bit();
    }

    /// Returns the panels in the set, the most useful first.
    pub fn panels(self) -> impl Iterator<Item = Panel> {
        Panel::all().filter(move |panel| self.has(*panel))
    }
}

impl FromIterator<Panel> for PanelSet {
    fn from_iter<I: IntoIterator<Item = Panel>>(panels: I) -> Self {
        let mut set = Self::default();
        panels.into_iter().for_each(|panel| set.insert(panel));
        set
    }
}

/// The layout of the panels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Layout {
    /// The tile that fills the window. It contains hidden panels, too, so that they come back at the same position.
    pub root: LayoutTile,
    /// The panels that are hidden; never the canvas.
    hidden: PanelSet,
}

impl Default for Layout {
    fn default() -> Self {
        let tabs = |slot| {
            let mut rows: Vec<&PanelRow> = ROWS.iter().filter(|row| row.slot == slot).collect();
            // The table is in the sequence of use, not of tabs.
            rows.sort_by_key(|row| row.tab);
            let panels = rows.iter().map(|row| LayoutTile::Panel(row.panel));
            let tiles = panels.collect();
            LayoutTile::Tabs { tiles, open: 0 }
        };

        let linear = |axis, tiles| LayoutTile::Linear { axis, tiles };

        // The shares of the tiles of a row or a column add up to 1. They were chosen, not measured.
        let right = vec![(tabs(Slot::Upper), 0.44), (tabs(Slot::Lower), 0.56)];
        let middle = vec![
            (tabs(Slot::Left), 0.195),
            (tabs(Slot::Middle), 0.605),
            (linear(Direction::Vertical, right), 0.2),
        ];
        // The timeline is the only panel at the bottom, and needs no tabs.
        let rows = vec![
            (linear(Direction::Horizontal, middle), 0.874),
            (LayoutTile::Panel(Panel::Timeline), 0.126),
        ];
        Self::new(linear(Direction::Vertical, rows))
    }
}

impl Layout {
    /// Returns a layout without hidden panels.
    #[must_use]
    pub fn new(root: LayoutTile) -> Self {
        let hidden = PanelSet::default();
        Self { root, hidden }
    }

    /// Returns a layout of this panel alone.
    #[must_use]
    pub fn alone(panel: Panel) -> Self {
        Self::new(LayoutTile::Tabs {
            tiles: vec![LayoutTile::Panel(panel)],
            open: 0,
        })
    }

    /// Returns whether the panel is visible: it exists, it is not hidden, and its tab is open.
    #[must_use]
    pub fn shows(&self, panel: Panel) -> bool {
        !self.hidden.has(panel) && self.root.shows(panel)
    }

    /// Returns the hidden panels.
    #[must_use]
    pub const fn hidden(&self) -> PanelSet {
        self.hidden
    }

    /// Hides a panel; it keeps its position. The canvas stays.
    pub fn hide(&mut self, panel: Panel) {
        if panel != Panel::Canvas {
            self.hidden.insert(panel);
            self.root.leave(self.hidden);
        }
    }

    /// Ends hiding these panels, without opening their tabs.
    pub(crate) fn show_all(&mut self, panels: PanelSet) {
        panels.panels().for_each(|panel| self.hidden.remove(panel));
        self.root.leave(self.hidden);
    }

    /// Returns the panels in the columns beside the canvas: all but the timeline and those that share the canvas's tabs.
    #[must_use]
    pub fn sides(&self) -> PanelSet {
        let middle = self.root.tabs_with(Panel::Canvas);
        let is_side = |panel: &Panel| {
            let shares = middle.is_some_and(|tabs| tabs.iter().any(|tile| tile.has(*panel)));
            !shares && ![Panel::Canvas, Panel::Timeline].contains(panel) && self.root.has(*panel)
        };
        Panel::all().filter(is_side).collect()
    }

    /// Enlarges tiles that are smaller than `least` requires for their panels, at the cost of the others, if
    /// `size` has room for all. `gap` is the space between tiles, `bar` the height of the tabs' bar.
    pub fn enlarge(&mut self, size: Vec2, [gap, bar]: [f32; 2], least: impl Fn(Panel) -> Vec2) {
        let hidden = self.hidden;
        let room = Room {
            gap,
            bar,
            least,
            hidden,
        };
        room.enlarge(&mut self.root, size);
    }

    /// Brings a panel into view, also if it was hidden.
    pub fn open(&mut self, panel: Panel) {
        self.hidden.remove(panel);
        self.root.open(panel);
    }

    /// Returns whether every panel occurs once, visible or hidden, as in every layout of this program.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        let all = Panel::all().fold(0, |set, panel| set | panel.bit());
        self.root.add_panels(0) == Some(all)
    }

    /// Returns the layout completed with missing panels as tabs, or `None` if it is not valid: a saved layout may be of
    /// a version with fewer panels, or come from anywhere.
    #[must_use]
    pub fn completed(mut self) -> Option<Self> {
        if !self.root.is_sound() {
            return None;
        }
        self.root = self.root.pruned()?;
        // A layout in which a panel occurs twice is not valid, and has no set of panels.
        let there = self.root.add_panels(0)?;

        for panel in Panel::all().filter(|panel| there & panel.bit() == 0) {
            // The neighbour may stand in no tabs. Then the first visible ones take the panel. A layout without tabs has no place for it,
            // and is not valid.
            let tabs = if self.root.tabs_with(NEIGHBOUR).is_some() {
                self.root.tabs_around(NEIGHBOUR)
            } else {
                self.root.seen_tabs()
            };
            tabs?.push(LayoutTile::Panel(panel));
        }
        Some(self)
    }
}

/// Computes the room that tiles need.
struct Room<L> {
    /// The space between two tiles.
    gap: f32,
    /// The height of the bar of tabs.
    bar: f32,
    /// Returns the least size of a panel.
    least: L,
    /// The panels that take no room.
    hidden: PanelSet,
}

impl<L: Fn(Panel) -> Vec2> Room<L> {
    /// Returns the smallest size of a tile, which has room for all panels in it that are not hidden.
    fn least_size(&self, tile: &LayoutTile) -> Vec2 {
        if tile.is_hidden(self.hidden) {
            return Vec2::ZERO;
        }

        match tile {
            LayoutTile::Panel(panel) => (self.least)(*panel),
            LayoutTile::Tabs { tiles, .. } => {
                // Any of the tabs can be opened, so that the largest one counts.
                let sizes = tiles.iter().map(|tile| self.least_size(tile));
                sizes.fold(Vec2::ZERO, Vec2::max) + vec2(0.0, self.bar)
            }
            LayoutTile::Linear { axis, tiles } => {
                let (along, across) = (axis.index(), 1 - axis.index());
                let (mut total, mut count) = (Vec2::ZERO, 0);
                for (tile, _) in tiles {
                    let size = self.least_size(tile);
                    total[across] = total[across].max(size[across]);
                    total[along] += size[along];
                    // A hidden tile takes no room, and has no gap either.
                    count += usize::from(!tile.is_hidden(self.hidden));
                }

                total[along] += self.gaps(count);
                total
            }
        }
    }

    /// Returns the length of all gaps between the given number of tiles.
    fn gaps(&self, tiles: usize) -> f32 {
        self.gap * tiles.saturating_sub(1) as f32
    }

    /// Changes the shares within a tile of `size`, so that all tiles in it have at least their least sizes if there is room for
    /// all of them.
    fn enlarge(&self, tile: &mut LayoutTile, size: Vec2) {
        let (axis, tiles) = match tile {
            LayoutTile::Panel(_) => return,
            LayoutTile::Tabs { tiles, .. } => {
                // A tile may be lower than its bar of tabs, and then has no room below it.
                let below_bar = (size - vec2(0.0, self.bar)).max(Vec2::ZERO);
                for tile in tiles {
                    self.enlarge(tile, below_bar);
                }
                return;
            }
            LayoutTile::Linear { axis, tiles } => (axis.index(), tiles),
        };

        // Hidden tiles take no room; they keep their shares for the time when they are shown again.
        let mut seen: Vec<_> = tiles
            .iter_mut()
            .filter(|(tile, _)| !tile.is_hidden(self.hidden))
            .collect();

        // A tile that is shorter than the gaps in it has no room for the tiles.
        let room = (size[axis] - self.gaps(seen.len())).max(0.0);
        let total: f32 = seen.iter().map(|(_, share)| share).sum();
        // A layout from a link or a file may have shares of 0 only, and the sum is a divisor.
        let divisor = if total == 0.0 { 1.0 } else { total };
        let lengths: Vec<f32> = seen
            .iter()
            .map(|(_, share)| room * share / divisor)
            .collect();
        let least: Vec<f32> = seen
            .iter()
            .map(|(tile, _)| self.least_size(tile)[axis])
            .collect();

        let new_lengths = enlarged(&lengths, &least);
        let is_same = new_lengths == lengths;

        for ((tile, share), length) in seen.iter_mut().map(|tile| &mut **tile).zip(new_lengths) {
            // An unchanged share is not computed from its length, as rounding could change it. Lengths change only if `room` is
            // enough for the least ones, so that it is not 0 here.
            if !is_same {
                *share = total * length / room;
            }

            let mut inner = size;
            inner[axis] = length;
            self.enlarge(tile, inner);
        }
    }
}

impl Direction {
    const fn index(self) -> usize {
        match self {
            Self::Horizontal => 0,
            Self::Vertical => 1,
        }
    }
}

/// Returns lengths with the same sum, each at least that of `least`; those above it keep their proportions. If the sum is too small
/// for `least`, returns the lengths themselves.
fn enlarged(lengths: &[f32], least: &[f32]) -> Vec<f32> {
    let (room, needed) = (lengths.iter().sum::<f32>(), least.iter().sum::<f32>());
    let mut pairs = lengths.iter().zip(least);
    if needed > room || pairs.all(|(length, least)| length >= least) {
        return lengths.to_vec();
    }

    // Each turn but the last gives one more tile its least length, so that the loop ends.
    let mut is_small = vec![false; lengths.len()];
    loop {
        // Returns the sum of the given lengths of the tiles that `is_small` marks, or of the others.
        let sum = |given: &[f32], of_small: bool| -> f32 {
            let summed = given
                .iter()
                .zip(&is_small)
                .filter(|(_, is_small)| **is_small == of_small);
            summed.map(|(length, _)| *length).sum()
        };

        let of_small = true;
        let remaining = room - sum(least, of_small);
        // The other tiles may all have length 0, and the sum of their lengths is a divisor.
        let shared = sum(lengths, !of_small).max(f32::MIN_POSITIVE);
        let length_of = |k: usize| {
            if is_small[k] {
                least[k]
            } else {
                lengths[k] * remaining / shared
            }
        };

        let scaled: Vec<f32> = (0..lengths.len()).map(length_of).collect();
        // Another of the remaining tiles may now be too small.
        let Some(small) = (0..scaled.len()).find(|&k| !is_small[k] && scaled[k] < least[k]) else {
            return scaled;
        };
        is_small[small] = true;
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn every_panel_has_a_letter_a_key_and_a_place_of_its_own() {
        let letters: HashSet<char> = ROWS.iter().map(|row| row.letter).collect();
        assert_eq!(letters.len(), ROWS.len());
        let places: HashSet<(u8, u8)> = ROWS.iter().map(|row| (row.slot as u8, row.tab)).collect();
        assert_eq!(places.len(), ROWS.len());

        let keys = ROWS.iter().map(|row| row.key).filter(|key| !key.is_empty());
        let keys: Vec<&str> = keys.collect();
        assert_eq!(keys.iter().collect::<HashSet<_>>().len(), keys.len());
        assert!(
            keys.iter()
                .all(|key| key.parse::<u8>().is_ok_and(|digit| digit < 10))
        );
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
    fn hidden_panels_keep_their_places() {
        let whole = Layout::default();
        let mut layout = whole.clone();
        layout.hide(Panel::Canvas);
        assert_eq!(layout, whole, "the canvas stays");
        // The next tab opens instead of a hidden one, and a hidden panel comes back at its former position.
        layout.open(Panel::Events);
        layout.hide(Panel::Events);
        assert!(layout.is_whole() && layout.shows(Panel::Parameters));
        assert!(!layout.shows(Panel::Events) && layout.hidden().has(Panel::Events));
        layout.hide(Panel::Parameters);
        assert!(
            layout.shows(Panel::Scenes),
            "to the right, as nothing is left of it"
        );
        for panel in [Panel::Scenes, Panel::Analysis] {
            layout.hide(panel);
        }
        let text = text::written(&layout);
        assert_eq!(text::read(&text), Some(layout.clone()), "{text}");
        for panel in Panel::all() {
            layout.open(panel);
            assert!(layout.shows(panel));
        }
        assert!(layout.hidden().is_empty());
    }

    #[test]
    fn the_sides_are_what_is_beside_the_canvas() {
        let mut layout = Layout::default();
        let sides = layout.sides();
        assert_eq!(sides.panels().count(), 11);
        for panel in [Panel::Canvas, Panel::Timeline, Panel::Passes] {
            assert!(!sides.has(panel));
        }
        // The room of hidden columns is not reserved.
        sides.panels().for_each(|panel| layout.hide(panel));
        let shares = layout.clone();
        layout.enlarge(vec2(120.0, 400.0), [2.0, 20.0], |_| vec2(100.0, 50.0));
        assert_eq!(layout, shares);
    }

    #[test]
    fn small_tiles_are_enlarged_at_the_cost_of_large_ones() {
        let same = [30.0, 60.0, 10.0];
        assert_eq!(enlarged(&same, &[30.0, 10.0, 10.0]), same);
        assert_eq!(enlarged(&same, &[0.0, 0.0, 28.0]), [24.0, 48.0, 28.0]);
        // One of the tiles that shrink becomes too small itself.
        assert_eq!(enlarged(&same, &[29.0, 0.0, 40.0]), [29.0, 31.0, 40.0]);
        assert_eq!(enlarged(&[0.0, 100.0], &[25.0, 25.0]), [25.0, 75.0]);
        // There is no room for all.
        assert_eq!(enlarged(&same, &[50.0, 50.0, 50.0]), same);
    }

    #[test]
    fn tiles_are_enlarged_only_as_far_as_the_window_has_room() {
        let least = |_| vec2(100.0, 50.0);
        let enlarge = |size| {
            let mut layout = Layout::default();
            layout.enlarge(size, [2.0, 20.0], least);
            layout
        };
        let whole = Layout::default();
        assert_eq!(enlarge(vec2(2_000.0, 1_500.0)), whole);
        // Without room no tile changes.
        assert_eq!(enlarge(Vec2::ZERO), whole);
        assert_ne!(enlarge(vec2(400.0, 300.0)), whole);
    }

    #[test]
    fn a_layout_of_a_version_with_fewer_panels_gets_the_new_ones() {
        let old = text::read("VHT_ebx-2000Tcg-6000VT_ls-4400T_vwki-5600-2000-8740t1260-");
        let mut new = old.expect("a layout");
        assert!(new.is_whole() && new.shows(Panel::Events));
        for panel in Panel::all() {
            new.open(panel);
            assert!(new.shows(panel), "{panel:?}");
        }
        let whole = Layout::default();
        assert_eq!(whole.clone().completed(), Some(whole));
        // Tabs whose last panel was dragged out do not receive others.
        let emptied = text::read("VHT-2000T_cg-8000-8000t2000-").expect("a layout");
        assert!(emptied.is_whole() && !text::written(&emptied).contains("T-"));
        // A single panel has no tabs to add others to.
        let root = LayoutTile::Panel(Panel::Canvas);
        assert_eq!(Layout::new(root).completed(), None);
        assert!(Layout::alone(Panel::Canvas).completed().unwrap().is_whole());
    }

    #[test]
    fn malformed_layouts_are_rejected() {
        let tabs = |tiles, open| LayoutTile::Tabs { tiles, open };
        let row = |share| LayoutTile::Linear {
            axis: Direction::Horizontal,
            tiles: vec![(tabs(vec![LayoutTile::Panel(Panel::Canvas)], 0), share)],
        };
        assert!(Layout::new(row(0.5)).completed().is_some());
        let canvas = || LayoutTile::Panel(Panel::Canvas);
        for root in [
            row(f32::NAN),
            row(-1.0),
            tabs(vec![canvas(), canvas()], 0),
            tabs(vec![canvas()], 1),
            tabs(Vec::new(), 0),
        ] {
            assert_eq!(Layout::new(root.clone()).completed(), None, "{root:?}");
        }
    }
}
