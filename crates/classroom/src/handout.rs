//! Handouts of lessons: one HTML file with a picture of each step, the questions, and space to write, which prints on A4
//! and on Letter. Begin with [`HandoutTask`].

use std::fmt::Write as _;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use tilescope_figures::{Scene, escape, to_svg};
use tilescope_lessons::{Control, Curve, Item, Lesson, Row, Style, Translation, spans};
use tilescope_session::jobs::Monitor;
use tilescope_session::language::Language;
use tilescope_session::task::Task;

use crate::lesson_labels::{LessonLabels, lesson_labels};
use crate::lesson_picture::{PictureStyle, picture, step_at};
use crate::lessons::OpenLesson;
use crate::talk::TalkRecord;

/// Width and height of a picture, in points. On paper it is scaled to the column that [`CSS`] leaves for it.
const PICTURE: [f64; 2] = [420.0, 330.0];
/// Width and height of a plot. Chosen, not measured, like the sizes around it.
const PLOT: [f64; 2] = [320.0, 90.0];
/// The height of the numbers below a plot, and where their baseline lies in it.
const TICK_ROOM: f64 = 16.0;
const TICK_BASELINE: f64 = 13.0;
/// The highest frequency, in 1/r, and the highest power of a plot. White noise has the power 1. Chosen, not measured.
const REACH: [f64; 2] = [3.0, 3.0];

/// The task of making a handout. Its outcome is the file, or a sentence with the reason why there is none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HandoutTask {
    /// The name of the lesson.
    pub name: String,
    /// The content of the lesson's file.
    pub text: String,
    /// The language of the words around it; empty for English.
    pub language: String,
    /// The content of the translation's file, if the lesson is shown in one.
    pub translation: Option<String>,
    /// Whether the answers are printed.
    pub answers: bool,
    /// Whether the speaker's notes are printed.
    pub notes: bool,
    /// Drawings and votes of a talk.
    pub record: Option<TalkRecord>,
}

/// Makes a handout; returns the file.
///
/// # Errors
///
/// A sentence: a fault of the lesson, or a step whose run has no such moment.
pub fn handout(task: HandoutTask) -> Result<String, String> {
    task.run(&Monitor::reporting(|_, _| {}))
}

/// A lesson as a page shows it before any program runs.
#[derive(Clone, Debug, PartialEq)]
pub struct LessonSheet {
    /// Its title, as plain text.
    pub title: String,
    /// What a learner can do afterwards, as plain text.
    pub objective: String,
    /// How many minutes it takes alone.
    pub minutes: u32,
    /// Its steps, in order.
    pub steps: Vec<StepSheet>,
}

/// A step of a lesson as a page shows it, with its question open: no answer stands in it.
#[derive(Clone, Debug, PartialEq)]
pub struct StepSheet {
    /// Its name in links.
    pub name: String,
    /// Its title, as plain text.
    pub title: String,
    /// The paragraphs before the question, as HTML.
    pub texts: String,
    /// The question with its options, as HTML; empty if the step has none.
    pub question: String,
    /// The picture of its moment, light on dark and dark on light.
    pub pictures: [Scene; 2],
}

/// Returns a lesson for a page, with pictures of a size in points. Neither answers nor notes stand in it.
///
/// # Errors
///
/// As [`handout`].
pub fn lesson_sheet(task: &HandoutTask, size: [f64; 2]) -> Result<LessonSheet, String> {
    let (lesson, translation) = task.read()?;

    let mut steps = Vec::new();
    // Steps of one run share its recording.
    let mut last = None;
    for index in 0..lesson.steps.len() {
        let open = step_at(&lesson, &translation, index, &mut last)
            .map_err(|fault| format!("Step {}: {fault}.", index + 1))?;
        let step = open.learner.step();

        // Text and question are made apart, as a page may set the question off. Nothing is revealed, so that the
        // controls show no answer. A question about a trace asks for one event after another; here the first is shown.
        let (mut texts, mut question) = (String::new(), String::new());
        for paragraph in &step.text {
            put(&mut texts, &open.learner.words(paragraph));
        }
        if let Some(asked) = open.learner.question() {
            ask(
                &mut question,
                asked.ask(0),
                &open.controls(&task.language),
                task.decimal_sign(),
            );
        }

        // Both looks of one moment, since finding it takes longer than drawing it. No strokes of a talk are drawn.
        steps.push(StepSheet {
            name: step.name.clone(),
            title: open.learner.words(&step.title),
            texts,
            question,
            pictures: [true, false].map(|dark| picture(&open, PictureStyle { size, dark }, &[])),
        });
    }

    Ok(LessonSheet {
        title: translation.of(&lesson.title).to_owned(),
        objective: translation.of(&lesson.objective).to_owned(),
        minutes: lesson.minutes,
        steps,
    })
}

