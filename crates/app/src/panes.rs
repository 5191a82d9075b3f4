//! The canvas: one picture of a moment, or two of compared runs side by side, with their input. It arranges the
//! pictures; drawing them is in `tilescope-canvas`.

mod buffers;
mod input;
mod menu;
mod objects;
mod orbit;
mod painting;
mod titles;
mod views;

use eframe::egui_wgpu::RenderState;
use egui::{Rect, Sense, Ui, Vec2, vec2};

use crate::ENABLED;
pub(crate) use input::has_focus;
pub use input::leads_zoom;
use orbit::OrbitPane;
use painting::CanvasBrush;
use tilescope_canvas::pane::Pane;
use tilescope_canvas::sprites::Sprites;
use tilescope_canvas::touch::Touch;
use tilescope_canvas::{hint, hover, overlay};
use tilescope_core::Stage;
use tilescope_drawing::palette::Palette;
use tilescope_drawing::subject::{GroundView, Subject};
use tilescope_session::look::Look;
use tilescope_session::moment::ShownMoment;
use tilescope_session::sentence::happened;
use tilescope_session::words::{counted, grouped, significant};
use tilescope_ui::language::Worded;
use tilescope_ui::widgets::Known;
use tilescope_workbench::command::{Command, ViewCommand, Which};
use tilescope_workbench::passes::OnCanvas;
use tilescope_workbench::state::{RunView, Runs, State, no_side_by_side};

/// The context of the canvas.
pub struct CanvasContext<'a> {
    palette: &'static Palette,
    look: Look,
    runs: &'a Runs,
    /// Run A's subject, and run B's.
    subjects: [Option<Subject<'a>>; 2],
    /// The rows of a GPU buffer, if they are shown.
    rows: Option<OnCanvas<'a>>,
    /// Whether the window is embedded in another page.
    is_embedded: bool,
    /// Whether it is the stage of a talk, which shows the picture and nothing about it.
    is_stage: bool,
    /// Whether panels take a part of the canvas when they open.
    is_compact: bool,
    /// What the list of objects has.
    listing: Listing,
    /// The brush that paints radii on run A, if it is chosen.
    brush: Option<CanvasBrush>,
    /// The pictures of run A where it is not compared with another: that of the set, and perhaps others beside it.
    views: Vec<GroundView>,
}

/// What the list of the objects in view has.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Listing {
    /// All objects.
    Whole,
    /// Nothing, while time runs by itself: objects come and go faster than anybody could read them.
    Empty,
    /// There is no list while a question of a lesson is open. Its answers are a list of their own, and objects could give one
    /// away.
    Withheld,
}

impl<'a> CanvasContext<'a> {
    /// Creates the context of a window's canvas.
    #[must_use]
    pub fn of(state: &'a State) -> Self {
        let (runs, appearance, window) = (state.runs(), state.appearance(), state.window());
        let causes = state.analysis().causes(&runs.first, window);
        let clock = state.time().playback.clock;

        // An open question is looked for first: while it is open the run does not play, and all objects would be
        // listed.
        let listing = if state.lessons().open_question().is_some() {
            Listing::Withheld
        } else if state.time().playback.is_playing() {
            Listing::Empty
        } else {
            Listing::Whole
        };

        Self {
            palette: Palette::of(appearance.look),
            look: appearance.look,
            runs,
            subjects: [
                runs.subject(Which::First, appearance, causes),
                // The causes of a brush are found for run A alone.
                runs.subject(Which::Second, appearance, None),
            ],
            rows: runs.first.buffers_on_canvas(window, appearance.look, clock),
            is_embedded: window.embedding.is_some(),
            is_stage: state.talks().open.is_some(),
            is_compact: window.drawer.arrangement.is_compact(),
            listing,
            brush: CanvasBrush::of(state),
            views: views_of(state),
        }
    }
}

/// Returns the pictures of run A where it is not compared with another.
fn views_of(state: &State) -> Vec<GroundView> {
    let run = &state.runs().first;
    // The pattern is shown alone: at that stage the set is not there.
    let is_free = no_side_by_side(state).is_none() && run.current_stage() != Some(Stage::Pattern);
    let session = run.session.as_deref();
    match session.filter(|_| is_free && state.appearance().is_side_by_side) {
        Some(session) => views::of_session(session),
        None => vec![GroundView::Set],
    }
}

