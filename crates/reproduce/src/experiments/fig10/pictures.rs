//! The pictures: the figure as the paper has it, zone plates, their errors and horizons pixel by pixel.

use serde_json::{Value, json};
use tilescope_analysis::measures::Spectrum;
use tilescope_figures::Bitmap;
use tilescope_figures::chart::{Axis, Panel, TileChart, TileContent};

use super::curves;
use super::filter::{ERROR_SHOWN, shade};
use super::horizon::{self, Horizon, SHOWN};
use super::looks::{CELLS, LOW, MeanSpectrum};
use super::plate::{EDGE, NYQUIST, Plate};
use super::results::SamplerResults;
use crate::error::Result;
use crate::experiments::common::{picture, power_scale, tile, whole_ticks};
use crate::numbers::number;
use crate::outcome::Picture;
use crate::study::Settings;
use crate::texts::text;

/// Side of a tile of the whole figure: twice the cells of a spectrum.
const TILE: f64 = 2.0 * CELLS as f64;
/// Power that is black.
pub const BLACK: f64 = 3.0;
/// Powers below this are the transform's error.
const NOTHING: f64 = 1e-9;
/// Spectra whose edge differs from that of the axis by more than this share have a note that states it.
const OFF_AXIS: f64 = 0.02;
/// Side of the tile of a zone plate or a horizon.
const LARGE: f64 = 512.0;
/// Which of the shades of a plate are those of its image, and which those of its error.
const IMAGE: usize = 0;
const ERROR: usize = 1;

/// Returns the pictures; `corners` are about a thousand samples of each sampler.
pub fn pictures(
    all: &[SamplerResults],
    corners: &[Vec<[f64; 2]>],
    settings: &Settings,
) -> Result<Vec<Picture>> {
    // All plates have one size. Without any, one pixel stands for the exact image.
    let first = all.first().and_then(|one| one.plates.first());
    let plate = Plate {
        side: first.map_or(1, |one| one.side),
    };
    let exact = plate.exact();

    // The values of the captions.
    let of_plates = json!({ "side": plate.side, "edge": EDGE });
    let of_errors = json!({ "error": ERROR_SHOWN });
    let of_curves = json!({ "nyquist": NYQUIST });
    // The note of an image states its errors, and that of a picture of errors their parts below and above Nyquist.
    let plates = plate_tiles(all, IMAGE, "fig10/errors")?;
    let errors = plate_tiles(all, ERROR, "fig10/parts")?;

    // How many sets there are does not matter to a picture.
    let (board, _) = horizon::amounts(settings);

    // Frequencies grow to the right and upwards: tiles show the part with the lowest ones.
    let lower = true;
    Ok(vec![
        comparison(all, corners)?,
        sheet(
            "fig10/zone-plate",
            &of_plates,
            exact_tile(&exact, lower)?,
            plates,
        )?,
        sheet(
            "fig10/zone-plate-error",
            &of_errors,
            exact_tile(&exact, lower)?,
            errors,
        )?,
        horizons(all, board)?,
        picture("fig10/curves", &of_curves, curves::panels(all))?,
    ])
}

/// Returns the part of a square image that a tile of `side` pixels shows: the left part of its lower or upper rows, each pixel as
/// large as a whole number of the tile's.
fn shades(image: &[u8], side: f64, lower: bool) -> Result<TileContent> {
    let columns = image.len().isqrt();
    let pixel = (side / columns as f64).round().max(1.0);
    let kept = columns.min((side / pixel) as usize);
    let skipped = if lower { columns - kept } else { 0 };
    let lines = image.chunks(columns).skip(skipped).take(kept);
    let kept_shades = lines.flat_map(|line| &line[..kept]).copied();
    let bitmap = Bitmap::grey(kept, kept_shades.collect())?;
    Ok(TileContent::Pixels(bitmap))
}

/// Returns the figure as the paper has it: samples, spectrum, zone plate and horizon of each sampler.
fn comparison(all: &[SamplerResults], corners: &[Vec<[f64; 2]>]) -> Result<Picture> {
    // All spectra have the axis of the first, so that they can be compared.
    let reach = (all.first()).map_or(Spectrum::MAX_NU, |one| one.spectrum.reach);
    let (mut samples, mut spectra, mut plates, mut boards) = (vec![], vec![], vec![], vec![]);

    for (one, places) in all.iter().zip(corners) {
        let dots = TileContent::Dots(places.clone());
        let note = format!("{} samples", places.len());
        samples.push(tile(Some(TILE), one.sampler.name(), note, dots));
        spectra.push(spectrum_tile(&one.spectrum, reach)?);

        let plate = plate_content(one, IMAGE, TILE)?;
        plates.push(tile(Some(TILE), "", plate_note(one, "fig10/errors"), plate));
        let (note, board) = horizon_content(one, TILE)?;
        boards.push(tile(Some(TILE), "", note, board));
    }

    // The range serves the ticks of the spectra; the other axes have only their names.
    let axis = |name| Axis::new(name).with_range(-reach, reach);
    let tiles = [
        (axis("samples"), samples),
        (
            axis("power spectrum, \u{3bd}").with_ticks(whole_ticks(reach)),
            spectra,
        ),
        (axis("zone plate"), plates),
        (axis("horizon"), boards),
    ];

    let row = |(axis, mut row): (Axis, Vec<TileChart>)| -> Vec<Panel> {
        // The name of a row stands beside its first tile.
        if let Some(first) = row.first_mut() {
            first.y = Some(axis);
        }
        row.into_iter().map(Panel::Tile).collect()
    };

    // A scale takes no room in its row: the figure draws it beside the title. Any row could hold the scale of powers.
    let mut rows = tiles.map(row);
    rows[0].push(power_scale(BLACK));

    let first = all.first().and_then(|one| one.plates.first());
    let values = json!({
        "sets": all.iter().map(|one| one.spectrum.sets).max(), "nu": Spectrum::MAX_NU, "black": BLACK,
        "samples": first.map(|one| one.count), "shown": SHOWN,
    });
    picture("fig10/comparison", &values, rows.into())
}

