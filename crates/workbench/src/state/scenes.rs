//! Scenes: makes, changes and shows them, draws their small pictures, and shows the tour.

use serde_json::{Value, json};
use tilescope_debugger::{Debugger, Direction, Marked, SavedScene};
use tilescope_session::selection::Selection;
use tilescope_session::solid::MadeSolid;

use super::effects::{Context, Effect};
use super::{RunView, Runs, WindowState};
use crate::command::Command;
use crate::layout::{Layout, Panel};
use crate::scene_lesson::{NO_GROUND, lesson_of};
use crate::scenes::{SceneCommand, SceneList, ShownScene, split_caption};
use crate::thumbnails::Thumbnails;
use crate::tour::tour;
use crate::view::{SavedView, SceneCamera};

/// The parts of a [`SavedView`] that a scene keeps; its camera is a [`SceneCamera`].
const PARTS: [&str; 7] = [
    "plane",
    "orbit",
    "layers",
    "colouring",
    "look",
    "layout",
    "selection",
];

impl SceneList {
    /// Returns the scenes of the list.
    #[must_use]
    pub fn scenes(self, run: &RunView) -> Vec<&SavedScene> {
        match self {
            Self::Tour => tour().iter().map(|scene| &scene.scene).collect(),
            Self::Own => {
                let debugger = run.debugger.as_ref();
                debugger.map_or_else(Vec::new, |debugger| debugger.scenes.iter().collect())
            }
        }
    }
}

/// Scenes in the state of the window; those of the user are kept with the run.
#[derive(Default)]
pub struct Scenes {
    /// The scene that is shown, if one is.
    pub shown: Option<ShownScene>,
    /// Small pictures of the user's scenes.
    pub thumbnails: Thumbnails,
}

/// What scenes use of the rest of the window.
pub(super) struct SceneSource {
    /// The current view, as it is saved.
    pub view: SavedView,
    /// The layout of the panels.
    pub layout: Layout,
    /// Whether the panel of the scenes is visible.
    pub has_panel: bool,
    /// Whether the window is embedded in another page, whose layout stays.
    pub is_embedded: bool,
}

impl Scenes {
    /// Returns whether the tour is shown.
    #[must_use]
    pub fn is_touring(&self) -> bool {
        self.shown
            .is_some_and(|shown| shown.list == SceneList::Tour)
    }

