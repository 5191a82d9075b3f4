//! Pins the definition of the points: these digests must never change, on any machine, engine, thread count or browser.
//! If one changes, the program computes other points.

use crate::support::pinned::{PINNED, cases};
use crate::support::{digest, run};
use tilescope_core::{Parameters, Unobserved, reference_sample};

#[test]
fn results_have_their_pinned_digests() {
    let mut found: Vec<(&str, String)> = cases()
        .iter()
        .map(|(name, p)| (*name, digest(&run(p).points())))
        .collect();
    let domain = Parameters::default().validate().unwrap();
    let reference = reference_sample(domain, 1, &mut Unobserved).unwrap();
    found.push(("reference", digest(&reference)));
    let found: Vec<(&str, &str)> = found.iter().map(|(n, d)| (*n, d.as_str())).collect();
    assert_eq!(found, PINNED);
}
