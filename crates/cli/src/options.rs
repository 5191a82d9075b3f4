//! Arguments of several commands: the domain, radius and format of a set, and values given by name.

use std::path::Path;

use anyhow::{Result, anyhow, bail, ensure};
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use serde::de::DeserializeOwned;
use tilescope_analysis::{Boundary, JudgeChoice, Region, VerifyError, VerifyOptions};
use tilescope_core::{Parameter, ParameterOption};
use tilescope_formats::{
    Certificate, CertificateUse, CheckError, Format, FormatError, Hint, Overrides, ReadSet,
    StreamReader, refuse_degrees,
};

use crate::paths::InFile;
use crate::radius_span::{RadiusSpan, TWO_RADII};
use crate::space::{Sides, SizeArgument};

/// The names of a type's values, the same in options and in JSON, each with its line of `--help`, if any.
pub type Names<const N: usize> = [(&'static str, &'static str); N];

/// The names of number types.
pub const PRECISIONS: Names<2> = [("f32", ""), ("f64", "")];

/// The names of judges.
const JUDGES: Names<4> = [
    ("delaunay", "Delaunay triangulation"),
    ("circles", "Covered circles, several times faster"),
    ("both", "Both, which must agree"),
    (
        "subdivision",
        "Squares, cut until each is covered: the only one for a radius that varies and for shapes; in space cubes",
    ),
];

/// The judges of a set.
#[derive(Clone, Debug, Args)]
pub struct JudgeArguments {
    /// The judge that verifies; if not given, both for up to 1,048,576 samples and covered circles for more, in space
    /// cubes for more
    #[arg(long, value_name = "JUDGE", value_parser = named::<JudgeChoice>(&JUDGES))]
    judge: Option<JudgeChoice>,
}

impl JudgeArguments {
    /// Returns the judges that the arguments choose.
    pub fn choice(&self) -> JudgeChoice {
        self.judge.unwrap_or_default()
    }

    /// Returns how to verify.
    pub fn options(&self) -> VerifyOptions {
        VerifyOptions {
            judges: self.choice(),
            ..VerifyOptions::default()
        }
    }
}

/// Reads values by their names.
pub fn named<T>(names: &[(&'static str, &'static str)]) -> impl TypedValueParser<Value = T> + use<T>
where
    T: DeserializeOwned + Clone + Send + Sync + 'static,
{
    // Names that say all have no help.
    let values = names.iter().map(|(name, help)| match *help {
        "" => PossibleValue::new(*name),
        help => PossibleValue::new(*name).help(help),
    });
    // Names are those of JSON, so that its reader finds the value.
    PossibleValuesParser::new(values)
        .try_map(|name| serde_json::from_value::<T>(serde_json::Value::String(name)))
}

/// Reads the words for a parameter's values.
pub fn words(options: &[ParameterOption]) -> PossibleValuesParser {
    let values = options.iter().map(|option| match option.help {
        "" => PossibleValue::new(option.word),
        help => PossibleValue::new(option.word).help(help),
    });
    PossibleValuesParser::new(values)
}

/// Reads the names of boundaries.
pub fn boundaries() -> impl TypedValueParser<Value = Boundary> + use<> {
    words(Parameter::Boundary.options())
        .try_map(|name| serde_json::from_value::<Boundary>(serde_json::Value::String(name)))
}

/// Reads the names of file formats, so that shells complete them and `--help` lists them.
pub fn formats() -> impl TypedValueParser<Value = Format> + use<> {
    let names = Format::ALL.map(|format| {
        let help = format!("{format}, .{}", format.extension());
        PossibleValue::new(format.name()).help(help)
    });
    PossibleValuesParser::new(names).try_map(|name| name.parse::<Format>())
}

