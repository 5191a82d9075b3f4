//! How large a window fits a device: the device's limits and memory compared with what a window needs. Also the halo
//! and the room of every window, and how they grow.

use tilescope_core::{Point, R, Rect, SampleError};

use crate::adapter::{AdapterReport, Limits};
use crate::error::GpuError;
use crate::plan::{MAX_CELLS, MAX_SIDE, Room, WindowPlan};
use crate::setup::Setup;
use crate::window_run::Shortage;

/// Initial width of the halo in cells. Samples rarely depend on others half as far away; where the window depends on
/// samples beyond the halo, it is computed again with twice the halo.
pub(crate) const HALO: i32 = 24;

/// The shortest side of a window, in cells. Chosen, not measured: around one so short, nearly all of the frame is halo.
pub(crate) const MIN_SIDE: u32 = 8;

/// How often a window may need more room before that counts as a fault. Chosen, not measured: a list gets at least the
/// room that it was found to need each time.
pub(crate) const MAX_TRIES: usize = 8;

/// The halo of a window and the room of its lists. Both grow until they suffice.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Allowance {
    /// Width of the halo in cells.
    pub halo: i32,
    /// The room; if `None`, it is estimated.
    pub room: Option<Room>,
    /// How often more room was needed.
    tries: usize,
}

impl Allowance {
    /// Returns a halo with the estimated room.
    pub(crate) const fn new(halo: i32) -> Self {
        Self {
            halo,
            room: None,
            tries: 0,
        }
    }

    /// Makes up for a shortage. Fails when the halo is `max_halo` cells wide already, and when more room never suffices.
    pub(crate) fn grow(&mut self, shortage: Shortage, max_halo: i32) -> Result<(), GpuError> {
        match shortage {
            Shortage::Halo if self.halo >= max_halo => {
                // A cell is r wide.
                let radii = f64::from(self.halo);
                return Err(SampleError::Entangled { radii }.into());
            }
            // The room is estimated anew, as a wider frame needs more of everything.
            Shortage::Halo => (self.halo, self.room) = (2 * self.halo, None),
            Shortage::Room(_) if self.tries == MAX_TRIES => return Err(GpuError::OutOfMemory),
            Shortage::Room(room) => {
                self.tries += 1;
                self.room = Some(room);
            }
        }
        Ok(())
    }
}

/// Bytes of memory to use if the caller sets no limit, since WebGPU does not report how much there is. Nearly all
/// discrete GPUs have more than the first, other devices more than the second. Where memory runs out, windows become
/// smaller.
const MEMORY_OF_DISCRETE: u64 = 6 << 30;
const MEMORY_OF_OTHERS: u64 = 1 << 30;

/// Returns the bytes of memory to use.
pub(crate) fn memory_of(report: &AdapterReport, wanted: Option<u64>) -> u64 {
    wanted.unwrap_or(if report.kind == "discrete GPU" {
        MEMORY_OF_DISCRETE
    } else {
        MEMORY_OF_OTHERS
    })
}

/// Returns the plan of a window that the device can take.
///
/// Fails with [`GpuError::TooLittleMemory`] if it does not fit.
pub(crate) fn plan(
    setup: &Setup,
    window: &Rect,
    Allowance { halo, room, .. }: Allowance,
    limits: &Limits,
    memory: u64,
) -> Result<WindowPlan, GpuError> {
    let cells = |low: i32, high: i32| ((high - 1) / R - low / R + 1) as u64;
    let width = cells(window.min.x, window.max.x);
    let height = cells(window.min.y, window.max.y);
    let longer = width.max(height);

    let check = |needed: u64, limit: &'static str, allowed: u64| {
        if needed <= allowed {
            return Ok(());
        }
        Err(GpuError::TooLittleMemory {
            cells: longer as u32,
            needed,
            limit,
            allowed,
        })
    };

    // The first checks come before the plan: the plan of a window that is far too large would itself take much memory.
    // The grid takes 16 bytes a cell, and numbers of cells are compared as bytes, since the error states bytes.
    let (cell_bytes, around) = (16, 2 * halo as u64);
    let binding = limits.max_storage_buffer_binding_size;
    // A side is counted as in a periodic domain. The frame of a bounded one may end sooner, so that this check may refuse
    // a window whose frame would just fit.
    check(
        cell_bytes * (longer + around),
        "a side of the engine's frames",
        cell_bytes * MAX_SIDE,
    )?;

    let max = setup.domain.rect().max;
    let frame_side = |side: u64, domain: i32| {
        if setup.domain.is_periodic() {
            side + around
        } else {
            // The frame of a bounded domain ends where the domain does.
            (side + around).min(cells(0, domain))
        }
    };
    let frame_cells = frame_side(width, max.x) * frame_side(height, max.y);
    let frame_bytes = cell_bytes * frame_cells;
    check(frame_bytes, "the engine's frames", cell_bytes * MAX_CELLS)?;
    check(frame_bytes, "maxStorageBufferBindingSize", binding)?;

    let plan = WindowPlan::new(setup, window, halo, room)?;
    // Only a run that is stepped through in one go keeps what each stage left, and it is not planned here.
    let keeps_stages = false;
    let lengths = plan.lengths(setup, keeps_stages);
    let longest = lengths.iter().map(|(_, length)| *length).max().unwrap_or(0);
    check(longest, "maxStorageBufferBindingSize", binding)?;
    check(longest, "maxBufferSize", limits.max_buffer_size)?;
    check(plan.peak(setup), "the memory to be used", memory)?;
    Ok(plan)
}

