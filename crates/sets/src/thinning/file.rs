//! Files of points, thinned: what they were chosen from, the choice, its verdict and its certificate.

use rayon::prelude::*;
use tilescope_analysis::{Control, Number, Region, SolidError, ThinnedReport, VerifyError};
use tilescope_core::Boundary;
use tilescope_formats::{
    Certificate, CertifiedRadius, ColumnUse, Format, FormatError, Hint, KeptRows, RadiusColumn,
    RadiusRule, ReadSet, Thinned, ThinnedFacts, decode, detect, keep_rows, positions_digest,
    read_column,
};

use super::{
    Cloud, CloudRadii, ThinError, ThinningPriority, Torus, UnknownPriority, bounds, judge, ranks,
    thin,
};
use crate::facts::Stated;
use crate::varying::{GivenRadius, RadiusSource, VaryingError, VaryingRecipe};

/// Why a file of points cannot be thinned, or a thinned one not be judged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ThinFileError {
    /// The file cannot be read, or not be written with fewer points.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// The points cannot be thinned.
    #[error(transparent)]
    Thin(#[from] ThinError),
    /// The radii cannot be had.
    #[error(transparent)]
    Varying(#[from] VaryingError),
    /// The order of the points is not known.
    #[error("the certificate cannot be judged: {0}")]
    Priority(#[from] UnknownPriority),
    /// There is no verdict.
    #[error("the thinned set has no verdict: {0}")]
    Verify(#[from] VerifyError),
    /// The points seem to be longitudes and latitudes.
    #[error(
        "all points lie within 180 and 90, as longitudes and latitudes do: distances in degrees are not those of a plane; \
         project the points to a plane first, or let --planar take them as they are"
    )]
    Degrees,
    /// A point lies outside the domain that was given.
    #[error("point {index} at ({x}, {y}) lies outside the domain, {region} from its corner at {} {}", origin[0], origin[1])]
    Outside {
        /// The index of the first such point.
        index: usize,
        /// Its x, as the file has it.
        x: f64,
        /// Its y, as the file has it.
        y: f64,
        /// The domain that was given.
        region: Region,
        /// Where its lower corner lies.
        origin: [f64; 2],
    },
    /// The radii of a column differ too much.
    #[error(
        "the radii in column {column} are from {} (point {}) to {} (point {}); the greatest may be at most {MAX_COLUMN_CONTRAST} \
         times the least",
        Number(radii[0]), points[0], Number(radii[1]), points[1]
    )]
    Contrast {
        /// The name of the column.
        column: String,
        /// The least and the greatest radius.
        radii: [f64; 2],
        /// The indices of the first points that have these.
        points: [usize; 2],
    },
    /// The rectangle around the points is no region.
    #[error("the points reach over {} x {}, which is no region that can be certified", Number(size[0]), Number(size[1]))]
    Region {
        /// The sides of the rectangle.
        size: [f64; 2],
    },
    /// The box around the points is no region.
    #[error("the points reach over {} x {} x {}, which is no region that can be certified", Number(size[0]), Number(size[1]), Number(size[2]))]
    Box {
        /// The sides of the box.
        size: [f64; 3],
    },
    /// A thinned set in space has no verdict.
    #[error("the thinned set has no verdict: {0}")]
    Solid(#[from] SolidError),
    /// The file would be read in another way under its new name.
    #[error(
        "called {name}, the file would be read as {found} and not as {format}; give it the extension of the input"
    )]
    Misnamed {
        /// The name that the file was to get.
        name: String,
        /// How it would be read.
        found: Format,
        /// How it is read now.
        format: Format,
    },
    /// The points that were read back are not those that were kept.
    #[error("reading back gave other points than were kept")]
    ReadBack,
}

/// A file of points, read.
#[derive(Debug)]
pub struct PointFile<'a> {
    /// The bytes of the file.
    pub bytes: &'a [u8],
    /// How they are read.
    pub hint: Hint<'a>,
    /// The points as read, in the coordinates of the file.
    pub read: ReadSet,
}

impl<'a> PointFile<'a> {
    /// Reads the points of a file as they are, without a certificate.
    ///
    /// # Errors
    ///
    /// [`ThinFileError::Format`].
    pub fn new(bytes: &'a [u8], hint: Hint<'a>) -> Result<Self, ThinFileError> {
        let read = decode(bytes, &hint)?;
        Ok(Self { bytes, hint, read })
    }

