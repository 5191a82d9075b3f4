//! Field and shape in lattice units, for the sampler and for the judge.

use std::sync::Arc;

use rayon::prelude::*;
use tilescope_analysis::{Radii, Shape as JudgedShape, VaryingRegion};
use tilescope_core::{Boundary, Domain, MAX_PITCH_BITS, Parameters, Point, R, RadiusField, Shape};
use tilescope_formats::{
    CertifiedRadius, CertifiedShape, Format, RadiusField as CertifiedField, RadiusRule,
    VaryingDomain, bytes_digest,
};

use super::error::VaryingError;
use super::grid::pixels_around;
use super::nodes::{
    HAIR, MAX_CONTRAST, RequestedRadii, SAME_RATIO, Squares, squares_for, squares_of,
};
use super::source::{DENSITY_CAP, RadiusSource, ShapeSource, radius_of_darkness, radius_of_grey};
use super::{ExactBlocks, VaryingRecipe, samples_in};
use crate::domain::region;

/// The nodes along the longer side at which an expression is looked at before it is run.
const GLANCE_NODES: usize = 64;

/// What a set is made on and judged in.
#[derive(Clone, Debug)]
pub struct Ground {
    /// The radius at each lattice point.
    pub field: RadiusField,
    /// The lattice points that are to be covered.
    pub shape: Shape,
    /// What sets are judged in.
    pub varying: Arc<VaryingDomain>,
    /// Where the lower corner of the domain lies.
    pub origin: [f64; 2],
    /// Nodes of the field, and pixels of a mask, are two to this power apart.
    pub(super) bits: u32,
    /// The largest radius that there can be beside the least one.
    pub(super) limit: f64,
}

/// The domain in user units, and the squares at whose corners its field has nodes.
struct Frame {
    size: [f64; 2],
    origin: [f64; 2],
    /// The squares of the field; none where the radius is the same everywhere.
    squares: Option<Squares>,
}

/// A shape for each of those that use it.
struct Shapes {
    sampled: Shape,
    judged: JudgedShape,
    /// As certificates state it.
    stated: Option<CertifiedShape>,
}

/// The radii of nodes, and the lattice that follows from the least.
struct Nodes {
    domain: Domain,
    bits: u32,
    units: Vec<i32>,
    /// The largest radius that is possible beside the least, in user units.
    limit: f64,
}

impl VaryingRecipe {
    /// Returns the ground of a radius: what the sampler needs, and what the judge gets. `radius` stands in the place of
    /// the recipe's own, which a search for a given number of samples scales.
    pub(super) fn ground_of(&self, radius: &RadiusSource) -> Result<Ground, VaryingError> {
        radius.check()?;
        radius.refuse_white()?;
        let frame = self.frame(radius)?;
        // A constant radius without pixels is one node.
        let nodes = match (frame.squares, radius) {
            (None, RadiusSource::Constant(radius)) => self.single(&frame, *radius)?,
            // Exact tiling has R units in its radius, whatever the pixels of a mask.
            (Some(_), RadiusSource::Constant(radius)) if self.exact.is_some() => {
                self.single(&frame, *radius)?
            }
            _ => self.nodes(&frame, radius)?,
        };
        let Nodes { domain, bits, .. } = nodes;
        let field = if nodes.units.len() == 1 {
            RadiusField::constant(domain, nodes.units[0])?
        } else {
            RadiusField::from_nodes(domain, bits, &nodes.units)?
        };

        let shapes = self.shapes(&frame, &domain, bits)?;
        let stated = stated_radius(radius, &nodes);
        // The judge gets the same integers, and makes its own tables of them.
        let [columns, _] = RadiusField::node_counts(&domain, bits)?;
        let radii = if nodes.units.len() == 1 {
            Radii::Constant(nodes.units[0])
        } else {
            Radii::Nodes {
                pitch_bits: bits,
                columns,
                nodes: &nodes.units,
            }
        };

        let sides = [domain.width(), domain.height()];
        let judged = VaryingRegion::new(
            region(&domain),
            sides,
            stated.least(),
            radii,
            &shapes.judged,
        )?;
        Ok(Ground {
            field,
            shape: shapes.sampled,
            varying: Arc::new(VaryingDomain {
                judged,
                radius: stated,
                shape: shapes.stated,
            }),
            origin: frame.origin,
            bits,
            limit: nodes.limit,
        })
    }

