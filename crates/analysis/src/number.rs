//! Numbers in messages.

use std::fmt;

/// Displays a number, with an exponent where it would otherwise have very many digits.
///
/// ```
/// use tilescope_analysis::Number;
/// assert_eq!(Number(0.025).to_string(), "0.025");
/// assert_eq!(Number(1e300).to_string(), "1e300");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Number(pub f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        // Beyond these limits plain digits would be zeros for the most part, or more digits than the number has.
        if (1e-5..1e16).contains(&size) || size == 0.0 {
            write!(f, "{}", self.0)
        } else {
            write!(f, "{:e}", self.0)
        }
    }
}