impl Task for HandoutTask {
    type Outcome = Result<String, String>;
    const NAME: &'static str = "handout";

    fn run(self, monitor: &Monitor) -> Self::Outcome {
        let (lesson, translation) = self.read()?;
        self.html(&lesson, &translation, monitor)
    }
}

impl HandoutTask {
    /// Reads the lesson and its translation.
    fn read(&self) -> Result<(Arc<Lesson>, Arc<Translation>), String> {
        let lesson = Lesson::read(&self.name, &self.text).map_err(|error| error.to_string())?;
        let translation = match &self.translation {
            Some(text) => Translation::read(text).map_err(|error| error.to_string())?,
            None => Translation::default(),
        };
        Ok((
            Arc::new(lesson),
            Arc::new(translation.with_decimal_sign(self.decimal_sign())),
        ))
    }

    /// Returns what divides a number from its decimals in its language; a point in English and in languages without a table.
    fn decimal_sign(&self) -> char {
        Language::of(&self.language).map_or('.', Language::decimal_sign)
    }

    /// Returns the handout: a head, and a section for each step.
    fn html(
        &self,
        lesson: &Arc<Lesson>,
        translation: &Arc<Translation>,
        monitor: &Monitor,
    ) -> Result<String, String> {
        let language = &self.language;
        let labels = lesson_labels(language);
        let title = escape(translation.of(&lesson.title));

        let mut html = format!(
            "<!doctype html>\n<html lang=\"{}\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{title}</title>\n<style>{CSS}</style>\n</head>\n<body>\n<h1>{title}</h1>\n<p class=\"objective\">{}</p>\n",
            escape(if language.is_empty() { "en" } else { language }),
            escape(translation.of(&lesson.objective)),
        );

        // `step_at` leaves the run of a step here, and uses it again for a step with the same parameters.
        let mut last = None;
        for index in 0..lesson.steps.len() {
            monitor.set_fraction(index as f32 / lesson.steps.len() as f32);
            if monitor.is_cancelled() {
                return Err("The handout was cancelled.".to_owned());
            }

            let mut step = step_at(lesson, translation, index, &mut last)
                .map_err(|fault| format!("Step {}: {fault}.", index + 1))?;
            self.section(&mut html, index, &mut step, labels)?;
        }

        html.push_str("</body>\n</html>\n");
        Ok(html)
    }

    /// Writes the section of a step: picture, text, question with its controls, the answer or space for one, and the
    /// notes if they are wanted.
    fn section(
        &self,
        html: &mut String,
        index: usize,
        open: &mut OpenLesson,
        labels: &LessonLabels,
    ) -> Result<(), String> {
        let step = open.learner.step().clone();
        let key = format!("{}/{}", open.learner.lesson().name, step.name);

        let record = self.record.as_ref();
        let strokes = record.map_or(&[][..], |record| record.strokes_in(&key));

        // Pictures on paper are light, whatever look the window has.
        let style = PictureStyle {
            size: PICTURE,
            dark: false,
        };
        let svg = to_svg(&picture(open, style, strokes)).map_err(|error| error.to_string())?;

        let heading = escape(&open.learner.words(&step.title));
        let _ = write!(
            html,
            "<section>\n<h2>{}. {heading}</h2>\n<div class=\"step\">\n<img alt=\"{heading}\" width=\"{}\" height=\"{}\" src=\"{}\">\n<div>\n",
            index + 1,
            PICTURE[0],
            PICTURE[1],
            data_url(&svg),
        );

        for paragraph in &step.text {
            put(html, &open.learner.words(paragraph));
        }
        html.push_str("</div>\n</div>\n");

        // The controls are written first: once the answer is revealed they show it. A question about a trace asks for
        // one event after another; here the first is shown.
        if let Some(question) = open.learner.question() {
            let controls = open.controls(&self.language);
            ask(html, question.ask(0), &controls, self.decimal_sign());
            if self.answers {
                open.learner.reveal();

                // There is a question, so that there is an answer.
                let answer = open.right_answer(&self.language).unwrap_or_default();
                let _ = write!(
                    html,
                    "<div class=\"answer\"><p><strong>{}</strong> {}</p>",
                    labels.the_answer,
                    inline(&answer)
                );

                for paragraph in &step.after {
                    put(html, &open.learner.words(paragraph));
                }
                html.push_str("</div>\n");
            } else {
                // Space to write the answer by hand.
                html.push_str("<div class=\"lines\"><p></p><p></p><p></p></div>\n");
            }
        }

        let notes = step.notes.iter().filter(|_| self.notes);
        for note in notes {
            let note = inline(open.learner.speaker_note(note));
            let _ = writeln!(html, "<p class=\"note\">{note}</p>");
        }

        html.push_str("</section>\n");
        Ok(())
    }
}

