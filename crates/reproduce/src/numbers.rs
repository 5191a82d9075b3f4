//! Numbers and cells as text: all digits for data files, significant ones for readers.

use std::fmt::Write;

use crate::outcome::{Cell, Table};

/// Returns a table as CSV with a head line; missing numbers are empty.
pub fn csv(table: &Table) -> String {
    let heads: Vec<&str> = table.columns.iter().map(|c| c.key.as_str()).collect();
    let mut out = heads.join(",");
    out.push('\n');
    for row in &table.rows {
        let cells: Vec<String> = row.iter().map(exact).collect();
        let _ = writeln!(out, "{}", cells.join(","));
    }
    out
}

fn exact(cell: &Cell) -> String {
    match cell {
        Cell::Count(count) => count.to_string(),
        Cell::Number(value) => value.to_string(),
        Cell::Text(text) if text.contains([',', '"', '\n', '\r']) => {
            format!("\"{}\"", text.replace('"', "\"\""))
        }
        Cell::Text(text) => text.clone(),
        Cell::Missing(()) => String::new(),
    }
}

/// Returns a cell for readers.
pub fn readable(cell: &Cell, digits: usize) -> String {
    match cell {
        Cell::Count(count) => self::count(*count),
        Cell::Number(value) => number(*value, digits),
        Cell::Text(text) => text.clone(),
        Cell::Missing(()) => "\u{2013}".to_owned(),
    }
}

/// Returns a whole number, thousands apart.
pub fn count(value: u64) -> String {
    grouped(&value.to_string())
}

/// Returns a number with these significant digits, and its thousands apart.
pub fn number(value: f64, digits: usize) -> String {
    // Zero, infinities and NaN have no magnitude, and are written as they are.
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 {
            "0".to_owned()
        } else {
            value.to_string()
        };
    }

    // No number is written without a digit.
    let digits = digits.max(1) as i32;
    // Rounding may lift a number to the next power of ten, as 9.996 to three digits. The written number can be read
    // again.
    let rounded: f64 = format!("{value:.*e}", (digits - 1) as usize)
        .parse()
        .unwrap_or(value);
    let magnitude = rounded.abs().log10().floor() as i32;

    // Written out, numbers below 0.0001 and from 10^15 on would be mostly zeros.
    if !(-4..15).contains(&magnitude) {
        return format!("{value:.*e}", (digits - 1) as usize);
    }

    let decimals = digits - 1 - magnitude;
    if decimals >= 0 {
        let text = format!("{value:.*}", decimals as usize);
        let (whole, rest) = text.split_once('.').unwrap_or((&text, ""));
        let point = if rest.is_empty() { "" } else { "." };
        return format!("{}{point}{rest}", grouped(whole));
    }

    // There are more places before the point than digits asked for: the number is rounded to its leading digits, and zeros
    // fill the places behind them.
    let unit = 10_f64.powi(-decimals);
    grouped(&format!("{:.0}", (value / unit).round() * unit))
}

/// Returns the figures of a whole number with thousands apart; numbers of four figures or fewer have no gap.
fn grouped(whole: &str) -> String {
    let (sign, figures) = match whole.strip_prefix('-') {
        Some(figures) => ("\u{2212}", figures),
        None => ("", whole),
    };
    let mut out = sign.to_owned();
    for (index, figure) in figures.chars().enumerate() {
        if index > 0 && (figures.len() - index).is_multiple_of(3) && figures.len() > 4 {
            out.push('\u{202f}');
        }
        out.push(figure);
    }
    out
}

/// Returns a share as a percentage.
pub fn percent(share: f64, digits: usize) -> String {
    format!("{} %", number(100.0 * share, digits))
}

/// Returns a number with its sign.
pub fn signed(value: f64, digits: usize) -> String {
    let sign = if value > 0.0 { "+" } else { "" };
    format!("{sign}{}", number(value, digits))
}

/// Returns a probability. Those below 1e-300, near the end of the range of doubles, are not told apart.
pub fn chance(probability: f64) -> String {
    if probability < 1e-300 {
        "below 1e-300".to_owned()
    } else {
        number(probability, 2)
    }
}

/// Returns text for pictures, whose fonts have no narrow space.
pub fn drawn(text: &str) -> String {
    text.replace('\u{202f}', " ")
}

/// Returns a number for pictures.
pub fn drawn_number(value: f64, digits: usize) -> String {
    drawn(&number(value, digits))
}

/// Returns a whole number for pictures.
pub fn drawn_count(value: usize) -> String {
    drawn(&count(value as u64))
}
