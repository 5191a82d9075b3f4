//! The panel of scenes, which are moments with a view and a caption in the user's order, and of breakpoints with their
//! conditions. The caption of the current scene is drawn over the canvas by `caption.rs`; the actions on scenes are in
//! `workbench/src/state/scenes.rs`. Begin with [`show`]. Sizes are in screen points, and chosen, not measured, where no
//! reason stands beside them.

use egui::{
    Button, Color32, CursorIcon, Id, KeyboardShortcut, Label, RichText, Role, Sense, Stroke,
    StrokeKind, TextEdit, TextWrapMode, Ui, WidgetInfo, vec2,
};
use tilescope_debugger::{Debugger, Direction, Listings, Marked, SavedScene};
use tilescope_drawing::palette::Palette;
use tilescope_session::words::grouped;
use tilescope_ui::widgets::{Icon, Known, heading, icon_button};

use super::common::{no_events, thumbnail_texture};
use super::content::{Content, Room};
use super::context::PanelContext;
use crate::ENABLED;
use crate::actions::keys_of;
use tilescope_workbench::command::{Command, DebugCommand, TimeCommand};
use tilescope_workbench::scenes::{SceneCommand, SceneList, split_caption};
use tilescope_workbench::state::State;
use tilescope_workbench::thumbnails::THUMBNAIL_SIZE;

pub const CONTENT: Content = Content::of_state(Room::Scrolled, |ui, state, commands| {
    let run_on = Command::Time(TimeCommand::Continue(Direction::Forwards));
    show(ui, state, keys_of(state, &run_on), commands);
});

/// Shows the panel; `run_on` are the keys that run to the next breakpoint.
pub fn show(
    ui: &mut Ui,
    state: &State,
    run_on: Option<KeyboardShortcut>,
    commands: &mut Vec<Command>,
) {
    let context = &PanelContext::of(state);
    let palette = context.palette;
    let Some(debugger) = &context.run.debugger else {
        no_events(ui, context);
        return;
    };
    heading(ui, "Scenes");
    if debugger.scenes.is_empty() {
        let text = "Press B to make a scene of this moment and its view. PageDown and PageUp step through them.";
        ui.label(RichText::new(text).color(palette.muted))
            .known_as("no-scenes");
    }

    // The scene that is shown may be one of the tour, which this list does not have.
    let own = state
        .scenes()
        .shown
        .filter(|shown| shown.list == SceneList::Own);
    for (index, scene) in debugger.scenes.iter().enumerate() {
        let listed = ListedScene {
            index,
            scene,
            is_shown: own.is_some_and(|shown| shown.index == index),
        };
        ui.horizontal_top(|ui| {
            picture(ui, state, listed, commands);
            ui.vertical(|ui| row(ui, debugger, listed, palette, commands));
        });
        caption_field(ui, listed, commands);
    }

    ui.add_space(10.0);
    heading(ui, "Breakpoints");
    if debugger.breakpoints().is_empty() {
        let keys = run_on
            .map(|keys| crate::actions::shortcut_text(ui.ctx(), &keys))
            .unwrap_or_default();
        let text =
            format!("A click beside a line of pseudocode sets one; {keys} runs to the next.");
        ui.label(RichText::new(text).color(palette.muted))
            .known_as("no-breakpoints");
    }

    breakpoints(ui, debugger, palette, commands);
    // The number of events at which the breakpoints would stop.
    if let Some(text) = context.run.hits.description() {
        ui.label(RichText::new(text).color(palette.muted))
            .known_as("hits");
    }
}

/// A scene with its place in the list.
#[derive(Clone, Copy)]
struct ListedScene<'a> {
    index: usize,
    scene: &'a SavedScene,
    is_shown: bool,
}

