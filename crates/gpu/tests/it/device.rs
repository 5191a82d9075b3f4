//! Tests that need a graphics driver; a software one will do.

mod arithmetic;
mod exact;
mod faults;
mod row_places;
mod stages;
mod windows;
