//! Verdicts on figure 13's rates: whether tiling is several times as fast, and what the paper's own ratio can be held against.
//! It takes no time itself.

use super::rates::Row;
use crate::numbers::number;
use crate::outcome::{Claim, Verdict};

/// The paper's lower rate over that of sampling from scratch.
const FASTER: f64 = 2.5;

const PLACE: &str = "section 4.1.3, figure 13";

/// Returns the claims: of the direction, and of the ratio.
pub fn claims(rows: &[Row]) -> [Claim; 2] {
    let alone: Vec<&Row> = rows
        .iter()
        .filter(|row| row.leaf.is_some() && row.threads == Some(1))
        .collect();
    [direction(rows, &alone), ratio(rows, &alone)]
}

fn direction(rows: &[Row], alone: &[&Row]) -> Claim {
    let holds = |row: &&Row| row.ratio.quartiles[1] >= FASTER;
    let verdict = if alone.is_empty() {
        Verdict::NotComparable
    } else {
        Verdict::of(alone.iter().all(holds))
    };
    let densities = alone.iter().map(|row| row.density);
    let [low, high] = ends(densities).map(|density| number(density, 4));
    let of_reference = rows.first().map_or(f64::NAN, |row| row.density);
    Claim {
        claim: "Randomized tiling is several times as fast as sampling from scratch".to_owned(),
        place: PLACE.to_owned(),
        paper: "at least 2.5 times the rate of Ebeida et al.'s sampler".to_owned(),
        ours: format!(
            "times the rate of the reference sampler, all on one thread: {}; densities N r^2 / area {low} to {high}, the reference sampler's {}",
            by_name(alone),
            number(of_reference, 4)
        ),
        verdict,
        reason: format!(
            "Reproduced if the median ratio of rounds is at least {FASTER} at every leaf size with every engine that runs on one thread, as the \
             reference sampler does; more counts as well."
        ),
    }
}

fn ratio(rows: &[Row], alone: &[&Row]) -> Claim {
    let [low, high] = ends(alone.iter().map(|row| row.ratio.quartiles[1]));
    let rate = rows.first().map_or(f64::NAN, |row| row.rate.quartiles[1]);
    Claim {
        claim: "Randomized tiling is 2.5 to 4 times as fast as Ebeida et al.'s sampler".to_owned(),
        place: PLACE.to_owned(),
        paper: "2.5 to 4 times, both on a GPU".to_owned(),
        ours: format!(
            "{} to {} times the reference sampler, both on one thread of a processor",
            number(low, 3),
            number(high, 3)
        ),
        verdict: Verdict::NotComparable,
        reason: format!(
            "Another baseline: the paper's ratio is of two programs on a GPU, and there is no reference sampler for a GPU here. A ratio says as \
             much about the baseline as about the method; the reference sampler makes {} million samples a second here.",
            number(rate / 1e6, 3)
        ),
    }
}

fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    })
}

/// Returns each engine's ratios by leaf.
fn by_name(rows: &[&Row]) -> String {
    let mut names: Vec<&str> = Vec::new();
    for row in rows {
        if !names.contains(&row.name.as_str()) {
            names.push(&row.name);
        }
    }
    let of = |name: &&str| {
        let rows = rows.iter().filter(|row| row.name == **name);
        let ratios = rows.map(|row| {
            let leaf = row.leaf.unwrap_or_default();
            format!("{} at leaf {leaf} r", number(row.ratio.quartiles[1], 3))
        });
        format!("{name} {}", ratios.collect::<Vec<_>>().join(", "))
    };
    names.iter().map(of).collect::<Vec<_>>().join("; ")
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use tilescope_analysis::measures::Summary;

    fn row(name: &str, leaf: Option<f64>, threads: usize, ratio: f64) -> Row {
        let of = |value| Summary::of([value]).unwrap();
        Row {
            name: name.to_owned(),
            leaf,
            threads: Some(threads),
            count: 2e6,
            rate: of(5e5 * ratio),
            ratio: of(ratio),
            density: 0.698,
            min_distance: 1.0,
            covering_radius: 1.0,
        }
    }

    pub fn rows(parallel: f64, sequential: f64) -> Vec<Row> {
        vec![
            row("reference", None, 1, 1.0),
            row("KDRT, parallel", Some(20.0), 1, parallel),
            // More threads may not save it.
            row("KDRT, parallel", Some(20.0), 2, 9.0),
            row("KDRT, sequential", Some(20.0), 1, sequential),
        ]
    }

    #[test]
    fn every_engine_on_one_thread_counts_and_a_ratio_to_another_baseline_is_no_verdict() {
        let verdict = |rows: &[Row]| claims(rows)[0].verdict;
        assert_eq!(verdict(&rows(30.0, 2.6)), Verdict::Reproduced);
        assert_eq!(verdict(&rows(2.4, 9.0)), Verdict::NotReproduced);
        assert_eq!(verdict(&rows(30.0, 2.4)), Verdict::NotReproduced);
        assert_eq!(verdict(&rows(3.0, 3.0)[..1]), Verdict::NotComparable);
        for ratio in [3.0, 30.0] {
            let claims = claims(&rows(ratio, 3.0));
            assert_eq!(claims[1].verdict, Verdict::NotComparable);
            assert!(
                claims[0]
                    .ours
                    .contains("KDRT, sequential 3.00 at leaf 20 r"),
                "{}",
                claims[0].ours
            );
        }
    }
}