    /// Returns the points, in the coordinates of the file.
    #[must_use]
    pub fn points(&self) -> &[[f64; 2]] {
        &self.read.set.points
    }

    /// Returns the radii that stand in a column.
    fn radii(&self, name: &str) -> Result<Vec<f64>, FormatError> {
        read_column(self.bytes, &self.hint, name, ColumnUse::Radius)
    }

    /// Returns how the points chosen from this file are read from a file of that name.
    #[must_use]
    pub fn hint_of_chosen<'b>(&self, name: &'b str) -> Hint<'b>
    where
        'a: 'b,
    {
        hint_of_chosen(&self.hint, name)
    }

    /// Refuses a name under which the file would be read in another way.
    ///
    /// # Errors
    ///
    /// [`ThinFileError::Misnamed`].
    pub fn check_name(&self, name: &str) -> Result<(), ThinFileError> {
        let (found, format) = (
            detect(self.bytes, name.as_ref())?.format,
            self.read.detection.format,
        );
        // Where columns are chosen, lines of numbers are a table. A format that is given holds for any name.
        let is_table = self.hint.columns.is_some() && found == Format::UtkText;
        if found == format || is_table || self.hint.format.is_some() {
            return Ok(());
        }
        Err(self.misnamed(name, found))
    }

    fn misnamed(&self, name: &str, found: Format) -> ThinFileError {
        ThinFileError::Misnamed {
            name: name.to_owned(),
            found,
            format: self.read.detection.format,
        }
    }

    /// Returns the file with only those points that are kept, to be called `name`. Its bytes stand in `rows`, from
    /// which it borrows them.
    ///
    /// # Errors
    ///
    /// [`ThinFileError::Format`] where the format cannot keep what belongs to a point, [`ThinFileError::ReadBack`], and
    /// as [`Self::check_name`].
    pub fn keep<'b>(
        &self,
        kept: &[bool],
        rows: &'b mut KeptRows,
        name: &'b str,
    ) -> Result<PointFile<'b>, ThinFileError>
    where
        'a: 'b,
    {
        *rows = keep_rows(self.bytes, &self.hint, kept)?;
        let chosen = PointFile::new(&rows.bytes, self.hint_of_chosen(name))?;
        // The format is recognised by the rows, too. With fewer rows it may be another one than that of the given file,
        // which `check_name`, given all rows, cannot foresee.
        let found_format = chosen.read.detection.format;
        if found_format != self.read.detection.format {
            return Err(self.misnamed(name, found_format));
        }

        check_chosen(chosen.points(), self.points(), kept)?;
        Ok(chosen)
    }
}

/// Refuses points that were read back and are not those that were kept.
pub(super) fn check_chosen<const N: usize>(
    chosen: &[[f64; N]],
    given: &[[f64; N]],
    kept: &[bool],
) -> Result<(), ThinFileError> {
    // To the bit: 0 and -0 are the same place, but not the same digest.
    let bits = |point: &[f64; N]| point.map(f64::to_bits);
    let expected = (given.iter().zip(kept)).filter(|(_, kept)| **kept);
    if (chosen.iter().map(bits)).eq(expected.map(|(point, _)| bits(point))) {
        Ok(())
    } else {
        Err(ThinFileError::ReadBack)
    }
}

/// Returns how the points chosen from a file are read, if it is read by `hint`, from a file of that name.
pub(super) fn hint_of_chosen<'b>(hint: &Hint<'b>, name: &'b str) -> Hint<'b> {
    Hint {
        name,
        // Of several sets one is left.
        set: None,
        ..*hint
    }
}

/// Returns the rank of each of `count` points in a file, unless that is its index. A column is read only to rank the points by it.
pub(super) fn ranks_in(
    bytes: &[u8],
    hint: &Hint<'_>,
    priority: &ThinningPriority,
    count: usize,
) -> Result<Option<Vec<u32>>, FormatError> {
    let column = match priority {
        ThinningPriority::Column { column, .. } => {
            read_column(bytes, hint, column, ColumnUse::Order)?
        }
        ThinningPriority::Order | ThinningPriority::Random { .. } => Vec::new(),
    };
    Ok(ranks(priority, count, &column))
}

/// Where the radii of points come from.
#[derive(Clone, Debug)]
pub enum ThinRadius {
    /// They are one for all, or those of a field at the places of the points.
    Source(RadiusSource),
    /// They stand in a column or a property of the file, by its name or its number from 1.
    Column(String),
}

