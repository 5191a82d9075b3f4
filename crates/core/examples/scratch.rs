//! scratch
use std::time::Instant;
use tilescope_core::*;
fn main() {
    for order in [
        Order::Index,
        Order::Random,
        Order::OwnBlockFirst,
        Order::PhaseGroup,
    ] {
        let p = Parameters {
            radius: 1.0,
            width: 300.0,
            height: 300.0,
            leaf: 20.0,
            order,
            ..Parameters::default()
        };
        let run = sample(&p, &mut Unobserved).unwrap();
        let s = run.summary();
        println!(
            "{order:?} {s:?} density {:.4} cand {:?}",
            s.count as f64 / run.domain.area_radii(),
            run.iterations
                .iter()
                .map(|i| (i.detectors.len(), i.candidates.len()))
                .collect::<Vec<_>>()
        );
    }
    for (b, i, v) in [
        (Boundary::Bounded, Insertion::Circumcentre, Variant::Staged),
        (Boundary::Periodic, Insertion::Uniform, Variant::Staged),
        (Boundary::Bounded, Insertion::Uniform, Variant::Staged),
        (
            Boundary::Periodic,
            Insertion::Circumcentre,
            Variant::AsPrinted,
        ),
        (
            Boundary::Bounded,
            Insertion::Circumcentre,
            Variant::AsPrinted,
        ),
    ] {
        let p = Parameters {
            radius: 1.0,
            width: 300.0,
            height: 300.0,
            leaf: 20.0,
            boundary: b,
            insertion: i,
            variant: v,
            ..Parameters::default()
        };
        let t = Instant::now();
        let run = sample(&p, &mut Unobserved).unwrap();
        let mut d = stages::disks::DiskGrid::new(run.domain);
        for p in run.points() {
            assert!(!d.covers(p));
            assert!(d.insert(p));
        }
        println!(
            "{b:?} {i:?} {v:?} {:?} uncovered {:?} {:?} {:?}",
            run.summary(),
            d.uncovered_point(0),
            d.uncovered_point(20000),
            t.elapsed()
        );
    }
    let side = (1e6f64 / 0.6975).sqrt();
    for leaf in [20.0, 40.0, 80.0] {
        let p = Parameters {
            radius: 1.0,
            width: side,
            height: side,
            leaf,
            ..Parameters::default()
        };
        for _ in 0..2 {
            let mut last = Instant::now();
            let t0 = last;
            let mut log = String::new();
            let run = sample(&p, &mut |pr: Progress| {
                if pr.done == pr.total {
                    let n = Instant::now();
                    log += &format!("{} {:.1} ", pr.stage, (n - last).as_secs_f64() * 1e3);
                    last = n;
                }
                std::ops::ControlFlow::Continue(())
            })
            .unwrap();
            let e = t0.elapsed().as_secs_f64();
            println!(
                "leaf {leaf}: {} {:.3} s {:.3} M/s  {log}",
                run.result.len(),
                e,
                run.result.len() as f64 / e / 1e6
            );
        }
    }
    let d = Domain::from_size([side, side], 1.0, Boundary::Periodic).unwrap();
    let t = Instant::now();
    let mut log = String::new();
    let mut last = t;
    let r = reference_sample(d, 5, &mut |pr: Progress| {
        let n = Instant::now();
        log += &format!(
            "{}.{} {:.1} ",
            pr.stage,
            pr.done,
            (n - last).as_secs_f64() * 1e3
        );
        last = n;
        std::ops::ControlFlow::Continue(())
    })
    .unwrap();
    println!(
        "reference {} density {:.4} {:.3} M/s",
        r.len(),
        r.len() as f64 / d.area_radii(),
        r.len() as f64 / t.elapsed().as_secs_f64() / 1e6
    );
    println!("{log}");
}
