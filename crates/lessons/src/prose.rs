//! The paragraphs of lessons: Markdown with emphasis, strong emphasis and code only, and expressions in braces. They are
//! parsed when they are shown and not before, so that a translation can replace them.

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};

/// How a part of a paragraph is set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Style {
    /// It is set as text.
    #[default]
    Plain,
    /// It is emphasised, in italics.
    Emphasis,
    /// It is strongly emphasised, in bold.
    Strong,
    /// It is set as code.
    Code,
}

/// A part of a paragraph in one style.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Span {
    /// The text without marks.
    pub text: String,
    /// The style of all of it.
    pub style: Style,
}

/// Returns the parts of a paragraph. Other marks, such as those of links, are left out; their text stays.
#[must_use]
pub fn spans(paragraph: &str) -> Vec<Span> {
    let mut spans: Vec<Span> = Vec::new();
    let mut styles = vec![Style::Plain];

    // A text in the style of the last part continues it.
    let mut put = |text: &str, style: Style| match spans.last_mut() {
        Some(last) if last.style == style => last.text.push_str(text),
        _ => spans.push(Span {
            text: text.to_owned(),
            style,
        }),
    };

    for event in Parser::new_ext(paragraph, Options::empty()) {
        let style = styles.last().copied().unwrap_or_default();

        match event {
            Event::Start(Tag::Emphasis) => styles.push(Style::Emphasis),
            Event::Start(Tag::Strong) => styles.push(Style::Strong),
            Event::End(TagEnd::Emphasis | TagEnd::Strong) => {
                styles.pop();
            }
            Event::Code(text) => put(&text, Style::Code),
            // Text between angle brackets is taken for HTML by the parser, and is shown as it stands.
            Event::Text(text) | Event::Html(text) | Event::InlineHtml(text) => put(&text, style),
            // The end of a line within a paragraph is a space.
            Event::SoftBreak | Event::HardBreak => put(" ", style),
            // Links, lists and headings leave their text as it is.
            _ => {}
        }
    }

    spans
}

/// Returns a paragraph without marks.
#[must_use]
pub fn plain(paragraph: &str) -> String {
    spans(paragraph).into_iter().map(|span| span.text).collect()
}

/// Returns the number of words of a paragraph.
#[must_use]
pub fn words(paragraph: &str) -> usize {
    plain(paragraph).split_whitespace().count()
}

/// Returns a text with every `{expression}` replaced; `{{` and `}}` stand for braces.
///
/// # Errors
///
/// What `value` returns, a brace that is not closed, and one that closes without having been opened.
pub fn filled(
    text: &str,
    mut value: impl FnMut(&str) -> Result<String, String>,
) -> Result<String, String> {
    let mut filled = String::with_capacity(text.len());
    let mut rest = text;

    while let Some(at) = rest.find(['{', '}']) {
        filled.push_str(&rest[..at]);
        // A brace is one byte.
        let (brace, after) = rest[at..].split_at(1);

        // A brace that is written twice stands for itself.
        if let Some(behind_both) = after.strip_prefix(brace) {
            filled.push_str(brace);
            rest = behind_both;
        } else if brace == "}" {
            return Err("a closing brace without an opening one; write }} for a brace".to_owned());
        } else {
            let end = closing(after).ok_or("an expression in braces is not closed")?;
            filled.push_str(&value(after[..end].trim())?);
            rest = &after[end + 1..];
        }
    }

    filled.push_str(rest);
    Ok(filled)
}

/// Returns where the expression at the start of a text ends; it may have braces of its own.
fn closing(text: &str) -> Option<usize> {
    let mut open = 1;
    let mut braces = text
        .char_indices()
        .filter(|(_, brace)| matches!(brace, '{' | '}'));
    let (end, _) = braces.find(|(_, brace)| {
        open += if *brace == '{' { 1 } else { -1 };
        open == 0
    })?;
    Some(end)
}

/// Returns the expressions in the braces of a text.
pub fn expressions(text: &str) -> Result<Vec<String>, String> {
    let mut found = Vec::new();
    filled(text, |expression| {
        found.push(expression.to_owned());
        Ok(String::new())
    })?;
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn emphasis_and_code_are_kept_and_nothing_else() {
        let text = spans("A **set** is *maximal* if `gap`s\nare <b>gone</b> [here](http://x.y).");
        let styles: Vec<_> = text
            .iter()
            .map(|span| (span.text.as_str(), span.style))
            .collect();
        assert_eq!(styles[1], ("set", Style::Strong));
        assert_eq!(styles[3], ("maximal", Style::Emphasis));
        assert_eq!(styles[5], ("gap", Style::Code));
        assert_eq!(plain("are <b>gone</b>\n[here](x)"), "are <b>gone</b> here");
        assert_eq!(words("one *two*\nthree"), 3);
    }

    #[test]
    fn expressions_are_replaced() {
        let value = |text: &str| Ok(format!("<{text}>"));
        assert_eq!(
            filled("a {x + 1} b {{c}}", value).unwrap(),
            "a <x + 1> b {c}"
        );
        assert_eq!(
            filled("{if x { 1 } else { 2 }}!", value).unwrap(),
            "<if x { 1 } else { 2 }>!"
        );
        assert!(filled("a {x", value).is_err() && filled("a } b", value).is_err());
        assert_eq!(expressions("{a} and {b}").unwrap(), ["a", "b"]);
    }
}
