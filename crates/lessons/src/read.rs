//! Reads a lesson file: front matter between lines of `---`, steps that begin with `# Title`, paragraphs, and directives
//! in fences of three backticks.

use std::fmt::Write as _;

use tilescope_core::{MAXIMAL_DENSITY, Parameters};

use crate::error::{LessonError, nearest};
use crate::fields::{Field, Fields};
use crate::lesson::{
    Camera, ChoiceOption, Gate, GateKind, LAYERS, Lesson, MAX_BYTES, SceneSpec, Step, Text, Wrong,
};
use crate::moment::Moment;
use crate::parameters::{MAX_SAMPLES, with_parameter};
use crate::prose;
use crate::syntax;

/// The most steps of a lesson.
pub const MAX_STEPS: usize = 40;
/// The most options, items or candidates of a question.
pub const MAX_OPTIONS: usize = 8;
/// The most steps of a `trace`.
const MAX_TRACED: usize = 12;

const DIRECTIVES: [&str; 3] = ["run", "gate", "note"];
const FRONT_MATTER: [&str; 3] = ["title", "objective", "minutes"];
const OF_RUN: [&str; 5] = ["moment", "where", "layers", "camera", "seeds"];
/// The parameters of a run that lessons name; `pattern-side` is the side of the pattern.
pub const PARAMETERS: [&str; 12] = [
    "width",
    "height",
    "radius",
    "boundary",
    "seed",
    "leaf",
    "dihedral",
    "order",
    "insertion",
    "search",
    "variant",
    "pattern-side",
];
/// The parameters of the first step, if it does not set them: some hundred samples in blocks of 12 r.
const FIRST: Parameters = Parameters {
    width: 1.0,
    height: 1.0,
    radius: 0.03,
    boundary: tilescope_core::Boundary::Periodic,
    seed: 1,
    leaf: 12.0,
    pattern: tilescope_core::PatternSpec {
        side: 100.0,
        boundary: tilescope_core::Boundary::Periodic,
        seed: 0,
    },
    dihedral: false,
    order: tilescope_core::Order::OwnBlockFirst,
    insertion: tilescope_core::Insertion::Circumcentre,
    search: tilescope_core::Search::Complete,
    variant: tilescope_core::Variant::Staged,
};

