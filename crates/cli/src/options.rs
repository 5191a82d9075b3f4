//! Arguments of several commands: the domain, radius and format of a set, and values given by name.

use std::path::Path;

use anyhow::{Result, anyhow};
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use serde::de::DeserializeOwned;
use tilescope_analysis::{Boundary, JudgeChoice, Region, VerifyOptions};
use tilescope_formats::{
    Certificate, CertificateUse, CheckError, Format, FormatError, Hint, Overrides, ReadSet,
    StreamReader,
};

use crate::paths::InFile;

/// The names of a type's values, the same in options and in JSON, each with its line of `--help`, if any.
pub type Names<const N: usize> = [(&'static str, &'static str); N];

/// The names of boundaries.
pub const BOUNDARIES: Names<2> = [
    ("periodic", "Opposite sides are joined"),
    ("bounded", "The border is closed and must be covered"),
];

/// The names of number types.
pub const PRECISIONS: Names<2> = [("f32", ""), ("f64", "")];

/// The names of judges.
const JUDGES: Names<3> = [
    ("delaunay", "Delaunay triangulation"),
    ("circles", "Covered circles, several times faster"),
    ("both", "Both, which must agree"),
];

/// The judges of a set.
#[derive(Clone, Debug, Args)]
pub struct JudgeArguments {
    /// The judge that verifies; if not given, both for up to 1,048,576 samples and covered circles for more
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
    let values = names.iter().map(|(name, help)| match *help {
        "" => PossibleValue::new(*name),
        help => PossibleValue::new(*name).help(help),
    });
    PossibleValuesParser::new(values)
        .try_map(|name| serde_json::from_value::<T>(serde_json::Value::String(name)))
}

/// Returns the verifier's region of a run's domain.
pub fn region(domain: &tilescope_core::Domain) -> Region {
    Region::new(domain.size(), domain.is_periodic())
}

/// Options that stand in for, or override, a set's certificate.
#[derive(Debug, Args)]
pub struct SetArguments {
    /// Poisson-disk radius
    #[arg(long, value_name = "R")]
    pub radius: Option<f64>,
    /// Width of the domain
    #[arg(long, value_name = "W")]
    pub width: Option<f64>,
    /// Height of the domain
    #[arg(long, value_name = "H")]
    pub height: Option<f64>,
    /// How the domain ends
    #[arg(long, value_parser = named::<Boundary>(&BOUNDARIES))]
    pub boundary: Option<Boundary>,
    /// Format of the input, if neither its extension nor its content names one
    #[arg(long, value_name = "FORMAT")]
    pub format: Option<Format>,
    /// Leave the certificate out, which may be false: the set is then taken for one of unknown origin
    #[arg(long)]
    pub no_certificate: bool,
}

/// What a false certificate leaves to do.
pub const WITHOUT_CERTIFICATE: &str = "--no-certificate reads the set without it";

impl SetArguments {
    /// Returns the values that override the certificate of `path`. A side or boundary that is not given is
    /// the certificate's; without one, the periodic unit square's.
    pub fn overrides(&self, path: &Path) -> Result<Overrides> {
        let given = [
            self.width.is_some(),
            self.height.is_some(),
            self.boundary.is_some(),
        ];
        let mut stated = None;
        if given.contains(&true) && given.contains(&false) {
            stated = self.certificate(path)?.map(|stated| stated.region);
        }
        let region = || self.region_over(stated.unwrap_or(Region::UNIT_SQUARE));
        Ok(Overrides {
            format: self.format,
            region: given.contains(&true).then(region),
            radius: self.radius,
            without_certificate: self.no_certificate,
            ..Overrides::default()
        })
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
        match StreamReader::open(path, self.format) {
            Ok(reader) => Ok(reader.certificate().cloned()),
            Err(_) => Ok(self.read_as(path, CertificateUse::AsStated)?.certificate),
        }
    }

    /// Reads the file with the given format. Fails if its certificate is false, unless that is left out.
    pub fn read(&self, path: &Path) -> Result<ReadSet> {
        let certificate = if self.no_certificate {
            CertificateUse::LeftOut
        } else {
            CertificateUse::Checked
        };
        self.read_as(path, certificate)
    }

    fn read_as(&self, path: &Path, certificate: CertificateUse) -> Result<ReadSet> {
        let hint = Hint {
            format: self.format,
            certificate,
            ..Hint::default()
        };
        let read = tilescope_formats::read(path, &hint);
        let read = read.map_err(|error| match error {
            FormatError::FalseCertificate { .. } | FormatError::Certificate { .. } => {
                anyhow!("{error}; {WITHOUT_CERTIFICATE}")
            }
            other => other.into(),
        });
        read.in_file(path)
    }
}

/// Checks a set with `overrides`; if no region is known, with that of the periodic unit square.
pub fn check_or_unit_square<T>(
    overrides: &Overrides,
    check: impl Fn(&Overrides) -> Result<T, CheckError>,
) -> Result<T, CheckError> {
    match check(overrides) {
        Err(CheckError::NoRegion(_)) => check(&Overrides {
            region: Some(Region::UNIT_SQUARE),
            ..overrides.clone()
        }),
        outcome => outcome,
    }
}
