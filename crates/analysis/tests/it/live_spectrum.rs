//! Spectra that are kept by changes, against the transform of the same samples at random moments.

use std::ops::ControlFlow;

use tilescope_analysis::Boundary;
use tilescope_analysis::live::{LiveSpectrum, Plane};
use tilescope_analysis::measures::{MeasureError, Periodogram, Spectrum, anisotropy_reference_db};

use crate::support::{BOTH, Random, go_on};

/// A sample as it is told to a live measure.
type LiveSample = (u32, [i32; 2]);

fn plane(size: [u32; 2], boundary: Boundary) -> Plane {
    Plane {
        size,
        radius: 1000,
        boundary,
    }
}

fn random_place(random: &mut Random, plane: &Plane) -> [i32; 2] {
    plane
        .size
        .map(|size| (random.uniform() * f64::from(size)) as i32)
}

fn random_samples(random: &mut Random, plane: &Plane, count: u32) -> Vec<LiveSample> {
    (0..count)
        .map(|id| (id, random_place(random, plane)))
        .collect()
}

fn live(plane: Plane, samples: &[LiveSample], stride: u32) -> LiveSpectrum {
    let mut live = LiveSpectrum::new(plane, samples.len(), stride).expect("a spectrum");
    for &(id, place) in samples {
        live.insert(id, place);
    }
    live
}

/// What is shown, as a text: numbers that are not defined are equal to themselves there.
fn shown(live: &LiveSpectrum) -> String {
    format!("{:?}", live.spectrum())
}

/// The periodogram by the transform, on the window that is shown.
fn transformed(plane: &Plane, samples: &[LiveSample]) -> Periodogram {
    let region = plane.region_in_radii();
    let point = |(_, place): &LiveSample| place.map(|x| f64::from(x) / f64::from(plane.radius));
    let points: Vec<_> = samples.iter().map(point).collect();
    let window = Spectrum::window(points.len() as f64, region);
    Periodogram::of(&points, region, &window, &go_on).expect("a periodogram")
}

/// The largest difference of powers, in parts of what is allowed.
fn difference(found: &Periodogram, expected: &Periodogram) -> f64 {
    let allowed = |power: &f64| 1e-3 * (1.0 + power);
    let pairs = found.power.iter().zip(&expected.power);
    let differences = pairs.map(|(a, b)| (a - b).abs() / allowed(b));
    differences.fold(0.0, f64::max)
}

/// Lets samples come and go at random, about as many as a number that rises and falls.
fn next(
    random: &mut Random,
    plane: &Plane,
    samples: &mut Vec<LiveSample>,
    live: &mut LiveSpectrum,
) {
    let goes = random.uniform() * 160.0 < samples.len() as f64;
    if goes && samples.len() > 1 {
        let index = (random.uniform() * samples.len() as f64) as usize;
        let (id, place) = samples.swap_remove(index);
        live.remove(id, place);
    } else {
        // One in ten comes where another is.
        let place = match samples.last() {
            Some((_, place)) if random.uniform() < 0.1 => *place,
            _ => random_place(random, plane),
        };
        let id = (random.uniform() * 1e9) as u32;
        samples.push((id, place));
        live.insert(id, place);
    }
}

#[test]
fn a_thousand_random_moments_have_the_powers_of_the_transform() {
    let sizes = [[30_000, 30_000], [40_007, 9_001]];
    for (seed, size) in sizes.into_iter().enumerate() {
        for boundary in BOTH {
            let plane = plane(size, boundary);
            let mut random = Random::new(100 + seed as u64);
            let mut live = LiveSpectrum::new(plane, 200, 1).expect("a spectrum");
            let mut samples = Vec::new();

            for moment in 0..250 {
                let changes = 1.0 + random.uniform() * 25.0;
                for _ in 0..changes as usize {
                    next(&mut random, &plane, &mut samples, &mut live);
                }
                let found = live.periodogram().expect("a periodogram");
                let expected = transformed(&plane, &samples);
                assert_eq!(found.window, expected.window);
                let off = difference(&found, &expected);
                // Far better than what is asked for.
                assert!(off < 1e-2, "{boundary:?}, moment {moment}: {off}");
            }
            assert!(!live.must_renew(), "{}", live.error());
        }
    }
}

