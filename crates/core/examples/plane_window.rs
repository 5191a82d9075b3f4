//! Prints the samples of a window of a plane of some 10^9 as `x,y` lines: `cargo run --release -p tilescope-core --example plane_window --
//! LEFT BOTTOM SIDE`, in radii, 1000 2000 120 if they are not given.

use tilescope_core::{Parameters, Pattern, Plane, SampleError, Unobserved, WindowMaker};

fn main() -> Result<(), SampleError> {
    let numbers: Vec<f64> = std::env::args()
        .filter_map(|word| word.parse().ok())
        .collect();
    let &[left, bottom, side] = numbers
        .as_slice()
        .try_into()
        .unwrap_or(&[1000.0, 2000.0, 120.0]);

    let parameters = Parameters {
        width: 40_000.0,
        height: 40_000.0,
        radius: 1.0,
        seed: 7,
        ..Parameters::default()
    };
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved)?;
    let plane = Plane::new(&parameters, &pattern)?;
    // Only the window and its surroundings are computed.
    let window = plane
        .domain()
        .window([left, bottom], [left + side, bottom + side])?;
    let samples = plane.window(&window)?;

    println!("x,y");
    for [x, y] in plane.domain().users_from_lattice(&samples) {
        println!("{x},{y}");
    }
    Ok(())
}
