//! Measures that are made anew in slices are those that are made at once.

use tilescope_analysis::Boundary;
use tilescope_analysis::live::{
    LiveCover, LivePairs, LiveSample, LiveSpectrum, LiveVerdict, Plane, Renew, Renewal,
};

use crate::support::{BOTH, Random};

fn plane(size: [u32; 2], boundary: Boundary) -> Plane {
    Plane {
        size,
        radius: 1000,
        boundary,
    }
}

/// Samples at random, one in ten of them where another is.
fn samples(random: &mut Random, plane: &Plane, count: u32) -> Vec<LiveSample> {
    let mut all: Vec<LiveSample> = Vec::new();
    for id in 0..count {
        let place = match all.last() {
            Some((_, place)) if random.uniform() < 0.1 => *place,
            _ => (plane.size).map(|size| (random.uniform() * f64::from(size)) as i32),
        };
        all.push((id, place));
    }
    all
}

/// Makes a measure anew, and returns it with the steps of its largest slice and of all.
fn in_slices<M: Renew>(measure: &M, samples: &[LiveSample]) -> (M, [u64; 2]) {
    let mut renewal = Renewal::of(measure, samples.to_vec());
    let expected = renewal.steps_left();
    let (mut largest, mut all) = (0, 0);
    while !renewal.is_made() {
        let steps = renewal.proceed();
        (largest, all) = (largest.max(steps), all + steps);
    }
    assert!(renewal.steps_left() <= expected);
    (renewal.finish(), [largest, all])
}

#[test]
fn distances_and_circles_in_slices_are_those_at_once() {
    let mut random = Random::new(31);
    for boundary in BOTH {
        let plane = plane([40_000, 31_000], boundary);
        let strangers = samples(&mut random, &plane, 50);
        let mut pairs = LivePairs::new(plane).expect("a plane");
        let mut cover = LiveCover::new(plane).expect("a plane");
        pairs.rebuild(&strangers);
        cover.rebuild(&strangers);

        for count in [0, 1, 40, 1200] {
            let all = samples(&mut random, &plane, count);
            let (found_pairs, [largest, _]) = in_slices(&pairs, &all);
            assert!(largest < 20_000, "{largest}");
            let (found_cover, [largest, _]) = in_slices(&cover, &all);
            assert!(largest < 20_000, "{largest}");

            let (mut at_once, mut covered) = (pairs.clone(), cover.clone());
            at_once.rebuild(&all);
            covered.rebuild(&all);
            assert_eq!(
                LiveVerdict::of(&found_pairs, &found_cover),
                LiveVerdict::of(&at_once, &covered)
            );
            assert_eq!(found_pairs.correlation(), at_once.correlation());
            assert_eq!(found_cover.gaps(), covered.gaps());

            // The control: another set is another measure.
            if count > 1 {
                covered.rebuild(&all[..all.len() - 3]);
                assert_ne!(found_cover.gaps(), covered.gaps());
            }
        }
    }
}

#[test]
fn a_spectrum_in_slices_is_that_at_once() {
    let mut random = Random::new(32);
    for (boundary, stride) in BOTH.into_iter().flat_map(|b| [(b, 1), (b, 3)]) {
        let plane = plane([50_000, 37_000], boundary);
        let mut spectrum = LiveSpectrum::new(plane, 3000, stride).expect("a spectrum");
        spectrum.rebuild(&samples(&mut random, &plane, 20));

        for count in [0, 2, 3000] {
            let all = samples(&mut random, &plane, count);
            let (found, [largest, steps]) = in_slices(&spectrum, &all);
            let expected = Renewal::cost(&spectrum, all.len());
            assert!(steps <= 2 * expected, "{steps} {expected}");
            assert!(expected <= 2 * steps, "{steps} {expected}");
            assert!(count < 3000 || largest < steps / 4, "{largest} {steps}");

            let mut at_once = spectrum.clone();
            at_once.rebuild(&all);
            let shown = |live: &LiveSpectrum| format!("{:?}", live.spectrum());
            assert_eq!(shown(&found), shown(&at_once));
            assert_eq!(found.count(), all.len());
        }
    }
}
