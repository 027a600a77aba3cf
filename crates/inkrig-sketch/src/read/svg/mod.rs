//! Curves in SVG.
//!
//! The text is looked over ([`guard`]), parsed as XML under limits, counted ([`expansion`]) and copied down to what can
//! be drawn ([`clean`], [`style`], [`path_data`]), resolved by usvg (units, view boxes, `<use>`, transforms, visibility) and flattened
//! ([`flatten`]).

mod clean;
mod expansion;
mod flatten;
mod guard;
mod path_data;
pub(crate) mod style;

use roxmltree::{Document, Node, ParsingOptions};

use self::guard::too_complex;
use crate::limits::MAX_SVG_ELEMENTS;
use crate::{Curve, SketchError};

pub(super) fn read(text: &str) -> Result<Curve, SketchError> {
    Ok(strokes(&parse(text)?, &|_| 0)?.0)
}

/// The document, under limits.
pub(crate) fn parse(text: &str) -> Result<Document<'_>, SketchError> {
    guard::check_markup(text)?;
    // Text between elements makes nodes too, hence the factor.
    let nodes_limit = u32::try_from(4 * MAX_SVG_ELEMENTS).unwrap_or(u32::MAX);
    let options = ParsingOptions { allow_dtd: true, nodes_limit, entity_resolver: None };
    Document::parse_with_options(text, options).map_err(|error| match error {
        roxmltree::Error::NodesLimitReached => too_complex("too many elements", MAX_SVG_ELEMENTS),
        error => {
            let (place, message) = (error.pos(), error.to_string());
            let problem = message.rsplit_once(" at ").map_or(message.as_str(), |(problem, _)| problem);
            SketchError::Svg { line: place.row, column: place.col, problem: problem.to_owned() }
        }
    })
}

/// All visible strokes, and the tag of the element that each was drawn by: at most 24 bits.
pub(crate) fn strokes(
    document: &Document<'_>,
    tag: &dyn Fn(Node<'_, '_>) -> u32,
) -> Result<(Curve, Vec<u32>), SketchError> {
    let clean = clean::clean(document, tag)?;
    let tree = usvg::Tree::from_str(&clean.text, &offline()).map_err(|error| {
        let problem = match error {
            usvg::Error::InvalidSize => "width, height or viewBox of the drawing is not positive".to_owned(),
            error => error.to_string(),
        };
        clean::located(document.root_element(), problem)
    })?;
    flatten::flatten(tree.root(), &clean.paths)
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
