//! All numbers of the figure: means to be read, sets and curves for data files.

use tilescope_analysis::measures::Summary;

use super::found::{DENSE, Found};
use super::plate::Plated;
use crate::outcome::{Cell, Column, Table};

/// Returns the tables.
pub fn tables(all: &[Found]) -> Vec<Table> {
    vec![
        plates(all),
        horizons(all),
        plate_sets(all),
        plate_classes(all),
        horizon_sets(all),
        power(all),
    ]
}

type Columns<'a> = &'a [(&'a str, &'a str, usize)];

fn table(
    (name, title): (&str, &str),
    columns: Columns<'_>,
    rows: Vec<Vec<Cell>>,
    shown: bool,
) -> Table {
    Table {
        name: name.to_owned(),
        title: title.to_owned(),
        columns: (columns.iter())
            .map(|(key, head, digits)| Column::new(key, head, *digits))
            .collect(),
        rows,
        shown,
    }
}

/// Zone plates of a sampler, and those of KDRT with as many samples as a file has.
fn groups(one: &Found) -> [(String, &[Plated]); 2] {
    [
        (one.name.clone(), &one.plates),
        (format!("KDRT, as many as {}", one.name), &one.beside),
    ]
}

fn plates(all: &[Found]) -> Table {
    let columns: Columns<'_> = &[
        ("sampler", "sampler", 0),
        ("sets", "sets", 3),
        ("samples", "samples", 9),
        ("side_pixels", "side, pixels", 5),
        ("rmse", "RMSE", 4),
        ("rmse_deviation", "deviation", 2),
        ("rmse_below_nyquist", "RMSE below Nyquist", 4),
        ("rmse_above_nyquist", "RMSE above Nyquist", 4),
        ("signal_to_noise_db", "signal to noise, dB", 3),
        ("low_power", "mean power at \u{3bd} \u{2264} 0.5", 3),
    ];
    let row = |(name, plates): (String, &[Plated]), low: Option<f64>| {
        let first = plates.first()?;
        let of = |value: fn(&Plated) -> f64| Summary::of(plates.iter().map(value));
        let mean = |value: fn(&Plated) -> f64| of(value).map_or(f64::NAN, |found| found.mean);
        let deviation = of(|plate| plate.rmse).filter(|found| found.count > 1);
        Some(vec![
            name.into(),
            plates.len().into(),
            first.count.into(),
            first.side.into(),
            mean(|plate| plate.rmse).into(),
            deviation.map_or(f64::NAN, |found| found.deviation).into(),
            mean(|plate| plate.below).into(),
            mean(|plate| plate.above).into(),
            mean(|plate| plate.signal_db).into(),
            low.unwrap_or(f64::NAN).into(),
        ])
    };
    let rows = all.iter().flat_map(|one| {
        let low = one.look.as_ref().map(|look| look.low);
        let [own, beside] = groups(one);
        [row(own, low), row(beside, None)]
    });
    let rows = rows.flatten().collect();
    table(("zone-plates", "Zone plate"), columns, rows, true)
}

fn horizons(all: &[Found]) -> Table {
    let each: Vec<usize> = (all.iter())
        .map(|one| one.horizons.iter().map(|sets| sets[0].per_pixel).collect())
        .max_by_key(Vec::len)
        .unwrap_or_default();
    // Quick runs have too few numbers of samples for exponents.
    let fitted = all.iter().any(|one| one.slope().is_some());
    let exponent = format!("exponent from {DENSE} on");
    let mut columns = vec![Column::new("sampler", "sampler", 0)];
    columns.extend(fitted.then(|| Column::new("exponent", &exponent, 3)));
    columns.push(Column::new(
        "empty_percent_sparsest",
        "pixels without a sample at the least, %",
        3,
    ));
    columns.extend(each.iter().map(|per_pixel| {
        let key = format!("rmse_{per_pixel}_per_pixel");
        Column::new(&key, &format!("RMSE at {per_pixel} per pixel"), 4)
    }));
    let rendered = all.iter().filter(|one| !one.horizons.is_empty());
    let rows = rendered
        .map(|one| horizon_row(one, &each, fitted))
        .collect();
    Table {
        columns,
        ..table(("horizons", "Horizon"), &[], rows, true)
    }
}