/// Shows the small picture of a scene, in a frame of the accent colour if the scene is shown; a click goes to the
/// scene.
fn picture(
    ui: &mut Ui,
    state: &State,
    ListedScene {
        index,
        scene,
        is_shown,
    }: ListedScene<'_>,
    commands: &mut Vec<Command>,
) {
    let palette = Palette::of(state.appearance().look);
    let [width, height] = THUMBNAIL_SIZE.map(|side| side as f32);
    // The picture is drawn in the background. Its room is kept free, so that nothing moves when it comes.
    let (rect, response) = ui.allocate_exact_size(vec2(width, height), Sense::click());
    let name = format!("Picture of scene {}", index + 1);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, ENABLED, &name));
    response.known_as(format_args!("scene-{}.picture", index + 1));

    let session = state.runs().first.session.as_ref();
    let is_dark = state.appearance().look.is_dark();
    let thumbnail =
        session.and_then(|session| state.scenes().thumbnails.of(session, scene, is_dark));
    if let Some(thumbnail) = thumbnail {
        let id = Id::unique("picture of a scene").with(index);
        let texture = thumbnail_texture(ui, id, thumbnail).id();
        let whole = tilescope_canvas::UNIT;
        ui.painter().image(texture, rect, whole, Color32::WHITE);
    }

    let color = if is_shown {
        palette.accent
    } else {
        palette.line
    };
    ui.painter()
        .rect_stroke(rect, 3.0, Stroke::new(1.5, color), StrokeKind::Inside);

    if response.on_hover_cursor(CursorIcon::PointingHand).clicked() {
        commands.push(Command::Scene(SceneCommand::Show(index)));
    }
}

/// Shows the moment of a scene and the buttons that update, move and remove the scene.
fn row(
    ui: &mut Ui,
    debugger: &Debugger,
    listed: ListedScene<'_>,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let index = listed.index;
    let number = index + 1;
    let mut issue = |command| commands.push(Command::Scene(command));
    if moment(ui, debugger, listed, palette).clicked() {
        issue(SceneCommand::Show(index));
    }

    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        let update = ui.add(Button::new("Update").small());
        update.known_as(format_args!("scene-{number}.replace"));
        let update =
            update.on_hover_text("Gives this scene the current moment and the current view.");
        if update.clicked() {
            issue(SceneCommand::Replace(index));
        }

        // The first scene cannot go up and the last one not down: their buttons say so. Both buttons have the arrows of
        // `Taller` and `Shorter`, which point up and down.
        let no_up = (index == 0).then_some("It is the first.");
        let no_down = (number == debugger.scenes.len()).then_some("It is the last.");
        // Numbers count from 1, so that the number of a scene is the index of the next one.
        let above = SceneCommand::Move(index, index.saturating_sub(1));
        let below = SceneCommand::Move(index, number);
        let remove = SceneCommand::Remove(index);
        let mut button = |icon, name: String, id: &str, refusal, command| {
            let button = icon_button(ui, icon, &name, refusal, palette);
            let id = format_args!("scene-{number}.{id}");
            if button.known_as(id).clicked() {
                issue(command);
            }
        };

        let up_name = format!("Move scene {number} up");
        button(Icon::Taller, up_name, "up", no_up, above);
        let down_name = format!("Move scene {number} down");
        button(Icon::Shorter, down_name, "down", no_down, below);
        let remove_name = format!("Remove scene {number}");
        button(Icon::Close, remove_name, "remove", None, remove);
    });
}

/// Shows the caption of a scene, to be edited.
fn caption_field(
    ui: &mut Ui,
    ListedScene { index, scene, .. }: ListedScene<'_>,
    commands: &mut Vec<Command>,
) {
    let number = index + 1;
    let mut caption = scene.caption.clone();
    let field = TextEdit::multiline(&mut caption)
        .desired_rows(1)
        .hint_text("caption")
        .desired_width(ui.available_width() - 8.0);

    let response = ui.add(field);
    response.widget_info(|| {
        WidgetInfo::labeled(
            Role::TextInput,
            ENABLED,
            format!("Caption of scene {number}"),
        )
    });
    response.known_as(format_args!("scene-{number}.caption"));
    if response.changed() {
        commands.push(Command::Scene(SceneCommand::Caption(index, caption)));
    }
    ui.add_space(6.0);
}