/// Radii before the rectangle around the points is known.
enum ReadRadii<'a> {
    /// Those of a column, and what certificates state of them.
    Column(RadiusColumn, Vec<f64>),
    /// Those that follow from the places of the points.
    Source(&'a RadiusSource),
}

impl ReadRadii<'_> {
    /// Returns the least radius, unless a field has to be evaluated before.
    const fn least(&self) -> Option<f64> {
        match self {
            Self::Column(stated, _) => Some(stated.least),
            Self::Source(source) => source.constant(),
        }
    }
}

impl ThinRadius {
    /// Reads the radii of a column.
    fn read(&self, file: &PointFile<'_>) -> Result<ReadRadii<'_>, ThinFileError> {
        match self {
            Self::Source(source) => Ok(ReadRadii::Source(source)),
            Self::Column(name) => {
                let radii = file.radii(name)?;
                refuse_contrast(&radii, name)?;
                Ok(ReadRadii::Column(column(&radii, name), radii))
            }
        }
    }

    /// Returns the pixels of a row and of a column, if the radii are those of pixels in a bounded domain.
    fn pixels(&self) -> Option<[usize; 2]> {
        match self {
            Self::Source(source) => source.pixels(Boundary::Bounded),
            Self::Column(_) => None,
        }
    }

    /// Returns the parameter that certificates state it by.
    fn stated(&self) -> (&'static str, serde_json::Value) {
        match self {
            Self::Source(source) => source.stated(),
            Self::Column(name) => ("radius-column", name.as_str().into()),
        }
    }
}

/// The most that the greatest radius of a column is of the least one. Each octave of radii has a grid of its own, and each point
/// looks around in all of them: in thirteen at this limit. Chosen, not measured.
pub const MAX_COLUMN_CONTRAST: f64 = 4096.0;

/// How the points of a file are thinned.
#[derive(Clone, Debug)]
pub struct ThinRecipe {
    /// Where the radii come from.
    pub radius: ThinRadius,
    /// In which order points are taken.
    pub priority: ThinningPriority,
    /// The domain and its lower corner; without it, the rectangle around the points, which for radii of pixels has their
    /// proportions.
    pub domain: Option<(Region, [f64; 2])>,
}

/// What a file is thinned and judged by.
#[derive(Clone, Debug)]
pub struct Thinning {
    /// A rectangle around all points.
    pub region: Region,
    /// Where its lower corner lies.
    pub origin: [f64; 2],
    /// The radius, as certificates state it; of a column, that of all points.
    pub radius: CertifiedRadius,
    /// The radius of each point, where it varies.
    radii: Option<Vec<f64>>,
    /// The order of the points, if it is needed and not that of the file.
    ranks: Option<Vec<u32>>,
    priority: ThinningPriority,
    parameters: Stated,
}

impl ThinRecipe {
    /// Returns the recipe by which the thinned set of a certificate is judged. `given` is the field of a radius that
    /// varies: certificates hold no field.
    ///
    /// # Errors
    ///
    /// [`ThinFileError::Varying`] where the certificate does not say from what the radius follows, and
    /// [`ThinFileError::Priority`].
    pub fn of_certificate(
        stated: &Certificate,
        thinned: &Thinned,
        given: GivenRadius,
    ) -> Result<Self, ThinFileError> {
        let radius = match &stated.radius {
            CertifiedRadius::Column(column) => ThinRadius::Column(column.column.clone()),
            CertifiedRadius::Constant(_) | CertifiedRadius::Field(_) => {
                ThinRadius::Source(RadiusSource::of_certificate(stated, given)?)
            }
        };
        Ok(Self {
            radius,
            priority: thinned.priority.parse()?,
            domain: Some((stated.region, stated.origin.unwrap_or_default())),
        })
    }

