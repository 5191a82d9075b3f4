//! Expressions of x and y, such as `0.006 + 0.024*x`.
//!
//! They are computed in `f64` by operations that IEEE 754 rounds correctly and by functions of the crate `libm`, which are
//! made of such operations: so the same expression has the same values, to the bit, on every machine.

use serde::{Deserialize, Serialize};

use super::error::VaryingError;

/// The longest text of an expression: a longer one is refused before it is parsed. Chosen, not measured.
pub const MAX_EXPRESSION: usize = 4096;

/// How deep parentheses and functions may be nested: the parser calls itself for each.
const MAX_DEPTH: usize = 64;

/// A function of x and y.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Expression {
    text: String,
    /// The operations in the order in which they are carried out on a stack.
    steps: Vec<Step>,
}

/// Expressions are equal if their texts are, by which they are kept.
impl PartialEq for Expression {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

#[derive(Clone, Copy, Debug)]
enum Step {
    Number(f64),
    X,
    Y,
    One(OfOne),
    Two(OfTwo),
}

/// A function of one number.
type OfOne = fn(f64) -> f64;

/// A function of two numbers.
type OfTwo = fn(f64, f64) -> f64;

/// The functions of one number.
const ONE: [(&str, OfOne); 8] = [
    ("abs", f64::abs),
    ("cos", libm::cos),
    ("exp", libm::exp),
    ("floor", f64::floor),
    ("log", libm::log),
    ("sin", libm::sin),
    ("sqrt", f64::sqrt),
    ("tanh", libm::tanh),
];

/// The functions of two numbers.
const TWO: [(&str, OfTwo); 5] = [
    ("atan2", libm::atan2),
    ("hypot", |x, y| (x * x + y * y).sqrt()),
    ("max", |x, y| if x < y { y } else { x }),
    ("min", |x, y| if y < x { y } else { x }),
    ("pow", libm::pow),
];

impl Expression {
    /// Reads an expression: numbers, `x`, `y`, `pi`, `+ - * / ^`, parentheses, and the functions `abs`, `atan2`, `cos`, `exp`,
    /// `floor`, `hypot`, `log` (natural), `max`, `min`, `pow`, `sin`, `sqrt` and `tanh`.
    ///
    /// # Errors
    ///
    /// [`VaryingError::Expression`] with the place of the first fault.
    pub fn parse(text: &str) -> Result<Self, VaryingError> {
        let mut parser = Parser {
            text: text.as_bytes(),
            at: 0,
            depth: 0,
            steps: Vec::new(),
        };
        let length = text.chars().count();
        if length > MAX_EXPRESSION {
            // The place of this fault is the first character that is too many.
            return Err(VaryingError::Expression {
                at: MAX_EXPRESSION + 1,
                reason: format!(
                    "it has {length} characters; at most {MAX_EXPRESSION} are possible"
                ),
            });
        }

        parser.sum()?;
        if parser.peek().is_some() {
            return Err(parser.unexpected("an operator or the end"));
        }
        Ok(Self {
            text: text.to_owned(),
            steps: parser.steps,
        })
    }

    /// Returns the text that was read.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the value at a place.
    #[must_use]
    pub fn at(&self, x: f64, y: f64) -> f64 {
        // As many numbers as most expressions wait with: chosen, not measured.
        let mut stack = Vec::with_capacity(8);
        self.on(&mut stack, x, y)
    }

    /// Returns what [`Self::at`] does, by a stack whose memory is used again.
    pub(super) fn on(&self, stack: &mut Vec<f64>, x: f64, y: f64) -> f64 {
        stack.clear();
        // The parser leaves no step without its operands, so that the stack is never empty where one is taken.
        for step in &self.steps {
            let value = match *step {
                Step::Number(value) => value,
                Step::X => x,
                Step::Y => y,
                Step::One(function) => function(stack.pop().unwrap_or(f64::NAN)),
                Step::Two(function) => {
                    let second = stack.pop().unwrap_or(f64::NAN);
                    function(stack.pop().unwrap_or(f64::NAN), second)
                }
            };
            stack.push(value);
        }
        stack.pop().unwrap_or(f64::NAN)
    }
}

impl TryFrom<String> for Expression {
    type Error = VaryingError;

    fn try_from(text: String) -> Result<Self, VaryingError> {
        Self::parse(&text)
    }
}

impl From<Expression> for String {
    fn from(expression: Expression) -> Self {
        expression.text
    }
}

/// A parser by recursive descent. A sum is made of products, a product of signed powers, and a power of atoms: numbers, names,
/// functions and sums in parentheses. Each pushes its steps behind those of its operands, in the order of a stack.
struct Parser<'a> {
    text: &'a [u8],
    /// Where the next character is.
    at: usize,
    depth: usize,
    steps: Vec<Step>,
}

