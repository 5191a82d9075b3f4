//! Medians of the times and shares of all rounds, by leaf size.

use std::collections::BTreeSet;

use tilescope_analysis::measures::Summary;

use super::stages::{Procedure, StageRound, StageTimes};
use crate::rates::{PassTimes, median};

/// A leaf size over all rounds.
#[derive(Clone, Debug)]
pub struct LeafTimes {
    pub leaf: f64,
    pub printed: bool,
    /// Seconds of each procedure, and its share of the run.
    pub procedures: Vec<(Procedure, Summary, Summary)>,
    /// Seconds of a run of the sequential engine, the sum of its procedures.
    pub whole: Summary,
    /// Seconds of the parallel engine for the same set; `None` for the algorithm as printed.
    pub parallel: Option<Summary>,
    /// Samples of the first round's set.
    pub count: usize,
}

impl LeafTimes {
    pub fn name(&self) -> String {
        let printed = if self.printed { ", as printed" } else { "" };
        format!("leaf {} r{printed}", self.leaf)
    }

    /// Returns the median share of elimination and first insertion together, and the largest one of any other
    /// procedure.
    pub fn shares(&self) -> [f64; 2] {
        let is_first = false;
        let others = self.medians(is_first).into_iter();
        [self.first_shares().iter().sum(), others.fold(0.0, f64::max)]
    }

    /// Returns the median shares of elimination and of the first insertion, or of the loop that does both.
    pub fn first_shares(&self) -> Vec<f64> {
        let is_first = true;
        self.medians(is_first)
    }

    fn medians(&self, is_first: bool) -> Vec<f64> {
        let each = (self.procedures.iter()).filter(|(of, _, _)| of.is_first() == is_first);
        each.map(|(_, _, share)| share.quartiles[1]).collect()
    }
}

/// Returns a row for each leaf size in the sequence of the rounds. Iterations that not every round has count as no
/// time there.
pub fn rows(rounds: &[StageRound]) -> Vec<LeafTimes> {
    let leaves = rounds.first().map_or(0, |first| first.timed.len());
    let times_of = |index: usize| {
        rounds
            .iter()
            .filter_map(move |round| round.timed.get(index))
    };
    (0..leaves)
        .filter_map(|index| row(&times_of(index).collect::<Vec<_>>()))
        .collect()
}

/// Returns the row of a leaf size, of its times in each round; `None` without rounds.
fn row(times: &[&StageTimes]) -> Option<LeafTimes> {
    let whole = |one: &StageTimes| one.seconds.iter().map(|(_, seconds)| seconds).sum::<f64>();
    let each = times.iter().flat_map(|one| &one.seconds).map(|(of, _)| *of);
    // The order of procedures is that in which a run carries them out.
    let procedures: BTreeSet<Procedure> = each.collect();

    let with_summaries = |procedure: Procedure| {
        let seconds_of = |one: &StageTimes| {
            let found = one.seconds.iter().find(|(of, _)| *of == procedure);
            // A round that needed fewer iterations spent no time on this one.
            found.map_or(0.0, |(_, seconds)| *seconds)
        };
        let shares = times.iter().map(|one| seconds_of(one) / whole(one));
        let seconds = Summary::of(times.iter().map(|one| seconds_of(one)))?;
        Some((procedure, seconds, Summary::of(shares)?))
    };

    let first = times.first()?;
    Some(LeafTimes {
        leaf: first.leaf,
        printed: first.printed,
        procedures: procedures.into_iter().filter_map(with_summaries).collect(),
        whole: Summary::of(times.iter().map(|one| whole(one)))?,
        // The algorithm as printed is not timed in parallel, which leaves nothing to sum up.
        parallel: Summary::of(times.iter().filter_map(|one| one.parallel)),
        count: first.summary.count,
    })
}

/// Returns the passes of each stage of GPUs, by their names, with the medians of their seconds.
pub fn passes(rounds: &[StageRound]) -> Vec<(String, PassTimes)> {
    let Some(last) = rounds.last() else {
        return Vec::new();
    };
    let with_median = |(adapter, one): &(String, PassTimes)| {
        let same = |other: &&(String, PassTimes)| other.0 == *adapter && other.1.stage == one.stage;
        let each = rounds.iter().flat_map(|round| &round.passes).filter(same);
        let seconds = median(each.filter_map(|(_, one)| one.seconds));
        let one = one.clone();
        (adapter.clone(), PassTimes { seconds, ..one })
    };
    last.passes.iter().map(with_median).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use tilescope_core::Summary as RunSummary;

    #[test]
    fn shares_are_medians_of_shares_and_rounds_without_an_iteration_count_as_none() {
        let summary = RunSummary {
            blocks: 1,
            tiled: 1,
            dropped: 0,
            eliminated: 0,
            inserted: Vec::new(),
            count: 1,
        };
        let round = |slow: f64, third: bool| {
            let mut seconds = vec![
                (Procedure::Tile, 2.0 * slow),
                (Procedure::Eliminate, 3.0 * slow),
                (Procedure::Iterate(1), 5.0 * slow),
            ];
            if third {
                seconds.push((Procedure::Iterate(3), 10.0 * slow));
            }
            StageRound {
                timed: vec![StageTimes {
                    leaf: 20.0,
                    printed: false,
                    seconds,
                    summary: summary.clone(),
                    detectors: Vec::new(),
                    parallel: None,
                }],
                passes: Vec::new(),
            }
        };
        let rows = rows(&[round(1.0, false), round(7.0, false), round(1.0, true)]);
        assert_eq!(rows[0].procedures.len(), 4);
        let [first, other] = rows[0].shares();
        assert!((first - 0.8).abs() < 1e-12, "{first}");
        assert!((other - 0.2).abs() < 1e-12, "{other}");
    }
}
