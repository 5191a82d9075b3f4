//! The pictures: the figure as the paper has it, zone plates, their errors and horizons pixel by pixel.

use tilescope_analysis::measures::Spectrum;
use tilescope_figures::Bitmap;
use tilescope_figures::chart::{Axis, Panel, TileChart, TileContent};

use super::curves;
use super::horizon::{Horizon, SHOWN};
use super::looks::{CELLS, LOW, MeanSpectrum};
use super::plate::{EDGE, NYQUIST, Plate, PlateErrors};
use super::results::SamplerResults;
use super::shades::{ERROR_SHOWN, shade};
use crate::error::ReproduceError;
use crate::experiments::common::{picture, power_scale};
use crate::numbers::{count, number};
use crate::outcome::Picture;
use crate::study::Settings;

/// Side of a tile of the whole figure: twice the cells of a spectrum.
const TILE: usize = 2 * CELLS;
/// Power that is black.
pub const BLACK: f64 = 3.0;
/// Powers below this are the transform's error.
const NOTHING: f64 = 1e-9;
/// Spectra whose edge is further than this part from that of the axis have one of their own.
const OFF_AXIS: f64 = 0.02;
/// Side of the tile of a zone plate or a horizon.
const LARGE: usize = 512;

/// Returns the pictures; `corners` are about a thousand samples of each sampler.
pub fn pictures(
    all: &[SamplerResults],
    corners: &[Vec<[f64; 2]>],
    settings: &Settings,
) -> Result<Vec<Picture>, ReproduceError> {
    let plate = all.first().and_then(|one| one.plates.first());
    let plate = Plate {
        side: plate.map_or(1, |one| one.side),
    };
    let caption = format!(
        "Left: error of the zone plate by local frequency, a mean over sets; the image's Nyquist frequency is {NYQUIST}. Right: error \
         of the horizon by samples per pixel, on logarithmic scales, with 95 % bands over sets. Below: radial mean power of the \
         samples; that of a grid is a few peaks."
    );
    let title = "Error by frequency and by number of samples, and power";
    Ok(vec![
        comparison(all, corners)?,
        plates(all, plate)?,
        errors(all, plate)?,
        horizons(all, Horizon::of(settings))?,
        picture("curves", title, caption, curves::panels(all))?,
    ])
}

fn tile(side: usize, title: &str, note: String, content: TileContent) -> TileChart {
    TileChart {
        title: title.to_owned(),
        note,
        y: None,
        side: Some(side as f64),
        content,
    }
}

/// A square image; the part that a tile of `side` pixels shows, with pixels as large as a whole number: its left part, and the lower
/// or the upper one.
fn shades(image: &[u8], side: usize, lower: bool) -> Result<TileContent, ReproduceError> {
    let columns = image.len().isqrt();
    let pixel = (side as f64 / columns as f64).round().max(1.0) as usize;
    let kept = columns.min(side / pixel);
    let skipped = if lower { columns - kept } else { 0 };
    let lines = image.chunks(columns).skip(skipped).take(kept);
    let kept_shades = lines.flat_map(|line| &line[..kept]).copied();
    let bitmap = Bitmap::grey(kept, kept_shades.collect())?;
    Ok(TileContent::Pixels(bitmap))
}

