//! The timeline: a sentence on the last event, and the controls of time. Sizes are in screen points, and chosen, not
//! measured, where no reason stands beside them.

use egui::text::LayoutJob;
use egui::{
    Align, Button, Color32, ComboBox, Context, DragValue, FontId, Layout, RichText, Role, Sense,
    Slider, TextStyle, Ui, Vec2, WidgetInfo, vec2,
};
use tilescope_session::glossary;
use tilescope_session::sentence::happened;
use tilescope_session::words::{capital, grouped, significant};
use tilescope_ui::language::Worded;
use tilescope_ui::theme::{FINGER, is_for_fingers};
use tilescope_ui::widgets::{Icon, Kebab, Known, icon_button};

use super::content::{Content, Room};
use super::context::TimeContext;
use super::pseudocode::next_line;
use super::{curve, track};
use crate::ENABLED;
use crate::actions::time_refusals;
use tilescope_workbench::arrangement::Arrangement;
use tilescope_workbench::clock::{Clock, SPEEDS, WHOLE_RUNS_SECS};
use tilescope_workbench::command::{Command, TimeCommand, ViewCommand, Which};
use tilescope_workbench::orbit::OrbitCommand;

/// Minimum width for counts beside the sentence.
const WIDE: f32 = 760.0;
/// Gap between the sentence and the counts.
const BESIDE: f32 = 24.0;
/// Gap between the sentence and the controls.
const ABOVE_CONTROLS: f32 = 4.0;
/// Width of the labels "Done" and "Next".
const LABEL: f32 = 46.0;
/// Height of the row of the next line.
const NEXT_LINE: f32 = 19.0;
/// A lower window has no room for the next line.
const MIN_HEIGHT_FOR_NEXT: f32 = 560.0;
/// Font size of the labels, and of the next line.
const SMALL_SIZE: f32 = 13.0;
/// Font size of the sentence.
const SIZE: f32 = 15.0;
/// Font size of the sentence in a small window.
const COMPACT_SIZE: f32 = 14.5;

/// A sentence as long as those of runs of some ten thousand samples. Room for it is always reserved, so that nothing
/// moves from event to event.
const SPECIMEN: &str = "The circumcentre of sample 10,774 of block 88 with sample 17,364 of block 88 and sample 10,974 of \
     block 88, 1.99 r away, is nearer to sample 10,775 of block 88.";

/// Returns the last step in the words of the window's language; of nested levels with the verdict on the samples that are shown.
fn said(ctx: &Context, context: &TimeContext<'_>) -> String {
    // At the end of a run the sentence is about the plane, which balls take the place of.
    let run = context.run;
    let session = run.session.as_deref().filter(|_| run.is_at_end());
    if let Some((orbit, session)) = run.orbit().zip(session)
        && let Some(sentence) = orbit.sentence(session)
    {
        return ctx.words(sentence);
    }

    let happened = happened(context.run.shown().as_ref()) + context.run.prefix_verdict();
    ctx.words(happened)
}

/// Returns the height of a text wrapped at `width`.
fn text_height(ctx: &Context, text: &str, size: f32, width: f32) -> f32 {
    let job = LayoutJob::simple(
        text.to_owned(),
        FontId::proportional(size),
        Color32::WHITE,
        width,
    );
    ctx.fonts_mut(|fonts| fonts.layout_job(job)).size().y
}

/// Returns the size of the whole sentence, at least that of [`SPECIMEN`].
fn sentence_height(ctx: &Context, context: &TimeContext<'_>, size: f32, width: f32) -> f32 {
    let height = |text: &str| text_height(ctx, text, size, width);
    height(&ctx.words(SPECIMEN))
        .max(height(&said(ctx, context)))
        .ceil()
}

