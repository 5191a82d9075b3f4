//! Charts and tables of what was counted. They show and decide nothing.

use tilescope_analysis::measures::Uniformity;
use tilescope_figures::chart::{Axis, Level, LineChart, Panel, Series};

use super::counted::EDGES;
use super::maps::maps;
use super::subject::{Found, Subject};
use crate::error::ReproduceError;
use crate::experiments::common::{chart, columns, curve, picture};
use crate::outcome::{Cell, Picture, Table};

/// Largest distance from a border that charts show, in radii.
const FAR: f64 = 10.0;

pub fn pictures(found: &Found, cells: usize) -> Result<Vec<Picture>, ReproduceError> {
    let Found {
        reference,
        circumcentre,
        uniform,
        random,
        ..
    } = found;
    let four = [(1, reference), (0, circumcentre), (2, uniform), (3, random)];
    let borders = chart_of("By distance from the nearest block border", &four, |one| {
        &one.blocks
    });
    let domain = chart_of("By distance from the domain's border", &four, |one| {
        &one.domain
    });
    let ranks = ranks(&[(0, circumcentre), (2, uniform)]);
    let inserted = inserted(&[(0, circumcentre), (2, uniform)]);
    let caption = format!(
        "Density against the reference sampler's mean, with bands of 99 % confidence, and where samples are inserted; {} sets each. \
         A gap's places are ranked by their distance from the nearest sample.",
        circumcentre.sets
    );
    let curves = vec![
        vec![Panel::Lines(borders), Panel::Lines(domain)],
        vec![Panel::Lines(ranks), Panel::Lines(inserted)],
    ];
    let borders = picture("borders", "Where samples are", caption, curves)?;
    Ok(vec![borders, maps(found, cells)?])
}

/// Returns the middle of a class of distances.
fn middle(class: usize) -> Option<f64> {
    let end = EDGES.get(class + 1)?;
    Some(0.5 * (EDGES[class] + end)).filter(|x| *x < FAR)
}

fn chart_of(
    title: &str,
    subjects: &[(usize, &Subject)],
    pick: fn(&Subject) -> &Uniformity,
) -> LineChart {
    let series = |&(number, subject): &(usize, &Subject)| {
        let (mut points, mut band) = (Vec::new(), Vec::new());
        for (class, deviation) in pick(subject).deviations.iter().enumerate() {
            if let Some(x) = middle(class) {
                let off = subject.against(deviation);
                points.push([x, 100.0 * off.relative]);
                band.push(off.interval.map(|end| 100.0 * end));
            }
        }
        Series {
            band: Some(band),
            ..curve(subject.name, number, points)
        }
    };
    let mut chart = chart(
        title,
        "distance, r",
        "density, % from the reference",
        subjects.iter().map(series).collect(),
    );
    chart.x = Axis::new("distance, r").with_range(0.0, 7.0);
    chart
}

fn ranks(subjects: &[(usize, &Subject)]) -> LineChart {
    let series = |&(number, subject): &(usize, &Subject)| {
        let inside = subject.inside.as_ref()?;
        let classes = inside.deviations.len() as f64;
        let place = |class: usize| (class as f64 + 0.5) / classes;
        let points = (0..)
            .zip(&inside.deviations)
            .map(|(class, of)| [place(class), 1.0 + of.relative]);
        let band = inside
            .deviations
            .iter()
            .map(|of| of.interval.map(|end| 1.0 + end));
        Some(Series {
            band: Some(band.collect()),
            ..curve(subject.name, number, points.collect())
        })
    };
    let mut chart = chart(
        "Inserted samples by rank in their gap",
        "rank among places of the gap (1: farthest from all samples)",
        "samples, 1 for uniform",
        subjects.iter().filter_map(series).collect(),
    );
    chart.x.range = Some([0.0, 1.0]);
    chart.levels = vec![Level {
        name: "uniform".to_owned(),
        y: 1.0,
    }];
    chart
}

fn inserted(subjects: &[(usize, &Subject)]) -> LineChart {
    let series = |&(number, subject): &(usize, &Subject)| {
        let total = subject.inserted.iter().sum::<u64>().max(1) as f64;
        let mut sum = 0;
        let mut points = vec![[0.0, 0.0]];
        for (class, count) in subject.inserted.iter().enumerate() {
            sum += count;
            points.extend(
                EDGES
                    .get(class + 1)
                    .map(|end| [*end, 100.0 * sum as f64 / total]),
            );
        }
        curve(subject.name, number, points)
    };
    let mut chart = chart(
        "Inserted samples nearer to a block border than",
        "distance, r",
        "inserted samples, %",
        subjects.iter().map(series).collect(),
    );
    chart.x.range = Some([0.0, 5.0]);
    chart.y.range = Some([0.0, 105.0]);
    chart
}

