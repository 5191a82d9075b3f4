//! Short, unique labels of files, and the pattern that several names share.

/// The most characters of a short name. Chosen, not measured.
const MAX_LENGTH: usize = 40;

/// Returns the names, with a number after those that occurred before.
pub fn numbered(names: &[String]) -> Vec<String> {
    let numbered = |(index, name): (usize, &String)| {
        let before = (names[..index].iter())
            .filter(|other| *other == name)
            .count();
        if before == 0 {
            return name.clone();
        }
        // Let n be the number of all names. The second of several equal names tries 2, 2 + n, 2 + 2n and so on. The
        // third tries 3, 3 + n and so on. No two of them thus try the same number. A number that gives the name of
        // another file is skipped.
        let numbers = (before + 1..).step_by(names.len());
        let mut all = numbers.map(|number| format!("{name} ({number})"));
        // The numbers have no end, so that a free one is always found.
        all.find(|name| !names.contains(name)).unwrap_or_default()
    };
    names.iter().enumerate().map(numbered).collect()
}

/// Returns the fewest last path components that make each name unique, cut to 40 characters.
pub fn short(names: &[String]) -> Vec<String> {
    let tail = |name: &String, count: usize| -> String {
        let parts: Vec<&str> = name.split(['/', '\\']).collect();
        parts[parts.len().saturating_sub(count)..].join("/")
    };
    let label = |name: &String| {
        let most = name.split(['/', '\\']).count();
        // Equal names stay equal with any number of components; they get numbers later.
        let is_alone = |count: &usize| {
            let own = tail(name, *count);
            (names.iter()).all(|other| other == name || tail(other, *count) != own)
        };
        let count = (1..most).find(is_alone).unwrap_or(most);
        cut(&tail(name, count), MAX_LENGTH)
    };
    names.iter().map(label).collect()
}

/// Returns the common beginning and end of the file names of `names`, with an asterisk between them.
pub fn pattern(names: &[&str]) -> String {
    let file = |name: &&str| -> Vec<char> {
        let file = name.rsplit(['/', '\\']).next();
        // Every text has a last part.
        file.unwrap_or_default().chars().collect()
    };
    let mut files: Vec<Vec<char>> = names.iter().map(file).collect();
    // The shortest name bounds the common beginning as well as the common end.
    files.sort_by_key(Vec::len);
    let Some((shortest, others)) = files.split_first() else {
        return String::new();
    };
    // Equal names have nothing between beginning and end for which an asterisk could stand.
    if others.iter().all(|file| file == shortest) {
        return shortest.iter().collect();
    }

    let begins_alike = |at: &usize| others.iter().all(|file| file[*at] == shortest[*at]);
    let head = (0..shortest.len()).take_while(begins_alike).count();
    let at_end = |file: &[char], back: usize| file[file.len() - 1 - back];
    let ends_alike =
        |&back: &usize| (others.iter()).all(|file| at_end(file, back) == at_end(shortest, back));
    // In the shortest name the two must not overlap.
    let tail = (0..shortest.len() - head).take_while(ends_alike).count();
    let end = &shortest[shortest.len() - tail..];
    shortest[..head].iter().chain(&['*']).chain(end).collect()
}

/// Returns a name in at most `most` characters: its beginning, an ellipsis, its end.
pub fn cut(name: &str, most: usize) -> String {
    let characters: Vec<char> = name.chars().collect();
    if characters.len() <= most {
        return name.to_owned();
    }
    // Names of files may differ at either end. The ellipsis is one character.
    let (head, tail) = (most / 2, most - most / 2 - 1);
    let end = &characters[characters.len() - tail..];
    (characters[..head].iter().chain(&['\u{2026}']).chain(end)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(names: &[&str]) -> Vec<String> {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        numbered(&short(&names))
    }

    #[test]
    fn names_are_as_short_as_tells_them_apart() {
        assert_eq!(of(&["runs/a/x.csv", "runs/b/y.csv"]), ["x.csv", "y.csv"]);
        assert_eq!(
            of(&["runs/a/x.csv", "runs/b/x.csv"]),
            ["a/x.csv", "b/x.csv"]
        );
        assert_eq!(of(&["x.csv", "b/x.csv"]), ["x.csv", "b/x.csv"]);
    }

    #[test]
    fn patterns_keep_what_all_names_have() {
        assert_eq!(pattern(&["a/s1.npy", "b/s2.npy", "s10.npy"]), "s*.npy");
        assert_eq!(pattern(&["x.csv", "y.npy"]), "*");
        assert_eq!(pattern(&["aa.csv", "aaa.csv"]), "aa*.csv");
        assert_eq!(pattern(&["a/x.csv", "b/x.csv"]), "x.csv");
        assert_eq!(pattern(&["x.csv"]), "x.csv");
    }

    #[test]
    fn equal_names_are_numbered() {
        assert_eq!(of(&["x.csv", "x.csv"]), ["x.csv", "x.csv (2)"]);
        let like_a_number = of(&["x.csv", "x.csv", "x.csv (2)"]);
        assert_eq!(like_a_number, ["x.csv", "x.csv (5)", "x.csv (2)"]);
    }

    #[test]
    fn long_names_keep_beginning_and_end_and_stay_different() {
        let long = |middle: &str| format!("{}{middle}{}.csv", "a".repeat(60), "b".repeat(60));
        let names = [long("1"), long("2")];
        let found = numbered(&short(&names));
        assert!(found[0].starts_with("aaaa"));
        assert_eq!(found[0].split_once('.').map(|parts| parts.1), Some("csv"));
        assert_eq!(found[0].chars().count(), 40);
        assert_eq!(found[1], format!("{} (2)", found[0]));
    }
}
