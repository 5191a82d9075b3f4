//! At random moments of random runs, forwards and backwards, what is kept from change to change equals the verdict of both
//! judges from nothing.

use std::ops::ControlFlow;

use proptest::prelude::*;
use tilescope_analysis::live::{LiveCover, LivePairs, LiveVerdict, Plane};
use tilescope_analysis::{Boundary, Report, VerifyOptions, verify};
use tilescope_core::{
    Insertion, Order, Parameters, PatternSpec, R, Recorder, Run, RunEvent, Unobserved, Variant,
    sample_recorded,
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

proptest! {
    #![proptest_config(ProptestConfig::with_cases(tilescope_tests::cases(48)))]

    #[test]
    fn moments_of_runs_are_judged_as_from_nothing(
        parameters in parameters(),
        moments in prop::collection::vec(0.0_f64..=1.0, 12),
    ) {
        let mut changes = Changes::default();
        let run = sample_recorded(&parameters, &mut Unobserved, &mut changes).expect("a run");
        let mut follower = Follower::new(&run);
        let (all, mut taken) = (&changes.0, 0);
        let ends = [0.0, 1.0];
        for (round, moment) in moments.into_iter().chain(ends).enumerate() {
            let target = (moment * all.len() as f64) as usize;
            while taken < target {
                let (sample, comes) = all[taken];
                follower.change(&run, sample, comes);
                taken += 1;
            }
            while taken > target {
                taken -= 1;
                let (sample, came) = all[taken];
                follower.change(&run, sample, !came);
            }
            let difference = follower.difference(round % 4 == 3);
            prop_assert!(difference.is_none(), "{target} of {}: {difference:?}", all.len());
        }
        prop_assert!(LiveVerdict::of(&follower.pairs, &follower.cover).valid());

        // The control: a change that the circles were not told of.
        let (id, place) = follower.samples[follower.samples.len() / 2];
        follower.cover.remove(id, place);
        follower.cover.insert(id, [place[0] / 2, place[1]]);
        prop_assert!(follower.difference(false).is_some());
    }
}
