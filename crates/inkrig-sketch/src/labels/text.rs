//! Labels in a line: `A:30 B:45 "wave left":1.5s`.

use std::fmt::{Display, Formatter};
use std::str::FromStr;

use super::{LabelLength, Labels, LabelsBuilder, Refusal};
use crate::SketchError;
use crate::limits::MAX_BYTES;
use crate::wave::shown;

const WHAT: &str = "labels";

impl FromStr for Labels {
    type Err = SketchError;

    /// Reads a row from its text.
    ///
    /// # Errors
    /// [`SketchError::Syntax`] with the column, what stands there and what is expected; the errors of [`Labels::new`].
    fn from_str(text: &str) -> Result<Self, SketchError> {
        if text.len() > MAX_BYTES {
            return Err(SketchError::FileTooLarge { what: WHAT, bytes: text.len() });
        }
        let mut builder = LabelsBuilder::default();
        let mut cursor = Cursor { rest: text, column: 1 };
        loop {
            cursor.skip(char::is_whitespace);
            if cursor.rest.is_empty() {
                return builder.finish();
            }
            let name_column = cursor.column;
            let name = cursor.name()?;
            cursor.colon(&name)?;
            let length_column = cursor.column;
            let word = cursor.skip(|c| !c.is_whitespace());
            let length =
                length(word, &name).map_err(|(expected, hint)| wrong(length_column, word, expected, hint))?;
            builder.push(&name, length).map_err(|refusal| match refusal {
                Refusal::Full(error) => error,
                Refusal::Name(expected) => wrong(name_column, &name, expected, None),
                Refusal::Length(expected) => wrong(length_column, word, expected, None),
            })?;
        }
    }
}

impl Display for Labels {
    fn fmt(&self, out: &mut Formatter<'_>) -> std::fmt::Result {
        for (index, (name, length)) in self.segments().enumerate() {
            out.write_str(if index > 0 { " " } else { "" })?;
            if name.starts_with('"') || name.contains(|c: char| c == ':' || c.is_whitespace()) {
                write!(out, "\"{}\"", name.replace('"', "\"\""))?;
            } else {
                out.write_str(name)?;
            }
            match length {
                LabelLength::Frames(frames) => write!(out, ":{frames}")?,
                LabelLength::Seconds(seconds) => write!(out, ":{seconds}s")?,
            }
        }
        Ok(())
    }
}

/// The text that is left, and where it begins.
struct Cursor<'a> {
    rest: &'a str,
    /// In characters, counted from 1.
    column: usize,
}

impl<'a> Cursor<'a> {
    /// Passes the characters for which the test holds.
    fn skip(&mut self, test: impl Fn(char) -> bool) -> &'a str {
        let end = self.rest.find(|c| !test(c)).unwrap_or(self.rest.len());
        let (passed, rest) = self.rest.split_at_checked(end).unwrap_or((self.rest, ""));
        self.rest = rest;
        self.column += passed.chars().count();
        passed
    }

    fn name(&mut self) -> Result<String, SketchError> {
        let start = self.column;
        if !self.take('"') {
            return Ok(self.skip(|c| c != ':' && !c.is_whitespace()).to_owned());
        }
        let mut name = String::new();
        loop {
            name.push_str(self.skip(|c| c != '"'));
            if !self.take('"') {
                return Err(wrong(start, &name, "a quote at the end of the name", None));
            }
            if !self.take('"') {
                return Ok(name);
            }
            name.push('"');
        }
    }

    fn colon(&mut self, name: &str) -> Result<(), SketchError> {
        if name.is_empty() {
            return Err(wrong(
                self.column,
                self.word(),
                "a name before the colon",
                Some("Write A:30".into()),
            ));
        }
        if !self.take(':') {
            let hint = format!(
                "Write {0}:30 or {0}:1s; a name with spaces is put in quotes",
                shown(name).trim_matches('`')
            );
            return Err(wrong(self.column, self.word(), "a colon and a length after the name", Some(hint)));
        }
        Ok(())
    }

    fn take(&mut self, sign: char) -> bool {
        let Some(rest) = self.rest.strip_prefix(sign) else { return false };
        self.rest = rest;
        self.column += 1;
        true
    }

    /// What stands here up to the next space.
    fn word(&self) -> &'a str {
        if self.rest.starts_with(char::is_whitespace) {
            " "
        } else {
            self.rest.split(char::is_whitespace).next().unwrap_or_default()
        }
    }
}

/// Reads a length, or says what is expected and how to write it.
fn length(word: &str, name: &str) -> Result<LabelLength, (&'static str, Option<String>)> {
    const EXPECTED: &str = "a length in frames, such as 30, or in seconds, such as 1.5s";
    if let Ok(frames) = word.parse() {
        return Ok(LabelLength::Frames(frames));
    }
    let is_number = |text: &str| text.starts_with(|c: char| c.is_ascii_digit() || c == '.');
    match word.strip_suffix('s').map(|text| (is_number(text), text.parse())) {
        Some((true, Ok(seconds))) => return Ok(LabelLength::Seconds(seconds)),
        _ if word.is_empty() => {
            return Err((EXPECTED, Some("Write the length right after the colon, without a space".into())));
        }
        _ => {}
    }
    let hint = if word.ends_with([',', ';']) {
        Some("Separate segments by spaces only".into())
    } else if is_number(word) && word.contains('.') && word.parse::<f64>().is_ok() {
        Some(format!("Frames are whole; for seconds write {}s", shown(word).trim_matches('`')))
    } else if word.contains(':') {
        Some(format!("Put a name that holds a colon in quotes, or a space after the length of {name:?}"))
    } else {
        None
    };
    Err((EXPECTED, hint))
}

fn wrong(column: usize, found: &str, expected: impl Into<String>, hint: Option<String>) -> SketchError {
    let found = match found {
        "" => "the end".to_owned(),
        " " => "a space".to_owned(),
        _ => shown(found),
    };
    SketchError::Syntax { what: WHAT, column, found, expected: expected.into(), hint }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn segments(text: &str) -> Vec<(String, LabelLength)> {
        text.parse::<Labels>().unwrap().segments().map(|(name, length)| (name.to_owned(), length)).collect()
    }

    #[test]
    fn names_are_free() {
        use LabelLength::{Frames, Seconds};
        let read = segments(" A:30\n\"a: \"\"b\"\"\":1.5s 5\":2\tÄ-ö/3:1e1s");
        let expected =
            [("A", Frames(30)), ("a: \"b\"", Seconds(1.5)), ("5\"", Frames(2)), ("Ä-ö/3", Seconds(10.0))];
        assert_eq!(read, expected.map(|(name, length)| (name.to_owned(), length)));
    }

    #[test]
    fn display_quotes_only_where_needed() {
        let text = "A:30 \"a b\":1.5s \"x:\":1 5\":2 \"\"\"q\":3";
        assert_eq!(text.parse::<Labels>().unwrap().to_string(), text);
    }
}
