//! Exports of the making of a stipple: its dots in the order of their arrival.

use tilescope_figures::MAX_SIDE;
use tilescope_figures::animation::MAX_FRAME_PIXELS;
use tilescope_session::words::grouped;

use super::ExportSource;
use super::balls::seconds;
use crate::export::write::making_frames;
use crate::export::{ExportForm, ExportRefusal};

impl ExportSource<'_> {
    /// Returns how many pixels the frames are wide, or why they would be too large.
    pub(super) fn making_columns(&self, form: &ExportForm) -> Result<u32, ExportRefusal> {
        let columns = form.columns()?;
        let size = self.session()?.size_radii();
        // As `on_paper` lays the picture out.
        let rows = (size.y / size.x * f64::from(columns)).round().max(1.0);

        let pixels = f64::from(columns) * rows;
        let fits = rows <= MAX_SIDE && pixels <= MAX_FRAME_PIXELS as f64;
        if !fits {
            return Err(ExportRefusal::TooLarge {
                width: columns as usize,
                height: rows as usize,
                pixels: MAX_FRAME_PIXELS as usize,
                side: MAX_SIDE as usize,
            });
        }
        Ok(columns)
    }

    /// Returns a short description of the animation.
    pub(super) fn making_prospect(&self, form: &ExportForm) -> Result<String, ExportRefusal> {
        form.ink.look()?;
        let columns = grouped(self.making_columns(form)? as usize);
        let frames = making_frames(self.session()?.summary.count);
        let secs = seconds(frames, form)?;
        Ok(format!(
            "{frames} frames, {columns} pixels wide, {secs:.1} s"
        ))
    }
}
