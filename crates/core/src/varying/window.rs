//! Windows of sets whose radius varies, or that cover a shape, made without the rest: [`varying_window`].
//!
//! What becomes of a dart depends on darts nearby alone, and on what these depend on. So a window is made from its own base cells
//! and layers of those around ([`around`]). What they leave in doubt ([`piece`]) is known: if it reaches the window, it is made
//! again with more layers. So no bound is needed on how far a window depends on what is around it.

mod around;
mod piece;

use glam::I64Vec2;
use rayon::prelude::*;

use super::field::RadiusField;
use super::parallel;
use super::shape::Shape;
use crate::error::SampleError;
use crate::lattice::{Domain, Point, Window};
use crate::memory;
use crate::parameters::MAXIMAL_DENSITY;
use crate::progress::{Meter, Observer};
use crate::random::Key;
use crate::stage::Stage;
use around::CellsAround;
use piece::{WindowArrival, WindowPiece};

/// How many layers of cells are made around a window at first, a layer being about a radius wide (`few_layers_leave_windows_in_doubt`).
const LAYERS: usize = 8;

/// How many more a window gets that is in doubt.
const MORE_LAYERS: usize = 4;

/// With more layers the whole set is made instead. Chosen, not measured: no window has been seen to need so many.
const MAX_LAYERS: usize = 64;

/// The longest side of a square piece of a window, in radii as they are in it; larger windows are made in pieces. Chosen, not measured.
const PIECE_SIDE: f64 = 64.0;

/// Places along each side of a piece at which its radii are looked at. They only say whether it is cut.
const PIECE_LOOKS: i64 = 16;

/// Bytes that a sample of a window takes: twice 24 while it is brought into order, 8 for its place and 16 for its position in user
/// units, and a tenth. Counted by the sizes of the types, not measured.
const BYTES_A_SAMPLE: f64 = 80.0;

/// Places along each side of a window at which its radii are looked at, to say how many samples it has.
const LOOKS: i64 = 64;

/// The samples of a window of a larger set.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct VaryingWindow {
    /// The samples in the window, in the order of their arrival.
    pub inside: Vec<Point>,
    /// Samples outside of the window, in the order of their arrival: all that are near a place of the shape in the window, which
    /// a verifier needs to judge it, and some more.
    pub around: Vec<Point>,
    /// How many base cells were looked at, each with all darts in it: a measure of the work.
    pub cells: u64,
}

/// Returns the samples of [`super::varying_sample`] that lie in a window, without the others. A window beyond the end of a
/// periodic domain shows its repetition, with the places of the domain.
///
/// Only the window and the surroundings on which its samples depend are made, on all threads of the current pool. The samples do not
/// depend on the number of threads, nor on where the window ends. Fails when `observer` stops it, or the system does not give the
/// memory. Progress is reported as [`crate::Stage::Regions`], which are pieces of the window.
///
/// ```
/// use tilescope_core::{Boundary, Domain, R, RadiusField, Shape, Unobserved, varying_window};
///
/// // A window of a set of two thousand million samples.
/// let domain = Domain::from_size([1.0, 1.0], 2e-5, Boundary::Periodic)?;
/// let field = RadiusField::constant(domain, R)?;
/// let window = domain.window([0.5, 0.5], [0.501, 0.501])?;
/// let made = varying_window(&field, &Shape::rectangle(), 7, &window, &mut Unobserved)?;
/// assert!((1_650..1_850).contains(&made.inside.len()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn varying_window(
    field: &RadiusField,
    shape: &Shape,
    seed: u64,
    window: &Window,
    observer: &mut dyn Observer,
) -> Result<VaryingWindow, SampleError> {
    memory::ask_for(expected_in_window(field, window), BYTES_A_SAMPLE)?;
    let pieces = pieces(field, window);
    let key = Key::from_seed(seed);

    let (mut arrived, mut cells) = (Vec::new(), 0);
    let mut meter = Meter::begin(observer, Stage::Regions, pieces.len() as u64)?;
    // The observer may stop the work whenever each thread has made a few pieces.
    for batch in pieces.chunks(4 * rayon::current_num_threads()) {
        let made: Vec<Option<MadePiece>> = batch
            .par_iter()
            .with_max_len(1)
            .map(|piece| {
                let layers = (LAYERS..=MAX_LAYERS).step_by(MORE_LAYERS);
                made(field, shape, key, piece, layers)
            })
            .collect();
        for piece in made {
            let Some(piece) = piece else {
                let whole = parallel::sample(field, shape, seed, observer)?;
                return Ok(cut(whole, field.domain(), window));
            };
            arrived.extend(piece.arrived);
            cells += piece.cells;
        }
        meter.count(batch.len() as u64)?;
        // By itself the meter asks the observer only after thousands of counted pieces.
        meter.ask()?;
    }
    meter.end()?;
    Ok(in_order(arrived, cells))
}

