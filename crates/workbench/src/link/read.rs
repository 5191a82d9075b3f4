//! Reads a link, each part independently of the others. Parts that are unknown, invalid or beyond limits are
//! named in warnings.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use glam::DVec2;

use tilescope_classroom::lessons::WantedLesson;
use tilescope_core::combine::file::{Layout as Combination, PieceSource, PlacedPiece};
use tilescope_core::{
    MAXIMAL_DENSITY, NestedRequest, Parameters, PatternSpec, TilingMethod, WithinLevel,
};
use tilescope_debugger::{Listings, SavedBreakpoint, SavedScene};
use tilescope_drawing::camera::Camera;
use tilescope_drawing::orbit::OrbitView;
use tilescope_session::combination::NINE;
use tilescope_session::ground::{GroundRequest, PortableGround};
use tilescope_session::language;
use tilescope_session::layers::Colouring;
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;
use tilescope_session::words::{grouped, quoted};

use super::content::{LinkContent, NamedMoment};
use super::parameters::{self, in_links, link_key};
use super::text::{finite, from_base64, items, named, numbers, pairs, rings_of};
use super::view::{read_layers, read_scene_view, read_selection};
use super::warnings::LinkWarnings;
use super::write::{GROUND, LACKS, LACKS_GROUND, LINKS, NESTED, NINE_SETS};
use super::{
    MAX_BYTES, MAX_COMBINATION, MAX_SAMPLES, MAX_SCENES, MAX_STOPS, MAX_TEXT, VERSION,
    VERSION_OF_OTHERS,
};
use crate::clock::Clock;
use crate::curve::ShownCurve;
use crate::layout;
use crate::view::{speed, whole_run};

/// The keys of a link besides the parameters of its runs.
const OTHERS: &str = "v levels exactly order-within radius-expression shape origin lacks depth combine at rank stage camera plane orbit layers colouring look curve select clock speed whole-run loop b break watch mark \
     mark-view layout lesson step practice language";

/// The keys of texts that people write, in which every character counts.
const FREE_TEXTS: [&str; 5] = ["break", "watch", "mark", "mark-view", "radius-expression"];

/// Every colouring, in the sequence of their numbers in links.
pub const COLOURINGS: [Colouring; 5] = [
    Colouring::Block,
    Colouring::Provenance,
    Colouring::Age,
    Colouring::Level,
    Colouring::Depth,
];
const CLOCKS: [Clock; 3] = [Clock::Event, Clock::Line, Clock::Stage];

/// Reads a fragment, with or without its `#`, or a whole address. Returns the nearest content that may be
/// opened, and warnings about parts that were changed or ignored. Time and memory are limited for any text.
#[must_use]
pub fn read(text: &str) -> (LinkContent, LinkWarnings) {
    let mut reader = LinkReader {
        pairs: HashMap::new(),
        warnings: LinkWarnings::default(),
    };
    reader.split(text);
    let version = reader.version();
    let mut content = LinkContent::default();
    reader.lesson(&mut content);
    reader.run(&mut content);
    reader.look(&mut content);
    reader.selection(&mut content);
    // After the run, from which the parameters of the second one differ.
    reader.second(&mut content);
    // Methods are replaced only here, as the second run's parameters are given by their differences from those of the link.
    reader.method(&mut content);
    // An older link leads to the same samples as when it was copied.
    let is_tiled = |ground: &GroundRequest| ground.is_tiled(&content.parameters);
    if version < VERSION && content.ground.as_ref().is_some_and(is_tiled) {
        content.parameters.method = TilingMethod::Kdrt;
    }
    reader.stops(&mut content);
    (content, reader.warnings)
}

struct LinkReader {
    pairs: HashMap<String, String>,
    warnings: LinkWarnings,
}

/// Returns every key except those of a second run, which are prefixed by `b.`.
#[cfg(test)]
pub fn keys() -> impl Iterator<Item = &'static str> {
    OTHERS.split(' ').chain(in_links().map(link_key))
}

/// Returns whether a link of this version may have this key.
fn is_known(key: &str) -> bool {
    let of_run = |key: &str| in_links().any(|parameter| link_key(parameter) == key);
    OTHERS.split(' ').any(|other| other == key)
        || of_run(key)
        || key.strip_prefix("b.").is_some_and(of_run)
}

