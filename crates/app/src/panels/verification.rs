//! The verdict of the independent verifier: a chip that is always visible, and a panel with its numbers. Sizes are in
//! screen points, and chosen, not measured, where no reason stands beside them.

use std::sync::Arc;

use egui::{
    Color32, CursorIcon, FontId, Galley, RichText, Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo,
    vec2,
};
use tilescope_analysis::measures::number;
use tilescope_analysis::{COVERING_TOLERANCE, Judge, PrefixClaim, Report};
use tilescope_drawing::palette::Palette;
use tilescope_session::glossary;
use tilescope_session::ground::MadeGround;
use tilescope_session::verification::{Verdict, Witness};
use tilescope_session::words::{conflicts_in, counted, grouped, significant};
use tilescope_ui::language::Worded;
use tilescope_ui::theme::semibold;
use tilescope_ui::widgets::{Kebab, Known, heading, name_group, row, shown_row, verdict_mark};

use super::common::divide;
use super::content::{Content, Room};
use super::context::PanelContext;
use crate::ENABLED;
use tilescope_workbench::command::{Command, ViewCommand, Which};
use tilescope_workbench::state::Verification;

/// Shows the chip; a click goes to the conflict or gap that decides the verdict, or of a valid set to the closest pair, if it
/// is known.
pub fn chip(ui: &mut Ui, context: &PanelContext<'_>, commands: &mut Vec<Command>) {
    // Without a session there is no verdict to show.
    if matches!(context.run.verification, Verification::Nothing) {
        return;
    }

    let (text, is_valid, color) = summary(context, context.palette);
    let text = ui.words(text);
    let galley = galley_of(ui, &text, color);
    let size = vec2(width_of(&galley), 30.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let name = format!("{}: {text}", ui.words("Verdict"));
    response.widget_info(|| WidgetInfo::labeled(Role::Button, ENABLED, &name));
    response.known_as("verdict");

    let painter = ui.painter();
    let is_hot = response.hovered() || response.has_focus();
    let fill = color.gamma_multiply(if is_hot { 0.26 } else { 0.15 });
    let stroke = Stroke::new(1.0, color.gamma_multiply(0.7));
    painter.rect(rect, 15.0, fill, stroke, StrokeKind::Inside);

    // The mark and the text are centred as one. The mark takes 18 points, and has its middle 4 points from the left.
    let start = rect.center().x - 0.5 * (galley.size().x + 18.0);
    if let Some(is_valid) = is_valid {
        let mark = egui::pos2(start + 4.0, rect.center().y);
        verdict_mark(painter, mark, is_valid, color);
    }
    let at = egui::pos2(start + 18.0, rect.center().y - galley.size().y / 2.0);
    painter.galley(at, galley, color);

    let tip = ui.words(explanation(context));
    let response = response.on_hover_text(tip);
    if response.on_hover_cursor(CursorIcon::PointingHand).clicked() {
        commands.push(Command::View(
            Which::First,
            ViewCommand::FlyToWitness(Witness::Verdict),
        ));
    }
}

fn galley_of(ui: &Ui, text: &str, color: Color32) -> Arc<Galley> {
    let font = FontId::new(13.0, semibold());
    ui.painter().layout_no_wrap(text.to_owned(), font, color)
}

/// Returns the width of the chip of a text: at least that of the longest usual verdict, so that nothing moves when it arrives.
fn width_of(galley: &Galley) -> f32 {
    (galley.size().x + 46.0).max(150.0)
}

/// Returns the width that [`chip`] takes; 0 where there is nothing to verify.
pub fn chip_width(ui: &Ui, context: &PanelContext<'_>) -> f32 {
    if matches!(context.run.verification, Verification::Nothing) {
        return 0.0;
    }
    let (text, _, color) = summary(context, context.palette);
    width_of(&galley_of(ui, &ui.words(text), color))
}

/// Returns the text of the chip, whether the session is valid if that is known, and the colour of text and mark.
fn summary(context: &PanelContext<'_>, palette: &Palette) -> (String, Option<bool>, Color32) {
    match &context.run.verification {
        Verification::Nothing => ("nothing to verify".to_owned(), None, palette.muted),
        Verification::Pending(_) => ("verifying\u{2026}".to_owned(), None, palette.muted),
        // A session that could not be verified is not taken for valid.
        Verification::Failed(_) => ("no verdict".to_owned(), Some(false), palette.conflict),
        Verification::Done(verdict) => {
            let is_valid = verdict.valid();
            let of_prefix = |claim: PrefixClaim| {
                let word = if is_valid { "verified" } else { "not valid" };
                format!("first {}: {word}", grouped(claim.count))
            };
            let of_result = || match (verdict.conflict_free(), verdict.maximal()) {
                (true, true) if context.run.is_at_end() => "verified".to_owned(),
                // Before the end of the run the canvas does not show the set that was verified.
                (true, true) => "final result verified".to_owned(),
                (true, false) => "not maximal".to_owned(),
                (false, true) => "not conflict-free".to_owned(),
                (false, false) => "conflicts and gaps".to_owned(),
            };

            // A stipple is the first dots of a larger set by arrival. So even all of its dots are called a prefix.
            let of_dots = |all: usize| {
                let word = if is_valid { "verified" } else { "not valid" };
                match verdict.report.count {
                    count if count < all => format!("first {}: {word}", grouped(count)),
                    _ => format!("prefix: {word}"),
                }
            };

            let text = match (verdict.claim, verdict.stipple) {
                (Some(claim), _) => of_prefix(claim),
                (None, Some(all)) => of_dots(all),
                (None, None) => of_result(),
            };
            // Until the verdict on the prefix at work is there, the one before is shown, muted.
            let color = if context.run.prefix_at_work().is_some() {
                palette.muted
            } else if is_valid {
                palette.inserted
            } else {
                palette.conflict
            };
            (text, Some(is_valid), color)
        }
    }
}

/// Returns the tooltip of the chip: who judged, and what a click shows.
fn explanation(context: &PanelContext<'_>) -> String {
    match &context.run.verification {
        Verification::Nothing => "Each session is verified when it is ready.".to_owned(),
        Verification::Pending(job) => {
            format!("The verifier is at work: {:.0}%.", job.fraction() * 100.0)
        }
        Verification::Failed(reason) => reason.clone(),
        // A verdict with a claim is that of a prefix of nested levels. The next prefix may be at work by then.
        Verification::Done(verdict) if verdict.claim.is_some() => {
            let judges = Judge::joined(&verdict.report.judges);
            let next = context
                .run
                .prefix_at_work()
                .map_or_else(String::new, |count| {
                    format!(" The first {} are being verified.", grouped(count))
                });

            format!(
                "Found by {judges}, which share no code with the sampler. Click to see these samples and their closest pair, or what is wrong.{next}"
            )
        }
        // Valid sets of dots, in a field or in a shape have no closest pair to show.
        Verification::Done(verdict) if verdict.valid() && verdict.stipple.is_some() => {
            let covering = verdict.report.covering_factor.map_or_else(
                || "so few dots promise no covering".to_owned(),
                |factor| format!("every place is within {factor:.3} times its radius of one"),
            );
            format!(
                "No two of these dots are near each other, and {covering}; verified by {}, which shares no code with the sampler.",
                Judge::joined(&verdict.report.judges)
            )
        }
        Verification::Done(verdict) if verdict.valid() && is_local(context) => format!(
            "No two samples are near each other, and each place is near a sample, with the radius at each place; verified by {}, which shares no code with the sampler.",
            Judge::joined(&verdict.report.judges)
        ),
        Verification::Done(verdict) if verdict.valid() => format!(
            "Conflict-free and maximal, to within (1 + 2^-15) r, verified by {}, which share no code with the sampler. Click to see the closest pair.",
            Judge::joined(&verdict.report.judges)
        ),
        Verification::Done(_) => "Click to see the conflict or gap.".to_owned(),
    }
}

/// Returns whether the radius of the set depends on the place, or its domain is a shape.
fn is_local(context: &PanelContext<'_>) -> bool {
    let session = context.run.session.as_ref();
    session.is_some_and(|session| session.ground.is_some())
}

/// What the limit of the covering radius is.
const TOLERATED: &str = "A set counts as maximal if its covering radius is at most (1 + 2^-15) r: positions are rounded to a lattice of which r is 2^15 units.";

pub const CONTENT: Content = Content::of_run(Room::Scrolled, show);

/// Shows the verifier's numbers. The rows are shown before their values are known.
pub fn show(ui: &mut Ui, context: &PanelContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    heading(ui, "Verification");
    // The rows stand closer than in other panels, so that all of them are seen at once.
    ui.spacing_mut().item_spacing.y = 3.0;
    ui.spacing_mut().interact_size.y = 21.0;

    let verdict = context.run.verdict();
    let report = verdict.map(|verdict| &verdict.report);
    // The verifier measures in the unit of the domain, of which an r has this many.
    let unit = (context.run.session.as_ref()).map_or(1.0, |session| session.run().domain.radius());
    match verdict.and_then(|verdict| Some((verdict, verdict.claim?))) {
        Some((verdict, claim)) => guarantee(ui, verdict, claim, unit, palette),
        None if context.run.shows_stipple() => dots(ui, verdict, palette),
        None => properties(ui, report, palette),
    }

    if is_local(context) {
        return local_numbers(ui, context, commands);
    }
    numbers(ui, context, unit);

    // A prefix of nested levels is judged by the covering that was promised, which `guarantee` shows above.
    if verdict.is_none_or(|verdict| verdict.claim.is_none()) {
        let tolerance = report.map_or(COVERING_TOLERANCE, |report| report.covering_tolerance);
        let limit = format!("{:.6} r", 1.0 + tolerance);
        let shown = shown_row(ui, "Maximal up to", &limit, palette);
        let shown = shown.on_hover_text(ui.words(TOLERATED));
        shown.known_as("covering-limit");
    }

    let judges = report.map_or_else(|| "\u{2013}".to_owned(), |report| short(&report.judges));
    let shown = shown_row(ui, "Verified by", &judges, palette);
    if let Some(report) = report {
        shown.on_hover_text(ui.words(Judge::joined(&report.judges)));
    }

    ui.add_space(4.0);
    witnesses(ui, verdict, commands);

    if let Verification::Failed(reason) = &context.run.verification {
        ui.label(RichText::new(ui.words(reason)).color(palette.conflict));
    }
    divide(ui, palette);
}

/// Returns what a number of the catalogue means.
fn meaning(key: &str) -> &'static str {
    let found = number(key);
    debug_assert!(found.is_some(), "the catalogue has no number {key}");
    found.map_or("", |number| number.meaning)
}

