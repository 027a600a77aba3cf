//! Style sheets and style attributes of an SVG, cut down to what decides whether and where a shape is seen.

use std::fmt::Write;

/// Properties that are handed on as they are.
const PROPERTIES: [&str; 6] =
    ["display", "visibility", "opacity", "fill-opacity", "transform", "transform-origin"];

/// Whether a shape is painted, as `fill` and `stroke` say, in two properties that are inherited alike and cost nothing:
/// outlining a hostile stroke, only to know its size, is what makes SVG programs slow or stop. `flatten` reads them.
const FILLED: [&str; 3] = ["paint-order", "normal", "stroke"];
const STROKED: [&str; 3] = ["shape-rendering", "crispEdges", "geometricPrecision"];

/// The property and value that are handed on for a declaration, or `None` where it says nothing about visibility or place.
pub(super) fn clean_property<'a>(name: &'a str, value: &'a str) -> Option<(&'a str, &'a str)> {
    let value = value.trim();
    let harmless = |c: char| c.is_ascii_alphanumeric() || " .,#%()+-!".contains(c);
    let [property, painted, unpainted] = match name {
        "fill" => FILLED,
        "stroke" => STROKED,
        _ if PROPERTIES.contains(&name) && !value.is_empty() && value.chars().all(harmless) => {
            return Some((name, value));
        }
        _ => return None,
    };
    match value {
        "" | "inherit" => None,
        "none" | "transparent" => Some((property, unpainted)),
        _ => Some((property, painted)),
    }
}

/// The kept declarations of a style attribute or of a rule's body, as `name:value;`.
pub(super) fn clean_declarations(text: &str) -> String {
    let mut clean = String::new();
    for (name, value) in text.split(';').filter_map(|declaration| declaration.split_once(':')) {
        let (value, important) = match value.trim_end().strip_suffix("!important") {
            Some(value) => (value, " !important"),
            None => (value, ""),
        };
        if let Some((name, value)) = clean_property(name.trim(), value) {
            // Writing to a string does not fail.
            let _ = write!(clean, "{name}:{value}{important};");
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
    for_each_whole_rule(sheet, |selector, declarations| {
        let declarations = clean_declarations(declarations);
        if declarations.is_empty() { Ok(()) } else { on_rule(selector, &declarations) }
    })
}

/// The same with all declarations as they are written.
pub(crate) fn for_each_whole_rule<E>(
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
        for selector in selectors.split(',').map(str::trim).filter(|selector| is_simple(selector)) {
            on_rule(selector, declarations)?;
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
        let illustrator =
            "/* a */ @import url(x); .cls-1, .cls-2 { fill: none; stroke-width:10 } #a{display:none}";
        assert_eq!(
            rules(illustrator),
            [".cls-1{paint-order:stroke;}", ".cls-2{paint-order:stroke;}", "#a{display:none;}"]
        );
        let important = "@media print { .a { fill: red } } path.b{stroke:url(#g)!important}";
        assert_eq!(rules(important), ["path.b{shape-rendering:crispEdges !important;}"]);
    }

    #[test]
    fn the_rest_is_left_out() {
        let odd = "a b{fill:red} a>b{fill:red} [x]{fill:red} .a{filter:url(#f)} {} }{ ,{fill:red}";
        assert_eq!(rules(odd), [""; 0]);
        let odd = "fill:inherit;mask:url(#a);stroke:'x';opacity:0;stroke-width:1e30;display:'';transform";
        assert_eq!(clean_declarations(odd), "shape-rendering:crispEdges;opacity:0;");
    }
}
