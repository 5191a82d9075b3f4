//! A plane as it is handed over: by either method, with the buffers of its windows.

use std::mem::MaybeUninit;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tilescope_core::memory::{Making, ask_for};
use tilescope_core::{
    Domain, ExactPlane, MAX_SEQUENTIAL_SAMPLES, MAXIMAL_DENSITY, Parameters, Pattern,
    PatternHistory, PlaceBuffers, Plane, R, SampleError, TilingMethod, Unobserved, Window,
    WindowMaker,
};

use crate::status::Failure;

/// The period in radii where none is given. It leaves a little to the longest that a domain may have, 65,532 r, so that
/// no rounding of the product refuses it.
const USUAL_PERIOD: f64 = 65_000.0;

/// What a plane is made from, as C has it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TilescopeSettings {
    /// The seed of every draw.
    pub seed: u64,
    /// The radius in user units.
    pub radius: f64,
    /// The side of the square that repeats, in user units; 0 for 65,000 radii.
    pub period: f64,
    /// The shortest edge of a block in radii; 0 for the usual one.
    pub leaf: f64,
    /// 0 for KDRT, 1 for exact tiling.
    pub method: i32,
}

/// A sample's position in user units.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TilescopePoint {
    /// Along the width.
    pub x: f64,
    /// Along the height.
    pub y: f64,
}

impl Default for TilescopeSettings {
    fn default() -> Self {
        Self {
            seed: 1,
            radius: 1.0,
            period: 0.0,
            leaf: 0.0,
            method: 0,
        }
    }
}

impl TilescopeSettings {
    /// Returns the parameters of the run whose windows the plane has. Fails for an unknown method, and for a period
    /// that is negative or no number. The caller checks the other values.
    pub(crate) fn parameters(&self) -> Result<Parameters, Failure> {
        let method = match self.method {
            0 => TilingMethod::Kdrt,
            1 => TilingMethod::Exact,
            method => return Err(Failure::Method { method }),
        };

        let period = self.period;
        if period.is_nan() || period < 0.0 {
            return Err(Failure::Period { period });
        }

        let usual = Parameters::default();
        // A value of 0 stands for the usual one, so that a struct of zeros needs a radius alone.
        let given_or = |value: f64, usual: f64| if value == 0.0 { usual } else { value };
        let side = given_or(period, USUAL_PERIOD * self.radius);
        let mut parameters = Parameters {
            width: side,
            height: side,
            radius: self.radius,
            seed: self.seed,
            leaf: given_or(self.leaf, usual.leaf),
            method,
            ..usual
        };

        // Exact tilings have larger patterns.
        parameters.pattern = parameters.usual_pattern();
        Ok(parameters)
    }
}

/// A plane of exact tiling, with the history that it borrows.
struct ExactWindows {
    // The plane stands first: fields are dropped in the order in which they stand, and it borrows from the next one.
    plane: ExactPlane<'static>,
    _history: Arc<PatternHistory>,
}

impl ExactWindows {
    /// Makes the history of the pattern, and the plane that reads it.
    fn new(parameters: &Parameters) -> Result<Self, SampleError> {
        let history = Arc::new(PatternHistory::of_spec(
            &parameters.pattern,
            &mut Unobserved,
        )?);

        #[expect(unsafe_code, reason = "the argument is at the head of this crate")]
        // SAFETY: the history lies in the Arc's allocation, which stays where it is until the last Arc is dropped. No
        // code changes it: an Arc gives shared references alone. The reference does not leave this struct, whose fields
        // are private and which drops the plane first.
        let borrowed: &'static PatternHistory = unsafe { &*Arc::as_ptr(&history) };

        Ok(Self {
            plane: ExactPlane::new(parameters, borrowed)?,
            _history: history,
        })
    }
}

enum Windows {
    Kdrt(Box<Plane>),
    Exact(Box<ExactWindows>),
}

/// A request to a plane.
pub(crate) enum Asked {
    /// The samples in a window.
    Whole(Window),
    /// The samples in `to` that are not in `from`.
    Gained { from: Window, to: Window },
}

/// A plane, as C holds it.
pub struct TilescopePlane {
    windows: Windows,
    /// Buffers that no call uses at the moment. There is one for each call of those that were in progress at once.
    idle: Mutex<Vec<PlaceBuffers>>,
}

impl TilescopePlane {
    /// Makes the plane of some settings. Fails if they are out of range.
    pub(crate) fn new(settings: &TilescopeSettings) -> Result<Self, Failure> {
        let parameters = settings.parameters()?;
        parameters.validate()?;

        let windows = match parameters.method {
            TilingMethod::Kdrt => {
                let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved)?;
                Windows::Kdrt(Box::new(Plane::new(&parameters, &pattern)?))
            }
            TilingMethod::Exact => Windows::Exact(Box::new(ExactWindows::new(&parameters)?)),
        };

