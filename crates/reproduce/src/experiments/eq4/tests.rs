//! Verdicts on made-up shares, and a quick run.

use super::*;
use crate::experiment::Experiment;
use crate::study::tests::{alone, quick_run};

/// What would be found if the equation held: `factor` times its share, of clips and of inserted samples.
fn found(leaf: f64, factor: [f64; 2]) -> LeafShares {
    let predicted = LeafShares {
        leaf,
        ..LeafShares::default()
    }
    .predicted();
    LeafShares {
        leaf,
        count: 1_000_000,
        area: 1e6,
        // The overlap of the plane is far from it: it must not matter.
        alone: 1e6 * (1.0 - 0.9 * factor[0].min(0.5)),
        clipped: 1e6 / (1.0 - factor[0] * predicted),
        blocks: 100,
        edges: 200.0 * leaf,
        tiled: 1_500_000,
        margin: 300_000,
        inserted: (1e6 * factor[1] * predicted) as usize,
        ..LeafShares::default()
    }
}

fn verdicts(factor: impl Fn(f64) -> [f64; 2]) -> Vec<Verdict> {
    let found: Vec<LeafShares> = LEAVES
        .iter()
        .map(|&leaf| found(leaf, factor(leaf)))
        .collect();
    claims(&found).iter().map(|claim| claim.verdict).collect()
}

#[test]
fn verdicts_follow_from_the_numbers() {
    use Verdict::{NotReproduced, Reproduced};
    assert_eq!(verdicts(|_| [1.0, 0.3]), [Reproduced; 4]);
    let wide = [NotReproduced, NotReproduced, Reproduced, Reproduced];
    assert_eq!(verdicts(|_| [1.4, 0.3]), wide);
    let many = [Reproduced, Reproduced, NotReproduced, Reproduced];
    assert_eq!(verdicts(|_| [1.0, 1.1]), many);
    let flat = [Reproduced, Reproduced, Reproduced, NotReproduced];
    assert_eq!(verdicts(|leaf| [1.0, 0.1 * (leaf / 6.0).sqrt()]), flat);
}

#[test]
fn what_is_counted_is_what_there_is() {
    alone(&Settings::default(), |control| {
        let parameters = square(4_000.0, 12.0);
        let run = sequential(&parameters, control)?;
        let found = counts(12.0, &run);
        let summary = run.summary();
        assert_eq!(
            (found.tiled, found.eliminated),
            (summary.tiled, summary.eliminated)
        );
        assert_eq!(found.count, found.tiled - found.eliminated + found.inserted);
        // Who was eliminated was in conflict, and there is somebody who survived one.
        assert!(found.eliminated < found.in_conflict && found.in_conflict < found.tiled);
        assert!(found.lost < found.eliminated && found.margin < found.tiled);
        // Random places: as many lie within r of their block's border as the blocks say.
        let shallow = |p: &&tilescope_core::Point| {
            run.blocks
                .leaves
                .iter()
                .any(|block| (0..R).contains(&block.rect.depth(**p)))
        };
        let pattern = run.pattern.samples();
        let inside = |p: &&tilescope_core::Point| run.domain.rect().contains(**p);
        let places: Vec<_> = pattern.iter().filter(inside).collect();
        let share = places.iter().filter(|p| shallow(p)).count() as f64 / places.len() as f64;
        assert!(
            (share - found.overlap()).abs() < 0.03,
            "{share} {}",
            found.overlap()
        );
        Ok(())
    });
}

#[test]
fn a_quick_run_has_the_units_it_said() {
    let outcome = quick_run(Experiment::Eq4, &Settings::default());
    assert_eq!(outcome.claims.len(), 4);
    assert_eq!(outcome.tables[0].rows.len(), LEAVES.len());
}