    /// Returns about how many samples there are, from few nodes of an expression or few pixels of an image: cheap enough to be
    /// asked for in each frame of a window.
    ///
    /// # Errors
    ///
    /// [`VaryingError`] for domains and for radii that are refused, as far as these nodes show it.
    pub fn glance(&self) -> Result<f64, VaryingError> {
        self.radius.check()?;
        let frame = self.frame(&self.radius)?;
        let Some(squares) = frame.squares else {
            // Only a constant radius has no squares, so that the 1 is never used.
            let radius = self.radius.constant().unwrap_or(1.0);
            Domain::from_size(frame.size, radius, self.boundary)?;
            return Ok(samples_in(frame.size[0] * frame.size[1], radius));
        };

        // Each grey value is looked at by itself, and is not a mean of several as at a node.
        let count = 1;
        let radii: Vec<f64> = match &self.radius {
            RadiusSource::Image { image, radii } => {
                let few = image.few().map(u32::from);
                few.map(|grey| radius_of_grey(*radii, grey, count))
                    .collect()
            }
            RadiusSource::Density { image, black } => {
                let few = image.few().map(u32::from);
                few.map(|grey| radius_of_darkness(*black, grey, count))
                    .collect()
            }
            RadiusSource::Grid { grid, scale } => {
                let every = grid
                    .radii
                    .len()
                    .div_ceil(GLANCE_NODES * GLANCE_NODES)
                    .max(1);
                let few = grid.radii.iter().step_by(every);
                few.map(|radius| scale * radius).collect()
            }
            RadiusSource::Constant(_) | RadiusSource::Expression { .. } => {
                // A glance takes few nodes: those of the field are `part` times as dense.
                let [columns, rows] = squares.counts;
                let part = columns.max(rows).div_ceil(GLANCE_NODES).max(1);
                let few = Squares {
                    counts: squares.counts.map(|count| count.div_ceil(part)),
                    pitch: squares.pitch * part as f64,
                };
                self.requests(&self.radius, &frame, few)?
            }
        };
        let least = radii.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = radii.iter().copied().fold(0.0, f64::max);

        // Radii of a density that are too large become the largest possible ones: only others are refused. `nodes` may
        // refuse a little more, as its lattice has a largest radius, too.
        if greatest > MAX_CONTRAST * least && !self.radius.is_capped() {
            return Err(VaryingError::Contrast {
                least,
                greatest,
                limit: MAX_CONTRAST,
                allowing: None,
            });
        }
        // The lattice of the field, as `nodes` finds it. The domain is made to learn whether it is refused, which a hair
        // (`HAIR`) does not change.
        let pitch = squares.pitch;
        let in_units = |bits: u32| least / pitch * f64::from(1_u32 << bits);
        let bits = (0..=MAX_PITCH_BITS)
            .find(|&bits| in_units(bits) >= f64::from(R))
            .ok_or(VaryingError::Fine { least, pitch })?;
        let unit_radius = pitch / f64::from(1_u32 << bits) * f64::from(R);
        Domain::from_size(frame.size, unit_radius, self.boundary)?;
        // Nodes beyond the border of a bounded domain stand for no area, which a rough number may ignore.
        let mean = radii.iter().map(|radius| radius.powi(-2)).sum::<f64>() / radii.len() as f64;
        let squared_radii = frame.size[0] * frame.size[1] * mean;
        // The area is in squared radii, so that the radius is 1.
        Ok(samples_in(squared_radii, 1.0))
    }

