//! Windows of space without end, with what is around them, to be judged.

use tilescope_analysis::{
    Boundary, Control, SolidError, SolidRegion, SolidReport, VerifyOptions, verify_solid_cut,
};
use tilescope_core::{Observer, R, SampleError, SolidSpace, SolidWindow};

/// How far around a window samples are judged, in lattice units: whether a place of it is covered may depend on samples a radius
/// away, and a hair more.
const MARGIN: i32 = 2 * R;

/// The samples in a window of space and around it.
#[derive(Clone, Debug)]
pub struct SolidSurroundings {
    /// From the lowest corner of the part on.
    points: Vec<[f64; 3]>,
    /// The part that they fill.
    region: SolidRegion,
    radius: f64,
    /// The corners of the window in that part.
    corners: [[f64; 3]; 2],
}

impl SolidSurroundings {
    /// Makes the samples in and around a window.
    ///
    /// # Errors
    ///
    /// As [`SolidSpace::samples`].
    pub fn of(
        space: &SolidSpace,
        window: &SolidWindow,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        let wide = window.widened(MARGIN);
        // From the corner of the part on, where positions are not rounded.
        // In doubles: two places may be farther apart than the largest 32-bit integer.
        let unit = space.radius() / f64::from(R);
        let local =
            |place: [i32; 3], axis: usize| f64::from(place[axis]) - f64::from(wide.min[axis]);
        let user = |place: [i32; 3]| [0, 1, 2].map(|axis| local(place, axis) * unit);
        let places = space.samples(&wide, observer)?;

        let [width, height, depth] = user(wide.max);
        Ok(Self {
            points: places.into_iter().map(user).collect(),
            region: SolidRegion {
                width,
                height,
                depth,
                boundary: Boundary::Bounded,
            },
            radius: space.radius(),
            corners: [user(window.min), user(window.max)],
        })
    }

    /// Judges the window by all samples in and around it: conflicts count wherever they are, gaps in the window.
    ///
    /// # Errors
    ///
    /// [`SolidError`] when there is no verdict.
    pub fn judge(&self, control: Control<'_>) -> Result<SolidReport, SolidError> {
        let asked = (self.region, self.radius);
        let options = VerifyOptions::default();
        verify_solid_cut(&self.points, asked, self.corners, &options, control)
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use tilescope_core::Unobserved;

    use super::*;

    /// Control: without a sample of it, a window has a gap.
    #[test]
    fn windows_are_maximal_and_faults_in_them_are_seen() {
        let space = SolidSpace::new(0.5, 3).unwrap();
        let window = space.window([-7.0, 0.3, 2.0], [-5.0, 2.0, 4.0]).unwrap();
        let made = SolidSurroundings::of(&space, &window, &mut Unobserved).unwrap();
        let judged = |made: &SolidSurroundings| made.judge(&|_| ControlFlow::Continue(())).unwrap();
        assert!(judged(&made).valid());

        let [low, high] = made.corners;
        let inside =
            |at: &[f64; 3]| (0..3).all(|axis| low[axis] < at[axis] && at[axis] < high[axis]);
        let count = made.points.iter().filter(|point| inside(point)).count();
        assert!((25..60).contains(&count), "{count}");
        for index in 0..made.points.len() {
            let mut fewer = made.clone();
            let removed = fewer.points.remove(index);
            assert!(
                !inside(&removed) || !judged(&fewer).maximal(),
                "{removed:?}"
            );
        }
        let mut more = made.clone();
        more.points.push(made.points[0].map(|at| at + 1e-3));
        assert_eq!(judged(&more).conflicts, 1);
    }
}
