//! Judges the points on standard input, `x,y` a line: `cargo run --release -p tilescope-analysis --example judge -- WIDTH HEIGHT RADIUS
//! < set.csv`. The domain is periodic.

use std::error::Error;
use std::io::stdin;
use std::ops::ControlFlow;

use tilescope_analysis::{Boundary, Region, VerifyOptions, verify};

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [width, height, radius] = words.as_slice() else {
        return Err("give the width, the height and the radius".into());
    };
    let region = Region {
        width: width.parse()?,
        height: height.parse()?,
        boundary: Boundary::Periodic,
    };

    let mut points = Vec::new();
    for line in stdin().lines() {
        let line = line?;
        let numbers = line
            .split_once(',')
            .map(|(x, y)| (x.trim().parse::<f64>(), y.trim().parse::<f64>()));
        // A line of names may stand first.
        if let Some((Ok(x), Ok(y))) = numbers {
            points.push([x, y]);
        }
    }

    let go_on = |_| ControlFlow::Continue(());
    let report = verify(
        &points,
        region,
        radius.parse()?,
        &VerifyOptions::default(),
        &go_on,
    )?;

    println!(
        "{} points, {} conflicts, {} gaps",
        report.count, report.conflicts, report.gaps
    );
    println!("smallest distance {}", report.min_distance);
    println!("covering radius {}", report.covering_radius);
    println!(
        "{}",
        if report.valid() {
            "maximal"
        } else {
            "not maximal"
        }
    );
    Ok(())
}