impl LinkReader {
    /// Splits a link into its keys and values.
    fn split(&mut self, text: &str) {
        let text = text.trim();
        let fragment = text.split_once('#').map_or(text, |(_, fragment)| fragment);
        let limited = self.cut(fragment);

        for (key, value) in pairs(limited).flat_map(parted) {
            let name = quoted(&key);
            match self.pairs.entry(key) {
                Entry::Occupied(_) => self
                    .warnings
                    .add(format!("\"{name}\" is there twice; the first one counts.")),
                Entry::Vacant(entry) if is_known(entry.key()) => drop(entry.insert(value)),
                Entry::Vacant(_) => self
                    .warnings
                    .add(format!("\"{name}\" is unknown in links and was left out.")),
            }
        }
    }

    /// Returns the beginning of a text within the limit, cut behind a whole pair of key and value.
    fn cut<'a>(&mut self, text: &'a str) -> &'a str {
        if text.len() <= MAX_BYTES {
            return text;
        }
        self.warnings.add(format!(
            "The link has {} bytes; everything after the first {} was left out.",
            grouped(text.len()),
            grouped(MAX_BYTES)
        ));

        let mut end = MAX_BYTES;
        // Bytes are counted, and a character may have several.
        while !text.is_char_boundary(end) {
            end -= 1;
        }

        let start = &text[..end];
        // The last pair may have lost its end, and would be read as another value.
        start.rfind('&').map_or("", |separator| &start[..separator])
    }

    /// Reads the lesson and the language.
    fn lesson(&mut self, content: &mut LinkContent) {
        let known = |text: &str| {
            language::TAGS
                .into_iter()
                .find(|name| text.eq_ignore_ascii_case(name))
        };
        // A language counts without a lesson as well: for the lessons that are opened later.
        content.language = self.take("language", |text| known(text).map(str::to_owned));

        // Without a lesson, a step and a practice ask for nothing, and are left out without a warning.
        let Some(lesson) = self.take("lesson", name) else {
            return;
        };
        content.lesson = Some(WantedLesson {
            name: lesson,
            step: self.take("step", name),
            practice: self.take("practice", |text| text.parse().ok()),
        });
    }

    /// Returns the version by which the link is read: the newest, unless it names an older one. Warns if it names one that is
    /// not known.
    fn version(&mut self) -> u32 {
        let Some(text) = self.pairs.get("v") else {
            return VERSION;
        };
        let shown = quoted(text);
        // The parts of a link do not depend on each other, so that a newer link is read as far as its parts are known.
        match tidy(text).parse::<u32>() {
            Ok(known @ VERSION_OF_OTHERS..=VERSION) => return known,
            Ok(newer) if newer > VERSION => self.warnings.add(format!(
                "The link is of version {newer}, and this program knows version {VERSION}; what it knows was read."
            )),
            _ => self.warnings.add(format!(
                "The link says that its version is \"{shown}\"; it was read as version {VERSION}."
            )),
        }
        VERSION
    }

    /// Returns the value of a key, read by `read`; warns if it is invalid.
    fn take<T>(&mut self, key: &str, read: impl FnOnce(&str) -> Option<T>) -> Option<T> {
        let text = self.pairs.get(key)?;
        let taken = read(tidy(text));
        if taken.is_none() {
            let text = quoted(text);
            self.warnings.add(format!(
                "The link's {key} \"{text}\" is invalid and was left out."
            ));
        }
        taken
    }

    /// Reads the run and its moment.
    fn run(&mut self, content: &mut LinkContent) {
        content.combination = self.combination();
        // The layout of a combination has the parameters of each of its sets, so that it needs none of these parts.
        if content.combination.is_none() {
            let texts = |key: &str| self.pairs.get(key).map(|text| tidy(text));
            content.parameters =
                parameters::read(texts, &Parameters::default(), "", &mut self.warnings);
            content.depth = self.depth(&content.parameters);
            content.nested = self.nested(&content.parameters);
            content.ground = self.ground(&content.parameters);
            // A set in a field or a shape has no levels: they are removed from the content, with a warning if there
            // were any.
            if content.ground.is_some() && content.nested.take().is_some() {
                let text =
                    "The link's nested levels were left out: they have one radius in a rectangle.";
                self.warnings.add(text.to_owned());
            }
        }

        if content.depth.is_some() && (content.nested.is_some() || content.ground.is_some()) {
            (content.nested, content.ground) = (None, None);
            let text = "The link's nested levels, field or shape were left out: a set in space has one radius in a box.";
            self.warnings.add(text.to_owned());
        }

        let lacks = self.take(LACKS, |text| (text == LACKS_GROUND).then_some(()));
        content.lacks_ground = lacks.is_some();
        if content.lacks_ground {
            let text = "The link was copied from a set with an image, such as painted radii, or a very long polygon, which no link holds: another set is shown.";
            self.warnings.add(text.to_owned());
        }

        let at = self.take("at", |text| text.parse().ok());
        let stage = self.take("stage", name);
        // The samples with ranks below the link's rank are shown. All ranks of samples are at least 0 and below 1, so
        // that 0 would show no sample, and 1 shows all samples.
        let is_rank = |rank: &f64| *rank > 0.0 && *rank <= 1.0;
        let rank = self.take("rank", |text| finite(text).filter(is_rank));
        // An event, or a number of samples, is more exact than a rank, and a rank more than a stage.
        content.moment = match (at, rank, stage) {
            (Some(cursor), ..) => NamedMoment::Event(cursor),
            (None, Some(below), _) => NamedMoment::Rank(below),
            (None, None, Some(stage)) => NamedMoment::Stage(stage),
            (None, None, None) => NamedMoment::End,
        };
    }

    /// Replaces the method of a set that darts make, of which no sample depends on the method. The reader of the link may expect
    /// blocks, so that a warning names it.
    fn method(&mut self, content: &mut LinkContent) {
        let asked = content.parameters.method;
        content.parameters = content.recipe().with_its_method().parameters;
        if content.parameters.method != asked {
            let text = "The link's method \"exact\" was left out: darts make sets in space and sets whose radius varies.";
            self.warnings.add(text.to_owned());
        }
    }

    /// Returns the third side, if the link has one with which a box can be filled.
    fn depth(&mut self, parameters: &Parameters) -> Option<f64> {
        let depth = self.take("depth", finite)?;
        let why = match tilescope_session::solid::expected_samples(parameters, depth) {
            Ok(samples) if samples <= MAX_SAMPLES => return Some(depth),
            Ok(samples) => format!(
                "the box has about {} samples, and a link may ask for {}",
                grouped(samples as usize),
                grouped(MAX_SAMPLES as usize)
            ),
            Err(error) => error.to_string(),
        };
        self.warnings
            .add(format!("The link's depth was left out: {why}."));
        None
    }

    /// Returns the nested levels, if the link has some that can be made with `parameters`.
    fn nested(&mut self, parameters: &Parameters) -> Option<NestedRequest> {
        let [levels_key, exactly_key, order_key] = NESTED;
        // These are read before the number of levels, so that invalid ones are named in warnings even if that number is missing.
        let exactly = self.take(exactly_key, |text| text.parse().ok());
        let order = self.take(order_key, |text| named(&WithinLevel::ALL, text));

        let Some(levels) = self.take(levels_key, |text| text.parse().ok()) else {
            if exactly.is_some() || order.is_some() {
                let text = "The link says how nested levels are made but not how many (\"levels\"): they were left out.";
                self.warnings.add(text.to_owned());
            }
            return None;
        };

        let request = NestedRequest {
            levels,
            exactly,
            order_within: order.unwrap_or_default(),
        };

        // A link may not ask for as many samples as the program can make.
        let refusal = if super::content::allows(&request) {
            request
                .check(parameters)
                .err()
                .map(|error| error.to_string())
        } else {
            let most = grouped(MAX_SAMPLES as usize);
            Some(format!(
                "they have more samples than the {most} that a link may ask for"
            ))
        };

        if let Some(why) = &refusal {
            self.warnings
                .add(format!("The link's nested levels were left out: {why}."));
        }
        refusal.is_none().then_some(request)
    }

    /// Returns the field and the shape, if the link has some that can be made with `parameters`.
    fn ground(&mut self, parameters: &Parameters) -> Option<GroundRequest> {
        let [expression_key, shape_key, origin_key] = GROUND;
        // Every character of a formula counts, also a parenthesis at its end.
        let radius_expression = self.pairs.get(expression_key).cloned();
        let rings = self.take(shape_key, rings_of);
        let origin = self.take(origin_key, numbers);
        // A corner of the domain alone asks for nothing.
        if radius_expression.is_none() && rings.is_none() {
            return None;
        }

        let portable = PortableGround {
            radius_expression,
            rings: rings.unwrap_or_default(),
            origin: origin.unwrap_or_default(),
        };
        // A short look at the formula finds why it is refused, or about how many samples there would be.
        let checked = portable.request().and_then(|request| {
            let samples = match &request {
                Some(request) => request.recipe(parameters).glance()?,
                // There is no request if there is no formula and the list of rings is empty. This does not occur,
                // because `rings_of` returns no empty list.
                None => 0.0,
            };
            Ok((request, samples))
        });

        let why = match checked {
            Ok((request, samples)) if samples <= MAX_SAMPLES => return request,
            Ok((_, samples)) => format!(
                "it has about {} samples, and a link may ask for {}",
                grouped(samples as usize),
                grouped(MAX_SAMPLES as usize)
            ),
            Err(error) => error.to_string(),
        };
        self.warnings
            .add(format!("The link's field or shape was left out: {why}."));
        None
    }

    fn combination(&mut self) -> Option<Combination> {
        let text = tidy(self.pairs.get("combine")?);
        let layout = combination(text);
        if let Err(why) = &layout {
            self.warnings
                .add(format!("The link's combination was left out: {why}."));
        }
        layout.ok()
    }

    /// Reads the view: camera, layers, colours, playback and panels.
    fn look(&mut self, content: &mut LinkContent) {
        content.view.camera = self.take("camera", |text| {
            let [x, y, scale] = numbers(text)?;
            Camera::checked(DVec2::new(x, y), scale)
        });

        // Planes lie across the third axis alone.
        content.view.plane = self.take("plane", |text| finite(text.strip_prefix("z:")?));
        content.view.orbit = self.take("orbit", OrbitView::read);

        if let Some(names) = self.take("layers", |text| Some(text.to_owned())) {
            let (layers, unknown) = read_layers(&names);
            content.view.appearance.chosen_layers = layers;
            for name in unknown.into_iter().map(quoted) {
                self.warnings
                    .add(format!("There is no layer \"{name}\"; it was left out."));
            }
        }

        // Where a part is missing or invalid, the view has what a new window has.
        if let Some(colouring) = self.take("colouring", |text| named(&COLOURINGS, text)) {
            content.view.appearance.colouring = colouring;
        }
        if let Some(look) = self.take("look", |text| named(&Look::ALL, text)) {
            content.view.appearance.look = look;
        }
        if let Some(curve) = self.take("curve", ShownCurve::read) {
            content.view.appearance.curve = curve;
        }

        if let Some(clock) = self.take("clock", |text| named(&CLOCKS, text)) {
            content.view.playback.choose(clock);
            // A new window plays the whole run in a given time. A link that names a clock is played by the ticks of that clock, as older
            // links are, unless it names a time as well.
            content.view.playback.whole_run_secs = None;
        }

        if let Some(speed) = self.take("speed", |text| speed(text.parse().ok()?)) {
            content.view.playback.choose_speed(speed);
        }
        // This is read after the clock and the speed, because choosing one of these ends playing by a duration.
        if let Some(secs) = self.take("whole-run", |text| whole_run(text.parse().ok()?)) {
            content.view.playback.whole_run_secs = Some(secs);
        }

        content.view.playback.range = self.take("loop", |text| {
            let (start, end) = text.split_once('-')?;
            let (start, end) = (start.parse().ok()?, end.parse().ok()?);
            // A loop has at least one event.
            (start < end).then_some(start..end)
        });

        if let Some(layout) = self.take("layout", layout::text::read) {
            content.view.layout = layout;
        }
    }

    fn selection(&mut self, content: &mut LinkContent) {
        let selection = self.take("select", read_selection);
        content.view.selection = selection.unwrap_or(Selection::Nothing);
    }

    /// Reads the second run: its parameters, and in what it is linked with the first.
    fn second(&mut self, content: &mut LinkContent) {
        let Some(names) = self.pairs.get("b") else {
            if self.pairs.keys().any(|key| key.starts_with("b.")) {
                let text = "The link has parameters of a second run but not the run (\"b\"); they were left out.";
                self.warnings.add(text.to_owned());
            }
            return;
        };

        // The link has the parameters in which the second run differs from the first. If a combination is shown
        // instead of a first run, `content` still has the default parameters, and the second run differs from those.
        let pairs = &self.pairs;
        let texts = |key: &str| pairs.get(&format!("b.{key}")).map(|text| tidy(text));
        let second = parameters::read(texts, &content.parameters, " of run B", &mut self.warnings);

        // Only the links that are named are on.
        let mut links = [false; 3];
        for name in tidy(names).split(',').filter(|name| !name.is_empty()) {
            match LINKS.iter().position(|link| *link == name) {
                Some(index) => links[index] = true,
                None => self.warnings.add(format!(
                    "Two runs cannot be linked by \"{}\"; it was left out.",
                    quoted(name)
                )),
            }
        }

        (content.view.second, content.view.links) = (Some(second), links);
    }

    /// Reads breakpoints, watches, and scenes with their views.
    fn stops(&mut self, content: &mut LinkContent) {
        content.breakpoints = self.list("break", "breakpoint", MAX_STOPS, breakpoint);
        content.watches = self.list("watch", "watch", MAX_STOPS, short);
        // A view belongs to the scene at the same position of the list of scenes; a scene without a view has a
        // placeholder there. So invalid scenes and views keep their positions, as errors, until each scene has its
        // view.
        let mut scenes = self.list("mark", "scene", MAX_SCENES, |text| {
            Some(scene(text).ok_or_else(|| quoted(text)))
        });

        let views = self.list("mark-view", "view of a scene", MAX_SCENES, |text| {
            Some(read_scene_view(text).ok_or_else(|| quoted(text)))
        });
        for (scene, view) in scenes.iter_mut().zip(views) {
            match (scene, view) {
                (Ok(scene), Ok(view)) => scene.view = view,
                (Ok(_), Err(text)) => self.warnings.add(format!(
                    "The link's view of a scene \"{text}\" is invalid and was left out."
                )),
                // Without its scene a view has nowhere to go.
                (Err(_), _) => {}
            }
        }

        for scene in scenes {
            match scene {
                Ok(scene) => content.scenes.push(scene),
                Err(text) => self.warnings.add(format!(
                    "The link's scene \"{text}\" is invalid and was left out."
                )),
            }
        }
    }

    /// Returns the valid items in the list of a key, of at most `most`. `what` names an item in warnings.
    fn list<T>(
        &mut self,
        key: &str,
        what: &str,
        most: usize,
        item: impl Fn(&str) -> Option<T>,
    ) -> Vec<T> {
        let Some(text) = self.pairs.get(key) else {
            return Vec::new();
        };

        let texts = items(text);
        if texts.len() > most {
            self.warnings.add(format!(
                "The link has {} of the kind \"{key}\"; the first {most} were read.",
                grouped(texts.len())
            ));
        }

        let mut taken = Vec::new();
        // Items beyond `most` are not even parsed, since a link may come from anywhere and be long.
        for text in texts.iter().take(most) {
            match item(text) {
                Some(valid) => taken.push(valid),
                None => self.warnings.add(format!(
                    "The link's {what} \"{}\" is invalid and was left out.",
                    quoted(text)
                )),
            }
        }
        taken
    }
}