fn horizon_row(one: &Found, each: &[usize], fitted: bool) -> Vec<Cell> {
    let mean = |per_pixel: &usize| {
        let mut all = one.horizons.iter();
        let sets = all.find(|sets| sets[0].per_pixel == *per_pixel)?;
        Some(Summary::of(sets.iter().map(|set| set.rmse))?.mean)
    };
    let empty = one.horizons.first().map(|sets| 100.0 * sets[0].empty);
    let slope = fitted.then(|| one.slope());
    let numbers = slope
        .into_iter()
        .chain([empty])
        .chain(each.iter().map(mean));
    let numbers = numbers.map(|value| Cell::from(value.unwrap_or(f64::NAN)));
    std::iter::once(one.name.clone().into())
        .chain(numbers)
        .collect()
}

fn plate_sets(all: &[Found]) -> Table {
    let columns: Columns<'_> = &[
        ("sampler", "sampler", 0),
        ("set", "set", 3),
        ("samples", "samples", 9),
        ("side_pixels", "side, pixels", 5),
        ("empty_pixels", "empty pixels", 6),
        ("rmse", "RMSE", 6),
        ("rmse_below_nyquist", "RMSE below Nyquist", 6),
        ("rmse_above_nyquist", "RMSE above Nyquist", 6),
        ("signal_to_noise_db", "signal to noise, dB", 4),
    ];
    let groups = all.iter().flat_map(groups);
    let rows = groups.flat_map(|(name, plates)| {
        let row = move |plate: &Plated| {
            vec![
                name.clone().into(),
                plate.index.into(),
                plate.count.into(),
                plate.side.into(),
                plate.empty.into(),
                plate.rmse.into(),
                plate.below.into(),
                plate.above.into(),
                plate.signal_db.into(),
            ]
        };
        plates.iter().map(row).collect::<Vec<_>>()
    });
    let rows = rows.collect();
    table(
        ("zone-plate-sets", "Zone plates, each set"),
        columns,
        rows,
        false,
    )
}

fn plate_classes(all: &[Found]) -> Table {
    let columns: Columns<'_> = &[
        ("sampler", "sampler", 0),
        ("set", "set", 3),
        ("cycles_per_pixel", "local frequency, cycles per pixel", 3),
        ("rmse", "RMSE", 6),
    ];
    let groups = all.iter().flat_map(groups);
    let rows = groups.flat_map(|(name, plates)| {
        let rows = plates.iter().flat_map(|plate| {
            let row = |class: &[f64; 2]| {
                vec![
                    name.clone().into(),
                    plate.index.into(),
                    class[0].into(),
                    class[1].into(),
                ]
            };
            plate.classes.iter().map(row).collect::<Vec<_>>()
        });
        rows.collect::<Vec<Vec<Cell>>>()
    });
    let rows = rows.collect();
    table(
        ("zone-plate-frequencies", "Zone plates by local frequency"),
        columns,
        rows,
        false,
    )
}

fn horizon_sets(all: &[Found]) -> Table {
    let columns: Columns<'_> = &[
        ("sampler", "sampler", 0),
        ("samples_per_pixel", "samples per pixel", 4),
        ("set", "set", 3),
        ("samples", "samples", 9),
        ("rmse", "RMSE", 6),
        ("empty_share", "share of pixels without a sample", 4),
    ];
    let rows = all.iter().flat_map(|one| {
        let sets = one.horizons.iter().flatten();
        sets.map(|set| {
            vec![
                one.name.clone().into(),
                set.per_pixel.into(),
                set.index.into(),
                set.count.into(),
                set.rmse.into(),
                set.empty.into(),
            ]
        })
    });
    let rows = rows.collect();
    table(("horizon-sets", "Horizons, each set"), columns, rows, false)
}

fn power(all: &[Found]) -> Table {
    let columns: Columns<'_> = &[
        ("sampler", "sampler", 0),
        ("nu", "\u{3bd}", 4),
        ("power", "radial mean power", 4),
    ];
    let rows = all.iter().flat_map(|one| {
        let places = one.look.iter().flat_map(|look| &look.power);
        places.map(|[nu, power]| vec![one.name.clone().into(), (*nu).into(), (*power).into()])
    });
    let rows = rows.collect();
    table(("power", "Radial mean power"), columns, rows, false)
}