/// Options that stand in for, or override, a set's certificate.
#[derive(Clone, Debug, Args)]
pub struct SetArguments {
    /// Poisson-disk radius; with --radius-image MIN..MAX, the radii of black and of white, of a set without a certificate
    #[arg(long, value_name = "R", value_parser = RadiusSpan::parse)]
    pub radius: Option<RadiusSpan>,
    /// Width of the domain
    #[arg(long, value_name = "W")]
    pub width: Option<f64>,
    /// Height of the domain
    #[arg(long, value_name = "H")]
    pub height: Option<f64>,
    /// Third side of the domain, of a set in space whose certificate does not state it
    #[arg(long, value_name = "D")]
    pub depth: Option<f64>,
    /// How the domain ends
    #[arg(long, value_parser = boundaries())]
    pub boundary: Option<Boundary>,
    /// Format of the input, if neither its extension nor its content names one
    #[arg(long, value_name = "FORMAT", value_parser = formats())]
    pub format: Option<Format>,
    /// Where the lower corner of the domain lies in the file, for a set at map coordinates; if not given, where the
    /// certificate states, or at 0 0
    #[arg(long, num_args = 2, value_names = ["X", "Y"])]
    pub origin: Option<Vec<f64>>,
    /// Beside --origin, where the lower corner of a set in space lies along z in the file; if not given, at 0
    #[arg(long, value_name = "Z", requires = "origin")]
    pub origin_z: Option<f64>,
    /// Take the points of a .geojson file as positions in a plane, though they may be longitudes and latitudes: all lie
    /// within 180 and 90, and some beyond the domain
    #[arg(long)]
    pub planar: bool,
    /// Leave the certificate out, which may be false: the set is then taken for one of unknown origin
    #[arg(long)]
    pub no_certificate: bool,
    /// The columns of x and y in a text table, each by its name, or by its number from 1. Other columns are then not looked
    /// at, but for one named radius where samples have radii of their own; without this option a column z must be 0
    #[arg(long, num_args = 2, value_names = ["A", "B"])]
    pub columns: Option<Vec<String>>,
    /// Which set of a file that holds several, from 0
    #[arg(long, value_name = "I")]
    pub set: Option<usize>,
}

/// Returns the two numbers of `--origin`, if it is given.
pub fn pair(origin: Option<&Vec<f64>>) -> Option<[f64; 2]> {
    origin.and_then(|origin| origin.as_slice().try_into().ok())
}

/// Refuses the first of some options that is given, where the value is the certificate's. A `clause` says what depends on that value.
pub fn refuse_stated(options: &[(&str, bool)], clause: &str) -> Result<()> {
    match options.iter().find(|(_, is_given)| *is_given) {
        Some((name, _)) => bail!("{name} is that of the certificate, {clause}; leave it out"),
        None => Ok(()),
    }
}

/// What to do about a false certificate.
pub const WITHOUT_CERTIFICATE: &str = "--no-certificate reads the set without it";

/// What to do about samples outside the domain.
const ANOTHER_DOMAIN: &str = "--width, --height, --boundary and --origin state another domain";

/// What to do about third coordinates, if neither a certificate nor an option says that the set is one in space.
const IN_SPACE: &str =
    "--depth gives a set in space its third side; draw and convert take a plane of one by --slice";

impl SetArguments {
    /// Returns the values that override the certificate of `path`. A side or boundary that is not given is
    /// the certificate's; without one, the periodic unit square's.
    pub fn overrides(&self, path: &Path) -> Result<Overrides> {
        self.refuse_origin_z()?;
        let given = [
            self.width.is_some(),
            self.height.is_some(),
            self.boundary.is_some(),
        ];
        let mut stated = None;
        // The certificate is read only where it has to fill in one of the three.
        if given.contains(&true) && given.contains(&false) {
            stated = self.certificate(path)?.map(|stated| stated.region);
        }

        let region = || self.region_over(stated.unwrap_or(Region::UNIT_SQUARE));
        // The parser of arguments takes two names or none, so that no other number gets lost here.
        let columns = self.columns.clone();
        // The region stays empty if none of its parts is given. So does a radius or an origin that is not given. The
        // check takes the values of empty fields from the certificate.
        Ok(Overrides {
            format: self.format,
            set: self.set,
            columns: columns.and_then(|columns| columns.try_into().ok()),
            region: given.contains(&true).then(region),
            radius: self.least_radius(),
            origin: self.origin(),
            planar: self.planar,
            without_certificate: self.no_certificate,
            ..Overrides::default()
        })
    }

