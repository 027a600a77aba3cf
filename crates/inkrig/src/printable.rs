//! Words and numbers made fit for a terminal and for people.

use std::fmt::Display;
use std::path::Path;

/// Text from outside (names, paths, messages that hold them) without what could steer a terminal or turn the order
/// of reading: such characters become U+FFFD. Line ends are replaced too, so one line stays one line.
pub fn text(text: impl Display) -> String {
    text.to_string()
        .chars()
        .map(|letter| if steers(letter) { char::REPLACEMENT_CHARACTER } else { letter })
        .collect()
}

/// A path as [`text`]; what is not UTF-8 becomes U+FFFD as well.
pub fn path(path: &Path) -> String {
    text(path.display())
}

/// A path for JSON, which holds text only: what is not UTF-8 becomes U+FFFD, everything else stays (JSON escapes it).
pub fn json_path(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// A number with a fixed count of decimals, and never a minus before nothing but zeros.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|letter| matches!(letter, '0' | '.')) => rest.to_string(),
        _ => text,
    }
}

/// What is wrong with JSON, in words of the file and not of the program that reads it.
pub fn json_error(error: &serde_json::Error) -> String {
    let types = [
        ("expected usize", "expected a whole number, 0 or more"),
        ("expected u64", "expected a whole number, 0 or more"),
        ("expected u32", "expected a whole number, 0 or more"),
        ("expected f32", "expected a number"),
        ("expected f64", "expected a number"),
        ("expected a sequence", "expected a list"),
        ("expected a map", "expected an object"),
        ("expected a string", "expected text"),
        ("expected struct ", "expected an object: "),
    ];
    types.iter().fold(error.to_string(), |said, (from, to)| said.replace(from, to))
}

/// `1 frame`, `2 frames`.
pub fn counted(count: usize, thing: &str) -> String {
    if count == 1 { format!("1 {thing}") } else { format!("{count} {thing}s") }
}

/// Control characters, and the marks that switch between left-to-right and right-to-left.
fn steers(letter: char) -> bool {
    letter.is_control()
        || matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_steers_a_terminal() {
        assert_eq!(text("a\u{1b}[2J\nb\u{9b}1m\u{202e}c ü"), "a\u{fffd}[2J\u{fffd}b\u{fffd}1m\u{fffd}c ü");
    }

    #[test]
    fn numbers_read_well() {
        assert_eq!([fixed(-0.001, 2), fixed(-0.0, 0), fixed(-0.01, 2)], ["0.00", "0", "-0.01"]);
        assert_eq!([counted(1, "frame"), counted(0, "frame")], ["1 frame", "0 frames"]);
    }
}