/// Samples, spectrum, zone plate and horizon of each sampler, as in the paper.
fn comparison(
    all: &[SamplerResults],
    corners: &[Vec<[f64; 2]>],
) -> Result<Picture, ReproduceError> {
    let reach = (all.first()).map_or(Spectrum::MAX_NU, |one| one.spectrum.reach);
    let (mut samples, mut spectra, mut plates, mut boards) = (vec![], vec![], vec![], vec![]);
    for (one, places) in all.iter().zip(corners) {
        let dots = TileContent::Dots(places.clone());
        let note = format!("{} samples", places.len());
        samples.push(tile(TILE, one.sampler.name(), note, dots));
        spectra.push(spectrum(&one.spectrum, reach)?);
        let plate = plate_content(one, 0, TILE)?;
        plates.push(tile(TILE, "", plate_note(one, error_words), plate));
        let (note, board) = horizon_content(one, TILE)?;
        boards.push(tile(TILE, "", note, board));
    }
    let names = [
        "samples",
        "power spectrum, \u{3bd}",
        "zone plate",
        "horizon",
    ];
    let mut rows = Vec::new();
    for (name, mut row) in names.into_iter().zip([samples, spectra, plates, boards]) {
        let axis = Axis::new(name).with_range(-reach, reach);
        if let Some(first) = row.first_mut() {
            let ticked = name.starts_with("power");
            first.y = Some(if ticked {
                axis.with_ticks(whole(reach))
            } else {
                axis
            });
        }
        rows.push(row.into_iter().map(Panel::Tile).collect::<Vec<_>>());
    }
    rows[0].push(power_scale(BLACK));
    picture("comparison", "Quality of integration", caption(all), rows)
}

/// Ticks at whole numbers.
fn whole(reach: f64) -> Vec<(f64, String)> {
    let most = reach as i32;
    let label = |value: i32| value.to_string().replace('-', "\u{2212}");
    (-most..=most)
        .map(|value| (f64::from(value), label(value)))
        .collect()
}

