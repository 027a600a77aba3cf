//! A look at SVG text before any XML parser sees it: what would make the parser itself slow or hungry.

use std::collections::HashSet;

use crate::SketchError;
use crate::limits::{
    MAX_SVG_ATTRIBUTES, MAX_SVG_ELEMENT_ATTRIBUTES, MAX_SVG_ELEMENTS, MAX_SVG_LOOKUPS, MAX_SVG_TEXT,
};

/// Refuses what an XML parser compares each with each, in too large numbers: attributes of a tag, prefixes of name
/// spaces, entities; and entities that multiply.
///
/// Entities are allowed as long as they hold plain text: drawing programs declare their name spaces with them.
pub(super) fn check_markup(text: &str) -> Result<(), SketchError> {
    check_prefixes(text)?;
    // The parser sets memory aside for each of these signs; an element and the text around it have up to four.
    if text.bytes().filter(|&byte| byte == b'<').count() > 4 * MAX_SVG_ELEMENTS {
        return Err(too_complex("too many elements", MAX_SVG_ELEMENTS));
    }
    if text.bytes().filter(|&byte| byte == b'=').count() > MAX_SVG_ATTRIBUTES {
        return Err(too_complex("too many attributes", MAX_SVG_ATTRIBUTES));
    }
    let mut entities = 0_usize;
    let mut longest_entity = 0;
    let mut rest = text;
    while let Some((_, tag)) = rest.split_once('<') {
        rest = if let Some(comment) = tag.strip_prefix("!--") {
            after(comment, "-->")
        } else if let Some(data) = tag.strip_prefix("![CDATA[") {
            after(data, "]]>")
        } else if let Some(instruction) = tag.strip_prefix('?') {
            after(instruction, "?>")
        } else if let Some(declarations) = tag.strip_prefix("!DOCTYPE") {
            unquoted(declarations, &['[', '>'])?.rest
        } else {
            let is_entity = tag.starts_with("!ENTITY");
            let scan = unquoted(tag, &['>'])?;
            if scan.equal_signs > MAX_SVG_ELEMENT_ATTRIBUTES {
                return Err(too_complex("an element has too many attributes", MAX_SVG_ELEMENT_ATTRIBUTES));
            }
            if is_entity {
                check_entity(text, &scan)?;
                entities += 1;
                longest_entity = longest_entity.max(scan.longest_value.len());
            }
            scan.rest
        };
    }
    // Each reference looks through all entities, and copies one.
    let references = if entities > 0 { text.bytes().filter(|&byte| byte == b'&').count() } else { 0 };
    if references.saturating_mul(entities) > MAX_SVG_LOOKUPS {
        return Err(too_complex("too many references times entities", MAX_SVG_LOOKUPS));
    }
    if references.saturating_mul(longest_entity) > MAX_SVG_TEXT {
        return Err(too_complex("the entities expand to too many bytes", MAX_SVG_TEXT));
    }
    Ok(())
}

/// A parser copies the prefixes in force to each element that declares a name space.
fn check_prefixes(text: &str) -> Result<(), SketchError> {
    let mut distinct = HashSet::new();
    for (declared, after) in text.split("xmlns").skip(1).enumerate() {
        if let Some(prefix) =
            after.strip_prefix(':').and_then(|after| after.split(['=', ' ', '\t', '\n', '\r']).next())
        {
            distinct.insert(prefix);
        }
        if (declared + 1).saturating_mul(distinct.len() + 1) > MAX_SVG_LOOKUPS {
            return Err(too_complex("too many declarations of name spaces times prefixes", MAX_SVG_LOOKUPS));
        }
    }
    Ok(())
}

pub(super) fn too_complex(what: &'static str, limit: usize) -> SketchError {
    SketchError::SvgTooComplex { what, limit }
}

fn after<'a>(text: &'a str, end: &str) -> &'a str {
    text.split_once(end).map_or("", |(_, rest)| rest)
}

/// What a tag holds up to its end.
struct Scan<'a> {
    equal_signs: usize,
    longest_value: &'a str,
    any_value_has_markup: bool,
    rest: &'a str,
}

/// Walks to the first of `ends` outside quotation marks.
fn unquoted<'a>(tag: &'a str, ends: &[char]) -> Result<Scan<'a>, SketchError> {
    let mut scan = Scan { equal_signs: 0, longest_value: "", any_value_has_markup: false, rest: tag };
    loop {
        let stop = |c: char| c == '"' || c == '\'' || c == '=' || ends.contains(&c);
        let Some(at) = scan.rest.find(stop) else {
            scan.rest = "";
            return Ok(scan);
        };
        let mut tail = scan.rest.get(at..).unwrap_or_default().chars();
        let found = tail.next();
        scan.rest = tail.as_str();
        match found {
            Some('=') => scan.equal_signs += 1,
            Some(quote @ ('"' | '\'')) => {
                let (value, rest) = scan.rest.split_once(quote).unwrap_or((scan.rest, ""));
                scan.any_value_has_markup |= value.contains('<') || has_entity_reference(value);
                if value.len() > scan.longest_value.len() {
                    scan.longest_value = value;
                }
                scan.rest = rest;
            }
            _ => return Ok(scan),
        }
    }
}

fn has_entity_reference(value: &str) -> bool {
    value.split('&').skip(1).any(|reference| !reference.starts_with('#'))
}

fn check_entity(text: &str, scan: &Scan<'_>) -> Result<(), SketchError> {
    if !scan.any_value_has_markup {
        return Ok(());
    }
    let before = text.get(..text.len() - scan.rest.len()).unwrap_or_default();
    let line = before.bytes().filter(|&byte| byte == b'\n').count() + 1;
    Err(SketchError::Svg {
        line: u32::try_from(line).unwrap_or(u32::MAX),
        column: 1,
        problem: "an entity holds markup or other entities; save the drawing as plain SVG".into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_documents_pass() {
        for text in [
            "<svg a='1' b=\"2\"><path d='M0 0'/></svg>",
            "<?xml version=\"1.0\"?><!-- a='1' < > --><svg><style><![CDATA[ a=b=c ]]></style></svg>",
            "<!DOCTYPE svg PUBLIC \"-//W3C\" \"http://x/[y]>\" [ <!ENTITY ns \"http://a/\"> ]><svg xmlns=\"&ns;\"/>",
            "not xml at all",
            "<",
            "<a b='",
            "",
        ] {
            assert_eq!(check_markup(text), Ok(()), "{text}");
        }
    }

    #[test]
    fn an_attribute_may_hold_anything() {
        let value = "=".repeat(1000);
        assert_eq!(check_markup(&format!("<svg a='{value}'>{value}</svg>")), Ok(()));
        let attributes = "a=''".repeat(MAX_SVG_ELEMENT_ATTRIBUTES + 1);
        assert!(check_markup(&format!("<svg {attributes}/>")).is_err());
    }
}