    /// Returns the caption of the scene that is shown.
    #[must_use]
    pub fn caption<'a>(&self, run: &'a RunView) -> Option<&'a str> {
        let ShownScene { list, index } = self.shown?;
        let scene = list.scenes(run).into_iter().nth(index)?;
        let (caption, _note) = split_caption(&scene.caption);
        Some(caption)
    }

    /// Draws the pictures of the scenes while their panel is open.
    pub(super) fn follow_thumbnails(&mut self, runs: &Runs, window: &WindowState, dark: bool) {
        if let (Some(session), Some(debugger)) = (&runs.first.session, &runs.first.debugger)
            && window.shows(Panel::Scenes)
        {
            let wake = &runs.jobs.wake;
            self.thumbnails.follow(session, debugger, dark, wake);
        }
    }

    /// Applies a command to the scenes of a run, and shows them in it.
    pub(super) fn apply(
        &mut self,
        command: SceneCommand,
        run: &mut RunView,
        source: &SceneSource,
        context: &mut Context,
    ) {
        let count = SceneList::Own.scenes(run).len();
        match command {
            SceneCommand::Add => self.add(run, source, context),
            SceneCommand::Replace(index) => {
                let view = scene_view(run, &source.view);
                // The new scene, of the current moment, takes the place and the caption of the old one.
                change_scenes(run, |debugger| {
                    if let Some(caption) = debugger.scenes.get(index).map(|s| s.caption.clone()) {
                        debugger.scenes.remove(index);
                        debugger.add_scene(index, view);
                        debugger.scenes[index].caption = caption;
                    }
                });
            }

            SceneCommand::Caption(index, text) => change_scenes(run, |debugger| {
                if let Some(scene) = debugger.scenes.get_mut(index) {
                    scene.caption = text;
                }
            }),

            SceneCommand::Remove(index) => {
                change_scenes(run, |debugger| {
                    if index < debugger.scenes.len() {
                        debugger.scenes.remove(index);
                    }
                });
                // The removed scene may be the one that is shown, and those behind it have other indices now. Which one
                // was shown is not followed up here, as `Move` does: after a removal no scene of the user is shown. A
                // scene of the tour, which is in another list, stays.
                self.shown = self.shown.filter(|_| self.is_touring());
            }

            SceneCommand::Move(from, to) => {
                if from < count && to < count {
                    change_scenes(run, |debugger| {
                        let scene = debugger.scenes.remove(from);
                        debugger.scenes.insert(to, scene);
                    });
                    self.follow_moved(from, to);
                }
            }

            SceneCommand::Show(index) => self.show(SceneList::Own, index, run, source, context),
            SceneCommand::Step(direction) => self.step(direction, run, source, context),
            SceneCommand::Tour => context.ask(Effect::StartTour),
            SceneCommand::Offer(index) => self.take_offer(index, context),
            SceneCommand::Leave => self.leave(context),
        }
    }

    /// Asks for the commands of a button of the tour's scene.
    fn take_offer(&self, index: usize, context: &mut Context) {
        let Some(shown) = self.shown.filter(|shown| shown.list == SceneList::Tour) else {
            return;
        };
        let offers = tour().get(shown.index).map(|scene| &scene.offers);
        let Some(offer) = offers.and_then(|offers| offers.get(index)) else {
            return;
        };
        for command in &offer.commands {
            context.ask(Effect::Issue(Box::new(command.clone())));
        }
    }

    /// Corrects the index of the shown scene after a scene was moved.
    fn follow_moved(&mut self, from: usize, to: usize) {
        if let Some(ShownScene { list, index }) = &mut self.shown
            && *list == SceneList::Own
        {
            // The index of the shown scene in the list without the moved one.
            let without = *index - usize::from(*index > from);
            *index = if *index == from {
                to
            } else {
                without + usize::from(without >= to)
            };
        }
    }

    /// Makes a scene of the moment, behind the one that is shown, or at the end of the list.
    fn add(&mut self, run: &mut RunView, source: &SceneSource, context: &mut Context) {
        let view = scene_view(run, &source.view);
        let at = match self.shown {
            Some(shown) if shown.list == SceneList::Own => shown.index + 1,
            // At a position beyond the end, the new scene becomes the last one.
            _ => usize::MAX,
        };
        let before = SceneList::Own.scenes(run).len();
        change_scenes(run, |debugger| debugger.add_scene(at, view));
        if let Some(shown) = &mut self.shown
            && shown.list == SceneList::Own
        {
            // The new scene, behind the shown one, is of the moment that is shown: from now on it is the shown scene.
            shown.index += 1;
        }

        let is_added = SceneList::Own.scenes(run).len() > before;
        if is_added && !source.has_panel {
            // The panel would show the new scene; without it there is no other sign that the key did something.
            let number = at.min(before) + 1;
            let text = format!("Scene {number} is made of this moment: it is in the panel Scenes.");
            context.ask(Effect::TellBriefly(text));
        }
    }

    /// Shows the scene before or after the one that is shown.
    fn step(
        &mut self,
        direction: Direction,
        run: &mut RunView,
        source: &SceneSource,
        context: &mut Context,
    ) {
        // If no scene is shown, the user's first one comes next, and none is before it.
        let (list, to) = match (self.shown, direction) {
            (None, Direction::Forwards) => (SceneList::Own, Some(0)),
            (None, Direction::Backwards) => (SceneList::Own, None),
            (Some(shown), Direction::Forwards) => (shown.list, Some(shown.index + 1)),
            (Some(shown), Direction::Backwards) => (shown.list, shown.index.checked_sub(1)),
        };

        let len = list.scenes(run).len();
        match to {
            Some(index) if index < len => self.show(list, index, run, source, context),
            // After its last scene the tour is over.
            Some(_) if list == SceneList::Tour => self.leave(context),
            // Before the first scene and after the user's last one, the shown scene stays.
            _ => {}
        }
    }

    /// Removes the caption. The tour gives back what it replaced.
    fn leave(&mut self, context: &mut Context) {
        if self.is_touring() {
            context.ask(Effect::EndTour);
        } else {
            self.shown = None;
        }
    }

    /// Shows a scene of a list.
    pub(super) fn show(
        &mut self,
        list: SceneList,
        index: usize,
        run: &mut RunView,
        source: &SceneSource,
        context: &mut Context,
    ) {
        let Some(scene) = list.scenes(run).get(index).map(|&scene| scene.clone()) else {
            return;
        };

        if list == SceneList::Own && self.is_touring() {
            // The tour ends first, so that the scene is shown in the user's own run, which comes back.
            let show = Command::Scene(SceneCommand::Show(index));
            context.ask(Effect::EndTour);
            return context.ask(Effect::Issue(Box::new(show)));
        }

        self.shown = Some(ShownScene { list, index });
        // The last scene of the tour is about the panels, which the tour had hidden.
        if list == SceneList::Tour && index + 1 == tour().len() {
            context.ask(Effect::BringPanels);
        }
        // While the run is still being made, nothing can be shown. Once there is a run, `State::finish_sampling` shows the scene again.
        arrive_at(&scene, run, source, context);
    }
}

