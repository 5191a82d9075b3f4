//! Arguments of a third side: `--depth`, or three sides in one word.

use clap::Args;

/// The third side of a box.
#[derive(Clone, Debug, Default, Args)]
pub struct SpaceArguments {
    /// Third side of the domain: the set is then one of balls in space, made by the reference sampler
    #[arg(long, value_name = "D")]
    pub depth: Option<f64>,
    /// Width, height and depth in one word, such as 10x10x10
    #[arg(long = "size", value_name = "WxHxD", value_parser = Sides::parse, conflicts_with_all = ["depth", "width", "height"])]
    pub sides: Option<Sides>,
}

impl SpaceArguments {
    /// Returns whether there is a third side.
    pub const fn is_given(&self) -> bool {
        self.depth.is_some() || self.sides.is_some()
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
        let typed = self.sides.map(|Sides(sides)| sides);
        typed.or(self.depth.map(|depth| [width, height, depth]))
    }
}

/// Three sides in one word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sides(pub [f64; 3]);

impl Sides {
    /// Reads `WxHxD`.
    fn parse(text: &str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split('x').collect();
        let &[width, height, depth] = parts.as_slice() else {
            return Err(format!(
                "{text:?} has {} sides; three are needed, as in 10x10x10: a plane has --width and --height",
                parts.len()
            ));
        };
        let side = |text: &str| text.parse().map_err(|_| format!("{text:?} is no number"));
        Ok(Self([side(width)?, side(height)?, side(depth)?]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_sides_are_one_word() {
        assert_eq!(Sides::parse("10x2.5x1e1"), Ok(Sides([10.0, 2.5, 10.0])));
        for (text, wanted) in [
            ("10x10", "\"10x10\" has 2 sides; three are needed"),
            ("1x2x3x4", "has 4 sides"),
            ("10x10xten", "\"ten\" is no number"),
            ("", "has 1 sides"),
        ] {
            let said = Sides::parse(text).expect_err(text);
            assert!(said.contains(wanted), "{said}");
        }
    }
}