/// Returns the side, in cells, of the largest of the windows tried that fits the device. The first has the whole domain. No
/// side is shorter than [`MIN_SIDE`].
pub(crate) fn longest_side(setup: &Setup, limits: &Limits, memory: u64) -> Result<u32, GpuError> {
    let max = setup.domain.rect().max;
    let [columns, rows] = setup.cells();
    let whole = columns.max(rows);

    // The domain is cut into equal parts along each side, more and more of them. Few numbers are tried, since each plan
    // visits the whole tree of blocks.
    let mut parts = 1;
    loop {
        let side = whole.div_ceil(parts).max(MIN_SIDE);
        let length = |domain: i32| (i64::from(side) * i64::from(R)).min(domain.into()) as i32;
        // The part lies in the middle, where a bounded domain has room for a halo on all sides. It begins with a cell.
        let low = |domain: i32| (domain - length(domain)) / 2 / R * R;

        let window = Rect {
            min: Point::new(low(max.x), low(max.y)),
            max: Point::new(low(max.x) + length(max.x), low(max.y) + length(max.y)),
        };

        // A window must fit with twice the usual halo, as the halo may have to be doubled.
        match plan(setup, &window, Allowance::new(2 * HALO), limits, memory) {
            Ok(_) => return Ok(side),
            Err(GpuError::TooLittleMemory { .. }) if side > MIN_SIDE => {
                // A third more parts each time, so that few are tried, but at least one more.
                parts = (parts + 1).max(parts * 4 / 3);
            }
            Err(error) => return Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tilescope_core::{Parameters, Pattern, Unobserved};

    const ROOMY: Limits = Limits {
        max_buffer_size: u64::MAX,
        max_storage_buffer_binding_size: u64::MAX,
        max_compute_workgroups_per_dimension: u32::MAX,
        max_storage_buffers_per_shader_stage: u32::MAX,
    };

    fn setup(width: f64, height: f64) -> Setup {
        let parameters = Parameters {
            width,
            height,
            radius: 1.0,
            ..Parameters::default()
        };
        let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
        Setup::new(&parameters, &pattern, false).unwrap()
    }

    #[test]
    fn frames_stay_within_32_bits() {
        let setup = setup(65_532.0, 10.0);
        let side = longest_side(&setup, &ROOMY, u64::MAX).unwrap();
        assert!((30_000..65_000).contains(&side), "{side}");
        let whole = setup.domain.rect();
        let refused = plan(&setup, &whole, Allowance::new(HALO), &ROOMY, u64::MAX);
        assert!(matches!(
            refused,
            Err(GpuError::TooLittleMemory { cells: 65_532, .. })
        ));
    }

    /// A binding is at most 2^31 - 1 bytes long, and the grid takes 16 bytes a cell.
    #[test]
    fn up_to_92_million_samples_go_in_one_window_and_more_in_four() {
        let limits = Limits {
            max_storage_buffer_binding_size: (1 << 31) - 1,
            ..ROOMY
        };
        for (samples, windows) in [(92e6, 1), (94e6, 4), (3e8, 4)] {
            let side = f64::floor((samples / 0.7_f64).sqrt());
            let setup = setup(side, side);
            let most = longest_side(&setup, &limits, u64::MAX).unwrap();
            let along = (side / f64::from(most)).ceil() as u32;
            assert_eq!(along * along, windows, "{samples} samples");
        }
    }

    #[test]
    fn every_limit_makes_windows_smaller() {
        let setup = setup(300.0, 200.0);
        let side = |limits: &Limits, memory| longest_side(&setup, limits, memory).unwrap();
        assert_eq!(side(&ROOMY, u64::MAX), 300);
        let binding = Limits {
            max_storage_buffer_binding_size: 1_000_000,
            ..ROOMY
        };
        let buffer = Limits {
            max_buffer_size: 1_000_000,
            ..ROOMY
        };
        assert!(side(&binding, u64::MAX) < 200);
        assert!(side(&buffer, u64::MAX) < 200);
        assert!(side(&ROOMY, 2_500_000) < 200);
    }
}