impl Lesson {
    /// Reads a lesson; `name` is that of its file, without `.md`.
    ///
    /// # Errors
    ///
    /// The first fault of the file, with its line, what is allowed, and the nearest right word.
    pub fn read(name: &str, text: &str) -> Result<Self, LessonError> {
        if text.len() > MAX_BYTES {
            let message = format!(
                "the file has {} bytes; a lesson has at most {MAX_BYTES}",
                text.len()
            );
            return Err(LessonError::new(1, message));
        }
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
            return Err(LessonError::new(reader.at.max(1), message));
        }
        let minutes = front
            .get("minutes")
            .map_or(Ok(10.0), |field| field.number([1.0, 120.0]))?;
        Ok(Self {
            name: name.to_owned(),
            title: front.need("title")?.value.clone(),
            objective: front.need("objective")?.value.clone(),
            minutes: minutes as u32,
            hash: blake3::hash(text.as_bytes()).to_hex()[..16].to_owned(),
            steps,
        })
    }
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

    /// Returns the lines up to one that `ends`, which is skipped.
    fn up_to(
        &mut self,
        what: &str,
        ends: impl Fn(&str) -> bool,
    ) -> Result<Vec<&'a str>, LessonError> {
        let begun = self.at;
        let mut lines = Vec::new();
        while let Some(line) = self.line() {
            if ends(line) {
                return Ok(lines);
            }
            lines.push(line);
        }
        Err(LessonError::new(begun.max(1), format!("{what} has no end")))
    }

    fn front_matter(&mut self) -> Result<Fields, LessonError> {
        if self.line().map(str::trim_end) != Some("---") {
            let message = "a lesson begins with a line \"---\", its title and its objective, and another line \"---\"";
            return Err(LessonError::new(1, message));
        }
        let lines = self.up_to("the front matter", |line| line.trim_end() == "---")?;
        let fields = Fields::read("the front matter", 1, &lines)?;
        fields.only(&FRONT_MATTER, &[])?;
        Ok(fields)
    }

    fn body(&mut self) -> Result<(), LessonError> {
        let mut paragraph = String::new();
        while let Some(line) = self.line() {
            let number = self.at;
            if line.starts_with("```") {
                self.end_paragraph(&mut paragraph, number)?;
                self.directive(line.trim_start_matches('`').trim(), number)?;
            } else if let Some(title) = line.strip_prefix("# ") {
                self.end_paragraph(&mut paragraph, number)?;
                self.step(title.trim(), number)?;
            } else if line.starts_with('#') {
                let message =
                    "titles of steps begin with one \"#\" and a space; there are no others";
                return Err(LessonError::new(number, message));
            } else if line.trim().is_empty() {
                self.end_paragraph(&mut paragraph, number)?;
            } else {
                if line.trim_start().starts_with("- ") {
                    self.end_paragraph(&mut paragraph, number)?;
                }
                let gap = if paragraph.is_empty() { "" } else { " " };
                let _ = write!(paragraph, "{gap}{}", line.trim());
            }
        }
        self.end_paragraph(&mut paragraph, self.at)?;
        Ok(())
    }

    fn end_paragraph(&mut self, paragraph: &mut String, line: usize) -> Result<(), LessonError> {
        if paragraph.is_empty() {
            return Ok(());
        }
        syntax::check_text(paragraph, line)?;
        let step = self.steps.last_mut().ok_or_else(|| {
            LessonError::new(line, "text before the first step; a step begins with a line such as \"# The first loss\"")
        })?;
        let part = if step.gate.is_some() {
            &mut step.after
        } else {
            &mut step.text
        };
        part.push(std::mem::take(paragraph));
        Ok(())
    }

    fn step(&mut self, title: &str, line: usize) -> Result<(), LessonError> {
        if self.steps.len() == MAX_STEPS {
            return Err(LessonError::new(
                line,
                format!("a lesson has at most {MAX_STEPS} steps"),
            ));
        }
        let name = slug(title);
        self.check_name(&name, line)?;
        // A step shows what the step before it showed, unless it says otherwise.
        let scene = self.steps.last().map(|step| step.scene.clone());
        self.steps.push(Step {
            name,
            title: title.to_owned(),
            text: Vec::new(),
            after: Vec::new(),
            scene: scene.unwrap_or(SceneSpec {
                parameters: FIRST,
                moment: Moment::End,
                condition: None,
                layers: None,
                camera: Camera::Fit,
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
            return Err(LessonError::new(line, "the name has no letters or digits"));
        }
        if let Some(other) = self.steps.iter().find(|step| step.name == name) {
            let message = format!(
                "the name \"{name}\" is taken by the step of line {}",
                other.line
            );
            return Err(LessonError::new(line, message));
        }
        Ok(())
    }

    fn directive(&mut self, info: &str, line: usize) -> Result<(), LessonError> {
        let lines = self
            .up_to("the directive", |line| line.trim_end() == "```")
            .map_err(|_| {
                LessonError::new(
                    line,
                    "the directive has no end; it ends with a line of three backticks",
                )
            })?;
        let (kind, name) = info.split_once(' ').unwrap_or((info, ""));
        if !DIRECTIVES.contains(&kind) {
            return Err(LessonError::unknown(line, "directive", kind, &DIRECTIVES));
        }
        let none = || LessonError::new(line, format!("a {kind} before the first step"));
        if self.steps.is_empty() {
            return Err(none());
        }
        if kind == "gate" {
            let name = slug(name);
            let at = self.steps.len() - 1;
            if self.steps[at].name != name {
                self.check_name(&name, line)?;
            }
            if let Some(other) = &self.steps[at].gate {
                let message = format!(
                    "the step has a question already, in line {}; begin another step",
                    other.line
                );
                return Err(LessonError::new(line, message));
            }
            let gate = gate(name.clone(), line, &lines)?;
            let step = &mut self.steps[at];
            (step.name, step.gate) = (name, Some(gate));
            return Ok(());
        }
        let step = self.steps.last_mut().ok_or_else(none)?;
        match kind {
            "note" => {
                let text = lines.join("\n");
                let paragraphs = text
                    .split("\n\n")
                    .map(|part| part.replace('\n', " ").trim().to_owned());
                step.notes
                    .extend(paragraphs.filter(|part| !part.is_empty()));
            }
            _ => run(&mut step.scene, &Fields::read("a run", line, &lines)?)?,
        }
        Ok(())
    }
}

/// Returns a name for links: the letters and digits of a text in lower case, with hyphens between the words.
fn slug(text: &str) -> String {
    let lower = text.to_lowercase();
    let words = lower
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-")
}

/// Changes a scene as a `run` directive says. Parameters and layers stay as they were if they are not named; the moment's
/// condition and the camera do not.
fn run(scene: &mut SceneSpec, fields: &Fields) -> Result<(), LessonError> {
    let known: Vec<&str> = PARAMETERS.iter().chain(&OF_RUN).copied().collect();
    fields.only(&known, &[])?;
    scene.line = fields.line;
    for field in fields
        .all
        .iter()
        .filter(|field| PARAMETERS.contains(&field.key.as_str()))
    {
        scene.parameters = with_parameter(&scene.parameters, field)?;
    }
    (scene.condition, scene.camera) = (None, Camera::Fit);
    if let Some(field) = fields.get("moment") {
        scene.moment = Moment::read(&field.value, field.line)?;
    }
    if let Some(field) = fields.get("where") {
        scene.condition = Some(expression(&field.value, field.line, &[])?);
    }
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
                let radii = Field {
                    value: radii.to_owned(),
                    ..field.clone()
                }
                .number([2.0, 1_000.0])?;
                Camera::At(expression(place, field.line, &[])?, radii)
            }
            _ => {
                let message = "the camera is \"fit\" or of the form \"EXPRESSION radii 12\", where the expression gives a \
                               sample or a place [x, y]";
                return Err(LessonError::new(field.line, message));
            }
        };
    }
    let line = fields.line;
    let domain = scene.parameters.validate();
    let domain = domain.map_err(|error| LessonError::new(line, error.to_string()))?;
    let samples = domain.area_radii() * MAXIMAL_DENSITY;
    if samples > MAX_SAMPLES {
        let message = format!(
            "the run would have about {samples:.0} samples; a lesson's has at most {MAX_SAMPLES}"
        );
        return Err(LessonError::new(line, message));
    }
    Ok(())
}

