//! Reads a lesson file: front matter between lines of `---`, steps that begin with `# Title`, paragraphs, and directives
//! in fences of three backticks. Begin with [`Lesson::read`]. Expressions are only parsed here; `scene.rs` evaluates them.

use std::fmt::Write as _;

use tilescope_core::{
    Boundary, MAX_LEVELS, MAXIMAL_DENSITY, NestedRequest, Parameter, SOLID_DENSITY, WithinLevel,
};
use tilescope_sets::Expression;
use unicode_segmentation::UnicodeSegmentation;

use crate::error::{LessonError, nearest};
use crate::fields::{Field, Fields};
use crate::inventory::{Concept, TestForm};
use crate::kinds::{KINDS, KindRow};
use crate::lesson::{Gate, Lesson, Step};
use crate::moment::Moment;
use crate::parameters::{MAX_SAMPLES, first, parameters, set_parameter};
use crate::scene_spec::{Camera, Claim, LAYERS, SceneSpec};
use crate::syntax;
use crate::text::{MAX_BYTES, Text, Wrong};

mod space;

use space::space;

/// The most steps of a lesson.
pub const MAX_STEPS: usize = 40;

const DIRECTIVES: [&str; 3] = ["run", "gate", "note"];
const FRONT_MATTER: [&str; 4] = ["title", "objective", "minutes", "form"];
const OF_RUN: [&str; 11] = [
    "radius-expression",
    "coin",
    "depth",
    "plane",
    "levels",
    "order-within",
    "density",
    "moment",
    "where",
    "layers",
    "camera",
];
/// Fields of a run that may occur several times.
const CLAIMS: [&str; 2] = ["claim", "claim-mean"];
/// How many minutes a lesson may say that it takes: up to two hours, as a lecture.
const MINUTES: [f64; 2] = [1.0, 120.0];
/// The minutes of a lesson that does not say how many it takes: those of most lessons.
const USUAL_MINUTES: f64 = 10.0;
/// The parts of a side at whose ends a field is looked at before it is made. Chosen, not measured.
const FIELD_LOOKS: u32 = 64;
/// How many r a camera may show: fewer than 2 are no whole disk, and 1,000 are more than the sides of a square with
/// [`MAX_SAMPLES`], about 170 r.
const CAMERA_RADII: [f64; 2] = [2.0, 1_000.0];
/// The limits of the bound of a mean: far beyond every number of a run, and not infinite.
const BOUNDS: [f64; 2] = [-1e9, 1e9];
impl Lesson {
    /// Reads a lesson; `name` is that of its file, without `.md`.
    ///
    /// # Errors
    ///
    /// The first fault of the file, with its line, the allowed values, and the nearest right word.
    pub fn read(name: &str, text: &str) -> Result<Self, LessonError> {
        if text.len() > MAX_BYTES {
            let length = text.len();
            let message = format!("the file has {length} bytes; a lesson has at most {MAX_BYTES}");
            return Err(LessonError::new(1, message));
        }

        // Some editors put a mark before a text, which would change the hash below.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);

        let mut reader = Reader {
            lines: text.lines().collect(),
            at: 0,
            steps: Vec::new(),
        };

        let front = reader.front_matter()?;
        reader.body()?;
        let steps = reader.steps;
        if steps.is_empty() {
            let message =
                "the lesson has no steps; a step begins with a line such as \"# The first loss\"";
            // Lines count from 1, also those of a file without any.
            return Err(LessonError::new(reader.at.max(1), message));
        }

        let minutes = front.optional("minutes", |field| field.number(MINUTES))?;
        let form = |field: &Field| TestForm::named(&field.value, field.line);

        let mut lesson = Self {
            name: name.to_owned(),
            title: front.need("title")?.value.clone(),
            objective: front.need("objective")?.value.clone(),
            minutes: minutes.unwrap_or(USUAL_MINUTES) as u32,
            form: front.optional("form", form)?,
            // 16 of 64 digits suffice to distinguish the versions of a lesson.
            hash: blake3::hash(text.as_bytes()).to_hex()[..16].to_owned(),
            steps,
        };

        if lesson.form.is_some() {
            // A form has no practice: scores can be compared only if all who take it are asked about the same runs.
            let gates = lesson
                .steps
                .iter_mut()
                .filter_map(|step| step.gate.as_mut());
            gates.for_each(|gate| gate.practice = None);
        }

        check_form(&lesson)?;
        Ok(lesson)
    }
}

