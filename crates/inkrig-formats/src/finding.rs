//! What a reader or writer has to say about a file that it could handle.

use std::fmt;

/// Something to know about a file that was read or written all the same.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// A short stable name, such as `bvh-row-count`: for tests, filters and documentation.
    pub code: &'static str,
    /// How much it matters.
    pub severity: Severity,
    /// One sentence for people.
    pub message: String,
    /// Where in the file, when it is one place.
    pub place: Option<Place>,
}

/// How much a [`Finding`] matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// A choice was made that is nearly always right.
    Info,
    /// The file is not quite as it should be, or something could not be kept.
    Warning,
}

/// A place in a text file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Line, from 1. CR, LF and CRLF each end one line.
    pub line: usize,
    /// Column in characters, from 1; a tab is one character.
    pub column: usize,
    /// The joint that the place belongs to, fit for printing: control characters replaced, long names cut.
    pub joint: Option<String>,
}

impl Finding {
    pub(crate) fn info(code: &'static str, message: String) -> Self {
        Self { code, severity: Severity::Info, message, place: None }
    }

    pub(crate) fn warning(code: &'static str, message: String) -> Self {
        Self { code, severity: Severity::Warning, message, place: None }
    }

    pub(crate) fn at(mut self, place: Place) -> Self {
        self.place = Some(place);
        self
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let severity = match self.severity {
            Severity::Info => "info",
            Severity::Warning => "warning",
        };
        write!(f, "{severity} [{}] ", self.code)?;
        if let Some(place) = &self.place {
            write!(f, "{place}: ")?;
        }
        f.write_str(&self.message)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}", self.line, self.column)?;
        match &self.joint {
            Some(joint) => write!(f, ", joint `{joint}`"),
            None => Ok(()),
        }
    }
}

/// Text from a file made fit for a message: control characters replaced (they could steer a terminal), cut at 40
/// characters.
pub(crate) fn shown(text: &str) -> String {
    clean(text, 40)
}

/// As [`shown`], cut at `most` characters.
pub(crate) fn clean(text: &str, most: usize) -> String {
    let clean = |c: char| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c };
    let mut short: String = text.chars().take(most).map(clean).collect();
    if text.chars().nth(most).is_some() {
        short.push('…');
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_from_files_cannot_steer_a_terminal() {
        assert_eq!(shown("a\u{1b}[2Jb"), "a\u{fffd}[2Jb");
        assert_eq!(shown(&"x".repeat(41)), format!("{}…", "x".repeat(40)));
    }

    #[test]
    fn a_finding_reads_as_one_line() {
        let place = Place { line: 3, column: 7, joint: Some("Hips".into()) };
        let finding = Finding::warning("bvh-row-count", "3 rows, 4 announced".into()).at(place);
        let expected = "warning [bvh-row-count] line 3, column 7, joint `Hips`: 3 rows, 4 announced";
        assert_eq!(finding.to_string(), expected);
    }
}
