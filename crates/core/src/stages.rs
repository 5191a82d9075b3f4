//! The stages as functions over plain data, one file each, in the paper's order. Engines call them.

pub mod blocks;
pub(crate) mod cells;
pub mod darts;
pub mod detect;
pub mod disks;
pub mod eliminate;
pub mod insert;
pub mod order;
pub mod tile;
pub mod uniform;
pub(crate) mod voronoi;
