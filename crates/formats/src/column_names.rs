//! Which columns of a table are x, y and z, by the names of its header or by the caller's choice.

use crate::error::quote;
use crate::fields::{Separator, unquoted};
use crate::text::words;

/// What a caller can do about a header whose names are of no use.
const CHOOSE: &str =
    "name two of them x and y, or choose two by name or number (--columns A B of the command line)";

/// Words of a header that say nothing about which coordinate a column holds: units and general words.
const GENERAL: [&str; 24] = [
    "coord",
    "coords",
    "coordinate",
    "coordinates",
    "pos",
    "position",
    "point",
    "points",
    "pt",
    "loc",
    "location",
    "axis",
    "m",
    "cm",
    "mm",
    "um",
    "nm",
    "km",
    "ft",
    "px",
    "pixel",
    "pixels",
    "meter",
    "metre",
];

/// The columns of x and y, and of z if there is one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NamedColumns {
    pub places: [usize; 2],
    pub z: Option<usize>,
}

/// The columns that a header names: `x` and `y`, or names near them such as `X_coord` or `x [m]`. The error is a reason.
pub(crate) fn named(names: &[String]) -> Result<NamedColumns, String> {
    let (x, y) = (find(names, "x")?, find(names, "y")?);
    if let (Some(x), Some(y)) = (x, y) {
        return Ok(NamedColumns {
            places: [x, y],
            z: find(names, "z")?,
        });
    }

    // Longitude and latitude have names of their own, for which the message can say what to do.
    if let Some([longitude, latitude]) = degrees(names) {
        return Err(format!(
            "\"{longitude}\" and \"{latitude}\" are degrees on a sphere, and only planar sets are read: project them, \
             to UTM for example, and name the columns x and y"
        ));
    }

    let missing = if x.is_none() { "x" } else { "y" };
    Err(format!(
        "no column is named {missing}; the columns are {}: {CHOOSE}",
        list(names)
    ))
}

/// Refuses names without x, y and z, the columns of points in space. The error is a reason.
pub(crate) fn check_in_space(names: &[String]) -> Result<(), String> {
    for axis in ["x", "y", "z"] {
        // Longitude and latitude are no places in a box either, and are reported where the columns are read.
        if find(names, axis)?.is_none() && degrees(names).is_none() {
            return Err(format!(
                "no column is named {axis}, and a set in space has x, y and z; the columns are {}",
                list(names)
            ));
        }
    }
    Ok(())
}

/// Whether a remark such as `# x y` is a header: it names coordinates, planar or not.
pub(crate) fn is_header(names: &[String]) -> bool {
    named(names).is_ok() || degrees(names).is_some()
}

/// The names in a remark, if it is a header: `# x y`, `//X Y Z`.
pub(crate) fn in_remark(line: &[u8]) -> Option<Vec<String>> {
    let is_mark = |b: &u8| b.is_ascii_whitespace() || b"#%/".contains(b);
    let begin = line.iter().position(|b| !is_mark(b))?;
    let line = &line[begin..];
    let names = match Separator::of(line) {
        Separator::Blank => words(line).map(name).collect(),
        separator => line
            .split(|&b| b == separator.byte())
            .map(name)
            .collect::<Vec<_>>(),
    };
    Some(names).filter(|names| is_header(names))
}

/// The name in a field of a header.
pub(crate) fn name(field: &[u8]) -> String {
    quote(unquoted(field))
}

/// The columns that the caller chose, each by its name, or by its number from 1 if no column has that name. `count` is the
/// number of columns. The error is a reason.
pub(crate) fn chosen(
    choice: &[String; 2],
    names: &[String],
    count: usize,
) -> Result<[usize; 2], String> {
    let places = [
        one(&choice[0], names, count)?,
        one(&choice[1], names, count)?,
    ];
    if places[0] == places[1] {
        return Err(format!(
            "\"{}\" and \"{}\" are the same column; choose two",
            choice[0], choice[1]
        ));
    }
    Ok(places)
}

