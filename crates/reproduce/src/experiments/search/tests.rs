//! Verdicts on made-up numbers of gaps, and a quick run.

use super::*;
use crate::experiment::Experiment;
use crate::study::tests::quick_run;

fn judged(holes: usize) -> GapCounts {
    GapCounts {
        count: ENOUGH,
        inserted: 30,
        holes,
        centers: holes as u64,
        covering_radius: if holes > 0 { 1.05 } else { 1.0 },
        ..GapCounts::default()
    }
}

fn found(printed: bool, two: usize, four: usize) -> GapStatistics {
    GapStatistics {
        leaf: 20.0,
        printed,
        seed: 1,
        two: judged(two),
        four: judged(four),
    }
}

#[test]
fn one_gap_decides_and_only_where_it_is() {
    use Verdict::{NotComparable, NotReproduced, Reproduced};
    let verdicts = |found: &[GapStatistics]| {
        let claims = claims(found);
        claims.iter().map(|claim| claim.verdict).collect::<Vec<_>>()
    };
    let clean = [found(false, 0, 0), found(true, 0, 0)];
    assert_eq!(verdicts(&clean), [Reproduced; 4]);
    let staged = [found(false, 1, 0), found(true, 0, 0)];
    let expected = [Reproduced, Reproduced, NotReproduced, Reproduced];
    assert_eq!(verdicts(&staged), expected);
    let printed = [found(false, 0, 0), found(true, 0, 1)];
    let expected = [Reproduced, NotReproduced, Reproduced, Reproduced];
    assert_eq!(verdicts(&printed), expected);
    let places: Vec<String> = claims(&clean)
        .into_iter()
        .map(|claim| claim.place)
        .collect();
    assert_eq!(places[..2], ["section 3.2.2"; 2]);
    assert_eq!(places[2..], ["beyond the paper"; 2]);
    let ours = |found: &[GapStatistics]| claims(found)[2].ours.clone();
    assert!(
        ours(&clean).starts_with("no gap in 1 sets of 1"),
        "{}",
        ours(&clean)
    );
    assert!(
        ours(&clean).contains("at most 5.3 a million"),
        "{}",
        ours(&clean)
    );
    assert!(ours(&staged).starts_with("1 gap in"), "{}", ours(&staged));
    // Too few to say that there is none.
    let mut few = found(false, 0, 1);
    few.two.count = ENOUGH - 1;
    assert_eq!(verdicts(&[few])[2], NotComparable);
}

#[test]
fn a_quick_run_finds_gaps_at_two_radii_and_none_at_four() {
    let outcome = quick_run(Experiment::Search, &Settings::default());
    assert_eq!(outcome.claims[2].verdict, Verdict::NotReproduced);
    assert_ne!(outcome.claims[1].verdict, Verdict::NotReproduced);
    assert_ne!(outcome.claims[3].verdict, Verdict::NotReproduced);
    assert!(outcome.pictures.len() >= 2);
}

#[test]
fn a_hole_that_was_made_is_found_with_its_sites() {
    let settings = Settings::default();
    crate::study::tests::alone(&settings, |control| {
        let (mut set, inserted) = make(&square(2_000.0, 10.0), Search::Complete, control)?;
        assert_eq!(GapCounts::of(&set, inserted, control)?.holes, 0);
        let lost = set.points.remove(700);
        let judged = GapCounts::of(&set, inserted, control)?;
        assert!(judged.holes >= 1 && judged.centers >= judged.holes as u64);
        let near = |at: [f64; 2]| (at[0] - lost[0]).hypot(at[1] - lost[1]) < 1.0;
        assert!(judged.worst.iter().all(|witness| near(witness.center)));
        for witness in &judged.worst {
            for site in witness.sites {
                assert!((site[0].hypot(site[1]) - witness.distance).abs() < 1e-6);
            }
        }
        Ok(())
    });
}