/// Returns the room for counts beside the sentence, the same at every moment.
fn room_beside(ctx: &Context, context: &TimeContext<'_>, width: f32) -> f32 {
    let (Some(session), true) = (&context.run.session, width >= WIDE) else {
        return 0.0;
    };
    // There are most samples after tiling or at the end.
    let most = grouped(session.summary.tiled.max(session.summary.count));
    let moment = match context.run.cursor() {
        Some((_, len)) => format!("event {0} of {0}", grouped(len)),
        None => "stage 9 of 9".to_owned(),
    };
    let digits = session.summary.count.to_string().len();

    // The numbers of stages and iterations are taken to have one digit. There are at most eleven levels. The radius of
    // each level is the root of 2 times that of the next level. The last level has r, so that no level has more than
    // 32 r.
    let texts = match context.run.prefix() {
        Some(_) if context.run.shows_stipple() => vec![format!("{most} of {most} dots")],
        Some(_) => vec![
            format!("{most} of {most} samples"),
            "radius 32.00 r".to_owned(),
            // Ranks are so near to each other that a number between two of them needs about as many decimals as their
            // count has digits, and two more.
            format!("ranks below 0.{}", "0".repeat(digits + 2)),
        ],
        None => vec![format!("{most} samples"), moment, "iteration 9".to_owned()],
    };

    let text = joined(ctx, texts);
    let font = TextStyle::Monospace.resolve(&ctx.style_of(ctx.theme()));
    let job = LayoutJob::simple_singleline(text, font, Color32::WHITE);
    ctx.fonts_mut(|fonts| fonts.layout_job(job)).size().x + BESIDE
}

/// Returns the counts of a moment as one text in the language of the window.
fn joined(ctx: &Context, counts: Vec<String>) -> String {
    let words = counts.into_iter().map(|text| ctx.words(text));
    words.collect::<Vec<_>>().join("   ")
}

/// Returns whether the next line is shown: there are events, and the window is not low.
fn has_next(ctx: &Context, context: &TimeContext<'_>) -> bool {
    context.run.debugger.is_some() && ctx.content_rect().height() >= MIN_HEIGHT_FOR_NEXT
}

/// Returns the room for counts beside the sentence: 0 where the counts stand beside the next line, which is short.
fn room_beside_sentence(ctx: &Context, context: &TimeContext<'_>, width: f32) -> f32 {
    if has_next(ctx, context) {
        0.0
    } else {
        room_beside(ctx, context, width)
    }
}

/// Returns the height that shows everything in `width`.
#[must_use]
pub fn height(ctx: &Context, context: &TimeContext<'_>, width: f32) -> f32 {
    let sentence_width = width - LABEL - room_beside_sentence(ctx, context, width);
    let track = if is_for_fingers(ctx) {
        track::COMPACT_HEIGHT
    } else {
        track::HEIGHT
    };
    let next = if has_next(ctx, context) {
        NEXT_LINE
    } else {
        0.0
    };
    let lines = sentence_height(ctx, context, SIZE, sentence_width).max(LINE);
    lines + next + ABOVE_CONTROLS + curve::height(context) + track
}

pub const CONTENT: Content = Content::of_state(Room::Whole, |ui, state, commands| {
    show(ui, &TimeContext::of(state), commands);
});