    /// Returns the given radius; of two, the first.
    pub fn least_radius(&self) -> Option<f64> {
        self.radius.map(|span| span.least)
    }

    /// Refuses two radii, unless there is an image whose grey lies between them.
    pub fn refuse_two_radii(&self, has_image: bool) -> Result<()> {
        let greatest = self.radius.and_then(|span| span.greatest);
        ensure!(greatest.is_none() || has_image, TWO_RADII);
        Ok(())
    }

    /// Takes the sides that `--size` gives in one word.
    pub fn take_sides(&mut self, word: &SizeArgument) {
        if let Some(Sides([width, height, depth])) = word.sides {
            // The parser refuses single sides beside them.
            (self.width, self.height, self.depth) = (Some(width), Some(height), Some(depth));
        }
    }

    /// Refuses the third coordinate of an origin, which planar sets do not have.
    fn refuse_origin_z(&self) -> Result<()> {
        if self.origin_z.is_some() {
            bail!(
                "--origin-z: it is for sets in space, whose certificate states a third side or for which --depth does; leave it out"
            );
        }
        Ok(())
    }

    /// Returns the given origin.
    pub fn origin(&self) -> Option<[f64; 2]> {
        pair(self.origin.as_ref())
    }

    /// Returns the given origin of a set in space; without a third coordinate it has z = 0.
    pub fn origin_in_space(&self) -> Option<[f64; 3]> {
        let [x, y] = self.origin()?;
        Some([x, y, self.origin_z.unwrap_or_default()])
    }

    /// Refuses a radius or a domain beside the certificate's. A `clause` says what depends on these.
    pub fn refuse_domain(&self, clause: &str) -> Result<()> {
        let given = [
            ("--radius", self.radius.is_some()),
            ("--width", self.width.is_some()),
            ("--height", self.height.is_some()),
            ("--boundary", self.boundary.is_some()),
        ];
        refuse_stated(&given, clause)
    }

    /// Refuses a set, read without a verdict, that seems to be of longitudes and latitudes beyond its domain.
    pub fn refuse_degrees(&self, read: &ReadSet, region: Region) -> Result<()> {
        if self.planar {
            return Ok(());
        }
        // Positions that were read are in domain units: the domain's lower corner is 0.
        refuse_degrees(read, region, [0.0; 2]).map_err(|error| hinted(error.into()))
    }

    /// Returns the given region, with missing parts taken from `base`.
    pub fn region_over(&self, base: Region) -> Region {
        Region {
            width: self.width.unwrap_or(base.width),
            height: self.height.unwrap_or(base.height),
            boundary: self.boundary.unwrap_or(base.boundary),
        }
    }

    /// Returns the certificate of `path` as it is, unless it is left out. Reads the points only if the format requires it.
    pub fn certificate(&self, path: &Path) -> Result<Option<Certificate>> {
        if self.no_certificate {
            return Ok(None);
        }
        // A file that cannot be read in pieces is read as a whole; if it cannot be read at all, the error says why.
        if let Ok(reader) = StreamReader::open(path, self.format) {
            return Ok(reader.certificate().cloned());
        }
        let hint = Hint {
            format: self.format,
            // A certificate belongs to the whole file: it is read with any set of it.
            set: self.set.or(Some(0)),
            // Only the certificate is wanted, so that points with a third coordinate are no reason to refuse the file.
            any_z: true,
            columns: columns(self.columns.as_deref()),
            certificate: CertificateUse::AsStated,
            ..Hint::default()
        };
        let read = tilescope_formats::read(path, &hint).map_err(with_option);
        Ok(read.in_file(path)?.certificate)
    }

    /// Returns how many sets of a file are chosen: one, or all if no argument chooses.
    pub fn sets(&self, path: &Path) -> Result<usize> {
        // A file that can be read in pieces holds one set.
        if self.set.is_some() || StreamReader::open(path, self.format).is_ok() {
            return Ok(1);
        }
        Ok(self.read_as(path, Some(0), CertificateUse::AsStated)?.sets)
    }