/// The column that the caller chose by its name, or by its number from 1 if no column has that name. `count` is the
/// number of columns. The error is a reason: no column is meant, or several may be.
pub(crate) fn one(wanted: &str, names: &[String], count: usize) -> Result<usize, String> {
    // Names that differ in case alone, such as `Lon` and `LON`, are chosen by their exact spelling. Any other spelling,
    // such as `lon`, could mean each of them, and is refused.
    let with_name = match only(names, wanted, |name| name == wanted)? {
        None => only(names, wanted, |name| name.eq_ignore_ascii_case(wanted))?,
        exact => exact,
    };
    let number = || wanted.parse::<usize>().ok()?.checked_sub(1);
    // A column may be called `2`: names are looked for before numbers.
    let column = with_name.or_else(number);
    column.filter(|&column| column < count).ok_or_else(|| {
        let by_name = match names {
            [] => String::new(),
            names => format!("{}, or by number ", list(names)),
        };
        format!("there is no column \"{wanted}\"; the columns are {by_name}1 to {count}")
    })
}

/// The column of an axis: the one of its name, else the only one with a name near it.
fn find(names: &[String], axis: &str) -> Result<Option<usize>, String> {
    let exact = only(names, axis, |name| name.eq_ignore_ascii_case(axis))?;
    if exact.is_some() {
        return Ok(exact);
    }
    only(names, axis, |name| is_near(name, axis))
}

/// The only column whose name is as wanted; `None` if none is. Several are an error.
fn only(
    names: &[String],
    wanted: &str,
    is_wanted: impl Fn(&str) -> bool,
) -> Result<Option<usize>, String> {
    let mut found = names.iter().enumerate().filter(|(_, name)| is_wanted(name));
    match (found.next(), found.next()) {
        (Some((_, first)), Some((_, second))) => Err(format!(
            "both \"{first}\" and \"{second}\" may be {wanted}: {CHOOSE}"
        )),
        (first, _) => Ok(first.map(|(column, _)| column)),
    }
}

/// Whether `name` is `axis` with units or general words.
fn is_near(name: &str, axis: &str) -> bool {
    let joined = |word: &str| {
        let rest = word.strip_prefix(axis).or_else(|| word.strip_suffix(axis));
        // Shorter general words, such as m, would make an axis of words such as "my".
        rest.is_some_and(|rest| rest.is_empty() || (rest.len() > 2 && GENERAL.contains(&rest)))
    };
    matches!(&specific_words(name)[..], [word] if joined(word))
}

/// The names of longitude and latitude; `None` unless a header has both.
fn degrees(names: &[String]) -> Option<[&String; 2]> {
    let find = |known: &[&str]| {
        let is_known = |word: &String| known.contains(&word.as_str());
        (names.iter()).find(|name| specific_words(name).iter().any(is_known))
    };
    let longitude = find(&["lon", "lng", "long", "longitude"])?;
    Some([longitude, find(&["lat", "latitude"])?])
}

/// The words of a name in lower case, without units in brackets and without general words. A bracket that is not closed
/// makes all behind it a unit.
fn specific_words(name: &str) -> Vec<String> {
    let mut depth = 0_u32;
    let without_units = name.chars().map(|letter| {
        // A closing bracket is part of the unit that it ends. If no bracket is open, it is part of the name.
        let opens = matches!(letter, '[' | '(' | '{');
        let closes = matches!(letter, ']' | ')' | '}');
        depth += u32::from(opens);
        let inside = depth > 0;
        depth -= u32::from(closes && inside);
        if inside { ' ' } else { letter }
    });

    let lower: String = without_units.flat_map(char::to_lowercase).collect();
    let words = lower.split(|c: char| !c.is_alphanumeric());
    let is_specific = |word: &&str| !word.is_empty() && !GENERAL.contains(word);
    words.filter(is_specific).map(str::to_owned).collect()
}

