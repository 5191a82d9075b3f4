use super::*;
use crate::lattice::{Boundary, R};
use crate::levels::frame::LevelFrame;
use crate::parameters::Parameters;
use crate::progress::Unobserved;
use crate::stage::Stage;

/// Seeds with which pixels that see no insertion of one iteration have a candidate after a later one.
const SEEDS: [u64; 3] = [21, 35, 39];

/// Returns a region of a bounded domain of 60 r by 60 r with few samples, no two of which are within 2.5 r, and all cells dirty.
fn sparse(seed: u64) -> LevelRegion {
    let parameters = Parameters {
        width: 60.0,
        height: 60.0,
        radius: 1.0,
        boundary: Boundary::Bounded,
        ..Parameters::default()
    };
    let domain = parameters.validate().unwrap();
    let frame = LevelFrame {
        rect: domain.rect(),
        ..LevelFrame::at(&domain, glam::I64Vec2::ZERO)
    };

    let mut region = LevelRegion::default();
    region.begin(frame, Radius::FINEST);
    let apart = 5 * R / 2;
    let key = Key::from_seed(seed);
    for dart in 0..4000 {
        let [x, y] = key
            .draw_at(dart, 0)
            .map(|word| (word % (60 * R as u32)) as i32);
        let at = Point::new(x, y);
        let is_near =
            |offset: IVec2| offset.as_i64vec2().length_squared() <= i64::from(apart).pow(2);
        if !region.grid.any_near(at, apart, is_near) {
            let foreign = true;
            region.keep(at, foreign);
        }
    }

    region.dirty = (0..region.grid.layout().count() as u32).collect();
    region
}

/// After the last iteration there is no candidate, not even in pixels that only a later insertion came near. The gaps are as
/// wide as those between few samples, so that filling them takes many iterations.
#[test]
fn no_gap_is_left_in_pixels_that_later_insertions_come_near() {
    for seed in SEEDS {
        let mut region = sparse(seed);
        let few = region.samples.len();
        let mut unobserved = Unobserved;
        let mut meter = Meter::begin(&mut unobserved, Stage::Regions, 1).unwrap();
        let mut fill = |key: u64| {
            let key = Key::from_seed(key);
            region.fill_by_pixels(key, &mut meter).unwrap();
            region.samples.len()
        };

        let filled = fill(seed);
        assert!(filled > 5 * few, "{few} of {filled} are not few");
        // All cells are still dirty: every pixel is searched again.
        assert_eq!(fill(seed + 1_000), filled, "{seed}");
    }
}
