//! `tilescope sample --window` with six numbers: a part of space without end, made without the rest.

use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};
use tilescope_analysis::{Number, Region, SolidReport};
use tilescope_core::{Parameter, Progress, SolidSpace};
use tilescope_formats::{
    ExportContext, Format, SolidColumns, SolidContext, Warning, check_solid_format,
    export_solid_unverified, solid_digest,
};
use tilescope_sets::{SolidMade, SolidSurroundings};

use crate::make::NO_VERDICT;
use crate::output::{answer, compared, conflicts_answer, report, validity, warning_line};
use crate::paths::{InFile, named};
use crate::progress::verifying;
use crate::sample_arguments::SampleArguments;
use crate::{interrupt, verdict_code};

use super::make::refuse_planar;

/// The largest number of samples of a window and around it: they are verified in memory.
const MAX_SAMPLES: f64 = 2e7;

/// Computes the samples of a window of space, judges them and prints the report. Returns the exit code of the program.
pub fn run(arguments: &SampleArguments, corners: [f64; 6]) -> Result<u8> {
    refuse_planar(
        arguments,
        "--window of six numbers",
        &[Parameter::Radius, Parameter::Seed],
    )?;
    ensure!(
        !arguments.space.is_given(),
        "{option}: --window of six numbers is a part of space without end, which has no sides; leave {option} out",
        option = arguments.space.option()
    );
    ensure!(
        arguments.run.count.is_none() && arguments.nested.exactly.is_none(),
        "space without end has no number of samples: with --window of six numbers give --radius"
    );
    if let Some(path) = &arguments.out {
        let format = Format::to_write(path, arguments.format)?;
        check_solid_format(format).in_file(path)?;
        // UTK's positions are parts of a domain.
        ensure!(
            !matches!(format, Format::UtkText | Format::UtkBinary),
            "{}: {format} has positions in a unit cube, and a window of space without end has no domain; take ply, npy, csv or xyz",
            named(path)
        );
    }

    // Only the radius and the seed are used. `refuse_planar` has refused all other parameters that were typed.
    let asked = &arguments.run.asked;
    let space = SolidSpace::new(asked.radius, asked.seed)?;
    let [x0, y0, z0, x1, y1, z1] = corners;
    let window = space.window([x0, y0, z0], [x1, y1, z1])?;
    let expected = SolidSurroundings::expected_samples(&window);
    ensure!(
        expected <= MAX_SAMPLES,
        "about {expected:.3e} samples lie in the window and within 2 r of it, where they are judged with it; \
         the limit is {MAX_SAMPLES:.0e}: choose a smaller window"
    );

    // The samples that are saved are among those that are judged. The time is that of all of these, without their verdict.
    let began = Instant::now();
    let around = SolidSurroundings::of(&space, &window, &mut |_: Progress| interrupt::flow())?;
    let inside = around.inside();
    let seconds = began.elapsed().as_secs_f64();
    let verdict = verifying(|control| around.judge(control)).context(NO_VERDICT)?;
    let found = WindowFound {
        points: space.users_from_lattice(&inside.places),
        levels: inside.levels.of_samples().collect(),
        verdict,
        corners,
        space,
        seconds,
    };

    // A part of a set is saved without a certificate, which would state that it is maximal at its sides, too.
    let mut lines = found.text();
    let (mut file, mut note) = (Value::Null, None);
    if let Some(path) = &arguments.out {
        note = found.save(arguments, path)?.map(|note| note.to_string());
        lines.extend(note.as_deref().map(warning_line));
        file = json!(named(path));
        let _ = writeln!(
            lines,
            "file           {} (a part of a set has no certificate)",
            named(path)
        );
    }
    let warnings = note.as_slice();
    report(arguments.json, || found.json(&file, warnings), || lines)?;
    Ok(verdict_code(found.verdict.valid()))
}

/// A window that was made, with its verdict.
struct WindowFound {
    space: SolidSpace,
    corners: [f64; 6],
    points: Vec<[f64; 3]>,
    /// The level at which each sample arrived.
    levels: Vec<u8>,
    verdict: SolidReport,
    seconds: f64,
}

impl WindowFound {
    /// Saves the samples without a certificate. Returns a note if the format leaves the levels out.
    fn save(&self, arguments: &SampleArguments, path: &Path) -> Result<Option<Warning>> {
        ensure!(
            !self.points.is_empty(),
            "{}: no sample lies in the window, and files have at least one",
            named(path)
        );
        // The formats that are left hold positions as they are, whatever the domain.
        let base = Region::new([1.0; 2], false);
        let mut planar = ExportContext::new(base, self.space.radius());
        planar.format = arguments.format;
        planar.precision = arguments.precision;
        // A sample has the same level in every window. Its place in the order of arrival is that of no window: space without
        // end has no first sample.
        let columns = SolidColumns {
            arrival: Vec::new(),
            level: self.levels.clone(),
        };
        let context = SolidContext {
            planar,
            depth: 1.0,
            columns,
        };
        export_solid_unverified(path, &self.points, &context).in_file(path)
    }

    /// Returns the report for programs.
    fn json(&self, file: &Value, warnings: &[String]) -> Value {
        let (space, verdict) = (&self.space, &self.verdict);
        json!({
            "method": SolidMade::METHOD,
            "parameters": { "radius": space.radius(), "seed": space.seed() },
            "window": self.corners,
            "radius": space.radius(),
            "count": self.points.len(),
            "positions_digest": solid_digest(&self.points),
            "seconds": self.seconds,
            "conflicts": verdict.conflicts,
            "gaps": verdict.gaps,
            "min_distance_r": verdict.min_distance / verdict.radius,
            "conflict_free": verdict.conflict_free(),
            "maximal": verdict.maximal(),
            "valid": verdict.valid(),
            "file": file,
            "warnings": warnings,
        })
    }

    /// Returns the report in lines.
    fn text(&self) -> String {
        let verdict = &self.verdict;
        let [x0, y0, z0, x1, y1, z1] = self.corners;
        // In radii, so that the limit is 1, which need not be shown beside it.
        let (min_distance, _limit) = compared(verdict.min_distance / verdict.radius, 1.0, 9);
        format!(
            "window         [{x0}, {x1}) x [{y0}, {y1}) x [{z0}, {z1}) of space without end, r = {}\n\
             samples        {} in {:.2} ms\n\
             conflict-free  {}   min distance {min_distance} r\n\
             maximal        {}\n\
             verdict        {}\n",
            Number(verdict.radius),
            self.points.len(),
            self.seconds * 1e3,
            conflicts_answer(verdict.conflicts),
            answer(verdict.maximal(), verdict.gaps),
            validity(verdict.valid()),
        )
    }
}