/// The names in quotation marks, cut to a bounded number.
fn list(names: &[String]) -> String {
    // Chosen, not measured.
    const MOST: usize = 12;
    let quoted = names.iter().take(MOST).map(|name| format!("\"{name}\""));
    let mut listed = quoted.collect::<Vec<_>>().join(", ");
    if names.len() > MOST {
        listed.push_str(", ...");
    }
    listed
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(names: &str) -> Vec<String> {
        names.split(',').map(str::to_owned).collect()
    }

    fn places(names: &str) -> Result<[usize; 2], String> {
        named(&header(names)).map(|columns| columns.places)
    }

    #[test]
    fn near_names_are_used() {
        for names in [
            "x,y",
            "X,Y",
            "X_coord,Y_coord",
            "x [m],y [m]",
            "X (mm),Y (mm)",
            "x_m,y_m",
            "POINT_X,POINT_Y",
            "xcoord,ycoord",
            "Position X,Position Y",
            "coordX,coordY",
            "x [km/s],y",
        ] {
            assert_eq!(places(names), Ok([0, 1]), "{names}");
        }
        assert_eq!(places("id,Y,X"), Ok([2, 1]));
        // The exact name is used although there is a near one.
        assert_eq!(places("x_m,x,y"), Ok([1, 2]));
        assert_eq!(
            named(&header("X,Y,Z [m]")).map(|found| found.z),
            Ok(Some(2))
        );
    }

    #[test]
    fn other_names_are_refused_with_what_was_found() {
        for names in [
            "max,may",
            "xy,yx",
            "box,boy",
            "x2,y2",
            "xm,ym",
            "vx,vy",
            "x speed,y speed",
        ] {
            let reason = places(names).expect_err(names);
            assert!(
                reason.starts_with("no column is named x; the columns are \""),
                "{reason}"
            );
        }
        assert!(
            places("x,z")
                .expect_err("no y")
                .starts_with("no column is named y")
        );
        let reason = places("x_m,x_px,y").expect_err("two near names");
        assert!(
            reason.starts_with("both \"x_m\" and \"x_px\" may be x"),
            "{reason}"
        );
        assert!(places("x,y,x").is_err());
    }

    #[test]
    fn degrees_are_refused_by_name() {
        for names in [
            "lon,lat",
            "Latitude,Longitude",
            "id,lng [deg],lat [deg]",
            "GPS lat,GPS long",
        ] {
            let reason = places(names).expect_err(names);
            assert!(reason.contains("project them"), "{reason}");
            assert!(is_header(&header(names)));
        }
        assert_eq!(places("lon,lat,x,y"), Ok([2, 3]));
        assert!(!is_header(&header("made,by,hand")));
    }

    #[test]
    fn columns_are_chosen_by_name_or_number() {
        let names = header("id,Lon,lat,2");
        let choose = |a: &str, b: &str| chosen(&[a.to_owned(), b.to_owned()], &names, 4);
        assert_eq!(choose("lon", "lat"), Ok([1, 2]));
        assert_eq!(choose("1", "3"), Ok([0, 2]));
        // A name comes before a number.
        assert_eq!(choose("2", "1"), Ok([3, 0]));
        for (a, b) in [("0", "1"), ("5", "1"), ("x", "lat")] {
            let reason = choose(a, b).expect_err(a);
            assert_eq!(
                reason,
                format!(
                    "there is no column \"{a}\"; the columns are \"id\", \"Lon\", \"lat\", \"2\", or by number 1 to 4"
                )
            );
        }
        assert!(
            choose("lat", "3")
                .expect_err("one column")
                .contains("the same column")
        );

        let names = header("x,X,Y");
        let choose = |a: &str| chosen(&[a.to_owned(), "y".to_owned()], &names, 3);
        assert_eq!(choose("x"), Ok([0, 2]));
        assert_eq!(choose("X"), Ok([1, 2]));
        let names = header("xs,Xs,y");
        let reason = chosen(&["XS".to_owned(), "y".to_owned()], &names, 3).expect_err("either");
        assert!(
            reason.contains("both \"xs\" and \"Xs\" may be XS"),
            "{reason}"
        );
    }
}