        Ok(Self {
            windows,
            idle: Mutex::default(),
        })
    }

    pub(crate) fn domain(&self) -> &Domain {
        match &self.windows {
            Windows::Kdrt(plane) => plane.domain(),
            Windows::Exact(exact) => exact.plane.domain(),
        }
    }

    /// Writes the number of the samples that are asked for to `count`, and the samples to `points`. If they do not all
    /// fit, it writes none of them and fails. For a window of too many samples, or with too little memory, it fails
    /// before it writes a number.
    pub(crate) fn write(
        &self,
        asked: &Asked,
        points: &mut [MaybeUninit<TilescopePoint>],
        count: &mut usize,
    ) -> Result<(), Failure> {
        // A window gains at most all of its samples.
        let (Asked::Whole(window) | Asked::Gained { to: window, .. }) = asked;
        self.check_size(window)?;

        let mut buffers = self.take_buffers();
        let places = match (&self.windows, asked) {
            (Windows::Kdrt(plane), Asked::Whole(window)) => plane.places(window, &mut buffers),
            (Windows::Kdrt(plane), Asked::Gained { from, to }) => {
                plane.gained(from, to, &mut buffers)
            }
            (Windows::Exact(exact), Asked::Whole(window)) => {
                exact.plane.places(window, &mut buffers)
            }
            (Windows::Exact(exact), Asked::Gained { from, to }) => {
                exact.plane.gained(from, to, &mut buffers)
            }
        }?;

        let (found, capacity) = (places.len(), points.len());
        *count = found;
        if found <= capacity {
            let positions = self.domain().users_from_plane(places);
            for (point, [x, y]) in points.iter_mut().zip(positions) {
                point.write(TilescopePoint { x, y });
            }
        }

        self.idle().push(buffers);
        if found > capacity {
            return Err(Failure::TooSmall { found, capacity });
        }
        Ok(())
    }

    /// Refuses a window of too many samples, and one for which there is no memory: an allocation that fails would end
    /// the caller's program.
    fn check_size(&self, window: &Window) -> Result<(), Failure> {
        let [width, height] = sides(window);
        let expected = width * height * MAXIMAL_DENSITY;
        let most = MAX_SEQUENTIAL_SAMPLES;
        if expected > most {
            return Err(Failure::TooMany { expected, most });
        }

        let making = match self.windows {
            Windows::Kdrt(_) => Making::Sweep,
            Windows::Exact(_) => Making::Exact,
        };
        Ok(ask_for(expected, making.bytes_a_sample())?)
    }

    fn take_buffers(&self) -> PlaceBuffers {
        self.idle().pop().unwrap_or_default()
    }

    fn idle(&self) -> MutexGuard<'_, Vec<PlaceBuffers>> {
        // A list of buffers is whole after every step, so that a panic of another thread has left it usable.
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns the most samples that a window can have: N points of a convex region with area A and perimeter P, no two
/// closer than 1, are at most 2 A / sqrt(3) + P / 2 + 1 (Groemer 1960).
pub(crate) fn capacity(window: &Window) -> usize {
    let [width, height] = sides(window);
    let most = 2.0 / 3_f64.sqrt() * width * height + width + height + 1.0;
    // One more than the sum, whose roundings are far below 1.
    most as usize + 1
}

/// Returns the sides of a window in radii.
fn sides(window: &Window) -> [f64; 2] {
    let sides = (window.max - window.min).as_dvec2() / f64::from(R);
    sides.to_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_of_zeros_need_a_radius_alone() {
        let zeros = TilescopeSettings {
            seed: 0,
            radius: 2.5,
            period: 0.0,
            leaf: 0.0,
            method: 0,
        };
        let parameters = zeros.parameters().unwrap();
        assert!(parameters.validate().is_ok());
        let said = [parameters.width / parameters.radius, parameters.leaf];
        let usual = [USUAL_PERIOD, Parameters::default().leaf];
        assert_eq!(said.map(f64::to_bits), usual.map(f64::to_bits));
    }

    #[test]
    fn bad_settings_are_refused_with_value_and_limit() {
        let refused = |settings: TilescopeSettings| {
            let failed = TilescopePlane::new(&settings).err();
            failed.expect("bad settings").to_string()
        };
        let usual = TilescopeSettings::default();
        let radius = -3.0;
        assert!(refused(TilescopeSettings { radius, ..usual }).contains("radius is -3"));
        let period = f64::NAN;
        assert!(refused(TilescopeSettings { period, ..usual }).contains("NaN"));
        let period = 9.0;
        assert!(refused(TilescopeSettings { period, ..usual }).contains("10"));
        let leaf = 5.0;
        assert!(refused(TilescopeSettings { leaf, ..usual }).contains("at least 6 r"));
        let method = 7;
        assert!(refused(TilescopeSettings { method, ..usual }).contains("method is 7"));
    }
}