fn change_scenes(run: &mut RunView, change: impl FnOnce(&mut Debugger)) {
    if let Some(debugger) = &mut run.debugger {
        change(debugger);
    }
}

/// Returns the current view for a scene.
fn scene_view(run: &RunView, view: &SavedView) -> Value {
    // A fitted view has no camera: it fits any canvas. Without a canvas there is no positive size, and 1 stands for it.
    // `radii` says how many radii the shorter side shows. Runs of other parameters have the current event elsewhere: its
    // place tells by how much the camera has to be moved there.
    let camera = (!run.is_fitted()).then(|| SceneCamera {
        radii: f64::from(run.viewport.size().min_elem().max(1.0)) / run.camera.scale,
        center: Some(run.camera.center),
        event: run.current_place(),
    });

    let mut view = view.to_json();
    if let Some(parts) = view.as_object_mut() {
        parts.retain(|name, _| PARTS.contains(&name.as_str()));
        if let Some(camera) = camera {
            parts.insert("camera".to_owned(), json!(camera));
        }
    }
    view
}

/// Goes to the moment of a scene, and looks at it as the scene does.
fn arrive_at(scene: &SavedScene, run: &mut RunView, source: &SceneSource, context: &mut Context) {
    let Some(debugger) = &run.debugger else {
        return;
    };
    let marked = debugger.marked(scene);
    let Some(cursor) = marked.cursor() else {
        let text = "This run has no such moment: the scene was made in another run.";
        return context.tell(text.to_owned());
    };

    // Play would leave the moment of the scene at once.
    context.ask(Effect::Pause);
    let before = run.stage;
    run.jump(cursor);
    run.moved(before);

    if !scene.view.is_null() {
        let is_same_run = matches!(marked, Marked::Here(_));
        look_as(&scene.view, is_same_run, run, source, context);
    }
}

/// Applies the view of a scene; `is_same_run` if it was made in this run. Parts that are missing or invalid stay as they
/// are, but without a camera the domain is fitted.
fn look_as(
    view: &Value,
    is_same_run: bool,
    run: &mut RunView,
    source: &SceneSource,
    context: &mut Context,
) {
    // Parts that the scene lacks stay as they are now, but for three. If the scene has no selection, nothing is
    // selected. If it has no plane, the plane follows the events. If it has no balls, the plane is shown.
    let now = SavedView {
        selection: Selection::Nothing,
        plane: None,
        layout: source.layout.clone(),
        ..source.view.clone()
    };
    let (saved, _invalid) = SavedView::from_json(view, &now);
    context.ask(Effect::Appearance(Box::new(saved.appearance)));
    // If the scene has no layout, the panels stay as they are, also those that the tour has just brought back.
    if !source.is_embedded && view.get("layout").is_some() {
        context.ask(Effect::Layout(saved.layout));
    }

    // In another run the selected number is that of another sample, and at a selected place lies something else.
    let can_select = is_same_run && run.can_select(saved.selection);
    let selection = if can_select {
        saved.selection
    } else {
        Selection::Nothing
    };
    run.pick(selection, context);
    run.cut_at_users(saved.plane);
    run.take_orbit(saved.orbit);

    let placed = SceneCamera::of(view).and_then(|camera| {
        let center = camera.placed(run.current_place(), is_same_run)?;
        Some((center, camera.radii))
    });

    match placed {
        Some((center, radii)) => run.fly_to(center, radii, context),
        None => run.fit(context),
    }
}

