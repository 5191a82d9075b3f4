//! The terms of the program, each defined once. The window's explanations read them, and the glossary of `crates/README.md` is
//! generated from them. Nothing here needs a session.

use tilescope_analysis::measures::{CATALOGUE, SetNumber};

/// A term and what it means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Term {
    /// The term as it is written within a sentence.
    pub name: &'static str,
    /// Its meaning, in one or two sentences.
    pub meaning: &'static str,
    /// Where the paper introduces it (Wang and Suda, HPG 2017); empty where the paper has no such term.
    pub paper: &'static str,
}

macro_rules! glossary {
    ($($constant:ident, $name:literal, $paper:literal, $meaning:literal;)*) => {
        $(
            #[doc = $meaning]
            pub const $constant: Term = Term { name: $name, meaning: $meaning, paper: $paper };
        )*

        /// The terms but the numbers of a set, from the points to the program around them.
        const OWN: &[Term] = &[$($constant),*];
    };
}

glossary! {
    SAMPLE, "sample", "3.1.1", "A point of the set that is made.";
    DOMAIN, "domain", "3.1.1", "The rectangle that the set fills.";
    PERIODIC, "periodic", "", "Opposite sides of the rectangle are joined, as on a torus.";
    BOUNDED, "bounded", "", "The rectangle ends at its border: distances do not reach across it.";
    RADIUS, "radius r", "3.1.1", "The smallest distance allowed between two samples, and the largest allowed from any place to its nearest sample.";
    DISK, "disk", "3.1.1", "The circle of radius r around a sample: no other sample may lie in it.";
    CONFLICT, "conflict", "3.2", "A pair of samples closer than r.";
    GAP, "gap", "3.2.1", "An area that no sample covers: every place in it is farther than r from all samples.";
    MAXIMAL, "maximal", "3.1.1", "Without gaps: no sample can be added without a conflict.";
    VALID, "valid", "", "Conflict-free and maximal, as the verifier decides it.";
    LATTICE, "lattice", "", "The integer positions on which all samples lie: r is 2^15 units.";

    PATTERN, "pattern", "3.1.2", "A small maximal set, made once, from which every block takes its samples.";
    KD_TREE, "KD-tree", "3.1.2", "The random splits, in x and y by turns, that cut the domain into blocks.";
    LEAF, "leaf", "3.1.1", "The shortest edge that a block may have, in r.";
    BLOCK, "block", "3.1.2", "A leaf of the random KD-tree: a rectangle of the domain that is tiled as one. The paper says building block.";
    CLIP, "clip", "3.1.2", "The part of the pattern that a block receives: the block enlarged by r on every side, laid at a random position of the pattern.";
    MARGIN, "margin", "3", "The strip of width r around a block in which its clip overlaps the neighbours.";
    TILING, "tiling", "3.1.3", "The stage in which every block receives its clip.";
    SEAM, "seam", "4.2", "A line along which two clips meet, or two sets of a combination. Conflicts and gaps arise near it.";
    COMBINATION, "combination", "4.2", "Maximal sets side by side in the rectangles of a layout, made one by elimination and insertion along their seams.";
    PIECE, "piece", "4.2", "One of the sets of a combination.";
    LEVEL, "level", "", "One of several nested sets: it is maximal for its own radius and has all samples of the level before, whose radius is larger by the root of 2.";
    PREFIX, "prefix", "", "The first samples of a set, however many, in the order of its file. With nested levels every prefix is evenly spread.";
    RANK, "rank", "", "A number from 0 to below 1 that each sample of nested levels has, in their order. The samples with ranks below a number, or below a density that depends on the place, are evenly spread.";

    ELIMINATION, "elimination", "3.2.2", "The stage that resolves conflicts: samples claim their disks in an order, and a later sample in a claimed disk goes.";
    UNDECIDED, "undecided", "", "A tiled sample whose turn in elimination has not come.";
    KEPT, "kept", "", "A sample that claimed its disk, or was inserted: it is in the result.";
    ELIMINATED, "eliminated", "3.2.2", "A sample that was removed because one that came before it in the order lies closer than r.";
    ORDER, "order", "", "The order in which tiled samples claim their disks.";
    DETECTOR, "detector", "3.2.1", "A sample that looks for gaps around itself, because a sample near it was eliminated or inserted.";
    SEARCH, "search", "3.2.2", "What one detector does: it takes the samples within its reach and tests the circumcentres that it forms with any two of them.";
    REACH, "reach", "3.2.2", "How far a detector looks: 4 r, or 7 r near the border of a bounded domain; 2 r as an experiment.";
    CANDIDATE, "candidate", "3.2.1", "A place that no sample covers, where one may be inserted: an uncovered circumcentre, a point of the border, or a dart.";
    SITES, "sites", "", "The samples that make a candidate: the three on its circle, or two and the border.";
    INSERTION, "insertion", "3.2.2", "The stage that puts samples into gaps, at candidates that do not conflict with each other.";
    INSERTED, "inserted", "3.2.2", "A sample that was put into a gap, rather than tiled.";
    ITERATION, "iteration", "3.2.3", "One round of detection and insertion. Rounds go on until no detector finds a gap.";
    DART, "dart", "", "A random place that becomes a sample if nothing covers it. Uniform insertion and the reference sampler throw darts.";
    ARRIVAL, "arrival", "", "The turn of a dart among all darts: by how often its cell was cut, by its throw and its number in that throw, then by its place in the pattern. What arrives first stays.";
    FIRST_BLOCKER, "first blocker", "", "The earliest sample that covers a refused dart. While it is there, the dart stays refused.";
    WOKEN, "woken", "", "Said of a refused dart of exact tiling that arrives once more, as its first blocker was lost, or lies outside of its block or of the shape.";
    AS_PRINTED, "as printed", "3.2.2", "Algorithm 4 exactly as the paper prints it: elimination and the first insertion take turns sample by sample.";
    STAGED, "staged", "", "The arrangement used otherwise: all elimination comes before all insertion, so that every stage can run in parallel.";
    REFERENCE_SAMPLER, "reference sampler", "4.1.3", "Maximal Poisson-disk sampling from scratch by dart throwing (Ebeida and others, 2012). It makes the patterns, and sets to compare with.";
    EXACT_TILING, "exact tiling", "", "Tiling of all darts of a pattern with their order of arrival: a dart is a sample unless an earlier sample covers it. Seams have no bias.";

    STAGE, "stage", "", "A step of a run: pattern, blocks, tile, eliminate, iterate 1 and so on, finish.";
    RUN, "run", "", "Everything that was made from one set of parameters, stage by stage.";
    ENGINE, "engine", "", "An implementation of the stages: sequential, parallel or GPU. All give the same points.";
    WINDOW, "window (of the plane)", "", "A rectangle of the domain that is computed by itself, from the blocks around it.";
    HALO, "halo", "", "The cells around a window that are computed with it, so that the samples within do not depend on what lies farther out.";
    UNSURE, "unsure", "", "Said of a cell whose samples may depend on what lies beyond the halo. It is computed again with a wider one.";
    PASS, "pass", "", "One compute shader run over all of its elements on the GPU.";
    KEY, "key", "", "What a random number is drawn for: the seed, the purpose and the number of the block, cell or candidate. There is no generator state.";
    DIGEST, "digest", "", "A hash of all positions: equal digests mean equal points, bit for bit.";

    EVENT, "event", "", "One step of a recorded run: a split, a clip, a comparison, a test of a place, an insertion.";
    RECORDING, "recording", "", "A run with all of its events.";
    CURSOR, "cursor", "", "The number of events that have happened at the current moment.";
    MOMENT, "moment", "", "The state of a run after some of its events, or after a stage where no events were kept.";
    SESSION, "session", "", "A run to look at, with its verdict. A saved session also has breakpoints, scenes and the view.";
    SCENE, "scene", "", "A moment to show, with its camera, layers and caption. The tour is made of scenes.";
    TASK, "task", "", "Work in the background on plain data: a thread natively, a worker on a page.";
    CERTIFICATE, "certificate", "", "The file beside an exported set: parameters, verdict and digest of what was written.";
    WITNESS, "witness", "", "What proves a verdict: the closest pair, the largest empty circle, a conflict, the centre of a gap.";
    OPEN_PLACE, "open place", "", "The centre of an empty circle larger than r: a gap has one or more.";

    BLUE_NOISE, "blue noise", "1", "A set without low frequencies and without a preferred direction, as a maximal Poisson-disk set is.";
    PERIODOGRAM, "periodogram", "4.1.3", "The power of a set at each frequency; 1 is that of independent random samples.";
    RADIAL_MEAN, "radial mean", "4.1.3", "The mean power in rings of equal frequency.";
    ANISOTROPY, "anisotropy", "", "How much the power varies within a ring of frequencies: large where a direction is preferred.";
    PAIR_CORRELATION, "g(r)", "", "The pair correlation: pairs of samples at a distance, relative to those of independent random samples.";
    DELAUNAY, "Delaunay triangles", "3.2.1", "The triangles of three samples whose circumcircle holds no other sample.";
    VORONOI, "Voronoi cell", "", "The places that are nearer to one sample than to any other.";
    COVERED_CIRCLE, "covered circle", "", "The circle of radius r around a sample, if other disks cover all of it: the set is maximal when every circle is covered. An exposed arc is a part of a circle that no other disk covers, the border of a gap.";
    CIRCUMCIRCLE, "empty circle", "3.2.1", "A circle through three samples with no sample inside. One that is larger than r proves a gap.";
}