/// Refuses a form if one of its questions has no concept, has the concept of an earlier one, or gives help.
fn check_form(lesson: &Lesson) -> Result<(), LessonError> {
    if lesson.form.is_none() {
        return Ok(());
    }

    let gates: Vec<&Gate> = lesson.gates().map(|(_, gate)| gate).collect();
    for (index, gate) in gates.iter().enumerate() {
        let wrong = |message: String| LessonError::new(gate.line, message);

        let Some(concept) = gate.concept else {
            let names = Concept::NAMES.join(", ");
            let message = format!("a question of a form needs a \"concept\": {names}");
            return Err(wrong(message));
        };

        // A gain compares the first answers about a concept, of which there is one in each form.
        if let Some(other) = gates[..index].iter().find(|it| it.concept == Some(concept)) {
            let (name, line) = (concept.name(), other.line);
            let message = format!("the question of line {line} is about \"{name}\" already");
            return Err(wrong(message));
        }

        if gate.kind.is_trace() {
            let message = "a form has no trace, which shows the right answer at each event";
            return Err(wrong(message.to_owned()));
        }

        if gate.hint.is_some() {
            let message =
                "a question of a form has no hint: it measures what is known without help";
            return Err(wrong(message.to_owned()));
        }
    }

    Ok(())
}

struct Reader<'a> {
    lines: Vec<&'a str>,
    /// The index of the line to be read next.
    at: usize,
    steps: Vec<Step>,
}

