//! Words, lines and places in a text, for the formats that are one.

use crate::{FormatError, Place, finding::shown};

/// Numbers are taken for broken beyond this, in the file's own units.
pub(crate) const LARGEST_NUMBER: f64 = 1e12;

/// A position in the text that knows its line. CR, LF and CRLF each end one line.
#[derive(Debug, Clone)]
pub(crate) struct Lexer<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
    line_start: usize,
}

/// A piece of the text and where it stands.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Word<'a> {
    pub(crate) text: &'a [u8],
    at: usize,
    line: usize,
    line_start: usize,
}

impl<'a> Lexer<'a> {
    /// Starts after a byte order mark. Zeros and the DOS end-of-file mark at the end are left out.
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        let padding = |byte: &&u8| matches!(byte, 0 | 0x1a);
        let end = bytes.len() - bytes.iter().rev().take_while(padding).count();
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3.min(end) } else { 0 };
        Self { bytes: bytes.get(..end).unwrap_or_default(), at, line: 1, line_start: at }
    }

    /// Size of the whole text, bytes.
    pub(crate) fn len(&self) -> usize {
        self.bytes.len()
    }

    /// The text that is still ahead.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    /// Skips spaces and line ends; whether there is any text left.
    pub(crate) fn skip_space(&mut self) -> bool {
        while let Some(&byte) = self.bytes.get(self.at) {
            match byte {
                b'\n' | b'\r' => self.end_line(byte),
                _ if is_blank(byte) => self.at += 1,
                _ => return true,
            }
        }
        false
    }

    /// The next word on any line; a brace is a word of its own. Empty at the end of the text.
    pub(crate) fn word(&mut self) -> Word<'a> {
        self.skip_space();
        let length = match self.bytes.get(self.at) {
            Some(b'{' | b'}') => 1,
            _ => self.rest().iter().take_while(|&&byte| !ends_word(byte)).count(),
        };
        self.take(length)
    }

    /// The next word without moving.
    pub(crate) fn peek(&self) -> Word<'a> {
        self.clone().word()
    }

    /// The next run of anything but spaces on this line. Empty at its end.
    pub(crate) fn word_in_line(&mut self) -> Word<'a> {
        let mut start = self.at;
        while self.bytes.get(start).is_some_and(|&byte| is_blank(byte)) {
            start += 1;
        }
        self.at = start;
        let ends = |&byte: &u8| is_blank(byte) || byte == b'\n' || byte == b'\r';
        let length = self.rest().iter().position(ends).unwrap_or(self.rest().len());
        self.take(length)
    }

    /// The rest of this line up to a `{`, without spaces at its ends.
    pub(crate) fn name(&mut self) -> Word<'a> {
        self.line_until(|byte| matches!(byte, b'{' | b'\n' | b'\r'))
    }

    /// The rest of this line, without spaces at its ends.
    pub(crate) fn line(&mut self) -> Word<'a> {
        self.line_until(|byte| matches!(byte, b'\n' | b'\r'))
    }

    /// The place of a word, in or beside a joint.
    pub(crate) fn place(&self, word: &Word<'_>, joint: Option<&str>) -> Place {
        let before = self.bytes.get(word.line_start..word.at).unwrap_or_default();
        // A UTF-8 character is one column: its later bytes do not count.
        let column = before.iter().filter(|&&byte| byte & 0xc0 != 0x80).count() + 1;
        Place { line: word.line, column, joint: joint.map(shown) }
    }

    /// An error at a word.
    pub(crate) fn error(
        &self,
        code: &'static str,
        word: &Word<'_>,
        joint: Option<&str>,
        what: impl Into<String>,
        hint: impl Into<String>,
    ) -> FormatError {
        FormatError::Read { code, place: self.place(word, joint), what: what.into(), hint: hint.into() }
    }

    /// Whether a word is the very last thing in the text.
    pub(crate) fn is_last(&self, word: &Word<'_>) -> bool {
        word.at + word.text.len() == self.bytes.len()
    }

    fn line_until(&mut self, ends: impl Fn(u8) -> bool) -> Word<'a> {
        let rest = self.rest();
        let length = rest.iter().position(|&byte| ends(byte)).unwrap_or(rest.len());
        let all = rest.get(..length).unwrap_or_default();
        let front = all.iter().take_while(|&&byte| is_blank(byte)).count();
        let back = all.iter().rev().take_while(|&&byte| is_blank(byte)).count();
        let end = self.at + length;
        self.at += front;
        let word = self.take(length.saturating_sub(front + back));
        self.at = end;
        word
    }

    fn take(&mut self, length: usize) -> Word<'a> {
        let text = self.bytes.get(self.at..self.at + length).unwrap_or_default();
        let word = Word { text, at: self.at, line: self.line, line_start: self.line_start };
        self.at += length;
        word
    }

    fn end_line(&mut self, byte: u8) {
        let crlf = byte == b'\r' && self.bytes.get(self.at + 1) == Some(&b'\n');
        self.at += if crlf { 2 } else { 1 };
        self.line += 1;
        self.line_start = self.at;
    }
}

