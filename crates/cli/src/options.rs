//! Arguments that several commands share: what a point set is, where its file does not say.

use std::path::Path;

use anyhow::{Context, Result};
use clap::{Args, ValueEnum};
use tilescope_analysis::{Boundary, Region};
use tilescope_formats::{Format, Hint, Overrides, StreamReader};

/// How the domain ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BoundaryArgument {
    /// Opposite sides are joined
    Periodic,
    /// The border is closed and must be covered
    Bounded,
}

impl From<BoundaryArgument> for tilescope_core::Boundary {
    fn from(argument: BoundaryArgument) -> Self {
        match argument {
            BoundaryArgument::Periodic => Self::Periodic,
            BoundaryArgument::Bounded => Self::Bounded,
        }
    }
}

impl From<BoundaryArgument> for Boundary {
    fn from(argument: BoundaryArgument) -> Self {
        match argument {
            BoundaryArgument::Periodic => Self::Periodic,
            BoundaryArgument::Bounded => Self::Bounded,
        }
    }
}

/// Returns the verifier's region of a run's domain.
pub fn region(domain: &tilescope_core::Domain) -> Region {
    let [width, height] = domain.size();
    Region {
        width,
        height,
        boundary: judged(domain.boundary()),
    }
}

/// Returns the verifier's name of a run's boundary.
pub const fn judged(boundary: tilescope_core::Boundary) -> Boundary {
    match boundary {
        tilescope_core::Boundary::Periodic => Boundary::Periodic,
        tilescope_core::Boundary::Bounded => Boundary::Bounded,
    }
}

/// What a file's certificate would say, given by hand.
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
    #[arg(long, value_enum)]
    pub boundary: Option<BoundaryArgument>,
    /// Format of the input, where neither extension nor content tell
    #[arg(long, value_name = "FORMAT")]
    pub format: Option<Format>,
}

impl SetArguments {
    /// Returns what overrides the certificate of `path`. A side or boundary that is not given is
    /// the certificate's; without one, the periodic unit square's.
    pub fn overrides(&self, path: &Path) -> Result<Overrides> {
        let given = self.width.is_some() || self.height.is_some() || self.boundary.is_some();
        let region = if given {
            Some(self.region(path)?)
        } else {
            None
        };
        Ok(Overrides {
            format: self.format,
            region,
            radius: self.radius,
            ..Overrides::default()
        })
    }

    fn region(&self, path: &Path) -> Result<Region> {
        let complete = self.width.is_some() && self.height.is_some() && self.boundary.is_some();
        let stated = if complete {
            None
        } else {
            self.stated_region(path)?
        };
        let base = stated.unwrap_or(UNIT_SQUARE);
        Ok(Region {
            width: self.width.unwrap_or(base.width),
            height: self.height.unwrap_or(base.height),
            boundary: self.boundary.map_or(base.boundary, Into::into),
        })
    }

    /// Returns the region of the certificate of `path`, without its points where that is possible.
    fn stated_region(&self, path: &Path) -> Result<Option<Region>> {
        if let Ok(reader) = StreamReader::open(path, self.format) {
            return Ok(reader.certificate().map(|stated| stated.region));
        }
        Ok(self.read(path)?.certificate.map(|stated| stated.region))
    }

    /// Reads the file with the given format.
    pub fn read(&self, path: &Path) -> Result<tilescope_formats::ReadSet> {
        let hint = Hint {
            format: self.format,
            ..Hint::default()
        };
        tilescope_formats::read(path, &hint).with_context(|| path.display().to_string())
    }
}

/// The domain of a set that says nothing of its own.
pub const UNIT_SQUARE: Region = Region {
    width: 1.0,
    height: 1.0,
    boundary: Boundary::Periodic,
};
