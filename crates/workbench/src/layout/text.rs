//! Layouts as short texts, for links and files: nested rows, columns and tabs, with a letter for each panel.

use super::{Direction, Layout, LayoutTile, MAX_DEPTH, MAX_TILES, Panel};

/// The unit of written shares is one over this: less than a point of a screen.
const PART: f32 = 10_000.0;
/// The largest share that is written or read. Chosen, not measured.
const MAX_SHARE: f32 = 100.0;
/// The end of a container.
const END: char = '-';
/// The mark before the open tab.
const OPEN: char = '_';
/// The mark before the hidden panels.
const HIDDEN: char = '.';

/// Returns a layout as text: `H`, `V` or `T`, the children, `-`. A child of a row or column is followed by its share in
/// ten thousandths. The letters of hidden panels follow a dot.
#[must_use]
pub fn written(layout: &Layout) -> String {
    let mut text = String::new();
    write(&layout.root, &mut text);
    if !layout.hidden.is_empty() {
        text.push(HIDDEN);
        text.extend(layout.hidden.panels().map(Panel::letter));
    }
    text
}

/// Appends a tile and all tiles in it to a text.
fn write(tile: &LayoutTile, text: &mut String) {
    match tile {
        LayoutTile::Panel(panel) => text.push(panel.letter()),

        LayoutTile::Tabs { tiles, open } => {
            text.push('T');
            for (index, tile) in tiles.iter().enumerate() {
                if index == *open {
                    text.push(OPEN);
                }
                write(tile, text);
            }
            text.push(END);
        }

        LayoutTile::Linear { axis, tiles } => {
            text.push(match axis {
                Direction::Horizontal => 'H',
                Direction::Vertical => 'V',
            });
            for (tile, share) in tiles {
                write(tile, text);
                // A tile can be dragged to a larger share, which `read` would refuse.
                let share = share.clamp(0.0, MAX_SHARE);
                text.push_str(&((share * PART).round() as u32).to_string());
            }
            text.push(END);
        }
    }
}

/// Returns the layout of a text, completed with missing panels; `None` if the text is malformed.
#[must_use]
pub fn read(text: &str) -> Option<Layout> {
    let mut reader = LayoutReader {
        rest: text,
        count: 0,
    };
    let root = reader.tile(0)?;
    let mut layout = Layout::new(root).completed()?;
    if reader.takes(HIDDEN) {
        while let Some(letter) = reader.next() {
            layout.hide(panel_of(letter)?);
        }
    }
    reader.rest.is_empty().then_some(layout)
}

fn panel_of(letter: char) -> Option<Panel> {
    Panel::all().find(|panel| panel.letter() == letter)
}

impl From<Layout> for String {
    fn from(layout: Layout) -> Self {
        written(&layout)
    }
}

impl TryFrom<String> for Layout {
    type Error = &'static str;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        read(&text).ok_or("this is not a layout of the panels")
    }
}

struct LayoutReader<'a> {
    rest: &'a str,
    count: usize,
}

impl LayoutReader<'_> {
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

    /// Reads a tile at a depth, with all tiles in it; `None` if the text is invalid, or beyond a limit.
    fn tile(&mut self, depth: usize) -> Option<LayoutTile> {
        self.count += 1;
        if depth > MAX_DEPTH || self.count > MAX_TILES {
            return None;
        }
        match self.next()? {
            'T' => self.tabs(depth),
            'H' => self.linear(Direction::Horizontal, depth),
            'V' => self.linear(Direction::Vertical, depth),
            other => Some(LayoutTile::Panel(panel_of(other)?)),
        }
    }

    fn tabs(&mut self, depth: usize) -> Option<LayoutTile> {
        let (mut tiles, mut open) = (Vec::new(), 0);
        while !self.takes(END) {
            if self.takes(OPEN) {
                open = tiles.len();
            }
            tiles.push(self.tile(depth + 1)?);
        }
        Some(LayoutTile::Tabs { tiles, open })
    }

    fn linear(&mut self, axis: Direction, depth: usize) -> Option<LayoutTile> {
        let mut tiles = Vec::new();
        while !self.takes(END) {
            tiles.push((self.tile(depth + 1)?, self.share()?));
        }
        Some(LayoutTile::Linear { axis, tiles })
    }

    fn share(&mut self) -> Option<f32> {
        let len = self.rest.find(|c: char| !c.is_ascii_digit())?;
        let (digits, rest) = self.rest.split_at(len);
        self.rest = rest;
        let share = digits.parse::<u32>().ok()? as f32 / PART;
        (share <= MAX_SHARE).then_some(share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layouts_are_read_as_written() {
        let mut layout = Layout::default();
        let first = written(&layout);
        assert_eq!(
            first,
            "VHT_peba-1950T_cg-6050VT_lsx-4400T_viwk-5600-2000-8740t1260-"
        );
        for panel in Panel::all() {
            layout.open(panel);
            let text = written(&layout);
            let back = read(&text).unwrap();
            assert!(back.is_whole() && back.shows(panel), "{panel:?}: {text}");
            assert_eq!(written(&back), text);
        }
        for panel in [Panel::Parameters, Panel::Legend] {
            layout.hide(panel);
        }
        let text = written(&layout);
        assert!(text.ends_with("-.pk"), "{text}");
        assert_eq!(read(&text).map(|back| written(&back)), Some(text));
        // Missing panels, as in a link of an earlier version, are completed.
        assert!(read("VT_cg-5000t5000-").unwrap().is_whole());
    }

    #[test]
    fn malformed_layouts_are_rejected() {
        let deep = "H".repeat(60_000);
        let wide = format!("T{}-", "c".repeat(60_000));
        for text in [
            "",
            "-",
            "c",
            "?",
            "T",
            "Tcc-",
            "T-",
            "Hc5000",
            "Hc-",
            "Hc5000e-",
            "T_cg-x",
            "Hc99999999999-",
            "Hc4000000000g1-",
            "VT_cg-5000c5000-",
            "T\u{e9}-",
            "VT_cg-5000t5000-.?",
            "VT_cg-5000t5000-p",
            &deep,
            &wide,
        ] {
            assert!(read(text).is_none(), "{text:.40}");
        }
    }
}