    /// Reads one set of the file, with the given format and columns. Fails if its certificate is false, unless that is left
    /// out.
    pub fn read(&self, path: &Path, set: Option<usize>) -> Result<ReadSet> {
        let varying = false;
        self.read_hinted(path, set, self.checked(), varying)
    }

    /// The same as [`Self::read`], also of sets whose radius varies or that cover a shape.
    pub fn read_varying(&self, path: &Path) -> Result<ReadSet> {
        let varying = true;
        self.read_hinted(path, self.set, self.checked(), varying)
    }

    /// The same as [`Self::read_varying`], without a comparison of the file with its certificate.
    pub fn read_as_stated(&self, path: &Path) -> Result<ReadSet> {
        let varying = true;
        self.read_hinted(path, self.set, CertificateUse::AsStated, varying)
    }

    fn checked(&self) -> CertificateUse {
        if self.no_certificate {
            CertificateUse::LeftOut
        } else {
            CertificateUse::Checked
        }
    }

    /// The same as [`Self::read`], with another use of the certificate.
    pub fn read_as(
        &self,
        path: &Path,
        set: Option<usize>,
        certificate: CertificateUse,
    ) -> Result<ReadSet> {
        let varying = false;
        self.read_hinted(path, set, certificate, varying)
    }

    /// Reads a file with what the arguments say about it. Errors name the option that would help.
    fn read_hinted(
        &self,
        path: &Path,
        set: Option<usize>,
        certificate: CertificateUse,
        varying: bool,
    ) -> Result<ReadSet> {
        self.refuse_origin_z()?;
        let mut hint = Hint {
            format: self.format,
            set,
            columns: columns(self.columns.as_deref()),
            origin: self.origin(),
            certificate,
            varying,
            ..Hint::default()
        };
        let mut read = tilescope_formats::read(path, &hint);

        // A cloud that was thinned by x and y keeps its z, and is a planar set.
        if matches!(read, Err(FormatError::NotPlanar { .. }))
            && self
                .certificate(path)?
                .is_some_and(|stated| is_by_x_and_y(&stated))
        {
            hint.any_z = true;
            read = tilescope_formats::read(path, &hint);
        }
        read.map_err(with_option).in_file(path)
    }
}

/// Returns the names of two columns as they are read by.
pub fn columns(names: Option<&[String]>) -> Option<[&str; 2]> {
    // The parser of arguments takes two names or none, so that no other number gets lost here.
    let names = <&[String; 2]>::try_from(names?).ok()?;
    Some(names.each_ref().map(String::as_str))
}

/// The parameter of a certificate that says that a cloud was thinned by x and y alone.
pub const XY: &str = "xy";

/// Whether a certificate states that points were thinned by their x and y, whatever z is.
pub fn is_by_x_and_y(stated: &Certificate) -> bool {
    stated.parameters.get(XY) == Some(&true.into())
}

/// Adds to the error of a file the option that helps.
fn with_option(error: FormatError) -> anyhow::Error {
    match error {
        // The points may be as wanted all the same, and an option reads them.
        FormatError::FalseCertificate { .. } | FormatError::Certificate { .. } => {
            anyhow!("{error}; {WITHOUT_CERTIFICATE}")
        }
        FormatError::NotPlanar { .. } => anyhow!("{error}; {IN_SPACE}"),
        other => other.into(),
    }
}

/// Adds to the error of a check the options that help.
pub fn hinted(error: CheckError) -> anyhow::Error {
    match error {
        CheckError::Verify(error @ VerifyError::OutOfRegion { .. }) => {
            anyhow!("{error}; {ANOTHER_DOMAIN}")
        }
        error @ CheckError::Beyond { .. } => anyhow!("{error}; {ANOTHER_DOMAIN}"),
        CheckError::Format(error @ FormatError::NotPlanar { .. }) => {
            anyhow!("{error}; {IN_SPACE}")
        }
        CheckError::Format(error @ FormatError::Degrees { .. }) => {
            anyhow!("{error}; --planar takes them as they are")
        }
        other => other.into(),
    }
}

#[cfg(test)]
mod tests;