/// Shows the timeline: the last step in words, the next line, and the controls beside the track.
pub fn show(ui: &mut Ui, context: &TimeContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    ui.spacing_mut().item_spacing.y = 0.0;
    let room = ui.available_width();
    let beside = room_beside_sentence(ui.ctx(), context, room);
    let width = room - LABEL - beside;
    // The room for a long sentence is always kept, so that nothing moves from event to event.
    let height = sentence_height(ui.ctx(), context, SIZE, width).max(LINE);

    ui.allocate_ui_with_layout(
        vec2(room, height),
        Layout::left_to_right(Align::Center),
        |ui| {
            ui.set_min_size(vec2(room, height));
            ui.spacing_mut().item_spacing.x = 0.0;
            // Screen readers follow this order: the sentence comes first, then the counts.
            label(ui, "Done", height, palette.muted);
            sentence(ui, context, SIZE, vec2(width, height), ALL_LINES);
            if beside > 0.0 {
                counts(ui, context);
            }
        },
    );

    let next = next_line(context.run).filter(|_| has_next(ui.ctx(), context));
    if let Some(next) = next {
        let row = vec2(room, NEXT_LINE);
        ui.allocate_ui_with_layout(row, Layout::left_to_right(Align::Center), |ui| {
            ui.set_min_size(row);
            ui.spacing_mut().item_spacing.x = 0.0;
            label(ui, "Next", NEXT_LINE, palette.muted);
            let beside_next = room_beside(ui.ctx(), context, room);
            let size = vec2(room - LABEL - beside_next, NEXT_LINE);
            ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
                ui.set_min_size(size);
                let text = RichText::new(ui.words(next))
                    .size(SMALL_SIZE)
                    .color(palette.muted);
                let response = ui.add(egui::Label::new(text).truncate());
                response.known_as("next-line");
            });
            if beside_next > 0.0 {
                counts(ui, context);
            }
        });
    }
    ui.add_space(ABOVE_CONTROLS);

    let size = vec2(room, curve::height(context));
    let (above, _) = ui.allocate_exact_size(size, Sense::hover());
    let track = ui.horizontal(|ui| {
        let with_ends = true;
        controls(ui, context, with_ends, commands);
        ui.add_space(6.0);
        clock(ui, context, 72.0, commands);
        speed(ui, context, commands);
        prefix(ui, context, commands);
        plane(ui, context, commands);
        ui.add_space(14.0);
        track::show(ui, context, commands)
    });
    // The curve is as wide as the track, which begins behind the controls, so that it is shown after them.
    curve::show(ui, context, above, track.inner, commands);
}

/// Shows the counts of the moment at the end of a row.
fn counts(ui: &mut Ui, context: &TimeContext<'_>) {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let counts = joined(ui.ctx(), context.run.moment_texts(context.is_veiled));
        let text = RichText::new(counts).monospace();
        ui.label(text.color(context.palette.muted))
            .known_as("counts");
    });
}

/// Shows the label of a row.
fn label(ui: &mut Ui, text: &str, height: f32, color: Color32) {
    let room = vec2(LABEL, height);
    ui.allocate_ui_with_layout(room, Layout::left_to_right(Align::Center), |ui| {
        ui.set_min_size(room);
        let text = RichText::new(ui.words(text)).size(SMALL_SIZE);
        ui.label(text.color(color));
    });
}

/// No limit of the lines of a sentence.
const ALL_LINES: usize = usize::MAX;

/// Shows the sentence, in at most this many lines.
fn sentence(ui: &mut Ui, context: &TimeContext<'_>, size: f32, room: Vec2, lines: usize) {
    ui.allocate_ui_with_layout(room, Layout::left_to_right(Align::Center), |ui| {
        ui.set_min_size(room);
        let color = context.palette.text;
        let font = FontId::proportional(size);
        let mut text = LayoutJob::simple(said(ui.ctx(), context), font, color, room.x);
        // The tooltip shows the rest.
        text.wrap.max_rows = lines;
        let galley = ui.painter().layout_job(text);
        let response = ui.add(egui::Label::new(galley));
        super::common::read_out(ui, &response);
        response.known_as("status");
    });
}

/// Height of a line of the sentence.
const LINE: f32 = 20.0;
/// Minimum width of the chooser of clocks for touch.
const CLOCK: f32 = 92.0;
/// Gap between the rows of a small window.
const APART: f32 = 4.0;

/// Returns the height of a small window's controls of this width. Where the sentence takes room from the canvas or an
/// open panel it has two lines, in a low window one.
#[must_use]
pub fn compact_height(ctx: &Context, context: &TimeContext<'_>, is_low: bool, width: f32) -> f32 {
    let sentence = compact_sentence(ctx, context, is_low, width);
    // The margins of the controls take 12 points, and a button for fingers 2 more than `FINGER`.
    12.0 + sentence + FINGER + 2.0 + track::COMPACT_HEIGHT + 2.0 * APART
}

/// Returns whether a small window has room for the whole sentence: beside the canvas, where no panel is open.
fn is_whole(context: &TimeContext<'_>) -> bool {
    context.drawer.open.is_none() && context.drawer.arrangement == Arrangement::Landscape
}