impl RunView {
    /// Returns a lesson with a step for each scene.
    ///
    /// # Errors
    ///
    /// Those of [`lesson_of`].
    pub(crate) fn lesson_of_scenes(&self) -> Result<String, String> {
        let (Some(session), Some(debugger)) = (&self.session, &self.debugger) else {
            return Err("There is no session with events.".to_owned());
        };
        if session.ground.is_some() {
            return Err(NO_GROUND.to_owned());
        }
        // The run of a set in space has the insertion by darts, which its form does not name.
        let solid = session.solid.as_ref();
        let parameters = solid.map_or(&session.run().parameters, |solid| &solid.asked);
        let (depth, has_own_pattern) = (solid.map(MadeSolid::depth), session.own.is_some());
        lesson_of(&debugger.scenes, parameters, depth, has_own_pattern)
    }
}

#[cfg(test)]
mod tests {
    use super::super::State;
    use super::super::tests::settled;
    use super::*;
    use crate::command::{FormCommand, TimeCommand, ViewCommand, Which};
    use glam::DVec2;
    use tilescope_core::RunEvent;
    use tilescope_debugger::{Event, Target};
    use tilescope_drawing::camera::Camera;
    use tilescope_session::layers::Layer;

    fn scene(state: &mut State, command: SceneCommand) {
        state.apply(Command::Scene(command));
    }

    fn rest(state: &mut State) {
        while state.advance(0.1) {}
    }

    /// Returns the cursor, the camera and the layers of the state.
    fn seen(state: &State) -> (Option<(usize, usize)>, Camera, bool, bool) {
        let run = &state.runs.first;
        let layers = state.appearance.layers(state.runs.first.current_stage());
        (
            state.runs.first.cursor(),
            run.camera,
            run.is_fitted(),
            layers.has(Layer::Voronoi),
        )
    }

    /// A state with three scenes: the whole domain, a place with other layers, and the end.
    fn with_scenes() -> State {
        let mut state = settled();
        let viewport = emath::Rect::from_min_size(emath::pos2(0.0, 0.0), emath::vec2(800.0, 600.0));
        state.apply(Command::View(Which::First, ViewCommand::Viewport(viewport)));
        state.apply(Command::Time(TimeCommand::Jump(5_000)));
        scene(&mut state, SceneCommand::Add);
        state.apply(Command::Time(TimeCommand::Jump(12_000)));
        let fly = ViewCommand::FlyTo([30.0, 40.0].into(), 20.0);
        state.apply(Command::View(Which::First, fly));
        rest(&mut state);
        let layer = crate::command::AppearanceCommand::ToggleLayer(Layer::Voronoi);
        state.apply(Command::Appearance(layer));
        scene(&mut state, SceneCommand::Add);
        state.apply(Command::Time(TimeCommand::LastStage));
        scene(&mut state, SceneCommand::Add);
        state
    }

    #[test]
    fn scenes_come_back_as_they_were_made_in_their_order() {
        let mut state = with_scenes();
        let mut views = Vec::new();
        for index in 0..3 {
            scene(&mut state, SceneCommand::Show(index));
            rest(&mut state);
            views.push(seen(&state));
        }
        assert_eq!(views[0].0.map(|(at, _)| at), Some(5_000));
        assert_eq!(views[1].0.map(|(at, _)| at), Some(12_000));
        assert!(views[0].2 && !views[1].2 && !views[0].3 && views[1].3);
        assert!(views[1].1.center.distance([30.0, 40.0].into()) < 1e-9);
        // A step goes on from the scene that is shown, and stays at the ends of the list.
        scene(&mut state, SceneCommand::Step(Direction::Forwards));
        assert_eq!(state.scenes.shown.map(|shown| shown.index), Some(2));
        for index in [1, 0, 0] {
            scene(&mut state, SceneCommand::Step(Direction::Backwards));
            rest(&mut state);
            assert_eq!(state.scenes.shown.map(|shown| shown.index), Some(index));
            assert_eq!(seen(&state), views[index]);
        }
        // The first one, which is shown, becomes the second one.
        scene(&mut state, SceneCommand::Move(2, 0));
        assert_eq!(state.scenes.shown.map(|shown| shown.index), Some(1));
        scene(&mut state, SceneCommand::Show(1));
        rest(&mut state);
        assert_eq!(seen(&state), views[0]);
        scene(&mut state, SceneCommand::Remove(1));
        assert_eq!(SceneList::Own.scenes(&state.runs.first).len(), 2);
        assert!(state.scenes.shown.is_none());
    }

