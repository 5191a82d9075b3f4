//! The verdict on a set in space, as text and as data.

use std::fmt::Write;

use serde_json::{Value, json};
use tilescope_analysis::{Boundary, Judge, JudgeChoice, Number, SolidRegion, SolidVerdict};

use crate::output::{answer, compared, conflicts_answer, validity};

/// Returns "10 x 10 x 10, periodic".
pub fn box_text(region: &SolidRegion) -> String {
    let boundary = match region.boundary {
        Boundary::Periodic => "periodic",
        Boundary::Bounded => "bounded",
    };
    let [width, height, depth] = region.size().map(Number);
    format!("{width} x {height} x {depth}, {boundary}")
}

/// Returns the fields of a verdict, as those of planar sets. Lengths are in radii if the name ends in `_r`.
pub fn json(verdict: &SolidVerdict) -> Value {
    // Numbers that are not finite become null. The beginning of a larger set has a covering factor: it is judged within
    // that factor of the radius, so that `report.maximal()` does not say that it is maximal.
    let report = &verdict.report;
    json!({
        "count": report.count,
        "density": report.density,
        "min_distance_r": report.min_distance / report.radius,
        "covering_radius_r": verdict.covering_radius / report.radius,
        "relative_radius": verdict.relative_radius(),
        "covering_tolerance": report.covering_tolerance,
        "conflicts": report.conflicts,
        "more_conflicts": report.more_conflicts(),
        "gaps": report.gaps,
        "conflict_free": report.conflict_free(),
        "maximal": report.maximal() && verdict.covering_factor.is_none(),
        "covering_factor": verdict.covering_factor,
        "valid": verdict.valid(),
        "judges": report.judges,
    })
}

/// Returns why covered circles did not judge, though they were asked.
fn declined(verdict: &SolidVerdict, asked: JudgeChoice) -> Option<&'static str> {
    let report = &verdict.report;
    let are_asked = match asked {
        JudgeChoice::Circles | JudgeChoice::Both => true,
        JudgeChoice::Automatic => report.count <= JudgeChoice::BOTH_UP_TO,
        JudgeChoice::Subdivision | JudgeChoice::Delaunay => false,
    };
    if !are_asked || report.judges.contains(&Judge::Circles) {
        return None;
    }
    Some(if report.conflicts > 0 {
        "covered circles judge sets without conflicts alone"
    } else {
        "covered circles do not judge samples that are so far apart"
    })
}

/// Returns the verdict in a few lines. `asked` are the judges that were chosen.
pub fn text(verdict: &SolidVerdict, asked: JudgeChoice) -> String {
    // Lengths are in radii, with as many decimals as in the verdict on planar sets: 9, and 6 for single witnesses, or
    // more where that shows whether a length or its limit is larger.
    let report = &verdict.report;
    let r = report.radius;
    // The limit of distances is 1 in radii, which need not be shown beside them.
    let (closest, _limit) = compared(report.min_distance / r, 1.0, 9);
    // Positions are rounded to a lattice, and maximality has a tolerance for it.
    let limit = 1.0 + report.covering_tolerance;
    let (farthest, most) = compared(verdict.covering_radius / r, limit, 9);
    let covers = match verdict.covering_factor {
        // The factor is rounded up, so that the sentence is true of every place.
        Some(factor) => format!(
            "prefix         yes   every place is within {:.6} r",
            (factor * 1e6).ceil() / 1e6
        ),
        None => format!(
            "maximal        {}   covering radius {farthest} r, at most {most} r",
            answer(report.maximal(), report.gaps)
        ),
    };

    let why = declined(verdict, asked).map_or_else(String::new, |why| format!("   ({why})"));
    let mut out = format!(
        "samples        {}\n\
         density        {:.4} N r^3 / volume\n\
         conflict-free  {}   min distance {closest} r\n\
         {covers}\n\
         verified by    {}{why}\n",
        report.count,
        report.density,
        conflicts_answer(report.conflicts),
        Judge::joined(&report.judges),
    );

    // A set may have millions of conflicts and of gaps; the three worst of each show the fault.
    for conflict in report.worst_conflicts.iter().take(3) {
        let (apart, _) = compared(conflict.distance / r, 1.0, 6);
        let (a, b) = (conflict.first, conflict.second);
        let _ = writeln!(out, "  conflict: samples {a} and {b}, {apart} r apart");
    }
    for gap in report.worst_gaps.iter().take(3) {
        let ([x, y, z], (far, _)) = (place(gap.center, r), compared(gap.distance / r, limit, 6));
        let _ = writeln!(
            out,
            "  gap: ({x}, {y}, {z}) is {far} r from the nearest sample"
        );
    }
    let _ = writeln!(out, "verdict        {}", validity(verdict.valid()));
    out
}

/// Returns the coordinates of a place to a millionth of a radius, which finds the place and is read at a glance.
fn place(at: [f64; 3], radius: f64) -> [Number; 3] {
    // Decimals are counted from the radius on: a set of small balls needs more of them. Doubles have no more than 17.
    let decimals = (6.0 - radius.log10()).ceil().clamp(0.0, 17.0) as usize;
    at.map(|value| {
        let rounded = format!("{value:.decimals$}");
        // Through a number, so that zeros at the end are left out; adding 0 turns -0 into 0.
        Number(rounded.parse::<f64>().unwrap_or(value) + 0.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_have_digits_as_fine_as_a_millionth_of_the_radius() {
        let text = |at, radius| place(at, radius).map(|value| value.to_string());
        let at = [9.313_225_746_154_785e-9, 0.25, 1.0 / 3.0];
        assert_eq!(text(at, 1.0), ["0", "0.25", "0.333333"]);
        // Of balls of a thousandth, three digits more; what is not small stays as it is.
        assert_eq!(text(at, 1e-3), ["9e-9", "0.25", "0.333333333"]);
        assert_eq!(
            text([-1e-12, 1234.5678, 5e5], 100.0),
            ["0", "1234.5678", "500000"]
        );
    }
}
