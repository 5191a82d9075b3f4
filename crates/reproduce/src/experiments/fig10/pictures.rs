//! The pictures: the figure as the paper has it, zone plates, their errors and horizons pixel by pixel.
//! It computes nothing but shades.

use super::curves;
use super::found::Found;
use super::horizon::{Horizon, SHOWN};
use super::looks::{CELLS, LOW};
use super::plate::{EDGE, NYQUIST, Plate};
use super::samplers::Sampler;
use super::shades::{ERROR_SHOWN, shade};
use super::sheet::{Content, Name, Sheet, Tile};
use crate::error::ReproduceError;
use crate::numbers::{count, number};
use crate::outcome::Picture;
use crate::study::Settings;
use tilescope_analysis::measures::Spectrum;

/// Side of a tile of the whole figure: twice the cells of a spectrum.
const TILE: f64 = 2.0 * CELLS as f64;
/// Power that is black.
pub const BLACK: f64 = 3.0;
/// Powers below this are the transform's error.
const NOTHING: f64 = 1e-9;
/// Spectra whose edge is further than this part from that of the axis have one of their own.
const OFF_AXIS: f64 = 0.02;
/// Side of a zone plate's tile.
const PLATE: f64 = 512.0;
/// Side of a horizon's tile.
const HORIZON: f64 = 512.0;
/// Files that have room in a picture.
const FILES: usize = 2;

/// Returns the pictures; `corners` are about a thousand samples of each sampler.
pub fn pictures(
    all: &[Found],
    corners: &[Vec<[f64; 2]>],
    settings: &Settings,
) -> Result<Vec<Picture>, ReproduceError> {
    let shown = all.len().min(Sampler::MADE.len() + FILES);
    let (all, corners) = (&all[..shown], &corners[..shown]);
    let plate = all.first().and_then(|one| one.plates.first());
    let plate = Plate {
        side: plate.map_or(1, |one| one.side),
    };
    Ok(vec![
        whole(all, corners)?,
        plates(all, plate)?,
        errors(all, plate)?,
        horizons(all, Horizon::of(settings))?,
        Picture {
            name: "curves".to_owned(),
            caption: format!(
                "Left: error of the zone plate by local frequency, a mean over sets; the image's Nyquist frequency is {NYQUIST}. Right: error \
                 of the horizon by samples per pixel, on logarithmic scales, with 95 % bands over sets. Below: radial mean power of the \
                 samples; that of a grid is a few peaks."
            ),
            scene: curves::scene(all)?,
        },
    ])
}

fn tile(heading: &str, note: String, content: Content) -> Tile {
    Tile {
        heading: heading.to_owned(),
        note,
        content,
    }
}

fn shades(columns: usize, shades: &[u8], lower: bool) -> Content {
    Content::Shades {
        columns,
        shades: shades.to_vec(),
        lower,
    }
}

/// Samples, spectrum, zone plate and horizon of each sampler, as in the paper.
fn whole(all: &[Found], corners: &[Vec<[f64; 2]>]) -> Result<Picture, ReproduceError> {
    let samples = all.iter().zip(corners).map(|(one, places)| {
        let note = format!("{} samples", places.len());
        tile(&one.name, note, Content::Samples(places.clone()))
    });
    let shown = reach(all);
    let spectra = all.iter().map(|one| spectrum(one, shown));
    let images = all
        .iter()
        .map(|one| tile("", error_note(one), plate(one, 0)));
    let boards = all.iter().map(|one| match shown_horizon(one) {
        None => tile("", String::new(), Content::Empty),
        Some((rmse, image)) => {
            let side = image.len().isqrt();
            let note = format!("RMSE {}", number(rmse, 3));
            tile("", note, shades(side, image, false))
        }
    });
    let sheet = Sheet {
        title: "Quality of integration".to_owned(),
        side: TILE,
        names: row_names(shown),
        ramp: Some(BLACK),
        rows: vec![
            samples.collect(),
            spectra.collect(),
            images.collect(),
            boards.collect(),
        ],
    };
    Ok(Picture {
        name: "comparison".to_owned(),
        caption: whole_caption(all),
        scene: sheet.scene()?,
    })
}

/// Returns how far the first spectrum reaches, as nu.
fn reach(all: &[Found]) -> f64 {
    let mut looks = all.iter().filter_map(|one| one.look.as_ref());
    looks.next().map_or(Spectrum::MAX_NU, |look| look.reach)
}

/// Names of the figure's rows, and the frequencies of the second.
fn row_names(reach: f64) -> Vec<Name> {
    let most = reach as i32;
    let tick = |nu: i32| {
        let label = nu.to_string().replace('-', "\u{2212}");
        (0.5 + 0.5 * f64::from(nu) / reach, label)
    };
    let name = |name: &str, ticks| Name {
        name: name.to_owned(),
        ticks,
    };
    vec![
        name("samples", Vec::new()),
        name(
            "power spectrum, \u{3bd}",
            (-most..=most).map(tick).collect(),
        ),
        name("zone plate", Vec::new()),
        name("horizon", Vec::new()),
    ]
}

fn whole_caption(all: &[Found]) -> String {
    let looks = all.iter().filter_map(|one| one.look.as_ref());
    let sets = looks.map(|look| look.sets).max().unwrap_or(0);
    let first = all.first().and_then(|one| one.plates.first());
    format!(
        "Rows: a part of a set; the mean power spectrum of up to {sets} sets to \u{3bd} = {}, white 0, black {BLACK} and above; the lower \
         left part of the zone plate from {} samples, Gaussian filter; a horizon at {SHOWN} samples per pixel, mean of each pixel. RMSE \
         is that of the whole image from the first set, the one shown; SNR is the exact image's mean square over that of the error. The tables \
         have means over sets.",
        Spectrum::MAX_NU,
        first.map_or_else(String::new, |one| count(one.count as u64))
    )
}

