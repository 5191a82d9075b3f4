//! Curves for charts and reports: columns of points, with a confidence band where one is known.

use serde::Serialize;
use tilescope_analysis::measures::DifferenceCurve;

/// A curve.
#[derive(Clone, Serialize)]
pub struct Curve {
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    #[serde(flatten)]
    pub band: Option<Band>,
}

/// The lower and upper ends of a curve's confidence band, at each point.
#[derive(Clone, Serialize)]
pub struct Band {
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
}

impl Curve {
    /// Returns the curve through `points`.
    pub fn new(points: &[[f64; 2]], bands: Option<&Vec<[f64; 2]>>) -> Self {
        let [x, y] = columns(points);
        let band = bands.filter(|bands| !bands.is_empty()).map(|bands| {
            let [lower, upper] = columns(bands);
            Band { lower, upper }
        });
        Self { x, y, band }
    }

    /// Returns the points.
    pub fn points(&self) -> Vec<[f64; 2]> {
        rows(&self.x, &self.y)
    }
}

impl Band {
    /// Returns the two ends at each point.
    pub fn ends(&self) -> Vec<[f64; 2]> {
        rows(&self.lower, &self.upper)
    }
}

impl From<&DifferenceCurve> for Curve {
    fn from(curve: &DifferenceCurve) -> Self {
        Self::new(&curve.points, curve.bands.as_ref())
    }
}

fn columns(rows: &[[f64; 2]]) -> [Vec<f64>; 2] {
    [0, 1].map(|axis| rows.iter().map(|row| row[axis]).collect())
}

/// Returns the points of two columns.
pub fn rows(first: &[f64], second: &[f64]) -> Vec<[f64; 2]> {
    first.iter().zip(second).map(|(&a, &b)| [a, b]).collect()
}
