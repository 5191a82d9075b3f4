//! How large a window a device can take: its limits and its memory, compared with what a window needs.

use tilescope_core::{Point, R, Rect};

use crate::adapter::{AdapterReport, Limits};
use crate::error::GpuError;
use crate::plan::{MOST_CELLS, Plan};
use crate::setup::Setup;
use crate::sweep::HALO;

/// Memory to use where nobody said how much: WebGPU does not tell what there is. A discrete GPU has more than the
/// first, everything else than the second; where it has not, windows become smaller.
const MEMORY_OF_DISCRETE: u64 = 6 << 30;
const MEMORY_OF_OTHERS: u64 = 1 << 30;

/// The shortest side that is tried, in cells.
const SHORTEST: u32 = 8;

/// Returns the bytes of memory to use.
pub(crate) fn memory_of(report: &AdapterReport, wanted: Option<u64>) -> u64 {
    wanted.unwrap_or(if report.kind == "discrete GPU" {
        MEMORY_OF_DISCRETE
    } else {
        MEMORY_OF_OTHERS
    })
}

/// What a window needs that is more than there is.
struct Excess {
    needed: u64,
    limit: &'static str,
    allowed: u64,
}

/// Returns the longest side of a window, in cells, that the device can take, at most the domain's longer side.
pub(crate) fn longest_side(setup: &Setup, limits: &Limits, memory: u64) -> Result<u32, GpuError> {
    let max = setup.domain.rect().max;
    let whole = (max.x.max(max.y) - 1) as u32 / R as u32 + 1;
    let mut side = whole;
    // From the whole domain down, a quarter at a time: a plan costs what the tree's visit costs.
    loop {
        match excess(setup, side, limits, memory)? {
            None => return Ok(side),
            Some(_) if side > SHORTEST => side = (side * 3 / 4).max(SHORTEST),
            Some(excess) => {
                return Err(GpuError::TooLittleMemory {
                    cells: side,
                    needed: excess.needed,
                    limit: excess.limit,
                    allowed: excess.allowed,
                });
            }
        }
    }
}

/// Returns what a window of so many cells along its sides needs beyond what the device has.
fn excess(
    setup: &Setup,
    side: u32,
    limits: &Limits,
    memory: u64,
) -> Result<Option<Excess>, GpuError> {
    // Before anything is computed that grows with the window.
    let with_halo = u64::from(side) + 2 * HALO as u64;
    let least = |needed: u64, limit: &'static str, allowed: u64| {
        (needed > allowed).then_some(Excess {
            needed,
            limit,
            allowed,
        })
    };
    let domain = setup.domain.rect().max;
    let cells = with_halo * with_halo;
    let square = (u64::from(domain.x.unsigned_abs()) + 2 * 32 * R as u64) / R as u64
        * ((u64::from(domain.y.unsigned_abs()) + 2 * 32 * R as u64) / R as u64);
    if let Some(excess) = least(
        cells.min(square),
        "the engine's number of cells",
        MOST_CELLS,
    ) {
        return Ok(Some(excess));
    }
    // The grid, 16 bytes a cell, is the longest buffer or nearly so.
    let binding = limits.max_storage_buffer_binding_size;
    let grid = 16 * cells.min(square);
    if let Some(excess) = least(grid, "maxStorageBufferBindingSize", binding) {
        return Ok(Some(excess));
    }
    let end = |max: i32| (i64::from(side) * i64::from(R)).min(max.into()) as i32;
    let window = Rect {
        min: Point::new(0, 0),
        max: Point::new(end(domain.x), end(domain.y)),
    };
    let plan = Plan::new(setup, &window, HALO, None)?;
    let lengths = plan.lengths(setup, false);
    let total = plan.peak(setup);
    let longest = lengths.iter().map(|(_, length)| *length).max().unwrap_or(0);
    let longest = longest.max(plan.result_length());
    Ok(least(longest, "maxStorageBufferBindingSize", binding)
        .or_else(|| least(longest, "maxBufferSize", limits.max_buffer_size))
        .or_else(|| least(total, "the memory to be used", memory)))
}