fn error_note(one: &Found) -> String {
    let first = one.plates.first();
    first.map_or_else(String::new, |plate| {
        format!(
            "RMSE {}, SNR {} dB",
            number(plate.rmse, 3),
            number(plate.signal_db, 3)
        )
    })
}

/// The image of the first set, or its error.
fn plate(one: &Found, which: usize) -> Content {
    let first = one.plates.first();
    let images = first.and_then(|plate| Some((plate.side, plate.shades.as_ref()?)));
    images.map_or(Content::Empty, |(side, images)| {
        shades(side, &images[which], true)
    })
}

fn shown_horizon(one: &Found) -> Option<(f64, &[u8])> {
    let first = one.horizons.iter().filter_map(|sets| sets.first());
    let mut images = first.filter_map(|set| Some((set.rmse, set.shades.as_deref()?)));
    images.next()
}

/// A spectrum, low powers white; it says so if it does not reach as far as the axis.
fn spectrum(one: &Found, shown: f64) -> Tile {
    let Some(look) = &one.look else {
        return tile("", String::new(), Content::Empty);
    };
    let mut note = if look.low < NOTHING {
        format!("no power to \u{3bd} = {LOW}")
    } else {
        format!("power to \u{3bd} = {LOW}: {}", number(look.low, 2))
    };
    if (look.reach / shown - 1.0).abs() > OFF_AXIS {
        note = format!("{note}; edge at \u{3bd} = {}", number(look.reach, 3));
    }
    let powers = look.picture.chunks(CELLS).rev().flatten();
    let shades = powers.map(|power| shade(1.0 - 2.0 * power / BLACK));
    let content = Content::Shades {
        columns: CELLS,
        shades: shades.collect(),
        lower: true,
    };
    tile("", note, content)
}

fn rows(tiles: Vec<Tile>, along: usize) -> Vec<Vec<Tile>> {
    let mut rows = Vec::new();
    for (index, tile) in tiles.into_iter().enumerate() {
        if index % along == 0 {
            rows.push(Vec::new());
        }
        let last = rows.len() - 1;
        rows[last].push(tile);
    }
    rows
}

fn exact(size: Plate) -> Tile {
    let exact: Vec<u8> = size.exact().iter().map(|v| shade(*v)).collect();
    tile("exact", String::new(), shades(size.side, &exact, true))
}

fn plates(all: &[Found], size: Plate) -> Result<Picture, ReproduceError> {
    let each = all.iter().filter(|one| !one.plates.is_empty());
    let each = each.map(|one| tile(&one.name, error_note(one), plate(one, 0)));
    let sheet = Sheet {
        title: "Zone plate sin(x\u{b2} + y\u{b2})".to_owned(),
        side: PLATE,
        names: Vec::new(),
        ramp: None,
        rows: rows(std::iter::once(exact(size)).chain(each).collect(), 2),
    };
    Ok(Picture {
        name: "zone-plate".to_owned(),
        caption: format!(
            "The zone plate about the lower left corner, {0} \u{d7} {0} pixels, whose local frequency reaches {EDGE} cycles per pixel at the \
             right and upper edge. The exact image is grey where a pixel sees several rings, but for the hundredth that the Gaussian \
             lets through about 1 cycle per pixel: what else is seen there is aliasing, or noise. Images and RMSE are those of the first set.",
            size.side
        ),
        scene: sheet.scene()?,
    })
}

fn errors(all: &[Found], size: Plate) -> Result<Picture, ReproduceError> {
    let each = all.iter().filter(|one| !one.plates.is_empty());
    let note = |one: &Found| {
        let first = one.plates.first();
        first.map_or_else(String::new, |plate| {
            format!(
                "RMSE {} below Nyquist, {} above",
                number(plate.below, 3),
                number(plate.above, 3)
            )
        })
    };
    let each = each.map(|one| tile(&one.name, note(one), plate(one, 1)));
    let sheet = Sheet {
        title: "Zone plate: difference from the exact image".to_owned(),
        side: PLATE,
        names: Vec::new(),
        ramp: None,
        rows: rows(std::iter::once(exact(size)).chain(each).collect(), 2),
    };
    Ok(Picture {
        name: "zone-plate-error".to_owned(),
        caption: format!(
            "The exact zone plate, and what is too dark and too bright in the others: grey is right, black \u{2212}{ERROR_SHOWN}, white {ERROR_SHOWN}. \
             First set."
        ),
        scene: sheet.scene()?,
    })
}

fn horizons(all: &[Found], horizon: Horizon) -> Result<Picture, ReproduceError> {
    let exact: Vec<u8> = horizon.exact().iter().map(|v| shade(*v)).collect();
    let exact = tile("exact", String::new(), shades(horizon.side, &exact, false));
    let each = all.iter().filter_map(|one| {
        let (rmse, image) = shown_horizon(one)?;
        let note = format!("RMSE {}", number(rmse, 3));
        Some(tile(&one.name, note, shades(horizon.side, image, false)))
    });
    let sheet = Sheet {
        title: format!("Horizon at {SHOWN} samples per pixel"),
        side: HORIZON,
        names: Vec::new(),
        ramp: None,
        rows: rows(std::iter::once(exact).chain(each).collect(), 2),
    };
    Ok(Picture {
        name: "horizon".to_owned(),
        caption: format!(
            "A checkerboard up to its horizon, {0} \u{d7} {0} pixels: exact means, and means of {SHOWN} samples per pixel. First set.",
            horizon.side
        ),
        scene: sheet.scene()?,
    })
}
