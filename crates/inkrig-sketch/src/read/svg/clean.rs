//! A clean copy of an SVG document: groups, shapes and local references, and nothing else.
//!
//! An SVG may refer to files, repeat itself a billion times through `<use>`, clip paths, masks, markers, patterns and
//! filters, and run a style language. None of this is needed to know what was drawn, so the parser that resolves units,
//! transforms and visibility is handed only what is: elements and attributes from a list. Path data is read here and
//! stands in the copy as a number, references stay inside the document, and what they expand to is counted first.

use std::collections::HashMap;
use std::fmt::Write;

use kurbo::PathEl;
use roxmltree::{Document, Node};

use super::expansion::Measure;
use super::guard::too_complex;
use super::path_data::{Fault, parse_path, parse_points};
use super::style::{clean_declarations, clean_property, for_each_rule};
use crate::SketchError;
use crate::limits::{MAX_POINTS, MAX_SVG_STYLE_MATCHES, MAX_SVG_TEXT};

const SVG: &str = "http://www.w3.org/2000/svg";
const XLINK: &str = "http://www.w3.org/1999/xlink";

/// Attributes that are copied as they are; presentation attributes go through [`clean_property`].
const ATTRIBUTES: [&str; 4] =
    ["preserveAspectRatio", "requiredExtensions", "requiredFeatures", "systemLanguage"];
/// Attributes that hold lengths.
const LENGTHS: [&str; 14] =
    ["cx", "cy", "height", "r", "rx", "ry", "viewBox", "width", "x", "x1", "x2", "y", "y1", "y2"];
/// Largest length, in its own unit, and largest percentage.
const MAX_LENGTH: f64 = 1e9;
const MAX_PERCENT: f64 = 100.0;

/// Classes of one element that are looked at.
const MAX_CLASSES: usize = 16;

/// The document with nothing in it but what can be drawn, and the path data that it stands for.
pub(super) struct Clean {
    /// An SVG document whose path number n is [`placeholder`] n.
    pub(super) text: String,
    pub(super) paths: Vec<Vec<PathEl>>,
}

/// Path data that stands for path number n: three points, the first at x = n. No shape of SVG makes such an outline.
fn placeholder(number: usize) -> String {
    format!("M{number} 0L{number} 1L{number} 2")
}

/// Makes the clean copy. Shapes carry what `tag` says of them as the colour of their fill, which has no other meaning in the
/// copy; 0 leaves it out.
///
/// # Errors
/// The root is not `<svg>`; a `<use>` contains itself; path data is wrong; the drawing is larger than the limits once
/// expanded.
pub(super) fn clean(
    document: &Document<'_>,
    tag: &dyn Fn(Node<'_, '_>) -> u32,
) -> Result<Clean, SketchError> {
    let root = document.root_element();
    if kind(root) != Kind::Container("svg") {
        let problem = format!("the root element is <{}>, not <svg>", shorten(root.tag_name().name()));
        return Err(located(root, problem));
    }
    let mut ids = HashMap::new();
    for node in root.descendants() {
        if let Some(id) = node.attribute("id").filter(|id| is_plain_id(id)) {
            ids.entry(id).or_insert(node);
        }
    }
    let cost = Measure::new(&ids).cost(root, 0)?;
    cost.check()?;
    let mut copy = Copy { ids: &ids, out: String::new(), paths: Vec::new(), room: MAX_POINTS, tag };
    copy.style_sheets(root, cost.elements)?;
    copy.element(root)?;
    Ok(Clean { text: copy.out, paths: copy.paths })
}

/// An error at a node of the document.
pub(super) fn located(node: Node<'_, '_>, problem: String) -> SketchError {
    let place = node.document().text_pos_at(node.range().start);
    SketchError::Svg { line: place.row, column: place.col, problem }
}

pub(super) type Ids<'a, 'input> = HashMap<&'a str, Node<'a, 'input>>;

