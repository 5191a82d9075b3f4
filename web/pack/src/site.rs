//! What can be read before any program runs: the lessons as cards of the first page, a page for each lesson in each of its
//! languages, their pictures, and the map of the site. All of it comes from the lessons' own files.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use anyhow::{Context, Result, anyhow};
use serde_json::json;
use tilescope_classroom::handout::{HandoutTask, LessonSheet, StepSheet, lesson_sheet};
use tilescope_figures::{escape, to_png, to_svg};
use tilescope_lessons::shipped::{self, Shipped};

use crate::compress;
use crate::page::{File, Source};

/// The page of a lesson, with marks as `[[title]]`.
const LESSON: &str = include_str!("site/lesson.html");

/// Width and height of a step's picture, in points.
const PICTURE: [f64; 2] = [640.0, 420.0];
/// Pixels in a point of a preview, the picture that chats and feeds show of a link.
const PREVIEW: f64 = 2.0;

/// The step whose picture is a lesson's cover, from 1: the one that shows at a glance what the lesson is about. Other
/// lessons have the picture of their first step.
const COVERS: [(&str, usize); 10] = [
    ("welcome", 3),
    ("maximal", 3),
    ("spectrum", 3),
    ("clips", 4),
    ("survivors", 3),
    ("losses", 4),
    ("gaps", 3),
    ("rounds", 2),
    ("tiling", 4),
    ("parallel", 3),
];

/// The step that the first page shows in large, by its lesson and its number: the disks around a gap.
const HERO: (&str, usize) = ("gaps", 1);
/// What it shows.
const HERO_TEXT: &str = "Samples, each with its disk in the colour of its block. Among the disks lies one small hatched \
    area that none of them covers.";

/// The address that snippets have where the site's own is not known; `site.js` replaces it.
const SOME_ADDRESS: &str = "https://example.org/tilescope/";

/// Where the first page begins in `index.html`, and where the program's part.
const FIRST_PAGE_BEGINS: &str = "<div id=\"site\">";
const PROGRAM_BEGINS: &str = "<template id=\"program\">";

/// The words around a lesson in one language.
struct Words {
    /// The language's tag.
    tag: &'static str,
    /// Its own name.
    own_name: &'static str,
    /// The folder of its pages below that of the lesson.
    folder: &'static str,
    /// From there to the site's folder.
    up: &'static str,
    /// What a link's fragment has behind the lesson.
    link: &'static str,
    marks: [(&'static str, &'static str); 14],
}

const ENGLISH: Words = Words {
    tag: "en",
    own_name: "English",
    folder: "",
    up: "../../",
    link: "",
    marks: [
        ("all", "All lessons"),
        ("begin", "Begin"),
        ("begin-here", "Begin at this step"),
        ("minutes", "minutes"),
        ("steps", "What it asks"),
        (
            "no-answers",
            "The answers are computed from the run, so they are not printed here. Begin, predict, and see what happens.",
        ),
        (
            "no-scripts",
            "The text can be read as it is. To begin, allow JavaScript for this site: the lesson runs in the browser and sends nothing anywhere.",
        ),
        ("picture", "the points at this moment"),
        ("embed", "Put a question into your own page"),
        (
            "embed-text",
            "Copy the snippet of a question and replace course.example by the origin of your page. The frame sends your page messages: the height that the question needs, and after each answer lesson, step, score and tries. This script, once in your page, gives frames their height and is where to use the answers:",
        ),
        ("licence", "Text and pictures of this lesson:"),
        ("next", "Next lesson"),
        ("languages", "Language"),
        ("lesson", "Lesson"),
    ],
};