impl<'a> Reader<'a> {
    fn line(&mut self) -> Option<&'a str> {
        let line = self.lines.get(self.at).copied();
        self.at += usize::from(line.is_some());
        line
    }

    /// Returns the lines up to the line `end`, which is skipped; `fault` is the message if there is none.
    fn up_to(&mut self, end: &str, fault: &str) -> Result<Vec<&'a str>, LessonError> {
        let begun = self.at;
        let mut lines = Vec::new();
        while let Some(line) = self.line() {
            if line.trim_end() == end {
                return Ok(lines);
            }
            lines.push(line);
        }
        Err(LessonError::new(begun.max(1), fault))
    }

    fn front_matter(&mut self) -> Result<Fields, LessonError> {
        if self.line().map(str::trim_end) != Some("---") {
            let message = "a lesson begins with a line \"---\", its title and its objective, and another line \"---\"";
            return Err(LessonError::new(1, message));
        }
        let lines = self.up_to("---", "the front matter has no end")?;
        let fields = Fields::read("the front matter", 1, &lines)?;
        fields.only(&FRONT_MATTER, &[])?;
        Ok(fields)
    }

    /// Reads the steps: all lines after the front matter.
    fn body(&mut self) -> Result<(), LessonError> {
        let mut paragraph = String::new();

        while let Some(line) = self.line() {
            // The index of the next line, from 0, is the number of this one, from 1.
            let number = self.at;
            if line.starts_with("```") {
                self.end_paragraph(&mut paragraph, number)?;
                self.directive(line.trim_start_matches('`').trim(), number)?;
            } else if let Some(title) = line.strip_prefix("# ") {
                self.end_paragraph(&mut paragraph, number)?;
                self.step(title.trim(), number)?;
            } else if line.starts_with('#') {
                let message = "the title of a step begins with one \"#\" and a space; there are no other titles";
                return Err(LessonError::new(number, message));
            } else if line.trim().is_empty() {
                self.end_paragraph(&mut paragraph, number)?;
            } else {
                // An item of a list is a paragraph of its own, even without a blank line before it.
                if line.trim_start().starts_with("- ") {
                    self.end_paragraph(&mut paragraph, number)?;
                }

                let gap = if paragraph.is_empty() { "" } else { " " };
                let _ = write!(paragraph, "{gap}{}", line.trim());
            }
        }

        // The last paragraph has no blank line after it.
        self.end_paragraph(&mut paragraph, self.at)?;
        Ok(())
    }

    /// Checks the paragraph that is read so far, and adds it to the step. `line` is the one that ends it, or the file's
    /// last.
    fn end_paragraph(&mut self, paragraph: &mut String, line: usize) -> Result<(), LessonError> {
        if paragraph.is_empty() {
            return Ok(());
        }

        syntax::check_text(paragraph, line)?;

        let step = self.steps.last_mut().ok_or_else(|| {
            LessonError::new(line, "text before the first step; a step begins with a line such as \"# The first loss\"")
        })?;

        // Paragraphs behind the question are shown after its answer.
        let part = if step.gate.is_some() {
            &mut step.after
        } else {
            &mut step.text
        };

        part.push(std::mem::take(paragraph));
        Ok(())
    }

    /// Begins a step with a title, and with the scene of the step before it.
    fn step(&mut self, title: &str, line: usize) -> Result<(), LessonError> {
        if self.steps.len() == MAX_STEPS {
            let message = format!("a lesson has at most {MAX_STEPS} steps");
            return Err(LessonError::new(line, message));
        }

        let name = step_name(title);
        self.check_name(&name, line)?;

        // A step begins with the scene of the step before it, but claims belong to the step that makes them.
        let scene = self.steps.last().map(|step| SceneSpec {
            claims: Vec::new(),
            ..step.scene.clone()
        });

        self.steps.push(Step {
            name,
            title: title.to_owned(),
            text: Vec::new(),
            after: Vec::new(),
            // The first step shows the end of the default run, until a directive changes that.
            scene: scene.unwrap_or(SceneSpec {
                parameters: first(),
                levels: None,
                radius: None,
                depth: None,
                plane: None,
                has_coin: true,
                density: None,
                moment: Moment::End,
                condition: None,
                layers: None,
                camera: Camera::Fit,
                claims: Vec::new(),
                line,
            }),
            gate: None,
            notes: Vec::new(),
            line,
        });
        Ok(())
    }

    fn check_name(&self, name: &str, line: usize) -> Result<(), LessonError> {
        if name.is_empty() {
            let message =
                "the title has no letter or digit, of any script, to make the step's name of";
            return Err(LessonError::new(line, message));
        }
        if let Some(Step { line: other, .. }) = self.steps.iter().find(|step| step.name == name) {
            let message = format!("the step of line {other} has the name \"{name}\" already");
            return Err(LessonError::new(line, message));
        }
        Ok(())
    }

    /// Reads a directive, whose first line has the kind and the name `info`.
    fn directive(&mut self, info: &str, line: usize) -> Result<(), LessonError> {
        let fault = "the directive has no end; it ends with a line of three backticks";
        let lines = self.up_to("```", fault)?;
        let (kind, name) = info.split_once(' ').unwrap_or((info, ""));

        if !DIRECTIVES.contains(&kind) {
            return Err(LessonError::unknown(line, "directive", kind, &DIRECTIVES));
        }

        // A question gives its name to its step. No other step may have this name, but the step itself may have it
        // already.
        let name = step_name(name);
        if kind == "gate" && self.steps.last().is_some_and(|step| step.name != name) {
            self.check_name(&name, line)?;
        }

        let none = || LessonError::new(line, format!("a {kind} before the first step"));
        let step = self.steps.last_mut().ok_or_else(none)?;

        match (kind, &step.gate) {
            ("gate", Some(Gate { line: other, .. })) => {
                let message =
                    format!("the step has a question already, in line {other}; begin another step");
                return Err(LessonError::new(line, message));
            }
            ("gate", None) => {
                let made = gate(name.clone(), line, &lines)?;

                // The reason for the key stands first among the texts after the answer.
                step.after
                    .extend(made.because.iter().map(|text| text.text.clone()));
                (step.name, step.gate) = (name, Some(made));
            }
            ("note", _) => {
                let text = lines.join("\n");
                let paragraphs = text
                    .split("\n\n")
                    .map(|part| part.replace('\n', " ").trim().to_owned())
                    .filter(|part| !part.is_empty());
                step.notes.extend(paragraphs);
            }
            // The only other directive is `run`.
            _ => run(&mut step.scene, &Fields::read("a run", line, &lines)?)?,
        }

        Ok(())
    }
}

/// Returns the name of a step in links: the letters and digits of its title, of any script, in lower case, with hyphens
/// between the words; empty if the title has none.
#[must_use]
pub fn step_name(title: &str) -> String {
    let lower = title.to_lowercase();
    let mut name = String::with_capacity(lower.len());
    let mut is_between_words = false;
    // A letter and the marks on it are one cluster: in Hindi or Arabic a word is not cut at its vowels.
    for cluster in lower.graphemes(true) {
        if !cluster.starts_with(char::is_alphanumeric) {
            is_between_words = true;
            continue;
        }
        if is_between_words && !name.is_empty() {
            name.push('-');
        }
        name.push_str(cluster);
        is_between_words = false;
    }
    name
}

