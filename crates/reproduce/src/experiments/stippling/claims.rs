//! Verdicts on stipples beside other methods, also on where the others are better.

use serde_json::{Value, json};

use super::methods::DotMethod;
use super::quality::BLURS;
use super::{ComparedImage, StippledImage};
use crate::experiments::common::ends;
use crate::outcome::{Claim, Verdict};
use crate::rule::Rule;
use crate::texts::claim;

/// Errors closer than this, in decibels, are equal: stipples of other seeds differ by as much. Chosen, not measured.
const EQUAL: f64 = 0.3;
/// The same of the tones that are farthest off.
const EQUAL_TONE: f64 = 0.01;

/// Returns all claims.
pub fn claims(all: &[ComparedImage]) -> Vec<Claim> {
    let any = |_: StippledImage| true;
    let (stipple, voronoi) = (DotMethod::Stipple, DotMethod::Voronoi);

    // The claim says that the first method of a pair is better, at the blurs that are listed: the two coarsest, the finest, all
    // but the finest, or all.
    vec![
        by_errors(
            "stippling/coarse",
            all,
            [stipple, voronoi],
            &BLURS[2..],
            any,
        ),
        tones(all),
        by_errors(
            "stippling/fine",
            all,
            [voronoi, stipple],
            &BLURS[..1],
            |subject| {
                // Letters are narrower than the distance of dots, so that at this blur no method shows their tone. The
                // other claims about errors begin at a coarser blur, or are the control, which is to hold for all
                // images.
                subject != StippledImage::Text
            },
        ),
        by_errors(
            "stippling/diffusion",
            all,
            [DotMethod::Diffusion, stipple],
            &BLURS[1..],
            any,
        ),
        by_errors(
            "stippling/random",
            all,
            [stipple, DotMethod::Random],
            &BLURS,
            any,
        ),
    ]
}

impl ComparedImage {
    /// Returns how much less error the first method has than the second at a blur, in decibels.
    fn gain(&self, [better, other]: [DotMethod; 2], blur: usize) -> f64 {
        let of = |method: DotMethod| {
            // `ALL` has every method, so that 0 never stands in.
            let index = DotMethod::ALL
                .iter()
                .position(|&one| one == method)
                .unwrap_or(0);
            self.by_method[index].quality.blurs[blur]
        };
        of(better) - of(other)
    }
}

/// Judges whether the first of two methods has less error than the second, on all these images and at all these blurs.
fn by_errors(
    id: &str,
    all: &[ComparedImage],
    methods: [DotMethod; 2],
    blurs: &[f64],
    is_judged: impl Fn(StippledImage) -> bool,
) -> Claim {
    let judged_blurs = (0..BLURS.len()).filter(|&index| blurs.contains(&BLURS[index]));
    // A case is an image at a blur: the claim holds if it holds in all cases.
    let judged = all.iter().filter(|one| is_judged(one.subject));
    let gains = judged.flat_map(|one| {
        judged_blurs
            .clone()
            .map(move |blur| one.gain(methods, blur))
    });
    let gains: Vec<f64> = gains.collect();

    let verdicts = gains
        .iter()
        .map(|&gain| Rule::Above(0.0).verdict(Some([gain - EQUAL, gain + EQUAL])));
    let [low, high] = ends(gains.iter().copied());
    let values = json!({ "low": low, "high": high, "equal": EQUAL, "cases": gains.len() });
    claim(id, Verdict::of_all(verdicts), &values)
}

/// Judges whether stipples have less wrong tones than weighted Voronoi stippling, on all images.
fn tones(all: &[ComparedImage]) -> Claim {
    // The methods begin with stipples and weighted Voronoi stippling.
    let worst =
        |one: &ComparedImage| [0, 1].map(|method| one.by_method[method].quality.worst_tone());
    let verdicts = all.iter().map(|one| {
        let [stipple, voronoi] = worst(one);
        let gain = voronoi - stipple;
        Rule::Above(0.0).verdict(Some([gain - EQUAL_TONE, gain + EQUAL_TONE]))
    });
    let verdict = Verdict::of_all(verdicts);
    let each: Vec<Value> = all.iter().map(|one| json!(worst(one))).collect();
    claim(
        "stippling/tones",
        verdict,
        &json!({ "each": each, "equal": EQUAL_TONE }),
    )
}
