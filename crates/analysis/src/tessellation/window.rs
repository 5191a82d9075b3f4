//! The samples with so many copies across the periods, or guards far outside, that every cell is bounded and exact. The
//! polygons are not clipped. The radius only suggests the first halo.

use glam::{DVec2, IVec2};
use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation};

use super::triangles::Triangle;
use crate::cover::circle::circumcircle;
use crate::delaunay::{delaunay, site};
use crate::domain::Domain;
use crate::error::VerifyError;

/// A sample, seen from the home domain `shift` periods away.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Seen {
    pub sample: u32,
    pub shift: IVec2,
}

/// The sites that keep the cells of a bounded domain finite.
const GUARD: u32 = u32::MAX;

/// A sample, a copy or a guard, as it is triangulated.
#[derive(Clone, Copy, Debug)]
struct Site {
    position: Point2<f64>,
    seen: Seen,
}

impl HasPosition for Site {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.position
    }
}

/// The start of a side of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub at: DVec2,
    /// Its distance from the samples around.
    pub reach: f64,
    /// The sample beyond the side; none beyond the border.
    pub beyond: Option<Seen>,
}

/// The polygons of the cells, counter-clockwise, in the domain's unit.
pub(super) struct Window {
    pub samples: Vec<DVec2>,
    /// Empty for a sample at the place of another.
    pub polygons: Vec<Vec<Corner>>,
    /// The triangles of a bounded set, if they were asked for. Empty for a periodic one, of whose triangles some would
    /// be doubled or missing at the seams.
    pub triangles: Vec<Triangle>,
}

impl Window {
    /// Returns the polygons of a set, and the error of a triangulation that fails.
    pub fn new(points: &[[f64; 2]], domain: Domain, radius: f64) -> Result<Self, VerifyError> {
        let wants_triangles = true;
        Self::of_some(points, domain, radius, wants_triangles, |_| true)
    }

    /// Returns the polygons of the samples that are wanted, by index: those of others are empty. Triangles take a while, and are
    /// left out unless they are asked for.
    pub fn of_some(
        points: &[[f64; 2]],
        domain: Domain,
        radius: f64,
        wants_triangles: bool,
        is_wanted: impl Fn(usize) -> bool,
    ) -> Result<Self, VerifyError> {
        let samples: Vec<_> = points.iter().map(|&p| domain.scale_point(p)).collect();

        // All samples are triangulated together, from the domain's corner on.
        let failed = |cause| VerifyError::Triangulation {
            corner: [0.0; 2],
            cause,
        };

        // The halo doubles until it holds all empty circles, so that the result does not depend on the first halo, only
        // the time. A maximal set has circles of at most r, which reach at most 2 r beyond the domain; a radius that is
        // far from the samples' spacing says little. The factors were chosen with room to spare.
        let spacing = domain.spacing(samples.len());
        let mut halo = 4.0 * radius.clamp(spacing, 8.0 * spacing);
        loop {
            let sites = home_and_copies(&samples, &domain, halo);
            let mut found = delaunay(sites).map_err(failed)?;

            let mut triangles = Vec::new();
            if !domain.periodic {
                let guard_sites = guards(&domain);
                if let Some(found) = &mut found {
                    if wants_triangles {
                        triangles = triangles_of(found);
                    }
                    for guard in guard_sites {
                        let inserted = found.insert(guard);
                        inserted.map_err(|error| failed(error.to_string()))?;
                    }
                } else {
                    // Samples on one line have no triangulation; with the guards they have one.
                    let sites = home_and_copies(&samples, &domain, halo).into_iter();
                    found = delaunay(sites.chain(guard_sites).collect()).map_err(failed)?;
                }
            }

            // A bounded domain has no copies, and a halo of a period holds all copies that matter.
            let has_all = !domain.periodic || halo >= domain.extent.max_element();
            let complete = found
                .and_then(|found| polygons(&found, &samples, &domain, halo, has_all, &is_wanted));
            if let Some(polygons) = complete {
                return Ok(Self {
                    samples,
                    polygons,
                    triangles,
                });
            }
            halo *= 2.0;
        }
    }
}

