//! What the pattern that the blocks of an exact tiling share means: below the method, with the way to the reference sampler
//! where a pattern takes longer than it saves.

use egui::{RichText, Ui};
use tilescope_session::words::grouped;
use tilescope_ui::language::Worded;
use tilescope_ui::widgets::Known;
use tilescope_workbench::command::{Command, FormCommand};
use tilescope_workbench::draft::SharedPattern;

use super::FormContext;

/// Where the times are from.
const MEASURED: &str = "Times are those of one thread of a server, and on a page longer.";

/// Shows how often the pattern is used and what the run costs from nothing; nothing unless the run is an exact tiling.
pub(super) fn show(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    let Some(shared) = context.form.draft.shared_pattern() else {
        return;
    };
    for (text, name) in [
        (reuse(&shared), "shared-pattern"),
        (time(&shared), "shared-pattern-time"),
    ] {
        let words = ui.words(text);
        let label = ui.label(RichText::new(words).color(context.palette.muted));
        label.known_as(name);
        label.on_hover_text(ui.words(MEASURED));
    }

    // Of shapes it is not known which takes longer, and the choice of the method stands above.
    if shared.is_slower() {
        let link = ui.link(ui.words("Use the reference sampler"));
        let why = "Makes the set by darts, without a pattern: with the same law, in less time.";
        link.on_hover_text(ui.words(why)).issues(
            "reference-sampler",
            Command::Form(FormCommand::ReferenceSampler),
            commands,
        );
    }
}

/// Returns how often samples of the pattern are used, and what averages over the set are worth.
fn reuse(shared: &SharedPattern) -> String {
    let law = if shared.repeats_within_blocks {
        "It repeats within the largest blocks, so that the law is exact only in windows that are narrower"
    } else {
        "The law is exact in every window in which no part of the pattern occurs twice"
    };
    format!(
        "N / k = {:.2}: about {} samples share a pattern of {}. {law}; averages over the set vary about as those of {} independent samples.",
        shared.samples / shared.of_pattern,
        rounded(shared.samples),
        rounded(shared.of_pattern),
        rounded(shared.independent()),
    )
}

/// Returns what the run takes from nothing, beside the reference sampler.
fn time(shared: &SharedPattern) -> String {
    let of_making = seconds(shared.of_making);
    if shared.is_shape {
        return format!(
            "The pattern takes about {of_making}, and darts need none. Sets in shapes were not timed."
        );
    }
    format!(
        "From nothing about {}, of which the pattern takes {of_making}; the reference sampler about {}.",
        seconds(shared.seconds),
        seconds(shared.of_reference)
    )
}

/// Returns a number of samples with two digits.
fn rounded(samples: f64) -> String {
    let step = 10_f64.powf((samples.log10().floor() - 1.0).max(0.0));
    grouped(((samples / step).round() * step) as usize)
}

/// Returns a time with about two digits.
fn seconds(seconds: f64) -> String {
    // The decimals up to the second digit that is not 0. Nothing takes less than a tenth of a millisecond.
    let first = seconds.max(1e-4).log10().floor();
    let decimals = (1.0 - first).max(1.0) as usize;
    format!("{seconds:.decimals$} s")
}
