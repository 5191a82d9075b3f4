//! Curves for charts and reports.

use serde_json::{Value, json};

/// A curve: its points, and the lower and upper end of its confidence band at each, if one is known.
pub struct Curve {
    pub points: Vec<[f64; 2]>,
    pub bands: Option<Vec<[f64; 2]>>,
}

impl Curve {
    /// Returns the curve through `points`.
    pub fn new(points: Vec<[f64; 2]>, bands: Option<Vec<[f64; 2]>>) -> Self {
        let bands = bands.filter(|bands| !bands.is_empty());
        Self { points, bands }
    }

    /// Returns its columns by their names.
    pub fn json(&self) -> Value {
        let column = |rows: &[[f64; 2]], axis: usize| -> Vec<f64> {
            rows.iter().map(|row| row[axis]).collect()
        };
        let mut columns = json!({ "x": column(&self.points, 0), "y": column(&self.points, 1) });
        if let Some(bands) = &self.bands {
            columns["lower"] = json!(column(bands, 0));
            columns["upper"] = json!(column(bands, 1));
        }
        columns
    }
}