/// Writes a question with the controls that paper has. `sign` divides a number from its decimals.
fn ask(html: &mut String, asked: &str, controls: &[Control], sign: char) {
    let _ = writeln!(html, "<p class=\"ask\">{}</p>", inline(asked));

    for control in controls {
        match control {
            Control::Line {
                text,
                is_printed: true,
            } => {
                let _ = writeln!(html, "<p>{}</p>", escape(text));
            }
            // Other lines say how to use the controls of a window.
            Control::Line { .. } => {}
            Control::List { items } => list(html, items.iter().map(|one| item(one, sign))),
            Control::Chips { items } => {
                let names: Vec<String> = items.iter().map(|one| item(one, sign)).collect();
                choices(html, &names.join(" &#160; "));
            }
            Control::Rows { rows } => {
                // A row without a name chooses a part of an answer, such as the direction of a cut. The list that comes with it
                // has the whole answers, which suffice on paper.
                let named = rows
                    .iter()
                    .filter_map(|row| Some((row.name.as_ref()?, row)));
                let lines: Vec<String> = named.map(|(name, row)| line(name, row)).collect();
                if !lines.is_empty() {
                    list(html, lines.into_iter());
                }
            }
            // The name of the field is for screen readers: on paper there is room to write.
            Control::Field { unit, .. } => choices(html, &format!("_______ {}", escape(unit))),
            Control::Plot { curves } => {
                let curves: Vec<&Curve> = curves.iter().collect();
                html.push_str(&plot(&curves, sign));
            }
        }
    }
}

/// Writes a list with letters.
fn list(html: &mut String, items: impl Iterator<Item = String>) {
    html.push_str("<ol class=\"options\" type=\"A\">\n");
    for item in items {
        let _ = writeln!(html, "<li>{item}</li>");
    }
    html.push_str("</ol>\n");
}

/// Writes the words to choose from in one line.
fn choices(html: &mut String, choices: &str) {
    let _ = writeln!(html, "<p class=\"choices\">{choices}</p>");
}

/// Returns an item with the spectrum beside it.
fn item(item: &Item, sign: char) -> String {
    let plot = item.curve.as_ref().map(|curve| plot(&[curve], sign));
    inline(&item.text) + plot.as_deref().unwrap_or("")
}

/// Returns a row of words, one of which is to be marked.
fn line(name: &str, row: &Row) -> String {
    let words: Vec<&str> = row.words.iter().map(|word| word.text.as_str()).collect();
    format!("{name}: {}", words.join(" / "))
}