/// The state of the canvas between frames.
#[derive(Default)]
pub struct Canvas {
    first: Pane,
    second: LatePane,
    dots: LatePane,
    /// The pictures of radii and of the shape have no samples, and need no device.
    radii: Pane,
    shape: Pane,
    /// Symbols for the rows of buffers.
    marks: Sprites,
}

/// A picture that creates its pipelines when it is first shown, since that takes a while.
#[derive(Default)]
struct LatePane {
    pane: Pane,
    /// The device, until the pipelines are there.
    device: Option<RenderState>,
}

impl LatePane {
    fn ready(&mut self) -> &mut Pane {
        if let Some(device) = self.device.take() {
            self.pane.draw_with(&device);
        }
        &mut self.pane
    }
}

impl Canvas {
    /// From now on draws samples by instancing on the device of `render_state`.
    pub fn draw_with(&mut self, render_state: &RenderState) {
        self.first.draw_with(render_state);
        for late in [&mut self.second, &mut self.dots] {
            late.device = Some(render_state.clone());
        }
    }

    /// Shows the canvas in the remaining space of `ui`.
    pub fn show(&mut self, ui: &mut Ui, context: &CanvasContext<'_>, commands: &mut Vec<Command>) {
        // A window may leave the canvas no room: views are fitted in at least a point.
        let size = ui.available_size().max(vec2(1.0, 1.0));
        let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
        let subject = context.subjects[0];

        let Some((second, comparison)) = &context.runs.second else {
            self.show_views(ui, rect, context, commands);
            return;
        };

        // The two pictures leave a gap, in which this colour is seen as a line between them.
        ui.painter().rect_filled(rect, 0.0, context.palette.line);
        let [left, right] = titles::halves(rect);
        // A heading takes the upper edge of its half, and returns the rest for the picture.
        let left = PaneSide {
            rect: titles::heading(ui, left, context, &titles::first_title(context)),
            which: Which::First,
            view: GroundView::Set,
            name: "Canvas of run A",
            subject,
            main: None,
            is_led: true,
        };
        left.show(ui, context, &mut self.first, &mut self.marks, commands)
            .known_as("canvas-a");

        let subject = context.subjects[1];
        let right = PaneSide {
            rect: titles::heading(ui, right, context, &titles::second_title(context, second)),
            which: Which::Second,
            view: GroundView::Set,
            name: "Canvas of run B",
            subject,
            main: None,
            is_led: true,
        };
        right
            .show(ui, context, self.second.ready(), &mut self.marks, commands)
            .known_as("canvas-b");

        // With linked cameras the pointer over one picture is marked at the same place of the other.
        titles::echo(
            ui,
            [left.rect, right.rect],
            [&left.subject, &right.subject],
            comparison,
            context,
        );
    }

    /// Shows run A alone, in one picture or in several.
    fn show_views(
        &mut self,
        ui: &mut Ui,
        rect: Rect,
        context: &CanvasContext<'_>,
        commands: &mut Vec<Command>,
    ) {
        let views = &context.views;
        let size = context.subjects[0].map(|subject| subject.shown.session.size_radii());
        let aspect = size.map_or(1.0, |size| (size.x / size.y) as f32);
        let tiles = views::tiles(rect, views.len(), aspect);
        let is_alone = views.len() == 1;

        // The picture that the pointer is in says what lies there; without a pointer that of the set clears what was said.
        let of_set = views.iter().position(|view| *view == GroundView::Set);
        let main = of_set.map(|index| tiles[index]);
        let pointer = ui.input(|input| input.pointer.interact_pos());
        let has_pointer = |tile: &Rect| pointer.is_some_and(|at| tile.contains(at));
        let led = tiles.iter().position(has_pointer).or(of_set);

        if !is_alone {
            // Pictures leave gaps, in which this colour is seen as lines between them.
            ui.painter().rect_filled(rect, 0.0, context.palette.line);
        }

        for (index, (view, tile)) in views.iter().copied().zip(tiles).enumerate() {
            let subject = context.subjects[0].map(|subject| Subject {
                view,
                layers: views::layers(view, subject.layers),
                ..subject
            });
            let [name, id] = views::canvas(view);
            let side = PaneSide {
                which: Which::First,
                view,
                rect: if is_alone { rect } else { tile },
                name,
                subject,
                main: main.filter(|_| !is_alone),
                is_led: led == Some(index),
            };
            let pane = match view {
                GroundView::Set => &mut self.first,
                GroundView::Dots => self.dots.ready(),
                GroundView::Radii => &mut self.radii,
                GroundView::Shape => &mut self.shape,
            };
            side.show(ui, context, pane, &mut self.marks, commands)
                .known_as(id);
        }
    }
}