    #[test]
    fn scenes_survive_other_parameters_and_end_where_the_stage_ends() {
        let mut state = with_scenes();
        state.apply(Command::Form(FormCommand::Type(
            tilescope_core::Parameter::Seed,
            "7".to_owned(),
        )));
        state.apply(Command::Run);
        state.settle();
        scene(&mut state, SceneCommand::Show(2));
        rest(&mut state);
        assert!(state.runs.first.is_at_end());
        scene(&mut state, SceneCommand::Show(1));
        rest(&mut state);
        let run = &state.runs.first;
        let at = run
            .camera
            .screen_from_domain(run.viewport, run.current_place().unwrap());
        let made = with_scenes();
        let (there, place) = {
            let mut made = made;
            scene(&mut made, SceneCommand::Show(1));
            rest(&mut made);
            let run = &made.runs.first;
            let place = run.current_place().unwrap();
            (run.camera.screen_from_domain(run.viewport, place), place)
        };
        // The event has the same position in the view, but another one in the domain.
        assert!(at.distance(there) < 0.1, "{at:?} {there:?}");
        assert!(place.distance(run.current_place().unwrap()) > 1.0);
    }

    #[test]
    fn every_scene_of_the_tour_is_there_and_short() {
        let mut state = settled();
        scene(&mut state, SceneCommand::Tour);
        for (index, of_tour) in tour().iter().enumerate() {
            assert!(state.scenes.is_touring());
            assert_eq!(state.scenes.shown.map(|shown| shown.index), Some(index));
            assert!(state.messages.notice.is_none(), "{}", of_tour.title);
            let words = of_tour.scene.caption.split_whitespace().count();
            assert!(
                (5..=40).contains(&words),
                "{}: {words} words",
                of_tour.title
            );
            let view = &of_tour.scene.view;
            let (_, invalid) = SavedView::from_json(view, &SavedView::default());
            let camera = view.get("camera");
            assert!(invalid.iter().all(|&part| part == "camera"), "{invalid:?}");
            assert_eq!(camera.is_some(), SceneCamera::of(view).is_some());
            scene(&mut state, SceneCommand::Step(Direction::Forwards));
        }
        assert!(state.scenes.shown.is_none());
        assert_eq!(tour().len(), 12);
    }

    /// Returns how far the samples are from the point that an event examines, nearest first, in r.
    fn distances(state: &State, place: DVec2) -> Vec<f64> {
        let run = &state.runs.first;
        let shown = run.shown().unwrap();
        let mut found = Vec::new();
        shown.session.index.visit(place, place, 3.0, |seen| {
            if shown.covers(seen.id) {
                found.push(seen.position.distance(place));
            }
        });
        found.sort_by(f64::total_cmp);
        found
    }

