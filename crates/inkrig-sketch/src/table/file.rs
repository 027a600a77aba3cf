//! What the readers of controls share: bytes to text, and the place of a mistake in JSON.

use crate::SketchError;
use crate::limits::MAX_BYTES;
use crate::read::utf8;

/// The text of a file that should hold `what`.
pub(crate) fn text_of<'a>(bytes: &'a [u8], what: &'static str) -> Result<&'a str, SketchError> {
    if bytes.len() > MAX_BYTES {
        return Err(SketchError::FileTooLarge { what, bytes: bytes.len() });
    }
    utf8(bytes).map_err(|line| SketchError::FileNotText { what, line })
}

/// A mistake in JSON, found after `index` good items.
pub(crate) fn located(
    error: &serde_json::Error,
    text: &str,
    item: &'static str,
    index: usize,
) -> SketchError {
    let (line, column) = (error.line(), error.column());
    let rest = text.lines().nth(line.saturating_sub(1)).and_then(|line| line.get(column.saturating_sub(1)..));
    let word: String = rest.unwrap_or_default().chars().take_while(char::is_ascii_alphabetic).collect();
    let message = error.to_string();
    let problem = match word.as_str() {
        // As Python and JavaScript programs write them.
        "NaN" | "Infinity" => format!("{word} is not a finite number. Repair or leave out this {item}"),
        // The place is told apart from the problem: serde_json ends its message with it.
        _ => message
            .rsplit_once(" at line ")
            .map_or(message.as_str(), |(problem, _)| problem)
            .replace("expected usize", "expected a whole number")
            .replace("expected f64", "expected a number"),
    };
    SketchError::JsonItem { line, column, item, index, problem }
}