#[test]
fn powers_depend_on_the_samples_alone() {
    let mut random = Random::new(7);
    let plane = plane([30_000, 20_000], Boundary::Bounded);
    let samples = random_samples(&mut random, &plane, 60);
    let strangers = random_samples(&mut random, &plane, 200);
    let expected = live(plane, &samples, 1);

    let mut found = LiveSpectrum::new(plane, 60, 1).expect("a spectrum");
    for &(id, place) in strangers.iter().chain(samples.iter().rev()) {
        found.insert(id, place);
    }
    for &(id, place) in strangers.iter().rev() {
        found.remove(id, place);
    }
    assert_eq!(found.periodogram(), expected.periodogram());
    assert_eq!(shown(&found), shown(&expected));

    // The control: a change that is forgotten is noticed.
    let (id, place) = strangers[5];
    found.insert(id, place);
    assert_ne!(found.periodogram(), expected.periodogram());
    let samples_and_one: Vec<LiveSample> = samples.iter().copied().chain([strangers[6]]).collect();
    let off = difference(
        &found.periodogram().expect("a periodogram"),
        &transformed(&plane, &samples_and_one),
    );
    assert!(off > 100.0, "{off}");
}

#[test]
fn what_is_shown_is_that_of_the_periodogram() {
    for (size, boundary) in [
        ([50_000, 50_000], Boundary::Periodic),
        ([20_000, 90_000], Boundary::Bounded),
    ] {
        let plane = plane(size, boundary);
        let samples = random_samples(&mut Random::new(8), &plane, 900);
        let live = live(plane, &samples, 1);
        let periodogram = live.periodogram().expect("a periodogram");
        let expected = Spectrum::of(&periodogram).expect("a spectrum");

        let found = live.spectrum().expect("a spectrum");
        assert_eq!(found.profile.annuli.len(), expected.profile.annuli.len());
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12 * (1.0 + b.abs());
        for (a, b) in found.profile.annuli.iter().zip(&expected.profile.annuli) {
            assert_eq!(a.count, b.count);
            let is_near = near(a.frequency, b.frequency) && near(a.power, b.power);
            assert!(is_near, "{a:?} {b:?}");
            let are_without = a.anisotropy_db.is_nan() && b.anisotropy_db.is_nan();
            let is_near = near(a.anisotropy_db, b.anisotropy_db);
            assert!(is_near || are_without, "{a:?} {b:?}");
        }
        let bits = |spectrum: &Spectrum| spectrum.picture_reach.map(f64::to_bits);
        assert_eq!(bits(&found), bits(&expected));
        let [a, b] = [&found, &expected].map(|spectrum| &spectrum.picture);
        assert_eq!(
            (a.size, a.rows, a.side, a.row_side),
            (b.size, b.rows, b.side, b.row_side)
        );
        for (a, b) in a.power.iter().zip(&b.power) {
            assert!((a - b).abs() < 1e-12 * (1.0 + b) || a.is_nan() && b.is_nan());
        }
    }
}

