//! Charts, maps and tables of what was counted.

use tilescope_analysis::measures::Uniformity;
use tilescope_figures::Bitmap;
use tilescope_figures::chart::{
    Axis, ColorScale, Level, LineChart, Panel, Series, TileChart, TileContent,
};

use super::counted::EDGES;
use super::gaps::CLASSES;
use super::offsets::{SamplerUniformity, UniformityResults};
use crate::error::ReproduceError;
use crate::experiments::common::{chart, curve, picture};
use crate::numbers::{number, signed};
use crate::outcome::{Picture, Table};
use crate::table::table;

/// Largest distance from a border that charts show, in radii.
const FAR: f64 = 10.0;

pub fn pictures(found: &UniformityResults, cells: usize) -> Result<Vec<Picture>, ReproduceError> {
    let UniformityResults {
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
    subjects: &[(usize, &SamplerUniformity)],
    pick: fn(&SamplerUniformity) -> &Uniformity,
) -> LineChart {
    let series = |&(number, subject): &(usize, &SamplerUniformity)| {
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

fn ranks(subjects: &[(usize, &SamplerUniformity)]) -> LineChart {
    let series = |&(number, subject): &(usize, &SamplerUniformity)| {
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

fn inserted(subjects: &[(usize, &SamplerUniformity)]) -> LineChart {
    let series = |&(number, subject): &(usize, &SamplerUniformity)| {
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

pub fn tables(found: &UniformityResults) -> Vec<Table> {
    vec![tests(found), distances(found), in_gaps(found)]
}

/// Returns each test with its effect.
fn tests(found: &UniformityResults) -> Table {
    let rows = found.all().into_iter().flat_map(|one| {
        let of = [
            ("cells of the domain", Some(&one.cells)),
            ("distance from block borders", Some(&one.blocks)),
            ("distance from the domain's border", Some(&one.domain)),
            ("side of the domain's border", Some(&one.sides)),
            ("rank in the gap", one.inside.as_ref()),
        ];
        let of = of.into_iter();
        of.filter_map(move |(by, test)| Some((one.name, by, test?)))
    });
    let title = "Each test; probabilities as if samples were independent, which makes them too large but for ranks";
    table("tests", title, rows)
        .column("sets_by", "sets by", 3, |row| row.0)
        .column("classes_by", "classes by", 3, |row| row.1)
        .column("sets", "sets", 4, |row| row.2.runs)
        .column("samples", "samples", 8, |row| row.2.samples)
        .column("classes", "classes", 4, |row| row.2.deviations.len())
        .column("chi_square", "chi-square", 5, |row| {
            row.2.chi_square.statistic
        })
        .column("chi_square_by_freedom", "by degree of freedom", 4, |row| {
            row.2.chi_square.statistic / row.2.chi_square.freedom as f64
        })
        .column("probability", "probability", 3, |row| {
            row.2.chi_square.probability
        })
        .column("cramers_v", "Cramer's V", 3, |row| {
            row.2.chi_square.cramers_v
        })
        .column("largest_percent", "largest deviation, %", 3, |row| {
            100.0 * row.2.largest_deviation()
        })
        .shown()
}

/// Returns densities by distance from both kinds of border.
fn distances(found: &UniformityResults) -> Table {
    let rows = found.all().into_iter().flat_map(|one| {
        let borders = [("block", &one.blocks), ("domain", &one.domain)].into_iter();
        borders.flat_map(move |(border, test)| {
            let classes = test.deviations.iter().enumerate();
            classes.map(move |(class, deviation)| (one, border, class, deviation))
        })
    });
    let interval =
        |one: &SamplerUniformity, class| one.against(class).interval.map(|end| 100.0 * end);
    table("distances", "Density by distance from borders", rows)
        .column("sets_by", "sets by", 3, |row| row.0.name)
        .column("border", "border of", 3, |row| row.1)
        .column("from_r", "from, r", 3, |row| EDGES[row.2])
        .column("observed", "samples", 8, |row| row.3.observed)
        .column("expected", "at the reference's density", 8, |row| {
            row.3.expected * row.0.density.recip()
        })
        .column("deviation_percent", "deviation, %", 3, |row| {
            100.0 * row.0.against(row.3).relative
        })
        .column("low_percent", "99 % from, %", 3, |row| {
            interval(row.0, row.3)[0]
        })
        .column("high_percent", "to, %", 3, |row| interval(row.0, row.3)[1])
        .column("inserted", "inserted", 7, |row| {
            let inserted = row.0.inserted.get(row.2).copied();
            inserted.filter(|_| row.1 == "block")
        })
        .hidden()
}

/// Returns inserted samples by rank.
fn in_gaps(found: &UniformityResults) -> Table {
    let rows = found.all().into_iter().flat_map(|one| {
        let ranks = one.inside.iter().flat_map(|inside| &inside.deviations);
        ranks.enumerate().map(move |(class, of)| (one, class, of))
    });
    table("ranks", "Inserted samples by rank in their gap", rows)
        .column("sets_by", "sets by", 3, |row| row.0.name)
        .column("rank_from", "rank from", 2, |row| {
            row.1 as f64 / CLASSES as f64
        })
        .column("observed", "samples", 7, |row| row.2.observed)
        .column("expected", "uniform", 7, |row| row.2.expected)
        .column("deviation_percent", "deviation, %", 3, |row| {
            100.0 * row.2.relative
        })
        .column("skipped", "samples without rank: gap too small", 5, |row| {
            row.0.skipped
        })
        .hidden()
}

/// Deviation at which colours end.
const END: f64 = 0.1;
/// From blue over nearly white to red, in equal steps: told apart without red or without green as well.
const COLORS: [[u8; 3]; 5] = [
    [5, 48, 97],
    [67, 147, 195],
    [247, 247, 247],
    [214, 96, 77],
    [103, 0, 31],
];
/// Maps beside each other, and the side of each in pixels.
const MAPS: usize = 3;
const SIDE: f64 = 380.0;

/// Returns the colour of a deviation.
fn color(deviation: f64) -> [u8; 3] {
    let steps = (COLORS.len() - 1) as f64;
    let at = (0.5 * (deviation / END).clamp(-1.0, 1.0) + 0.5) * steps;
    let from = (at as usize).min(COLORS.len() - 2);
    let part = at - from as f64;
    [0, 1, 2].map(|k| {
        let [a, b] = [COLORS[from][k], COLORS[from + 1][k]].map(f64::from);
        (a + part * (b - a)).round() as u8
    })
}

/// Returns the maps of all sets: how far each cell of the domain is from the mean.
fn maps(found: &UniformityResults, cells: usize) -> Result<Picture, ReproduceError> {
    let [reference, moved, others @ ..] = found.all();
    let mut tiles = Vec::new();
    for one in [&[reference], &others[..], &[moved]].concat() {
        let rows = one.cells.deviations.chunks(cells).rev().flatten();
        let colors: Vec<[u8; 3]> = rows.map(|cell| color(cell.relative)).collect();
        tiles.push(Panel::Tile(TileChart {
            title: one.name.to_owned(),
            note: String::new(),
            y: None,
            side: Some(SIDE),
            content: TileContent::Cells(Bitmap::rgb(cells, &colors)?),
        }));
    }
    let ends = [-100.0 * END, 100.0 * END];
    let mut rows: Vec<Vec<Panel>> = tiles.chunks(MAPS).map(<[Panel]>::to_vec).collect();
    let deviation = |step: i32| END * (f64::from(step) / 31.5 - 1.0);
    let [low, high] = ends.map(|end| format!("{} %", signed(end, 2)));
    rows[0].push(Panel::Scale(ColorScale {
        ends: [format!("samples of a cell, from the mean: {low}"), high],
        colors: (0..64).map(|step| color(deviation(step))).collect(),
    }));
    let caption = format!(
        "Samples in each of {cells} x {cells} cells of the domain, against the mean: blue fewer, red more, from {} % to +{} %. \
         The last map is the control with a bias put in.",
        number(ends[0], 2),
        number(ends[1], 2)
    );
    picture("maps", "Samples by place in the domain", caption, rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_white_in_the_middle_and_end_at_the_ends() {
        assert_eq!(color(0.0), COLORS[2]);
        assert_eq!([color(-END), color(-1.0)], [COLORS[0]; 2]);
        assert_eq!([color(END), color(1.0)], [COLORS[4]; 2]);
        let [less, more] = [-0.05, 0.05].map(color);
        assert!(less[2] > less[0] && more[0] > more[2]);
    }
}