/// One of the pictures and its rectangle.
struct PaneSide<'a> {
    which: Which,
    view: GroundView,
    rect: Rect,
    name: &'a str,
    subject: Option<Subject<'a>>,
    /// The rectangle of the picture of the set, where others are beside it.
    main: Option<Rect>,
    /// Whether it says what the pointer is over. Of several pictures of a run one does, since they would contradict each other.
    is_led: bool,
}

/// Describes a picture by its moment, for those who do not see it. A pointer over it names the object there instead.
fn describe(ui: &Ui, response: &egui::Response, subject: &Subject<'_>) {
    let shown = &subject.shown;
    let mut moment = ui.words(happened(Some(shown)));
    if let Some(plane) = in_plane(shown) {
        moment = format!("{moment} {}", ui.words(plane));
        // Within a throw nothing else says how many cubes are active.
        let active = (shown.plane).and_then(|at| shown.session.active_in_plane(shown.stage, at));
        if let Some(active) = active {
            moment = format!("{moment} {}.", ui.words(active));
        }
    }
    ui.ctx()
        .accesskit_node_builder(response.id, |node| node.set_description(moment));
}

/// Returns what the plane through a set in space shows, where the words for the moment are those of an event; `None` where they
/// are about the plane already, and of planar sets.
fn in_plane(shown: &ShownMoment<'_>) -> Option<String> {
    let (solid, plane) = shown.session.solid.as_ref().zip(shown.plane)?;
    let debugger = shown.debugger.filter(|_| !shown.ends_stage())?;
    // Samples of darts stay once they are there, in the order of their ids.
    let count = debugger.state().counts().kept;
    let place = significant(solid.users_from_plane(plane));
    let cut = grouped(solid.count_cut_of(count, plane));
    let balls = counted(count, "ball", "balls");
    Some(format!("The plane z = {place} cuts {cut} of {balls}."))
}

