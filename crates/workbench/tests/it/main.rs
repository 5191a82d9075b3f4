//! The workbench, tested without a window and without a graphics driver.

mod analysis;
mod analysis_brush;
mod combine;
mod combine_refusals;
mod combining;
mod export;
mod export_analysis;
mod export_refusals;
mod exporting;
mod files_in_memory;
mod files_refused;
mod gate;
mod ground;
mod ground_measures;
mod indices;
mod link;
mod live;
mod nested;
mod painting;
mod parts;
mod runs;
mod script;
mod space;
mod space_measures;
mod stipple;
mod tiled_shapes;