fn compact_sentence(ctx: &Context, context: &TimeContext<'_>, is_low: bool, width: f32) -> f32 {
    if is_whole(context) {
        return sentence_height(ctx, context, COMPACT_SIZE, width);
    }
    if is_low { LINE } else { 2.0 * LINE }
}

/// Shows the sentence, the controls and the track below each other, large enough for touch.
pub fn show_compact(
    ui: &mut Ui,
    context: &TimeContext<'_>,
    is_low: bool,
    commands: &mut Vec<Command>,
) {
    ui.spacing_mut().item_spacing.y = APART;
    let width = ui.available_width();
    let room = vec2(width, compact_sentence(ui.ctx(), context, is_low, width));

    // A sentence that is cut off is shown whole in the timeline's panel.
    let lines = match (is_whole(context), is_low) {
        (true, _) => ALL_LINES,
        (false, true) => 1,
        (false, false) => 2,
    };

    sentence(ui, context, COMPACT_SIZE, room, lines);
    ui.horizontal(|ui| {
        let with_ends = true;
        controls(ui, context, with_ends, commands);
        ui.add_space(6.0);
        // Where the chooser of clocks has no room, the Go menu has its choices.
        if ui.available_width() >= CLOCK {
            clock(ui, context, ui.available_width().min(110.0), commands);
        }
    });
    track::show(ui, context, commands);
}

/// Layout of an embedded player below its canvas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Player {
    /// Controls and track side by side, as in the window.
    Wide,
    /// The sentence, the controls and the track below each other.
    Narrow,
    /// The most important controls and the track side by side, in players that have little room beside the canvas.
    Small,
}

/// In narrower players, in screen points, the track is below the controls.
const WIDE_PLAYER: f32 = 560.0;
/// Narrower players lack the buttons to the first and the last stage.
const ALL_BUTTONS: f32 = 420.0;
/// Lower players that are not wide are small.
const HIGH_PLAYER: f32 = 300.0;
/// Font size of the sentence in players that are not wide.
const PLAYER_SIZE: f32 = 12.0;
/// Width of the chooser of speeds in players that are not wide.
const SPEED: f32 = 70.0;
/// Margins of the controls below a player's canvas, horizontal and vertical.
pub const PLAYER_MARGIN: egui::Vec2 = vec2(12.0, 6.0);

impl Player {
    /// Returns the layout of a player of this size, in screen points.
    #[must_use]
    pub fn of(size: egui::Vec2) -> Self {
        if size.x >= WIDE_PLAYER {
            Self::Wide
        } else if size.y >= HIGH_PLAYER {
            Self::Narrow
        } else {
            Self::Small
        }
    }

    /// Returns the total height, `width` wide between the margins.
    #[must_use]
    pub fn height(self, ctx: &Context, context: &TimeContext<'_>, width: f32) -> f32 {
        let sentence = sentence_height(ctx, context, PLAYER_SIZE, width);
        let row = APART + FINGER + 4.0;
        2.0 * PLAYER_MARGIN.y
            + match self {
                Self::Wide => height(ctx, context, width),
                Self::Narrow => sentence + row + APART + track::COMPACT_HEIGHT,
                Self::Small => sentence + row,
            }
    }

    /// Shows the player's controls.
    pub fn show(self, ui: &mut Ui, context: &TimeContext<'_>, commands: &mut Vec<Command>) {
        if self == Self::Wide {
            show(ui, context, commands);
            return;
        }

        ui.spacing_mut().item_spacing.y = APART;
        let width = ui.available_width();
        let room = vec2(
            width,
            sentence_height(ui.ctx(), context, PLAYER_SIZE, width),
        );
        sentence(ui, context, PLAYER_SIZE, room, ALL_LINES);

        // The limit counts the player's margins, which are not in the width here.
        let room_for_all = ALL_BUTTONS - 2.0 * PLAYER_MARGIN.x;
        let with_ends = self == Self::Narrow && ui.available_width() >= room_for_all;
        ui.horizontal(|ui| {
            controls(ui, context, with_ends, commands);
            ui.add_space(6.0);
            if self == Self::Small {
                track::show(ui, context, commands);
                return;
            }
            clock(ui, context, 64.0, commands);
            if ui.available_width() >= SPEED {
                speed(ui, context, commands);
            }
        });

        if self == Self::Narrow {
            track::show(ui, context, commands);
        }
    }
}

