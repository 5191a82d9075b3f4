//! Groups of horizontal bars over one axis, each with its name before it and its value behind: no legend.
//! It draws what it is given and computes nothing of it.

use tilescope_analysis::measures::Summary;
use tilescope_figures::{
    Anchor, Baseline, Font, Group, Palette, Rect, Scene, Shape, Stroke, Style, Text, text_width,
};

use crate::numbers::{count, number};

/// Width of a figure in pixels.
const WIDTH: f64 = 1200.0;
const MARGIN: f64 = 20.0;
const TITLE: f64 = 58.0;
const HEADING: f64 = 34.0;
const LINE: f64 = 27.0;
const THICK: f64 = 17.0;
const SIZE: f64 = 13.0;
/// Size of an axis's numbers, the room below groups for them and for the axis's name, and the steps that an axis has at most.
const TICK: f64 = 12.0;
const AXIS: f64 = 46.0;
const STEPS: f64 = 8.0;

/// A bar.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    pub name: String,
    pub value: f64,
    /// Where a whisker begins and ends.
    pub spread: Option<[f64; 2]>,
    /// What is written behind it.
    pub text: String,
    /// Bars of one kind in several groups have one colour, by its number.
    pub kind: usize,
}

/// Bars under a heading.
#[derive(Clone, Debug, PartialEq)]
pub struct Bars {
    pub heading: String,
    pub bars: Vec<Bar>,
}

/// Returns a number as it is drawn: figures' fonts have no narrow space.
pub fn drawn_number(value: f64, digits: usize) -> String {
    number(value, digits).replace('\u{202f}', " ")
}

/// Returns a whole number as it is drawn.
pub fn drawn_count(value: usize) -> String {
    count(value as u64).replace('\u{202f}', " ")
}

/// Quartiles of fewer values would be interpolations.
const FEW: usize = 5;

/// Returns where a whisker begins and ends: quartiles, or of few values the least and the most.
pub fn whisker(summary: &Summary) -> [f64; 2] {
    if summary.count < FEW {
        [summary.least, summary.most]
    } else {
        [summary.quartiles[0], summary.quartiles[2]]
    }
}

/// Returns what [`whisker`] is of so many rounds, for captions.
pub const fn whisker_words(rounds: usize) -> &'static str {
    if rounds < FEW {
        "from least to most"
    } else {
        "from quartile to quartile"
    }
}

/// Returns key and heading of columns with both ends of [`whisker`] of so many rounds.
pub const fn whisker_columns(rounds: usize) -> [(&'static str, &'static str); 2] {
    if rounds < FEW {
        [("least", "least"), ("most", "most")]
    } else {
        [
            ("quartile_1", "first quartile"),
            ("quartile_3", "third quartile"),
        ]
    }
}

/// Returns the picture of groups that have at least one bar among them; `axis` names their quantity and its unit.
pub fn bars_scene(title: &str, axis: &str, groups: &[Bars], palette: &Palette) -> Scene {
    let all = || groups.iter().flat_map(|group| &group.bars);
    let widest = |text: fn(&Bar) -> &str| {
        all()
            .map(|bar| text_width(text(bar), Font::Regular, SIZE))
            .fold(0.0, f64::max)
    };
    let left = MARGIN + widest(|bar| &bar.name) + 12.0;
    let right = WIDTH - MARGIN - widest(|bar| &bar.text) - 12.0;
    let end = |bar: &Bar| bar.spread.map_or(bar.value, |ends| ends[1].max(bar.value));
    let most = all().map(end).fold(f64::MIN_POSITIVE, f64::max);
    let row = Row {
        left,
        scale: (right - left) / most,
        palette,
    };
    let mut scene = Scene::new(WIDTH, 1.0, palette.background);
    title.clone_into(&mut scene.title);
    let mut head = Group::new("title");
    head.shapes.push(bold([MARGIN, 34.0], title, 20.0, palette));
    let mut drawn = Group::new("bars");
    let mut y = TITLE;
    for group in groups {
        if !group.heading.is_empty() {
            let at = [MARGIN, y + 20.0];
            drawn.shapes.push(bold(at, &group.heading, 15.0, palette));
            y += HEADING;
        }
        let top = y;
        let bottom = top + LINE * group.bars.len() as f64;
        let lines = ticks(most).into_iter();
        let lines = lines.map(|(value, _)| [top, bottom].map(|end| [row.at(value), end]));
        drawn.shapes.push(Shape::Segments {
            segments: lines.collect(),
            stroke: Stroke::new(palette.line, 0.6),
        });
        for bar in &group.bars {
            row.draw(bar, y + 0.5 * LINE, &mut drawn);
            y += LINE;
        }
        let axis = Stroke::new(palette.muted, 1.0);
        drawn.shapes.push(Shape::line([left, top], [left, y], axis));
        y += 10.0;
    }
    let below = row.axis(axis, most, y);
    scene.groups.extend([head, drawn, below]);
    scene.height = y + AXIS + MARGIN;
    scene
}

/// Returns round values from zero to `most` and what is written there.
fn ticks(most: f64) -> Vec<(f64, String)> {
    let power = 10_f64.powf((most / STEPS).log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power);
    let step = steps.into_iter().find(|step| most <= STEPS * step);
    let step = step.unwrap_or(10.0 * power);
    let decimals = (-(step.log10() + 1e-9).floor()).max(0.0) as usize;
    let label = |value: f64| {
        if decimals == 0 {
            drawn_count(value.round() as usize)
        } else {
            format!("{value:.decimals$}")
        }
    };
    let count = (most / step * (1.0 + 1e-9)).floor() as usize;
    let values = (0..=count).map(|index| step * index as f64);
    values.map(|value| (value, label(value))).collect()
}

