//! Files of points in space, thinned: the choice, its verdict and its certificate.

use tilescope_analysis::{Boundary, Control, SolidError, SolidRegion, ThinnedReport};
use tilescope_formats::{
    Certificate, Format, FormatError, Hint, KeptRows, SolidRaw, Thinned, ThinnedSolidFacts,
    decode_solid, detect, keep_rows, solid_digest,
};

use super::super::file::{ThinFileError, check_chosen, hint_of_chosen, ranks_in};
use super::super::{ThinError, ThinningPriority};
use super::{SpaceCloud, bounds, judge_space, thin_space};
use crate::facts::Stated;

/// A file of points in space, read.
#[derive(Debug)]
pub struct SpaceFile<'a> {
    /// The bytes of the file.
    pub bytes: &'a [u8],
    /// How they are read.
    pub hint: Hint<'a>,
    /// The points as read, in the coordinates of the file.
    pub read: SolidRaw,
}

impl<'a> SpaceFile<'a> {
    /// Reads the points of a file as they are, without a certificate.
    ///
    /// # Errors
    ///
    /// [`FormatError`] also for files whose points have no third coordinate.
    pub fn new(bytes: &'a [u8], hint: Hint<'a>) -> Result<Self, FormatError> {
        let read = decode_solid(bytes, &hint)?;
        Ok(Self { bytes, hint, read })
    }

    /// Returns the points, in the coordinates of the file.
    #[must_use]
    pub fn points(&self) -> &[[f64; 3]] {
        &self.read.points
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
    ) -> Result<SpaceFile<'b>, ThinFileError>
    where
        'a: 'b,
    {
        *rows = keep_rows(self.bytes, &self.hint, kept)?;
        let chosen = SpaceFile::new(&rows.bytes, hint_of_chosen(&self.hint, name))?;
        // The format is recognised by the rows, too. With fewer rows it may be another one than that of the given file,
        // which `check_name`, given all rows, cannot foresee.
        let (found, format) = (chosen.read.detection.format, self.read.detection.format);
        if found != format {
            let name = name.to_owned();
            return Err(ThinFileError::Misnamed {
                name,
                found,
                format,
            });
        }

        check_chosen(chosen.points(), self.points(), kept)?;
        Ok(chosen)
    }

    /// Refuses a name under which the file would be read in another way.
    ///
    /// # Errors
    ///
    /// [`ThinFileError::Misnamed`].
    pub fn check_name(&self, name: &str) -> Result<(), ThinFileError> {
        let format = self.read.detection.format;
        let found = match self.hint.format {
            // A format that is given holds for any name.
            Some(_) => format,
            None => detect(self.bytes, name.as_ref())?.format,
        };
        // `detect` takes lines of three numbers for XYZ. `decode_solid` reads such lines as UTK's if the name says so:
        // under a name that says so again they are read in the same way.
        let is_as_named = found == Format::Xyz && Format::from_path(name.as_ref()) == Some(format);
        if found == format || is_as_named {
            return Ok(());
        }
        Err(ThinFileError::Misnamed {
            name: name.to_owned(),
            found,
            format,
        })
    }
}

/// How the points of a file in space are thinned.
#[derive(Clone, Debug)]
pub struct SpaceRecipe {
    /// The radius of all points.
    pub radius: f64,
    /// In which order points are taken.
    pub priority: ThinningPriority,
}

/// What a file in space is thinned and judged by.
#[derive(Clone, Debug)]
pub struct SpaceThinning {
    /// The sides of a box around all points.
    pub region: SolidRegion,
    /// The radius.
    pub radius: f64,
    /// The order of the points, if it is needed and not that of the file.
    ranks: Option<Vec<u32>>,
    priority: ThinningPriority,
    parameters: Stated,
}

impl SpaceRecipe {
    /// Returns the parts of a certificate's thinned set that a judge needs.
    ///
    /// # Errors
    ///
    /// [`ThinFileError::Priority`].
    pub fn of_certificate(stated: &Certificate, thinned: &Thinned) -> Result<Self, ThinFileError> {
        Ok(Self {
            radius: stated.radius.least(),
            priority: thinned.priority.parse()?,
        })
    }

