//! Style sheets and style attributes of an SVG, cut down to what decides whether and where a shape is seen.

use std::fmt::Write;

/// Properties that are kept.
const PROPERTIES: [&str; 13] = [
    "display",
    "visibility",
    "opacity",
    "overflow",
    "color",
    "fill",
    "fill-opacity",
    "stroke",
    "stroke-opacity",
    "stroke-width",
    "font-size",
    "transform",
    "transform-origin",
];

/// Whether a property decides about visibility or place.
pub(super) fn is_kept_property(name: &str) -> bool {
    PROPERTIES.contains(&name)
}

/// A value that is safe to hand on, or `None`. Paint that is defined elsewhere (gradients, patterns, variables) becomes
/// black: it is seen, and its colour does not matter.
pub(super) fn clean_value<'a>(property: &str, value: &'a str) -> Option<&'a str> {
    let value = value.trim();
    let is_paint = matches!(property, "fill" | "stroke" | "color");
    let harmless = |c: char| c.is_ascii_alphanumeric() || " .,#%()+-!".contains(c);
    if is_paint && (value.contains("url(") || value.contains("var(")) {
        Some("black")
    } else {
        (!value.is_empty() && value.chars().all(harmless)).then_some(value)
    }
}

/// The kept declarations of a style attribute or of a rule's body, as `name:value;`.
pub(super) fn clean_declarations(text: &str) -> String {
    let mut clean = String::new();
    for (name, value) in text.split(';').filter_map(|declaration| declaration.split_once(':')) {
        let name = name.trim();
        if let Some(value) = clean_value(name, value).filter(|_| is_kept_property(name)) {
            // Writing to a string does not fail.
            let _ = write!(clean, "{name}:{value};");
        }
    }
    clean
}

/// Collects the rules of style sheets whose selectors are a type, a class, an id or a type with one of these, which is
/// what drawing programs write. Rules with other selectors and at-rules are left out.
///
/// `on_rule` is told the selector and declarations of each; it stops the reading with an error.
pub(super) fn for_each_rule<E>(
    sheet: &str,
    mut on_rule: impl FnMut(&str, &str) -> Result<(), E>,
) -> Result<(), E> {
    let sheet = without_comments(sheet);
    let mut rest = sheet.as_str();
    while let Some((prelude, body)) = rest.split_once('{') {
        // At-rules without a block may stand before the selectors.
        let selectors = prelude.rsplit(';').next().unwrap_or(prelude).trim();
        if selectors.starts_with('@') {
            rest = after_block(body);
            continue;
        }
        let (declarations, after) = body.split_once('}').unwrap_or((body, ""));
        rest = after;
        let declarations = clean_declarations(declarations);
        if !declarations.is_empty() {
            for selector in selectors.split(',').map(str::trim).filter(|selector| is_simple(selector)) {
                on_rule(selector, &declarations)?;
            }
        }
    }
    Ok(())
}

fn without_comments(sheet: &str) -> String {
    let mut clean = String::with_capacity(sheet.len());
    let mut rest = sheet;
    while let Some((before, comment)) = rest.split_once("/*") {
        clean.push_str(before);
        clean.push(' ');
        rest = comment.split_once("*/").map_or("", |(_, after)| after);
    }
    clean.push_str(rest);
    clean
}

/// What follows the end of a block whose first brace is already open.
fn after_block(text: &str) -> &str {
    let mut depth = 1_usize;
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            b'{' => depth += 1,
            b'}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return text.get(at + 1..).unwrap_or_default();
        }
    }
    ""
}

/// `path`, `*`, `.class`, `#id`, `path.class` or `path#id`.
fn is_simple(selector: &str) -> bool {
    match selector.split_once(['.', '#']) {
        Some((element, name)) => (element.is_empty() || element == "*" || is_name(element)) && is_name(name),
        None => selector == "*" || is_name(selector),
    }
}

fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rules(sheet: &str) -> Vec<String> {
        let mut found = Vec::new();
        let read: Result<(), ()> = for_each_rule(sheet, |selector, declarations| {
            found.push(format!("{selector}{{{declarations}}}"));
            Ok(())
        });
        assert_eq!(read, Ok(()));
        found
    }

    #[test]
    fn what_drawing_programs_write_is_kept() {
        assert_eq!(
            rules(
                "/* a */ @import url(x); .cls-1, .cls-2 { fill: none; stroke-miterlimit:10 } #a{display:none}"
            ),
            [".cls-1{fill:none;}", ".cls-2{fill:none;}", "#a{display:none;}"]
        );
        assert_eq!(
            rules("@media print { .a { fill: red } } path.b{stroke:url(#g)}"),
            ["path.b{stroke:black;}"]
        );
    }

    #[test]
    fn the_rest_is_left_out() {
        assert_eq!(
            rules("a b{fill:red} a>b{fill:red} [x]{fill:red} .a{filter:url(#f)} {} }{ ,{fill:red}"),
            [""; 0]
        );
        assert_eq!(
            clean_declarations("fill:red;mask:url(#a);stroke:'x';opacity:0;transform"),
            "fill:red;opacity:0;"
        );
    }
}
