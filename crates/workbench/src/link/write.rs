//! Writes a link: all parts that differ from an empty link, in a fixed order, up to a limited length.

use std::ops::Range;

use serde_json::Value;
use tilescope_classroom::lessons::WantedLesson;
use tilescope_core::{NestedRequest, Parameters, WithinLevel};
use tilescope_debugger::{SavedBreakpoint, SavedScene};
use tilescope_drawing::camera::Camera;
use tilescope_session::combination::NINE;
use tilescope_session::ground::{GroundRequest, PortableGround};
use tilescope_session::words::counted;

use super::content::{LinkContent, NamedMoment};
use super::parameters::differing;
use super::text::{base64, escaped, exact, item, name, rings_text, rounded};
use super::view::{layers_text, scene_view_text, selection_text};
use super::{
    MAX_CHARACTERS, MAX_COMBINATION, MAX_SCENES, MAX_STOPS, MAX_TEXT, VERSION, VERSION_OF_OTHERS,
};
use crate::layout;

/// A permalink, as it was written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Link {
    /// The fragment of the address, without its `#`: at most [`MAX_CHARACTERS`] letters, digits and marks.
    pub fragment: String,
    /// The settings that the link leaves out, as phrases such as "the panel layout".
    pub left_out: Vec<String>,
}

/// The keys of nested levels: how many, their number of samples, and their order within a level.
pub(super) const NESTED: [&str; 3] = ["levels", "exactly", "order-within"];

/// The keys of a field and a shape: the radius as a function, the corners of a polygon, and the lower corner of the domain.
pub(super) const GROUND: [&str; 3] = ["radius-expression", "shape", "origin"];

/// The key of what a set has that its link lacks, and its one value. A reader of the link is told that it leads to another set.
pub(super) const LACKS: &str = "lacks";
pub(super) const LACKS_GROUND: &str = "ground";

/// The name that stands for the paper's combination of nine sets; others are written by their layout.
pub(super) const NINE_SETS: &str = "nine";

/// Writes a link, as much of it as the limits allow.
#[must_use]
pub fn write(content: &LinkContent) -> Link {
    let mut writer = Writer::default();
    // The language comes last, behind parts that may fill the link.
    writer.language(content);
    let reserved = writer.text.len() + 1;
    writer = Writer {
        reserved,
        ..Writer::default()
    };
    // The lowest version that holds the run, so that older programs read the link where they can. A lesson makes its own runs.
    let ground = content.ground.as_ref().filter(|_| content.lesson.is_none());
    let tiles_shape = ground.is_some_and(|ground| ground.is_tiled(&content.parameters));
    let version = if tiles_shape {
        VERSION
    } else {
        VERSION_OF_OTHERS
    };
    writer.put("v", version.to_string());

    if let Some(lesson) = &content.lesson {
        // A lesson makes its own runs, and its steps choose the view.
        writer.lesson(lesson);
        writer.language(content);
        return Link {
            fragment: writer.text,
            left_out: Vec::new(),
        };
    }

    writer.run(content);
    writer.look(content);
    writer.second(content);
    writer.stops(content);
    writer.panels(content);
    writer.language(content);

    Link {
        fragment: writer.text,
        left_out: writer.left_out,
    }
}

#[derive(Default)]
struct Writer {
    text: String,
    left_out: Vec<String>,
    /// Characters at the end of the link that no part but the language may take.
    reserved: usize,
}

impl Writer {
    fn put(&mut self, key: &str, value: impl AsRef<str>) {
        if !self.text.is_empty() {
            self.text.push('&');
        }
        self.text.push_str(key);
        self.text.push('=');
        self.text.push_str(value.as_ref());
    }

    /// Returns the number of characters left for the value of a key: `&` and `=` take two.
    fn room(&self, key: &str) -> usize {
        MAX_CHARACTERS.saturating_sub(self.reserved + self.text.len() + key.len() + 2)
    }

    fn lesson(&mut self, lesson: &WantedLesson) {
        self.put("lesson", escaped(&lesson.name));
        if let Some(step) = &lesson.step {
            self.put("step", escaped(step));
        }
        if let Some(seed) = lesson.practice {
            self.put("practice", seed.to_string());
        }
    }

    fn language(&mut self, content: &LinkContent) {
        if let Some(language) = &content.language {
            self.put("language", escaped(language));
        }
    }