fn layers(field: &Field) -> Result<Vec<String>, LessonError> {
    let mut layers = Vec::new();
    for name in field
        .value
        .split([' ', ','])
        .filter(|name| !name.is_empty())
    {
        if !LAYERS.contains(&name) {
            return Err(LessonError::unknown(field.line, "layer", name, &LAYERS));
        }
        layers.push(name.to_owned());
    }
    Ok(layers)
}

/// Returns an expression that parses and uses only known names, and `more`.
fn expression(text: &str, line: usize, more: &[&str]) -> Result<Text, LessonError> {
    syntax::check(text, line, more)?;
    Ok(Text {
        text: text.to_owned(),
        line,
    })
}

fn paragraph(text: &str, line: usize) -> Result<Text, LessonError> {
    syntax::check_text(text, line)?;
    if prose::plain(text).trim().is_empty() {
        return Err(LessonError::new(line, "the text is empty"));
    }
    Ok(Text {
        text: text.to_owned(),
        line,
    })
}

/// The fields that every gate may have.
const OF_GATE: [&str; 6] = ["type", "ask", "hint", "decided", "shows", "practice"];

fn gate(name: String, line: usize, lines: &[&str]) -> Result<Gate, LessonError> {
    let mut fields = Fields::read("a gate", line, lines)?;
    // The other fields are known only once the type is.
    let is_alike = |field: &&Field| nearest(&field.key, &["type"]).is_some();
    if let (None, Some(field)) = (fields.get("type"), fields.all.iter().find(is_alike)) {
        return Err(LessonError::unknown(
            field.line,
            "field of a gate",
            &field.key,
            &["type"],
        ));
    }
    let named = fields.need("type")?;
    if !GateKind::NAMES.contains(&named.value.as_str()) {
        return Err(LessonError::unknown(
            named.line,
            "type of gate",
            &named.value,
            &GateKind::NAMES,
        ));
    }
    let named = named.value.clone();
    fields.of = format!("a {named} gate");
    let (once, many): (&[&str], &[&str]) = match named.as_str() {
        "pick" => (&["answer", "candidates", "several"], &["wrong"]),
        "place" => (&["right", "answer", "within"], &["wrong", "candidate"]),
        "number" => (&["answer", "tolerance", "unit"], &["wrong"]),
        "choice" => (&[], &["option", "curve"]),
        "order" => (&[], &["item"]),
        "bands" => (&["from", "to"], &["band"]),
        "trace" => (&["events", "steps"], &["option"]),
        _ => (&[], &[]),
    };
    let once: Vec<&str> = OF_GATE.iter().chain(once).copied().collect();
    fields.only(&once, many)?;
    let kind = kind(&named, &fields)?;
    let ask = fields.need("ask")?;
    let hint = fields
        .get("hint")
        .map(|field| paragraph(&field.value, field.line))
        .transpose()?;
    let decided = fields.get("decided").map(|field| {
        syntax::check_text(&field.value, field.line)?;
        // A query with values of the moment is read when they are known.
        if !field.value.contains('{') {
            Moment::read(&format!("after {}", field.value), field.line)?;
        }
        Ok(Text {
            text: field.value.clone(),
            line: field.line,
        })
    });
    let practice = match fields.get("practice") {
        None => Some(1..=40),
        Some(field) if field.value == "none" => None,
        Some(field) => Some(field.seeds()?),
    };
    Ok(Gate {
        name,
        ask: paragraph(&ask.value, ask.line)?,
        wrong: wrongs(&named, &fields)?,
        kind,
        hint,
        decided: decided.transpose()?,
        shows: fields.get("shows").map_or(Ok(Vec::new()), layers)?,
        practice,
        line,
    })
}