/// Changes a scene by a `run` directive. What the directive does not name stays as it was, with five exceptions: the
/// claims, the condition of the moment, the camera, the plane, and the usual pattern of exact tiling. New levels have no
/// density, and a new field has its coin, unless the directive says otherwise.
fn run(scene: &mut SceneSpec, fields: &Fields) -> Result<(), LessonError> {
    let known: Vec<&str> = parameters().map(Parameter::key).chain(OF_RUN).collect();
    fields.only(&known, &CLAIMS)?;

    scene.line = fields.line;
    scene.claims = claims(fields)?;

    let before = scene.parameters;
    // In the order of the file, so that the error names the first wrong line.
    for field in &fields.all {
        if let Some(parameter) = parameters().find(|it| it.key() == field.key) {
            set_parameter(&mut scene.parameters, parameter, field)?;
        }
    }

    // The pattern of exact tiling goes with the seed and the size of the set, but a side that is given here stays.
    let following = scene.parameters.pattern_following(&before);
    let pattern = &mut scene.parameters.pattern;
    pattern.seed = following.seed;
    if fields.get(Parameter::PatternSide.key()).is_none() {
        pattern.side = following.side;
    }

    levels(scene, fields)?;
    field_of_radii(scene, fields)?;
    space(scene, fields)?;

    if let Some(field) = fields.get("moment") {
        scene.moment = Moment::read(&field.value, field.line)?;
    }

    // Unlike most parts, the camera and the condition do not stay as they were if the directive does not name them.
    scene.camera = Camera::Fit;
    scene.condition = fields.optional("where", |field| field.expression(&[]))?;

    if let Some(field) = fields.get("layers") {
        scene.layers = match field.value.as_str() {
            "automatic" => None,
            _ => Some(layers(field)?),
        };
    }

    if let Some(field) = fields.get("camera") {
        scene.camera = match field.split(" radii ") {
            ("fit", None) => Camera::Fit,
            (place, Some(radii)) => {
                let radii = field.part(radii).number(CAMERA_RADII)?;
                Camera::At(Text::new(place, field.line).expression(&[])?, radii)
            }
            _ => {
                let message = "the camera is \"fit\" or of the form \"EXPRESSION radii 12\", where the expression gives a \
                               sample or a place [x, y]";
                return Err(field.wrong(message));
            }
        };
    }

    let wrong = |message: String| LessonError::new(fields.line, message);
    let domain = scene
        .parameters
        .validate()
        .map_err(|error| wrong(error.to_string()))?;

    // The products are about the number of samples of a maximal set. Runs are recorded with all of their events, on the
    // machines of learners.
    let samples = match scene.run(None).domain_in_space() {
        Some(made) => {
            made.map_err(|error| wrong(error.to_string()))?
                .volume_radii()
                * SOLID_DENSITY
        }
        None => domain.area_radii() * MAXIMAL_DENSITY,
    };
    if samples > MAX_SAMPLES {
        return Err(wrong(format!(
            "the run would have about {samples:.0} samples; a lesson's has at most {MAX_SAMPLES}"
        )));
    }
    Ok(())
}

/// Changes the nested levels of a scene by the fields of its `run` directive.
fn levels(scene: &mut SceneSpec, fields: &Fields) -> Result<(), LessonError> {
    if let Some(field) = fields.get("levels") {
        scene.levels = match field.value.as_str() {
            "none" => None,
            _ => Some(NestedRequest {
                levels: field.whole([1, MAX_LEVELS])?,
                order_within: WithinLevel::default(),
                exactly: None,
            }),
        };
        // A density is that of the levels for which it was painted.
        scene.density = None;
    }

    let needed = |field: &Field| field.wrong(format!("\"{}\" needs \"levels: ...\"", field.key));

    if let Some(field) = fields.get("order-within") {
        let request = scene.levels.as_mut().ok_or_else(|| needed(field))?;
        request.order_within = match field.value.as_str() {
            "random" => WithinLevel::Random,
            "farthest" => WithinLevel::Farthest,
            other => {
                let known = ["random", "farthest"];
                return Err(LessonError::unknown(field.line, "order", other, &known));
            }
        };
    }

    if let Some(field) = fields.get("density") {
        scene.levels.ok_or_else(|| needed(field))?;
        scene.density = match field.value.as_str() {
            "all" => None,
            _ => Some(field.expression(&["x", "y"])?),
        };
    }

    // The parameters may have changed, also where the levels stay as the step before set them.
    let checked = scene
        .levels
        .map_or(Ok(()), |request| request.check(&scene.parameters));
    checked.map_err(|error| LessonError::new(fields.line, error.to_string()))
}