#[test]
fn a_stride_has_the_powers_of_the_whole() {
    for boundary in BOTH {
        let plane = plane([40_000, 25_000], boundary);
        let samples = random_samples(&mut Random::new(9), &plane, 1003);
        let whole = live(plane, &samples, 1);
        let [x, y] = {
            let window = whole.periodogram().expect("a periodogram").window;
            [window.x.end - 1, window.y.end - 1]
        };

        for stride in [2, 3] {
            let thin = live(plane, &samples, stride);
            assert_eq!(shown(&whole.thinned(stride).expect("a part")), shown(&thin));
            assert!((thin.share() - f64::from(stride * stride).recip()).abs() < 1e-15);
            assert!(thin.cost_of_change() * 2 < whole.cost_of_change());

            let step = i64::from(stride);
            for [kx, ky] in [
                [0, 0],
                [1, 0],
                [step, -step],
                [-x / step * step, 0],
                [3, y],
                [2, 4],
            ] {
                let is_kept = kx % step == 0 && ky % step == 0;
                let expected = whole.power([kx, ky]).filter(|_| is_kept);
                assert_eq!(thin.power([kx, ky]), expected, "{stride}: {kx} {ky}");
            }
            assert!(matches!(
                thin.periodogram(),
                Err(MeasureError::OutOfRange { .. })
            ));
            assert!(thin.thinned(1).is_none());
        }
        assert_eq!(whole.power([x + 1, 0]), None);
        assert!(whole.thinned(4).is_none());
    }
}

/// Random samples have the mean power 1 and no preferred direction, whatever part of the frequencies is kept.
#[test]
fn the_annuli_of_a_stride_are_those_of_a_spectrum() {
    let plane = plane([50_000, 50_000], Boundary::Periodic);
    let samples = random_samples(&mut Random::new(10), &plane, 4000);
    for stride in [1, 2, 3] {
        let found = live(plane, &samples, stride)
            .spectrum()
            .expect("a spectrum");
        let points = found.power();
        assert!(points.last().expect("annuli")[0] > 2.4);
        let mean = |values: &[[f64; 2]]| {
            values.iter().map(|point| point[1]).sum::<f64>() / values.len() as f64
        };
        // The lowest annuli have a few frequencies, whose power scatters.
        let high = &points[points.len() / 4..];
        assert!((mean(high) - 1.0).abs() < 0.06, "{}", mean(high));
        let anisotropy = found.anisotropy();
        let above = mean(&anisotropy[anisotropy.len() / 4..]) - anisotropy_reference_db(1);
        assert!(above.abs() < 0.8, "{above}");
        assert_eq!(found.bands, None);
    }
}

#[test]
fn renewed_sums_are_those_of_the_transform() {
    for (boundary, stride) in [
        (Boundary::Periodic, 1),
        (Boundary::Bounded, 1),
        (Boundary::Bounded, 2),
    ] {
        let plane = plane([31_000, 27_000], boundary);
        let samples = random_samples(&mut Random::new(11), &plane, 300);
        let by_changes = live(plane, &samples, stride);
        assert!(by_changes.error() > 0.0 && by_changes.error() < 1e-6);

        let mut renewed = LiveSpectrum::new(plane, 300, stride).expect("a spectrum");
        for &(id, place) in &samples[..7] {
            renewed.insert(id, place);
        }
        let stop = |_| ControlFlow::Break(());
        let before = shown(&renewed);
        assert_eq!(renewed.renew(&samples, &stop), Err(MeasureError::Cancelled));
        assert_eq!(shown(&renewed), before);
        renewed.renew(&samples, &go_on).expect("a transform");
        assert_eq!((renewed.error(), renewed.count()), (0.0, 300));

        let step = i64::from(stride);
        for k in [
            [0, 0],
            [step, 0],
            [0, -step],
            [20 * step, -9 * step],
            [-6 * step, -6 * step],
        ] {
            let [a, b] = [&renewed, &by_changes].map(|live| live.power(k).expect("a power"));
            assert!((a - b).abs() < 1e-5 * (1.0 + b), "{k:?}: {a} {b}");
        }
    }
}