    /// Returns whether sets of this recipe may lie on one of two lattices: a mask of one radius that darts make, whose pixels are
    /// whole lattice squares, or that is tiled exactly, in whose radius there are R units. Every other recipe has one lattice.
    #[must_use]
    pub fn has_two_lattices(&self) -> bool {
        let is_mask = matches!(
            self.shape,
            Some(ShapeSource::Mask(_) | ShapeSource::Dark { .. })
        );
        is_mask && matches!(self.radius, RadiusSource::Constant(_))
    }

    /// Returns this recipe for judging a set at these positions, as a file of `format` holds them, by the lattice that they lie on:
    /// that of exact tiling if they fit it, and better than that of darts. Positions of another program fit neither and are judged in
    /// that of darts. A recipe of one lattice stays as it is.
    ///
    /// # Errors
    ///
    /// [`VaryingError`] when the domain is refused.
    pub fn fitted_to(self, positions: &[[f64; 2]], format: Format) -> Result<Self, VaryingError> {
        let RadiusSource::Constant(radius) = self.radius else {
            return Ok(self);
        };
        if !self.has_two_lattices() {
            return Ok(self);
        }

        let frame = self.frame(&self.radius)?;
        // The mean square, in units, of how far coordinates are from those of the nearest point of a lattice.
        let strayed = |domain: Domain| {
            let unit = domain.radius() / f64::from(R);
            // Files of the unit torus hold positions divided by the width, which the two lattices round differently.
            let scale = if format.is_unit_torus() {
                domain.size()[0]
            } else {
                1.0
            };
            let squares = positions.iter().map(|at| {
                let inside = [0, 1].map(|axis| scale * (at[axis] - frame.origin[axis]));
                let there = domain.user_from_lattice(domain.lattice_from_user(inside));
                let squared = |axis: usize| ((there[axis] - inside[axis]) / unit).powi(2);
                f64::midpoint(squared(0), squared(1))
            });
            squares.sum::<f64>() / positions.len().max(1) as f64
        };
        // A method that cannot make such a set has no lattice.
        let of =
            |nodes: Result<Nodes, _>| nodes.map_or(f64::INFINITY, |nodes| strayed(nodes.domain));
        let by_darts = of(self.nodes(&frame, &self.radius));
        let by_tiling = of(self.single(&frame, radius));

        // Positions that have nothing to do with a lattice have a mean of 1/12. Positions of a lattice that a file
        // holds in single precision have less than 1/12, unless two neighbouring numbers of the file are more than a
        // unit apart. The limit is a quarter of 1/12 (chosen): the mean of ten positions or more is rarely below it by
        // chance.
        let is_tiled = by_tiling < by_darts && by_tiling < 1.0 / 48.0;

        // The lattice depends on the method, but not on its blocks.
        let blocks = is_tiled.then(|| ExactBlocks::from(&Parameters::default()));
        Ok(Self {
            exact: blocks,
            ..self
        })
    }

    /// Returns about how many samples there are with these radii, if all of the domain is covered.
    pub(super) fn expected(&self, radius: &RadiusSource) -> Result<f64, VaryingError> {
        let frame = self.frame(radius)?;
        match (frame.squares, radius) {
            (Some(squares), _) => {
                let radii = self.requests(radius, &frame, squares)?;
                // Each node stands for the area of one square, in which the radius is about that of the node. Those on
                // the far border of a bounded domain count, too, which a rough number may ignore.
                let square = |&radius: &f64| samples_in(squares.pitch * squares.pitch, radius);
                Ok(radii.iter().map(square).sum())
            }
            (None, RadiusSource::Constant(radius)) => {
                Ok(samples_in(frame.size[0] * frame.size[1], *radius))
            }
            // A field always has squares.
            (None, _) => Ok(0.0),
        }
    }