/// Returns a plot of spectra: power by frequency in 1/r. Screen readers skip it, as in the program: its numbers alone would say
/// nothing.
fn plot(curves: &[&Curve], sign: char) -> String {
    let [width, height] = PLOT;

    // In a picture y points downwards, while power grows upwards. A power beyond the plot is drawn at its top.
    let place = |[x, y]: [f64; 2]| {
        let at = [
            x / REACH[0] * width,
            height * (1.0 - (y / REACH[1]).min(1.0)),
        ];
        format!("{:.1},{:.1}", at[0], at[1])
    };

    let polyline = |points: &str, style: &str| {
        format!("<polyline points=\"{points}\" fill=\"none\" stroke=\"{style}\"/>")
    };

    // Below the plot there is room for the numbers of the ticks.
    let mut svg = format!(
        "<svg class=\"plot\" viewBox=\"0 0 {width} {}\" width=\"{width}\" aria-hidden=\"true\">",
        height + TICK_ROOM
    );

    // Grey lines at the power 0 and at 1, that of white noise.
    for level in [0.0, 1.0] {
        let ends = [place([0.0, level]), place([REACH[0], level])].join(" ");
        svg.push_str(&polyline(&ends, "#999"));
    }

    // Round numbers within the plot: one at either end would be cut off.
    for tick in [0.5, 1.0, 1.5, 2.0, 2.5] {
        let at = tick / REACH[0] * width;
        let number = tick.to_string().replace('.', &sign.to_string());
        // One number has the unit, which would not fit beside each.
        let unit = if tick > 2.0 { " / r" } else { "" };
        let _ = write!(
            svg,
            "<text x=\"{at:.1}\" y=\"{}\" font-size=\"11\" text-anchor=\"middle\">{number}{unit}</text>",
            height + TICK_BASELINE
        );
    }

    // Beyond the plot a curve ends, as a line outside of it would cross the words beside it.
    for curve in curves {
        let inside = curve.iter().filter(|[x, _]| *x <= REACH[0]);
        let points: Vec<String> = inside.map(|&at| place(at)).collect();
        svg.push_str(&polyline(&points.join(" "), "#1f5fd0"));
    }

    svg.push_str("</svg>");
    svg
}

/// Writes a paragraph, or an item of a list.
fn put(html: &mut String, paragraph: &str) {
    let (class, text) = match paragraph.strip_prefix("- ") {
        Some(item) => (" class=\"item\"", format!("\u{2022} {item}")),
        None => ("", paragraph.to_owned()),
    };
    let _ = writeln!(html, "<p{class}>{}</p>", inline(&text));
}

/// Returns a paragraph of a lesson as HTML; no part of it is read as HTML.
fn inline(paragraph: &str) -> String {
    let parts = spans(paragraph).into_iter().map(|span| {
        let text = escape(&span.text);
        match span.style {
            Style::Plain => text,
            Style::Emphasis => format!("<em>{text}</em>"),
            Style::Strong => format!("<strong>{text}</strong>"),
            Style::Code => format!("<code>{text}</code>"),
        }
    });
    parts.collect()
}

/// Returns a picture as a data URL, so that the names of its parts do not clash with those of other pictures in the document.
fn data_url(svg: &str) -> String {
    let mut url = "data:image/svg+xml,".to_owned();
    for c in svg.chars() {
        match c {
            // Only characters with a meaning in URLs or HTML: all others take less room as they are than in base64.
            '%' => url.push_str("%25"),
            // As an attribute's value the URL is decoded once as HTML: `&lt;` in the drawing would end as `<`.
            '&' => url.push_str("%26"),
            '#' => url.push_str("%23"),
            '<' => url.push_str("%3C"),
            '>' => url.push_str("%3E"),
            '"' => url.push_str("%22"),
            '\n' => url.push_str("%0A"),
            c => url.push(c),
        }
    }

    url
}