impl Parser<'_> {
    /// Counts a call within a call, and refuses those that would take the stack beyond its end.
    fn go_deeper(&mut self) -> Result<(), VaryingError> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.fault(format!("it is nested more than {MAX_DEPTH} deep")));
        }
        Ok(())
    }

    /// Reads a sum: products with signs between them.
    fn sum(&mut self) -> Result<(), VaryingError> {
        // Each parenthesis and each argument is a sum, so that depth is counted here, and otherwise only at exponents.
        self.go_deeper()?;
        self.product()?;
        // From the left: 1-2-3 is (1-2)-3.
        while let Some(sign) = self.take(b"+-") {
            self.product()?;
            let operation: OfTwo = if sign == b'+' {
                |a, b| a + b
            } else {
                |a, b| a - b
            };
            self.steps.push(Step::Two(operation));
        }
        self.depth -= 1;
        Ok(())
    }

    fn product(&mut self) -> Result<(), VaryingError> {
        self.signed()?;
        while let Some(sign) = self.take(b"*/") {
            self.signed()?;
            let operation: OfTwo = if sign == b'*' {
                |a, b| a * b
            } else {
                |a, b| a / b
            };
            self.steps.push(Step::Two(operation));
        }
        Ok(())
    }

    /// A power with signs before it, which bind less than it does: -2^2 is -4.
    fn signed(&mut self) -> Result<(), VaryingError> {
        let mut is_negative = false;
        while let Some(sign) = self.take(b"+-") {
            is_negative ^= sign == b'-';
        }
        self.atom()?;
        if self.take(b"^").is_some() {
            // Exponents of exponents are calls within calls without a sum.
            self.go_deeper()?;
            // From the right, as in mathematics: 2^3^2 is 2^9. An exponent may have signs of its own.
            self.signed()?;
            self.depth -= 1;
            self.steps.push(Step::Two(libm::pow));
        }
        if is_negative {
            self.steps.push(Step::One(|value| -value));
        }
        Ok(())
    }

    /// Reads a number, a name, a function with its arguments, or a sum in parentheses.
    fn atom(&mut self) -> Result<(), VaryingError> {
        match self.peek() {
            Some(b'(') => {
                self.at += 1;
                self.sum()?;
                self.close()
            }
            Some(c) if c.is_ascii_digit() || c == b'.' => self.number(),
            Some(c) if c.is_ascii_alphabetic() => {
                // Names may end in digits, as atan2 does.
                let is_word = |c: &u8| c.is_ascii_alphanumeric() || *c == b'_';
                let start = self.at;
                let length = self.text[start..].iter().take_while(|c| is_word(c)).count();
                self.at += length;
                let word = String::from_utf8_lossy(&self.text[start..start + length]).into_owned();
                self.word(&word, start)
            }
            _ => Err(self.unexpected("a number, x, y, a function or a parenthesis")),
        }
    }

    /// Reads a number.
    fn number(&mut self) -> Result<(), VaryingError> {
        let start = self.at;
        while let Some(&c) = self.text.get(self.at) {
            // A sign belongs to the number only if it follows the letter of an exponent.
            let is_exponent = |c: u8| matches!(c, b'e' | b'E');
            let is_sign =
                matches!(c, b'+' | b'-') && self.at > start && is_exponent(self.text[self.at - 1]);
            if !(c.is_ascii_digit() || c == b'.' || is_exponent(c) || is_sign) {
                break;
            }
            self.at += 1;
        }

        let text = String::from_utf8_lossy(&self.text[start..self.at]).into_owned();
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => {
                self.steps.push(Step::Number(value));
                Ok(())
            }
            _ => {
                self.at = start;
                Err(self.fault(format!("{text} is no number")))
            }
        }
    }

    /// Reads what follows a word, which began at `start`: nothing after a name, the arguments after a function.
    fn word(&mut self, word: &str, start: usize) -> Result<(), VaryingError> {
        // These three names are all that there are; others cannot be defined.
        let without_arguments = match word {
            "x" => Some(Step::X),
            "y" => Some(Step::Y),
            "pi" => Some(Step::Number(std::f64::consts::PI)),
            _ => None,
        };
        if let Some(step) = without_arguments {
            self.steps.push(step);
            return Ok(());
        }

        let one = ONE.iter().find(|(name, _)| *name == word);
        let two = TWO.iter().find(|(name, _)| *name == word);
        let step = match (one, two) {
            (Some(&(_, function)), _) => Step::One(function),
            (None, Some(&(_, function))) => Step::Two(function),
            (None, None) => {
                // The message names the place where the word begins.
                self.at = start;
                let names = ONE
                    .iter()
                    .map(|(name, _)| *name)
                    .chain(TWO.iter().map(|(name, _)| *name));
                let known: Vec<&str> = ["x", "y", "pi"].into_iter().chain(names).collect();
                return Err(
                    self.fault(format!("{word} is unknown; known are {}", known.join(", ")))
                );
            }
        };

        // The steps of the arguments come before that of the function, which takes their values from the stack.
        if self.take(b"(").is_none() {
            return Err(self.unexpected("("));
        }
        self.sum()?;
        if let Step::Two(_) = step {
            if self.take(b",").is_none() {
                return Err(self.unexpected(&format!("a comma, as {word} takes two numbers")));
            }
            self.sum()?;
        }
        self.close()?;
        self.steps.push(step);
        Ok(())
    }

    fn close(&mut self) -> Result<(), VaryingError> {
        match self.take(b")") {
            Some(_) => Ok(()),
            None => Err(self.unexpected(")")),
        }
    }

    /// Returns the next character that is no blank.
    fn peek(&mut self) -> Option<u8> {
        while self.text.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
        self.text.get(self.at).copied()
    }

    /// Takes the next character if it is one of these.
    fn take(&mut self, some: &[u8]) -> Option<u8> {
        let next = self.peek().filter(|next| some.contains(next));
        self.at += usize::from(next.is_some());
        next
    }

    fn unexpected(&mut self, wanted: &str) -> VaryingError {
        let found = match self.peek() {
            Some(c) if c.is_ascii_graphic() => format!("`{}`", char::from(c)),
            Some(_) => "another character".to_owned(),
            None => "the end".to_owned(),
        };
        self.fault(format!("{found} stands where {wanted} is needed"))
    }

    fn fault(&self, reason: String) -> VaryingError {
        // The first character of several bytes is a fault itself, so that up to it bytes and characters are the same number.
        VaryingError::Expression {
            at: self.at + 1,
            reason,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str, x: f64, y: f64) -> f64 {
        Expression::parse(text).expect(text).at(x, y)
    }

    fn fault(text: &str) -> String {
        Expression::parse(text).expect_err(text).to_string()
    }

    #[test]
    fn values_follow_the_rules_of_arithmetic() {
        let exactly = |text: &str, expected: f64| {
            let found = value(text, 3.0, -0.5);
            assert_eq!(found.to_bits(), expected.to_bits(), "{text}: {found}");
        };
        exactly("0.5 + 0.25*x", 1.25);
        exactly("1 - 2 - 3", -4.0);
        exactly("8/4/2*x", 3.0);
        exactly("-2^2", -4.0);
        exactly("2^-1", 0.5);
        exactly("2^3^2", 512.0);
        exactly("--x", 3.0);
        exactly("(1 + y) * 1e-2", 0.005);
        exactly("min(x, y) + max(x, 4) + abs(y)", 4.0);
        exactly("hypot(x, 4) + floor(y)", 4.0);
        exactly("sqrt(x*12) + 0 * pi", 6.0);
    }

    #[test]
    fn functions_have_the_same_bits_everywhere() {
        // Another library has the same, but for the last bits of tanh and of powers.
        let pinned = [
            ("sin(x)", 0x3fe4_9d6e_6946_19b8),
            ("exp(y)", 0x4028_5d6f_d931_e0bb),
            ("log(y)", 0x3fed_5240_f0e0_e078),
            ("tanh(x)", 0x3fe3_56fb_17af_2e90),
            ("cos(y)", 0xbfe9_a2f7_ef85_8b7d),
            ("atan2(y, x)", 0x3ff4_c3bc_f48f_aef4),
            ("x^y", 0x3fda_3cd7_2ed9_866c),
        ];
        for (text, bits) in pinned {
            assert_eq!(value(text, 0.7, 2.5).to_bits(), bits, "{text}");
        }
    }

    #[test]
    fn faults_are_named_with_their_place() {
        assert!(fault("").contains("character 1: the end stands where a number"));
        assert!(fault("1 + ").contains("character 5"));
        assert!(fault("2 x").contains("character 3: `x` stands where an operator"));
        assert!(fault("min(x)").contains("a comma, as min takes two numbers"));
        assert!(fault("sinh(x)").contains("sinh is unknown; known are x, y, pi, abs, "));
        assert!(fault("(1 + x").contains("the end stands where )"));
        assert!(fault("1.2.3").contains("1.2.3 is no number"));
        assert!(fault("1e999").contains("1e999 is no number"));
        assert!(fault("ä").contains("another character"));
    }

    #[test]
    fn expressions_without_end_are_refused() {
        let long = "x+".repeat(MAX_EXPRESSION);
        assert!(fault(&long).contains("8192 characters; at most 4096"));
        // Places are counted in characters, of which these have two bytes each.
        let wide = "\u{e9}".repeat(MAX_EXPRESSION + 1);
        assert!(fault(&wide).contains("at character 4097: it has 4097 characters"));
        assert!(fault(&wide[..8]).contains("at character 1: another character"));
        assert!(fault(&"(".repeat(4000)).contains("nested more than 64 deep"));
        assert!(fault(&"2^".repeat(2000)).contains("nested more than 64 deep"));
        let deep = format!("{}x{}", "(".repeat(60), ")".repeat(60));
        assert_eq!(value(&deep, 2.0, 0.0).to_bits(), 2_f64.to_bits());
    }
}