    /// Returns the x of the columns and the y of the rows of nodes of a function of x and y: where an expression is evaluated.
    ///
    /// # Errors
    ///
    /// [`VaryingError`] when the domain is refused.
    pub fn node_places(&self) -> Result<[Vec<f64>; 2], VaryingError> {
        let frame = self.frame(&self.radius)?;
        let Some(Squares { counts, pitch }) = frame.squares else {
            return Err(VaryingError::Nothing);
        };
        // The far border of a periodic domain is its near one.
        let more = usize::from(self.boundary == Boundary::Bounded);
        Ok([0, 1].map(|axis| {
            let places = 0..counts[axis] + more;
            let place = |at: usize| frame.origin[axis] + at as f64 * pitch;
            places.map(place).collect()
        }))
    }

    /// Returns the radius that is asked for at each node, in user units, row by row.
    fn requests(
        &self,
        radius: &RadiusSource,
        frame: &Frame,
        Squares { counts, pitch }: Squares,
    ) -> Result<Vec<f64>, VaryingError> {
        // Nodes are the corners of squares: one more than squares, unless the far border is the near one.
        let wraps = self.boundary == Boundary::Periodic;
        let [columns, rows] = counts.map(|count| count + usize::from(!wraps));
        let place_of = |row: usize, column: usize| {
            let [x, y] = frame.origin;
            [x + column as f64 * pitch, y + row as f64 * pitch]
        };
        let value = |stack: &mut Vec<f64>, row: usize, column: usize| match radius {
            RadiusSource::Constant(radius) => *radius,
            RadiusSource::Expression { expression, scale } => {
                let [x, y] = place_of(row, column);
                scale * expression.on(stack, x, y)
            }
            RadiusSource::Image { image, radii } => {
                let (sum, count) = grey_around(&image.grey, counts, wraps, [column, row]);
                radius_of_grey(*radii, sum, count)
            }
            RadiusSource::Density { image, black } => {
                let (sum, count) = grey_around(&image.grey, counts, wraps, [column, row]);
                radius_of_darkness(*black, sum, count)
            }
            RadiusSource::Grid { grid, scale } => scale * grid.radii[row * columns + column],
        };

        let mut asked = vec![0.0; columns * rows];
        // A formula may take seconds. One stack serves many rows, as each node would ask for memory of its own.
        let by_row = asked.par_chunks_mut(columns).enumerate();
        let wrong = by_row.map_init(Vec::new, |stack, (row, radii)| {
            for (column, radius) in radii.iter_mut().enumerate() {
                *radius = value(stack, row, column);
            }
            let is_wrong = |radius: &f64| !(*radius > 0.0 && radius.is_finite());
            radii.iter().position(is_wrong).map(|column| (row, column))
        });

        // The error names the first node of all, whichever thread was first.
        match wrong.flatten().min() {
            Some((row, column)) => Err(VaryingError::Radius {
                radius: asked[row * columns + column],
                place: place_of(row, column),
            }),
            None => Ok(asked),
        }
    }

    /// Returns the domain, and the squares of its field.
    fn frame(&self, radius: &RadiusSource) -> Result<Frame, VaryingError> {
        let of_shape = self.shape.as_ref().and_then(ShapeSource::pixels);
        let pixels = match (radius.pixels(self.boundary), of_shape) {
            (Some(first), Some(second)) if first != second => {
                return Err(VaryingError::Sizes { first, second });
            }
            (first, second) => first.or(second),
        };

        let mut origin = self.origin.unwrap_or_default();
        let mut sides = self.size;
        if let Some(ShapeSource::Polygon(polygon)) = &self.shape {
            // Without a given side or corner the domain is the rectangle around the polygon. Otherwise the polygon is a
            // part of the domain, whose corner is 0 0 if only a side is given; a side that is not given ends with the
            // polygon.
            let [low, high] = polygon.bounds();
            if self.origin.is_none() && sides == [None; 2] {
                origin = low;
            }
            sides = [0, 1].map(|axis| sides[axis].or(Some(high[axis] - origin[axis])));
        }
        // Pixels are squares, so that one side gives the other. A side that nothing gives is 1; with pixels this is the
        // width.
        let size = match (sides, pixels.map(|pixels| pixels.map(|count| count as f64))) {
            ([Some(width), Some(height)], _) => [width, height],
            ([Some(width), None], Some([columns, rows])) => [width, width * rows / columns],
            ([None, Some(height)], Some([columns, rows])) => [height * columns / rows, height],
            ([None, None], Some([columns, rows])) => [1.0, rows / columns],
            (sides, None) => sides.map(|side| side.unwrap_or(1.0)),
        };

        let of_function = || squares_of(size, self.boundary).ok();
        let is_of_function = |pixels| of_function().is_some_and(|own| own.counts == pixels);
        let squares = match (pixels, radius) {
            // Where a grid comes from shows in its size alone. With as many squares as an expression would have, it was made
            // by a function of x and y, and its last squares may reach beyond the border. Beside a mask its squares are
            // the mask's pixels. For a size that an expression cannot have (`ok`) there is no such grid.
            (Some(pixels), RadiusSource::Grid { .. })
                if of_shape.is_none() && is_of_function(pixels) =>
            {
                of_function()
            }
            // A mask makes a field also of a radius that is the same everywhere, so that its pixels are whole in
            // lattice units.
            (Some(pixels), _) => Some(Squares {
                counts: pixels,
                pitch: pitch_of_pixels(pixels, size)?,
            }),
            (None, RadiusSource::Expression { .. }) => Some(squares_of(size, self.boundary)?),
            (None, _) => None,
        };
        Ok(Frame {
            size,
            origin,
            squares,
        })
    }