impl<'a> Word<'a> {
    /// What stands before and after the first colon, without spaces at its ends. Without a colon all stands before.
    pub(crate) fn split_at_colon(&self) -> (&'a [u8], Self) {
        let colon = self.text.iter().position(|&byte| byte == b':').unwrap_or(self.text.len());
        let (key, after) = self.text.split_at_checked(colon).unwrap_or_default();
        let front = after.iter().take_while(|&&byte| byte == b':' || is_blank(byte)).count();
        let text = after.get(front..).unwrap_or_default();
        (key, Self { text, at: self.at + colon + front, ..*self })
    }

    /// The word as shown in messages, where it is the value of a line.
    pub(crate) fn shown_value(&self) -> String {
        if self.text.is_empty() { "nothing".into() } else { self.shown() }
    }

    /// Whether the word is a keyword, in upper or lower case.
    pub(crate) fn is(&self, keyword: &str) -> bool {
        self.text.eq_ignore_ascii_case(keyword.as_bytes())
    }

    /// The word as shown in messages.
    pub(crate) fn shown(&self) -> String {
        if self.text.is_empty() {
            return "the end of the file".into();
        }
        // A name of 40 characters has at most 160 bytes; a whole file in one word is not converted for one message.
        let start = self.text.get(..200).unwrap_or(self.text);
        format!("`{}`", shown(&String::from_utf8_lossy(start)))
    }

    /// The word as a number.
    pub(crate) fn number(&self) -> Result<f64, NotANumber> {
        let text = std::str::from_utf8(self.text).map_err(|_| NotANumber::Text)?;
        match text.parse::<f64>() {
            Ok(value) if value.abs() <= LARGEST_NUMBER => Ok(value),
            Ok(value) if value.is_nan() => Err(NotANumber::Nan),
            Ok(_) if text.contains(['n', 'N']) => Err(NotANumber::Infinite),
            Ok(_) => Err(NotANumber::TooLarge),
            Err(_) if self.has_decimal_comma() => Err(NotANumber::Comma),
            Err(_) => Err(NotANumber::Text),
        }
    }

    fn has_decimal_comma(&self) -> bool {
        let digits = |&byte: &u8| byte.is_ascii_digit() || matches!(byte, b',' | b'.' | b'-' | b'+');
        self.text.contains(&b',') && self.text.iter().all(digits)
    }
}

/// Why a word is not a usable number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NotANumber {
    Text,
    Comma,
    Nan,
    Infinite,
    TooLarge,
}

impl NotANumber {
    pub(crate) fn hint(self) -> &'static str {
        match self {
            Self::Text => "write a decimal number, such as -12.5",
            Self::Comma => "write decimals with a point, and nothing but spaces between numbers",
            Self::Nan | Self::Infinite => "export the motion again, or put in the value of the frame before",
            Self::TooLarge => "numbers go up to 1e12; export the motion again",
        }
    }
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | 0x0b | 0x0c)
}

fn ends_word(byte: u8) -> bool {
    is_blank(byte) || matches!(byte, b'\n' | b'\r' | b'{' | b'}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_end_counts_once() {
        let mut lexer = Lexer::new(b"\xef\xbb\xbfa\r\nb\rc\n\n\tde{");
        let words: Vec<_> = (0..5).map(|_| lexer.word()).collect();
        let lines: Vec<_> = words.iter().map(|word| word.line).collect();
        assert_eq!(lines, [1, 2, 3, 5, 5]);
        let place = lexer.place(&words[4], Some("hip"));
        assert_eq!(place.to_string(), "line 5, column 4, joint `hip`");
        assert_eq!(lexer.place(&words[0], None).column, 1);
        assert!(lexer.word().text.is_empty());
    }

    #[test]
    fn names_run_to_the_brace_or_the_line_end() {
        let mut lexer = Lexer::new("  left \thand  {\né  b".as_bytes());
        assert_eq!(lexer.name().text, b"left \thand");
        assert_eq!(lexer.word().text, b"{");
        assert!(lexer.skip_space());
        assert_eq!(lexer.word_in_line().text, "é".as_bytes());
        let last = lexer.word_in_line();
        assert_eq!(lexer.place(&last, None).column, 4);
        assert!(lexer.is_last(&last));
    }

    #[test]
    fn numbers_as_files_write_them() {
        let number = |text: &str| Lexer::new(text.as_bytes()).word().number();
        for (text, value) in
            [(".0083333", 0.0083333), ("+1", 1.0), ("1e-5", 1e-5), ("-5.", -5.0), ("-0", 0.0)]
        {
            assert_eq!(number(text), Ok(value), "{text}");
        }
        assert_eq!(number("0,5"), Err(NotANumber::Comma));
        assert_eq!(number("-nan"), Err(NotANumber::Nan));
        assert_eq!(number("-inf"), Err(NotANumber::Infinite));
        assert_eq!(number("1e13"), Err(NotANumber::TooLarge));
        assert_eq!(number("1e999"), Err(NotANumber::TooLarge));
        assert_eq!(number("-1.#IND"), Err(NotANumber::Text));
        assert_eq!(number("é"), Err(NotANumber::Text));
    }
}
