//! The samplers of sets in space: one set of the unit cube by one of them, for `conformance.py`.

use std::fmt::Write;

use nalgebra as na;
use rand_06::SeedableRng;
use tilescope_core::{Boundary, SolidDomain, Unobserved, solid_sample};

use crate::timed;

/// Writes a set of the unit cube by the sampler of a name, and prints the seconds that it took.
pub fn make(name: &str, radius: &str, seed: &str, file: &str) {
    let radius: f64 = radius.parse().expect("a radius");
    let seed: u64 = seed.parse().expect("a seed");
    let sampler = sampler(name).expect("a known sampler in space");
    let (points, seconds) = timed(|| sampler(radius, seed));

    let mut table = String::from("x,y,z\n");
    for [x, y, z] in points {
        // The shortest text that reads back as the same number.
        writeln!(table, "{x},{y},{z}").expect("a text takes every line");
    }
    std::fs::write(file, table).expect("a file that can be written");
    println!("{seconds}");
}

/// A sampler of the unit cube with a radius and a seed.
type SpaceSampler = fn(f64, u64) -> Vec<[f64; 3]>;

fn sampler(name: &str) -> Option<SpaceSampler> {
    let found: SpaceSampler = match name {
        "tilescope, periodic" => |radius, seed| ours(radius, seed, Boundary::Periodic),
        "tilescope, bounded" => |radius, seed| ours(radius, seed, Boundary::Bounded),
        "fast_poisson" => |radius, seed| {
            fast_poisson::Poisson3D::new()
                .with_dimensions([1.0; 3], radius)
                .with_seed(seed)
                .generate()
        },
        "faster_poisson, dart" => |radius, seed| {
            let seed = Some(seed);
            faster_poisson::PoissonDart3D::new()
                .radius(radius)
                .seed(seed)
                .run()
        },
        "faster_poisson, Bridson" => |radius, seed| {
            let seed = Some(seed);
            faster_poisson::Poisson3D::new()
                .radius(radius)
                .seed(seed)
                .run()
        },
        "poisson_diskus (unseeded)" => {
            |radius, _| poisson_diskus::bridson(&[1.0; 3], radius, 30, true).expect("a set")
        }

        // Its radius is half the smallest distance, in absolute units.
        "poisson, Ebeida" => |radius, seed| {
            let builder = poisson::Builder::<f64, na::Vector3<f64>>::with_radius(
                radius / 2.0,
                poisson::Type::Perioditic,
            );
            let rng = rand_06::rngs::SmallRng::seed_from_u64(seed);
            let generator = builder.build(rng, poisson::algorithm::Ebeida);
            let made = generator.generate();
            made.iter().map(|v| [v.x, v.y, v.z]).collect()
        },
        _ => return None,
    };
    Some(found)
}

fn ours(radius: f64, seed: u64, boundary: Boundary) -> Vec<[f64; 3]> {
    let domain = SolidDomain::from_size([1.0; 3], radius, boundary).expect("a domain");
    let samples = solid_sample(domain, seed, &mut Unobserved).expect("a set");
    domain.users_from_lattice(&samples)
}
