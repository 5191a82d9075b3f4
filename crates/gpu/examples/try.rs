use std::sync::Arc;
use tilescope_core::*;
use tilescope_gpu::*;
fn main() {
    let gpu = Arc::new(pollster::block_on(Gpu::open(&Choice{software:true,..Default::default()})).unwrap());
    println!("{:?}", gpu.report());
    let args: Vec<String> = std::env::args().collect();
    let r: f64 = args.get(1).map_or(0.01, |s| s.parse().unwrap());
    for boundary in [Boundary::Periodic, Boundary::Bounded] { for insertion in [Insertion::Circumcentre, Insertion::Uniform] {
    for order in [Order::OwnBlockFirst, Order::Index, Order::Random, Order::PhaseGroup] {
    let parameters = Parameters { radius: r, boundary, insertion, order, leaf: 12.0, ..Default::default() };
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
    let t = std::time::Instant::now();
    let sweep = pollster::block_on(GpuSweep::new(gpu.clone(), &parameters, &pattern, Options{sources:true,..Default::default()})).unwrap();
    let out = pollster::block_on(sweep.finish(&mut Unobserved));
    let took = t.elapsed();
    let cpu = Sweep::new(&parameters, &pattern, true).unwrap().finish(&mut Unobserved).unwrap();
    match out { Err(e) => println!("{boundary:?} {insertion:?} {order:?} ERROR {e}"),
      Ok(out) => println!("{boundary:?} {insertion:?} {order:?} points {} sources {} summary {} | {} vs {} {:?} {:?} {:?}", out.0.points==cpu.0.points, out.0.sources==cpu.0.sources, out.1==cpu.1, out.0.points.len(), cpu.0.points.len(), took, out.1, cpu.1) }
    }}}
}
