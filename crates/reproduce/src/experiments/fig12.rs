//! Figure 12 and section 4.2: nine sets that were made independently of each other become one, with small losses near
//! the seams, so that a serial sampler becomes a parallel one. The pieces are reference sets;
//! `tilescope_core::combine` glues them.

use serde::{Deserialize, Serialize};
use serde_json::json;
use tilescope_analysis::Report;
use tilescope_core::combine::{CombineOptions, Combined, EliminatedSample, combine};
use tilescope_core::{Boundary, Domain, Point, R, Rect as Cells, Source, reference_sample};
use tilescope_figures::{
    Baseline, DiskRadii, Font, Group, Marker, Palette, PictureOptions, Rect, Scene, SetPicture,
    Shape, Stroke, Style, Text, set_scene, text_width,
};

use crate::control::Control;
use crate::engines::{nine, nine_rects};
use crate::error::{ReproduceError, Result};
use crate::experiments::common::{above_samples, largest};
use crate::numbers::count;
use crate::outcome::{Claim, Outcome, Picture, Table, Verdict};
use crate::rates::timed;
use crate::sets::Set;
use crate::study::{Settings, Study};
use crate::texts::{claim, table, text};

/// Losses up to this share of all samples count as minor. Chosen, not measured, like the two limits below.
const MINOR: f64 = 0.02;
/// Gluing may take this share of all the work, to be small.
const SMALL: f64 = 0.1;
/// Layouts of this side in radii and more say something about the cost.
const LARGE: f64 = 600.0;
/// Sides in radii of the layout that is drawn, whatever the settings.
const DRAWN: f64 = 150.0;

