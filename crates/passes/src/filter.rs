//! Filters of a table's rows: conditions on columns, and on whether a row changed.

use thiserror::Error;

/// The pseudo-column of row numbers.
const ROW: &str = "row";

/// Why a filter cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum FilterError {
    /// There is nothing between two commas.
    #[error("a condition is empty; conditions are separated by one comma each")]
    Empty,
    /// A condition is not a comparison.
    #[error(
        "{0:?} is not a condition; write column>number, with >, >=, <, <=, = or !=, or changed"
    )]
    NoComparison(String),
    /// No column has the name.
    #[error("no column is called {name:?}; there are: {}", columns.join(", "))]
    NoSuchColumn {
        /// The name that no column has.
        name: String,
        /// The names of the columns.
        columns: Vec<String>,
    },
    /// The other side is not a whole number of 64 bits.
    #[error("{0:?} is not a whole number between {least} and {most}", least = i64::MIN, most = i64::MAX)]
    NotANumber(String),
}

/// How a value is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Operator {
    Above,
    AtLeast,
    Below,
    AtMost,
    Equal,
    Unequal,
}

/// Longer operators first, since they begin like shorter ones.
const COMPARISONS: [(&str, Operator); 7] = [
    (">=", Operator::AtLeast),
    ("<=", Operator::AtMost),
    ("!=", Operator::Unequal),
    ("==", Operator::Equal),
    (">", Operator::Above),
    ("<", Operator::Below),
    ("=", Operator::Equal),
];

impl Operator {
    const fn holds(self, value: i64, number: i64) -> bool {
        match self {
            Self::Above => value > number,
            Self::AtLeast => value >= number,
            Self::Below => value < number,
            Self::AtMost => value <= number,
            Self::Equal => value == number,
            Self::Unequal => value != number,
        }
    }
}

/// A condition on a row: that it changed, or how its number or the value of a column, by its index, compares with a
/// number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Condition {
    Changed,
    Row(Operator, i64),
    Column(usize, Operator, i64),
}

/// Conditions that must all hold.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Filter {
    conditions: Vec<Condition>,
}

impl Filter {
    /// Reads a filter for a table with `columns`: conditions such as `x>5`, `iteration 1 != -1`, `row<100` or
    /// `changed`, separated by commas. Every row satisfies an empty text.
    ///
    /// Fails with the first condition that cannot be read.
    pub fn parse(text: &str, columns: &[String]) -> Result<Self, FilterError> {
        let mut conditions = Vec::new();
        if !text.trim().is_empty() {
            for part in text.split(',') {
                conditions.push(condition(part.trim(), columns)?);
            }
        }
        Ok(Self { conditions })
    }

    /// Returns whether it has no condition.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.conditions.is_empty()
    }

    /// Returns whether a row satisfies it: its number, its values and whether it changed.
    #[must_use]
    pub fn accepts(&self, row: usize, values: &[i64], changed: bool) -> bool {
        self.conditions.iter().all(|condition| match *condition {
            Condition::Changed => changed,
            Condition::Row(comparison, number) => comparison.holds(row as i64, number),
            Condition::Column(column, comparison, number) => {
                comparison.holds(values[column], number)
            }
        })
    }
}

/// Reads one condition, which has no spaces around it.
fn condition(text: &str, columns: &[String]) -> Result<Condition, FilterError> {
    if text.is_empty() {
        return Err(FilterError::Empty);
    }
    if text.eq_ignore_ascii_case("changed") {
        return Ok(Condition::Changed);
    }

    let no_comparison = || FilterError::NoComparison(text.to_owned());
    // The operator is at the beginning of the rest: the column's name stands before it.
    let sign_at = text.find(['<', '>', '=', '!']).ok_or_else(no_comparison)?;
    let (name, rest) = (text[..sign_at].trim(), &text[sign_at..]);
    let (sign, operator) = COMPARISONS
        .into_iter()
        .find(|(sign, _)| rest.starts_with(sign))
        .ok_or_else(no_comparison)?;

    let digits = rest[sign.len()..].trim();
    let not_a_number = |_| FilterError::NotANumber(digits.to_owned());
    let number = digits.parse().map_err(not_a_number)?;

    // If a column has the name of the pseudo-column, the name stands for the column, which has no other name.
    if let Some(column) = columns.iter().position(|c| c.eq_ignore_ascii_case(name)) {
        return Ok(Condition::Column(column, operator, number));
    }
    if name.eq_ignore_ascii_case(ROW) {
        return Ok(Condition::Row(operator, number));
    }

    Err(FilterError::NoSuchColumn {
        name: name.to_owned(),
        columns: columns.to_vec(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns() -> Vec<String> {
        ["x", "iteration 1"].map(str::to_owned).to_vec()
    }

    fn passing(text: &str) -> Vec<usize> {
        let filter = Filter::parse(text, &columns()).unwrap();
        let rows = [([3, -1], false), ([5, 2], true), ([9, -1], true)];
        let pass = |(row, (values, changed)): (usize, &([i64; 2], bool))| {
            filter.accepts(row, values, *changed).then_some(row)
        };
        rows.iter().enumerate().filter_map(pass).collect()
    }

    #[test]
    fn conditions_choose_rows() {
        assert_eq!(passing(""), [0, 1, 2]);
        assert_eq!(passing("x>3"), [1, 2]);
        assert_eq!(passing("X >= 3"), [0, 1, 2]);
        assert_eq!(passing("x<5"), [0]);
        assert_eq!(passing("x<=5, changed"), [1]);
        assert_eq!(passing("iteration 1 = -1"), [0, 2]);
        assert_eq!(passing("iteration 1 == 2"), [1]);
        assert_eq!(passing("iteration 1 != -1"), [1]);
        assert_eq!(passing("row>0,row<2"), [1]);
        assert_eq!(passing("changed,x>100"), [0_usize; 0]);
    }

    #[test]
    fn errors_name_the_condition() {
        let error = |text| Filter::parse(text, &columns()).unwrap_err();
        assert_eq!(error("x>1,,changed"), FilterError::Empty);
        let unknown = error("z>1").to_string();
        assert!(unknown.contains("\"z\"") && unknown.contains("iteration 1"));
        assert!(matches!(error("x"), FilterError::NoComparison { .. }));
        assert!(matches!(error("x!1"), FilterError::NoComparison { .. }));
        for text in ["x>", "x>1.5", "x=>1", "x>99999999999999999999"] {
            assert!(
                matches!(error(text), FilterError::NotANumber { .. }),
                "{text}"
            );
        }
    }
}