#[derive(Debug, PartialEq)]
pub(super) enum Kind {
    /// Copied with its children, under this name.
    Container(&'static str),
    Shape(&'static str),
    /// A path, polyline or polygon: copied as a placeholder.
    Path,
    Use,
    /// Copied as an empty element, so that its siblings keep their place.
    Other,
}

pub(super) fn kind(node: Node<'_, '_>) -> Kind {
    if !node.is_element() || !matches!(node.tag_name().namespace(), None | Some(SVG)) {
        return Kind::Other;
    }
    match node.tag_name().name() {
        "svg" => Kind::Container("svg"),
        "g" | "a" => Kind::Container("g"),
        "switch" => Kind::Container("switch"),
        "symbol" => Kind::Container("symbol"),
        // Never drawn where they stand; what is inside may be referred to.
        "defs" | "clipPath" | "mask" | "marker" | "pattern" => Kind::Container("defs"),
        "path" | "polyline" | "polygon" => Kind::Path,
        "rect" => Kind::Shape("rect"),
        "circle" => Kind::Shape("circle"),
        "ellipse" => Kind::Shape("ellipse"),
        "line" => Kind::Shape("line"),
        "use" => Kind::Use,
        _ => Kind::Other,
    }
}

fn is_plain_id(id: &str) -> bool {
    !id.is_empty() && id.chars().all(|c| c.is_alphanumeric() || "-_.:".contains(c))
}

/// What a `<use>` refers to, if it lies in this document.
pub(super) fn target<'a, 'input>(node: Node<'a, 'input>, ids: &Ids<'a, 'input>) -> Option<Node<'a, 'input>> {
    let href = node.attribute("href").or_else(|| node.attribute((XLINK, "href")))?;
    ids.get(href.trim().strip_prefix('#')?).copied()
}

/// Writes the copy. Recursion is bounded: the document was measured first.
struct Copy<'c, 'a, 'input> {
    ids: &'c Ids<'a, 'input>,
    out: String,
    paths: Vec<Vec<PathEl>>,
    room: usize,
    tag: &'c dyn Fn(Node<'_, '_>) -> u32,
}

impl<'a, 'input> Copy<'_, 'a, 'input> {
    fn style_sheets(&mut self, root: Node<'a, 'input>, elements: usize) -> Result<(), SketchError> {
        let mut rules = 0_usize;
        let mut sheet = String::new();
        for style in
            root.descendants().filter(|node| node.has_tag_name("style") || node.has_tag_name((SVG, "style")))
        {
            for_each_rule(style.text().unwrap_or_default(), |selector, declarations| {
                rules += 1;
                let _ = writeln!(sheet, "{selector}{{{declarations}}}");
                if rules.saturating_mul(elements) > MAX_SVG_STYLE_MATCHES || sheet.len() > MAX_SVG_TEXT {
                    Err(too_complex("too many style rules times elements", MAX_SVG_STYLE_MATCHES))
                } else {
                    Ok(())
                }
            })?;
        }
        self.out = sheet;
        Ok(())
    }

    fn element(&mut self, node: Node<'a, 'input>) -> Result<(), SketchError> {
        let (name, is_container) = match kind(node) {
            Kind::Container(name) => (name, true),
            Kind::Shape(name) => (name, false),
            Kind::Path => ("path", false),
            Kind::Use => ("use", false),
            Kind::Other => {
                self.out.push_str("<desc/>");
                return Ok(());
            }
        };
        let is_root = node.parent_element().is_none();
        let sheet = if is_root { std::mem::take(&mut self.out) } else { String::new() };
        let _ = write!(self.out, "<{name}");
        if is_root {
            let _ = write!(self.out, " xmlns=\"{SVG}\"");
        }
        self.attributes(node)?;
        if matches!(kind(node), Kind::Path | Kind::Shape(_)) {
            let tag = (self.tag)(node);
            if tag > 0 {
                self.attribute("fill", &format!("#{:06x}", tag & 0xFF_FFFF));
            }
        }
        match kind(node) {
            Kind::Path => self.path(node)?,
            Kind::Use => {
                if let Some(id) = target(node, self.ids).and_then(|target| target.attribute("id")) {
                    self.attribute("href", &format!("#{id}"));
                }
            }
            _ => {}
        }
        self.out.push('>');
        if !sheet.is_empty() {
            let _ = write!(self.out, "<style>{sheet}</style>");
        }
        if is_container {
            for child in node.children().filter(Node::is_element) {
                self.element(child)?;
            }
        }
        let _ = write!(self.out, "</{name}>");
        Ok(())
    }

