//! The native module of the Python package `tilescope`: typed functions over numpy arrays that call the other crates. What
//! Python users see, with its documentation, is in `python/tilescope`.
//!
//! Arrays that come from Python are never written to by anybody: the package makes read-only copies first. So they can be
//! read while Python runs other threads. Everything that may take long runs without Python's lock, in threads of its own,
//! while the calling thread looks for signals (`task`). Structures cross as JSON, whose numbers keep every bit.

#![allow(
    clippy::needless_pass_by_value,
    reason = "Python's arguments are values of the function that they are given to"
)]

mod arguments;
mod arrays;
mod combine;
mod curve;
mod cut;
mod domain;
mod drawing;
mod failure;
mod field_plane;
mod files;
mod ground;
mod image;
mod judge;
mod measure;
mod memory;
mod picture;
mod plane;
mod recorded;
mod sample;
mod solid;
mod space;
mod stipple;
mod task;
mod values;

/// The module, as Python imports it.
#[pyo3::pymodule]
mod _tilescope {
    #[pymodule_export]
    use crate::arguments::{RunRequest, check_domain, prefix};
    #[pymodule_export]
    use crate::combine::combine;
    #[pymodule_export]
    use crate::curve::{curve, curve_field};
    #[pymodule_export]
    use crate::cut::verify_window;
    #[pymodule_export]
    use crate::field_plane::PythonFieldPlane;
    #[pymodule_export]
    use crate::files::{certify, digest, named_by_content, read, save, write_file};
    #[pymodule_export]
    use crate::ground::{Ground, ground_of};
    #[pymodule_export]
    use crate::judge::{check, verify};
    #[pymodule_export]
    use crate::measure::{analyze, pair_correlation, spectrum};
    #[pymodule_export]
    use crate::picture::draw;
    #[pymodule_export]
    use crate::plane::PythonPlane;
    #[pymodule_export]
    use crate::recorded::recorded_numbers;
    #[pymodule_export]
    use crate::sample::{sample, sample_field};
    #[pymodule_export]
    use crate::solid::{
        check_file_in_space, is_in_space, read_file_in_space, sample_solid, save_solid,
        verify_solid,
    };
    #[pymodule_export]
    use crate::space::PythonSpace;
    #[pymodule_export]
    use crate::stipple::{draw_dots, stipple};
    #[pymodule_export]
    use crate::task::set_threads;
}
