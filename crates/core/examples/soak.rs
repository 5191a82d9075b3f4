//! x
use std::sync::Arc;
use tilescope_core::*;
fn main() {
    let n: u32 = std::env::args().nth(1).unwrap().parse().unwrap();
    let first: u32 = std::env::args().nth(2).map_or(0, |s| s.parse().unwrap());
    let mut total = 0u64;
    for k in first..first + n {
        let key = Key::from_seed(0xabcdef + k as u64);
        let d = |i: u32| key.draw(Stream::Dart, i)[0] as f64 / 4294967296.0;
        let pick = |i: u32, n: u32| below(key.draw(Stream::Dart, i)[0], n);
        let boundary = if pick(0, 2) == 0 {
            Boundary::Periodic
        } else {
            Boundary::Bounded
        };
        let w = if pick(1, 3) == 0 {
            10.0 + d(2) * 20.0
        } else {
            10.0 + d(2) * 300.0
        };
        let h = if pick(3, 3) == 0 {
            10.0 + d(4) * 20.0
        } else {
            10.0 + d(4) * 300.0
        };
        let leaf = 6.0 + d(5) * d(6) * 60.0;
        let pb = if pick(7, 5) == 0 {
            Boundary::Bounded
        } else {
            Boundary::Periodic
        };
        let pside = if pb == Boundary::Bounded {
            2.0 * leaf + 4.0 + d(8) * 50.0
        } else {
            10.0 + d(8) * 90.0
        };
        let order = [
            Order::Index,
            Order::Random,
            Order::OwnBlockFirst,
            Order::PhaseGroup,
        ][pick(9, 4) as usize];
        let search = if pick(10, 6) == 0 {
            Search::TwoRadii
        } else {
            Search::Complete
        };
        let insertion = if pick(13, 2) == 0 && std::env::args().nth(3).is_some() {
            Insertion::Uniform
        } else {
            Insertion::Circumcentre
        };
        let p = Parameters {
            width: w,
            height: h,
            radius: 1.0,
            boundary,
            seed: k as u64,
            leaf,
            pattern: PatternSpec {
                side: pside,
                boundary: pb,
                seed: k as u64,
            },
            dihedral: pick(11, 2) == 0,
            order,
            search,
            insertion,
            ..Parameters::default()
        };
        let Ok(pattern) = Pattern::generate(&p.pattern, &mut Unobserved) else {
            continue;
        };
        let pattern = Arc::new(pattern);
        let run = match Sequential::new(&p, pattern.clone())
            .unwrap()
            .finish(&mut Unobserved)
        {
            Ok(r) => r,
            Err(e) => {
                println!("{k}: {e}");
                continue;
            }
        };
        let want = run.points();
        let (got, summary) = Sweep::new(&p, &pattern, pick(14, 2) == 0)
            .unwrap()
            .finish(&mut Unobserved)
            .unwrap();
        if let Some(sources) = &got.sources {
            for (s, &id) in sources.iter().zip(&run.result) {
                let w = match run.samples.origins[id as usize] {
                    Origin::Tiled { block, pattern, .. } => Source::Tiled { block, pattern },
                    Origin::Inserted { iteration, .. } => Source::Inserted { iteration },
                };
                assert_eq!(*s, w, "{p:?}");
            }
        }
        let mut w = run.summary();
        while w.inserted.last() == Some(&0) {
            w.inserted.pop();
        }
        if w != summary {
            println!("{k} summary {w:?} {summary:?}");
        }
        let got = got.points;
        let plane = Plane::new(&p, &pattern).unwrap();
        for q in 0..4 {
            let e = |i: u32| key.draw(Stream::Offset, 10 * q + i)[0] as f64 / 4294967296.0;
            let (x, y) = (w2(w0(p.width), e(0)), w2(p.height, e(1)));
            let (ww, hh) = (p.width * e(2) * e(4), p.height * e(3) * e(5));
            let win = match plane.domain().window([x, y], [x + ww, y + hh]) {
                Ok(w) => w,
                Err(_) => continue,
            };
            let gotw = plane.window(&win).unwrap();
            let inside = |p: &&Point| {
                let ax = |v: i32, a: usize| {
                    if plane.domain().is_periodic() {
                        let s = [plane.domain().width(), plane.domain().height()][a] as i64;
                        (v as i64 - win.min[a]).rem_euclid(s) < win.max[a] - win.min[a]
                    } else {
                        (win.min[a]..win.max[a]).contains(&(v as i64))
                    }
                };
                ax(p.x, 0) && ax(p.y, 1)
            };
            let wantw: Vec<Point> = want.iter().filter(inside).copied().collect();
            if wantw != gotw {
                println!(
                    "{k} WINDOW {x} {y} {ww} {hh} {} {}",
                    wantw.len(),
                    gotw.len()
                );
            }
        }
        total += want.len() as u64;
        if want != got {
            let ws: std::collections::HashSet<_> = want.iter().collect();
            let gs: std::collections::HashSet<_> = got.iter().collect();
            println!("{k} DIFFERENT {} {} {p:?}", want.len(), got.len());
            println!(
                "  missing {:?}",
                want.iter()
                    .filter(|p| !gs.contains(p))
                    .take(3)
                    .collect::<Vec<_>>()
            );
            println!(
                "  extra {:?}",
                got.iter()
                    .filter(|p| !ws.contains(p))
                    .take(3)
                    .collect::<Vec<_>>()
            );
        }
    }
    println!("total {total}");
}
fn w0(a: f64) -> f64 {
    a
}
fn w2(side: f64, e: f64) -> f64 {
    (e * 1.4 - 0.2) * side
}
