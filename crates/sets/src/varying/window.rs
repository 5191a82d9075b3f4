//! Windows of sets whose radius varies, or that cover a shape, with the samples around them, to be judged.

use std::sync::Arc;

use tilescope_analysis::{Control, CutReport, VerifyError, VerifyOptions};
use tilescope_core::{
    ExactPlane, Observer, ParameterError, PatternHistory, Point, R, Window, WindowMaker,
    expected_in_window, varying_window, window_parts,
};
use tilescope_formats::PointSet;

use super::{ExactBlocks, Ground, VaryingError, VaryingRecipe};
use crate::facts::Facts;
use crate::recipe::facts_of_exact;

/// How far around a window an exact tiling is made to judge it, in lattice units: a place may be covered by a sample that is a
/// radius away, and a sample may be in conflict with one as far.
const MARGIN: i64 = R as i64;

/// The samples in a window of a set that was not made as a whole, and those around it.
#[derive(Clone, Debug)]
pub struct WindowMade {
    /// The samples in the window, in the order that they have in the whole set.
    pub set: PointSet,
    /// How the whole set is made.
    pub facts: Facts,
    /// The positions in the window and around it.
    all: Vec<[f64; 2]>,
    /// What the window shows of the domain: rectangles of lattice points, each from its lowest to its highest.
    shown: Vec<[[i32; 2]; 2]>,
}

impl WindowMade {
    /// Judges the window by the samples in it and around it: places of the window have to be covered, and samples in it must not
    /// be in conflict with any.
    ///
    /// # Errors
    ///
    /// [`VerifyError`] when there is no verdict.
    pub fn judge(
        &self,
        options: &VerifyOptions,
        control: Control<'_>,
    ) -> Result<CutReport, VerifyError> {
        let Some(varying) = &self.facts.varying else {
            return Err(VerifyError::Empty);
        };
        varying
            .judged
            .verify_window(&self.all, &self.shown, options, control)
    }
}

impl Ground {
    /// Returns the window between two corners, in the coordinates of polygons and expressions. Of a bounded domain it is cut at
    /// the border, beyond which it may lie as a whole.
    ///
    /// # Errors
    ///
    /// [`ParameterError`] when a side is not above 0, or longer than the domain, or too far away.
    pub fn window(&self, [left, bottom, right, top]: [f64; 4]) -> Result<Window, ParameterError> {
        let [x, y] = self.origin;
        let domain = self.field.domain();
        let window = domain.window([left - x, bottom - y], [right - x, top - y]);
        // The error names the corners as they were given.
        window.map_err(|error| match error {
            ParameterError::Window { name, maximum, .. } => {
                let (low, high) = if name == "width" {
                    (left, right)
                } else {
                    (bottom, top)
                };
                ParameterError::Window {
                    name,
                    low,
                    high,
                    maximum,
                }
            }
            other => other,
        })
    }

    /// Returns about how many samples lie in a window, if all of it is covered.
    #[must_use]
    pub fn expected_in(&self, window: &Window) -> f64 {
        expected_in_window(&self.field, window)
    }
}

impl VaryingRecipe {
    /// Makes the samples of the set that lie in a window, without the others. `ground` is that of [`Self::ground`].
    ///
    /// # Errors
    ///
    /// [`VaryingError::WindowCount`] of a recipe with a count, and as [`Self::make`]. A window may have no sample.
    pub fn make_window(
        &self,
        ground: &Ground,
        window: &Window,
        observer: &mut dyn Observer,
    ) -> Result<WindowMade, VaryingError> {
        if let Some(count) = self.count {
            return Err(VaryingError::WindowCount { count });
        }

        let (facts, inside, around) = if let Some(blocks) = self.exact {
            self.tiled_window(ground, blocks, window, observer)?
        } else {
            let (field, shape) = (&ground.field, &ground.shape);
            let made = varying_window(field, shape, self.seed, window, observer)?;
            let facts = self.facts_of_darts(&self.radius, ground);
            (facts, made.inside, made.around)
        };

        let domain = ground.field.domain();
        let set = PointSet::from_points(domain.users_from_lattice(&inside));
        // The judge looks at samples in the window and around it alike.
        let mut all = set.points.clone();
        all.extend(domain.users_from_lattice(&around));
        let shown = window_parts(domain, window).map(|part| {
            let last = Point::new(part.max.x - 1, part.max.y - 1);
            [part.min, last].map(|place| [place.x, place.y])
        });
        Ok(WindowMade {
            set,
            facts,
            all,
            shown: shown.collect(),
        })
    }

