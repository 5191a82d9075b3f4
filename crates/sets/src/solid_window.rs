//! Windows of space without end, with the samples around them, to be judged.

use tilescope_analysis::{
    Boundary, Control, SolidError, SolidRegion, SolidReport, VerifyOptions, verify_solid_cut,
};
use tilescope_core::{
    Observer, R, SOLID_DENSITY, SampleError, SolidArrivals, SolidSpace, SolidWindow,
};

/// How far around a window samples are judged, in lattice units. A place of the window may be covered by a sample that
/// is a radius away, and the judge asks for more than a radius around the window. Two radii are enough.
const MARGIN: i32 = 2 * R;

/// The samples in a window of space and around it.
#[derive(Clone, Debug)]
pub struct SolidSurroundings {
    arrived: SolidArrivals,
    window: SolidWindow,
    /// The part that the samples fill.
    wide: SolidWindow,
    radius: f64,
}

impl SolidSurroundings {
    /// Returns about how many samples a window has together with the margin around it, which has most of them for a thin window.
    #[must_use]
    pub fn expected_samples(window: &SolidWindow) -> f64 {
        SOLID_DENSITY * window.widened(MARGIN).volume_radii()
    }

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
        Ok(Self {
            arrived: space.arrivals(&wide, observer)?,
            window: *window,
            wide,
            radius: space.radius(),
        })
    }

    /// Returns the samples of the window itself, which are among those that are judged.
    #[must_use]
    pub fn inside(&self) -> SolidArrivals {
        let mut inside = SolidArrivals::default();
        let each = (self.arrived.places.iter()).zip(self.arrived.levels.of_samples());
        for (&place, level) in each.filter(|&(place, _)| self.window.contains(*place)) {
            inside.places.push(place);
            inside.levels.add(level.into(), 1);
        }
        inside
    }

    /// Judges the window by all samples in and around it: conflicts count wherever they are, gaps in the window.
    ///
    /// # Errors
    ///
    /// [`SolidError`] when there is no verdict.
    pub fn judge(&self, control: Control<'_>) -> Result<SolidReport, SolidError> {
        // The judge gets positions from the lower corner of `wide` on. There they are small, so that doubles round them
        // little, however far from 0 the window lies. They are subtracted as doubles, as the difference of two places
        // may be larger than the largest 32-bit integer.
        let unit = self.radius / f64::from(R);
        let low = self.wide.min;
        let local = |place: [i32; 3], axis: usize| f64::from(place[axis]) - f64::from(low[axis]);
        let user = |place: [i32; 3]| [0, 1, 2].map(|axis| local(place, axis) * unit);

        let points: Vec<[f64; 3]> = self.arrived.places.iter().copied().map(user).collect();
        let [width, height, depth] = user(self.wide.max);
        let region = SolidRegion {
            width,
            height,
            depth,
            boundary: Boundary::Bounded,
        };
        let corners = [user(self.window.min), user(self.window.max)];
        let (asked, options) = ((region, self.radius), VerifyOptions::default());
        verify_solid_cut(&points, asked, corners, &options, control)
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

        // Those inside are the window that is made alone, and the estimate counts those around it, too.
        let inside = made.inside();
        assert_eq!(inside, space.arrivals(&window, &mut Unobserved).unwrap());
        assert!((25..60).contains(&inside.places.len()), "{inside:?}");
        let (all, expected) = (
            made.arrived.places.len(),
            SolidSurroundings::expected_samples(&window),
        );
        assert!(
            (all as f64 / expected - 1.0).abs() < 0.1,
            "{all} {expected}"
        );

        for index in 0..all {
            let mut fewer = made.clone();
            let removed = fewer.arrived.places.remove(index);
            assert!(
                !window.contains(removed) || !judged(&fewer).maximal(),
                "{removed:?}"
            );
        }
        let mut more = made.clone();
        // By 64 units on each axis, of which a radius has 2^15.
        more.arrived
            .places
            .push(made.arrived.places[0].map(|at| at + 64));
        assert_eq!(judged(&more).conflicts, 1);
    }
}