/// Shows the measures of a set in a field or a shape, with lengths in the unit of its domain; those that need one radius only where
/// there is one.
fn local_numbers(ui: &mut Ui, context: &PanelContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    let verdict = context.run.verdict();
    let report = verdict.map(|verdict| &verdict.report);
    let none = || "\u{2013}".to_owned();

    let least = report.map_or_else(none, |report| {
        // The smallest distance of a single sample is infinite.
        if report.min_distance.is_finite() {
            significant(report.min_distance)
        } else {
            "none".to_owned()
        }
    });
    let count = report.map_or_else(none, |report| grouped(report.count));
    let judges = report.map_or_else(none, |report| short(&report.judges));
    let density = report.map_or_else(none, |report| format!("{:.4}", report.density));
    // Where the radius varies it is infinite, as it is of a single sample.
    let relative = report.map(|report| report.relative_radius);
    let relative = relative.filter(|ratio| ratio.is_finite());
    let relative = relative.map_or_else(none, |ratio| format!("{ratio:.4}"));
    for (name, value) in [
        ("Smallest distance", &least),
        ("Density N r\u{b2}/A", &density),
        ("Relative radius", &relative),
        ("Samples", &count),
        ("Verified by", &judges),
    ] {
        row(ui, name, value, palette);
    }

    ui.add_space(4.0);
    witnesses(ui, verdict, commands);
    if let Verification::Failed(reason) = &context.run.verification {
        ui.label(RichText::new(ui.words(reason)).color(palette.conflict));
    }
    let session = context.run.session.as_ref();
    let varies = session
        .and_then(|session| session.ground.as_ref())
        .is_some_and(MadeGround::varies);
    let of_what = if varies { IN_FIELD } else { IN_SHAPE };
    ui.label(RichText::new(ui.words(of_what)).color(palette.muted))
        .known_as("local-measures");
    divide(ui, palette);
}

