//! Parameters to begin with, by name.

use std::f64::consts::TAU;

use tilescope_core::{
    Boundary, Insertion, NestedRequest, Parameters, Search, TilingMethod, WithinLevel,
};
use tilescope_sets::{ComputedPicture, DEFAULT_WHITE, Tone};

use crate::ground::{GroundRequest, PortableGround};
use crate::stipple::StippleRequest;

/// Parameters to begin with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// The session that the window opens with.
    First,
    /// Blocks at the lower end of the range that the paper recommends, 20 r to 40 r, and its bounded pattern.
    SmallBlocks,
    /// As many samples as in figure 11 of the paper.
    Million,
    /// Gaps are searched for within 2 r only, and some stay.
    BreakIt,
    /// Blocks in which the pattern repeats.
    LargeBlocks,
    /// Gaps are filled by uniform darts.
    Uniform,
    /// Darts are tiled with their order of arrival.
    Exact,
    /// A set with six nested levels.
    Nested,
    /// A radius that grows to the right.
    Ramp,
    /// A star, with a radius that grows from its middle.
    Star,
    /// Three balls on a table, stippled.
    StillLife,
    /// Ridges behind a lake, stippled.
    Landscape,
}

/// What the menu says of a preset.
struct Row {
    preset: Preset,
    name: &'static str,
    explanation: &'static str,
}

/// Every preset, in the order of the menu.
const ROWS: [Row; 12] = [
    Row {
        preset: Preset::First,
        name: "The first session",
        explanation: "About 10,000 samples in nine blocks: small enough to see every step.",
    },
    Row {
        preset: Preset::SmallBlocks,
        name: "Many small blocks",
        explanation: "Blocks of at least 20 r, the smallest that the paper recommends, and its bounded pattern: more seams, more gaps.",
    },
    Row {
        preset: Preset::Million,
        name: "The paper's figure 11",
        explanation: "A million samples, as many as the paper times. So large a run keeps its result only, without steps.",
    },
    Row {
        preset: Preset::BreakIt,
        name: "Break it",
        explanation: "Gaps are searched for within 2 r only: some stay open, and the verdict shows where.",
    },
    Row {
        preset: Preset::LargeBlocks,
        name: "Blocks too large",
        explanation: "Blocks larger than the pattern: it repeats within them, which the spectrum in Analysis shows as spikes.",
    },
    Row {
        preset: Preset::Uniform,
        name: "Uniform insertion",
        explanation: "Gaps are filled by darts, uniformly over their area, instead of at circumcentres.",
    },
    Row {
        preset: Preset::Exact,
        name: "Exact tiling",
        explanation: "Darts are tiled with their order of arrival, and what came first stays: seams have no bias.",
    },
    Row {
        preset: Preset::Nested,
        name: "Nested levels",
        explanation: "A set in an order of which every prefix is evenly spread: the timeline shows its first samples, however many.",
    },
    Row {
        preset: Preset::Ramp,
        name: "Growing radius",
        explanation: "The radius is a function of the place: it grows to the right, and darts show how density follows it.",
    },
    Row {
        preset: Preset::Star,
        name: "Star",
        explanation: "The domain is a star with a hole: darts outside do not exist, and the radius grows from the middle.",
    },
    Row {
        preset: Preset::StillLife,
        name: "Still life, stippled",
        explanation: "12,000 dots, as dense as a picture is dark: three balls on a table, which the program computes. Its shades are smooth.",
    },
    Row {
        preset: Preset::Landscape,
        name: "Landscape, stippled",
        explanation: "12,000 dots, as dense as a picture is dark: ridges behind a lake, which the program computes. Its edges are sharp.",
    },
];

/// The dots of the stipples: enough to see the pictures, and made in less than a second.
const DOTS: u64 = 12_000;

/// The expressions of the radius of the ramp and of the star.
const RAMP: &str = "0.008 + 0.032*x";
const STAR: &str = "0.012 + 0.06*hypot(x - 0.5, y - 0.5)";

impl Preset {
    /// Returns every preset, in the order of the menu.
    pub fn all() -> impl Iterator<Item = Self> {
        ROWS.iter().map(|row| row.preset)
    }