    /// Returns by what a file is thinned. `with_ranks` is false for a file of chosen points that is judged without its
    /// source: all of its points are kept, and their order does not matter. `region` is the box that a certificate states;
    /// without one it is that around the points.
    ///
    /// # Errors
    ///
    /// [`ThinFileError`] for a box around the points that is no region, and for radii and columns that cannot be used.
    pub fn prepare(
        &self,
        file: &SpaceFile<'_>,
        region: Option<SolidRegion>,
        with_ranks: bool,
    ) -> Result<SpaceThinning, ThinFileError> {
        let points = file.points();
        let region = match region {
            Some(region) => region,
            None => around(points, self.radius)?,
        };

        let ranks = if with_ranks {
            ranks_in(file.bytes, &file.hint, &self.priority, points.len())?
        } else {
            None
        };
        Ok(SpaceThinning {
            region,
            radius: self.radius,
            ranks,
            priority: self.priority.clone(),
            parameters: Stated::from([("radius".to_owned(), self.radius.into())]),
        })
    }
}

/// Returns the sides of a box around some points. No side is shorter than a radius, so that points in a plane have a
/// box, too. Nor is a side so short that the ratio of the longest side to it exceeds what a box may have.
fn around(points: &[[f64; 3]], radius: f64) -> Result<SolidRegion, ThinFileError> {
    let (_, size) = bounds(points);
    let longest = size.into_iter().fold(0.0, f64::max);
    let least = radius.max(longest / SolidRegion::MAX_ASPECT);
    let [width, height, depth] = size.map(|side| side.max(least));
    let region = SolidRegion {
        width,
        height,
        depth,
        boundary: Boundary::Bounded,
    };
    if region.is_supported() {
        return Ok(region);
    }
    // A radius that is not a positive number has an error of its own.
    if radius > 0.0 && radius.is_finite() {
        Err(ThinFileError::Box { size })
    } else {
        Err(ThinError::Radius { radius }.into())
    }
}

impl SpaceThinning {
    fn cloud<'a>(&'a self, points: &'a [[f64; 3]]) -> SpaceCloud<'a> {
        SpaceCloud {
            points,
            radius: self.radius,
            ranks: self.ranks.as_deref(),
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

    /// Returns whether points fit into a box of the sides of the region, wherever it lies.
    #[must_use]
    pub fn has_room_for(&self, points: &[[f64; 3]]) -> bool {
        let (_, size) = bounds(points);
        let sides = self.region.size();
        (0..3).all(|axis| size[axis] <= sides[axis])
    }

    /// Returns which points are kept, as [`thin_space`] does.
    ///
    /// # Errors
    ///
    /// Those of [`thin_space`].
    pub fn choose(
        &self,
        points: &[[f64; 3]],
        control: Control<'_>,
    ) -> Result<Vec<bool>, ThinError> {
        thin_space(&self.cloud(points), control)
    }

    /// Judges which points were kept, as [`judge_space`] does.
    ///
    /// # Errors
    ///
    /// Those of [`judge_space`].
    pub fn judge(
        &self,
        points: &[[f64; 3]],
        kept: &[bool],
        control: Control<'_>,
    ) -> Result<ThinnedReport, SolidError> {
        judge_space(&self.cloud(points), kept, control)
    }

    /// Returns the certificate of the points chosen from some.
    #[must_use]
    pub fn certificate(
        &self,
        given: &[[f64; 3]],
        chosen: &SpaceFile<'_>,
        report: &ThinnedReport,
    ) -> Certificate {
        self.certificate_of(chosen, report, solid_digest(given), given.len() as u64)
    }

    /// Returns the certificate of points that were chosen from `given_count` points, whose digest is `source_digest`.
    #[must_use]
    pub fn certificate_of(
        &self,
        chosen: &SpaceFile<'_>,
        report: &ThinnedReport,
        source_digest: String,
        given_count: u64,
    ) -> Certificate {
        let facts = ThinnedSolidFacts {
            name: chosen.hint.name,
            data: chosen.bytes,
            read: &chosen.read,
            region: self.region,
            radius: self.radius,
            parameters: self.parameters.clone(),
            thinned: Thinned {
                source: source_digest,
                given: given_count,
                priority: self.priority.to_string(),
            },
            report,
        };
        facts.certificate()
    }

    /// Adds a parameter to those that the certificate states.
    pub fn state(&mut self, name: &str, value: serde_json::Value) {
        self.parameters.insert(name.to_owned(), value);
    }
}
