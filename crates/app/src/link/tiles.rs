//! Where the panels stand, as a short text: rows, columns and tabs one within the other, each panel by a letter. What a sound
//! layout is says the layout.

use egui_tiles::{Container, Linear, LinearDir, Tabs, Tile, TileId, Tiles, Tree};

use crate::layout::{Layout, Panel};

/// Shares of rows and columns are told to this part.
const PART: f32 = 10_000.0;
/// The largest share.
const MOST_SHARE: f32 = 100.0;
/// Deeper than this no layout is read.
const DEEPEST: usize = 24;
/// More tiles than this are not read.
const MOST_TILES: usize = 100;
/// Ends a container.
const END: char = '-';
/// Stands before the open tab.
const OPEN: char = '_';

/// Returns a layout as text: `H`, `V` or `T`, its children, `-`; behind a child of a row or column its share in ten
/// thousandths. None for a layout that has grids, which the window does not make.
pub fn written(layout: &Layout) -> Option<String> {
    let mut text = String::new();
    write(&layout.0.tiles, layout.0.root()?, 0, &mut text)?;
    Some(text)
}

fn write(tiles: &Tiles<Panel>, id: TileId, depth: usize, text: &mut String) -> Option<()> {
    if depth > DEEPEST {
        return None;
    }
    match tiles.get(id)? {
        Tile::Pane(panel) => text.push(panel.letter()),
        Tile::Container(Container::Tabs(tabs)) => {
            text.push('T');
            for &child in &tabs.children {
                if tabs.active == Some(child) {
                    text.push(OPEN);
                }
                write(tiles, child, depth + 1, text)?;
            }
            text.push(END);
        }
        Tile::Container(Container::Linear(linear)) => {
            text.push(match linear.dir {
                LinearDir::Horizontal => 'H',
                LinearDir::Vertical => 'V',
            });
            for &child in &linear.children {
                write(tiles, child, depth + 1, text)?;
                let share = linear.shares[child].clamp(0.0, MOST_SHARE);
                text.push_str(&((share * PART).round() as u32).to_string());
            }
            text.push(END);
        }
        Tile::Container(Container::Grid(_)) => return None,
    }
    Some(())
}

/// Returns the layout that a text means, with every panel in it; none if it means no sound one.
pub fn read(text: &str) -> Option<Layout> {
    let mut reader = Reader {
        rest: text,
        tiles: Tiles::default(),
        count: 0,
    };
    let root = reader.tile(0)?;
    let tree = Tree::new(Layout::default().0.id(), root, reader.tiles);
    reader.rest.is_empty().then_some(())?;
    Layout(tree).completed()
}

struct Reader<'a> {
    rest: &'a str,
    tiles: Tiles<Panel>,
    count: usize,
}

impl Reader<'_> {
    fn next(&mut self) -> Option<char> {
        let next = self.rest.chars().next()?;
        self.rest = &self.rest[next.len_utf8()..];
        Some(next)
    }

    fn takes(&mut self, wanted: char) -> bool {
        let rest = self.rest.strip_prefix(wanted);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn tile(&mut self, depth: usize) -> Option<TileId> {
        self.count += 1;
        if depth > DEEPEST || self.count > MOST_TILES {
            return None;
        }
        match self.next()? {
            'T' => self.tabs(depth),
            'H' => self.linear(LinearDir::Horizontal, depth),
            'V' => self.linear(LinearDir::Vertical, depth),
            other => {
                let panel = Panel::all().find(|&panel| panel.letter() == other)?;
                Some(self.tiles.insert_pane(panel))
            }
        }
    }

    fn tabs(&mut self, depth: usize) -> Option<TileId> {
        let (mut children, mut active) = (Vec::new(), None);
        while !self.takes(END) {
            let is_open = self.takes(OPEN);
            let child = self.tile(depth + 1)?;
            children.push(child);
            if is_open {
                active = Some(child);
            }
        }
        let mut tabs = Tabs::new(children);
        tabs.active = active.or(tabs.active);
        Some(self.tiles.insert_container(Container::Tabs(tabs)))
    }

    fn linear(&mut self, dir: LinearDir, depth: usize) -> Option<TileId> {
        let mut linear = Linear::new(dir, Vec::new());
        while !self.takes(END) {
            let child = self.tile(depth + 1)?;
            linear.children.push(child);
            linear.shares.set_share(child, self.share()?);
        }
        Some(self.tiles.insert_container(Container::Linear(linear)))
    }

    fn share(&mut self) -> Option<f32> {
        let len = self.rest.find(|c: char| !c.is_ascii_digit())?;
        let (digits, rest) = self.rest.split_at(len);
        self.rest = rest;
        let share = digits.parse::<u32>().ok()? as f32 / PART;
        (share <= MOST_SHARE).then_some(share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layouts_come_back() {
        let mut layout = Layout::default();
        let first = written(&layout).unwrap();
        assert_eq!(
            first,
            "VHT_peba-1950T_cg-6050VT_lsx-4400T_viwk-5600-2000-8740t1260-"
        );
        for panel in Panel::all() {
            layout.open(panel);
            let text = written(&layout).unwrap();
            let back = read(&text).unwrap();
            assert!(back.is_whole() && back.shows(panel), "{panel:?}: {text}");
            assert_eq!(written(&back), Some(text));
        }
        // Missing panels, as in a link of an earlier version, are completed.
        assert!(read("VT_cg-5000t5000-").unwrap().is_whole());
    }

    #[test]
    fn texts_that_mean_no_layout_are_known() {
        let deep = "H".repeat(60_000);
        let wide = format!("T{}-", "c".repeat(60_000));
        for text in [
            "",
            "-",
            "c",
            "?",
            "T",
            "Tcc-",
            "Hc5000",
            "Hc-",
            "Hc5000e-",
            "T_cg-x",
            "Hc99999999999-",
            "Hc4000000000g1-",
            "VT_cg-5000c5000-",
            "T\u{e9}-",
            &deep,
            &wide,
        ] {
            assert!(read(text).is_none(), "{text:.40}");
        }
    }
}