struct Row<'a> {
    left: f64,
    /// Pixels of a unit.
    scale: f64,
    palette: &'a Palette,
}

impl Row<'_> {
    fn at(&self, value: f64) -> f64 {
        self.left + self.scale * value.max(0.0)
    }

    /// Returns the axis below all groups.
    fn axis(&self, name: &str, most: f64, y: f64) -> Group {
        let mut group = Group::new("axis");
        let (color, stroke) = (self.palette.muted, Stroke::new(self.palette.muted, 1.0));
        let [left, right] = [0.0, most].map(|value| self.at(value));
        group
            .shapes
            .push(Shape::line([left, y], [right, y], stroke));
        for (value, label) in ticks(most) {
            let x = self.at(value);
            group.shapes.push(Shape::line([x, y], [x, y + 5.0], stroke));
            let mut text = Text::new([x, y + 9.0], label, TICK, color);
            (text.anchor, text.baseline) = (Anchor::Middle, Baseline::Top);
            group.shapes.push(Shape::Text(text));
        }
        let mut text = Text::new([f64::midpoint(left, right), y + 40.0], name, SIZE, color);
        text.anchor = Anchor::Middle;
        group.shapes.push(Shape::Text(text));
        group
    }

    fn draw(&self, bar: &Bar, middle: f64, group: &mut Group) {
        let colors = self.palette.block_borders;
        let at = |value: f64| self.at(value);
        let [top, bottom] = [-0.5, 0.5].map(|half| middle + half * THICK);
        group.shapes.push(Shape::Rect {
            rect: Rect::new([self.left, top], [at(bar.value), bottom]),
            style: Style::filled(colors[bar.kind % colors.len()]),
        });
        if let Some([low, high]) = bar.spread {
            let stroke = Stroke::new(self.palette.text, 1.4);
            let across = |x: f64| [[x, middle - 4.0], [x, middle + 4.0]];
            group.shapes.push(Shape::Segments {
                segments: vec![
                    [[at(low), middle], [at(high), middle]],
                    across(at(low)),
                    across(at(high)),
                ],
                stroke,
            });
        }
        let behind = bar.spread.map_or(bar.value, |ends| ends[1].max(bar.value));
        let mut name = Text::new(
            [self.left - 10.0, middle],
            &bar.name,
            SIZE,
            self.palette.text,
        );
        (name.anchor, name.baseline) = (Anchor::End, Baseline::Middle);
        let mut text = Text::new(
            [at(behind) + 8.0, middle],
            &bar.text,
            SIZE,
            self.palette.muted,
        );
        text.baseline = Baseline::Middle;
        group.shapes.extend([name, text].map(Shape::Text));
    }
}

fn bold(at: [f64; 2], text: &str, size: f64, palette: &Palette) -> Shape {
    let mut text = Text::new(at, text, size, palette.text);
    text.font = Font::SemiBold;
    Shape::Text(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_has_a_few_round_ticks() {
        let labels = |most: f64| {
            ticks(most)
                .into_iter()
                .map(|tick| tick.1)
                .collect::<Vec<_>>()
        };
        assert_eq!(labels(10.0), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(
            labels(0.31),
            ["0.00", "0.05", "0.10", "0.15", "0.20", "0.25", "0.30"]
        );
        assert_eq!(
            labels(30_000.0),
            [
                "0", "5000", "10 000", "15 000", "20 000", "25 000", "30 000"
            ]
        );
        for most in [1e-3, 0.7, 1.0, 79.0, 80.0, 81.0, 1.7e5] {
            let count = ticks(most).len();
            assert!((4..=9).contains(&count), "{most}: {count}");
        }
    }

    #[test]
    fn few_values_have_no_quartiles() {
        let of = |values: &[f64]| {
            whisker(&Summary::of(values.iter().copied()).unwrap()).map(|end| end as i32)
        };
        assert_eq!(of(&[1.0, 3.0]), [1, 3]);
        assert_eq!(of(&[1.0, 2.0, 3.0, 4.0]), [1, 4]);
        assert_eq!(of(&[1.0, 2.0, 3.0, 4.0, 5.0]), [2, 4]);
        assert_eq!(whisker_words(2), "from least to most");
        assert_eq!(whisker_columns(5)[0].0, "quartile_1");
    }

    #[test]
    fn bars_are_as_long_as_their_values_and_their_texts_stay_inside() {
        let bar = |value: f64, text: &str| Bar {
            name: "a long name of a bar".to_owned(),
            value,
            spread: Some([0.9 * value, 1.1 * value]),
            text: text.to_owned(),
            kind: 1,
        };
        let groups = [Bars {
            heading: "group".to_owned(),
            bars: vec![bar(1.0, "1 of something"), bar(4.0, "4 of something")],
        }];
        let scene = bars_scene("title", "quantity, unit", &groups, &Palette::LIGHT);
        scene.validate().unwrap();
        let width = |shape: &Shape| match shape {
            Shape::Rect { rect, .. } => Some(rect.max[0] - rect.min[0]),
            _ => None,
        };
        let widths: Vec<f64> = scene.groups[1].shapes.iter().filter_map(width).collect();
        assert!((widths[1] / widths[0] - 4.0).abs() < 1e-9);
        for shape in &scene.groups[1].shapes {
            if let Shape::Text(text) = shape
                && text.anchor == Anchor::Start
            {
                let end = text.at[0] + text_width(&text.text, text.font, text.size);
                assert!(end < WIDTH, "{end}");
            }
        }
    }
}