    #[test]
    fn scenes_of_the_tour_show_what_they_say_away_from_the_border() {
        let mut state = settled();
        // A laptop's canvas.
        let size = emath::vec2(1280.0, 560.0);
        let viewport = emath::Rect::from_min_size(emath::pos2(0.0, 0.0), size);
        state.apply(Command::View(Which::First, ViewCommand::Viewport(viewport)));
        scene(&mut state, SceneCommand::Tour);
        for of_tour in tour() {
            rest(&mut state);
            let run = &state.runs.first;
            if !run.is_fitted() {
                let (low, high) = run.camera.visible(viewport);
                let end = run.session.as_ref().unwrap().size_radii();
                let is_inside = low.cmpge(DVec2::ZERO).all() && high.cmple(end).all();
                assert!(is_inside, "{}: {low} to {high} of {end}", of_tour.title);
            }
            let debugger = run.debugger.as_ref().unwrap();
            let (recording, cursor) = (debugger.recording(), debugger.state().cursor());
            let event = |at: usize| recording.event(at).and_then(Event::run_event);
            match event(cursor.saturating_sub(1)) {
                // The block has its whole copy.
                Some(RunEvent::Tiled { .. }) => {
                    assert!(!matches!(event(cursor), Some(RunEvent::Tiled { .. })));
                }
                // The label beside the pair's middle covers neither of them: the line leads from the upper left to the
                // lower right, and no other sample is near.
                Some(RunEvent::Eliminate { sample, by }) => {
                    let session = run.session.as_ref().unwrap();
                    let from = session.position(by);
                    let way = session.image_near(sample, from) - from;
                    assert!(way.x * way.y < 0.0 && way.length() > 0.5, "{way}");
                }
                // The circle is seen to be empty: three samples on it, the next one well outside, and an open area that
                // is larger than the mark in its middle.
                Some(RunEvent::Candidate { .. }) => {
                    let near = distances(&state, run.current_place().unwrap());
                    assert!(near[0] > 1.12 && near[2] - near[0] < 1e-3, "{near:?}");
                    assert!(near[3] > near[0] + 0.2, "{near:?}");
                }
                _ => {}
            }
            if of_tour.title != tour()[tour().len() - 1].title {
                scene(&mut state, SceneCommand::Step(Direction::Forwards));
            }
        }
    }

    #[test]
    fn every_scene_has_a_picture_of_its_own() {
        let mut state = with_scenes();
        state.window.open_panel(Panel::Scenes);
        let pictures = |state: &State| -> Vec<Option<Vec<u8>>> {
            let run = &state.runs.first;
            let (session, debugger) = (run.session.as_ref(), run.debugger.as_ref());
            let (session, debugger) = (session.unwrap(), debugger.unwrap());
            let of = |scene| state.scenes.thumbnails.of(session, scene, true);
            let scenes = debugger.scenes.iter();
            scenes
                .map(|scene| of(scene).map(|made| made.rgba.clone()))
                .collect()
        };
        state.settle();
        let pictures = pictures(&state);
        assert!(pictures.iter().all(Option::is_some));
        assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2]);
        // A picture shows more than one colour.
        for picture in pictures.into_iter().flatten() {
            let first = picture[..4].to_vec();
            assert!(picture.chunks(4).any(|pixel| pixel != first));
        }
    }

    #[test]
    fn pictures_of_the_whole_domain_show_what_is_near_their_events() {
        let mut state = with_scenes();
        while !SceneList::Own.scenes(&state.runs.first).is_empty() {
            scene(&mut state, SceneCommand::Remove(0));
        }
        state.apply(Command::View(Which::First, ViewCommand::Fit));
        for target in [Target::Elimination, Target::Insertion] {
            let next = TimeCommand::RunTo(target, Direction::Forwards);
            state.apply(Command::Time(TimeCommand::FirstStage));
            state.apply(Command::Time(next));
            // Running to the event has flown there.
            state.apply(Command::View(Which::First, ViewCommand::Fit));
            scene(&mut state, SceneCommand::Add);
        }
        state.window.open_panel(Panel::Scenes);
        state.settle();
        let run = &state.runs.first;
        let (session, debugger) = (run.session.as_ref(), run.debugger.as_ref());
        let (session, debugger) = (session.unwrap(), debugger.unwrap());
        let of = |scene| state.scenes.thumbnails.of(session, scene, true).unwrap();
        let [first, second] = &debugger.scenes[..] else {
            panic!("two scenes");
        };
        assert!(crate::view::SceneCamera::of(&first.view).is_none());
        let pixels = of(first).rgba.chunks(4).zip(of(second).rgba.chunks(4));
        let len = pixels.len();
        let other = pixels.filter(|(a, b)| a != b).count();
        // Of the whole domain they differed in 4 of 100 pixels.
        assert!(other * 4 > len, "{other} of {len}");
    }
}
