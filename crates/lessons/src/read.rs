//! Reads a lesson file: front matter between lines of `---`, steps that begin with `# Title`, paragraphs, and directives
//! in fences of three backticks. Begin with [`Lesson::read`]. Expressions are only parsed here; `scene.rs` evaluates them.

use std::fmt::Write as _;

use tilescope_core::{MAXIMAL_DENSITY, Parameters};
use unicode_segmentation::UnicodeSegmentation;

use crate::error::{LessonError, nearest};
use crate::fields::{Field, Fields};
use crate::inventory::{Concept, TestForm};
use crate::lesson::{
    Camera, ChoiceOption, Claim, Gate, GateKind, LAYERS, Lesson, MAX_BYTES, SceneSpec, Step, Text,
    Wrong,
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
const FRONT_MATTER: [&str; 4] = ["title", "objective", "minutes", "form"];
const OF_RUN: [&str; 5] = ["moment", "where", "layers", "camera", "seeds"];
/// Fields of a run that may occur several times.
const CLAIMS: [&str; 2] = ["claim", "claim-mean"];
/// The limits of the bound of a mean: far beyond every number of a run, and not infinite.
const BOUNDS: [f64; 2] = [-1e9, 1e9];
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
    /// The first fault of the file, with its line, the allowed values, and the nearest right word.
    pub fn read(name: &str, text: &str) -> Result<Self, LessonError> {
        if text.len() > MAX_BYTES {
            let length = text.len();
            let message = format!("the file has {length} bytes; a lesson has at most {MAX_BYTES}");
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
        let minutes = front.optional("minutes", |field| field.number([1.0, 120.0]))?;
        let form = |field: &Field| TestForm::named(&field.value, field.line);
        let mut lesson = Self {
            name: name.to_owned(),
            title: front.need("title")?.value.clone(),
            objective: front.need("objective")?.value.clone(),
            minutes: minutes.unwrap_or(10.0) as u32,
            form: front.optional("form", form)?,
            hash: blake3::hash(text.as_bytes()).to_hex()[..16].to_owned(),
            steps,
        };
        if lesson.form.is_some() {
            // All who take a form have the same instances; otherwise their scores could not be compared.
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

/// Refuses a form with a question that is about no concept or about that of a question before it, or that gives help.
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
        if let Some(other) = gates[..index].iter().find(|it| it.concept == Some(concept)) {
            let (name, line) = (concept.name(), other.line);
            let message = format!("the question of line {line} is about \"{name}\" already");
            return Err(wrong(message));
        }
        if matches!(gate.kind, GateKind::Trace { .. }) {
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
                let message = "the title of a step begins with one \"#\" and a space; there are no other titles";
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
            scene: scene.unwrap_or(SceneSpec {
                parameters: FIRST,
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

    fn directive(&mut self, info: &str, line: usize) -> Result<(), LessonError> {
        let fault = "the directive has no end; it ends with a line of three backticks";
        let lines = self.up_to("```", fault)?;
        let (kind, name) = info.split_once(' ').unwrap_or((info, ""));
        if !DIRECTIVES.contains(&kind) {
            return Err(LessonError::unknown(line, "directive", kind, &DIRECTIVES));
        }
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
                let gate = gate(name.clone(), line, &lines)?;
                step.after
                    .extend(gate.because.iter().map(|text| text.text.clone()));
                (step.name, step.gate) = (name, Some(gate));
            }
            ("note", _) => {
                let text = lines.join("\n");
                let paragraphs = text.split("\n\n");
                let paragraphs = paragraphs.map(|part| part.replace('\n', " ").trim().to_owned());
                step.notes
                    .extend(paragraphs.filter(|part| !part.is_empty()));
            }
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

/// Changes a scene by a `run` directive. Parameters, moment and layers that it does not name stay; the condition of the
/// moment and the camera do not.
fn run(scene: &mut SceneSpec, fields: &Fields) -> Result<(), LessonError> {
    let known: Vec<&str> = PARAMETERS.iter().chain(&OF_RUN).copied().collect();
    fields.only(&known, &CLAIMS)?;
    scene.line = fields.line;
    scene.claims = claims(fields)?;
    let is_parameter = |field: &&Field| PARAMETERS.contains(&field.key.as_str());
    for field in fields.all.iter().filter(is_parameter) {
        scene.parameters = with_parameter(&scene.parameters, field)?;
    }
    scene.camera = Camera::Fit;
    if let Some(field) = fields.get("moment") {
        scene.moment = Moment::read(&field.value, field.line)?;
    }
    scene.condition = fields.optional("where", |field| expression(&field.text(), &[]))?;
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
                let radii = field.part(radii).number([2.0, 1_000.0])?;
                Camera::At(expression(&Text::new(place, field.line), &[])?, radii)
            }
            _ => {
                let message = "the camera is \"fit\" or of the form \"EXPRESSION radii 12\", where the expression gives a \
                               sample or a place [x, y]";
                return Err(field.wrong(message));
            }
        };
    }
    let wrong = |message: String| LessonError::new(fields.line, message);
    let domain = scene.parameters.validate();
    let domain = domain.map_err(|error| wrong(error.to_string()))?;
    let samples = domain.area_radii() * MAXIMAL_DENSITY;
    if samples > MAX_SAMPLES {
        return Err(wrong(format!(
            "the run would have about {samples:.0} samples; a lesson's has at most {MAX_SAMPLES}"
        )));
    }
    Ok(())
}

/// Returns the claims of a run, in the order of the file.
fn claims(fields: &Fields) -> Result<Vec<Claim>, LessonError> {
    let all = fields.all.iter();
    let claims = all.filter_map(|field| match field.key.as_str() {
        "claim" => Some(expression(&field.text(), &[]).map(Claim::Each)),
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
        of: expression(&Text::new(of.trim(), field.line), &[])?,
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

/// Returns an expression that parses and uses only known names, and `more`.
fn expression(text: &Text, more: &[&str]) -> Result<Text, LessonError> {
    syntax::check(&text.text, text.line, more)?;
    Ok(text.clone())
}

fn paragraph(text: &Text) -> Result<Text, LessonError> {
    let checked = sentence(text)?;
    if prose::plain(&text.text).trim().is_empty() {
        return Err(text.wrong("the text is empty"));
    }
    Ok(checked)
}

/// Returns a text whose expressions in braces parse.
fn sentence(text: &Text) -> Result<Text, LessonError> {
    syntax::check_text(&text.text, text.line)?;
    Ok(text.clone())
}

/// Returns a query; one with values of the moment is read when they are known.
fn query(field: &Field) -> Result<Text, LessonError> {
    if !field.value.contains('{') {
        Moment::read(&format!("after {}", field.value), field.line)?;
    }
    sentence(&field.text())
}

/// The fields that every gate may have.
const OF_GATE: [&str; 12] = [
    "type", "ask", "hint", "mark", "circle", "strip", "decided", "shows", "practice", "because",
    "read", "concept",
];
/// The radii of circles and the widths of strips, in r: a smaller one lies under its mark, a larger one beyond every canvas.
const CIRCLES: [f64; 2] = [0.1, 20.0];

fn gate(name: String, line: usize, lines: &[&str]) -> Result<Gate, LessonError> {
    let mut fields = Fields::read("a gate", line, lines)?;
    // The other fields are known only once the type is.
    let is_alike = |field: &&Field| nearest(&field.key, &["type"]).is_some();
    if let (None, Some(field)) = (fields.get("type"), fields.all.iter().find(is_alike)) {
        let (line, what) = (field.line, "field of a gate");
        return Err(LessonError::unknown(line, what, &field.key, &["type"]));
    }
    let named = fields.need("type")?;
    let (name_line, named) = (named.line, named.value.clone());
    if !GateKind::NAMES.contains(&named.as_str()) {
        let (what, names) = ("type of gate", &GateKind::NAMES);
        return Err(LessonError::unknown(name_line, what, &named, names));
    }
    fields.of = format!("a {named} gate");
    let (once, many): (&[&str], &[&str]) = match named.as_str() {
        "pick" => (
            &["answer", "candidates", "several", "otherwise"],
            &["wrong"],
        ),
        "place" => (
            &["right", "answer", "within", "otherwise"],
            &["wrong", "candidate"],
        ),
        "number" => (
            &["answer", "tolerance", "unit", "otherwise", "curve"],
            &["wrong"],
        ),
        "choice" => (&[], &["option", "curve"]),
        "order" => (&["otherwise"], &["item"]),
        "bands" => (&["from", "to", "otherwise"], &["band"]),
        "trace" => (&["events", "steps"], &["option"]),
        _ => (&["otherwise"], &[]),
    };
    let once: Vec<&str> = OF_GATE.iter().chain(once).copied().collect();
    fields.only(&once, many)?;
    let kind = kind(&named, &fields)?;
    let said = |field: &Field| paragraph(&field.text());
    let practice = match fields.get("practice") {
        None => Some(1..=40),
        Some(field) if field.value == "none" => None,
        Some(field) => Some(field.seeds()?),
    };
    Ok(Gate {
        name,
        ask: paragraph(&fields.need("ask")?.text())?,
        wrong: wrongs(&named, &fields)?,
        kind,
        hint: fields.optional("hint", said)?,
        otherwise: fields.optional("otherwise", said)?,
        because: fields.optional("because", said)?,
        is_reading: fields.optional("read", yes_or_no)?.unwrap_or(false),
        mark: fields.optional("mark", |field| expression(&field.text(), &[]))?,
        circle: fields.optional("circle", |field| field.number(CIRCLES))?,
        strip: fields.optional("strip", |field| field.number(CIRCLES))?,
        decided: fields.optional("decided", query)?,
        shows: fields.optional("shows", layers)?.unwrap_or_default(),
        concept: fields.optional("concept", |field| Concept::named(&field.value, field.line))?,
        practice,
        line,
    })
}

fn wrongs(kind: &str, fields: &Fields) -> Result<Vec<Wrong>, LessonError> {
    let more: &[&str] = if kind == "pick" { &["s"] } else { &[] };
    let wrongs = fields.many("wrong").map(|field| {
        let (answer, Some(said)) = field.split("=>") else {
            let message = "a wrong answer is of the form \"wrong: EXPRESSION => SENTENCE\"";
            return Err(field.wrong(message));
        };
        Ok(Wrong {
            sentence: sentence(&Text::new(said, field.line))?,
            answer: expression(&Text::new(answer, field.line), more)?,
        })
    });
    wrongs.collect()
}

fn kind(named: &str, fields: &Fields) -> Result<GateKind, LessonError> {
    let need = |key: &str, more: &[&str]| expression(&fields.need(key)?.text(), more);
    let number = |key: &str, otherwise: f64, limits: [f64; 2]| {
        let read = fields.optional(key, |field| field.number(limits))?;
        Ok(read.unwrap_or(otherwise))
    };
    let plain = |field: &Field| expression(&field.text(), &[]);
    Ok(match named {
        "pick" => GateKind::Pick {
            answer: need("answer", &["s"])?,
            candidates: need("candidates", &["s"])?,
            several: fields.optional("several", yes_or_no)?.unwrap_or(false),
        },
        "place" => GateKind::Place {
            right: need("right", &[])?,
            answer: fields.optional("answer", |field| expression(&field.text(), &["x", "y"]))?,
            within: number("within", 0.25, [0.0, 2.0])?,
            candidates: limited("candidate", plain, 0, fields)?,
        },
        "number" => GateKind::Number {
            answer: need("answer", &[])?,
            tolerance: number("tolerance", 0.0, [0.0, 1e9])?,
            unit: fields
                .get("unit")
                .map_or(String::new(), |field| field.value.clone()),
            curve: fields.optional("curve", |field| expression(&field.text(), &[]))?,
        },
        "choice" => {
            let (options, curves) = (options(fields)?, limited("curve", plain, 0, fields)?);
            let [drawn, wanted] = [curves.len(), options.len()];
            if drawn != 0 && drawn != wanted {
                let message = format!(
                    "there are {drawn} curves and {wanted} options; each option has one curve"
                );
                return Err(LessonError::new(fields.line, message));
            }
            GateKind::Choice { options, curves }
        }
        "order" => {
            let item = |field: &Field| {
                let (text, Some(by)) = field.split(" by: ") else {
                    let message = "an item is of the form \"item: TEXT by: EXPRESSION\"";
                    return Err(field.wrong(message));
                };
                let [text, by] = [text, by].map(|part| Text::new(part, field.line));
                Ok((paragraph(&text)?, expression(&by, &[])?))
            };
            GateKind::Order {
                items: limited("item", item, 3, fields)?,
            }
        }
        "bands" => GateKind::Bands {
            from: need("from", &[])?,
            to: need("to", &[])?,
            bands: limited("band", band, 2, fields)?,
        },
        "trace" => GateKind::Trace {
            events: query(fields.need("events")?)?,
            steps: number("steps", 6.0, [1.0, MAX_TRACED as f64])? as usize,
            options: options(fields)?,
        },
        _ => GateKind::Cut,
    })
}

fn yes_or_no(field: &Field) -> Result<bool, LessonError> {
    match field.value.as_str() {
        "yes" => Ok(true),
        "no" => Ok(false),
        _ => Err(field.wrong(format!("\"{}\" is yes or no", field.key))),
    }
}

fn band(field: &Field) -> Result<[f64; 2], LessonError> {
    let (low, Some(high)) = field.split("..") else {
        return Err(field.wrong("a band is of the form \"band: 0.2..0.5\", in 1/r"));
    };
    let end = |text: &str| field.part(text).number([0.0, 3.0]);
    Ok([end(low)?, end(high)?])
}

/// Returns the options `TEXT when: EXPRESSION => SENTENCE`; the sentence may be missing.
fn options(fields: &Fields) -> Result<Vec<ChoiceOption>, LessonError> {
    let option = |field: &Field| {
        let text = |text: &str| Text::new(text.trim(), field.line);
        let (shown, Some(rest)) = field.split(" when: ") else {
            let message = "an option is of the form \"option: TEXT when: EXPRESSION => SENTENCE\"; the sentence may be left out";
            return Err(field.wrong(message));
        };
        let (when, said) = match rest.split_once("=>") {
            Some((when, said)) => (when, Some(sentence(&text(said))?)),
            None => (rest, None),
        };
        Ok(ChoiceOption {
            text: paragraph(&text(shown))?,
            when: expression(&text(when), &[])?,
            sentence: said,
        })
    };
    limited("option", option, 2, fields)
}

/// Reads the fields of a key, at least `least` and at most [`MAX_OPTIONS`].
fn limited<T>(
    key: &str,
    read: impl Fn(&Field) -> Result<T, LessonError>,
    least: usize,
    fields: &Fields,
) -> Result<Vec<T>, LessonError> {
    let items: Vec<T> = fields.many(key).map(read).collect::<Result<_, _>>()?;
    let (of, count) = (&fields.of, items.len());
    if count < least || count > MAX_OPTIONS {
        let message = format!("{of} has from {least} to {MAX_OPTIONS} of \"{key}\", not {count}");
        return Err(LessonError::new(fields.line, message));
    }
    Ok(items)
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