impl PaneSide<'_> {
    /// Shows one picture with its input, and returns its response. On the stage of a talk, nothing but the scale and
    /// the rows of a buffer, if they are shown, lies over it.
    fn show(
        &self,
        ui: &mut Ui,
        context: &CanvasContext<'_>,
        pane: &mut Pane,
        marks: &mut Sprites,
        commands: &mut Vec<Command>,
    ) -> egui::Response {
        let rect = self.rect;
        let response = ui.interact(rect, ui.scope_id().with(self.name), Sense::click_and_drag());
        let name = ui.words(self.name);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, ENABLED, &name));

        let run = context.runs.get(self.which);
        // The state fits and frames views, and needs the rectangle for that: of several pictures that of the set.
        let is_main = self.view == GroundView::Set;
        if is_main && run.is_some_and(|run| run.viewport != rect) {
            commands.push(Command::View(self.which, ViewCommand::Viewport(rect)));
        }

        let palette = self.palette(context);
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, palette.outside);

        let Some(subject) = &self.subject else {
            let is_sampling = run.is_some_and(|run| run.sampling.is_some());
            overlay::waiting(&painter, rect, is_sampling, palette);
            return response;
        };

        if let Some(orbit) = run.and_then(RunView::orbit) {
            let pane = OrbitPane {
                which: self.which,
                rect,
                session: subject.shown.session,
                orbit,
                palette,
                is_bare: context.is_stage,
                is_embedded: context.is_embedded,
            };
            pane.show(ui, &response, commands);
            return response;
        }

        let brush = self.brush(context);
        // This is called once a frame. It keeps the state of the fingers for the next call. A second call in one frame
        // would take two fingers that are lifted for a tap.
        let touch = Touch::follow(ui, &response);
        let is_painted = brush.is_some();
        let mut moves = Vec::new();
        let pointer = input::handle(
            ui, &response, subject, context, is_painted, touch, &mut moves,
        );
        // The other pictures have no pointer in them, and would say that it is over nothing.
        moves.retain(|command| self.is_led || !matches!(command, ViewCommand::Hover(_)));
        commands.extend(
            (moves.into_iter())
                .map(|command| self.in_main(command))
                .map(|command| Command::View(self.which, command)),
        );
        // The entries of the menu lead to panels, which an embedded window and the stage of a talk lack.
        if !context.is_embedded && !context.is_stage {
            menu::show(ui, &response, subject, self.which, commands);
        }

        let note_on_samples = pane.paint(ui, rect, subject, palette);
        // Only run A has passes of the GPU, whose buffers have rows.
        let has_rows = is_main && self.which == Which::First;
        let note = match context.rows.filter(|_| has_rows) {
            Some(rows) => buffers::show(ui, rect, subject, &rows, palette, marks, note_on_samples),
            None => note_on_samples,
        };

        if let Some(brush) = brush {
            brush.follow(ui, &response, touch.hand, subject, commands);
        }
        overlay::scale_bar(&painter, rect, subject, palette);
        // The stage of a talk has no texts that explain the picture: the lecturer does.
        if context.is_stage {
            return response;
        }

        overlay::cursor(&painter, rect, subject, pointer, palette);
        let mut below = rect;
        if self.main.is_some() {
            below.min.y = views::write_name(&painter, rect, self.view, palette);
        }
        overlay::note(&painter, below, subject, note.as_deref(), palette);
        if self.is_led {
            hint::show(&painter, rect, palette);
        }

        // The moment is that of the set. The names of the other pictures say what they show of it.
        if is_main {
            describe(ui, &response, subject);
        }
        // A projector's type is large, so that a whole card would cover the picture.
        let is_brief = context.look.is_projector();
        if pointer.is_some() {
            hover::show(ui, &painter, &response, subject, palette, is_brief);
        }

        // One list is enough: the others would have the same objects.
        if is_main && context.listing != Listing::Withheld {
            self.list(context, subject, &name).show(ui, commands);
        }
        response
    }

    /// Returns the colours. Dots are ink on paper in every look, as a stipple is printed; otherwise that of a photograph would be its
    /// negative in a dark look. The dots of an inverted image are light.
    fn palette(&self, context: &CanvasContext<'_>) -> &'static Palette {
        let is_inverted =
            (self.subject.as_ref()).is_some_and(|subject| subject.shown.session.is_inverted());
        match self.view {
            GroundView::Dots if is_inverted => Palette::of(Look::Dark),
            GroundView::Dots => Palette::of(Look::Light),
            _ => context.palette,
        }
    }

    /// Returns the brush that paints this picture, if one does: the form is that of run A.
    fn brush<'a>(&self, context: &'a CanvasContext<'_>) -> Option<&'a CanvasBrush> {
        let brush = context.brush.as_ref();
        brush.filter(|_| self.which == Which::First)
    }

    /// Returns a command with the places of the screen that the picture of the set has for them.
    fn in_main(&self, command: ViewCommand) -> ViewCommand {
        let moved = self
            .main
            .map_or(Vec2::ZERO, |main| main.min - self.rect.min);
        match command {
            ViewCommand::Zoom(at, factor) => ViewCommand::Zoom(at + moved, factor),
            command => command,
        }
    }

    /// Returns the list of the objects in view, for the keyboard and for screen readers.
    fn list<'a>(
        &self,
        context: &CanvasContext<'a>,
        subject: &'a Subject<'a>,
        name: &'a str,
    ) -> objects::ObjectList<'a> {
        objects::ObjectList {
            which: self.which,
            name,
            rect: self.rect,
            subject,
            palette: context.palette,
            is_empty: context.listing == Listing::Empty,
        }
    }
}