/// What the numbers of a set in a field are of.
const IN_FIELD: &str = "The density is by the radius at each place. Covering radius and relative radius compare with one radius, which this set does not have.";

/// What the numbers of a set of one radius in a shape are of.
const IN_SHAPE: &str = "Density and relative radius are by the area of the shape. The covering radius is not measured: squares find out whether places are covered, and not how far away they are.";

/// Shows the measures of the set, each with its meaning. `unit` is the length of r in the unit of the domain.
fn numbers(ui: &mut Ui, context: &PanelContext<'_>, unit: f64) {
    let verdict = context.run.verdict();
    let report = verdict.map(|verdict| &verdict.report);

    let text = |value: Option<f64>, digits: usize, suffix: &str| match value {
        Some(value) if value.is_finite() => format!("{value:.digits$}{suffix}"),
        // A single sample has no other one near it: its smallest distance is infinite.
        Some(_) => "none".to_owned(),
        None => "\u{2013}".to_owned(),
    };

    let in_radii = |value: fn(&Verdict) -> f64| verdict.map(|verdict| value(verdict) / unit);
    // Six digits show the tolerance, which is 2^-15 r. The four of the others are chosen, not measured.
    let least = text(in_radii(|verdict| verdict.report.min_distance), 6, " r");
    let cover = text(in_radii(|verdict| verdict.report.covering_radius), 6, " r");
    let density = text(report.map(|report| report.density), 4, "");
    let relative = text(report.map(|report| report.relative_radius), 4, "");
    let count = report.map_or_else(|| "\u{2013}".to_owned(), |report| grouped(report.count));

    let is_in_space = verdict.is_some_and(|verdict| verdict.space.is_some());
    let density_name = if is_in_space {
        "Density N r\u{b3}/V"
    } else {
        "Density N r\u{b2}/A"
    };
    // A number's meaning stands in its tooltip, as the catalogue has it.
    for (name, meaning, value) in [
        ("Smallest distance", meaning("min_distance_r"), &least),
        ("Covering radius", meaning("covering_radius_r"), &cover),
        (density_name, meaning("density"), &density),
        ("Relative radius", meaning("relative_radius"), &relative),
        (
            if context.run.prefix().is_some() {
                "First samples"
            } else {
                "Samples"
            },
            glossary::SAMPLE.meaning,
            &count,
        ),
    ] {
        let shown = shown_row(ui, name, value, context.palette);
        shown.on_hover_text(ui.words(meaning));
    }
}

