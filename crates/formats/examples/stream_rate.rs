//! Measures streams: points per second of export and check, and peak memory. Usage: `stream_rate export PATTERN 3x2
//! FILE [verify 0 or 1] [f32 or f64] [checkpoints]`, where the certified periodic set PATTERN is repeated 3 times
//! across and 2 times up, and `stream_rate check FILE` or `stream_rate whole FILE`. It prints times and asserts none.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use tilescope_analysis::{Progress, Region};
use tilescope_formats::{
    ExportContext, Hint, Overrides, Precision, StreamExport, StreamOptions, check, check_stream,
    read,
};

type Rows = Vec<Vec<[f64; 2]>>;
type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

const GO: fn(Progress) -> ControlFlow<()> = |_| ControlFlow::Continue(());

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |index: usize| arguments.get(index).map_or("", String::as_str);
    let begun = Instant::now();
    let count = match argument(0) {
        "export" => export(&arguments)?,
        "check" => {
            let found = check_stream(argument(1).as_ref(), &Overrides::default(), &GO)?;
            println!("passed {}", found.passed());
            found.report.count as u64
        }
        "whole" => {
            let (_, found) = check(argument(1).as_ref(), &Overrides::default(), &GO)?;
            println!("passed {}", found.passed());
            found.report.count as u64
        }
        _ => return Err("say export, check or whole".into()),
    };
    let seconds = begun.elapsed().as_secs_f64();
    let rate = count as f64 / seconds / 1e6;
    println!("{count} points in {seconds:.3} s: {rate:.2} M/s");
    println!("peak memory {}", peak_memory());
    Ok(())
}

fn export(arguments: &[String]) -> Outcome<u64> {
    let argument = |index: usize| arguments.get(index).map_or("", String::as_str);
    let (rows, region, radius) = pattern(argument(1).as_ref())?;
    let (across, up) = argument(2).split_once('x').ok_or("say 3x2")?;
    let [across, times]: [u32; 2] = [across.parse()?, up.parse()?];
    let larger = Region {
        width: region.width * f64::from(across),
        height: region.height * f64::from(times),
        ..region
    };
    let mut context = ExportContext::new(larger, radius);
    if argument(5) == "f32" {
        context.precision = Precision::Single;
    }
    let checkpoints: u32 = argument(6).parse().unwrap_or(0);
    let options = StreamOptions {
        verify: argument(4) != "0",
        resumable: checkpoints > 0,
    };
    let mut export = StreamExport::create(argument(3).as_ref(), &context, options)?;
    let (mut points, mut pushing, mut saving) = (Vec::new(), 0.0, 0.0);
    for up in 0..times {
        for row in &rows {
            for right in 0..across {
                let shift = [
                    f64::from(right) * region.width,
                    f64::from(up) * region.height,
                ];
                points.extend(row.iter().map(|p| [p[0] + shift[0], p[1] + shift[1]]));
            }
            if points.len() > 1 << 18 {
                pushing += timed(|| export.push(&points, None, &GO))?;
                points.clear();
            }
        }
        if checkpoints > 0 && up % times.div_ceil(checkpoints) == 0 {
            pushing += timed(|| export.push(&points, None, &GO))?;
            points.clear();
            saving += timed(|| export.checkpoint(&serde_json::Value::from(up)))?;
        }
    }
    pushing += timed(|| export.push(&points, None, &GO))?;
    let count = export.count();
    let rate = count as f64 / pushing / 1e6;
    println!("pushing {pushing:.3} s: {rate:.2} M/s; checkpoints {saving:.3} s");
    let finishing = timed(|| {
        let streamed = export.finish(&GO)?;
        if let Some(exported) = streamed.verified {
            println!("valid {}", exported.report.valid());
        }
        Ok::<(), tilescope_formats::ExportError>(())
    })?;
    println!("finishing {finishing:.3} s");
    Ok(count)
}

/// The rows, one radius high, of a certified set, its region and radius.
fn pattern(path: &Path) -> Outcome<(Rows, Region, f64)> {
    let pattern = read(path, &Hint::default())?;
    let stated = pattern.certificate;
    let stated = stated.ok_or("the pattern has no certificate")?;
    let (region, radius) = (stated.region, stated.radius.least());
    let mut rows = vec![Vec::new(); (region.height / radius) as usize + 1];
    for point in pattern.set.points {
        rows[(point[1] / radius) as usize].push(point);
    }
    Ok((rows, region, radius))
}

fn timed<E>(work: impl FnOnce() -> Result<(), E>) -> Result<f64, E> {
    let begun = Instant::now();
    work()?;
    Ok(begun.elapsed().as_secs_f64())
}

/// The peak of resident memory as Linux states it.
fn peak_memory() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    (status.lines())
        .find_map(|line| line.strip_prefix("VmHWM:"))
        .map_or("unknown".into(), |size| size.trim().into())
}