fn wrongs(kind: &str, fields: &Fields) -> Result<Vec<Wrong>, LessonError> {
    let mut wrongs = Vec::new();
    for field in fields.many("wrong") {
        let (answer, Some(sentence)) = field.split("=>") else {
            let message = "a wrong answer is of the form \"wrong: EXPRESSION => SENTENCE\"";
            return Err(LessonError::new(field.line, message));
        };
        syntax::check_text(sentence, field.line)?;
        let more: &[&str] = if kind == "pick" { &["s"] } else { &[] };
        wrongs.push(Wrong {
            answer: expression(answer, field.line, more)?,
            sentence: sentence.to_owned(),
        });
    }
    Ok(wrongs)
}

fn kind(named: &str, fields: &Fields) -> Result<GateKind, LessonError> {
    let need = |key: &str, more: &[&str]| {
        let field = fields.need(key)?;
        expression(&field.value, field.line, more)
    };
    let number = |key: &str, otherwise: f64, limits: [f64; 2]| {
        fields
            .get(key)
            .map_or(Ok(otherwise), |field| field.number(limits))
    };
    Ok(match named {
        "pick" => GateKind::Pick {
            answer: need("answer", &["s"])?,
            candidates: need("candidates", &["s"])?,
            several: match fields
                .get("several")
                .map(|field| (field.value.as_str(), field.line))
            {
                None | Some(("no", _)) => false,
                Some(("yes", _)) => true,
                Some((_, line)) => return Err(LessonError::new(line, "\"several\" is yes or no")),
            },
        },
        "place" => {
            let candidates = fields.many("candidate");
            GateKind::Place {
                right: need("right", &[])?,
                answer: fields
                    .get("answer")
                    .map(|f| expression(&f.value, f.line, &["x", "y"]))
                    .transpose()?,
                within: number("within", 0.25, [0.0, 2.0])?,
                candidates: limited(
                    candidates.map(|f| expression(&f.value, f.line, &[])),
                    0,
                    fields,
                )?,
            }
        }
        "number" => GateKind::Number {
            answer: need("answer", &[])?,
            tolerance: number("tolerance", 0.0, [0.0, 1e9])?,
            unit: fields
                .get("unit")
                .map_or(String::new(), |field| field.value.clone()),
        },
        "choice" => choice(fields)?,
        "order" => {
            let items = fields.many("item").map(|field| match field.split(" by: ") {
                (text, Some(by)) => Ok((
                    paragraph(text, field.line)?,
                    expression(by, field.line, &[])?,
                )),
                _ => Err(LessonError::new(
                    field.line,
                    "an item is of the form \"item: TEXT by: EXPRESSION\"",
                )),
            });
            GateKind::Order {
                items: limited(items, 3, fields)?,
            }
        }
        "bands" => GateKind::Bands {
            from: need("from", &[])?,
            to: need("to", &[])?,
            bands: bands(fields)?,
        },
        "trace" => {
            let events = fields.need("events")?;
            syntax::check_text(&events.value, events.line)?;
            if !events.value.contains('{') {
                Moment::read(&format!("before {}", events.value), events.line)?;
            }
            GateKind::Trace {
                events: Text {
                    text: events.value.clone(),
                    line: events.line,
                },
                steps: number("steps", 6.0, [1.0, MAX_TRACED as f64])? as usize,
                options: options(fields, 2)?,
            }
        }
        _ => GateKind::Cut,
    })
}