fn sides(settings: &Settings) -> Vec<f64> {
    settings.pick(vec![DRAWN, 600.0, 1800.0], vec![DRAWN])
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct LayoutResult {
    side: f64,
    /// Samples of the nine sets.
    before: usize,
    after: usize,
    /// Samples of the nine sets that are gone, and how far from the seam the deepest of them was, in radii.
    lost: usize,
    deepest: f64,
    inserted: usize,
    iterations: usize,
    /// Seconds to make a set of the whole domain on one thread, the nine sets on all, and to glue them.
    alone: f64,
    making: f64,
    gluing: f64,
    /// Threads that made and glued the nine.
    threads: usize,
    report: Report,
}

impl LayoutResult {
    fn lost_share(&self) -> f64 {
        self.lost as f64 / self.before as f64
    }

    fn overhead(&self) -> f64 {
        self.gluing / (self.making + self.gluing)
    }

    fn speedup(&self) -> f64 {
        self.alone / (self.making + self.gluing)
    }
}

pub fn units(settings: &Settings) -> usize {
    sides(settings).len()
}

/// Combines nine sets at each size, measures the results and draws one.
pub fn run(study: &Study<'_>) -> Result<Outcome> {
    let seed = study.settings.seed;
    let mut found: Vec<LayoutResult> = Vec::new();
    for side in sides(study.settings) {
        let (key, what) = (format!("side-{side}"), format!("nine sets on {side} r"));
        found.push(study.unit(&key, &what, |control| measure(side, seed, control))?);
    }
    let control = study.control("the picture");
    // Sets are not kept, so that the one of the picture is made anew.
    let domain = square_domain(DRAWN)?;
    let glued = glue(domain, seed, &control)?;
    Ok(Outcome {
        claims: claims(&found),
        pictures: pictures(&glued, &nine_rects(&domain)),
        tables: vec![layouts(&found)],
        notes: vec![text("fig12/how", &json!({}))],
    })
}

fn square_domain(side: f64) -> Result<Domain> {
    Ok(Domain::from_size([side; 2], 1.0, Boundary::Periodic)?)
}

struct Glued {
    combined: Combined,
    /// Samples of the nine.
    before: usize,
    /// Seconds of making the nine, and of gluing them.
    seconds: [f64; 2],
}

fn glue(domain: Domain, seed: u64, control: &Control<'_>) -> Result<Glued> {
    let (pieces, making) = timed(|| nine(domain, seed, control));
    let (pieces, options) = (pieces?, CombineOptions::default());
    let (combined, gluing) = timed(|| combine(domain, &pieces, &options, &mut control.observer()));
    Ok(Glued {
        combined: combined?,
        before: pieces.iter().map(|piece| piece.set.samples().len()).sum(),
        seconds: [making, gluing],
    })
}

/// Makes a domain of this side at once and by gluing nine sets, and returns the times and losses.
fn measure(side: f64, seed: u64, control: &Control<'_>) -> Result<LayoutResult> {
    let domain = square_domain(side)?;
    control.go_on()?;

    // The speed-up is that over one thread: a pool of one keeps the sampler from using more.
    let one = (rayon::ThreadPoolBuilder::new().num_threads(1).build())
        .map_err(|error| ReproduceError::Engine(error.to_string()))?;
    let (whole, alone) =
        timed(|| one.install(|| reference_sample(domain, seed, &mut control.observer())));
    // Of this set only the time is compared.
    drop(whole?);

    let glued = glue(domain, seed, control)?;
    let (combined, [making, gluing]) = (&glued.combined, glued.seconds);
    let set = Set::of(&domain, &combined.points);
    let report = set.judge(control)?;

    let rects = nine_rects(&domain);
    // A sample eliminated in the margin around its rectangle is no loss there, as the place belongs to another set.
    let lost = combined.eliminated.iter().filter(|sample| sample.own);
    let depth = |sample: &EliminatedSample| rects[sample.piece as usize].depth(sample.point);
    // Without losses the depth is 0.
    let deepest = lost.clone().map(depth).max().unwrap_or(0);

    let summary = combined.summary();
    Ok(LayoutResult {
        side,
        before: glued.before,
        after: combined.points.len(),
        lost: lost.count(),
        deepest: f64::from(deepest) / f64::from(R),
        inserted: summary.inserted.iter().sum(),
        iterations: summary.inserted.len(),
        alone,
        making,
        gluing,
        threads: rayon::current_num_threads(),
        report,
    })
}

fn claims(found: &[LayoutResult]) -> Vec<Claim> {
    let Some(last) = found.last() else {
        return Vec::new();
    };
    vec![maximal(found, last), losses(found, last), cost(last)]
}

/// Judges whether the combined sets have neither conflicts nor gaps.
fn maximal(found: &[LayoutResult], last: &LayoutResult) -> Claim {
    let faults = found
        .iter()
        .map(|one| one.report.conflicts + one.report.gaps)
        .sum();

    let words = match faults {
        0 => "neither conflict nor gap".to_owned(),
        1 => "1 conflict or gap".to_owned(),
        _ => format!("{} conflicts and gaps", count(faults)),
    };

    // The claim's text names the last set, and ends with "in" and these words. With one layout, "it" is that set.
    let layouts = match found.len() {
        1 => "it".to_owned(),
        number => format!("{number} layouts"),
    };

    let values = json!({ "samples": last.after, "faults": words, "layouts": layouts });
    claim("fig12/maximal", Verdict::of(faults == 0), &values)
}

fn losses(found: &[LayoutResult], last: &LayoutResult) -> Claim {
    let deepest = largest(found.iter().map(|one| one.deepest));
    // "Near the seams" is within 3 r of them, as the text of the claim says: chosen, not measured.
    let verdict = Verdict::of(last.lost_share() <= MINOR && deepest <= 3.0);
    let values = json!({
        "lost": last.lost, "before": last.before, "share": last.lost_share(),
        "worst": largest(found.iter().map(LayoutResult::lost_share)), "deepest": deepest, "minor": MINOR,
    });
    claim("fig12/losses", verdict, &values)
}

fn cost(last: &LayoutResult) -> Claim {
    let (threads, overhead) = (last.threads, last.overhead());
    let holds = overhead <= SMALL && last.speedup() > 1.0;
    let verdict = Verdict::if_known(threads >= 2 && last.side >= LARGE, holds);
    let values = json!({
        "speedup": last.speedup(), "overhead": overhead, "small": SMALL, "large": LARGE,
        "threads": format!("{threads} {}", if threads == 1 { "thread" } else { "threads" }),
    });
    claim("fig12/cost", verdict, &values)
}

fn layouts(found: &[LayoutResult]) -> Table {
    table("fig12/layouts", found, |one| {
        json!({
            "side_r": one.side, "samples_before": one.before, "samples_after": one.after,
            "lost": one.lost, "lost_percent": 100.0 * one.lost_share(), "deepest_r": one.deepest,
            "inserted": one.inserted, "iterations": one.iterations,
            "seconds_alone": one.alone, "seconds_making": one.making, "seconds_gluing": one.gluing,
            "threads": one.threads, "speedup": one.speedup(),
            "conflicts": one.report.conflicts, "gaps": one.report.gaps,
            "min_distance_r": one.report.min_distance, "covering_radius_r": one.report.covering_radius,
        })
    })
}

/// Size of the cross of an eliminated sample, in points: a little larger than the dots beside it.
const CROSS: f64 = 13.0;
/// Sides of the part that is shown large, in radii.
const PART: f64 = 36.0;

/// The nine pieces in the order in which they are the picture's blocks. The blocks take six tints in turn. In this
/// order no two pieces that share a side, inside the domain or across its borders, have the same tint.
const TINTED: [usize; 9] = [0, 1, 2, 3, 4, 5, 8, 6, 7];

/// Returns the picture of the whole, and that of a part from near.
fn pictures(glued: &Glued, rects: &[Cells]) -> Vec<Picture> {
    let combined = &glued.combined;
    // The lowest corner of the middle set is one at which four of the nine meet.
    let corner = combined.domain.user_from_lattice(rects[4].min);
    let half = 0.5 * PART * combined.domain.radius();
    let part = Rect::new(corner.map(|x| x - half), corner.map(|x| x + half));

    let values = json!({
        "before": glued.before, "after": combined.points.len(), "part": PART,
        "lost": combined.eliminated.iter().filter(|lost| lost.own).count(),
    });

    let picture = |(name, window): (&str, Option<Rect>)| {
        let title = text(&format!("fig12/{name}-title"), &values);
        Picture {
            name: name.to_owned(),
            caption: text(&format!("fig12/{name}"), &values),
            scene: scene(glued, rects, window, title),
        }
    };
    [("nine", None), ("seams", Some(part))].map(picture).into()
}

/// Returns the picture of the glued set. With a window it shows this part alone, and the eliminated samples as crosses.
fn scene(glued: &Glued, rects: &[Cells], window: Option<Rect>, title: String) -> Scene {
    let combined = &glued.combined;
    let user = |p: Point| combined.domain.user_from_lattice(p);
    let points = combined.positions();
    // The source of a sample calls its piece a block. The picture's blocks have other numbers: places in `TINTED`.
    let place_of = |piece: u32| TINTED.iter().position(|other| *other == piece as usize);
    let block = |source: &Source| match *source {
        Source::Tiled { block: piece, .. } => place_of(piece).map(|at| at as u32),
        // An inserted sample belongs to none of the nine.
        Source::Inserted { .. } => None,
    };

    let options = PictureOptions {
        window,
        ..PictureOptions::default()
    };

    let blocks = TINTED.map(|piece| Rect::new(user(rects[piece].min), user(rects[piece].max)));
    let set = SetPicture {
        points: &points,
        size: combined.domain.size(),
        boundary: Boundary::Periodic,
        radii: DiskRadii::Equal(combined.domain.radius()),
        blocks: blocks.into(),
        block_of: Some(combined.sources.iter().map(block).collect()),
        exposed: Vec::new(),
        plane: None,
        caption: title,
    };

    let mut scene = set_scene(&set, &options);
    let style = Style::filled(options.palette.eliminated);
    if let Some(part) = window {
        // In a picture y points downwards: places are mirrored within the part that is shown.
        let flip = |[x, y]: [f64; 2]| [x, part.min[1] + part.max[1] - y];
        let positions = points_of(glued).into_iter().map(flip);
        let cross = |at| Shape::marker(Marker::Cross, at, CROSS, style);
        above_samples(&mut scene, "eliminated", positions.map(cross).collect());
    }

    legend(&mut scene, &options.palette, window.is_some());
    scene
}

/// Side of a legend's mark, height of its line and size of its text, in points. Gaps between them and the width of a
/// disk's outline were set by eye.
const MARK: f64 = 12.0;
const LINE: f64 = 34.0;
const TEXT: f64 = 14.0;

/// Adds a line below the picture that says what its marks are. `close` is whether the picture shows a part from near.
fn legend(scene: &mut Scene, palette: &Palette, close: bool) {
    // Eight points above the middle of the line: set by eye, as are the distances of the marks.
    let middle = scene.height + 0.5 * LINE - 8.0;
    let colors = [
        palette.block_borders[0],
        palette.inserted,
        palette.eliminated,
    ];

    let [sample, inserted, eliminated] = colors.map(Style::filled);
    let disk = Style::default().with_stroke(Stroke::new(palette.disk, 1.4));
    // The text of each entry, its mark and the size of that, in marks. The disk is larger than a sample, as in the
    // picture.
    let entries = [
        ("sample, in the colour of its set", Marker::Dot, 1.0, sample),
        ("inserted", Marker::Diamond, 1.0, inserted),
        ("eliminated", Marker::Cross, 1.0, eliminated),
        ("disk of radius r", Marker::Dot, 1.6, disk),
    ];

    let mut group = Group::new("legend");
    let mut x = 20.0 + 0.5 * MARK;
    // A picture of the whole has only the first two: crosses and disks would be too small in it.
    for (name, kind, size, style) in entries.into_iter().take(if close { 4 } else { 2 }) {
        group
            .shapes
            .push(Shape::marker(kind, [x, middle], size * MARK, style));

        let mut label = Text::new([x + MARK + 4.0, middle], name, TEXT, palette.text);
        label.baseline = Baseline::Middle;
        x += MARK + 4.0 + text_width(name, Font::Regular, TEXT) + 2.5 * MARK;
        group.shapes.push(Shape::Text(label));
    }

    scene.groups.push(group);
    scene.height += LINE;
}

/// Returns the positions of eliminated samples that lay in their own set's rectangle, each once.
fn points_of(glued: &Glued) -> Vec<[f64; 2]> {
    let lost = glued.combined.eliminated.iter().filter(|lost| lost.own);
    let mut points: Vec<Point> = lost.map(|lost| lost.point).collect();
    points.sort_unstable_by_key(|p| p.row_major());
    points.dedup();
    glued.combined.domain.users_from_lattice(&points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Experiment;
    use crate::study::tests::quick_run;

    fn found() -> LayoutResult {
        LayoutResult {
            side: 1800.0,
            before: 2_000_000,
            after: 1_990_000,
            lost: 20_000,
            deepest: 1.9,
            inserted: 9000,
            iterations: 4,
            alone: 4.0,
            making: 2.0,
            gluing: 0.1,
            threads: 2,
            report: crate::rates::tests::report(),
        }
    }

    #[test]
    fn verdicts_follow_from_the_numbers() {
        let holds = claims(&[found()]);
        assert_eq!(holds[1].verdict, Verdict::Reproduced);
        assert!(holds[0].ours.ends_with("neither conflict nor gap in it"));
        let mut open = found();
        open.report.gaps = 1;
        let refuted = &claims(&[open, found()])[0];
        assert_eq!(refuted.verdict, Verdict::NotReproduced);
        assert!(refuted.ours.ends_with("1 conflict or gap in 2 layouts"));
        let lossy = LayoutResult {
            lost: 60_000,
            ..found()
        };
        assert_eq!(claims(&[lossy])[1].verdict, Verdict::NotReproduced);
        let deep = LayoutResult {
            deepest: 3.5,
            ..found()
        };
        assert_eq!(claims(&[deep])[1].verdict, Verdict::NotReproduced);
        let single = LayoutResult {
            threads: 1,
            ..found()
        };
        assert_eq!(claims(&[single])[2].verdict, Verdict::NotComparable);
        let slow = LayoutResult {
            gluing: 1.0,
            ..found()
        };
        assert_ne!(claims(&[slow])[2].verdict, Verdict::Reproduced);
    }

    #[test]
    fn a_quick_run_has_the_units_it_said_and_loses_what_it_counts() {
        let outcome = quick_run(Experiment::Fig12, &Settings::default());
        assert_eq!(outcome.claims.len(), 3);
        assert_eq!(outcome.claims[0].verdict, Verdict::Reproduced);
        assert_eq!(outcome.tables[0].rows.len(), 1);
        assert_eq!(outcome.pictures.len(), 2);
    }
}