/// Shows the moment of a scene in this run. If the scene was made in another run, the tooltip names its event there.
/// Returns the link to the moment, or the text that says that this run lacks it.
fn moment(
    ui: &mut Ui,
    debugger: &Debugger,
    ListedScene {
        index,
        scene,
        is_shown,
    }: ListedScene<'_>,
    palette: &Palette,
) -> egui::Response {
    let marked = debugger.marked(scene);
    let anchor = scene.anchor.map(|anchor| anchor.to_string());
    let origin = format!(
        "It was made in another run, at event {}{}.",
        grouped(scene.event),
        anchor.map_or(String::new(), |anchor| format!(" ({anchor})"))
    );

    let number = index + 1;
    let Some(cursor) = marked.cursor() else {
        let text = RichText::new(format!("{number}  not in this run")).color(palette.muted);
        let label = ui.label(text);
        label.known_as(format_args!("scene-{number}"));
        return label.on_hover_text(origin);
    };

    // A tilde marks a scene that was made in another run: the event is only the corresponding one of this run.
    let tilde = if matches!(marked, Marked::Here(_)) {
        ""
    } else {
        "~ "
    };
    // The cursor is the number of events that have happened. Events are counted from 0, so that the last one is one less.
    // Before the first event, the tooltip names that one.
    let last = cursor.saturating_sub(1);
    let event = tilescope_debugger::short(debugger.recording(), last);
    let title = match scene_title(scene) {
        Some(title) => title.to_owned(),
        None if cursor == 0 => "before the first event".to_owned(),
        None => event.clone(),
    };

    let mut text = RichText::new(format!("{number}  {title}"));
    if is_shown {
        text = text.strong();
    }

    let scope = ui.scope(|ui| {
        ui.style_mut().wrap_mode = Some(TextWrapMode::Truncate);
        ui.link(text)
    });
    let link = scope.inner;

    let moment = RichText::new(format!("{tilde}event {}", grouped(cursor)))
        .small()
        .monospace();
    ui.label(moment.color(palette.muted))
        .known_as(format_args!("scene-{number}.moment"));
    link.known_as(format_args!("scene-{number}"));
    link.on_hover_text(match marked {
        Marked::Here(_) => event,
        // A scene that this run lacks was shown above.
        _ => format!("{event}\n{origin} This is the corresponding event of its stage."),
    })
}

/// Returns the first words of a scene's caption, if it has one: its title.
fn scene_title(scene: &SavedScene) -> Option<&str> {
    let first = split_caption(&scene.caption).0.lines().next()?.trim();
    (!first.is_empty()).then_some(first)
}

/// Shows each breakpoint with its condition, and with the condition's error, if it has one.
fn breakpoints(ui: &mut Ui, debugger: &Debugger, palette: &Palette, commands: &mut Vec<Command>) {
    for (index, breakpoint) in debugger.breakpoints().iter().enumerate() {
        let line = Listings::shipped().line(breakpoint.line);
        // A breakpoint keeps the number of its line, which the listings may lack.
        let id = line.map_or("?", |line| line.id.as_str());
        let parameters = &debugger.recording().run().parameters;
        let words = line.map_or_else(String::new, |line| line.text(parameters));

        ui.horizontal(|ui| {
            let name = format!("Remove the breakpoint on {id}");
            let remove = icon_button(ui, Icon::Close, &name, None, palette);
            let command = Command::Debug(DebugCommand::RemoveBreakpoint(index));
            remove.issues(format_args!("{id}.remove"), command, commands);
            let mut enabled = breakpoint.enabled;
            let switch = ui.checkbox(&mut enabled, id);
            if switch.known_as(format_args!("{id}.enabled")).changed() {
                commands.push(Command::Debug(DebugCommand::Enable(index, enabled)));
            }
            // The number of a line does not say what it does, so that its words stand beside it.
            let text = RichText::new(words)
                .small()
                .monospace()
                .color(palette.muted);
            ui.add(Label::new(text).truncate());
        });

        let mut condition = breakpoint.condition.clone();
        let field = TextEdit::singleline(&mut condition)
            .align(egui::Align2::LEFT_CENTER)
            .hint_text("condition, such as block == 7 && distance < 0.9")
            .code_editor()
            .desired_width(ui.available_width() - 8.0);
        let response = ui.add(field);
        response.widget_info(|| {
            WidgetInfo::labeled(Role::TextInput, ENABLED, format!("Condition on {id}"))
        });
        response.known_as(format_args!("{id}.condition"));
        if response.changed() {
            commands.push(Command::Debug(DebugCommand::Condition(index, condition)));
        }

        if let Some(error) = breakpoint.error() {
            ui.label(RichText::new(error.to_string()).color(palette.conflict))
                .known_as(format_args!("{id}.refusal"));
        }
        ui.add_space(4.0);
    }
}
