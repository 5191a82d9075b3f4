//! The independent verifier's report on a session, with its witnesses: the closest pair of samples and the largest empty
//! circle, or what makes the set invalid. `tilescope_analysis` computes the verdict itself.

use glam::DVec2;

use tilescope_analysis::{
    Conflict, Gap, JudgeChoice, PrefixClaim, Region, Report, SolidGap, VerifyError, VerifyOptions,
    measure_solid, verify, verify_solid,
};

use tilescope_sets::region;

use crate::ground::MadeGround;
use crate::jobs::Monitor;
use crate::session::Session;
use crate::solid::{MadeSolid, planar_report};
use crate::task::{SessionRef, Task};

/// Which witness of a verdict to show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Witness {
    /// That of the overall verdict: the worst conflict, else the worst gap, else the closest pair.
    Verdict,
    /// The closest pair of samples.
    ClosestPair,
    /// The largest empty circle.
    LargestHole,
}

/// The most samples of a valid set whose closest pair and largest empty circle are found: each takes another
/// verification. Chosen, not measured.
const MAX_EXTREMES: usize = 3_000_000;
/// The closest pair and the largest circle of a valid set are found by verifying it once more, with limits that are tighter
/// than theirs by this factor.
const HAIR: f64 = 1e-9;

/// A report with its witnesses.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Verdict {
    /// The verifier's report on the result, or on a prefix of it.
    pub report: Report,
    /// The claim on that prefix, if the session has nested levels.
    pub claim: Option<PrefixClaim>,
    /// How many dots the whole stipple has, if the session is one: the report is on these or on the first of them.
    pub stipple: Option<usize>,
    /// The closest pair, if known; indices are of the result.
    pub closest: Option<Conflict>,
    /// The largest empty circle, if known.
    pub largest: Option<Gap>,
    /// Of a set in space, what the report has no room for. The density of the report is then that of space.
    #[serde(default)]
    pub space: Option<SpaceWitness>,
}

/// What the verdict on a set in space names besides its report.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SpaceWitness {
    /// An uncovered place with its distance to the nearest sample, in user units, if there is one.
    pub gap: Option<SolidGap>,
}

/// A witness in the plane, to be marked on the canvas and flown to by the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WitnessMark {
    /// The samples or the circle.
    pub shape: WitnessShape,
    /// Whether the verdict allows it: where radii differ and in prefixes, 1 r is not the limit.
    pub is_valid: bool,
}

/// What a witness consists of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WitnessShape {
    /// Two samples, by id, and their distance in r.
    Pair([u32; 2], f64),
    /// The centre of an empty circle and its radius, in r.
    Circle(DVec2, f64),
}

impl Verdict {
    /// Verifies the result of a run, or a prefix of nested levels. `points` are the positions of the samples.
    ///
    /// Fails when the verifier refuses the set or `monitor` is cancelled.
    pub fn of(
        points: &[[f64; 2]],
        region: Region,
        radius: f64,
        monitor: &Monitor,
    ) -> Result<Self, VerifyError> {
        let control = |progress| monitor.follow(progress);
        let ask = |radius: f64, options: &VerifyOptions| {
            verify(points, region, radius, options, &control)
        };
        let report = ask(radius, &VerifyOptions::default())?;

        // An invalid set shows its worst faults. A valid set has none, and shows the pair and the circle that come nearest to one.
        let mut closest = report.worst_conflicts.first().copied();
        let mut largest = report.worst_gaps.first().copied();

        if points.len() <= MAX_EXTREMES {
            let exact = VerifyOptions {
                // The usual tolerance is larger than the hair by which the limits are tighter, and would hide the
                // circle.
                covering_tolerance: 0.0,
                witnesses: 1,
                // The verdict is known already, so that one judge is enough.
                judges: JudgeChoice::Circles,
                ..VerifyOptions::default()
            };

            // With a radius just above the smallest distance, the closest pair is a conflict, which the judge names. A
            // single sample in a bounded region has no pair, and an infinite distance.
            if closest.is_none() && report.min_distance.is_finite() {
                let sharper = ask(report.min_distance * (1.0 + HAIR), &exact)?;
                closest = sharper.worst_conflicts.first().copied();
            }

            // With a radius just below the covering radius, the largest empty circle is a gap. (Between samples there
            // is always some room, so that the covering radius is above 0; a radius of 0 would be refused.)
            if largest.is_none() && report.covering_radius > 0.0 {
                let sharper = ask(report.covering_radius * (1.0 - HAIR), &exact)?;
                largest = sharper.worst_gaps.first().copied();
            }
        }

        Ok(Self {
            report,
            claim: None,
            stipple: None,
            closest,
            largest,
            space: None,
        })
    }

