//! A window of a plane with a margin around it, as a set of its own. Whether the set is valid is judged by the caller,
//! since the core has no verifier.

use glam::I64Vec2;

use crate::error::SampleError;
use crate::lattice::{Domain, Point, Window};

/// Radii around a window that a [`WidenedWindow`] has, although 2 suffice to judge the window. Chosen, not measured.
const MARGIN: i64 = 4;

/// The samples of a window and around it, as far as the domain reaches. Positions are in user units, from the lowest corner
/// of the whole; those of a periodic domain may come twice, if the window with its margin is longer than the domain.
#[derive(Clone, Debug, PartialEq)]
pub struct WidenedWindow {
    /// The samples of the window and of its margin.
    pub positions: Vec<[f64; 2]>,
    /// The width and the height of the window with its margin, in user units.
    pub size: [f64; 2],
    /// The lowest and the highest corner of the window, as the verifier takes them.
    pub window: [[f64; 2]; 2],
}

impl WidenedWindow {
    /// Returns a window with a margin around it, of a set whose radius has `radius` units. `find` returns the samples of a
    /// window.
    pub(crate) fn of(
        window: &Window,
        domain: &Domain,
        radius: i32,
        find: impl FnOnce(&Window) -> Result<Vec<Point>, SampleError>,
    ) -> Result<Self, SampleError> {
        let margin = MARGIN * i64::from(radius);
        let periodic = domain.is_periodic();
        let sides = [domain.width(), domain.height()];
        let unit = domain.unit();

        let mut wide = Window {
            min: window.min - margin,
            max: window.max + margin,
        };
        // Beyond a closed border there are no samples.
        if !periodic {
            wide.min = wide.min.max(I64Vec2::ZERO);
            wide.max = wide.max.min(domain.rect().max.into());
        }

        let user = |offset: I64Vec2| (offset.as_dvec2() * unit).to_array();

        // A window is at most as long as the domain, and its two margins, 8 r, are shorter than any periodic domain, which
        // has at least 10 r. Together they are shorter than two domains: a sample has at most two images in them.
        let images = |v: i32, axis: usize| {
            let (side, first) = (i64::from(sides[axis]), i64::from(v) - wide.min[axis]);
            let (first, step) = if periodic {
                (first.rem_euclid(side), side)
            } else {
                // A bounded domain shows a sample once: the second place is far beyond the window.
                (first, i64::MAX / 2)
            };
            let length = wide.max[axis] - wide.min[axis];
            (0..2)
                .map(move |k| first + k * step)
                .filter(move |&offset| offset < length)
                .map(move |offset| offset as f64 * unit[axis])
        };

        let shown = |p: &Point| {
            let xs = images(p.x, 0);
            images(p.y, 1)
                .flat_map(move |y| xs.clone().map(move |x| [x, y]))
                .collect::<Vec<_>>()
        };

        let samples = find(&wide)?;
        // A bounded set is closed: it ends with its last line of lattice points, one unit before `max`.
        let last = i64::from(!periodic);
        Ok(Self {
            positions: samples.iter().flat_map(shown).collect(),
            size: user(wide.max - wide.min - last),
            // The upper corner may lie one unit beyond the set, where there is nothing to judge.
            window: [window.min, window.max].map(|corner| user(corner - wide.min)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::parallel::plane::Plane;
    use crate::engine::parallel::window_maker::WindowMaker;
    use crate::lattice::Boundary;
    use crate::parameters::Parameters;
    use crate::pattern::Pattern;
    use crate::progress::Unobserved;

    fn widened(boundary: Boundary, low: [f64; 2], high: [f64; 2]) -> WidenedWindow {
        let parameters = Parameters {
            radius: 0.05,
            boundary,
            ..Parameters::default()
        };
        let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
        let plane = Plane::new(&parameters, &pattern).unwrap();
        let window = plane.domain().window(low, high).unwrap();
        plane.widened(&window, &mut Unobserved).unwrap()
    }

    #[test]
    fn a_margin_of_four_radii_ends_at_a_closed_border() {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-4;
        let inside = widened(Boundary::Bounded, [0.4, 0.4], [0.5, 0.6]);
        assert!(
            near(inside.size[0], 0.5) && near(inside.size[1], 0.6),
            "{:?}",
            inside.size
        );
        let corner = widened(Boundary::Bounded, [0.0, 0.0], [0.1, 0.1]);
        assert!(near(corner.size[0], 0.3) && corner.window[0].iter().all(|v| v.abs() < 1e-12));
        assert!(corner.window[1].iter().all(|&v| near(v, 0.1)));
    }

    #[test]
    fn a_cut_longer_than_a_periodic_domain_has_samples_twice() {
        let whole = widened(Boundary::Periodic, [0.0, 0.0], [1.0, 1.0]);
        let small = widened(Boundary::Periodic, [0.0, 0.0], [0.1, 0.1]);
        let mut all = whole.positions.clone();
        all.retain(|[x, y]| *x < 1.0 && *y < 1.0);
        assert!(whole.positions.len() > all.len() && all.len() > small.positions.len());
    }
}
