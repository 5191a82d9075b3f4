//! At random moments of random runs, forwards and backwards, what is kept from change to change equals the verdict of both
//! judges from nothing.

use std::ops::ControlFlow;
use std::sync::Arc;

use proptest::prelude::*;
use proptest::test_runner::TestCaseError;
use tilescope_analysis::live::{LiveCover, LivePairs, LiveVerdict, Plane};
use tilescope_analysis::{Boundary, Report, VerifyOptions, verify};
use tilescope_core::combine::{CombineOptions, Piece, combine_in_stages, grid};
use tilescope_core::{
    Domain, Fate, Insertion, Order, Parameters, Pattern, PatternSpec, Point, R, Recorder, Run,
    RunEvent, Unobserved, Variant, sample_recorded,
};

/// The samples that came and went, in sequence.
#[derive(Default)]
struct Changes(Vec<(u32, bool)>);

impl Recorder for Changes {
    fn record(&mut self, run_event: RunEvent) {
        match run_event {
            RunEvent::Tiled {
                sample,
                inside: true,
                ..
            }
            | RunEvent::Insert { sample, .. } => {
                self.0.push((sample, true));
            }
            RunEvent::Eliminate { sample, .. } => self.0.push((sample, false)),
            _ => {}
        }
    }
}

/// Measures that follow a run.
struct Follower {
    plane: Plane,
    samples: Vec<(u32, [i32; 2])>,
    pairs: LivePairs,
    cover: LiveCover,
}

impl Follower {
    fn new(run: &Run) -> Self {
        let domain = &run.domain;
        let plane = Plane {
            size: [domain.width() as u32, domain.height() as u32],
            radius: R as u32,
            boundary: if domain.is_periodic() {
                Boundary::Periodic
            } else {
                Boundary::Bounded
            },
        };
        Self {
            plane,
            samples: Vec::new(),
            pairs: LivePairs::new(plane).expect("a plane"),
            cover: LiveCover::new(plane).expect("a plane"),
        }
    }

    fn change(&mut self, run: &Run, sample: u32, comes: bool) {
        let point = run.samples.points[sample as usize];
        let place = [point.x, point.y];
        if comes {
            self.samples.push((sample, place));
            self.pairs.insert(sample, place);
            self.cover.insert(sample, place);
        } else {
            let index = self
                .samples
                .iter()
                .position(|other| other.0 == sample)
                .expect("it came");
            self.samples.swap_remove(index);
            self.pairs.remove(sample, place);
            self.cover.remove(sample, place);
        }
    }

    fn report(&self) -> Report {
        let in_radii = |place: [i32; 2]| place.map(|value| f64::from(value) / f64::from(R));
        let points: Vec<[f64; 2]> = self
            .samples
            .iter()
            .map(|sample| in_radii(sample.1))
            .collect();
        let (options, go_on) = (VerifyOptions::default(), |_| ControlFlow::Continue(()));
        let region = self.plane.region_in_radii();
        verify(&points, region, 1.0, &options, &go_on).expect("a verdict")
    }

    /// How the verdict differs from the judges'.
    fn difference(&self, rebuilt: bool) -> Option<String> {
        if self.samples.is_empty() {
            return (self.cover.count() + self.pairs.count() > 0).then(|| "not empty".to_owned());
        }
        let (mut pairs, mut cover) = (self.pairs.clone(), self.cover.clone());
        if rebuilt {
            pairs.rebuild(&self.samples);
            cover.rebuild(&self.samples);
        }

        let (found, report) = (LiveVerdict::of(&pairs, &cover), self.report());
        let is_same = found.count == report.count
            && found.conflicts == report.conflicts
            && found.min_distance.to_bits() == report.min_distance.to_bits()
            && found.gaps == report.gaps
            && (found.covering_radius / report.covering_radius - 1.0).abs() < 1e-11
            && found.valid() == report.valid();
        (!is_same).then(|| format!("{found:?} {report:?}"))
    }
}

fn parameters() -> impl Strategy<Value = Parameters> {
    let way = prop_oneof![
        Just((Variant::Staged, Insertion::Circumcentre)),
        Just((Variant::Staged, Insertion::Uniform)),
        Just((Variant::AsPrinted, Insertion::Circumcentre)),
    ];
    let order = prop_oneof![
        Just(Order::Index),
        Just(Order::Random),
        Just(Order::PhaseGroup)
    ];
    let shape = (10.0_f64..40.0, 10.0_f64..40.0, 6.0_f64..15.0);
    (any::<u64>(), shape, any::<bool>(), order, way).prop_map(
        |(seed, (width, height, leaf), is_bounded, order, way)| Parameters {
            width,
            height,
            radius: 1.0,
            boundary: if is_bounded {
                tilescope_core::Boundary::Bounded
            } else {
                tilescope_core::Boundary::Periodic
            },
            seed,
            leaf,
            pattern: PatternSpec {
                side: 17.0,
                ..PatternSpec::default()
            },
            order,
            insertion: way.1,
            variant: way.0,
            ..Parameters::default()
        },
    )
}