const GERMAN: Words = Words {
    tag: "de",
    own_name: "Deutsch",
    folder: "de/",
    up: "../../../",
    link: "&language=de",
    marks: [
        ("all", "Alle Lektionen"),
        ("begin", "Beginnen"),
        ("begin-here", "Mit diesem Schritt beginnen"),
        ("minutes", "Minuten"),
        ("steps", "Was gefragt wird"),
        (
            "no-answers",
            "Die Antworten werden aus dem Lauf berechnet, deshalb stehen sie hier nicht. Beginne, sage voraus, und sieh, was geschieht.",
        ),
        (
            "no-scripts",
            "Der Text lässt sich so lesen. Um zu beginnen, erlaube JavaScript für diese Seite: Die Lektion läuft im Browser und sendet nichts.",
        ),
        ("picture", "die Punkte in diesem Augenblick"),
        ("embed", "Eine Frage in die eigene Seite setzen"),
        (
            "embed-text",
            "Kopiere den Ausschnitt einer Frage und ersetze course.example durch den Ursprung deiner Seite. Der Rahmen sendet deiner Seite Nachrichten: die Höhe, die die Frage braucht, und nach jeder Antwort Lektion, Schritt, Punktzahl und Zahl der Versuche. Dieses Skript gehört einmal in deine Seite; es gibt Rahmen ihre Höhe, und die Antworten kommen hier an:",
        ),
        ("licence", "Text und Bilder dieser Lektion:"),
        ("next", "Nächste Lektion"),
        ("languages", "Sprache"),
        ("lesson", "Lektion"),
    ],
};

/// A lesson in both languages.
struct Entry {
    name: String,
    english: LessonSheet,
    german: LessonSheet,
}

/// Adds what can be read before the program runs. `address` is the site's public address, or empty.
///
/// # Errors
///
/// A lesson that cannot be shown, a lesson or a step that is chosen above and does not exist, a mark that is not known,
/// and a missing `index.html`.
pub fn add(sources: &mut BTreeMap<String, Source>, address: &str) -> Result<()> {
    let entries: Vec<Entry> = shipped::lessons()
        .iter()
        .map(entry)
        .collect::<Result<_>>()?;

    for (index, entry) in entries.iter().enumerate() {
        add_pictures(sources, entry)?;
        for words in [&ENGLISH, &GERMAN] {
            let next = entries.get(index + 1);
            let page = lesson_page(entry, next, words, address)?;
            let name = format!("lesson/{}/{}index.html", entry.name, words.folder);
            sources.insert(name.clone(), Source::apart(&name, page.into_bytes()));
        }
    }

    // This script serves the snippets of lesson pages, so that the program's own page does not need it.
    if let Some(script) = sources.remove("site.js") {
        sources.insert("site.js".to_owned(), script.set_apart());
    }

    let index = sources
        .get_mut("index.html")
        .context("there is no file index.html")?;
    let page = filled(
        index.text()?,
        &[
            // This mark stands in the head of `index.html`, and also takes the data for search engines.
            ("address", first_page_head(&entries, address)),
            ("cards", cards(&entries)),
            ("hero", hero(&entries)?),
            ("count", entries.len().to_string()),
            ("repository", env!("CARGO_PKG_REPOSITORY").to_owned()),
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ],
    );
    *index = Source::of_page("index.html", page?.into_bytes());

    // A map of addresses needs whole ones.
    if !address.is_empty() {
        let robots = format!("User-agent: *\nAllow: /\nSitemap: {address}sitemap.xml\n");
        for (name, text) in [
            ("sitemap.xml", sitemap(&entries, address)),
            ("robots.txt", robots),
        ] {
            sources.insert(name.to_owned(), Source::apart(name, text.into_bytes()));
        }
    }
    Ok(())
}

/// Reads a lesson in both languages, and draws the pictures of its steps.
fn entry(lesson: &Shipped) -> Result<Entry> {
    let sheet = |language: &Words, translation: Option<String>| {
        let task = HandoutTask {
            name: lesson.name.to_string(),
            text: lesson.text.to_string(),
            language: language.tag.to_owned(),
            translation,
            ..HandoutTask::default()
        };
        lesson_sheet(&task, PICTURE).map_err(|fault| anyhow!("the lesson {}: {fault}", lesson.name))
    };
    Ok(Entry {
        name: lesson.name.to_string(),
        english: sheet(&ENGLISH, None)?,
        german: sheet(&GERMAN, Some(lesson.german.to_string()))?,
    })
}