/// Shows the rest of a small window's controls: the whole sentence, counts, speed, the prefix of nested levels, the loop and
/// the curve of the run. The plane through a set in space has no slider here: actions move it.
pub fn more(ui: &mut Ui, context: &TimeContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    // The sentence below the canvas may be cut off.
    ui.label(RichText::new(said(ui.ctx(), context)).size(COMPACT_SIZE))
        .known_as("status-whole");
    for (k, text) in context
        .run
        .moment_texts(context.is_veiled)
        .into_iter()
        .enumerate()
    {
        ui.label(
            RichText::new(ui.words(text))
                .monospace()
                .color(palette.muted),
        )
        .known_as(format_args!("counts-{k}"));
    }

    ui.add_space(4.0);
    speed(ui, context, commands);
    prefix(ui, context, commands);

    ui.horizontal_wrapped(|ui| {
        for (name, command) in [
            ("Loop from here", TimeCommand::LoopStart),
            ("Loop up to here", TimeCommand::LoopEnd),
            ("No loop", TimeCommand::Loop(None)),
        ] {
            // Nested levels have a cursor without events, and can be looped over, too.
            let button =
                ui.add_enabled(context.run.cursor().is_some(), Button::new(ui.words(name)));
            button.known_as(Kebab(&command));
            let refusal = ui.words("There are no events to loop over.");
            let button = button.on_disabled_hover_text(refusal);
            if button.clicked() {
                commands.push(Command::Time(command));
            }
        }
    });

    curve::show_alone(ui, context, commands);
}

/// Shows the buttons that move time; where there is no room, those to the first and last stage are left out, since the
/// track does the same.
fn controls(ui: &mut Ui, context: &TimeContext<'_>, with_ends: bool, commands: &mut Vec<Command>) {
    let palette = context.palette;
    // At the end of the run play begins anew, so that it is refused only without a session.
    let no_session = context
        .run
        .session
        .is_none()
        .then_some("There is no session yet.");

    let [at_end, at_start] = time_refusals(context.run, context.time);
    let (play, play_name) = if context.time.playback.is_playing() {
        (Icon::Pause, "Pause (Space)")
    } else {
        (Icon::Play, "Play (Space)")
    };
    let clock = context.run.clock_name(context.time.playback.clock);
    // Nested levels have no stages.
    let unit = match context.run.prefix() {
        Some(_) if context.run.shows_stipple() => "dot",
        Some(_) => "level",
        None => "stage",
    };

    ui.spacing_mut().item_spacing.x = 2.0;
    for (icon, name, refusal, command) in [
        (
            Icon::First,
            format!("First {unit} (Home)").as_str(),
            at_start,
            Command::Time(TimeCommand::FirstStage),
        ),
        (
            Icon::Back,
            &format!("{} back (Left)", capital(clock)),
            at_start,
            Command::Time(TimeCommand::StepBack),
        ),
        (
            play,
            play_name,
            no_session,
            Command::Time(TimeCommand::TogglePlay),
        ),
        (
            Icon::Forward,
            &format!("{} forward (Right)", capital(clock)),
            at_end,
            Command::Time(TimeCommand::StepForward),
        ),
        (
            Icon::Last,
            &format!("Last {unit} (End)"),
            at_end,
            Command::Time(TimeCommand::LastStage),
        ),
    ] {
        if !with_ends && matches!(icon, Icon::First | Icon::Last) {
            continue;
        }
        let button = icon_button(ui, icon, name, refusal, palette);
        if button.known_as(Kebab(&command)).clicked() {
            commands.push(command);
        }
    }
}

/// Width of the field of the prefix beside its digits, in screen points.
const PREFIX: f32 = 18.0;

