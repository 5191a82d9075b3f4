//! The part of the domain that a picture shows, and how many samples lie in it.

use std::fmt;

use anyhow::{Result, ensure};
use tilescope_analysis::Region;
use tilescope_figures::Rect;

/// Returns the part of the domain to draw, whose lower corner lies at `origin` in the units of the file; `None`, for
/// the whole domain, if no part is given.
pub fn window(given: Option<&[f64]>, region: &Region, origin: [f64; 2]) -> Result<Option<Rect>> {
    let Some(&[x0, y0, x1, y1]) = given else {
        return Ok(None);
    };
    ensure!(
        [x0, y0, x1, y1].iter().all(|v| v.is_finite()) && x0 < x1 && y0 < y1,
        "--window is {x0} {y0} {x1} {y1}; it must be X0 < X1 and Y0 < Y1"
    );

    // In the picture the domain's lower corner lies at zero.
    let [left, right] = [x0, x1].map(|x| x - origin[0]);
    let [bottom, top] = [y0, y1].map(|y| y - origin[1]);
    // A window may reach beyond the domain, but it has to overlap it.
    ensure!(
        right > 0.0 && top > 0.0 && left < region.width && bottom < region.height,
        "--window is {x0} {y0} {x1} {y1}; it lies outside the domain, {} x {} at {} {}",
        region.width,
        region.height,
        origin[0],
        origin[1]
    );
    Ok(Some(Rect::new([left, bottom], [right, top])))
}

/// How many samples a picture shows.
pub struct Shown {
    count: usize,
    /// All samples that there are, where the picture shows a part of the domain.
    all: Option<usize>,
}

impl Shown {
    /// Counts the samples whose places lie in a window; without one, all.
    pub fn of(points: &[[f64; 2]], region: &Region, window: Option<Rect>) -> Self {
        let all = points.len();
        let Some(window) = window else {
            return Self {
                count: all,
                all: None,
            };
        };

        // Around the torus a sample has images in all directions, and a window may reach into the next period.
        let is_in = |value: f64, [low, high]: [f64; 2], period: f64| {
            let first_behind = if region.is_periodic() {
                value + ((low - value) / period).ceil() * period
            } else {
                value
            };
            (low..=high).contains(&first_behind)
        };
        let sides = |axis: usize| [window.min[axis], window.max[axis]];
        let is_shown = |&[x, y]: &[f64; 2]| {
            is_in(x, sides(0), region.width) && is_in(y, sides(1), region.height)
        };
        Self {
            count: points.iter().filter(|point| is_shown(point)).count(),
            all: Some(all),
        }
    }
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.count)?;
        match self.all {
            Some(all) => write!(f, " of {all}"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_counted_in_the_window_alone() {
        let points = [[1.0, 1.0], [9.5, 1.0], [5.0, 5.0]];
        let window = Some(Rect::new([-1.0, 0.0], [2.0, 3.0]));
        let said = |is_periodic, window| {
            let region = Region::new([10.0; 2], is_periodic);
            Shown::of(&points, &region, window).to_string()
        };
        assert_eq!(said(true, None), "3");
        // The image of the second sample, one period to the left, is in the window.
        assert_eq!(said(true, window), "2 of 3");
        assert_eq!(said(false, window), "1 of 3");
    }
}