impl Words {
    /// Returns the word of a mark.
    fn word(&self, mark: &str) -> &'static str {
        let found = self.marks.iter().find(|(name, _)| *name == mark);
        found.map_or("", |(_, word)| word)
    }
}

impl Entry {
    fn sheet(&self, words: &Words) -> &LessonSheet {
        match words.tag {
            "de" => &self.german,
            _ => &self.english,
        }
    }

    /// Returns the index of the step whose picture is the cover.
    fn cover(&self) -> usize {
        let chosen = COVERS.iter().find(|(name, _)| *name == self.name);
        chosen.map_or(0, |(_, number)| number - 1)
    }

    fn preview_name(&self) -> String {
        format!("preview-{}.png", self.name)
    }

    /// Returns the names of the pictures of a step, the dark one first.
    fn picture_names(&self, index: usize) -> [String; 2] {
        ["", "-light"].map(|look| format!("lesson-{}-{}{look}.svg", self.name, index + 1))
    }

    /// Returns the picture of a step in HTML, by the look that the reader's system prefers; `attributes` are those of the
    /// image.
    fn picture(&self, index: usize, up: &str, attributes: &str) -> String {
        let [dark, light] = self.picture_names(index);
        let [width, height] = PICTURE;
        format!(
            "<picture><source media=\"print, (prefers-color-scheme: light)\" srcset=\"{up}{{{{asset:{light}}}}}\">\
             <img src=\"{up}{{{{asset:{dark}}}}}\" width=\"{width}\" height=\"{height}\" {attributes}></picture>"
        )
    }
}

/// Adds the pictures of a lesson's steps, and its preview for chats, which show no SVG. Pages in both languages show
/// the pictures of the English steps.
fn add_pictures(sources: &mut BTreeMap<String, Source>, entry: &Entry) -> Result<()> {
    let steps = &entry.english.steps;
    for (index, step) in steps.iter().enumerate() {
        for (name, picture) in entry.picture_names(index).into_iter().zip(&step.pictures) {
            let svg = to_svg(picture)?.into_bytes();
            sources.insert(name, Source::made(svg).set_apart());
        }
    }

    let cover = steps
        .get(entry.cover())
        .with_context(|| format!("{} has no step for its cover", entry.name))?;
    // The first of the pictures is the dark one. The program is dark, too, until a person chooses another look.
    let png = to_png(&cover.pictures[0], PREVIEW)?;
    sources.insert(entry.preview_name(), Source::made(png).set_apart());
    Ok(())
}

/// Returns how many bytes of `index.html` are the first page, not the program's part: uncompressed, by gzip, by brotli.
///
/// # Errors
///
/// There is no `index.html` in UTF-8, or the two parts are not where they are expected.
pub fn first_page_sizes(files: &[File]) -> Result<[usize; 3]> {
    let file = files.iter().find(|file| file.path == "index.html");
    let index = std::str::from_utf8(&file.context("there is no index.html")?.bytes)?;

    // Everything between the two marks is for readers.
    let (before, after) = index
        .split_once(FIRST_PAGE_BEGINS)
        .and_then(|(before, rest)| Some((before, rest.split_once(PROGRAM_BEGINS)?.1)))
        .context("index.html lacks the first page or the program's part")?;

    // Its share is the difference of the page with and without it, since a part alone compresses worse than within the
    // whole.
    let [with, without] =
        [index.to_owned(), format!("{before}{after}")].map(|text| compress::sizes(text.as_bytes()));
    Ok(std::array::from_fn(|kind| {
        with[kind].saturating_sub(without[kind])
    }))
}