#[test]
fn a_rebuild_has_the_same_powers_whichever_way() {
    let plane = plane([30_000, 30_000], Boundary::Periodic);
    let all = random_samples(&mut Random::new(12), &plane, 5000);
    for count in [0, 1, 3, 5000] {
        let samples = &all[..count];
        let mut rebuilt = live(plane, &all[..40], 1);
        let steps = rebuilt.rebuild(samples);
        assert_eq!(steps, rebuilt.cost_of_rebuild(count));
        assert_eq!(rebuilt.count(), count);
        // The frequencies of 40 samples are kept.
        let mut fresh = LiveSpectrum::new(plane, 40, 1).expect("a spectrum");
        for &(id, place) in samples {
            fresh.insert(id, place);
        }
        for k in [[0, 0], [5, -3], [-16, 11]] {
            let [a, b] = [&rebuilt, &fresh].map(|live| live.power(k).unwrap_or(0.0));
            assert!((a - b).abs() < 1e-5 * (1.0 + b), "{count}: {a} {b}");
        }
    }
}

#[test]
fn sums_that_rounding_could_move_say_so() {
    let plane = plane([30_000, 30_000], Boundary::Bounded);
    let samples = random_samples(&mut Random::new(13), &plane, 150_000);
    let mut live = LiveSpectrum::new(plane, 1, 1).expect("a spectrum");
    live.renew(&samples, &go_on).expect("a transform");
    assert!(!live.must_renew());
    for &(id, place) in &samples[..149_980] {
        live.remove(id, place);
    }
    assert!(live.must_renew(), "{}", live.error());
    live.renew(&samples[149_980..], &go_on)
        .expect("a transform");
    assert!(!live.must_renew());

    // A sample next to the border weighs next to nothing.
    let mut cornered = LiveSpectrum::new(plane, 1, 1).expect("a spectrum");
    cornered.insert(0, [20, 29_990]);
    assert!(cornered.must_renew());
    cornered
        .renew(&[(0, [20, 29_990])], &go_on)
        .expect("a transform");
    let expected = transformed(&plane, &[(0, [20, 29_990])]);
    let found = cornered.periodogram().expect("a periodogram");
    assert!(difference(&found, &expected) < 1.0);
}

#[test]
fn few_and_many_samples_and_strange_planes_are_measured_or_refused() {
    let square = plane([30_000, 30_000], Boundary::Periodic);
    let mut one = LiveSpectrum::new(square, 0, 1).expect("a spectrum");
    let none = MeasureError::TooFew { count: 0, limit: 1 };
    assert_eq!(one.spectrum(), Err(none.clone()));
    assert_eq!(one.periodogram(), Err(none));
    assert_eq!(one.power([1, 1]), None);
    one.insert(3, [29_999, 17]);
    let powers = one.periodogram().expect("a periodogram").power;
    assert!(powers.iter().all(|power| (power - 1.0).abs() < 1e-6));
    let profile = one.spectrum().expect("a spectrum").profile;
    assert!(
        profile
            .annuli
            .iter()
            .all(|annulus| (annulus.power - 1.0).abs() < 1e-6)
    );

    // Half a million samples, or any more: 1,024 frequencies along each axis.
    for samples in [500_000, 5_000_000] {
        let large = LiveSpectrum::new(square, samples, 3).expect("a spectrum");
        assert!(large.cost_of_change() < 480_000);
        assert!(large.cost_of_rebuild(samples) < 3_000 * samples as u64);
    }

    // A plane a million times as long as wide: both axes have their own frequencies.
    for boundary in BOTH {
        let narrow = plane([2_000_000_000, 2_000], boundary);
        let samples = random_samples(&mut Random::new(14), &narrow, 50);
        let found = live(narrow, &samples, 1)
            .periodogram()
            .expect("a periodogram");
        assert!(difference(&found, &transformed(&narrow, &samples)) < 1e-2);
    }

    for bad in [
        plane([0, 5], Boundary::Periodic),
        Plane {
            radius: 0,
            ..square
        },
    ] {
        assert!(LiveSpectrum::new(bad, 10, 1).is_err(), "{bad:?}");
    }
    for stride in [0, 4] {
        let refused = LiveSpectrum::new(square, 10, stride).expect_err("a refusal");
        assert!(matches!(refused, MeasureError::OutOfRange { .. }));
    }
}
