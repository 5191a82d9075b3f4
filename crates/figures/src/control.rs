//! Asks the caller, while a picture is made, whether to go on.

use std::ops::ControlFlow;

use crate::error::FigureError;

/// Called with the steps that are done and all there are, every few shapes and for every row of pixels. `Break` ends the
/// work with [`FigureError::Cancelled`].
pub type Control<'a> = &'a mut dyn FnMut(usize, usize) -> ControlFlow<()>;

/// Lets every picture be finished.
pub(crate) const fn go_on(_: usize, _: usize) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Shapes between two calls. The largest take about a millisecond each.
const STRIDE: usize = 64;

/// Counts steps and calls the control function at intervals.
pub(crate) struct Steps<'a> {
    control: Control<'a>,
    done: usize,
    total: usize,
}

impl<'a> Steps<'a> {
    pub(crate) fn new(total: usize, control: Control<'a>) -> Self {
        Self {
            control,
            done: 0,
            total,
        }
    }

    /// Counts a shape as a step, and asks now and then whether to go on.
    pub(crate) fn shape(&mut self) -> Result<(), FigureError> {
        self.done += 1;
        if self.done.is_multiple_of(STRIDE) {
            self.ask()
        } else {
            Ok(())
        }
    }

    /// Counts one row of pixels, which takes longer than most shapes.
    pub(crate) fn row(&mut self) -> Result<(), FigureError> {
        self.done += 1;
        self.ask()
    }

    fn ask(&mut self) -> Result<(), FigureError> {
        match (self.control)(self.done, self.total) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(FigureError::Cancelled),
        }
    }
}

#[cfg(test)]
mod tests {
    use tilescope_core::Boundary;

    use super::*;
    use crate::canvas::PictureOptions;
    use crate::set::{DiskRadii, SetPicture, set_scene, set_scene_controlled};
    use crate::{
        Scene, to_png, to_png_controlled, to_svg_with_fonts, to_svg_with_fonts_controlled,
    };

    /// Returns how often the control function of a picture is called, with rising counts.
    fn calls(make: &dyn Fn(Control<'_>) -> Result<Vec<u8>, FigureError>) -> usize {
        let (mut calls, mut before) = (0, 0);
        let made = make(&mut |done, total| {
            assert!(before < done && done <= total, "{done} of {total} steps");
            (calls, before) = (calls + 1, done);
            ControlFlow::Continue(())
        });
        made.expect("drawable");
        calls
    }

    /// Checks that a picture whose control function breaks at a call, from the first to the last, is cancelled there.
    fn stops_where_asked(make: &dyn Fn(Control<'_>) -> Result<Vec<u8>, FigureError>) {
        let all = calls(make);
        for last in (1..all).step_by(all.div_ceil(8)).chain([all]) {
            let mut count = 0;
            let made = make(&mut |_, _| {
                count += 1;
                if count == last {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            });
            assert_eq!(made, Err(FigureError::Cancelled));
            assert_eq!(count, last, "it goes on after it was stopped");
        }
    }

    fn set(points: &[[f64; 2]]) -> SetPicture<'_> {
        SetPicture {
            points,
            size: [1.0; 2],
            boundary: Boundary::Bounded,
            radii: DiskRadii::Equal(0.05),
            blocks: Vec::new(),
            block_of: None,
            exposed: Vec::new(),
            plane: None,
            caption: "many samples".to_owned(),
        }
    }

    fn scattered(count: usize) -> Vec<[f64; 2]> {
        let place = |index: usize| {
            let turns = index as f64 * 0.618_033_988_75;
            [turns.fract(), (index as f64 + 0.5) / count as f64]
        };
        (0..count).map(place).collect()
    }

    fn scene(count: usize) -> Scene {
        let options = PictureOptions {
            width: 300.0,
            ..PictureOptions::default()
        };
        set_scene(&set(&scattered(count)), &options)
    }

    #[test]
    fn a_scene_asks_while_samples_are_laid_out() {
        let points = scattered(1000);
        let options = PictureOptions::default();
        let make = |control: Control<'_>| {
            let scene = set_scene_controlled(&set(&points), &options, control)?;
            Ok(vec![0; scene.groups.len()])
        };
        // Disks, then dots.
        assert!(calls(&make) >= 2 * 1000 / STRIDE);
        stops_where_asked(&make);
    }

    #[test]
    fn a_png_asks_while_shapes_are_drawn_and_for_every_row_that_is_compressed() {
        let (few, many) = (scene(1), scene(1000));
        let png =
            |scene: Scene| move |control: Control<'_>| to_png_controlled(&scene, 1.0, control);
        let rows = calls(&png(few));
        assert!(rows >= 300, "{rows} calls for 300 rows and more");
        let drawing = calls(&png(many.clone())) - rows;
        assert!(drawing >= 1000 / STRIDE, "{drawing} calls for 1000 dots");
        stops_where_asked(&png(many));
    }

    #[test]
    fn an_svg_asks_while_shapes_are_written() {
        let many = scene(1000);
        let make = |control: Control<'_>| {
            to_svg_with_fonts_controlled(&many, control).map(String::into_bytes)
        };
        assert!(calls(&make) >= 1000 / STRIDE);
        stops_where_asked(&make);
    }

    #[test]
    fn a_picture_that_is_not_stopped_is_the_same() {
        let many = scene(500);
        let png = to_png_controlled(&many, 1.0, &mut go_on);
        assert_eq!(png, to_png(&many, 1.0));
        let svg = to_svg_with_fonts_controlled(&many, &mut go_on);
        assert_eq!(svg, to_svg_with_fonts(&many));
    }
}
