//! A set in a field of radii whose darts no coin thins: where the side of the cells doubles, the samples show a stripe. A
//! lesson compares it with the right set. Begin with [`without_coin`].

use std::sync::Arc;

use tilescope_core::{Key, Locality, Parameters, Point, SampleGrid, Stream};
use tilescope_debugger::Recording;

/// The mean number of darts in a cell. Chosen, not measured: more darts would add a few samples all over the domain, and the
/// stripe would stay.
const DARTS_A_CELL: f64 = 64.0;

/// Returns the recording of the samples that darts make if no coin thins the darts: all cells throw equally often,
/// whatever the radius is inside them. So darts are equally dense in a whole octave of radii, and four times less dense
/// in the next one. A dart becomes a sample unless it is near an earlier one, as in the right process. In the right
/// process a coin also leaves out a share of the darts, wherever the radius is larger than the side of the cell.
pub(crate) fn without_coin(locality: &Arc<Locality>, parameters: &Parameters) -> Recording {
    let domain = locality.field.domain();
    let [width, height] = [domain.width(), domain.height()].map(f64::from);
    // The side of a cell is the largest power of two that is no greater than the least radius in the cell. So no cell
    // is smaller than one at the least radius of the field.
    let least_side = f64::from(1 << locality.field.extremes()[0].ilog2());

    // Darts fall everywhere as densely as in the smallest cells. Of those in larger cells a share stays, such that each cell has as
    // many as any other. This choice is by the side of the cell alone: it is not the coin.
    let count = DARTS_A_CELL * width * height / (least_side * least_side);
    let key = Key::from_seed(parameters.seed);

    let mut samples: Vec<Point> = Vec::new();
    let mut grid = SampleGrid::with_capacity(*domain, 0);
    for dart in 0..count as u32 {
        let [across, up] = key.draw(Stream::Dart, dart).map(share);
        let at = Point::new((across * width) as i32, (up * height) as i32);
        let side = f64::from(locality.base_side(at));
        let drawn = share(key.draw(Stream::Thin, dart)[0]);
        if drawn >= (least_side / side).powi(2) {
            continue;
        }

        let is_refused = grid.any_near(at, locality.sight(at), |near| {
            locality.is_near(at, samples[near.id as usize])
        });
        if !is_refused {
            grid.insert(samples.len() as u32, at);
            samples.push(at);
        }
    }
    Recording::of_arrivals(locality, parameters, samples)
}

/// Returns a number from 0 to below 1 that is drawn from a word.
fn share(word: u32) -> f64 {
    f64::from(word) / 4_294_967_296.0
}