fn caption(all: &[SamplerResults]) -> String {
    let sets = all.iter().map(|one| one.spectrum.sets).max().unwrap_or(0);
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

fn error_words(plate: &PlateErrors) -> String {
    let [rmse, signal] = [plate.rmse, plate.signal_db].map(|value| number(value, 3));
    format!("RMSE {rmse}, SNR {signal} dB")
}

fn parts_words(plate: &PlateErrors) -> String {
    let [below, above] = [plate.below, plate.above].map(|value| number(value, 3));
    format!("RMSE {below} below Nyquist, {above} above")
}

fn plate_note(one: &SamplerResults, words: fn(&PlateErrors) -> String) -> String {
    one.plates.first().map_or_else(String::new, words)
}

/// The image of the first set, or its error.
fn plate_content(
    one: &SamplerResults,
    which: usize,
    side: usize,
) -> Result<TileContent, ReproduceError> {
    let images = one.plates.first().and_then(|plate| plate.shades.as_ref());
    images.map_or(Ok(TileContent::Empty), |images| {
        shades(&images[which], side, true)
    })
}

/// The image of the first set, and what is written below it.
fn horizon_content(
    one: &SamplerResults,
    side: usize,
) -> Result<(String, TileContent), ReproduceError> {
    let first = one.horizons.iter().filter_map(|sets| sets.first());
    let mut images = first.filter_map(|set| Some((set.rmse, set.shades.as_deref()?)));
    let Some((rmse, image)) = images.next() else {
        return Ok((String::new(), TileContent::Empty));
    };
    let note = format!("RMSE {}", number(rmse, 3));
    Ok((note, shades(image, side, false)?))
}

/// A spectrum, low powers white; it says so if it does not reach as far as the axis.
fn spectrum(spectrum: &MeanSpectrum, shown: f64) -> Result<TileChart, ReproduceError> {
    let mut note = if spectrum.low < NOTHING {
        format!("no power to \u{3bd} = {LOW}")
    } else {
        format!("power to \u{3bd} = {LOW}: {}", number(spectrum.low, 2))
    };
    if (spectrum.reach / shown - 1.0).abs() > OFF_AXIS {
        note = format!("{note}; edge at \u{3bd} = {}", number(spectrum.reach, 3));
    }
    let powers = spectrum.picture.chunks(CELLS).rev().flatten();
    let image: Vec<u8> = powers
        .map(|power| shade(1.0 - 2.0 * power / BLACK))
        .collect();
    Ok(tile(TILE, "", note, shades(&image, TILE, true)?))
}

/// Returns the picture of large tiles, two in a row, the exact image first.
fn sheet(
    [name, title]: [&str; 2],
    caption: String,
    (exact, lower): (&[f64], bool),
    others: Vec<TileChart>,
) -> Result<Picture, ReproduceError> {
    let exact: Vec<u8> = exact.iter().map(|value| shade(*value)).collect();
    let exact = tile(LARGE, "exact", String::new(), shades(&exact, LARGE, lower)?);
    let tiles: Vec<Panel> = std::iter::once(exact)
        .chain(others)
        .map(Panel::Tile)
        .collect();
    let rows = tiles.chunks(2).map(<[Panel]>::to_vec).collect();
    picture(name, title, caption, rows)
}

/// The images of the zone plate, or their errors.
fn plate_tiles(
    all: &[SamplerResults],
    which: usize,
    words: fn(&PlateErrors) -> String,
) -> Result<Vec<TileChart>, ReproduceError> {
    let each = all.iter().filter(|one| !one.plates.is_empty());
    each.map(|one| {
        let content = plate_content(one, which, LARGE)?;
        Ok(tile(
            LARGE,
            one.sampler.name(),
            plate_note(one, words),
            content,
        ))
    })
    .collect()
}

fn plates(all: &[SamplerResults], size: Plate) -> Result<Picture, ReproduceError> {
    let caption = format!(
        "The zone plate about the lower left corner, {0} \u{d7} {0} pixels, whose local frequency reaches {EDGE} cycles per pixel at the \
         right and upper edge. The exact image is grey where a pixel sees several rings, but for the hundredth that the Gaussian \
         lets through about 1 cycle per pixel: what else is seen there is aliasing, or noise. Images and RMSE are those of the first set.",
        size.side
    );
    let names = ["zone-plate", "Zone plate sin(x\u{b2} + y\u{b2})"];
    sheet(
        names,
        caption,
        (&size.exact(), true),
        plate_tiles(all, 0, error_words)?,
    )
}

fn errors(all: &[SamplerResults], size: Plate) -> Result<Picture, ReproduceError> {
    let caption = format!(
        "The exact zone plate, and what is too dark and too bright in the others: grey is right, black \u{2212}{ERROR_SHOWN}, white {ERROR_SHOWN}. \
         First set."
    );
    let names = [
        "zone-plate-error",
        "Zone plate: difference from the exact image",
    ];
    sheet(
        names,
        caption,
        (&size.exact(), true),
        plate_tiles(all, 1, parts_words)?,
    )
}

fn horizons(all: &[SamplerResults], horizon: Horizon) -> Result<Picture, ReproduceError> {
    let mut tiles = Vec::new();
    for one in all.iter().filter(|one| !one.horizons.is_empty()) {
        let (note, content) = horizon_content(one, LARGE)?;
        tiles.push(tile(LARGE, one.sampler.name(), note, content));
    }
    let caption = format!(
        "A checkerboard up to its horizon, {0} \u{d7} {0} pixels: exact means, and means of {SHOWN} samples per pixel. First set.",
        horizon.side
    );
    let title = format!("Horizon at {SHOWN} samples per pixel");
    sheet(
        ["horizon", &title],
        caption,
        (&horizon.exact(), false),
        tiles,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_that_does_not_fit_is_cut_off_on_the_right_and_above_or_below() {
        let image: Vec<u8> = (0..16).collect();
        let of = |side, lower| match shades(&image, side, lower).unwrap() {
            TileContent::Pixels(bitmap) => bitmap,
            _ => panic!("no pixels"),
        };
        let grey = |columns, shades: Vec<u8>| Bitmap::grey(columns, shades).unwrap();
        assert_eq!(of(2, true), grey(2, vec![8, 9, 12, 13]));
        assert_eq!(of(2, false), grey(2, vec![0, 1, 4, 5]));
        assert_eq!(of(4, true), grey(4, image.clone()));
        assert_eq!(of(8, true), grey(4, image.clone()));
        // Twice the size shows less than the whole, once would leave half the tile empty.
        assert_eq!(of(6, true).size(), [3, 3]);
    }
}
