//! Grass around a camera that walks over an endless plane, as a game has it: chunks come into view and go out of it, and each is
//! computed alone. Prints for each second how many samples came and went. In bevy, `spawn` would spawn an entity for each sample
//! and `despawn` despawn them, and `World` would be a resource: `cargo run --release -p tilescope-core --example chunks`.

use std::collections::{BTreeMap, BTreeSet};

use tilescope_core::{Parameters, Pattern, Plane, SampleError, Unobserved, WindowMaker};

/// The side of a chunk in radii: some 1,700 samples.
const SIDE: f64 = 50.0;
/// Chunks that are in view to each side of the one with the camera.
const REACH: i32 = 2;

/// The chunks in view, by column and row.
struct World {
    plane: Plane,
    chunks: BTreeMap<[i32; 2], Vec<[f64; 2]>>,
}

impl World {
    /// Lets chunks come and go, and returns how many samples came and how many went.
    fn follow(&mut self, camera: [f64; 2]) -> Result<[usize; 2], SampleError> {
        let [column, row] = camera.map(|at| (at / SIDE).floor() as i32);
        let around = || -REACH..=REACH;
        let wanted: BTreeSet<[i32; 2]> = around()
            .flat_map(|y| around().map(move |x| [column + x, row + y]))
            .collect();

        let gone: Vec<[i32; 2]> = (self.chunks.keys().copied())
            .filter(|chunk| !wanted.contains(chunk))
            .collect();
        let despawned = gone.into_iter().map(|chunk| self.despawn(chunk)).sum();

        let mut spawned = 0;
        for chunk in wanted {
            if !self.chunks.contains_key(&chunk) {
                spawned += self.spawn(chunk)?;
            }
        }
        Ok([spawned, despawned])
    }

    /// Computes a chunk. Neighbours need not be there: their samples fit to these in any order.
    fn spawn(&mut self, chunk: [i32; 2]) -> Result<usize, SampleError> {
        let low = chunk.map(|index| f64::from(index) * SIDE);
        let domain = self.plane.domain();
        let samples = self
            .plane
            .window(&domain.window(low, low.map(|low| low + SIDE))?)?;
        let count = samples.len();
        self.chunks
            .insert(chunk, domain.users_from_lattice(&samples));
        Ok(count)
    }

    fn despawn(&mut self, chunk: [i32; 2]) -> usize {
        self.chunks
            .remove(&chunk)
            .map_or(0, |samples| samples.len())
    }
}

fn main() -> Result<(), SampleError> {
    let parameters = Parameters {
        width: 40_000.0,
        height: 40_000.0,
        radius: 1.0,
        seed: 7,
        ..Parameters::default()
    };
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved)?;
    let mut world = World {
        plane: Plane::new(&parameters, &pattern)?,
        chunks: BTreeMap::new(),
    };

    // Twenty radii a second to the right, and ten upwards.
    for second in 0..20 {
        let camera = [20.0, 10.0].map(|speed| 5000.0 + speed * f64::from(second));
        let [spawned, despawned] = world.follow(camera)?;
        let held: usize = world.chunks.values().map(Vec::len).sum();
        println!("camera at {camera:?}: {spawned} samples came, {despawned} went, {held} in view");
    }
    Ok(())
}