/// Changes the field of radii of a scene by the fields of its `run` directive.
fn field_of_radii(scene: &mut SceneSpec, fields: &Fields) -> Result<(), LessonError> {
    if let Some(field) = fields.get("radius-expression") {
        scene.radius = match field.value.as_str() {
            "none" => None,
            text => {
                let read = Expression::parse(text);
                Some(read.map_err(|error| field.wrong(error.to_string()))?)
            }
        };
        // Leaving out the coin belongs to the field for which it was said: a new field has its coin again.
        scene.has_coin = true;
    }

    if let Some(field) = fields.get("coin") {
        if scene.radius.is_none() {
            return Err(field.wrong("\"coin\" needs \"radius-expression: ...\""));
        }
        scene.has_coin = field.yes_or_no()?;
    }

    // The parameters may have changed, also where the field stays as the step before set it.
    match &scene.radius {
        Some(radius) => {
            check_field(scene, radius).map_err(|message| LessonError::new(fields.line, message))
        }
        None => Ok(()),
    }
}

/// Refuses a field in which r is no unit of length, and one that cannot be made as far as a short look shows.
fn check_field(scene: &SceneSpec, radius: &Expression) -> Result<(), String> {
    if scene.levels.is_some() {
        return Err("nested levels have one radius: \"levels: none\" goes with a field".to_owned());
    }

    // A field by an expression has 1024 squares along the longer side. The unit of its lattice is the side of a square,
    // divided by a power of two. If the longer side is a power of two, so is the unit. If also the least radius is at
    // least 1 and below 2, the lattice's r is 1, the unit of the expression.
    let [width, height] = [scene.parameters.width, scene.parameters.height];
    let longer = width.max(height);
    let is_of_r = scene.parameters.radius.to_bits() == 1.0_f64.to_bits();
    if !is_of_r || longer.log2().fract() != 0.0 {
        return Err(format!(
            "a field is measured in r: \"radius: 1\", and a longer side that is a power of two, such as 32 or 64, not {longer}"
        ));
    }
    if scene.parameters.boundary != Boundary::Bounded {
        return Err("a field is in a bounded domain: \"boundary: bounded\"".to_owned());
    }
    let along =
        |side: f64| (0..=FIELD_LOOKS).map(move |at| side * f64::from(at) / f64::from(FIELD_LOOKS));
    let values = along(height).flat_map(|y| along(width).map(move |x| radius.at(x, y)));
    let least = values.fold(f64::INFINITY, f64::min);
    if !(1.0..2.0).contains(&least) {
        return Err(format!(
            "the least radius of the field is {least}; it must be at least 1, which is r, and below 2"
        ));
    }

    let recipe = scene.run(None).recipe();
    let looked = recipe.map_or(Ok(0.0), |recipe| recipe.glance());
    looked.map(|_| ()).map_err(|error| error.to_string())
}

/// Returns the claims of a run, in the order of the file.
fn claims(fields: &Fields) -> Result<Vec<Claim>, LessonError> {
    let all = fields.all.iter();
    let claims = all.filter_map(|field| match field.key.as_str() {
        "claim" => Some(field.expression(&[]).map(Claim::Each)),
        "claim-mean" => Some(claim_of_mean(field)),
        _ => None,
    });
    claims.collect()
}

/// Returns the claim `EXPRESSION > NUMBER` or `EXPRESSION < NUMBER` about a mean.
fn claim_of_mean(field: &Field) -> Result<Claim, LessonError> {
    // The last sign divides, since the expression may compare too.
    let Some((of, bound)) = field.value.rsplit_once(['>', '<']) else {
        let message =
            "a claim about a mean is of the form \"claim-mean: EXPRESSION > NUMBER\", or with <";
        return Err(field.wrong(message));
    };

    let is_above = field.value[of.len()..].starts_with('>');
    Ok(Claim::Mean {
        of: Text::new(of.trim(), field.line).expression(&[])?,
        is_above,
        bound: field.part(bound.trim()).number(BOUNDS)?,
    })
}

fn layers(field: &Field) -> Result<Vec<String>, LessonError> {
    let names = field
        .value
        .split([' ', ','])
        .filter(|name| !name.is_empty());

    let read = |name: &str| {
        let known = LAYERS.contains(&name).then(|| name.to_owned());
        known.ok_or_else(|| LessonError::unknown(field.line, "layer", name, &LAYERS))
    };
    names.map(read).collect()
}