pub fn tables(found: &Found) -> Vec<Table> {
    vec![tests(found), distances(found), in_gaps(found)]
}

const TESTS: [(&str, &str, usize); 10] = [
    ("sets_by", "sets by", 3),
    ("classes_by", "classes by", 3),
    ("sets", "sets", 4),
    ("samples", "samples", 8),
    ("classes", "classes", 4),
    ("chi_square", "chi-square", 5),
    ("chi_square_by_freedom", "by degree of freedom", 4),
    ("probability", "probability", 3),
    ("cramers_v", "Cramer's V", 3),
    ("largest_percent", "largest deviation, %", 3),
];

/// Returns each test with its effect.
fn tests(found: &Found) -> Table {
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    for subject in found.all() {
        let of = [
            ("cells of the domain", Some(&subject.cells)),
            ("distance from block borders", Some(&subject.blocks)),
            ("distance from the domain's border", Some(&subject.domain)),
            ("side of the domain's border", Some(&subject.sides)),
            ("rank in the gap", subject.inside.as_ref()),
        ];
        for (name, test) in of {
            let Some(test) = test else { continue };
            rows.push(vec![
                subject.name.into(),
                name.into(),
                test.runs.into(),
                test.samples.into(),
                test.deviations.len().into(),
                test.chi_square.statistic.into(),
                (test.chi_square.statistic / test.chi_square.freedom as f64).into(),
                test.chi_square.probability.into(),
                test.chi_square.cramers_v.into(),
                (100.0 * test.largest_deviation()).into(),
            ]);
        }
    }
    Table {
        name: "tests".to_owned(),
        title: "Each test; probabilities as if samples were independent, which makes them too large but for ranks".to_owned(),
        columns: columns(&TESTS),
        rows,
        shown: true,
    }
}

const DISTANCES: [(&str, &str, usize); 9] = [
    ("sets_by", "sets by", 3),
    ("border", "border of", 3),
    ("from_r", "from, r", 3),
    ("observed", "samples", 8),
    ("expected", "at the reference's density", 8),
    ("deviation_percent", "deviation, %", 3),
    ("low_percent", "99 % from, %", 3),
    ("high_percent", "to, %", 3),
    ("inserted", "inserted", 7),
];

/// Returns densities by distance from both kinds of border.
fn distances(found: &Found) -> Table {
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    for subject in found.all() {
        for (name, test) in [("block", &subject.blocks), ("domain", &subject.domain)] {
            for (class, deviation) in test.deviations.iter().enumerate() {
                let off = subject.against(deviation);
                let inserted = subject.inserted.get(class).filter(|_| name == "block");
                rows.push(vec![
                    subject.name.into(),
                    name.into(),
                    EDGES[class].into(),
                    deviation.observed.into(),
                    (deviation.expected * subject.density.recip()).into(),
                    (100.0 * off.relative).into(),
                    (100.0 * off.interval[0]).into(),
                    (100.0 * off.interval[1]).into(),
                    inserted.map_or(Cell::Missing(()), |count| (*count).into()),
                ]);
            }
        }
    }
    Table {
        name: "distances".to_owned(),
        title: "Density by distance from borders".to_owned(),
        columns: columns(&DISTANCES),
        rows,
        shown: false,
    }
}

const RANKS: [(&str, &str, usize); 6] = [
    ("sets_by", "sets by", 3),
    ("rank_from", "rank from", 2),
    ("observed", "samples", 7),
    ("expected", "uniform", 7),
    ("deviation_percent", "deviation, %", 3),
    ("skipped", "samples without rank: gap too small", 5),
];

/// Returns inserted samples by rank.
fn in_gaps(found: &Found) -> Table {
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    for subject in found.all() {
        let Some(inside) = &subject.inside else {
            continue;
        };
        let classes = inside.deviations.len() as f64;
        for (class, of) in inside.deviations.iter().enumerate() {
            rows.push(vec![
                subject.name.into(),
                (class as f64 / classes).into(),
                of.observed.into(),
                of.expected.into(),
                (100.0 * of.relative).into(),
                subject.skipped.into(),
            ]);
        }
    }
    Table {
        name: "ranks".to_owned(),
        title: "Inserted samples by rank in their gap".to_owned(),
        columns: columns(&RANKS),
        rows,
        shown: false,
    }
}