    /// Returns the one node of a radius that is the same everywhere.
    fn single(&self, frame: &Frame, radius: f64) -> Result<Nodes, VaryingError> {
        let domain = Domain::from_size(frame.size, radius, self.boundary)?;
        Ok(Nodes {
            domain,
            bits: 0,
            units: vec![R],
            limit: radius * MAX_CONTRAST,
        })
    }

    /// Returns the nodes of a field, and the lattice in which the least radius is from 2^15 to 2^16 units and the pitch a
    /// power of two.
    fn nodes(&self, frame: &Frame, radius: &RadiusSource) -> Result<Nodes, VaryingError> {
        // Only a constant radius has no squares, and `ground_of` makes that one node.
        let Some(squares) = frame.squares else {
            return Err(VaryingError::Nothing);
        };
        let asked = self.requests(radius, frame, squares)?;
        let mut requested = RequestedRadii::new(asked, squares.pitch)?;
        if requested.are_too_unlike() && !radius.is_capped() {
            // The nodes of an expression may lie anywhere, so that the lattice can be made for its radii. Those of pixels
            // are the corners of the pixels.
            let has_mask = self.shape.as_ref().and_then(ShapeSource::pixels).is_some();
            let has_pixels = has_mask || !matches!(radius, RadiusSource::Expression { .. });
            // A contrast above that of all lattices is refused as it is.
            if !has_pixels && requested.greatest <= MAX_CONTRAST * requested.least {
                requested = self.requested_for_contrast(radius, frame, requested)?;
            }
            requested.refuse_contrast(has_pixels)?;
        }

        let unit_radius = requested.pitch / f64::from(1_u32 << requested.bits) * f64::from(R);
        let domain = Domain::from_size(frame.size, unit_radius * (1.0 - HAIR), self.boundary)?;
        Ok(Nodes {
            domain,
            bits: requested.bits,
            units: requested.units(),
            limit: requested.limit * requested.least,
        })
    }

    /// Returns the radii of an expression at nodes of another pitch, if there is one in whose lattice they differ by no more than is
    /// possible: the nearer the least radius is to R units, the larger the greatest one may be.
    fn requested_for_contrast(
        &self,
        radius: &RadiusSource,
        frame: &Frame,
        mut requested: RequestedRadii,
    ) -> Result<RequestedRadii, VaryingError> {
        // Between other nodes the least radius may be a little smaller. Then the pitch follows from that.
        const TRIES: usize = 4;
        for _ in 0..TRIES {
            let Some(mut squares) = squares_for(frame.size, self.boundary, requested.least) else {
                break;
            };
            if self.boundary == Boundary::Bounded {
                squares.counts = self.squares_beside(frame, squares.pitch, requested.least)?;
            }
            let asked = self.requests(radius, frame, squares)?;
            requested = RequestedRadii::new(asked, squares.pitch)?;
            if !requested.are_too_unlike() {
                break;
            }
        }
        Ok(requested)
    }

