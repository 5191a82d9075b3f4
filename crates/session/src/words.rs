//! Formats numbers, counts and sentences as the window shows them.

use tilescope_analysis::Report;
use tilescope_core::Stage;
pub use tilescope_debugger::significant;

/// Returns `text` with a capital letter and a full stop. The name of a file at its beginning is left unchanged.
#[must_use]
pub fn sentence(text: &str) -> String {
    let word = text.split([' ', ':', ',']).next().unwrap_or_default();
    // Such a word is the name of a file or of a parameter. A point at its end only ends the sentence.
    if word.contains(['.', '/', '\\', '_']) && !word.ends_with('.') {
        return ended(text);
    }
    ended(&capital(text))
}

/// Returns `text` with a capital letter; an empty text stays empty.
#[must_use]
pub fn capital(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().map(|c| c.to_uppercase().to_string());
    first.unwrap_or_default() + characters.as_str()
}

/// Returns `text` with a full stop, and without the numbers that operating systems give to errors. For text that begins
/// with a name, which keeps its case.
#[must_use]
pub fn ended(text: &str) -> String {
    let text = without_numbers(text);
    let stop = if text.ends_with(['.', '!', '?']) {
        ""
    } else {
        "."
    };
    format!("{text}{stop}")
}

/// Returns a text without " (os error 2)" and the like, which say no more than the words before them.
fn without_numbers(text: &str) -> String {
    let mut parts = text.split(" (os error ");
    // Even an empty text has a first part.
    let mut kept = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        // The bracket that closes may be missing, as in a message that was cut off.
        let (number, rest) = part.split_once(')').unwrap_or((part, ""));
        let is_number = !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
        if is_number {
            kept.push_str(rest);
        } else {
            kept.push_str(" (os error ");
            kept.push_str(part);
        }
    }
    kept
}

/// Returns `count` with a comma between groups of three digits.
#[must_use]
pub fn grouped(count: usize) -> String {
    tilescope_debugger::grouped(count as u64)
}

/// Returns the number of an event as shown. Events count from 1, so the last event's number is how many have happened.
#[must_use]
pub fn event_number(index: usize) -> String {
    grouped(index + 1)
}

/// Returns "1 sample" or "2 samples".
#[must_use]
pub fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{} {}", grouped(count), if count == 1 { one } else { many })
}

/// Returns how many conflicts a report counts, in words.
#[must_use]
pub fn conflicts_in(report: &Report) -> String {
    let more = if report.more_conflicts() {
        " or more"
    } else {
        ""
    };
    let noun = if report.conflicts == 1 {
        "conflict"
    } else {
        "conflicts"
    };
    format!("{}{more} {noun}", grouped(report.conflicts as usize))
}

/// Returns the name of a stage with a capital letter.
#[must_use]
pub fn stage_name(stage: Stage) -> String {
    match stage {
        Stage::Pattern => "Pattern".to_owned(),
        Stage::Blocks => "Blocks".to_owned(),
        Stage::Tile => "Tile".to_owned(),
        Stage::Eliminate => "Eliminate".to_owned(),
        Stage::Iterate(k) => format!("Iterate {k}"),
        Stage::Regions => "Regions".to_owned(),
        Stage::Finish => "Finish".to_owned(),
    }
}

/// Returns a part of a whole in percent.
#[must_use]
pub fn share(part: usize, whole: usize) -> String {
    format!("{:.1}%", 100.0 * part as f64 / whole.max(1) as f64)
}

/// Returns the last part of a path, whatever system it is of.
#[must_use]
pub fn last_part(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

/// The most characters of a text from outside that are shown. Chosen, not measured.
const MAX_QUOTED: usize = 40;

/// Returns a text from outside, shortened and on one line, so that it can be shown.
#[must_use]
pub fn quoted(text: &str) -> String {
    let plain = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let mut shown: String = text.chars().take(MAX_QUOTED).map(plain).collect();
    if text.chars().nth(MAX_QUOTED).is_some() {
        shown.push('\u{2026}');
    }
    shown
}

/// Returns a name of the window as written in links: in lower case, with hyphens.
#[must_use]
pub fn slug(name: &str) -> String {
    name.to_lowercase().replace(' ', "-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_the_system_have_no_numbers() {
        let text = "no/such.csv: No such file or directory (os error 2)";
        assert_eq!(ended(text), "no/such.csv: No such file or directory.");
        let text = "a.csv: Permission denied (os error 13); it stays as it was";
        assert_eq!(ended(text), "a.csv: Permission denied; it stays as it was.");
        assert_eq!(ended("two (os error s)"), "two (os error s).");
    }

    #[test]
    fn texts_from_outside_are_shortened_and_on_one_line() {
        assert_eq!(quoted("a\nb"), "a\u{fffd}b");
        assert_eq!(quoted(&"x".repeat(99)).chars().count(), MAX_QUOTED + 1);
    }

    #[test]
    fn numbers_are_grouped_and_counted() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(1000), "1,000");
        assert_eq!(grouped(12_345_678), "12,345,678");
        assert_eq!(counted(1, "gap", "gaps"), "1 gap");
        assert_eq!(counted(0, "gap", "gaps"), "0 gaps");
    }

    #[test]
    fn sentences_leave_names_of_files_as_they_are() {
        assert_eq!(sentence("the radius is 0"), "The radius is 0.");
        assert_eq!(sentence("no!"), "No!");
        assert_eq!(sentence(""), ".");
        assert_eq!(sentence("set.csv: no points"), "set.csv: no points.");
        assert_eq!(sentence("sets/a has 2 bytes"), "sets/a has 2 bytes.");
        assert_eq!(ended("my set.csv is empty"), "my set.csv is empty.");
    }
}