/// Returns a key and its value. Mail and course systems escape some marks of a link, so that several keys and values
/// come as one pair: these are returned apart. Where the `=` was escaped, all is in the key; where the `&` was, the
/// later keys are in the value. In texts that people write, `&` is a character like others.
fn parted((key, value): (String, String)) -> Vec<(String, String)> {
    if value.is_empty() && key.contains('=') {
        return pairs(&key).collect();
    }
    if FREE_TEXTS.contains(&key.as_str()) {
        return vec![(key, value)];
    }
    let mut parts = value.split('&');
    let first = parts.next().unwrap_or_default().to_owned();
    // A part without `=` is no key and value, and is left out.
    let others = parts
        .filter_map(|part| part.split_once('='))
        .map(|(key, value)| (key.to_owned(), value.to_owned()));
    std::iter::once((key, first)).chain(others).collect()
}

/// Returns a value without blanks around it, and without the marks of a sentence that end up in a link when a program finds
/// it in a text. No value ends with one of these marks.
fn tidy(text: &str) -> &str {
    let is_mark = |character: char| {
        character.is_whitespace() || ".,;:!?)]}>\"'\u{bb}\u{201c}\u{201d}".contains(character)
    };
    text.trim_start().trim_end_matches(is_mark)
}

fn name(text: &str) -> Option<String> {
    (!text.is_empty() && text.len() <= MAX_TEXT).then(|| text.to_owned())
}