/// Shows the buttons that fly to what decides the verdict.
fn witnesses(ui: &mut Ui, verdict: Option<&Verdict>, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        for (name, witness, known) in [
            (
                "Closest pair",
                Witness::ClosestPair,
                verdict.is_some_and(|verdict| verdict.closest.is_some()),
            ),
            (
                "Largest hole",
                Witness::LargestHole,
                verdict.is_some_and(|verdict| verdict.largest.is_some()),
            ),
        ] {
            // Before the verdict no pair and no hole is known, and a verdict may lack them, as on a very large set or in a field.
            let button = ui.add_enabled(known, egui::Button::new(ui.words(name)));
            button.known_as(Kebab(witness));

            let button = button.on_disabled_hover_text(ui.words("The verifier reported none."));
            if button.on_hover_text(ui.words("Fly there")).clicked() {
                commands.push(Command::View(
                    Which::First,
                    ViewCommand::FlyToWitness(witness),
                ));
            }
        }
    });
}

/// Shows whether a set is conflict-free and maximal; dashes without a report.
fn properties(ui: &mut Ui, report: Option<&Report>, palette: &Palette) {
    let free = report.map(|r| (r.conflict_free(), conflicts_in(r)));
    property(
        ui,
        ("Conflict-free", glossary::CONFLICT.meaning),
        free.as_ref(),
        palette,
    );
    let maximal = report.map(|r| {
        let count = counted(r.gaps as usize, "open place", "open places");
        (r.maximal(), count)
    });
    property(
        ui,
        ("Maximal", glossary::MAXIMAL.meaning),
        maximal.as_ref(),
        palette,
    );
}