/// Returns about how many samples lie in a window, if all of it is covered.
#[must_use]
pub fn expected_in_window(field: &RadiusField, window: &Window) -> f64 {
    let size = (window.max - window.min).max(I64Vec2::ZERO);
    let area = size.x as f64 * size.y as f64;
    MAXIMAL_DENSITY * area / typical_radius(field, window, LOOKS).powi(2)
}

/// Returns the radius, in units, that everywhere would give a window as many samples as it has, by so many places along each side.
fn typical_radius(field: &RadiusField, window: &Window, looks: i64) -> f64 {
    let domain = field.domain();
    let last = I64Vec2::from(domain.rect().max) - 1;
    let size = (window.max - window.min).max(I64Vec2::ZERO);

    let mut sum = 0.0;
    for row in 0..looks {
        for column in 0..looks {
            // The middle of each part of the window, in the domain.
            let part = I64Vec2::new(2 * column + 1, 2 * row + 1);
            let place = window.min + size * part / (2 * looks);
            let place = in_domain(domain, place).clamp(I64Vec2::ZERO, last);
            let radius = field.radius_at(Point::new(place.x as i32, place.y as i32));
            sum += f64::from(radius).powi(-2);
        }
    }
    ((looks * looks) as f64 / sum).sqrt()
}

/// Returns the place of the domain that a place of the plane shows. In a bounded domain it is the place itself.
fn in_domain(domain: &Domain, place: I64Vec2) -> I64Vec2 {
    if domain.is_periodic() {
        place.rem_euclid(I64Vec2::new(domain.width().into(), domain.height().into()))
    } else {
        place
    }
}

/// A piece of a window that was made.
struct MadePiece {
    arrived: Vec<WindowArrival>,
    cells: u64,
}

/// Makes a piece of a window with these numbers of layers of cells, one after another until it is not in doubt; `None` if it is with
/// all of them.
fn made(
    field: &RadiusField,
    shape: &Shape,
    key: Key,
    piece: &Window,
    layers: impl Iterator<Item = usize>,
) -> Option<MadePiece> {
    let mut around = CellsAround::of(field, shape, piece);
    let (mut widened, mut cells) = (0, 0);
    for layers in layers {
        // Beyond the layers that throw darts there is one more, which is in doubt from the beginning.
        while widened <= layers {
            around.widen();
            widened += 1;
        }
        cells += around.cells.len() as u64;
        if let Some(arrived) = WindowPiece::made(field, shape, key, piece, &around) {
            return Some(MadePiece { arrived, cells });
        }
    }
    None
}

/// Returns the samples of all pieces, in the order of their arrival.
fn in_order(mut arrived: Vec<WindowArrival>, cells: u64) -> VaryingWindow {
    arrived.par_sort_unstable();
    let mut window = VaryingWindow {
        cells,
        ..VaryingWindow::default()
    };
    // A sample may lie in one piece and around others, or around several. It counts once, inside if it lies in any.
    for of_sample in arrived.chunk_by(WindowArrival::is_same) {
        let first = of_sample[0];
        let list = if first.is_around {
            &mut window.around
        } else {
            &mut window.inside
        };
        list.push(first.point());
    }
    window
}

/// Returns a window of the whole set, whose samples are given in the order of their arrival.
fn cut(points: Vec<Point>, domain: &Domain, window: &Window) -> VaryingWindow {
    let contains = |point: &Point| {
        // In a periodic domain, the first image that is not below the window.
        let offset = in_domain(domain, I64Vec2::from(*point) - window.min);
        (offset.cmpge(I64Vec2::ZERO) & offset.cmplt(window.max - window.min)).all()
    };
    let (inside, around) = points.into_iter().partition(contains);
    VaryingWindow {
        inside,
        around,
        // No base cell was looked at for this window alone.
        cells: 0,
    }
}

