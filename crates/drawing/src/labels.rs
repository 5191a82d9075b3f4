//! Where the labels of marks go, so that they cover neither each other nor other marks. Begin with [`places`].

use emath::{Pos2, Rect, Vec2, vec2};

/// Room between a mark and its label.
const GAP: f32 = 2.0;

/// A circle that marks something, and the size of its label.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Labelled {
    /// The middle of the circle.
    pub at: Pos2,
    /// The radius of the circle.
    pub radius: f32,
    /// Width and height of the label; zero without a label.
    pub size: Vec2,
}

impl Labelled {
    /// Returns the square around the circle.
    #[must_use]
    pub fn ring(&self) -> Rect {
        Rect::from_center_size(self.at, Vec2::splat(2.0 * self.radius))
    }

    /// Returns the places of the label, the usual one first: beside the circle and above or below its middle, then right above
    /// and below the circle.
    fn candidates(&self) -> [Rect; 6] {
        let Vec2 { x, y } = self.size;
        let side = self.radius + GAP;
        // A label beside the circle ends four points below the circle's top, or begins as far above its bottom: chosen,
        // not measured.
        let low = 4.0 - self.radius;
        [
            vec2(side, low - y),
            vec2(-side - x, low - y),
            vec2(side, -low),
            vec2(-side - x, -low),
            vec2(-0.5 * x, -side - y),
            vec2(-0.5 * x, side),
        ]
        .map(|corner| Rect::from_min_size(self.at + corner, self.size))
    }
}

/// Returns the rectangle of each mark's label. Of the places that a label can have it takes the one that covers least:
/// of `taken`, of the other marks, of the labels before it, and of the area outside `frame`; of equally good ones the
/// first.
#[must_use]
pub fn places(marks: &[Labelled], taken: &[Rect], frame: Rect) -> Vec<Rect> {
    let mut labels: Vec<Rect> = Vec::new();
    for (index, mark) in marks.iter().enumerate() {
        let others = marks
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != index);
        let rings = others.map(|(_, other)| other.ring());
        let covered: Vec<Rect> = rings
            .chain(taken.iter().copied())
            .chain(labels.iter().copied())
            .collect();

        // An area beyond the frame is as hidden as one below another mark.
        let cost = |place: &Rect| {
            let hidden: f32 = covered.iter().map(|other| common(*place, *other)).sum();
            hidden + area(*place) - common(*place, frame)
        };

        // Of several places of the least cost, `min_by` takes the first.
        let candidates = mark.candidates();
        let cheapest = candidates
            .into_iter()
            .min_by(|a, b| cost(a).total_cmp(&cost(b)));
        labels.push(cheapest.unwrap_or(candidates[0]));
    }
    labels
}

fn area(rect: Rect) -> f32 {
    rect.width() * rect.height()
}

/// Returns the area that two rectangles have in common.
fn common(a: Rect, b: Rect) -> f32 {
    let both = a.intersect(b);
    if both.is_positive() { area(both) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use emath::pos2;

    const FRAME: Rect = Rect {
        min: pos2(0.0, 0.0),
        max: pos2(400.0, 300.0),
    };

    fn mark(x: f32, y: f32) -> Labelled {
        Labelled {
            at: pos2(x, y),
            radius: 8.0,
            size: vec2(24.0, 16.0),
        }
    }

    #[test]
    fn labels_of_near_marks_cover_neither_each_other_nor_a_mark() {
        // Pairs in all directions, as near as marks between which one chooses may be, and a third beside them.
        for degrees in (0..360).step_by(15) {
            let away = 24.0 * Vec2::angled((degrees as f32).to_radians());
            let marks = [
                mark(200.0, 150.0),
                mark(200.0 + away.x, 150.0 + away.y),
                mark(226.0, 176.0),
            ];
            let marks = if marks[1].at.distance(marks[2].at) < 24.0 {
                &marks[..2]
            } else {
                &marks[..]
            };
            let labels = places(marks, &[], FRAME);
            for (i, label) in labels.iter().enumerate() {
                assert!(FRAME.contains_rect(*label));
                let others = labels.iter().enumerate().filter(|(j, _)| *j != i);
                assert!(
                    others
                        .clone()
                        .all(|(_, other)| common(*label, *other) <= 0.0),
                    "{degrees}: {labels:?}"
                );
                let mut rings = marks.iter().enumerate().filter(|(j, _)| *j != i);
                assert!(
                    rings.all(|(_, other)| common(*label, other.ring()) <= 0.0),
                    "{degrees}: {labels:?}"
                );
            }
        }
    }

    #[test]
    fn a_label_stays_in_the_frame_and_off_what_is_taken() {
        let corner = places(&[mark(395.0, 5.0)], &[], FRAME)[0];
        assert!(FRAME.contains_rect(corner), "{corner:?}");

        let usual = places(&[mark(200.0, 150.0)], &[], FRAME)[0];
        assert!(usual.min.x > 200.0 && usual.min.y < 150.0, "{usual:?}");
        let other = places(&[mark(200.0, 150.0)], &[usual], FRAME)[0];
        assert!(common(usual, other) <= 0.0, "{usual:?} {other:?}");
    }
}