/// Returns the text `id` on the first set's zone plate.
fn plate_note(one: &SamplerResults, id: &str) -> String {
    let first = one.plates.first();
    first.map_or_else(String::new, |plate| text(id, &json!(plate)))
}

/// The image of the first set, or its error; nothing where it has no shades.
fn plate_content(one: &SamplerResults, which: usize, side: f64) -> Result<TileContent> {
    let images = one.plates.first().and_then(|plate| plate.shades.as_ref());
    // The lower rows have the lowest frequencies, as in the exact tile.
    let lower = true;
    images.map_or(Ok(TileContent::Empty), |images| {
        shades(&images[which], side, lower)
    })
}

/// Returns the note below the image of the first set, and the image: the first that has shades, which is that of
/// [`SHOWN`] samples per pixel. Both are empty without one.
fn horizon_content(one: &SamplerResults, side: f64) -> Result<(String, TileContent)> {
    let first = one.horizons.iter().filter_map(|sets| sets.first());
    let mut images = first.filter_map(|set| Some((set.rmse, set.shades.as_deref()?)));
    let Some((rmse, image)) = images.next() else {
        return Ok((String::new(), TileContent::Empty));
    };
    let note = format!("RMSE {}", number(rmse, 3));
    // The upper rows have the sky and the horizon.
    let lower = false;
    Ok((note, shades(image, side, lower)?))
}

/// Returns the tile of a spectrum: no power is white, and [`BLACK`] and more are black. Its note states how far the
/// spectrum reaches, if that differs from the reach of the axis by more than `OFF_AXIS`.
fn spectrum_tile(spectrum: &MeanSpectrum, axis_reach: f64) -> Result<TileChart> {
    let mut note = if spectrum.low < NOTHING {
        format!("no power to \u{3bd} = {LOW}")
    } else {
        format!("power to \u{3bd} = {LOW}: {}", number(spectrum.low, 2))
    };

    if (spectrum.reach / axis_reach - 1.0).abs() > OFF_AXIS {
        note = format!("{note}; edge at \u{3bd} = {}", number(spectrum.reach, 3));
    }
    // Rows of the spectrum go upwards, those of a picture downwards. Shades are those of values from -1, black, to 1,
    // white.
    let powers = spectrum.picture.chunks(CELLS).rev().flatten();
    let image: Vec<u8> = powers
        .map(|power| shade(1.0 - 2.0 * power / BLACK))
        .collect();
    // The tile has room for all rows, so that both values of `lower` give the same tile.
    let lower = true;
    Ok(tile(Some(TILE), "", note, shades(&image, TILE, lower)?))
}

/// Returns the large tile of an exact image.
fn exact_tile(values: &[f64], lower: bool) -> Result<TileChart> {
    let image: Vec<u8> = values.iter().map(|value| shade(*value)).collect();
    let shown = shades(&image, LARGE, lower)?;
    Ok(tile(Some(LARGE), "exact", String::new(), shown))
}

/// Returns the picture of large tiles, two in a row, the exact image first.
fn sheet(id: &str, values: &Value, exact: TileChart, others: Vec<TileChart>) -> Result<Picture> {
    let tiles: Vec<Panel> = [exact].into_iter().chain(others).map(Panel::Tile).collect();
    picture(id, values, tiles.chunks(2).map(<[Panel]>::to_vec).collect())
}

/// The images of the zone plate, or their errors.
fn plate_tiles(all: &[SamplerResults], which: usize, note: &str) -> Result<Vec<TileChart>> {
    let each = all.iter().filter(|one| !one.plates.is_empty());
    each.map(|one| {
        let content = plate_content(one, which, LARGE)?;
        Ok(tile(
            Some(LARGE),
            one.sampler.name(),
            plate_note(one, note),
            content,
        ))
    })
    .collect()
}

fn horizons(all: &[SamplerResults], horizon: Horizon) -> Result<Picture> {
    let mut tiles = Vec::new();
    for one in all.iter().filter(|one| !one.horizons.is_empty()) {
        let (note, content) = horizon_content(one, LARGE)?;
        tiles.push(tile(Some(LARGE), one.sampler.name(), note, content));
    }
    let values = json!({ "side": horizon.side, "shown": SHOWN });
    // The same rows as in the other tiles.
    let lower = false;
    let exact = exact_tile(&horizon.exact(), lower)?;
    sheet("fig10/horizon", &values, exact, tiles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_that_does_not_fit_is_cut_off_on_the_right_and_above_or_below() {
        let image: Vec<u8> = (0..16).collect();
        let of = |side: i32, lower| match shades(&image, side.into(), lower).unwrap() {
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
