//! Counts allocations: a game's frame must not wait for the system's memory.

#![expect(unsafe_code, reason = "an allocator is unsafe by its nature")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use tilescope_c::exports::TilescopeSettings;

use crate::support::{CPlane, buffer, square};

thread_local! {
    /// How often this thread has asked for memory.
    static ASKED: Cell<u64> = const { Cell::new(0) };
}

/// The system's allocator, counting.
struct Counting;

// SAFETY: every call is handed to the system's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ASKED.set(ASKED.get() + 1);
        // SAFETY: the caller's guarantee.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's guarantee.
        unsafe { System.dealloc(pointer, layout) };
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ASKED.set(ASKED.get() + 1);
        // SAFETY: the caller's guarantee.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Returns of the first 500 moves of a window and of 500 more how many ask for memory, and how often they do together.
fn asking(method: i32) -> [(usize, u64); 2] {
    let settings = TilescopeSettings {
        method,
        ..TilescopeSettings::default()
    };
    let plane = CPlane::new(&settings).unwrap();
    let mut from = square(500.2, 300.4, 120.0);
    let mut points = buffer(plane.capacity(&from).unwrap());
    plane.fill(&from, &mut points).unwrap();

    [0, 1].map(|_| {
        let (mut moves, mut all) = (0, 0);
        for step in 0..500 {
            let to = square(from.left + 2.0, from.bottom + f64::from(step % 3), 120.0);
            let before = ASKED.get();
            plane.gain([&from, &to], &mut points).unwrap();
            let asked = ASKED.get() - before;
            moves += usize::from(asked > 0);
            all += asked;
            from = to;
        }
        (moves, all)
    })
}

#[test]
fn moves_ask_for_no_memory_once_buffers_have_grown() {
    // A strip with unsure cells, in one move of nine, is computed again with a wider halo, in buffers that are made when they are
    // first needed, and grow.
    let found = asking(0);
    let [(_, first), later] = found;
    assert!((1..200).contains(&first), "{found:?}");
    assert_eq!(later, (0, 0));

    // The control: exact tiling makes its lists anew, in every move.
    let [_, (moves, _)] = asking(1);
    assert_eq!(moves, 500);
}
