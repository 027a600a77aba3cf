//! Curves in SVG.
//!
//! The text is looked over ([`guard`]), parsed as XML under limits, copied down to what can be drawn ([`clean`],
//! [`style`]), resolved by usvg (units, view boxes, `<use>`, transforms, visibility) and flattened ([`flatten`]).

mod clean;
mod flatten;
mod guard;
mod style;

use roxmltree::{Document, Node, ParsingOptions};

use self::guard::too_complex;
use crate::limits::{MAX_MAGNITUDE, MAX_SVG_ELEMENTS};
use crate::{Curve, SketchError};

pub(super) fn read(text: &str) -> Result<Curve, SketchError> {
    guard::check_markup(text)?;
    // Text between elements makes nodes too, hence the factor.
    let nodes_limit = u32::try_from(4 * MAX_SVG_ELEMENTS).unwrap_or(u32::MAX);
    let options = ParsingOptions { allow_dtd: true, nodes_limit, entity_resolver: None };
    let document = Document::parse_with_options(text, options).map_err(|error| match error {
        roxmltree::Error::NodesLimitReached => too_complex("too many elements", MAX_SVG_ELEMENTS),
        error => {
            let (place, message) = (error.pos(), error.to_string());
            let problem = message.rsplit_once(" at ").map_or(message.as_str(), |(problem, _)| problem);
            SketchError::Svg { line: place.row, column: place.col, problem: problem.to_owned() }
        }
    })?;
    for node in document.descendants() {
        for name in ["d", "points"] {
            if let Some(data) = node.attribute(name) {
                check_path_data(node, name, data)?;
            }
        }
    }
    let clean = clean::clean(&document)?;
    let tree = usvg::Tree::from_str(&clean, &offline()).map_err(|error| {
        let problem = match error {
            usvg::Error::InvalidSize => "width, height or viewBox of the drawing is not positive".to_owned(),
            error => error.to_string(),
        };
        clean::located(document.root_element(), problem)
    })?;
    flatten::flatten(tree.root())
}

/// No file, address or data is followed, whatever the drawing says. The clean copy holds no image; this is the second bolt.
fn offline() -> usvg::Options<'static> {
    usvg::Options {
        resources_dir: None,
        image_href_resolver: usvg::ImageHrefResolver {
            resolve_data: Box::new(|_, _, _| None),
            resolve_string: Box::new(|_, _| None),
        },
        ..usvg::Options::default()
    }
}

/// Path data is drawn up to its first mistake; characters that are never part of it, and numbers without sense, are
/// told instead of drawn.
fn check_path_data(node: Node<'_, '_>, name: &str, data: &str) -> Result<(), SketchError> {
    let is_number = |c: char| c.is_ascii_digit() || ".+-eE".contains(c);
    if let Some(odd) =
        data.chars().find(|&c| !is_number(c) && !"MmZzLlHhVvCcSsQqTtAa, \t\n\r\x0C".contains(c))
    {
        return Err(clean::located(node, format!("{name} holds {odd:?}, which is not part of a path")));
    }
    for token in data.split(|c| !is_number(c)).filter(|token| token.contains(['e', 'E']) || token.len() > 15)
    {
        // "1e5-3" is two numbers: signs begin one unless they follow an e.
        let mut previous = ' ';
        let starts_number = |c: char| {
            let starts = (c == '-' || c == '+') && !matches!(previous, 'e' | 'E');
            previous = c;
            starts
        };
        for number in token.split(starts_number) {
            if number.parse::<f64>().is_ok_and(|value| value.is_nan() || value.abs() > MAX_MAGNITUDE) {
                let shown: String = number.chars().take(40).collect();
                return Err(clean::located(
                    node,
                    format!("{name} holds the number {shown}; at most {MAX_MAGNITUDE:e} is read"),
                ));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn svg(body: &str) -> Result<Curve, SketchError> {
        read(&format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'>{body}</svg>"))
    }

    #[test]
    fn y_is_turned_up_and_transforms_apply() {
        let curve =
            svg("<g transform='translate(10 0)'><path transform='scale(2)' d='M0 0 L5 10'/></g>").unwrap();
        assert_eq!(curve.points(), [[10.0, 0.0], [20.0, -20.0]]);
        assert_eq!(curve.origin(), crate::Origin::Outline);
    }
}