    /// Writes the run and its moment.
    fn run(&mut self, content: &LinkContent) {
        match &content.combination {
            Some(layout) => self.combination(layout),
            None => self.parameters("", &content.parameters, &Parameters::default()),
        }

        if let Some(nested) = &content.nested {
            self.nested(nested);
        }
        if let Some(ground) = &content.ground {
            self.ground(ground);
        }
        if content.lacks_ground {
            self.put(LACKS, LACKS_GROUND);
        }
        if let Some(depth) = content.depth {
            self.put("depth", exact(depth));
        }

        match &content.moment {
            // A link without a moment shows the end.
            NamedMoment::End => {}
            NamedMoment::Event(cursor) => self.put("at", cursor.to_string()),
            NamedMoment::Rank(below) => self.put("rank", exact(*below)),
            NamedMoment::Stage(stage) => self.put("stage", escaped(stage)),
        }
    }

    fn parameters(&mut self, prefix: &str, parameters: &Parameters, base: &Parameters) {
        for (key, value) in differing(parameters, base) {
            self.put(&format!("{prefix}{key}"), value);
        }
    }

    fn nested(&mut self, request: &NestedRequest) {
        let [levels, exactly, order_within] = NESTED;
        self.put(levels, request.levels.to_string());
        if let Some(count) = request.exactly {
            self.put(exactly, count.to_string());
        }
        if request.order_within != WithinLevel::default() {
            self.put(order_within, name(&request.order_within));
        }
    }

    /// Writes the field and the shape.
    fn ground(&mut self, request: &GroundRequest) {
        let [expression, shape, origin] = GROUND;
        // A request with an image was left out before.
        let Some(portable) = PortableGround::of(request) else {
            return;
        };

        if let Some(text) = &portable.radius_expression {
            self.put(expression, escaped(text));
        }
        if !portable.rings.is_empty() {
            self.put(shape, rings_text(&portable.rings));
        }
        if portable.origin.iter().any(|&at| at != 0.0) {
            self.put(origin, portable.origin.map(exact).join(","));
        }
    }

    /// Writes the layout of a combination, unless it is too long.
    fn combination(&mut self, layout: &tilescope_core::combine::file::Layout) {
        let nine = tilescope_core::combine::file::Layout::from_json(NINE.as_bytes());
        let value = if nine.is_ok_and(|nine| nine == *layout) {
            NINE_SETS.to_owned()
        } else {
            // Writing to memory does not fail.
            let json = serde_json::to_string(layout).unwrap_or_default();
            base64(json.as_bytes())
        };

        if value.len() <= MAX_COMBINATION {
            self.put("combine", value);
        } else {
            self.left_out
                .push("the combination, whose layout is too long for a link".to_owned());
        }
    }

    /// Writes the parts of the view that differ from those of an empty link, so that the link stays short.
    fn look(&mut self, content: &LinkContent) {
        let empty_link = LinkContent::default();
        if let Some(Camera { center, scale }) = content.view.camera {
            let numbers = [center[0], center[1], scale].map(rounded);
            self.put("camera", numbers.join(","));
        }

        if let Some(place) = content.view.plane {
            // Not rounded, so that the link shows the same disks.
            self.put("plane", format!("z:{}", exact(place)));
        }
        if let Some(orbit) = content.view.orbit {
            self.put("orbit", orbit.to_string());
        }

        if let Some(layers) = content.view.appearance.chosen_layers {
            self.put("layers", layers_text(layers));
        }
        if content.view.appearance.colouring != empty_link.view.appearance.colouring {
            self.put("colouring", name(&content.view.appearance.colouring));
        }
        if content.view.appearance.look != empty_link.view.appearance.look {
            self.put("look", name(&content.view.appearance.look));
        }
        if content.view.appearance.curve.number.is_some() {
            self.put("curve", content.view.appearance.curve.to_string());
        }

        if let Some(selection) = selection_text(content.view.selection) {
            self.put("select", selection);
        }

        let playback = &content.view.playback;
        // A link has no passes of the GPU, and so no clock that counts them.
        let clock = playback.clock_of_events();
        let is_default_clock = clock == empty_link.view.playback.clock;
        if !is_default_clock {
            self.put("clock", name(&clock));
        }

        match playback.whole_run_secs {
            None => self.put("speed", playback.speed.to_string()),
            // A link without a clock and a speed plays the whole run in the default time, which need not be written. A
            // link with a clock plays at a speed unless a time is written, even if it is the default time.
            secs if is_default_clock && secs == empty_link.view.playback.whole_run_secs => {}
            Some(secs) => self.put("whole-run", secs.to_string()),
        }

        if let Some(Range { start, end }) = &content.view.playback.range {
            self.put("loop", format!("{start}-{end}"));
        }
    }

    /// Writes the second run, if there is one: in what it is linked with the first, and the parameters that differ.
    fn second(&mut self, content: &LinkContent) {
        let (Some(parameters), links) = (&content.view.second, &content.view.links) else {
            return;
        };
        let switches = LINKS.into_iter().zip(links);
        let names: Vec<&str> = switches
            .filter_map(|(name, on)| on.then_some(name))
            .collect();
        self.put("b", names.join(","));
        self.parameters("b.", parameters, &content.parameters);
    }