/// Returns a combination of four sets, as a run with all its stages.
fn combination(seed: u64, is_bounded: bool, order: Order, insertion: Insertion) -> Run {
    let boundary = if is_bounded {
        tilescope_core::Boundary::Bounded
    } else {
        tilescope_core::Boundary::Periodic
    };
    let domain = Domain::from_size([30.0, 26.0], 1.0, boundary).expect("a domain");
    let each = grid(&domain, 2, 2).into_iter().zip(seed..);
    let pieces = each.map(|(rect, seed)| {
        let own = Domain::of_rect(&rect, tilescope_core::Boundary::Periodic).expect("a domain");
        let set = Pattern::of_reference(own, seed, &mut Unobserved).expect("a set");
        let (set, start) = (Arc::new(set), Point::default());
        Piece { set, rect, start }
    });

    let options = CombineOptions {
        seed,
        order,
        insertion,
        ..CombineOptions::default()
    };
    let pieces: Vec<Piece> = pieces.collect();
    let made = combine_in_stages(domain, &pieces, &options, &mut Unobserved);
    made.expect("a combination").run
}

/// Returns the samples that come and go in a combination, which reports no events: those that the pieces contribute come, those
/// that are eliminated go, and those that fill gaps come.
fn changes_of_combination(run: &Run) -> Vec<(u32, bool)> {
    let fates = || (0..).zip(&run.samples.fates);
    let inserted: Vec<u32> = (run.iterations.iter())
        .flat_map(|made| made.inserted.clone())
        .collect();
    let placed = fates().filter(|(id, fate)| **fate != Fate::Dropped && !inserted.contains(id));
    let eliminated = fates().filter(|(_, fate)| matches!(fate, Fate::Eliminated { .. }));

    let mut changes: Vec<(u32, bool)> = placed.map(|(id, _)| (id, true)).collect();
    changes.extend(eliminated.map(|(id, _)| (id, false)));
    changes.extend(inserted.iter().map(|id| (*id, true)));
    changes
}

/// Checks moments of a run, in shares of its changes, and its end. The changes are taken forwards and backwards.
fn check_moments(run: &Run, all: &[(u32, bool)], moments: Vec<f64>) -> Result<(), TestCaseError> {
    let mut follower = Follower::new(run);
    let (mut taken, ends) = (0, [0.0, 1.0]);
    for (round, moment) in moments.into_iter().chain(ends).enumerate() {
        let target = (moment * all.len() as f64) as usize;
        while taken < target {
            let (sample, comes) = all[taken];
            follower.change(run, sample, comes);
            taken += 1;
        }
        while taken > target {
            taken -= 1;
            let (sample, came) = all[taken];
            follower.change(run, sample, !came);
        }
        let difference = follower.difference(round % 4 == 3);
        prop_assert!(
            difference.is_none(),
            "{target} of {}: {difference:?}",
            all.len()
        );
    }
    prop_assert!(LiveVerdict::of(&follower.pairs, &follower.cover).valid());

    // The control: a sample that only the circles see move, to the side of another one. No other is within r of its place, so
    // that the largest empty circle grows.
    let (id, place) = follower.samples[follower.samples.len() / 2];
    let (_, [x, y]) = follower.samples[0];
    follower.cover.remove(id, place);
    follower
        .cover
        .insert(id, [if x == 0 { 1 } else { x - 1 }, y]);
    prop_assert!(follower.difference(false).is_some());
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(tilescope_tests::cases(48)))]

    #[test]
    fn moments_of_runs_are_judged_as_from_nothing(
        parameters in parameters(),
        moments in prop::collection::vec(0.0_f64..=1.0, 12),
    ) {
        let mut changes = Changes::default();
        let run = sample_recorded(&parameters, &mut Unobserved, &mut changes).expect("a run");
        check_moments(&run, &changes.0, moments)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(tilescope_tests::cases(16)))]

    #[test]
    fn moments_of_combinations_are_judged_as_from_nothing(
        seed in any::<u32>(),
        is_bounded in any::<bool>(),
        order in prop_oneof![Just(Order::OwnBlockFirst), Just(Order::Random)],
        insertion in prop_oneof![Just(Insertion::Circumcentre), Just(Insertion::Uniform)],
        moments in prop::collection::vec(0.0_f64..=1.0, 8),
    ) {
        let run = combination(seed.into(), is_bounded, order, insertion);
        let changes = changes_of_combination(&run);
        let is_there = |id: &u32| changes.contains(&(*id, true)) && !changes.contains(&(*id, false));
        prop_assert!(run.result.iter().all(is_there));
        // Sets that meet are in conflict along their seams.
        prop_assert!(changes.iter().any(|(_, comes)| !comes));
        check_moments(&run, &changes, moments)?;
    }
}