/// Returns the samples, each place once, and their copies no further than `halo` from the domain. A halo of a period is always
/// enough: a cell reaches at most half a period beyond the domain, and the samples nearest to its places are at most half a
/// period away from them.
fn home_and_copies(samples: &[DVec2], domain: &Domain, halo: f64) -> Vec<Site> {
    let mut order: Vec<u32> = (0..samples.len() as u32).collect();
    let at = |id: u32| samples[id as usize].to_array();
    // Of samples at one place the lowest index gets the cell. Coordinates are finite, so that all of them compare.
    order.sort_unstable_by(|&a, &b| {
        at(a)
            .partial_cmp(&at(b))
            .unwrap_or(std::cmp::Ordering::Equal)
            .then(a.cmp(&b))
    });
    order.dedup_by(|later, first| at(*later) == at(*first));

    let shifts: &[i32] = if domain.periodic { &[0, -1, 1] } else { &[0] };
    // Room for half as many copies as samples (chosen, not measured): more take further memory as they come.
    let mut sites = Vec::with_capacity(order.len() * 3 / 2);
    for sample in order {
        for &across in shifts {
            for &along in shifts {
                let shift = IVec2::new(across, along);
                let place = shifted(samples[sample as usize], shift, domain);
                let within_halo =
                    place.cmpge(-DVec2::splat(halo)) & place.cmple(domain.extent + halo);
                if shift == IVec2::ZERO || within_halo.all() {
                    let position = site(place);
                    let seen = Seen { sample, shift };
                    sites.push(Site { position, seen });
                }
            }
        }
    }
    sites
}

/// A place `shift` periods on.
pub(super) fn shifted(place: DVec2, shift: IVec2, domain: &Domain) -> DVec2 {
    place + shift.as_dvec2() * domain.extent
}

/// Sites so far off that no place of the domain is nearest to them, on all sides. That takes more than one and a half
/// diagonals from the middle; 16 were chosen, with room to spare.
fn guards(domain: &Domain) -> [Site; 4] {
    let far = 16.0 * domain.extent.x.hypot(domain.extent.y);
    let [x, y] = (domain.extent / 2.0).to_array();
    [[x - far, y], [x + far, y], [x, y - far], [x, y + far]].map(|[x, y]| Site {
        position: Point2::new(x, y),
        seen: Seen {
            sample: GUARD,
            shift: IVec2::ZERO,
        },
    })
}

/// Returns the triangles of a triangulation that has no guards yet.
fn triangles_of(found: &DelaunayTriangulation<Site>) -> Vec<Triangle> {
    (found.inner_faces())
        .map(|face| {
            let corners = face.positions().map(|p| DVec2::new(p.x, p.y));
            let sites = face.vertices().map(|v| v.data().seen.sample as usize);
            Triangle::new(sites, corners)
        })
        .collect()
}

/// Returns the polygon around each sample; none if an empty circle reaches beyond the halo, where copies are missing, unless the
/// sites are known to have all. A circle inside the halo is empty for the whole set, so its triangle is one of the whole set.
fn polygons(
    found: &DelaunayTriangulation<Site>,
    samples: &[DVec2],
    domain: &Domain,
    halo: f64,
    has_all: bool,
    is_wanted: impl Fn(usize) -> bool,
) -> Option<Vec<Vec<Corner>>> {
    let mut polygons = vec![Vec::new(); samples.len()];
    // Copies and guards only bound the cells of samples. Cells of their own are not wanted.
    let homes = (found.vertices()).filter(|vertex| {
        let Seen { sample, shift } = vertex.data().seen;
        sample != GUARD && shift == IVec2::ZERO && is_wanted(sample as usize)
    });
    for vertex in homes {
        let polygon = &mut polygons[vertex.data().seen.sample as usize];
        // A cell has six sides on average, and hardly any more than eight.
        polygon.reserve(8);

        let first = vertex.out_edge()?;
        let mut edge = first;
        loop {
            // The side towards a neighbour begins in the triangle before it. A cell that no triangle bounds needs more copies.
            let face = edge.cw().face().as_inner()?;
            let circle = circumcircle(face.positions().map(|p| DVec2::new(p.x, p.y)));
            let reach = circle.square.sqrt();

            let inside = (circle.center - reach).cmpge(-DVec2::splat(halo))
                & (circle.center + reach).cmple(domain.extent + halo);
            if !(has_all || inside.all()) {
                return None;
            }

            let beyond = edge.to().data().seen;
            polygon.push(Corner {
                at: circle.center,
                reach,
                beyond: (beyond.sample != GUARD).then_some(beyond),
            });

            edge = edge.ccw();
            if edge == first {
                break;
            }
        }
    }
    Some(polygons)
}