    /// Returns the facts of an exact tiling, and its samples in a window and around it.
    fn tiled_window(
        &self,
        ground: &Ground,
        blocks: ExactBlocks,
        window: &Window,
        observer: &mut dyn Observer,
    ) -> Result<(Facts, Vec<Point>, Vec<Point>), VaryingError> {
        let parameters = self.tiling_of(&self.radius, ground, blocks)?;
        let history = PatternHistory::of_spec(&blocks.pattern, observer)?;
        let plane = ExactPlane::new(&parameters, &history)?.in_shape(&ground.shape);
        // Exact tilings have windows of their own, without the samples around them.
        let wide = window.grown(MARGIN, MARGIN);
        let found = plane.observed_window(&wide, observer)?;

        let domain = plane.domain();
        let parts: Vec<_> = window_parts(domain, window).collect();
        let is_inside = |point: &Point| parts.iter().any(|part| part.contains(*point));
        let (inside, around) = found.into_iter().partition(is_inside);

        // How many samples the whole set has is estimated, as it is not made.
        let samples = self.expected(&self.radius)?;
        let facts = facts_of_exact(&parameters, domain, history.pattern(), samples);
        let facts = Facts {
            origin: ground.origin,
            varying: Some(Arc::clone(&ground.varying)),
            ..self.with_shape(facts)
        };
        Ok((facts, inside, around))
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use tilescope_core::{Parameters, Unobserved};

    use super::*;
    use crate::varying::tests::{park, recipe};
    use crate::varying::{Expression, RadiusSource};

    fn in_park(radius: RadiusSource) -> VaryingRecipe {
        VaryingRecipe {
            shape: Some(park()),
            ..recipe(radius)
        }
    }

    fn made(recipe: &VaryingRecipe, corners: [f64; 4]) -> WindowMade {
        let ground = recipe.ground().unwrap();
        let window = ground.window(corners).unwrap();
        recipe
            .make_window(&ground, &window, &mut Unobserved)
            .unwrap()
    }

    fn report(made: &WindowMade) -> CutReport {
        let options = VerifyOptions::default();
        made.judge(&options, &|_| ControlFlow::Continue(()))
            .unwrap()
    }

    /// Checks windows against the whole set, and that faults in them are seen. `origin` is where the domain lies.
    fn check(recipe: &VaryingRecipe, corners: [f64; 4]) {
        let ground = recipe.ground().unwrap();
        let [x, y] = ground.origin;
        let whole = recipe.make(&mut Unobserved).unwrap();
        let is_inside = |[a, b]: &[f64; 2]| {
            let [left, bottom, right, top] = corners;
            (left - x..right - x).contains(a) && (bottom - y..top - y).contains(b)
        };
        let points = whole.set.points.iter().copied();
        let expected: Vec<[f64; 2]> = points.filter(is_inside).collect();
        let window = made(recipe, corners);
        assert!(expected.len() > 10, "{}", expected.len());
        assert_eq!(window.set.points, expected);
        assert_eq!(window.facts.method, whole.facts.method);
        assert!(report(&window).valid());

        // Control: one sample less leaves a gap, one more is in conflict, and another seed makes another set.
        let mut fewer = window.clone();
        fewer.all.remove(0);
        assert!(report(&fewer).gaps > 0);
        let mut more = window.clone();
        more.all.push(window.all[0]);
        assert_eq!(report(&more).whole.conflicts, 1);
        let other = VaryingRecipe {
            seed: recipe.seed + 1,
            ..recipe.clone()
        };
        assert_ne!(made(&other, corners).set.points, expected);
    }

    #[test]
    fn windows_have_the_samples_of_the_whole_and_faults_in_them_are_seen() {
        let text = "0.4 + 0.02*(x - 500000)";
        let field = RadiusSource::Expression {
            expression: Expression::parse(text).unwrap(),
            scale: 1.0,
        };
        let corners = [500_005.0, 5_400_002.0, 500_021.0, 5_400_017.5];
        check(&in_park(field), corners);
        let one = in_park(RadiusSource::Constant(0.6));
        check(&one, corners);
        let exact = VaryingRecipe {
            exact: Some(ExactBlocks::from(&Parameters::default())),
            ..one
        };
        check(&exact, corners);
    }

    #[test]
    fn a_window_takes_no_count_and_names_its_corners() {
        let recipe = VaryingRecipe {
            count: Some(1_000),
            ..in_park(RadiusSource::Constant(0.6))
        };
        let ground = recipe.ground().unwrap();
        let window = ground
            .window([500_005.0, 5_400_002.0, 500_021.0, 5_400_017.0])
            .unwrap();
        let refused = recipe.make_window(&ground, &window, &mut Unobserved);
        assert!(
            refused
                .unwrap_err()
                .to_string()
                .contains("has 1000 samples")
        );
        let wide = ground.window([500_005.0, 5_400_002.0, 500_905.0, 5_400_017.0]);
        let said = wide.unwrap_err().to_string();
        assert!(
            said.contains("500005") || said.contains("500,005"),
            "{said}"
        );
    }
}