    /// Writes breakpoints, watches, and scenes with their views.
    fn stops(&mut self, content: &LinkContent) {
        // A condition or a watch that is too long is left out whole, because without its end it would mean something else. A caption
        // only loses its end.
        let fits = |text: &str| text.chars().count() <= MAX_TEXT;

        let breakpoint = |b: &SavedBreakpoint| {
            let condition = b.condition.as_deref().unwrap_or_default();
            fits(condition).then(|| {
                // A mark before a breakpoint says that it is off.
                let off = if b.enabled { "" } else { "!" };
                let colon = if condition.is_empty() { "" } else { ":" };
                format!("{off}{}{colon}{}", b.line, escaped(&item(condition)))
            })
        };

        let watch = |text: &String| fits(text).then(|| escaped(&item(text)));
        // A scene is written as its event, its run and its anchor if it is of another run, and its caption.
        let scene_text = |scene: &SavedScene| {
            let shortened: String = scene.caption.chars().take(MAX_TEXT).collect();
            let colon = if shortened.is_empty() { "" } else { ":" };
            let run = match &scene.anchor {
                _ if scene.run.is_empty() => String::new(),
                Some(anchor) => format!("@{}@{anchor}", escaped(&item(&scene.run))),
                None => format!("@{}", escaped(&item(&scene.run))),
            };
            let caption = escaped(&item(&shortened));
            Some(format!("{}{run}{colon}{caption}", scene.event))
        };

        let breakpoints = &content.breakpoints;
        self.list("break", "breakpoints", MAX_STOPS, breakpoints, breakpoint);
        self.list("watch", "watches", MAX_STOPS, &content.watches, watch);
        let written = self.list("mark", "scenes", MAX_SCENES, &content.scenes, scene_text);
        // Only scenes that were written get views. Those are the first ones, as none in between is left out: each view
        // belongs to the scene at its position.
        self.views(&content.scenes[..written]);

        let long = content.scenes.iter().filter(|scene| !fits(&scene.caption));
        match long.count() {
            0 => {}
            count => self.left_out.push(format!(
                "the ends of {} of more than {MAX_TEXT} characters",
                counted(count, "caption", "captions")
            )),
        }
    }

    /// Writes the views of scenes, if there are any.
    fn views(&mut self, scenes: &[SavedScene]) {
        let mut views: Vec<&Value> = scenes.iter().map(|scene| &scene.view).collect();
        // Scenes at the end of the list that have no view need no placeholder.
        while views.pop_if(|view| view.is_null()).is_some() {}
        let view_text = |view: &&Value| Some(scene_view_text(view));
        self.list(
            "mark-view",
            "views of scenes",
            MAX_SCENES,
            &views,
            view_text,
        );
    }

    /// Writes as many items as the limits allow, and returns how many. `what` names the items where some are left out;
    /// `item` gives the text of one, or `None` for one that no link can have. For scenes and their views, whose
    /// positions count, `item` is never `None`.
    fn list<T>(
        &mut self,
        key: &str,
        what: &str,
        most: usize,
        all: &[T],
        item: impl Fn(&T) -> Option<String>,
    ) -> usize {
        let (mut text, mut taken, room) = (String::new(), 0, self.room(key));

        for written in all.iter().filter_map(item).take(most) {
            // The first item that does not fit ends the list. If only that item were left out, later scenes would be
            // at other positions, and would get the views of other scenes. The 1 is for the semicolon.
            if text.len() + written.len() + 1 > room {
                break;
            }
            if taken > 0 {
                text.push(';');
            }
            text.push_str(&written);
            taken += 1;
        }

        if taken > 0 {
            self.put(key, text);
        }

        if taken < all.len() {
            let missing = all.len() - taken;
            self.left_out
                .push(format!("{missing} of {} {what}", all.len()));
        }
        taken
    }

    /// Writes the layout of the panels. All parts that may be long come before it, so that the layout is the first
    /// part to be left out for lack of room.
    fn panels(&mut self, content: &LinkContent) {
        let default_layout = layout::text::written(&LinkContent::default().view.layout);
        let layout = layout::text::written(&content.view.layout);
        if layout == default_layout {
            return;
        }
        if layout.len() <= self.room("layout") {
            self.put("layout", layout);
        } else {
            self.left_out.push("the panel layout".to_owned());
        }
    }
}

/// The settings that can be linked between two runs; names in links.
pub(super) const LINKS: [&str; 3] = ["cameras", "clocks", "differences"];
