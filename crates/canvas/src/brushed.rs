//! The brushed range of a chart on the canvas: edges between pairs of samples at the selected distances, and a tint of
//! samples by their contribution to the power at the selected frequencies. `tilescope-workbench` finds both.

use egui::Pos2;
use tilescope_core::Stage;
use tilescope_drawing::parts;
use tilescope_drawing::scene::Scene;
use tilescope_drawing::surface::Surface;
use tilescope_session::words::{counted, grouped};

use crate::raster::MadeFrom;
use tilescope_drawing::brushed::Cause;

/// The edges in view, cached until the moment, the view or the brush changes.
#[derive(Default)]
pub struct Edges {
    made_from: Option<MadeFrom>,
    ends: Vec<[Pos2; 2]>,
    in_view: usize,
    /// A short description of the brush; `None` if it draws nothing.
    brushed: Option<String>,
}

impl Edges {
    /// Updates the edges for the moment and view shown.
    pub fn follow(&mut self, scene: &Scene<'_>, made_from: MadeFrom) {
        if self.made_from.as_ref() == Some(&made_from) {
            return;
        }
        self.made_from = Some(made_from);
        (self.ends, self.in_view) = parts::pairs_in_view(scene);
        let cause = scene.subject.causes.map(|found| &found.cause);
        self.brushed = cause
            .filter(|_| scene.stage >= Stage::Tile)
            .and_then(described);
    }

    /// Draws the edges in view.
    pub fn draw(&self, scene: &Scene<'_>, surface: &mut impl Surface) {
        parts::draw_pairs(scene, &self.ends, surface);
    }

    /// Returns a description of the brush, with a remark if edges are left out; none are drawn where there are so many
    /// samples in view that it is `crowded`. `None` without a brush.
    pub fn note(&self, crowded: bool) -> Option<String> {
        if crowded && self.in_view > 0 {
            return Some(
                "Too many samples in view to join the brushed pairs by lines: zoom in.".to_owned(),
            );
        }

        let brushed = self.brushed.as_ref()?;
        // Only the edges in the middle of the view are kept where there are very many.
        if self.in_view > self.ends.len() {
            return Some(format!(
                "{brushed} {} in view: the {} nearest to the middle are drawn. Zoom in.",
                grouped(self.in_view),
                grouped(self.ends.len())
            ));
        }
        Some(brushed.clone())
    }
}

/// Describes the brush in a sentence; `None` if it draws nothing.
fn described(cause: &Cause) -> Option<String> {
    let text = match cause {
        // Without pairs at its distances, or frequencies in its range, the brush draws nothing and needs no remark.
        Cause::Pairs { total: 0, .. } | Cause::Shares { frequencies: 0, .. } => return None,
        // The search keeps pairs from the bottom of the domain upwards, until no more can be drawn.
        Cause::Pairs { total, pairs } if *total > pairs.len() as u64 => format!(
            "Brushed: {} pairs; the {} lowest in the domain are kept.",
            grouped(*total as usize),
            grouped(pairs.len())
        ),
        Cause::Pairs { total, .. } => {
            format!("Brushed: {}.", counted(*total as usize, "pair", "pairs"))
        }
        Cause::Shares { .. } => {
            "Brushed frequencies tint the samples: red adds more than the mean, blue less."
                .to_owned()
        }
    };
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tilescope_drawing::brushed::Pair;

    #[test]
    fn the_remark_names_the_brush_and_omitted_pairs() {
        let pair = Pair {
            ids: [0, 1],
            offset: [1.0, 0.0].into(),
        };
        let pairs = |total, kept| Cause::Pairs {
            total,
            pairs: vec![pair; kept],
        };
        assert_eq!(described(&pairs(0, 0)), None);
        assert_eq!(described(&pairs(2, 2)).unwrap(), "Brushed: 2 pairs.");
        let cut = described(&pairs(1_000, 2)).unwrap();
        assert!(cut.contains("the 2 lowest in the domain are kept"), "{cut}");
    }
}