const CSS: &str = "
@page { margin: 15mm; }
body { font: 11pt/1.45 'Segoe UI', 'Helvetica Neue', Helvetica, Arial, sans-serif; color: #111; max-width: 180mm; margin: 0 auto; padding: 4mm; }
h1 { font-size: 20pt; margin: 0 0 2mm; }
h2 { font-size: 13pt; margin: 0 0 2mm; }
p { margin: 0 0 2mm; }
.objective { color: #444; margin-bottom: 6mm; }
section { break-inside: avoid; border-top: 0.3mm solid #bbb; padding: 4mm 0 3mm; }
.step { display: grid; grid-template-columns: 78mm 1fr; gap: 5mm; align-items: start; }
.step img { width: 78mm; height: auto; border: 0.2mm solid #ccc; }
.ask { font-weight: 600; margin-top: 2mm; }
.options { margin: 0 0 2mm; padding-left: 7mm; }
.options li { margin-bottom: 1mm; }
.choices { letter-spacing: 0.03em; }
.item { padding-left: 4mm; }
.plot { display: block; max-width: 90mm; margin: 1mm 0 2mm; }
.lines p { height: 7mm; margin: 0; border-bottom: 0.2mm solid #999; }
.answer { border-left: 1mm solid #2a7d3f; padding-left: 3mm; }
.note { border-left: 1mm solid #888; padding-left: 3mm; color: #444; font-style: italic; }
code { font-family: 'DejaVu Sans Mono', Consolas, monospace; font-size: 0.92em; }
@media (max-width: 600px) { .step { grid-template-columns: 1fr; } .step img { width: 100%; } }
";

#[cfg(test)]
mod tests {
    use super::*;
    use tilescope_lessons::shipped;

    fn made(task: HandoutTask) -> String {
        handout(task).unwrap()
    }

    fn survivors() -> HandoutTask {
        let all = shipped::lessons();
        let lesson = all
            .iter()
            .find(|lesson| lesson.name == "survivors")
            .unwrap();
        HandoutTask {
            name: lesson.name.to_string(),
            text: lesson.text.to_string(),
            ..HandoutTask::default()
        }
    }

    #[test]
    fn a_drawing_in_a_url_keeps_its_references() {
        assert_eq!(
            data_url("<t>1 &lt; 2</t>"),
            "data:image/svg+xml,%3Ct%3E1 %26lt; 2%3C/t%3E"
        );
    }

    #[test]
    fn a_handout_has_a_picture_a_step_and_tells_answers_and_notes_on_request_only() {
        let task = survivors();
        let lesson = Lesson::read("survivors", &task.text).unwrap();
        let plain = made(task.clone());
        assert_eq!(
            plain.matches("data:image/svg+xml,").count(),
            lesson.steps.len()
        );
        assert!(plain.contains("class=\"lines\""));
        let note = inline(
            &lesson
                .steps
                .iter()
                .flat_map(|step| &step.notes)
                .next()
                .unwrap()
                .clone(),
        );
        let after = &lesson.gates().next().unwrap().0.after[0];
        // A short piece, such as a name, stands elsewhere too.
        let outside = after.split('{').filter_map(|part| part.rsplit('}').next());
        let pieces = outside
            .flat_map(|part| part.split(['*', '`']))
            .map(str::trim);
        let after = pieces.max_by_key(|piece| piece.len()).unwrap().to_owned();
        assert!(
            !plain.contains("The answer:") && !plain.contains(&note) && !plain.contains(&after)
        );
        let full = made(HandoutTask {
            answers: true,
            notes: true,
            ..task
        });
        assert!(full.contains("The answer:") && full.contains(&note) && full.contains(&after));
    }

    #[test]
    fn numbers_of_a_plot_have_the_decimal_sign_of_the_language() {
        let [english, german] = ["en", "de"].map(|language| {
            let task = HandoutTask {
                language: language.to_owned(),
                ..survivors()
            };
            plot(&[], task.decimal_sign())
        });
        assert!(english.contains(">1.5<") && english.contains(">2.5 / r<"));
        assert!(german.contains(">1,5<") && german.contains(">2,5 / r<"));
        assert!(!german.contains(">1.5<") && german.contains(">1<"));
    }

    #[test]
    fn nothing_of_a_lesson_is_read_as_html() {
        let text = "---\ntitle: <script>alert(1)</script>\nobjective: a & b\n---\n# One <b>bold</b>\n```run\nradius: 0.06\nleaf: 6\nmoment: end of tile\n```\nText <img src=x>.\n";
        let html = made(HandoutTask {
            name: "x".to_owned(),
            text: text.to_owned(),
            ..HandoutTask::default()
        });
        assert!(!html.contains("<script") && !html.contains("<b>") && !html.contains("<img src=x"));
        assert!(html.contains("a &amp; b"));
    }

    #[test]
    fn a_fault_names_its_step() {
        let text = "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.06\nleaf: 6\nmoment: end of iterate-40\n```\n";
        let task = HandoutTask {
            name: "x".to_owned(),
            text: text.to_owned(),
            ..HandoutTask::default()
        };
        let error = handout(task).unwrap_err();
        assert!(
            error.contains("Step 1") && error.contains("no such moment"),
            "{error}"
        );
    }
}
