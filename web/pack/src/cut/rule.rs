//! Which functions the start does without, by their names.

/// Crates and modules of which the start and ordinary play need nothing, but for [`EARLY`]. A function that is named in
/// error is still found: the rest of the program is then loaded for it at once.
const LATER: &[&str] = &[
    // Spectra and other measures, the second judge, and what they compute with.
    "tilescope_analysis::grid",
    "tilescope_analysis::measures",
    "tilescope_analysis::tessellation",
    "tilescope_analysis::verify",
    "rustfft",
    "spade",
    "robust",
    "num_bigint",
    // Files and pictures.
    "tilescope_drawing::picture",
    "tilescope_figures",
    "tilescope_formats",
    "tilescope_sets",
    "tiny_skia",
    "tiny_skia_path",
    "ttf_parser",
    "zip",
    "quick_xml",
    "png",
    "image",
    "gif",
    "fdeflate",
    "flate2",
    "miniz_oxide",
    "roxmltree",
    "zune_jpeg",
    "csv_core",
    "tilescope_workbench::curve",
    "tilescope_workbench::export",
    "tilescope_workbench::files",
    // The GPU as an engine.
    "tilescope_gpu",
    "tilescope_passes",
    // Sets that are not tiled by clips, or of several: a field or a shape, all darts in order, nested levels, a layout.
    "tilescope_core::combine",
    "tilescope_core::exact",
    "tilescope_core::levels",
    "tilescope_core::varying",
    "tilescope_session::combining",
    "tilescope_session::nesting",
    "tilescope_session::varying",
    // Conditions, watches, lessons and talks.
    "rhai",
    "tilescope_lessons",
    "tilescope_classroom::handout",
    "tilescope_classroom::lesson_labels",
    "tilescope_debugger::divergence",
    "tilescope_debugger::expression",
    "pulldown_cmark",
    "fast_qr",
    "sha1_smol",
];

/// Exceptions: functions that ran between the start and the first steps, measured in Chromium. They copy, drop or ask for
/// parts of every run.
const EARLY: &[&str] = &[
    // A sort of the sampler's samples is the same function as one of these crates', and has its name.
    "core::slice::sort",
    "tilescope_formats::binary",
    "tilescope_formats::digest",
    "tilescope_gpu::adapter",
    "tilescope_gpu::error",
    "tilescope_gpu::opened",
    "tilescope_passes::Passes",
    // Each frame asks whether a computation in the background has ended, of whatever kind.
    "tilescope_session::geometry",
    "tilescope_session::jobs",
    "tilescope_sets::varying::source",
    // The first frame lists the numbers that expressions may name, those of the plane and those of sets in space.
    "tilescope_live::numbers::live_numbers",
    // A link that is opened closes the sheet of an export.
    "tilescope_workbench::export::form::ExportForm",
];

/// Functions with at most so many bytes of code go where they are called. The linker makes one of functions that are
/// equal, as many small ones are, so that their names say little: the drop of any handle may have the name of a rare
/// one.
const MAX_SMALL: usize = 128;

/// Whether the start does without a function of so many bytes of code. One that is generic is named with the types that
/// it was made for, and counts for each of them.
pub fn is_later(name: &str, bytes: usize) -> bool {
    let is_named = |paths: &[&str]| paths.iter().any(|path| names(name, path));
    bytes > MAX_SMALL && is_named(LATER) && !is_named(EARLY)
}

/// Whether a path is somewhere in a name.
fn names(name: &str, path: &str) -> bool {
    let is_word = |sign: char| sign.is_alphanumeric() || sign == '_';
    name.match_indices(path).any(|(at, _)| {
        let (before, after) = (&name[..at], &name[at + path.len()..]);
        // A path begins a word, is not part of a longer path, and ends with a word: `png` is not in
        // `tilescope::png::write`.
        let begins = !before.ends_with(|sign| is_word(sign) || sign == ':');
        // The path of a module may end with a type.
        let is_type = path.contains("::") && !after.starts_with(is_word);
        begins && (is_type || after.starts_with("::"))
    })
}

/// Returns the crate that a function counts for: the first that its name has besides the standard library.
pub fn crate_of(name: &str) -> &str {
    let ends = name.match_indices("::").map(|(at, _)| &name[..at]);
    let is_word = |sign: char| sign.is_alphanumeric() || sign == '_';
    for before in ends {
        // The word before this `::`, which is a crate unless another path goes before it.
        let begin = before.rfind(|sign| !is_word(sign)).map_or(0, |at| at + 1);
        let word = &before[begin..];
        let is_path = before[..begin].ends_with(':');
        if !is_path && !word.is_empty() && !STANDARD.contains(&word) {
            return word;
        }
    }
    "std"
}

/// The crates of the standard library.
const STANDARD: [&str; 4] = ["alloc", "core", "std", "hashbrown"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_counts_wherever_it_is_named_and_only_as_a_whole() {
        for name in [
            "tilescope_figures::chart",
            "<tilescope_figures::Chart as core::fmt::Debug>::fmt",
            "core::ptr::drop_in_place::<alloc::vec::Vec<tilescope_figures::Chart>>",
            "<&mut png::Reader as std::io::Read>::read",
            "core::ptr::drop_in_place::<tilescope_passes::PassesOfAll>",
        ] {
            assert!(is_later(name, 1_000) && !is_later(name, 10), "{name}");
        }
        for name in [
            "tilescope_core::sample",
            "tilescope_formats::digest::of",
            "core::ptr::drop_in_place::<tilescope_passes::Passes>",
            "my_png::Reader",
            "tilescope::png::write",
            "pngs::write",
            "png",
            "",
        ] {
            assert!(!is_later(name, 1_000), "{name}");
        }
    }

    #[test]
    fn a_function_counts_for_the_first_crate_that_it_names() {
        for (name, expected) in [
            ("tilescope_core::sample", "tilescope_core"),
            ("<egui::Ui as core::fmt::Debug>::fmt", "egui"),
            ("<alloc::vec::Vec<png::Chunk>>::push", "png"),
            ("core::ptr::drop_in_place::<&mut [epaint::Shape]>", "epaint"),
            ("<alloc::vec::Vec<u8>>::push", "std"),
            ("memcmp", "std"),
        ] {
            assert_eq!(crate_of(name), expected, "{name}");
        }
    }
}
