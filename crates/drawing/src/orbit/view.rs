//! From where a set in space is seen.

use std::fmt;
use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};
use tilescope_session::words::counted;

/// The greatest elevation, in degrees: straight from above, the vertical edges of the box would be points.
pub const MAX_ELEVATION: f64 = 89.0;
/// The magnifications: from half the size that fits into the picture to a few balls.
pub const ZOOMS: RangeInclusive<f64> = 0.5..=20.0;
/// How many pictures a turn has: one every 5 degrees.
pub const TURN_FRAMES: usize = 72;

/// From where a set in space is seen, and whether it is cut open.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OrbitView {
    /// The direction of the eye in the plane of x and y, from the x axis towards the y axis, in degrees, from 0 to below 360.
    pub azimuth: f64,
    /// How far the eye is above that plane, in degrees.
    pub elevation: f64,
    /// The magnification; at 1 the whole box fits, from whichever side it is seen.
    pub zoom: f64,
    /// Whether the corner nearest to the eye is cut out.
    pub is_cut: bool,
}

impl Default for OrbitView {
    /// Returns a view from the front, to the right and above, in which all three planes of the cut are seen.
    fn default() -> Self {
        Self {
            azimuth: 300.0,
            elevation: 30.0,
            zoom: 1.0,
            is_cut: true,
        }
    }
}

impl OrbitView {
    /// Returns the same view within the limits, with an azimuth from 0 to below 360; numbers that are not finite become those of the
    /// view at first.
    #[must_use]
    pub fn within_limits(self) -> Self {
        let first = Self::default();
        let finite = |value: f64, otherwise: f64| if value.is_finite() { value } else { otherwise };
        Self {
            azimuth: finite(self.azimuth, first.azimuth).rem_euclid(360.0) % 360.0,
            elevation: finite(self.elevation, first.elevation).clamp(-MAX_ELEVATION, MAX_ELEVATION),
            zoom: finite(self.zoom, first.zoom).clamp(*ZOOMS.start(), *ZOOMS.end()),
            is_cut: self.is_cut,
        }
    }

    /// Returns the same view turned by so many degrees to the side and upwards.
    #[must_use]
    pub fn turned(self, [azimuth, elevation]: [f64; 2]) -> Self {
        Self {
            azimuth: self.azimuth + azimuth,
            elevation: self.elevation + elevation,
            ..self
        }
        .within_limits()
    }

    /// Returns the directions to the right, upwards and towards the eye, each of length 1, in the axes of the box.
    pub(super) fn axes(self) -> [[f64; 3]; 3] {
        // The platform's sine would give other last bits on another one.
        let (sin_azimuth, cos_azimuth) = libm::sincos(self.azimuth.to_radians());
        let (sin, cos) = libm::sincos(self.elevation.to_radians());
        [
            [-sin_azimuth, cos_azimuth, 0.0],
            [-sin * cos_azimuth, -sin * sin_azimuth, cos],
            [cos * cos_azimuth, cos * sin_azimuth, sin],
        ]
    }

    /// Returns the octant that is cut out, by a sign for each axis: that of the corner nearest to the eye.
    #[must_use]
    pub fn open(self) -> Option<[f64; 3]> {
        let sign = |along: f64| if along < 0.0 { -1.0 } else { 1.0 };
        let [_, _, eye] = self.axes();
        self.is_cut.then(|| eye.map(sign))
    }

    /// Returns the views of a turn that ends where it began: [`TURN_FRAMES`] of them.
    #[must_use]
    pub fn turn(self) -> impl ExactSizeIterator<Item = Self> {
        let step = 360.0 / TURN_FRAMES as f64;
        (0..TURN_FRAMES).map(move |frame| self.turned([step * frame as f64, 0.0]))
    }

    /// Returns "30 degrees above", for a sentence.
    #[must_use]
    pub fn height_text(self) -> String {
        // Whole, and at most 89.
        let degrees = self.elevation.abs().round() as usize;
        let angle = counted(degrees, "degree", "degrees");
        match self.elevation {
            _ if degrees == 0 => "the side".to_owned(),
            elevation if elevation > 0.0 => format!("{angle} above"),
            _ => format!("{angle} below"),
        }
    }

    /// Reads a view as [`fmt::Display`] writes it; the magnification and the cut may be left out. `None` for a text
    /// that is not written so, and for numbers that are not finite.
    #[must_use]
    pub fn read(text: &str) -> Option<Self> {
        let mut parts = text.split(',');
        let mut number = || parts.next().map(|part| part.trim().parse::<f64>().ok());
        let (azimuth, elevation) = (number()??, number()??);
        let zoom = number().unwrap_or(Some(1.0))?;
        let is_cut = match parts.next() {
            None => true,
            Some("whole") => false,
            Some(_) => return None,
        };

        let view = Self {
            azimuth,
            elevation,
            zoom,
            is_cut,
        };
        let is_finite = [azimuth, elevation, zoom]
            .iter()
            .all(|value| value.is_finite());
        (is_finite && parts.next().is_none()).then(|| view.within_limits())
    }
}

/// Azimuth, elevation and magnification, and "whole" if nothing is cut out.
impl fmt::Display for OrbitView {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A tenth of a degree and a hundredth of the magnification are less than a pixel of most pictures.
        let rounded = |value: f64, parts: f64| (value * parts).round() / parts;
        let [azimuth, elevation] = [self.azimuth, self.elevation].map(|angle| rounded(angle, 10.0));
        write!(f, "{azimuth},{elevation},{}", rounded(self.zoom, 100.0))?;
        if self.is_cut {
            Ok(())
        } else {
            f.write_str(",whole")
        }
    }
}