    fn path(&mut self, node: Node<'a, 'input>) -> Result<(), SketchError> {
        let element = node.tag_name().name();
        let name = if element == "path" { "d" } else { "points" };
        let data = node.attribute(name).filter(|data| data.trim() != "none").unwrap_or_default();
        let path = match element {
            "path" => parse_path(data, &mut self.room),
            _ => parse_points(data, element == "polygon", &mut self.room),
        };
        let path = path.map_err(|fault| match fault {
            Fault::Full => SketchError::TooManyPoints,
            Fault::Wrong(problem) => located(node, format!("{name} of <{element}>, {problem}")),
        })?;
        if !path.is_empty() {
            self.attribute("d", &placeholder(self.paths.len()));
            self.paths.push(path);
        }
        Ok(())
    }

    fn attributes(&mut self, node: Node<'a, 'input>) -> Result<(), SketchError> {
        for attribute in node.attributes().filter(|attribute| attribute.namespace().is_none()) {
            let (key, value) = (attribute.name(), attribute.value());
            if key == "id" {
                // The first of its name keeps it, as references are resolved.
                if self.ids.get(value).is_some_and(|first| *first == node) {
                    self.attribute(key, value);
                }
            } else if key == "class" {
                let classes: Vec<&str> = value.split_ascii_whitespace().take(MAX_CLASSES).collect();
                self.attribute(key, &classes.join(" "));
            } else if key == "style" {
                self.attribute(key, &clean_declarations(value));
            } else if LENGTHS.contains(&key) {
                check_lengths(value).map_err(|problem| located(node, format!("{key} {problem}")))?;
                self.attribute(key, value);
            } else if ATTRIBUTES.contains(&key) {
                self.attribute(key, value);
            } else if let Some((key, value)) = clean_property(key, value) {
                self.attribute(key, value);
            }
        }
        Ok(())
    }

    fn attribute(&mut self, name: &str, value: &str) {
        let _ = write!(self.out, " {name}=\"");
        for character in value.chars() {
            match character {
                '&' => self.out.push_str("&amp;"),
                '<' => self.out.push_str("&lt;"),
                '"' => self.out.push_str("&quot;"),
                '\n' | '\t' | '\r' => self.out.push(' '),
                other => self.out.push(other),
            }
        }
        self.out.push('"');
    }
}

/// Lengths far beyond any drawing make outlines of too many pieces.
fn check_lengths(value: &str) -> Result<(), String> {
    for length in value.split([' ', ',', '\t', '\n', '\r']).filter(|length| !length.is_empty()) {
        let number = length.trim_end_matches(|c: char| c.is_ascii_alphabetic() || c == '%');
        let limit = if length.ends_with('%') { MAX_PERCENT } else { MAX_LENGTH };
        // What is no number is ignored, as SVG asks for.
        if number.parse::<f64>().is_ok_and(|number| number.is_nan() || number.abs() > limit) {
            return Err(format!("is {}; at most {MAX_LENGTH:e} or {MAX_PERCENT}% is read", shorten(length)));
        }
    }
    Ok(())
}

/// A name from the file, short enough for a message.
pub(super) fn shorten(name: &str) -> String {
    name.chars().take(40).collect()
}