fn choice(fields: &Fields) -> Result<GateKind, LessonError> {
    let curves = fields.many("curve");
    let curves = limited(curves.map(|f| expression(&f.value, f.line, &[])), 0, fields)?;
    let options = options(fields, 2)?;
    if !curves.is_empty() && curves.len() != options.len() {
        let message = format!(
            "there are {} curves and {} options; each option has one",
            curves.len(),
            options.len()
        );
        return Err(LessonError::new(fields.line, message));
    }
    Ok(GateKind::Choice { options, curves })
}

fn bands(fields: &Fields) -> Result<Vec<[f64; 2]>, LessonError> {
    let bands = fields.many("band").map(|field| {
        let part = |text: &str| {
            let value = text.to_owned();
            Field {
                value,
                ..field.clone()
            }
            .number([0.0, 3.0])
        };
        match field.split("..") {
            (low, Some(high)) => Ok([part(low)?, part(high)?]),
            _ => Err(LessonError::new(
                field.line,
                "a band is of the form \"band: 0.2..0.5\", in 1/r",
            )),
        }
    });
    limited(bands, 2, fields)
}

/// Returns the options `TEXT when: EXPRESSION => SENTENCE`; the sentence may be missing.
fn options(fields: &Fields, least: usize) -> Result<Vec<ChoiceOption>, LessonError> {
    let options = fields.many("option").map(|field| {
        let line = field.line;
        let (text, Some(rest)) = field.split(" when: ") else {
            let message = "an option is of the form \"option: TEXT when: EXPRESSION => SENTENCE\"; the sentence may be left out";
            return Err(LessonError::new(line, message));
        };
        let (when, sentence) = match rest.split_once("=>") {
            Some((when, sentence)) => (when.trim(), Some(sentence.trim().to_owned())),
            None => (rest, None),
        };
        if let Some(sentence) = &sentence {
            syntax::check_text(sentence, line)?;
        }
        Ok(ChoiceOption { text: paragraph(text, line)?, when: expression(when, line, &[])?, sentence })
    });
    limited(options, least, fields)
}

/// Returns the items, at least `least` and at most [`MAX_OPTIONS`].
fn limited<T>(
    items: impl Iterator<Item = Result<T, LessonError>>,
    least: usize,
    fields: &Fields,
) -> Result<Vec<T>, LessonError> {
    let items: Vec<T> = items.collect::<Result<_, _>>()?;
    if items.len() < least || items.len() > MAX_OPTIONS {
        let message = format!(
            "{} has from {least} to {MAX_OPTIONS} of these, not {}",
            fields.of,
            items.len()
        );
        return Err(LessonError::new(fields.line, message));
    }
    Ok(items)
}
