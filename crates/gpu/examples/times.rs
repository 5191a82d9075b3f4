use std::{collections::BTreeMap, sync::Arc};
use tilescope_core::*;
use tilescope_gpu::*;
fn main() {
    let gpu = Arc::new(pollster::block_on(Gpu::open(&Choice{software:true,..Default::default()})).unwrap());
    let args: Vec<String> = std::env::args().collect();
    let radius: f64 = args[1].parse().unwrap(); let leaf: f64 = args[2].parse().unwrap();
    let boundary = if args.len() > 3 { Boundary::Bounded } else { Boundary::Periodic };
    let parameters = Parameters { radius, leaf, boundary, ..Default::default() };
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
    for _ in 0..2 {
    let mut s = pollster::block_on(Stepper::new(gpu.clone(), &parameters, &pattern, Stage::Blocks)).unwrap();
    let t = std::time::Instant::now();
    pollster::block_on(s.finish()).unwrap();
    println!("{:?}", t.elapsed());
    let mut by: BTreeMap<&str, (f64, u32)> = BTreeMap::new();
    for r in s.reports() { let e = by.entry(r.name).or_default(); e.0 += r.seconds.unwrap_or(0.0); e.1 += 1; }
    let mut v: Vec<_> = by.into_iter().collect(); v.sort_by(|a,b| b.1.0.total_cmp(&a.1.0));
    for (n,(s,c)) in v { println!("  {n:14} {:9.3} ms x{c}", s*1e3); }
    }
}
