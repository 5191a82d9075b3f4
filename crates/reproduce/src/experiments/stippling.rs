//! Stipples beside other ways to place as many dots: weighted Voronoi stippling, error diffusion, and independent dots.

mod claims;
mod images;
mod methods;
mod quality;
mod shown;

use std::time::Instant;

use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::error::Result;
use crate::outcome::Outcome;
use crate::study::{Settings, Study};
use crate::texts::text;
use images::{Darkness, StippledImage};
use methods::{DotMethod, LLOYD_STEPS};
use quality::Quality;

/// What a method made of an image.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Stippled {
    /// The dots, in pixels of the image, y upwards.
    dots: Vec<[f64; 2]>,
    quality: Quality,
    /// Seconds on this machine.
    seconds: f64,
}

/// What all methods made of an image, in their sequence.
#[derive(Clone, Debug)]
struct ComparedImage {
    subject: StippledImage,
    dark: Darkness,
    by_method: Vec<Stippled>,
}

/// Returns pixels along a side of the images, and dots.
fn amounts(settings: &Settings) -> (usize, usize) {
    settings.pick((384, 10_000), (192, 2000))
}

pub fn units(_: &Settings) -> usize {
    StippledImage::ALL.len() * DotMethod::ALL.len()
}

/// Makes the dots of all methods for all images, a unit each, and compares them.
pub fn run(study: &Study<'_>) -> Result<Outcome> {
    let (side, dots) = amounts(study.settings);
    let all = StippledImage::ALL
        .into_iter()
        .map(|subject| compared(study, subject));
    let all = all.collect::<Result<Vec<ComparedImage>>>()?;

    // The notes say the same of every image.
    let values = json!({ "side": side, "dots": dots, "steps": LLOYD_STEPS });
    Ok(Outcome {
        claims: claims::claims(&all),
        pictures: vec![shown::picture_of(&all)?],
        tables: shown::tables(&all),
        notes: vec![
            text("stippling/how", &values),
            text("stippling/wins", &values),
        ],
    })
}

/// Makes the dots of all methods for an image, a unit each, and measures how well they show it.
fn compared(study: &Study<'_>, subject: StippledImage) -> Result<ComparedImage> {
    let (side, dots) = amounts(study.settings);
    let (image, seed) = (subject.image(side)?, study.settings.seed);
    let dark = Darkness::of(&image);

    let units = DotMethod::ALL.into_iter().map(|method| {
        let key = format!("{}-{}", subject.name(), method.name().replace(' ', "-"));
        let what = format!("{}, {}", subject.name(), method.name());
        study.unit(&key, &what, |control| {
            // The dots alone are timed, neither the judge nor the measures.
            let began = Instant::now();
            let placed = method.dots(&image, &dark, dots, seed, control)?;
            let seconds = began.elapsed().as_secs_f64();
            // Other methods promise nothing that could be judged.
            if method == DotMethod::Stipple {
                methods::check(&image, dots, seed, control)?;
            }
            let quality = Quality::of(&dark, &placed);
            Ok(Stippled {
                dots: placed,
                quality,
                seconds,
            })
        })
    });
    let by_method = units.collect::<Result<Vec<Stippled>>>()?;
    Ok(ComparedImage {
        subject,
        dark,
        by_method,
    })
}

#[cfg(test)]
mod tests;