/// Shows a field for the number of samples that are shown of nested levels or of a stipple, to be typed or dragged;
/// other sets have no such field.
fn prefix(ui: &mut Ui, context: &TimeContext<'_>, commands: &mut Vec<Command>) {
    let (Some(mut count), Some(session)) = (context.run.prefix(), &context.run.session) else {
        return;
    };
    let all = session.summary.count;
    let field = DragValue::new(&mut count)
        .range(1..=all)
        // A drag over 500 points goes through all samples: 1 / 500 of them for a point.
        .speed(0.002 * all as f64)
        // While a number is typed, its first digits are no prefix that the user asks for.
        .update_while_editing(false);

    // The field is as wide as the largest number needs, at 9 points a digit, so that nothing moves while the number changes.
    let size = vec2(
        PREFIX + 9.0 * all.to_string().len() as f32,
        ui.spacing().interact_size.y,
    );

    // Where there is no room, the field is left out: the track goes to every prefix, too.
    if ui.available_width() < size.x {
        return;
    }

    let response = ui
        .add_sized(size, field)
        .accessible_name(ui.words("Samples shown"));
    response.known_as("prefix");
    if response.changed() {
        commands.push(Command::Time(TimeCommand::Jump(count)));
    }
    response.on_hover_text(ui.words(glossary::PREFIX.meaning));
}

/// Shows the slider of the plane through a set in space and, if events were recorded, the switch by which the plane
/// follows them; planar sets have neither. Where the slider has no room both are left out: J and K move the plane, too.
fn plane(ui: &mut Ui, context: &TimeContext<'_>, commands: &mut Vec<Command>) {
    let Some((depth, mut place)) = context.run.plane_place() else {
        return;
    };
    // The slider and its number take at most a third of the row, as the track follows beside them. A slider of less
    // than a third of its full width is left out. Both thirds were chosen, not measured.
    let width = PLANE.min(ui.available_width() / 3.0 - PLANE_NUMBER);
    if width < PLANE / 3.0 {
        return;
    }

    ui.spacing_mut().slider_width = width;
    let slider = Slider::new(&mut place, 0.0..=depth)
        .prefix("z ")
        // Smart aim would move the plane to round numbers only.
        .smart_aim(false)
        .custom_formatter(|place, _| significant(place));
    let response = ui.add(slider).accessible_name(ui.words("Plane"));
    response.known_as("plane");
    if response.changed() {
        commands.push(Command::View(Which::First, ViewCommand::Plane(place)));
    }
    response.on_hover_text(ui.words(
        "Where the plane that is shown lies along the third axis. J and K move it by a tenth of r.",
    ));

    let mut is_orbit = context.run.orbit().is_some();
    let balls = ui.checkbox(&mut is_orbit, ui.words("Balls"));
    if balls.known_as("plane.balls").changed() {
        let show = ViewCommand::Orbit(OrbitCommand::Show(is_orbit));
        commands.push(Command::View(Which::First, show));
    }
    balls.on_hover_text(ui.words(
        "Shows the whole set as balls of half the radius, cut open at a corner, instead of the plane.",
    ));

    // Without events there is nothing to follow.
    if let Some(mut follows) = context.run.follows_events() {
        let switch = ui.checkbox(&mut follows, ui.words("Follow"));
        switch.known_as("plane.follow");
        if switch.changed() {
            let pin = ViewCommand::PinPlane(!follows);
            commands.push(Command::View(Which::First, pin));
        }
        switch.on_hover_text(
            ui.words("The plane goes where the last event happened. One that is moved stays."),
        );
    }
}

/// Width of the slider of the plane where there is room, and of the number beside it. In a box that is 20 r deep, a
/// slider of 160 points has 8 points for an r.
const PLANE: f32 = 160.0;
const PLANE_NUMBER: f32 = 70.0;

