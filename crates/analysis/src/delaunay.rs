//! Delaunay triangulations in nearly linear time for any set. Sites are inserted in a biased randomised order (Amenta,
//! Choi and Rote 2003): rounds of doubling size, each along a k-d tree. The expected work is then that of a random
//! order for any set, and each site lies near the one before it. The order is the same in every run.

use glam::DVec2;
use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation, validate_vertex};

/// Sites that are inserted before the rounds begin. Chosen, not measured.
const FIRST: usize = 64;

/// Returns the triangulation; `None` for sites on one line, which have no triangle. The error is spade's, for a
/// coordinate that it refuses.
pub(crate) fn delaunay<V: HasPosition<Scalar = f64>>(
    mut sites: Vec<V>,
) -> Result<Option<DelaunayTriangulation<V>>, String> {
    let failed = |error: spade::InsertionError| error.to_string();
    sites.iter().try_for_each(validate_vertex).map_err(failed)?;

    order(&mut sites);
    if !begin_with_a_triangle(&mut sites) {
        return Ok(None);
    }

    // By Euler's formula there are fewer than three edges and two triangles for each site.
    let count = sites.len();
    let mut found = DelaunayTriangulation::with_capacity(count, 3 * count, 2 * count);
    for site in sites {
        found.insert(site).map_err(failed)?;
    }
    Ok(Some(found))
}

/// Returns a place as a site. Coordinates that the triangulation refuses as too small, since its predicates could
/// underflow, become zero; as the longer extent is at least 1, that moves nothing visibly.
pub(crate) fn site(place: DVec2) -> Point2<f64> {
    let accepted = |value: f64| {
        if value.abs() < spade::MIN_ALLOWED_VALUE {
            0.0
        } else {
            value
        }
    };
    let place = place.map(accepted);
    Point2::new(place.x, place.y)
}

/// Puts sites into the biased randomised order: shuffles them, and sorts each round along a k-d tree.
fn order<V: HasPosition<Scalar = f64>>(sites: &mut [V]) {
    // Marsaglia's xorshift: any generator would do, since only the choice among cocircular sites depends on the order.
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    for index in (1..sites.len()).rev() {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        sites.swap(index, (state % (index as u64 + 1)) as usize);
    }

    let mut end = sites.len();
    // From the last round, half of all sites, back to the first.
    while end > FIRST {
        let begin = end / 2;
        along_a_tree(&mut sites[begin..end]);
        end = begin;
    }
}

/// Sorts sites along a k-d tree: parts them in halves across the longer side, and each half in the same way.
fn along_a_tree<V: HasPosition<Scalar = f64>>(sites: &mut [V]) {
    if sites.len() < 3 {
        return;
    }

    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for site in sites.iter() {
        let at = position(site);
        low = at.min(low);
        high = at.max(high);
    }

    let axis = (high - low).max_position();
    let middle = sites.len() / 2;
    // The halves are parted, not sorted: the next cut of a half is along an axis of its own.
    sites.select_nth_unstable_by(middle, |a, b| {
        position(a)[axis].total_cmp(&position(b)[axis])
    });

    let (before, after) = sites.split_at_mut(middle);
    along_a_tree(before);
    along_a_tree(after);
}

/// Brings three sites to the front that are not on one line; false if there are none. Without a triangle at the
/// beginning, the insertion of sites on a line would take a time that grows with the square of their number.
fn begin_with_a_triangle<V: HasPosition<Scalar = f64>>(sites: &mut [V]) -> bool {
    let Some(first) = sites.first().map(position) else {
        return false;
    };
    let Some(second) = sites.iter().position(|site| position(site) != first) else {
        return false;
    };
    sites.swap(1, second);
    let second = position(&sites[1]);
    let Some(third) = (sites.iter()).position(|site| !on_a_line([first, second, position(site)]))
    else {
        return false;
    };
    sites.swap(2, third);
    true
}

fn position<V: HasPosition<Scalar = f64>>(site: &V) -> DVec2 {
    let Point2 { x, y } = site.position();
    DVec2::new(x, y)
}

/// Whether three points are exactly on one line: the predicates are exact, so there is a face if and only if the points span one.
fn on_a_line(points: [DVec2; 3]) -> bool {
    let corners = points.map(|p| Point2::new(p.x, p.y)).to_vec();
    DelaunayTriangulation::<_>::bulk_load(corners).is_ok_and(|found| found.num_inner_faces() == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(
        points: impl IntoIterator<Item = [f64; 2]>,
    ) -> Option<DelaunayTriangulation<Point2<f64>>> {
        let sites = points.into_iter().map(|[x, y]| Point2::new(x, y)).collect();
        delaunay(sites).expect("accepted")
    }

    #[test]
    fn a_refused_coordinate_is_an_error_and_no_panic() {
        for bad in [f64::NAN, f64::INFINITY, 1e70, 1e-60] {
            let sites = vec![Point2::new(0.0, 0.0), Point2::new(bad, 1.0)];
            assert!(delaunay(sites).is_err(), "{bad}");
        }
    }

    #[test]
    fn lines_are_recognised_exactly() {
        assert!(found([[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]]).is_none());
        assert!(found([[0.3, 0.1], [0.3, 0.7], [0.3, 0.2]]).is_none());
        assert!(found([[0.3, 0.1]; 5]).is_none() && found([]).is_none());
        let above = f64::from_bits(0.5f64.to_bits() + 1);
        let found = found([[0.0, 0.0], [0.5, above], [1.0, 1.0]]).expect("a triangle");
        assert_eq!(found.num_inner_faces(), 1);
    }

    fn faces(found: &DelaunayTriangulation<Point2<f64>>) -> Vec<[[u64; 2]; 3]> {
        let mut faces: Vec<_> = found
            .inner_faces()
            .map(|face| {
                let mut corners = face.positions().map(|p| [p.x.to_bits(), p.y.to_bits()]);
                corners.sort_unstable();
                corners
            })
            .collect();
        faces.sort_unstable();
        faces
    }

    /// Points in general position have one triangulation, whatever the order.
    #[test]
    fn the_order_changes_nothing() {
        let point = |i: u32| [0.754_877, 0.569_84].map(|step| (f64::from(i) * step).fract());
        let points: Vec<_> = (0..2000).map(point).collect();
        let sites = points.iter().map(|[x, y]| Point2::new(*x, *y)).collect();
        let swept = DelaunayTriangulation::bulk_load(sites).expect("accepted");
        assert_eq!(faces(&found(points).expect("triangles")), faces(&swept));
    }
}