/// Returns the lessons as cards of the first page: picture, title, what one can do afterwards, minutes and languages.
fn cards(entries: &[Entry]) -> String {
    let mut cards = String::new();
    for entry in entries {
        let name = &entry.name;
        let [title, objective] = texts(&entry.english);
        // Said to screen readers alone: links that all say "Deutsch" could not be told apart.
        let german = escape(&entry.german.title);

        // The picture is hidden from screen readers: the title beside it says as much.
        let _ = writeln!(
            cards,
            "<li class=\"card\">\n{picture}\n<div>\n\
             <h3><a class=\"whole\" href=\"lesson/{name}/\">{title}</a></h3>\n<p>{objective}</p>\n\
             <p class=\"facts\">{minutes} minutes · English · \
             <a href=\"lesson/{name}/de/\" hreflang=\"de\" lang=\"de\">Deutsch<span class=\"unseen\">: {german}</span></a></p>\n\
             </div>\n</li>",
            picture = entry.picture(entry.cover(), "", "alt=\"\" loading=\"lazy\""),
            minutes = entry.english.minutes,
        );
    }
    cards
}

/// Returns the large picture of the first page.
fn hero(entries: &[Entry]) -> Result<String> {
    let (lesson, number) = HERO;
    let entry = entries
        .iter()
        .find(|entry| entry.name == lesson)
        .with_context(|| format!("there is no lesson {lesson}"))?;
    // It is in view at once, so that browsers are to load it before other pictures.
    let attributes = format!("alt=\"{HERO_TEXT}\" fetchpriority=\"high\"");
    Ok(entry.picture(number - 1, "", &attributes))
}

/// Returns title and objective of a lesson for HTML.
fn texts(sheet: &LessonSheet) -> [String; 2] {
    [&sheet.title, &sheet.objective].map(|text| plain_html(text))
}

/// Returns a text for HTML in which nothing is a placeholder.
fn plain_html(text: &str) -> String {
    without_placeholders(&escape(text))
}

/// Returns HTML that shows the same, without the braces with which placeholders begin.
fn without_placeholders(html: &str) -> String {
    html.replace("{{", "{&#123;")
}

/// Returns what the head of the first page has about its address and its lessons.
fn first_page_head(entries: &[Entry], address: &str) -> String {
    // Without a public address the lessons' addresses are relative, which readers resolve against the page. (The data
    // of one lesson, which catalogues copy, has no address then.)
    let lessons = entries.iter().map(|entry| {
        json!({
            "@type": "LearningResource",
            "name": entry.english.title,
            "url": format!("{address}lesson/{}/", entry.name),
        })
    });
    let data = json!({
        "@context": "https://schema.org",
        "@type": "WebApplication",
        "name": "Tilescope",
        "applicationCategory": "EducationalApplication",
        "operatingSystem": "Any with a browser",
        "isAccessibleForFree": true,
        "inLanguage": ["en", "de"],
        "softwareVersion": env!("CARGO_PKG_VERSION"),
        "codeRepository": env!("CARGO_PKG_REPOSITORY"),
        "license": ["https://www.apache.org/licenses/LICENSE-2.0", "https://opensource.org/license/mit"],
        "hasPart": lessons.collect::<Vec<_>>(),
    });

    format!("{}{}", own_address(address, ""), data_element(&data))
}

/// Returns the canonical address of a page in the head, if the site's is known.
fn own_address(address: &str, path: &str) -> String {
    if address.is_empty() {
        return String::new();
    }
    let whole = format!("{address}{path}");
    format!(
        "<link rel=\"canonical\" href=\"{whole}\" />\n<meta property=\"og:url\" content=\"{whole}\" />\n"
    )
}

/// Returns data for search engines as an element of the head.
fn data_element(data: &serde_json::Value) -> String {
    // A text of a lesson cannot end the element.
    let text = data.to_string().replace('<', "\\u003c");
    format!("<script type=\"application/ld+json\">{text}</script>")
}

