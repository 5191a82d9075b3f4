//! Arguments of a third side: `--depth`, or three sides in one word.

use clap::Args;

/// The third side of a box.
#[derive(Clone, Debug, Default, Args)]
pub struct SpaceArguments {
    /// Third side of the domain: the set is then one of balls in space, made by the reference sampler
    #[arg(long, value_name = "D")]
    pub depth: Option<f64>,
    #[command(flatten)]
    word: SizeArgument,
}

/// The three sides of a box in one word. Not where `--size` is that of a picture.
#[derive(Clone, Debug, Default, Args)]
pub struct SizeArgument {
    /// Width, height and depth in one word, such as 10x10x10
    #[arg(long = "size", value_name = "WxHxD", value_parser = Sides::parse, conflicts_with_all = ["depth", "width", "height"])]
    pub sides: Option<Sides>,
}

impl SpaceArguments {
    /// Returns whether there is a third side.
    pub const fn is_given(&self) -> bool {
        self.depth.is_some() || self.word.sides.is_some()
    }

    /// Returns the option that gives the third side, where there is one.
    pub const fn option(&self) -> &'static str {
        if self.depth.is_some() {
            "--depth"
        } else {
            "--size"
        }
    }

    /// Returns the sides of a box over a rectangle; without a third side, nothing.
    pub fn size(&self, [width, height]: [f64; 2]) -> Option<[f64; 3]> {
        let typed = self.word.sides.map(|Sides(sides)| sides);
        typed.or(self.depth.map(|depth| [width, height, depth]))
    }
}

/// Three sides in one word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sides(pub [f64; 3]);

impl Sides {
    /// Reads `WxHxD`, also with X or the sign of multiplication.
    fn parse(text: &str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split(['x', 'X', '\u{d7}']).collect();
        // Three numbers that are divided in another way are three sides all the same.
        if parts.len() == 1 && text.split([',', ';', '*', ' ']).count() > 1 {
            return Err(format!(
                "{text:?} is no box; its sides are written with x between them, as in 10x10x10"
            ));
        }
        let &[width, height, depth] = parts.as_slice() else {
            let sides = if parts.len() == 1 { "side" } else { "sides" };
            return Err(format!(
                "{text:?} has {} {sides}; three are needed, as in 10x10x10: a plane has --width and --height",
                parts.len()
            ));
        };
        let side = |text: &str| {
            let text = text.trim();
            text.parse().map_err(|_| format!("{text:?} is no number"))
        };
        Ok(Self([side(width)?, side(height)?, side(depth)?]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_sides_are_one_word() {
        for text in [
            "10x2.5x1e1",
            "10X2.5X10",
            "10\u{d7}2.5\u{d7}10",
            "10 x 2.5 x 10",
        ] {
            assert_eq!(Sides::parse(text), Ok(Sides([10.0, 2.5, 10.0])), "{text}");
        }
        for (text, wanted) in [
            ("10x10", "\"10x10\" has 2 sides; three are needed"),
            ("1x2x3x4", "has 4 sides"),
            ("10x10xten", "\"ten\" is no number"),
            ("", "has 1 side;"),
            ("10,10,10", "written with x between them, as in 10x10x10"),
            ("10*10*10", "written with x between them"),
        ] {
            let said = Sides::parse(text).expect_err(text);
            assert!(said.contains(wanted), "{said}");
        }
    }
}
