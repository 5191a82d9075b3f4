use std::sync::Arc; use std::time::Instant; use tilescope_core::*;
fn main(){
  let a: Vec<f64> = std::env::args().skip(1).map(|s| s.parse().unwrap()).collect();
  let (n, leaf, side) = (a[0], a[1], a[2] as i32);
  let radius = (0.6985/n).sqrt();
  let p = Parameters{radius, leaf, ..Parameters::default()};
  let pattern = Arc::new(Pattern::generate(&p.pattern, &mut Unobserved).unwrap());
  let plane = Plane::new(&p,&pattern).unwrap();
  for _ in 0..5 { let t=Instant::now(); let r=plane.all(side).unwrap(); let s=t.elapsed().as_secs_f64();
   println!("{} samples {:.1} ms {:.2} M/s retries {}", r.len(), s*1e3, r.len() as f64/s/1e6, RETRIES.load(std::sync::atomic::Ordering::Relaxed)); if a.len()>4 {tilescope_core::laps();} }
  if a.len()>3 { let run=Sequential::new(&p,pattern).unwrap().finish(&mut Unobserved).unwrap(); let want=run.points(); let got=plane.all(side).unwrap();
   println!("equal {}", want==got); }
}
