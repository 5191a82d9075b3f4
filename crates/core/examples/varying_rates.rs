//! Sets whose radius varies beside the reference sampler of one radius, in turn, on one thread and on all.
//!
//!     cargo run --release -p tilescope-core --example varying_rates -- [FIELD] [SIDE] [ROUNDS]
//!
//! FIELD is `all`, or one of `constant`, `waves` (a contrast of 1:16), `steps` and `noise` for that alone, of which a profiler
//! counts instructions; `reference` is the reference sampler alone. `waves-window` and so on are windows of those sets, half as wide
//! and in the middle. SIDE is the domain's side in units of the smallest radius (default 1024), ROUNDS how often all sets are
//! made (default 3): the shortest times count.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use rayon::ThreadPoolBuilder;
use tilescope_core::{
    Boundary, Domain, Key, Point, R, RadiusField, Shape, Stream, Unobserved, reference_sample,
    varying_sample, varying_window,
};

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

const NAMES: [&str; 4] = ["constant", "waves", "steps", "noise"];

fn main() -> Outcome<()> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "all".to_owned());
    let mut number = |default: i32| arguments.next().map_or(Ok(default), |text| text.parse());
    let (side, rounds) = (number(1024)?, number(3)?);

    let domain = Domain::from_size([f64::from(side); 2], 1.0, Boundary::Periodic)?;
    if name == "reference" {
        let samples = reference_sample(domain, 1, &mut Unobserved)?;
        println!("{name}: {} samples", black_box(samples).len());
        return Ok(());
    }
    if let Some(name) = name.strip_suffix("-window") {
        let (low, high) = (f64::from(side) * 0.25, f64::from(side) * 0.75);
        let window = domain.window([low; 2], [high; 2])?;
        let (field, shape) = (field(name, domain)?, Shape::rectangle());
        let found = black_box(varying_window(&field, &shape, 1, &window, &mut Unobserved)?);
        println!(
            "{name}: {} samples, {} cells",
            found.inside.len(),
            found.cells
        );
        return Ok(());
    }
    if name != "all" {
        let field = field(&name, domain)?;
        let samples = made(&field)?;
        println!("{name}: {} samples", samples.len());
        return Ok(());
    }

    let fields: Vec<RadiusField> = NAMES
        .iter()
        .map(|name| field(name, domain))
        .collect::<Result<_, _>>()?;
    compare(&fields, domain, rounds)
}

/// Makes all sets in turn, and prints rates by the shortest times.
fn compare(fields: &[RadiusField], domain: Domain, rounds: i32) -> Outcome<()> {
    let single = ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut constant = (0, f64::MAX);
    let mut best = vec![(0, [f64::MAX; 2]); fields.len()];

    for _ in 0..rounds.max(1) {
        let began = Instant::now();
        let count = reference_sample(domain, 1, &mut Unobserved)?.len();
        constant = (count, constant.1.min(began.elapsed().as_secs_f64()));

        for (field, (count, times)) in fields.iter().zip(&mut best) {
            let began = Instant::now();
            let alone = single.install(|| made(field))?;
            times[0] = times[0].min(began.elapsed().as_secs_f64());

            let began = Instant::now();
            let together = made(field)?;
            times[1] = times[1].min(began.elapsed().as_secs_f64());
            if alone != together {
                return Err("the number of threads changed the set".into());
            }
            *count = alone.len();
        }
    }

    let rate = |count: usize, seconds: f64| count as f64 / seconds / 1e6;
    let reference = rate(constant.0, constant.1);
    println!(
        "reference sampler: {} samples, {reference:.3} million a second",
        constant.0
    );
    for (name, (count, [alone, together])) in NAMES.iter().zip(best) {
        println!(
            "{name}: {count} samples, {:.3} million a second on one thread, {:.3} on {} ({:.2} times)",
            rate(count, alone),
            rate(count, together),
            rayon::current_num_threads(),
            alone / together
        );
    }
    Ok(())
}

fn made(field: &RadiusField) -> Outcome<Vec<Point>> {
    let samples = varying_sample(field, &Shape::rectangle(), 1, &mut Unobserved)?;
    Ok(black_box(samples))
}

/// Returns the field of a name: all but the constant one have radii from R to 16 R.
fn field(name: &str, domain: Domain) -> Outcome<RadiusField> {
    if name == "constant" {
        return Ok(RadiusField::constant(domain, R)?);
    }

    // Nodes two of the smallest radii apart; noise has them farther apart, as no place is even otherwise.
    let bits = if name == "noise" { 19 } else { 16 };
    let [columns, rows] = RadiusField::node_counts(&domain, bits)?;
    let node = |index: usize| {
        let (column, row) = (index % columns, index / columns);
        let [x, y] = [column as f64 / columns as f64, row as f64 / rows as f64];
        let share = match name {
            // Most samples are where the radius is small, so that it is changed evenly on the scale of its logarithm.
            "waves" => {
                let turn = std::f64::consts::TAU;
                let wave = 0.5 + 0.25 * (3.0 * turn * x).sin() + 0.25 * (3.0 * turn * y).sin();
                (16_f64.powf(wave) - 1.0) / 15.0
            }
            // Squares of an eighth of the domain, in turn of the smallest and of the largest radius.
            "steps" => f64::from(u8::from(
                ((8.0 * x) as u32 + (8.0 * y) as u32).is_multiple_of(2),
            )),
            _ => f64::from(Key::from_seed(3).draw(Stream::Dart, index as u32)[0]) / 2_f64.powi(32),
        };
        R + (share * f64::from(15 * R)) as i32
    };
    let nodes: Vec<i32> = (0..columns * rows).map(node).collect();
    Ok(RadiusField::from_nodes(domain, bits, &nodes)?)
}