    /// Verifies a set in a field or a shape: its subdivision proves square by square, with the radius at each place, that the set is
    /// valid. Of a valid set it names no closest pair and no largest circle, as these are measured by one radius; of
    /// another set it names the worst conflict and the worst gap.
    ///
    /// Of a stipple, `points` may be the first dots alone. How many the whole has is left to the caller.
    ///
    /// Fails when the field or the shape is refused, or there is no verdict.
    pub fn on_ground(
        points: &[[f64; 2]],
        made: &MadeGround,
        monitor: &Monitor,
    ) -> Result<Self, String> {
        let (ground, _stated) = made.ground().map_err(|error| error.to_string())?;
        let control = |progress| monitor.follow(progress);
        let (judged, options) = (&ground.varying.judged, VerifyOptions::default());
        // The first dots need not cover every place: how far they do is measured.
        let report = match made.stipple {
            Some(_) => judged.verify_prefix(points, &options, &control),
            None => judged.verify(points, &options, &control),
        };
        let report = report.map_err(|error| error.to_string())?;

        Ok(Self {
            claim: None,
            stipple: None,
            closest: report.worst_conflicts.first().copied(),
            largest: report.worst_gaps.first().copied(),
            space: None,
            report,
        })
    }

    /// Judges the set by cubes and by circles, and measures its covering radius. The report has lengths as those of planar
    /// sets, and as density that of space.
    ///
    /// Fails when the verifier refuses the set or `monitor` is cancelled.
    pub fn in_space(
        session: &Session,
        solid: &MadeSolid,
        monitor: &Monitor,
    ) -> Result<Self, String> {
        let points = solid.positions(session.run());
        let (region, radius) = (solid.region(), session.run().domain.radius());
        let control = |progress| monitor.follow(progress);
        let options = VerifyOptions {
            // Each side of the box is a whole number of lattice units, so that a unit may be a little longer than
            // radius / R. The box's own bound is computed with its longest unit.
            covering_tolerance: solid.domain.covering_bound() / radius - 1.0,
            ..VerifyOptions::default()
        };
        let is_prefix = false;
        let found = measure_solid(&points, region, radius, is_prefix, &options, &control)
            .map_err(|error| error.to_string())?;

        let mut closest = found.report.worst_conflicts.first().copied();
        let least = found.report.min_distance;
        if closest.is_none() && least.is_finite() {
            // With a radius just above the smallest distance the closest pair is a conflict, which the judge names.
            let sharper = verify_solid(&points, region, least * (1.0 + HAIR), &options, &control)
                .map_err(|error| error.to_string())?;
            closest = sharper.worst_conflicts.first().copied();
        }

        let gap = found.report.worst_gaps.first().copied();
        Ok(Self {
            report: planar_report(found),
            claim: None,
            stipple: None,
            closest,
            // A set in space has an empty ball instead of a circle, and only that of a gap is known.
            largest: None,
            space: Some(SpaceWitness { gap }),
        })
    }

    /// Returns whether no two samples are closer than they may be.
    #[must_use]
    pub fn conflict_free(&self) -> bool {
        let of_claim = |claim: PrefixClaim| claim.is_apart(&self.report);
        self.claim.map_or(self.report.conflict_free(), of_claim)
    }