/// Cuts a window into pieces of about as many samples as fit the cache.
fn pieces(field: &RadiusField, window: &Window) -> Vec<Window> {
    let (mut pieces, mut stack) = (Vec::new(), vec![*window]);
    while let Some(part) = stack.pop() {
        let size = part.max - part.min;
        // A window between two neighbouring lattice lines has no place.
        if size.min_element() <= 0 {
            continue;
        }

        // By the least radius, pieces of steep fields were so small that their surroundings had most cells.
        let radius = typical_radius(field, &part, PIECE_LOOKS);
        // A thin piece has most of its cells around it, so that these are counted, too.
        let margin = 2.0 * LAYERS as f64;
        let [width, height] = [size.x, size.y].map(|side| side as f64 / radius + margin);
        if width * height <= (PIECE_SIDE + margin).powi(2) {
            pieces.push(part);
            continue;
        }

        // Cut across the longer side.
        let (mut first, mut second) = (part, part);
        let axis = usize::from(size.y > size.x);
        let middle = part.min[axis] + size[axis] / 2;
        first.max[axis] = middle;
        second.min[axis] = middle;
        stack.extend([second, first]);
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Boundary, R};
    use crate::progress::Unobserved;

    /// A field of random nodes, from one to four R, that are two R apart.
    fn noise(boundary: Boundary) -> RadiusField {
        let domain = Domain::from_size([96.0, 64.0], 1.0, boundary).unwrap();
        let [columns, rows] = RadiusField::node_counts(&domain, 16).unwrap();
        let node = |index: usize| {
            let [word, _] = Key::from_seed(5).draw(crate::random::Stream::Dart, index as u32);
            R + (word >> 15) as i32 % (3 * R)
        };
        let nodes: Vec<i32> = (0..columns * rows).map(node).collect();
        RadiusField::from_nodes(domain, 16, &nodes).unwrap()
    }

    /// Windows of some radii, side by side, over the border of the domain.
    fn windows(side: f64) -> impl Iterator<Item = Window> {
        let domain = *noise(Boundary::Periodic).domain();
        (0..20).map(move |number| {
            let low = [
                8.0 + f64::from(number % 5) * 18.7,
                7.0 + f64::from(number / 5) * 12.7,
            ];
            domain.window(low, low.map(|at| at + side)).unwrap()
        })
    }

    /// Returns how many windows are in doubt with so many layers, and checks the others.
    fn doubtful(layers: usize, side: f64) -> usize {
        let (field, shape, seed) = (noise(Boundary::Periodic), Shape::rectangle(), 3);
        let whole = parallel::sample(&field, &shape, seed, &mut Unobserved).unwrap();
        let is_doubtful = |window: &Window| {
            let key = Key::from_seed(seed);
            let piece = made(&field, &shape, key, window, std::iter::once(layers));
            let Some(MadePiece { arrived, cells }) = piece else {
                return true;
            };
            let expected = cut(whole.clone(), field.domain(), window);
            assert_eq!(in_order(arrived, cells).inside, expected.inside);
            assert!(!expected.inside.is_empty() && !expected.around.is_empty());
            false
        };
        windows(side).filter(is_doubtful).count()
    }

    /// The evidence for the first number of layers. Windows that are not in doubt are right with any.
    #[test]
    fn few_layers_leave_windows_in_doubt() {
        let counts = [1, 3, LAYERS].map(|layers| doubtful(layers, 7.0));
        println!("{counts:?} of 20");
        assert!(
            counts[0] > 15 && counts[1] < counts[0] && counts[2] < 3,
            "{counts:?}"
        );
    }

    #[test]
    fn a_window_that_depends_on_too_much_is_cut_from_the_whole() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let (field, shape) = (noise(boundary), Shape::rectangle());
            let whole = |seed| parallel::sample(&field, &shape, seed, &mut Unobserved).unwrap();
            let [own, other] = [9, 8].map(whole);
            for window in windows(20.0).step_by(7) {
                let made = varying_window(&field, &shape, 9, &window, &mut Unobserved).unwrap();
                let expected = cut(own.clone(), field.domain(), &window);
                assert_eq!(made.inside, expected.inside);
                let is_there = |place| expected.around.contains(place);
                assert!(made.around.iter().all(is_there));
                let different = cut(other.clone(), field.domain(), &window);
                assert_ne!(made.inside, different.inside);
            }
        }
    }

    #[test]
    fn pieces_are_the_window() {
        let field = noise(Boundary::Periodic);
        for window in [
            [-50.0, 3.0, 40.0, 60.0],
            [0.0, 1.0, 96.0, 1.001],
            [0.0, 0.0, 0.01, 64.0],
        ] {
            let [left, bottom, right, top] = window;
            let window = field.domain().window([left, bottom], [right, top]).unwrap();
            let area = |rect: &Window| (rect.max - rect.min).element_product();
            let pieces = pieces(&field, &window);
            assert_eq!(pieces.iter().map(area).sum::<i64>(), area(&window));
            assert!(pieces.iter().all(|piece| area(piece) > 0));
        }
        assert!(
            pieces(
                &field,
                &Window {
                    min: I64Vec2::ONE,
                    max: I64Vec2::new(1, 5)
                }
            )
            .is_empty()
        );
    }
}
