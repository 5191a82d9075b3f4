//! Exports of sets in space: balls, as they are seen on the canvas, and the passage of a plane.

use tilescope_drawing::orbit::{MAX_PICTURE_SIDE, TURN_FRAMES};
use tilescope_session::words::grouped;

use super::{ExportSource, checked_view, size_text};
use crate::export::write::PASSAGE_FRAMES;
use crate::export::{BallsView, ExportForm, ExportKind, ExportRefusal, PassageView};

impl ExportSource<'_> {
    /// Returns whether the sheet's picture or animation is one of balls, which the canvas shows.
    #[must_use]
    pub fn shows_balls(&self, kind: ExportKind) -> bool {
        matches!(kind, ExportKind::Picture | ExportKind::Animation) && self.run.orbit().is_some()
    }

    /// Returns whether the sheet's animation is the passage of the plane through a set in space: if that was chosen, or if the
    /// set has no events.
    #[must_use]
    pub fn shows_passage(&self, form: &ExportForm) -> bool {
        let session = self.run.session.as_deref();
        let Some(session) = session.filter(|session| session.solid.is_some()) else {
            return false;
        };
        form.kind == ExportKind::Animation
            && !self.shows_balls(form.kind)
            && (form.passage || session.recording().is_none())
    }

    /// Returns whether there is a plane to pass through the set, and whether there are events to show.
    #[must_use]
    pub fn plane_and_events(&self) -> (bool, bool) {
        let session = self.run.session.as_deref();
        (
            session.is_some_and(|session| session.solid.is_some()),
            session.is_some_and(|session| session.recording().is_some()),
        )
    }

    /// Returns the view of a picture of balls, as on the canvas.
    pub(super) fn balls(&self, form: &ExportForm) -> Result<BallsView, ExportRefusal> {
        // Callers have asked `shows_balls`, so that balls are shown and this refusal never comes.
        let orbit = self.run.orbit().ok_or(ExportRefusal::NoSession)?;
        if !self.run.viewport.is_positive() {
            return Err(ExportRefusal::NoCanvas);
        }

        // A vector picture holds the balls as pixels, too: one for each point of the window.
        let scale = if form.has_scale() { form.scale()? } else { 1.0 };
        let sides = self.run.viewport.size() * scale as f32;
        let [width, height] = [sides.x, sides.y].map(|side| side.round().max(1.0) as u32);
        let side = MAX_PICTURE_SIDE as usize;
        if width.max(height) > MAX_PICTURE_SIDE {
            return Err(ExportRefusal::TooLarge {
                width: width as usize,
                height: height as usize,
                pixels: side * side,
                side,
            });
        }
        Ok(BallsView {
            view: orbit.view(),
            size: [width, height],
            is_dark: self.appearance.look.is_dark() && !form.print,
            caption: self.caption.unwrap_or_default().to_owned(),
            legend: form.legend,
        })
    }

    /// Returns a short description of a picture or an animation of balls.
    pub(super) fn balls_prospect(&self, form: &ExportForm) -> Result<String, ExportRefusal> {
        let [width, height] = self.balls(form)?.size.map(|side| grouped(side as usize));
        let size = format!("{width} x {height} pixels");
        if form.kind == ExportKind::Picture {
            return Ok(format!("The balls of the set, {size}"));
        }
        let secs = seconds(TURN_FRAMES, form)?;
        Ok(format!(
            "A turn in {TURN_FRAMES} frames, {size}, {secs:.1} s"
        ))
    }

    /// Returns the view of the passage of the plane.
    pub(super) fn passage(&self, form: &ExportForm) -> Result<PassageView, ExportRefusal> {
        let (mut shown, scale) = checked_view(form, *self)?;
        // The sheet does not offer it here, where it may have been chosen for something else.
        shown.view.analysis = false;
        Ok(PassageView { shown, scale })
    }

    /// Returns a short description of that animation.
    pub(super) fn passage_prospect(&self, form: &ExportForm) -> Result<String, ExportRefusal> {
        let PassageView { shown, scale } = self.passage(form)?;
        let size = size_text(&shown.view, scale);
        let secs = seconds(PASSAGE_FRAMES, form)?;
        Ok(format!("{PASSAGE_FRAMES} planes, {size}, {secs:.1} s"))
    }
}

/// Returns how long an animation of so many frames takes.
pub(super) fn seconds(frames: usize, form: &ExportForm) -> Result<f64, ExportRefusal> {
    // A delay counts hundredths of a second.
    Ok(frames as f64 * f64::from(form.delay()?) / 100.0)
}