fn short(text: &str) -> Option<String> {
    (text.chars().count() <= MAX_TEXT).then(|| text.to_owned())
}

/// Reads a scene: its event and its caption. A scene of another run has that run between them, and perhaps an anchor
/// behind the run. `None` if any of these is invalid.
fn scene(text: &str) -> Option<SavedScene> {
    let (mark, caption) = text.split_once(':').unwrap_or((text, ""));
    let mut parts = mark.split('@');
    let event = parts.next()?.parse().ok()?;
    let run = short(parts.next().unwrap_or_default())?;
    let anchor = match parts.next() {
        None => None,
        Some(anchor) => Some(anchor.parse().ok()?),
    };
    // Nothing may follow the anchor.
    if parts.next().is_some() {
        return None;
    }

    Some(SavedScene {
        event,
        caption: short(caption)?,
        run,
        anchor,
        ..SavedScene::default()
    })
}

/// Reads a line and its condition; a mark before them says that the breakpoint is off.
fn breakpoint(text: &str) -> Option<SavedBreakpoint> {
    let (enabled, text) = match text.strip_prefix('!') {
        Some(rest) => (false, rest),
        None => (true, text),
    };
    let (line, condition) = text.split_once(':').unwrap_or((text, ""));
    // A line that no listing has makes the breakpoint invalid.
    Listings::shipped().find(line)?;
    let condition = short(condition)?;
    Some(SavedBreakpoint {
        line: line.to_owned(),
        condition: (!condition.is_empty()).then_some(condition),
        enabled,
    })
}