/// Returns every term: those above, and the numbers of a set by the catalogue that all tables read.
pub fn terms() -> impl Iterator<Item = Term> {
    let numbers = CATALOGUE.iter().filter(|number| !is_defined(number.name));
    let term = |number: &SetNumber| Term {
        name: number.name,
        meaning: number.meaning,
        paper: "",
    };
    OWN.iter().copied().chain(numbers.map(term))
}

/// Returns whether a number is a term already, or counts things that have one, such as samples and gaps.
fn is_defined(number: &str) -> bool {
    let first = number.split(' ').next().unwrap_or_default();
    let names = [number, first.trim_end_matches('s')];
    OWN.iter().any(|term| names.contains(&term.name))
}

/// Returns the terms that are words of a text, in the singular or the plural.
pub fn terms_in(text: &str) -> impl Iterator<Item = Term> {
    let words: Vec<String> = text
        .split(|c: char| !c.is_alphanumeric() && c != '-')
        .map(|word| word.trim_end_matches('s').to_lowercase())
        .collect();
    terms().filter(move |term| {
        let name = term.name.to_lowercase();
        words.iter().any(|word| *word == name.trim_end_matches('s'))
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn terms_are_found_in_a_line() {
        let found = |text| -> Vec<&str> { terms_in(text).map(|term| term.name).collect() };
        assert_eq!(
            found("copy a sample of the clip into the domain"),
            ["sample", "domain", "clip"]
        );
        assert_eq!(found("for all Detectors and gaps:"), ["gap", "detector"]);
        assert_eq!(found("radius"), [""; 0]);
    }

    #[test]
    fn numbers_of_a_set_are_terms_unless_they_count_one() {
        let named = |name| terms().filter(|term| term.name == name).count();
        let numbers = ["density", "largest anisotropy", "radius r"];
        assert_eq!(numbers.map(named), [1, 1, 1]);
        assert_eq!(["samples N", "conflicts", "gaps"].map(named), [0, 0, 0]);
    }

    #[test]
    fn each_term_is_defined_once_in_one_or_two_sentences() {
        let names: BTreeSet<String> = terms().map(|term| term.name.to_lowercase()).collect();
        let meanings: BTreeSet<&str> = terms().map(|term| term.meaning).collect();
        let count = terms().count();
        assert_eq!((names.len(), meanings.len()), (count, count));
        for Term { name, meaning, .. } in terms() {
            assert!(meaning.ends_with('.') && !meaning.contains('|'), "{name}");
            assert!(meaning.matches(". ").count() <= 1, "{name}");
        }
    }
}
