//! x
use std::time::Instant;
use tilescope_core::*;
fn main() {
    let a: Vec<f64> = std::env::args()
        .skip(1)
        .map(|s| s.parse().unwrap())
        .collect();
    let (n, leaf) = (a[0], a[1]);
    let radius = (0.6985 / n).sqrt();
    let p = Parameters {
        radius,
        leaf,
        ..Parameters::default()
    };
    let sets = InstructionSet::available();
    let set = a
        .get(2)
        .map_or(InstructionSet::best(), |&k| sets[k as usize]);
    println!("{}", set.name());
    let pattern = Pattern::of_spec(&p.pattern, &mut Unobserved).unwrap();
    for _ in 0..5 {
        let t = Instant::now();
        let r = Sweep::new(&p, &pattern, false)
            .unwrap()
            .with_instructions(set)
            .finish(&mut Unobserved)
            .unwrap()
            .0
            .points;
        let s = t.elapsed().as_secs_f64();
        println!(
            "{} samples {:.1} ms {:.2} M/s",
            r.len(),
            s * 1e3,
            r.len() as f64 / s / 1e6
        );
    }
}