/// Returns the page of a lesson in a language.
fn lesson_page(
    entry: &Entry,
    next: Option<&Entry>,
    words: &Words,
    address: &str,
) -> Result<String> {
    let sheet = entry.sheet(words);
    let [title, objective] = texts(sheet);
    let up = words.up;
    let path = |words: &Words| format!("lesson/{}/{}", entry.name, words.folder);

    // First the parts that every lesson shares.
    let mut values: Vec<(&str, String)> = Vec::new();
    for (name, word) in words.marks {
        values.push((name, escape(word)));
    }

    // The last lesson has no next one.
    let next_link = next.map_or_else(String::new, |next| {
        let (name, folder) = (&next.name, words.folder);
        format!(
            "<a href=\"{up}lesson/{name}/{folder}\">{}: {}</a>",
            words.word("next"),
            plain_html(&next.sheet(words).title)
        )
    });

    let other = match words.tag {
        "de" => &ENGLISH,
        _ => &GERMAN,
    };

    // Then the lesson's own parts. Texts are escaped where they are made, as some of them are HTML already.
    values.extend([
        ("language", words.tag.to_owned()),
        ("title", title),
        ("objective", objective),
        ("up", up.to_owned()),
        ("duration", sheet.minutes.to_string()),
        (
            "lesson-link",
            format!("{up}#lesson={}{}", entry.name, escape(words.link)),
        ),
        ("address", own_address(address, &path(words))),
        ("alternates", alternates(address, up, &path)),
        (
            "data",
            data_element(&learning_resource(entry, words, address)),
        ),
        ("preview", entry.preview_name()),
        ("other-tag", other.tag.to_owned()),
        ("other-name", other.own_name.to_owned()),
        ("other-link", format!("{up}{}", path(other))),
        ("sections", sections(entry, words)),
        ("snippets", snippets(entry, words, address)),
        ("next-lesson", next_link),
    ]);
    filled(LESSON, &values).with_context(|| format!("the page of {}", entry.name))
}

/// Returns the links to a page in all of its languages, for search engines.
fn alternates(address: &str, up: &str, path: &dyn Fn(&Words) -> String) -> String {
    let from = if address.is_empty() { up } else { address };
    let link = |words: &Words, tag: &str| {
        let path = path(words);
        format!("<link rel=\"alternate\" hreflang=\"{tag}\" href=\"{from}{path}\" />\n")
    };
    let default = link(&ENGLISH, "x-default");
    [
        link(&ENGLISH, ENGLISH.tag),
        link(&GERMAN, GERMAN.tag),
        default,
    ]
    .concat()
}

/// Returns what search engines and catalogues of teaching material read about a lesson.
fn learning_resource(entry: &Entry, words: &Words, address: &str) -> serde_json::Value {
    let sheet = entry.sheet(words);

    // What a learner can do afterwards says both what the lesson is about and what it teaches.
    let mut data = json!({
        "@context": "https://schema.org",
        "@type": "LearningResource",
        "name": sheet.title,
        "description": sheet.objective,
        "teaches": sheet.objective,
        "inLanguage": words.tag,
        "timeRequired": format!("PT{}M", sheet.minutes),
        "learningResourceType": "interactive lesson",
        "interactivityType": "active",
        "educationalUse": ["self study", "lecture"],
        "educationalLevel": "university",
        "isAccessibleForFree": true,
        "license": "https://creativecommons.org/licenses/by/4.0/",
        "isPartOf": { "@type": "WebApplication", "name": "Tilescope" },
    });

    // Catalogues copy these, so that a relative address would lead nowhere.
    if !address.is_empty() {
        let path = format!("lesson/{}/{}", entry.name, words.folder);
        data["url"] = json!(format!("{address}{path}"));
        // The packer puts the file's final name in the place of `{{asset:NAME}}`.
        data["image"] = json!(format!("{address}{{{{asset:{}}}}}", entry.preview_name()));
        data["isPartOf"]["url"] = json!(address);
    }
    data
}

