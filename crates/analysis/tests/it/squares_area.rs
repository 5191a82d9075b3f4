//! The area of a shape, and that in squares of the radius at each place, against a count of all lattice points.

use tilescope_analysis::{Boundary, LatticeRegion, Radii, Shape, SquaresJudge};

use crate::support::Random;

const REGION: LatticeRegion = LatticeRegion {
    width: 600,
    height: 400,
    boundary: Boundary::Bounded,
};

fn judge(shape: &Shape) -> SquaresJudge {
    SquaresJudge::new(REGION, Radii::Constant(20), shape).expect("a judge")
}

/// Returns the sum of a weight over the lattice points of the domain. Those on the border of the region stand for half as much.
fn counted(judge: &SquaresJudge, weight: impl Fn([i32; 2]) -> f64) -> f64 {
    let LatticeRegion { width, height, .. } = REGION;
    let half = |at: i32, side: i32| if at == 0 || at == side { 0.5 } else { 1.0 };
    let places = (0..=height).flat_map(|y| (0..=width).map(move |x| [x, y]));
    let inside = places.filter(|&place| judge.contains(place));
    inside
        .map(|[x, y]| weight([x, y]) * half(x, width) * half(y, height))
        .sum()
}

/// Returns rings around the region's middle that cross each other, themselves and the border.
fn rings(random: &mut Random) -> Vec<Vec<[i32; 2]>> {
    let mut corner = || {
        let along = |side: i32, share: f64| ((1.4 * share - 0.2) * f64::from(side)) as i32;
        [
            along(REGION.width, random.uniform()),
            along(REGION.height, random.uniform()),
        ]
    };
    let mut ring = |corners: usize| (0..corners).map(|_| corner()).collect::<Vec<_>>();
    vec![ring(3), ring(7), ring(12)]
}

#[test]
fn the_area_of_rings_is_that_of_the_places_inside() {
    let mut random = Random::new(7);
    for _ in 0..20 {
        let rings = rings(&mut random);
        let judge = judge(&Shape::Polygon { rings });
        let (found, expected) = (judge.area(), counted(&judge, |_| 1.0));
        // Places on the sides count as inside, which are up to 600 units long: 22 sides.
        assert!(found <= expected + 1_000.0, "{found} {expected}");
        assert!(found >= expected - 9_000.0, "{found} {expected}");
        // The control: the region is larger by far more.
        assert!(240_000.0 - found > 20_000.0, "{found}");
    }
}

#[test]
fn areas_of_known_shapes_are_exact() {
    let area = |rings: &[&[[i32; 2]]]| {
        let rings = rings.iter().map(|ring| ring.to_vec()).collect();
        judge(&Shape::Polygon { rings }).area()
    };
    let square: &[[i32; 2]] = &[[100, 100], [300, 100], [300, 300], [100, 300]];
    let hole: &[[i32; 2]] = &[[150, 150], [150, 250], [250, 250], [250, 150]];
    assert!((area(&[square]) - 40_000.0).abs() < 1e-6);
    // A hole counts the same whichever way around it is given.
    let turned: Vec<[i32; 2]> = hole.iter().rev().copied().collect();
    assert!((area(&[square, hole]) - 30_000.0).abs() < 1e-6);
    assert!((area(&[square, &turned]) - 30_000.0).abs() < 1e-6);
    // Two triangles that meet where the sides cross.
    let crossed: &[[i32; 2]] = &[[100, 100], [300, 300], [300, 100], [100, 300]];
    assert!(
        (area(&[crossed]) - 20_000.0).abs() < 500.0,
        "{}",
        area(&[crossed])
    );
    // Half of it lies to the left of the region.
    let beyond: &[[i32; 2]] = &[[-100, 100], [100, 100], [100, 300], [-100, 300]];
    assert!((area(&[beyond]) - 20_000.0).abs() < 1e-6);
}

#[test]
fn pixels_have_their_area_within_the_region() {
    let mut random = Random::new(3);
    let (columns, rows) = (38, 25);
    let pixels: Vec<bool> = (0..columns * rows)
        .map(|_| random.uniform() < 0.4)
        .collect();
    let mask = judge(&Shape::Mask {
        pitch_bits: 4,
        columns,
        pixels: pixels.clone(),
    });
    // The last column of pixels is half a pixel wide.
    let width = |index: usize| {
        if index % columns == columns - 1 {
            8
        } else {
            16
        }
    };
    let inside = (0..pixels.len()).filter(|&index| pixels[index]);
    let expected: usize = inside.map(|index| 16 * width(index)).sum();
    assert!((mask.area() - expected as f64).abs() < 1e-9);

    let filling = judge(&Shape::Filling {
        columns,
        pixels: pixels.clone(),
    });
    let share = pixels.iter().filter(|pixel| **pixel).count() as f64 / pixels.len() as f64;
    assert!((filling.area() - 240_000.0 * share).abs() < 1e-6);
    // The control: the same pixels with another width.
    assert!((filling.area() - mask.area()).abs() > 1.0);
}

#[test]
fn an_area_in_radii_counts_places_by_their_own_radius() {
    // Radii from 12 to 180 on a slope with a step, of 32 units a node.
    let (columns, rows) = (20, 14);
    let node = |index: usize| {
        let (column, row) = (index % columns, index / columns);
        12 + 3 * column as i32 + if row > 6 { 120 } else { 0 }
    };
    let nodes: Vec<i32> = (0..columns * rows).map(node).collect();
    let radii = Radii::Nodes {
        pitch_bits: 5,
        columns,
        nodes: &nodes,
    };
    let star = vec![vec![[60, 10], [580, 120], [300, 390], [20, 250]]];
    for shape in [Shape::Rectangle, Shape::Polygon { rings: star }] {
        let judge = SquaresJudge::new(REGION, radii, &shape).expect("a judge");
        let weight = |place| f64::from(judge.radius_at(place)).powi(-2);
        let (found, expected) = (judge.area_in_radii(), counted(&judge, weight));
        assert!(!judge.has_one_radius());
        assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
        // The control: by the least radius the area is another.
        assert!(judge.area() / 144.0 > 1.5 * found);
    }

    let one = judge(&Shape::Rectangle);
    assert!(one.has_one_radius() && (one.area_in_radii() - 600.0).abs() < 1e-9);
}
