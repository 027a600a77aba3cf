//! Words, numbers and signs of a wave's text, each with its column.

use super::MAX_WAVE_TEXT;
use crate::SketchError;
use crate::limits::MAX_MAGNITUDE;

pub(super) const WHAT: &str = "wave";

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Number(f64),
    Word,
    /// `..`
    Range,
    /// One of `( ) , ; = | + - *`.
    Sign(char),
    End,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Token<'a> {
    pub(super) kind: Kind,
    pub(super) text: &'a str,
    /// Character of the whole text, counted from 1.
    pub(super) column: usize,
}

impl Token<'_> {
    pub(super) fn is_word(&self, word: &str) -> bool {
        self.kind == Kind::Word && self.text.eq_ignore_ascii_case(word)
    }

    pub(super) fn is_sign(&self, sign: char) -> bool {
        self.kind == Kind::Sign(sign)
    }

    /// The mistake that this token is.
    pub(super) fn wrong(&self, expected: impl Into<String>, hint: Option<&str>) -> SketchError {
        let found = match self.kind {
            Kind::End => "the end".to_owned(),
            _ => shown(self.text),
        };
        SketchError::Syntax {
            what: WHAT,
            column: self.column,
            found,
            expected: expected.into(),
            hint: hint.map(str::to_owned),
        }
    }
}

/// A piece of the text in backquotes, not too long, without control characters.
pub(crate) fn shown(text: &str) -> String {
    let start: String = text.chars().take(40).flat_map(char::escape_debug).collect();
    let more = if text.chars().nth(40).is_some() { "..." } else { "" };
    format!("`{start}{more}`")
}

/// All tokens; the last one is the end.
pub(super) fn tokens(text: &str) -> Result<Vec<Token<'_>>, SketchError> {
    if text.len() > MAX_WAVE_TEXT {
        return Err(SketchError::Syntax {
            what: WHAT,
            column: 1,
            found: format!("a text of {} bytes", text.len()),
            expected: format!("at most {MAX_WAVE_TEXT} bytes"),
            hint: Some("Give long waves as CSV or JSON samples".into()),
        });
    }
    let mut tokens = Vec::new();
    let (mut rest, mut column) = (text, 1);
    loop {
        let trimmed = rest.trim_start();
        column += rest.chars().take_while(|c| c.is_whitespace()).count();
        let Some(first) = trimmed.chars().next() else {
            tokens.push(Token { kind: Kind::End, text: "", column });
            return Ok(tokens);
        };
        let length = match first {
            '0'..='9' => number_length(trimmed),
            '.' if trimmed.starts_with("..") => 2,
            '.' => number_length(trimmed),
            _ if first.is_alphabetic() || first == '_' => {
                trimmed.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(trimmed.len())
            }
            _ => first.len_utf8(),
        };
        let (text, after) = trimmed.split_at_checked(length).unwrap_or((trimmed, ""));
        let mut token = Token { kind: Kind::Word, text, column };
        token.kind = match first {
            '.' if text == ".." => Kind::Range,
            '0'..='9' | '.' => number(&token)?,
            '(' | ')' | ',' | ';' | '=' | '|' | '+' | '-' | '*' => Kind::Sign(first),
            _ if first.is_alphabetic() || first == '_' => Kind::Word,
            _ => {
                return Err(token.wrong("a number, a name, .. or one of ( ) , ; = | + - *", sign_hint(first)));
            }
        };
        tokens.push(token);
        column += text.chars().count();
        rest = after;
    }
}

fn sign_hint(sign: char) -> Option<&'static str> {
    match sign {
        '/' => Some("There is no division: multiply by the reciprocal, as in 0.5 * t"),
        '^' => Some("There are no powers: multiply, as in t * t"),
        '\u{2212}' | '\u{2013}' => Some("Write minus as -"),
        '\u{00B7}' | '\u{00D7}' => Some("Write times as *"),
        '\u{2026}' => Some("Write a range with two points, as in 2Hz..8Hz"),
        '[' | '{' => Some("Use round parentheses; JSON samples are read from a file"),
        ':' => Some("This looks like labels; a wave is written as in sine(2Hz..8Hz)"),
        _ => None,
    }
}

/// Bytes of the number at the start. A point is part of it only where a digit follows, so that `2..8` is a range.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        bytes.get(from..).unwrap_or_default().iter().take_while(|byte| byte.is_ascii_digit()).count()
    };
    let mut length = digits(0);
    if bytes.get(length) == Some(&b'.') && digits(length + 1) > 0 {
        length += 1 + digits(length + 1);
    }
    if matches!(bytes.get(length), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(length + 1), Some(b'+' | b'-')));
        let exponent = digits(length + 1 + sign);
        if exponent > 0 {
            length += 1 + sign + exponent;
        }
    }
    length.max(1)
}

fn number(token: &Token<'_>) -> Result<Kind, SketchError> {
    match token.text.parse::<f64>() {
        Ok(value) if value <= MAX_MAGNITUDE => Ok(Kind::Number(value)),
        Ok(_) => Err(token.wrong(format!("a number of at most {MAX_MAGNITUDE:e}"), None)),
        Err(_) => Err(token.wrong("a number", Some("Write a decimal as in 0.5 and a range as in 2Hz..8Hz"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Vec<(String, usize)> {
        tokens(text).unwrap().iter().map(|token| (token.text.to_owned(), token.column)).collect()
    }

    #[test]
    fn ranges_units_and_exponents_come_apart() {
        let pieces = |text: &str| read(text).into_iter().map(|(piece, _)| piece).collect::<Vec<_>>();
        assert_eq!(pieces("2Hz..8Hz"), ["2", "Hz", "..", "8", "Hz", ""]);
        assert_eq!(pieces("2..8"), ["2", "..", "8", ""]);
        assert_eq!(pieces(".5...5"), [".5", "..", ".5", ""]);
        assert_eq!(pieces("1e-3s 2e x"), ["1e-3", "s", "2", "e", "x", ""]);
        assert_eq!(pieces("-1|1"), ["-", "1", "|", "1", ""]);
    }

    #[test]
    fn columns_count_characters() {
        assert_eq!(read("  ä\u{2003}b"), [("ä".into(), 3), ("b".into(), 5), (String::new(), 6)]);
    }
}