/// Returns the steps of a lesson: texts, question, picture, and a link that begins there.
fn sections(entry: &Entry, words: &Words) -> String {
    let mut html = String::new();
    for (index, step) in entry.sheet(words).steps.iter().enumerate() {
        let title = plain_html(&step.title);
        // The first picture is in view at once; the others are loaded when they come into view.
        let loading = if index == 0 { "eager" } else { "lazy" };

        // The link names its step to screen readers: there is one in each step.
        let _ = writeln!(
            html,
            "<section>\n<div>\n<h2>{number}. {title}</h2>\n{texts}{question}\
             <p class=\"start\"><a href=\"{up}#lesson={lesson}&amp;step={name}{link}\">{begin}<span class=\"unseen\">: {title}</span></a></p>\n</div>\n\
             {picture}\n</section>",
            number = index + 1,
            texts = without_placeholders(&step.texts),
            question = without_placeholders(&step.question),
            up = words.up,
            lesson = entry.name,
            name = step.name,
            link = escape(words.link),
            begin = words.word("begin-here"),
            picture = entry.picture(
                index,
                words.up,
                &format!(
                    "alt=\"{title}: {}\" loading=\"{loading}\"",
                    words.word("picture")
                )
            ),
        );
    }
    html
}

/// Returns a snippet for each question of a lesson: a frame for pages of others. `address` is that of this site, empty
/// where it is not known.
fn snippets(entry: &Entry, words: &Words, address: &str) -> String {
    let sheet = entry.sheet(words);
    let site = if address.is_empty() {
        SOME_ADDRESS
    } else {
        address
    };
    // A step without a question has nothing to report.
    let asked = sheet.steps.iter().filter(|step| !step.question.is_empty());

    let mut html = String::new();
    for StepSheet { name, title, .. } in asked {
        // HTML to be pasted: it is escaped for the page that it is pasted into, and once more for this one. The origin
        // of that page, to which the frame reports answers, takes the place of `course.example`.
        let frame = format!(
            "<iframe src=\"{site}?embed=player&amp;origin=https://course.example#lesson={}&amp;step={name}{}\"\n  \
             title=\"Tilescope: {}\" width=\"100%\" height=\"640\" loading=\"lazy\" allow=\"fullscreen\"></iframe>",
            entry.name,
            escape(words.link),
            escape(title),
        );
        let _ = writeln!(
            html,
            "<h3>{}</h3>\n<pre tabindex=\"0\"><code data-snippet>{}</code></pre>",
            plain_html(title),
            plain_html(&frame)
        );
    }
    html
}

/// Returns the map of the site for search engines.
fn sitemap(entries: &[Entry], address: &str) -> String {
    let mut urls = format!("<url><loc>{address}</loc></url>\n");
    for entry in entries {
        for folder in [ENGLISH.folder, GERMAN.folder] {
            let _ = writeln!(
                urls,
                "<url><loc>{address}lesson/{}/{folder}</loc></url>",
                entry.name
            );
        }
    }
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<urlset xmlns=\"http://www.sitemaps.org/schemas/sitemap/0.9\">\n{urls}</urlset>\n"
    )
}

/// Returns a page with each mark `[[name]]` replaced by its value.
///
/// # Errors
///
/// A mark that is not closed, or has no value.
fn filled(page: &str, values: &[(&str, String)]) -> Result<String> {
    let mut pieces = page.split("[[");
    let mut filled = pieces.next().unwrap_or_default().to_owned();

    for piece in pieces {
        let (name, after) = piece.split_once("]]").context("a mark is not closed")?;
        let value = values.iter().find(|(known, _)| *known == name);
        let (_, value) = value.with_context(|| format!("[[{name}]] is not known"))?;
        filled.push_str(value);
        filled.push_str(after);
    }

    Ok(filled)
}

#[cfg(test)]
mod tests;
