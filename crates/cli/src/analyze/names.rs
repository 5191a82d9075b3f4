//! Names of files that can be told from each other, short where people read them.

use std::collections::HashMap;

/// Letters of a short name at most.
const MAX_LENGTH: usize = 40;

/// Returns the names, with a number behind those that were there before.
pub fn numbered(names: &[String]) -> Vec<String> {
    let mut seen: HashMap<&str, usize> = HashMap::new();
    let taken = |name: &String| names.contains(name);
    names
        .iter()
        .map(|name| {
            let count = seen.entry(name).or_default();
            *count += 1;
            if *count == 1 {
                return name.clone();
            }
            // A file may be called like the numbered name of another.
            let mut number = *count;
            while taken(&format!("{name} ({number})")) {
                number += names.len();
            }
            format!("{name} ({number})")
        })
        .collect()
}

/// Returns, for each name, as many of its last parts as tell it from all others, in at most 40 letters; no two are the same.
pub fn short(names: &[String]) -> Vec<String> {
    let parts: Vec<Vec<&str>> = names
        .iter()
        .map(|name| name.rsplit(['/', '\\']).collect())
        .collect();
    let tail = |index: usize, count: usize| -> String {
        let parts = &parts[index];
        let mut kept = parts[..count.min(parts.len())].to_vec();
        kept.reverse();
        kept.join("/")
    };
    let label = |index: usize| {
        let most = parts[index].len();
        let alone = (1..most).find(|&count| {
            let own = tail(index, count);
            (0..names.len()).all(|other| names[other] == names[index] || tail(other, count) != own)
        });
        cut(&tail(index, alone.unwrap_or(most)), MAX_LENGTH)
    };
    (0..names.len()).map(label).collect()
}

/// Returns what the file names of `names` have in common, with an asterisk for the rest.
pub fn pattern(names: &[&str]) -> String {
    let files: Vec<Vec<char>> = names
        .iter()
        .map(|name| name.rsplit(['/', '\\']).next().unwrap_or(name))
        .map(|name| name.chars().collect())
        .collect();
    let Some((first, rest)) = files.split_first() else {
        return String::new();
    };
    let same = |letters: &dyn Fn(&[char]) -> Vec<char>, file: &[char]| {
        let pairs = letters(first).into_iter().zip(letters(file));
        pairs.take_while(|(a, b)| a == b).count()
    };
    let shortest = files.iter().map(Vec::len).min().unwrap_or(0);
    let common = |letters: &dyn Fn(&[char]) -> Vec<char>| {
        let counts = rest.iter().map(|file| same(letters, file));
        counts.min().unwrap_or(first.len())
    };
    let head = common(&<[char]>::to_vec);
    if head == first.len() && head == shortest {
        return first.iter().collect();
    }
    let backwards = |file: &[char]| file.iter().rev().copied().collect();
    let tail = common(&backwards).min(shortest - head.min(shortest));
    let end = &first[first.len() - tail..];
    first[..head].iter().chain(&['*']).chain(end).collect()
}

/// Returns a name in at most `most` letters: its beginning, an ellipsis, its end.
pub fn cut(name: &str, most: usize) -> String {
    let letters: Vec<char> = name.chars().collect();
    if letters.len() <= most {
        return name.to_owned();
    }
    let (head, tail) = (most / 2, most - most / 2 - 1);
    let end = letters.len() - tail;
    letters[..head]
        .iter()
        .chain(&['\u{2026}'])
        .chain(&letters[end..])
        .collect()
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
