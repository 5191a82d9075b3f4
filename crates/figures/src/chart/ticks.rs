//! Round places on an axis: multiples of 1, 2 or 5 times a power of ten, and their labels.

/// Round values of a range, all with one number of decimals.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ticks {
    /// Rising values within the range.
    pub(crate) values: Vec<f64>,
    decimals: usize,
}

impl Ticks {
    /// Returns at most `most` ticks of a rising range of finite numbers, or two where `most` is below that. Where the
    /// round distance that keeps to it leaves fewer than two ticks, the next smaller one is taken if it gives no more
    /// than `most`.
    pub(crate) fn of(range: [f64; 2], most: usize) -> Self {
        let least = (range[1] - range[0]) / (most.max(2) - 1) as f64;
        let ticks = Self::apart(range, least);
        if ticks.values.len() < 2 {
            // Below 1, 2 and 5 the next smaller round distance is 0.5, 0.5 and 0.4 of it, and the one after that less than 0.4.
            let finer = Self::apart(range, 0.4 * Step::of(least).length);
            if finer.values.len() <= most {
                return finer;
            }
        }
        ticks
    }

    /// Returns the ticks of the smallest round distance that is not below `least`.
    fn apart([low, high]: [f64; 2], least: f64) -> Self {
        let Step { length, decimals } = Step::of(least);
        // Multiples of a whole number keep their last digit, which a running sum would lose. A hair beyond
        // the ends belongs to the range: its ends are often round themselves.
        let hair = 1e-9;
        let first = (low / length - hair).ceil() as i64;
        let last = (high / length + hair).floor() as i64;
        Self {
            values: (first..=last).map(|i| i as f64 * length).collect(),
            decimals,
        }
    }

    /// Returns the label of a value, with a true minus sign.
    pub(crate) fn label(&self, value: f64) -> String {
        let text = format!("{value:.*}", self.decimals);
        let zero = text
            .trim_start_matches('-')
            .chars()
            .all(|c| "0.".contains(c));
        match text.strip_prefix('-') {
            Some(rest) if zero => rest.to_owned(),
            Some(rest) => format!("\u{2212}{rest}"),
            None => text,
        }
    }
}

/// A round distance between ticks.
struct Step {
    length: f64,
    /// How many decimals its multiples need.
    decimals: usize,
}

impl Step {
    /// Returns the smallest of 1, 2 and 5 times a power of ten that is not below `least`.
    fn of(least: f64) -> Self {
        let exponent = least.log10().floor() as i32;
        let times = |factor: f64, exponent: i32| {
            // A negative power is computed as the inverse of a whole number, and so is rounded only once.
            let power = if exponent < 0 {
                1.0 / 10f64.powi(-exponent)
            } else {
                10f64.powi(exponent)
            };
            Self {
                length: factor * power,
                decimals: (-exponent).max(0) as usize,
            }
        };

        let mut steps = [1.0, 2.0, 5.0]
            .map(|factor| times(factor, exponent))
            .into_iter();
        // A distance that rounding left a hair above a round value still takes that value.
        let found = steps.find(|step| step.length >= least * (1.0 - 1e-9));
        found.unwrap_or_else(|| times(1.0, exponent + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(range: [f64; 2], most: usize) -> Vec<String> {
        let ticks = Ticks::of(range, most);
        ticks.values.iter().map(|v| ticks.label(*v)).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(
            labels([0.0, 1.0], 6),
            ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        assert_eq!(
            labels([0.0, 2.5], 6),
            ["0.0", "0.5", "1.0", "1.5", "2.0", "2.5"]
        );
        assert_eq!(
            labels([-12.0, 7.0], 5),
            ["\u{2212}10", "\u{2212}5", "0", "5"]
        );
        assert_eq!(labels([0.0, 1e4], 3), ["0", "5000", "10000"]);
        assert_eq!(
            labels([0.013, 0.021], 5),
            ["0.014", "0.016", "0.018", "0.020"]
        );
    }

    /// A single tick tells no scale: zero alone would be within 0.32 of it on either side.
    #[test]
    fn there_are_two_ticks_where_there_is_room() {
        assert_eq!(labels([-0.32, 0.32], 4), ["\u{2212}0.2", "0.0", "0.2"]);
        assert_eq!(labels([-0.6, 0.6], 4), ["\u{2212}0.5", "0.0", "0.5"]);
    }

    #[test]
    fn ticks_lie_in_the_range_and_are_few() {
        for low in [-3.7, 0.0, 0.1, 99.0] {
            for length in [1e-3, 0.3, 1.0, 7.7, 1e6] {
                for most in 2..9 {
                    let found = Ticks::of([low, low + length], most).values;
                    assert!(found.len() <= most, "{low} {length} {most}: {found:?}");
                    let hair = 1e-6 * length;
                    let inside = |v: &f64| (low - hair..=low + length + hair).contains(v);
                    assert!(found.iter().all(inside), "{found:?}");
                }
            }
        }
    }

    #[test]
    fn zero_has_no_sign() {
        assert_eq!(Ticks::of([-1.0, 1.0], 3).label(-0.0), "0");
    }
}