/// Shows whether dots are conflict-free and a prefix as promised, and within which factor of the radius they cover.
/// Dashes stand for a verdict that is not there yet.
fn dots(ui: &mut Ui, verdict: Option<&Verdict>, palette: &Palette) {
    let report = verdict.map(|verdict| &verdict.report);
    let free = report.map(|report| (report.conflict_free(), conflicts_in(report)));
    let name = ("Conflict-free", glossary::CONFLICT.meaning);
    property(ui, name, free.as_ref(), palette);

    // `maximal` asks of a stipple whether its dots cover within the factor. A part of the dots promises no covering, so
    // that only all of them can have gaps.
    let prefix = verdict.map(|verdict| (verdict.maximal(), "gaps".to_owned()));
    property(
        ui,
        ("Prefix", glossary::PREFIX.meaning),
        prefix.as_ref(),
        palette,
    );
    let factor = report.map_or_else(
        || "\u{2013}".to_owned(),
        |report| match report.covering_factor {
            Some(factor) => format!("{factor:.4} radii"),
            None => "not promised".to_owned(),
        },
    );
    row(ui, "Covers within", &factor, palette);
}

/// Shows whether a prefix of nested levels keeps its promises of distance and covering. `unit` is the length of r in
/// the unit of the domain.
fn guarantee(ui: &mut Ui, verdict: &Verdict, claim: PrefixClaim, unit: f64, palette: &Palette) {
    // The words name the fault, and are shown only where a promise does not hold.
    let judged = |holds: bool| (holds, "not as promised".to_owned());
    let distance = format!("Distances over {:.3} r", claim.distance / unit);
    let apart = judged(verdict.conflict_free());
    property(
        ui,
        (&distance, glossary::PREFIX.meaning),
        Some(&apart),
        palette,
    );

    let covering = claim.covering.map(|covering| covering / unit);
    // Only a prefix that ends with a whole level promises to cover the domain.
    let name = covering.map_or_else(
        || "Covering not promised".to_owned(),
        |covering| format!("Covering up to {covering:.3} r"),
    );
    let covers = covering.map(|_| judged(verdict.maximal()));
    property(
        ui,
        (&name, meaning("covering_radius_r")),
        covers.as_ref(),
        palette,
    );
}

/// Returns the names of judges in a short form: "Delaunay, circles".
fn short(judges: &[Judge]) -> String {
    let name = |judge: &Judge| match judge {
        Judge::Delaunay => "Delaunay",
        Judge::Circles => "circles",
        Judge::Subdivision => "subdivision",
    };
    judges.iter().map(name).collect::<Vec<_>>().join(", ")
}

/// Shows whether the set has a property, with the fault if it has not.
fn property(
    ui: &mut Ui,
    (name, meaning): (&str, &str),
    judged: Option<&(bool, String)>,
    palette: &Palette,
) {
    let shown = ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(16.0, 20.0), Sense::hover());
        let (text, color) = match judged {
            // A dash stands for a verdict that is not there yet, or for a property that is not promised.
            None => ("\u{2013}".to_owned(), palette.muted),
            Some((true, _)) => ("yes".to_owned(), palette.inserted),
            Some((false, fault)) => (format!("no: {fault}"), palette.conflict),
        };
        if let Some((holds, _)) = judged {
            verdict_mark(ui.painter(), rect.center(), *holds, color);
        }
        ui.label(ui.words(name));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(RichText::new(ui.words(text)).monospace().color(color));
        });
    });

    // The name comes first: a row without a name would be named by its tooltip.
    name_group(&shown.response, &ui.words(name));
    shown.response.on_hover_text(ui.words(meaning));
}