    /// Returns how many squares of a pitch a bounded domain has in the lattice that follows from a least radius: the last of a row may
    /// lie beyond the border by less than a lattice unit, and is then none.
    fn squares_beside(
        &self,
        frame: &Frame,
        pitch: f64,
        least: f64,
    ) -> Result<[usize; 2], VaryingError> {
        // The pitch was chosen so that this is a power of two but for rounding.
        let units = f64::from(R) * pitch / least;
        let bits = (units.log2().round() as u32).min(MAX_PITCH_BITS);
        let unit_radius = pitch / f64::from(1_u32 << bits) * f64::from(R);
        let domain = Domain::from_size(frame.size, unit_radius * (1.0 - HAIR), self.boundary)?;
        let nodes = RadiusField::node_counts(&domain, bits)?;
        Ok(nodes.map(|count| count - 1))
    }

    /// Returns the shape for the sampler, for the judge and for the certificate.
    fn shapes(&self, frame: &Frame, domain: &Domain, bits: u32) -> Result<Shapes, VaryingError> {
        match &self.shape {
            None => Ok(Shapes {
                sampled: Shape::rectangle(),
                judged: JudgedShape::Rectangle,
                stated: None,
            }),
            Some(ShapeSource::Polygon(polygon)) => {
                // Sampler and judge get the corners in whole units, and the certificate the coordinates that these are rounded
                // from.
                let in_units = |corner: &[f64; 2]| lattice_corner(*corner, frame.origin, domain);
                let of_ring = |ring: &Vec<[f64; 2]>| ring.iter().map(in_units).collect();
                let rings: Vec<Vec<[i32; 2]>> = polygon.rings.iter().map(of_ring).collect();
                let points = rings
                    .iter()
                    .map(|ring| ring.iter().map(|&[x, y]| Point::new(x, y)).collect());

                let sampled = Shape::polygon(&points.collect::<Vec<_>>())?;
                let stated = CertifiedShape::Polygon {
                    rings: polygon.rings.clone(),
                };
                Ok(Shapes {
                    sampled,
                    judged: JudgedShape::Polygon { rings },
                    stated: Some(stated),
                })
            }
            Some(ShapeSource::Mask(image)) => {
                self.masked(frame, domain, bits, image.columns, image.inside())
            }
            Some(ShapeSource::Dark { image, white }) => self.masked(
                frame,
                domain,
                bits,
                image.columns,
                image.darker_than(*white),
            ),
        }
    }

    /// Returns the shape of chosen pixels, which are the squares of the field: 2^`bits` units wide, but for exact tiling, whose
    /// lattice has a fixed number of units in the radius, so that pixels need not be whole.
    fn masked(
        &self,
        frame: &Frame,
        domain: &Domain,
        bits: u32,
        columns: usize,
        pixels: Vec<bool>,
    ) -> Result<Shapes, VaryingError> {
        let sampled = if self.exact.is_some() {
            Shape::filling(domain, columns, &pixels)?
        } else {
            Shape::mask(bits, columns, &pixels)?
        };
        // A certificate holds no pixels: their digest shows whether an image that is given has the same ones. With a mask
        // there are always squares, so that the 1 is never used.
        let stated = CertifiedShape::Mask {
            digest: mask_digest(columns, &pixels),
            pitch: frame.squares.map_or(1.0, |squares| squares.pitch),
        };

        let judged = if self.exact.is_some() {
            JudgedShape::Filling { columns, pixels }
        } else {
            JudgedShape::Mask {
                pitch_bits: bits,
                columns,
                pixels,
            }
        };
        Ok(Shapes {
            sampled,
            judged,
            stated: Some(stated),
        })
    }
}