/// Shows the choice of the clock's tick.
fn clock(ui: &mut Ui, context: &TimeContext<'_>, width: f32, commands: &mut Vec<Command>) {
    let playback = &context.time.playback;
    let combo = ComboBox::from_id_salt("clock")
        .width(width)
        .selected_text(ui.words(context.run.clock_name(playback.clock)));

    let shown = combo.show_ui(ui, |ui| {
        for clock in Clock::ALL {
            // A clock that this run lacks stays in the list, with the reason.
            let refusal = context.run.clock_refusal(clock);
            let name = ui.words(context.run.clock_name(clock));
            let button = Button::selectable(playback.clock == clock, name);
            let response = ui.add_enabled(refusal.is_none(), button);
            response.known_as(format_args!("clock.{}", Kebab(clock)));
            let refusal = ui.words(refusal.unwrap_or_default());
            let response = response.on_disabled_hover_text(refusal);
            if response.clicked() {
                commands.push(Command::Time(TimeCommand::Clock(clock)));
            }
        }
    });

    let response = shown.response;
    let name = ui.words("Clock");
    response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, ENABLED, &name));
    response.known_as("clock");
    let tip = "Step by: what the arrow keys, and play tick by tick, advance by.";
    response.on_hover_text(ui.words(tip));
}

/// Shows the choice of the speed.
fn speed(ui: &mut Ui, context: &TimeContext<'_>, commands: &mut Vec<Command>) {
    let playback = &context.time.playback;
    let unit = context.run.clock_name(playback.clock);
    let combo =
        ComboBox::from_id_salt("speed")
            .width(58.0)
            .selected_text(match playback.pace_secs() {
                Some(secs) => format!("{secs} s"),
                None => ui.words(format!("{}\u{d7}", playback.speed)),
            });

    let shown = combo.show_ui(ui, |ui| {
        let by_passes = playback.clock == Clock::Pass;
        // A whole run in a given time divides that time among its events. Passes have no events.
        for secs in WHOLE_RUNS_SECS.into_iter().filter(|_| !by_passes) {
            let same = playback.whole_run_secs == Some(secs);
            let row = ui.selectable_label(same, ui.words(format!("whole run in {secs} s")));
            row.known_as(format_args!("whole-run.{secs}"));
            if row.clicked() {
                commands.push(Command::Time(TimeCommand::WholeRun(secs)));
            }
        }

        for speed in SPEEDS {
            // Speeds that differ by rounding alone are the same. With a pace for the whole run no speed is chosen.
            let same = playback.pace_secs().is_none() && (playback.speed - speed).abs() < 1e-6;
            if ui
                .selectable_label(same, ui.words(format!("{speed}\u{d7} by {unit}")))
                .clicked()
            {
                commands.push(Command::Time(TimeCommand::Speed(speed)));
            }
        }
    });

    let response = shown.response;
    let name = ui.words("Speed");
    response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, ENABLED, &name));
    response.known_as("speed");
    let tip = "How fast play goes: the whole run in a given time, longer where more happens, or tick by tick of the clock.";
    response.on_hover_text(ui.words(tip));
}

#[cfg(test)]
mod tests {
    use super::*;
    use tilescope_session::sentence::stage_sentence;
    use tilescope_workbench::State;

    #[test]
    fn the_sentences_fit_into_the_smallest_player() {
        let mut state = State::new(std::sync::Arc::new(|| {}));
        state.settle();
        let session = state.runs().first.session.clone().expect("a session");
        let recording = session.recording().expect("events");
        let stages = session.stages.iter();
        let mut sentences: Vec<String> = stages
            .map(|stage| stage_sentence(&session, *stage))
            .collect();
        let events = (0..recording.len()).step_by(7);
        let of_events = events.map(|event| tilescope_debugger::sentence(recording, event));
        sentences.extend(of_events.max_by_key(String::len));
        let width = 300.0 - 2.0 * PLAYER_MARGIN.x;
        let ctx = egui::Context::default();
        tilescope_ui::theme::install(&ctx, state.appearance().look);
        let mut cut = Vec::new();
        let _ = ctx.run_ui(egui::RawInput::default(), |ui| {
            for text in &sentences {
                let font = FontId::proportional(PLAYER_SIZE);
                let galley = ui
                    .painter()
                    .layout(text.clone(), font, egui::Color32::WHITE, width);
                // More would leave hardly any canvas in a player 200 points high.
                if galley.rows.len() > 4 {
                    cut.push((galley.size(), text.clone()));
                }
            }
        });
        assert_eq!(cut, Vec::new());
    }
}