/// The fields that every gate may have.
const OF_GATE: [&str; 12] = [
    "type", "ask", "hint", "mark", "circle", "strip", "decided", "shows", "practice", "because",
    "read", "concept",
];
/// The radii of circles and the widths of strips, in r: a smaller one lies under its mark, a larger one beyond every canvas.
const CIRCLES: [f64; 2] = [0.1, 20.0];

/// Reads a gate with the name of its step, from the lines of its directive.
fn gate(name: String, line: usize, lines: &[&str]) -> Result<Gate, LessonError> {
    let mut fields = Fields::read("a gate", line, lines)?;
    // Without a type the other fields cannot be checked. A misspelt `type` is then the likeliest error, and is named.
    let is_alike = |field: &&Field| nearest(&field.key, &["type"]).is_some();
    if let (None, Some(field)) = (fields.get("type"), fields.all.iter().find(is_alike)) {
        let (line, what) = (field.line, "field of a gate");
        return Err(LessonError::unknown(line, what, &field.key, &["type"]));
    }

    let named = fields.need("type")?;
    let of_name = |kind: &&KindRow| kind.name == named.value;
    let Some(row) = KINDS.iter().find(of_name) else {
        let names = KINDS.map(|kind| kind.name);
        let (line, what) = (named.line, "type of gate");
        return Err(LessonError::unknown(line, what, &named.value, &names));
    };

    fields.of = format!("a {} gate", row.name);
    let once: Vec<&str> = OF_GATE.iter().chain(row.once).copied().collect();
    fields.only(&once, row.many)?;
    let kind = (row.read)(&fields)?;

    let said = |field: &Field| field.text().paragraph();
    // Without the field there are 40 seeds, the number that the check of lessons asks by default.
    let practice = match fields.get("practice") {
        None => Some(1..=40),
        Some(field) if field.value == "none" => None,
        Some(field) => Some(field.seeds()?),
    };

    Ok(Gate {
        name,
        ask: fields.need("ask")?.text().paragraph()?,
        wrong: wrongs(row.wrong_names, &fields)?,
        kind_name: row.name,
        kind,
        hint: fields.optional("hint", said)?,
        otherwise: fields.optional("otherwise", said)?,
        because: fields.optional("because", said)?,
        is_reading: fields.optional("read", Field::yes_or_no)?.unwrap_or(false),
        mark: fields.optional("mark", |field| field.expression(&[]))?,
        circle: fields.optional("circle", |field| field.number(CIRCLES))?,
        strip: fields.optional("strip", |field| field.number(CIRCLES))?,
        decided: fields.optional("decided", Field::query)?,
        shows: fields.optional("shows", layers)?.unwrap_or_default(),
        concept: fields.optional("concept", |field| Concept::named(&field.value, field.line))?,
        practice,
        line,
    })
}

/// Returns the known wrong answers, whose expressions may also use the names `more`.
fn wrongs(more: &[&str], fields: &Fields) -> Result<Vec<Wrong>, LessonError> {
    let wrongs = fields.many("wrong").map(|field| {
        let (answer, Some(said)) = field.split("=>") else {
            let message = "a wrong answer is of the form \"wrong: EXPRESSION => SENTENCE\"";
            return Err(field.wrong(message));
        };

        Ok(Wrong {
            sentence: Text::new(said, field.line).sentence()?,
            answer: Text::new(answer, field.line).expression(more)?,
        })
    });
    wrongs.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_of_every_script_give_names() {
        for (title, name) in [
            ("The first loss: who goes?", "the-first-loss-who-goes"),
            ("冲突在哪里？", "冲突在哪里"),
            ("Где конфликт?", "где-конфликт"),
            ("Πού είναι;", "πού-είναι"),
            ("أين التعارض؟", "أين-التعارض"),
            ("संघर्ष कहाँ है?", "संघर्ष-कहाँ-है"),
            ("どこ、ですか", "どこ-ですか"),
            ("Größe ‚r‘ – 2", "größe-r-2"),
            ("  ?! — 🙂 ", ""),
        ] {
            assert_eq!(step_name(title), name);
        }
    }

    #[test]
    fn a_title_without_letters_is_refused_and_others_are_not() {
        let lesson = |title: &str| {
            let text = format!("---\ntitle: T\nobjective: O\n---\n\n# {title}\n\nText.\n");
            Lesson::read("l", &text)
        };
        assert_eq!(lesson("冲突在哪里？").unwrap().steps[0].name, "冲突在哪里");
        let error = lesson("?!").unwrap_err();
        assert!(
            error.line == 6 && error.message.contains("any script"),
            "{error}"
        );
    }
}