/// Returns the layout of a combination, if a link may ask for it; otherwise why not.
fn combination(text: &str) -> Result<Combination, String> {
    let length = text.chars().count();
    if length > MAX_COMBINATION {
        return Err(format!(
            "its layout has {} characters, and a link's has at most {}",
            grouped(length),
            grouped(MAX_COMBINATION)
        ));
    }

    let json = match text {
        NINE_SETS => NINE.as_bytes().to_vec(),
        text => from_base64(text).ok_or("it is not base64")?,
    };

    let layout = Combination::from_json(&json).map_err(|error| error.to_string())?;
    let placed = layout.placed().map_err(|error| error.to_string())?;
    // Patterns are made as well, and may have more samples than the sets that are clipped from them.
    let expected = placed.expected + of_patterns(&placed.pieces);
    if expected > MAX_SAMPLES {
        return Err(format!(
            "it and its patterns make about {expected:.0} samples, and a link may ask for {}",
            grouped(MAX_SAMPLES as usize)
        ));
    }

    // A link comes from anywhere, and must not make the program read files.
    let of_file = |source: &PieceSource| matches!(source, PieceSource::File { .. });
    if placed.pieces.iter().any(|piece| of_file(&piece.source)) {
        return Err("it has sets from files, which a link does not open".to_owned());
    }

    Ok(layout)
}

/// Returns the expected number of samples of all different patterns that pieces clip from.
fn of_patterns(pieces: &[PlacedPiece]) -> f64 {
    let mut specs: Vec<PatternSpec> = Vec::new();
    for piece in pieces {
        if let PieceSource::Run { parameters, .. } = &piece.source
            && !specs.contains(&parameters.pattern)
        {
            specs.push(parameters.pattern);
        }
    }
    let samples = specs.iter().map(|spec| spec.side * spec.side);
    MAXIMAL_DENSITY * samples.sum::<f64>()
}
