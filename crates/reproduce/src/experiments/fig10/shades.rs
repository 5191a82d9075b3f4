//! Values as shades of grey.

/// Errors of this size and beyond are black or white.
pub const ERROR_SHOWN: f64 = 0.5;

/// Returns the shade of a value from -1 to 1.
pub fn shade(value: f64) -> u8 {
    (127.5 + 127.5 * value).round().clamp(0.0, 255.0) as u8
}

/// Returns the shade of an error; zero is middle grey.
pub fn error_shade(error: f64) -> u8 {
    shade(error / ERROR_SHOWN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shades_reach_from_black_to_white() {
        assert_eq!([-2.0, -1.0, 0.0, 1.0].map(shade), [0, 0, 128, 255]);
        assert_eq!([-0.5, 0.0, 0.5].map(error_shade), [0, 128, 255]);
    }
}