    /// Returns its name in the menu.
    #[must_use]
    pub const fn name(self) -> &'static str {
        ROWS[self as usize].name
    }

    /// Returns its description, in a sentence.
    #[must_use]
    pub const fn explanation(self) -> &'static str {
        ROWS[self as usize].explanation
    }

    /// Returns the parameters that it sets.
    #[must_use]
    pub fn parameters(self) -> Parameters {
        let mut p = Parameters::default();

        match self {
            Self::First | Self::Nested => {}
            // A preset with a field is bounded, as fields are seldom periodic.
            Self::Ramp | Self::Star => p.boundary = Boundary::Bounded,
            // The unit of a stipple is a pixel, as on the command line.
            Self::StillLife | Self::Landscape => {
                p.boundary = Boundary::Bounded;
                [p.width, p.height] = ComputedPicture::SIZE.map(|pixels| pixels as f64);
            }
            Self::SmallBlocks => {
                p.leaf = 20.0;
                p.pattern.boundary = Boundary::Bounded;
            }

            // A maximal set has 0.696 samples for each r^2: of this radius 998,000.
            Self::Million => p.radius = 0.000_835,
            // So short a search leaves gaps with this seed, and none with the default one.
            Self::BreakIt => (p.seed, p.search) = (3, Search::TwoRadii),
            // Blocks are 60 r long at least, and the pattern is half of that. The domain, of 250 r, has several blocks.
            Self::LargeBlocks => (p.leaf, p.pattern.side, p.radius) = (60.0, 30.0, 0.004),
            Self::Uniform => p.insertion = Insertion::Uniform,
            Self::Exact => {
                p.method = TilingMethod::Exact;
                // The pattern that exact tilings of so many samples usually have.
                p.pattern = p.usual_pattern();
            }
        }
        p
    }

    /// Returns its field and its shape, if it has any.
    #[must_use]
    pub fn ground(self) -> Option<GroundRequest> {
        let (text, rings) = match self {
            Self::Ramp => (RAMP, Vec::new()),
            Self::Star => (STAR, star()),
            Self::StillLife => return stipple(ComputedPicture::StillLife),
            Self::Landscape => return stipple(ComputedPicture::Landscape),
            // These have one radius in a rectangle.
            Self::First
            | Self::SmallBlocks
            | Self::Million
            | Self::BreakIt
            | Self::LargeBlocks
            | Self::Uniform
            | Self::Exact
            | Self::Nested => return None,
        };
        let ground = PortableGround {
            radius_expression: Some(text.to_owned()),
            rings,
            origin: [0.0; 2],
        };
        // The expressions and the rings above are valid, as a test that makes each preset shows.
        ground.request().ok().flatten()
    }

    /// Returns its nested levels, if it has any.
    #[must_use]
    pub fn nesting(self) -> Option<NestedRequest> {
        (self == Self::Nested).then_some(NestedRequest {
            levels: 6,
            exactly: None,
            order_within: WithinLevel::Random,
        })
    }
}

/// Returns the request for dots of a picture.
fn stipple(picture: ComputedPicture) -> Option<GroundRequest> {
    // No picture is refused, as a test that makes each preset shows.
    let image = picture.image().ok()?;
    Some(GroundRequest {
        radius: None,
        shape: None,
        origin: [0.0; 2],
        stipple: Some(StippleRequest {
            image,
            tone: Tone::default(),
            white: DEFAULT_WHITE,
            dots: DOTS,
            runs_on: false,
        }),
    })
}

/// Returns the corners of a star with five points in the unit square, and of the hole in it.
fn star() -> Vec<Vec<[f64; 2]>> {
    // Four decimals keep links short, and keep the corners the same on machines whose sines differ in their last bits.
    let at = |radius: f64, turns: f64| {
        // A quarter of a turn from the x axis, so that the first corner is at the top.
        let angle = TAU * (turns + 0.25);
        [0.5 + radius * angle.cos(), 0.5 + radius * angle.sin()]
            .map(|value| (value * 1e4).round() / 1e4)
    };
    // The corners of the star lie by turns on a large and on a small circle, and the six of the hole on a still smaller
    // one. The large circle touches the sides of the square; the other two radii and the six corners are chosen.
    let corner = |k: u32| {
        let radius = if k.is_multiple_of(2) { 0.5 } else { 0.23 };
        at(radius, f64::from(k) / 10.0)
    };
    let hole = |k: u32| at(0.09, f64::from(k) / 6.0);
    vec![(0..10).map(corner).collect(), (0..6).map(hole).collect()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_stands_at_its_preset() {
        for (index, preset) in Preset::all().enumerate() {
            assert_eq!(preset as usize, index);
        }
    }
}