impl Ground {
    /// Returns how many pixels of a density are too light for the largest radius, with the radii that this ground has.
    pub(super) fn capped(&self, radius: &RadiusSource) -> usize {
        let RadiusSource::Density { image, black } = radius else {
            return 0;
        };
        // Darkness goes with the inverse square of the radius.
        let largest = self.limit.min(DENSITY_CAP * black);
        let all = 0.0;
        image.lighter_than(all, (black / largest).powi(2))
    }
}

/// Checks that so many columns and rows of pixels are squares in a domain of this width and height.
///
/// # Errors
///
/// [`VaryingError::Aspect`] if they are not.
pub fn check_pixels(pixels: [usize; 2], size: [f64; 2]) -> Result<(), VaryingError> {
    pitch_of_pixels(pixels, size).map(|_| ())
}

/// Returns the side of the pixels of a domain; fails unless they are squares.
fn pitch_of_pixels(pixels: [usize; 2], size: [f64; 2]) -> Result<f64, VaryingError> {
    let [columns, rows] = pixels.map(|count| count as f64);
    let (pitch, other) = (size[0] / columns, size[1] / rows);
    if (pitch / other - 1.0).abs() < SAME_RATIO {
        return Ok(pitch);
    }
    Err(VaryingError::Aspect { pixels, size })
}

/// Returns the sum of the grey values of the pixels around a node, and how many there are.
fn grey_around(grey: &[u16], squares: [usize; 2], wraps: bool, node: [usize; 2]) -> (u32, u32) {
    // A sum of integers, and no mean yet: it has the same bits in every order.
    pixels_around(squares, wraps, node).fold((0, 0), |(sum, count), pixel| {
        (sum + u32::from(grey[pixel]), count + 1)
    })
}

/// Returns the lattice point nearest to a corner, which may lie outside of the domain.
fn lattice_corner(corner: [f64; 2], origin: [f64; 2], domain: &Domain) -> [i32; 2] {
    let unit = domain.unit();
    // Corners that are farther than the lattice reaches end at its limit.
    let limit = f64::from(i32::MAX);
    [0, 1].map(|axis| {
        ((corner[axis] - origin[axis]) / unit[axis])
            .round()
            .clamp(-limit, limit) as i32
    })
}

/// Returns the radius as a certificate states it.
fn stated_radius(source: &RadiusSource, nodes: &Nodes) -> CertifiedRadius {
    if let RadiusSource::Constant(radius) = source {
        return CertifiedRadius::Constant(*radius);
    }
    // The units along the two axes differ by rounding alone. With the smaller one, no length is stated too long.
    let unit = nodes.domain.unit().min_element();
    // A field has nodes, so that R is never used.
    let extreme = |unit_radius: Option<&i32>| f64::from(unit_radius.copied().unwrap_or(R)) * unit;
    CertifiedRadius::Field(CertifiedField {
        rule: RadiusRule::HarmonicMean,
        digest: field_digest(nodes),
        pitch: f64::from(1_u32 << nodes.bits) * unit,
        least: extreme(nodes.units.iter().min()),
        greatest: extreme(nodes.units.iter().max()),
    })
}

/// Returns the digest of a field: of a line with its lattice, and the radii of its nodes in units.
fn field_digest(
    Nodes {
        domain,
        bits,
        units,
        ..
    }: &Nodes,
) -> String {
    let (width, height) = (domain.width(), domain.height());
    let mut bytes =
        format!("tilescope field: {width} x {height} units, nodes every 2^{bits}\n").into_bytes();
    bytes.extend(units.iter().flat_map(|unit| unit.to_le_bytes()));
    bytes_digest(&bytes)
}

/// Returns the digest of a mask: of a line with its size, and a byte for each pixel.
fn mask_digest(columns: usize, pixels: &[bool]) -> String {
    let rows = pixels.len() / columns;
    let mut bytes = format!("tilescope mask: {columns} x {rows} pixels\n").into_bytes();
    bytes.extend(pixels.iter().map(|&inside| u8::from(inside)));
    bytes_digest(&bytes)
}