    /// Returns by what a file is thinned. `with_ranks` is false for a file of chosen points that is judged without its
    /// source: all of its points are kept, and their order does not matter.
    ///
    /// # Errors
    ///
    /// [`ThinFileError`] for points outside of the domain, for a rectangle around them that is no region, and for radii
    /// and columns that cannot be used.
    pub fn prepare(
        &self,
        file: &PointFile<'_>,
        with_ranks: bool,
    ) -> Result<Thinning, ThinFileError> {
        let points = file.points();
        // A column is read before the rectangle is made: no side of the rectangle is shorter than the least radius.
        let read = self.radius.read(file)?;

        // The rectangle around the points takes the place of a domain that is not given. It need not be covered: points are
        // judged, and not places.
        let (region, origin) = if let Some(domain) = self.domain {
            domain
        } else {
            let (region, origin) = around(points, read.least())?;
            (in_proportion(region, self.radius.pixels()), origin)
        };
        refuse_outside(points, region, origin)?;

        let (radius, radii) = match read {
            ReadRadii::Column(stated, radii) => (CertifiedRadius::Column(stated), Some(radii)),
            ReadRadii::Source(source) => {
                if let Some(radius) = source.constant() {
                    (CertifiedRadius::Constant(radius), None)
                } else {
                    let (radius, radii) = of_field(source, points, region, origin)?;
                    (radius, Some(radii))
                }
            }
        };
        let ranks = if with_ranks {
            ranks_in(file.bytes, &file.hint, &self.priority, points.len())?
        } else {
            None
        };

        let (name, value) = self.radius.stated();
        Ok(Thinning {
            region,
            origin,
            radius,
            radii,
            ranks,
            priority: self.priority.clone(),
            parameters: Stated::from([(name.to_owned(), value)]),
        })
    }
}

/// Returns the field as certificates state it, and its radius at each point. Sets are made and judged with the same
/// field.
fn of_field(
    source: &RadiusSource,
    points: &[[f64; 2]],
    region: Region,
    origin: [f64; 2],
) -> Result<(CertifiedRadius, Vec<f64>), ThinFileError> {
    let recipe = VaryingRecipe {
        radius: source.clone(),
        shape: None,
        size: region.size().map(Some),
        origin: Some(origin),
        boundary: Boundary::of(region.is_periodic()),
        // No set is made, so that the seed and the count have no meaning.
        seed: 0,
        count: None,
        exact: None,
    };
    let varying = recipe.ground()?.varying;

    // Once for each point: the choice and its judge get the same numbers.
    let radius = |point: &[f64; 2]| {
        let place = [point[0] - origin[0], point[1] - origin[1]];
        varying.judged.radius_at(place)
    };
    let radii = points.par_iter().map(radius).collect();
    Ok((varying.radius.clone(), radii))
}

/// Returns what a certificate states of the radii in a column.
fn column(radii: &[f64], name: &str) -> RadiusColumn {
    let [least, greatest] = CloudRadii::Each(radii).extremes();
    RadiusColumn {
        rule: RadiusRule::HarmonicMean,
        column: name.to_owned(),
        least,
        greatest,
    }
}

/// Fails if the radii of a column differ by more than is judged in reasonable time.
fn refuse_contrast(radii: &[f64], name: &str) -> Result<(), ThinFileError> {
    let [least, greatest] = CloudRadii::Each(radii).extremes();
    if greatest / least <= MAX_COLUMN_CONTRAST {
        return Ok(());
    }
    // Both extremes are radii of points, so that the default below never stands in.
    let first = |wanted: f64| {
        radii
            .iter()
            .position(|radius| radius.total_cmp(&wanted).is_eq())
    };
    Err(ThinFileError::Contrast {
        column: name.to_owned(),
        radii: [least, greatest],
        points: [least, greatest].map(|radius| first(radius).unwrap_or_default()),
    })
}

/// Returns the rectangle around some points. A side is at least the least radius, so that points on a line have a region, too.
fn around(points: &[[f64; 2]], radius: Option<f64>) -> Result<(Region, [f64; 2]), ThinFileError> {
    let (origin, size) = bounds(points);
    let longer = size[0].max(size[1]);
    // A field has no radius before it is evaluated: about a thousandth of the longer side stands for it. The part was
    // chosen, not measured.
    let least = radius.unwrap_or(longer / 1024.0);
    let is_periodic = false;
    let region = Region::new(size.map(|side| side.max(least)), is_periodic);
    if region.is_supported() {
        return Ok((region, origin));
    }
    // A radius that is not a positive number has an error of its own.
    match radius {
        Some(radius) if !(radius > 0.0 && radius.is_finite()) => {
            Err(ThinError::Radius { radius }.into())
        }
        _ => Err(ThinFileError::Region { size }),
    }
}

/// Returns the smallest region that square pixels fill and that holds a bounded one at its lower corner. Without pixels it is
/// that one.
fn in_proportion(region: Region, pixels: Option<[usize; 2]>) -> Region {
    let Some([columns, rows]) = pixels.map(|counts| counts.map(|count| count as f64)) else {
        return region;
    };
    // The side that is kept stays as it is to the bit, so that no point falls outside by rounding.
    let [width, height] = region.size();
    let size = if width * rows / columns >= height {
        [width, width * rows / columns]
    } else {
        [height * columns / rows, height]
    };
    let is_periodic = false;
    Region::new(size, is_periodic)
}

/// Fails if a point is not in the stated region.
fn refuse_outside(
    points: &[[f64; 2]],
    region: Region,
    origin: [f64; 2],
) -> Result<(), ThinFileError> {
    let is_outside = |&[x, y]: &[f64; 2]| !region.contains([x - origin[0], y - origin[1]]);
    let Some(index) = points.par_iter().position_first(is_outside) else {
        return Ok(());
    };
    let [x, y] = points[index];
    Err(ThinFileError::Outside {
        index,
        x,
        y,
        region,
        origin,
    })
}

impl Thinning {
    fn cloud<'a>(&'a self, points: &'a [[f64; 2]]) -> Cloud<'a> {
        let radii = self.radii.as_deref().map(CloudRadii::Each);
        Cloud {
            points,
            radii: radii.unwrap_or(CloudRadii::Constant(self.radius.least())),
            ranks: self.ranks.as_deref(),
            torus: self.region.is_periodic().then_some(Torus {
                origin: self.origin,
                sides: self.region.size(),
            }),
        }
    }

