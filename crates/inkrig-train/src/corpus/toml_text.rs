//! TOML files, with what is wrong in them said in one line.

use serde::de::DeserializeOwned;

/// Reads a text in TOML.
///
/// # Errors
/// Line, column and what is wrong there.
pub(crate) fn parse_toml<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    toml::from_str(text).map_err(|error| toml_error(text, &error))
}

/// What a reader of TOML says, which has several lines with a drawing of the place, as one line.
pub(crate) fn toml_error(text: &str, error: &toml::de::Error) -> String {
    let Some(before) = error.span().and_then(|span| text.get(..span.start)) else {
        // Of values that come from no text: what is wrong, and the key.
        return joined(&error.to_string());
    };
    let line = before.matches('\n').count() + 1;
    let column = before.chars().rev().take_while(|&letter| letter != '\n').count() + 1;
    format!("line {line}, column {column}: {}", joined(error.message()))
}

fn joined(text: &str) -> String {
    text.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_one_line_with_its_place() {
        let says = |text: &str| parse_toml::<toml::Table>(text).unwrap_err();
        let said = says("a = 1\nhello");
        assert!(said.starts_with("line 2, column ") && !said.contains('\n') && !said.contains('|'), "{said}");
        assert!(says("ü = 'x").starts_with("line 1, column "), "columns are letters");
        let of_table = toml::Table::from_iter([("seed".to_string(), toml::Value::Boolean(true))]);
        let error = of_table.try_into::<std::collections::BTreeMap<String, u64>>().unwrap_err();
        let said = toml_error("", &error);
        assert!(said.contains("u64") && said.contains("seed") && !said.contains('\n'), "{said}");
    }
}
