//! Data as text that is safe inside of an HTML page.

use base64::prelude::{BASE64_STANDARD, Engine};
use serde::Serialize;

/// JSON that may stand in a `<script>` element: what could end the element or start a comment is escaped.
/// None of these characters occurs in JSON outside of strings.
pub(super) fn json_for_html(value: &impl Serialize) -> Result<String, serde_json::Error> {
    let json = serde_json::to_string(value)?;
    let mut escaped = String::with_capacity(json.len() + 64);
    for letter in json.chars() {
        match letter {
            '<' => escaped.push_str("\\u003c"),
            '>' => escaped.push_str("\\u003e"),
            '&' => escaped.push_str("\\u0026"),
            '\u{2028}' => escaped.push_str("\\u2028"),
            '\u{2029}' => escaped.push_str("\\u2029"),
            other => escaped.push(other),
        }
    }
    Ok(escaped)
}

/// Base64 with padding (RFC 4648, section 4).
pub(super) fn base64(bytes: &[u8]) -> String {
    BASE64_STANDARD.encode(bytes)
}

/// The number cut to so many decimals, 0 when it is not finite: short in JSON, and never NaN.
pub(super) fn decimals(value: f64, count: i32) -> f64 {
    let scale = 10_f64.powi(count);
    let rounded = (value * scale).round() / scale;
    if rounded.is_finite() { rounded + 0.0 } else { 0.0 }
}

/// At most `most` letters of a text, with a sign that something is missing.
pub(super) fn shorten(text: &str, most: usize) -> String {
    match text.char_indices().nth(most) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_is_escaped_and_comes_back() {
        let text = "</script><!-- & \u{2028}\u{2029} \"quoted\" \\u003c";
        let json = json_for_html(&text).unwrap();
        assert!(!json.contains(['<', '>', '&', '\u{2028}', '\u{2029}']), "{json}");
        assert_eq!(serde_json::from_str::<String>(&json).unwrap(), text);
    }

    #[test]
    fn numbers_stay_numbers() {
        assert_eq!(decimals(1.23456, 2), 1.23);
        assert_eq!(decimals(f64::NAN, 2), 0.0);
        assert_eq!(decimals(f64::MAX, 4), 0.0);
        assert_eq!(shorten("größer", 3), "grö…");
        assert_eq!(shorten("größer", 6), "größer");
    }
}