    /// Returns in which order points are taken.
    #[must_use]
    pub fn priority(&self) -> &ThinningPriority {
        &self.priority
    }

    /// Returns the order of the points, if it is not that of the file.
    #[must_use]
    pub fn ranks(&self) -> Option<&[u32]> {
        self.ranks.as_deref()
    }

    /// Returns which points are kept, as [`thin`] does.
    ///
    /// # Errors
    ///
    /// Those of [`thin`].
    pub fn choose(
        &self,
        points: &[[f64; 2]],
        control: Control<'_>,
    ) -> Result<Vec<bool>, ThinError> {
        thin(&self.cloud(points), control)
    }

    /// Judges which points were kept, as [`judge`] does.
    ///
    /// # Errors
    ///
    /// Those of [`judge`].
    pub fn judge(
        &self,
        points: &[[f64; 2]],
        kept: &[bool],
        control: Control<'_>,
    ) -> Result<ThinnedReport, VerifyError> {
        judge(&self.cloud(points), kept, control)
    }

    /// Returns the certificate of the points chosen from some.
    ///
    /// # Errors
    ///
    /// As [`Self::certificate_of`].
    pub fn certificate(
        &self,
        given: &[[f64; 2]],
        chosen: &PointFile<'_>,
        report: &ThinnedReport,
    ) -> Result<Certificate, ThinFileError> {
        self.certificate_of(chosen, report, positions_digest(given), given.len() as u64)
    }

    /// Returns the certificate of points that were chosen from `given_count` points, whose digest is `source_digest`.
    ///
    /// # Errors
    ///
    /// [`ThinFileError::Format`] where the file has no radii in the column that states them.
    pub fn certificate_of(
        &self,
        chosen: &PointFile<'_>,
        report: &ThinnedReport,
        source_digest: String,
        given_count: u64,
    ) -> Result<Certificate, ThinFileError> {
        // Of radii in a column the certificate states those of the kept points, which a reader of their file has.
        let radius = match &self.radius {
            CertifiedRadius::Column(RadiusColumn { column: name, .. }) => {
                CertifiedRadius::Column(column(&chosen.radii(name)?, name))
            }
            CertifiedRadius::Constant(_) | CertifiedRadius::Field(_) => self.radius.clone(),
        };

        let facts = ThinnedFacts {
            name: chosen.hint.name,
            data: chosen.bytes,
            read: &chosen.read,
            region: self.region,
            origin: self.origin,
            radius,
            parameters: self.parameters.clone(),
            thinned: Thinned {
                source: source_digest,
                given: given_count,
                priority: self.priority.to_string(),
            },
            report,
        };
        Ok(facts.certificate())
    }

    /// Adds a parameter to those that the certificate states.
    pub fn state(&mut self, name: &str, value: serde_json::Value) {
        self.parameters.insert(name.to_owned(), value);
    }
}