    /// Returns whether no place is farther from all samples than it may be: of a stipple, that its dots cover within a factor
    /// that can be measured.
    #[must_use]
    pub fn maximal(&self) -> bool {
        if let Some(all) = self.stipple {
            // All dots cover within the factor that was measured; fewer dots promise no covering.
            return self.report.count < all || self.report.gaps == 0;
        }
        let of_claim = |claim: PrefixClaim| claim.is_covering(&self.report);
        self.claim.map_or(self.report.maximal(), of_claim)
    }

    /// Returns whether the set is valid: conflict-free and maximal, or, of a prefix, as claimed.
    #[must_use]
    pub fn valid(&self) -> bool {
        self.conflict_free() && self.maximal()
    }

    /// Returns where `witness` lies in the plane, if it is known.
    #[must_use]
    pub fn witness_mark(&self, witness: Witness, session: &Session) -> Option<WitnessMark> {
        let radius = session.run().domain.radius();
        let pair = || {
            let pair = self.closest?;
            let id = |index: usize| session.run().result.get(index).copied();
            let ids = [id(pair.first)?, id(pair.second)?];
            Some(WitnessMark {
                shape: WitnessShape::Pair(ids, pair.distance / radius),
                // It is the worst pair, so that it conflicts if any does.
                is_valid: self.conflict_free(),
            })
        };

        let circle = || {
            let gap = self.largest?;
            let center = DVec2::from(gap.center) / radius;
            Some(WitnessMark {
                shape: WitnessShape::Circle(center, gap.distance / radius),
                // It is the largest one, so that it is a gap if any is.
                is_valid: self.maximal(),
            })
        };

        match witness {
            Witness::ClosestPair => pair(),
            Witness::LargestHole => circle(),
            // A conflict outweighs a gap.
            Witness::Verdict if !self.conflict_free() => pair(),
            Witness::Verdict if !self.maximal() => circle(),
            Witness::Verdict => pair().or_else(circle),
        }
    }
}

/// The task of verifying a session's result, or a prefix of nested levels or of a stipple.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct VerifyTask {
    /// The session whose result is verified.
    pub session: SessionRef,
    /// How many samples, of nested levels and of a stipple.
    pub prefix: Option<usize>,
}

impl Task for VerifyTask {
    type Outcome = Result<Verdict, String>;
    const NAME: &'static str = "verify";

    fn run(self, monitor: &Monitor) -> Self::Outcome {
        let session = &self.session;
        let run = session.run();
        if let Some(made) = &session.solid {
            return Verdict::in_space(session, made, monitor);
        }
        if let Some(made) = &session.ground {
            let mut points = run.positions();
            let all = points.len();
            points.truncate(self.prefix.unwrap_or(all));
            let verdict = Verdict::on_ground(&points, made, monitor)?;
            // A file may have only the first dots of a stipple, which promise no covering. The whole stipple has as
            // many dots as were asked for. (If the certificate states fewer dots than the file has, the file counts as
            // the whole.)
            let (_parameters, request) = &made.asked;
            let asked = request.stipple.as_ref();
            let dots_asked = asked.and_then(|stipple| usize::try_from(stipple.dots).ok());
            let whole_stipple = session
                .stipple()
                .map(|_| dots_asked.map_or(all, |dots| dots.max(all)));
            return Ok(Verdict {
                stipple: whole_stipple,
                ..verdict
            });
        }
        let region = region(&run.domain);

        let verdict = match session.nested.as_ref().zip(self.prefix) {
            Some((nested, count)) => {
                // A prefix is judged as a set of its own, with the radius that its level has.
                let claim = nested.claim(count);
                let points = run.domain.users_from_lattice(&run.samples.points[..count]);
                let verdict = Verdict::of(&points, region, claim.radius(), monitor);
                verdict.map(|verdict| Verdict {
                    claim: Some(claim),
                    ..verdict
                })
            }
            None => Verdict::of(&run.positions(), region, run.domain.radius(), monitor),
        };

        verdict.map_err(|error| error.to_string())
    }
}
