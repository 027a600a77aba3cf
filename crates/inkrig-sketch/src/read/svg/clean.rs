//! A clean copy of an SVG document: groups, shapes and local references, and nothing else.
//!
//! An SVG may refer to files, repeat itself a billion times through `<use>`, clip paths, masks, markers, patterns and
//! filters, and run a style language. None of this is needed to know what was drawn, so the parser that resolves
//! shapes, units and transforms is handed only what is: elements and attributes from a list. Paint becomes black where it
//! is not a plain colour, references stay inside the document, and what they expand to is counted first.

use std::collections::HashMap;
use std::fmt::Write;

use roxmltree::{Document, Node, NodeId};

use super::guard::too_complex;
use super::style::{clean_declarations, clean_value, for_each_rule, is_kept_property};
use crate::SketchError;
use crate::limits::{MAX_SVG_DEPTH, MAX_SVG_ELEMENTS, MAX_SVG_STYLE_MATCHES, MAX_SVG_TEXT};

const SVG: &str = "http://www.w3.org/2000/svg";
const XLINK: &str = "http://www.w3.org/1999/xlink";

/// Attributes that are copied as they are; those in `style::is_kept_property` are copied when harmless.
const ATTRIBUTES: [&str; 23] = [
    "cx",
    "cy",
    "d",
    "height",
    "points",
    "preserveAspectRatio",
    "r",
    "requiredExtensions",
    "requiredFeatures",
    "rx",
    "ry",
    "systemLanguage",
    "transform",
    "transform-origin",
    "viewBox",
    "width",
    "x",
    "x1",
    "x2",
    "y",
    "y1",
    "y2",
    "overflow",
];

/// Classes of one element that are looked at.
const MAX_CLASSES: usize = 16;

/// The document with nothing in it but what can be drawn.
///
/// # Errors
/// The root is not `<svg>`; a `<use>` contains itself; the drawing is larger than the limits once expanded.
pub(super) fn clean(document: &Document<'_>) -> Result<String, SketchError> {
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
    let cost = Measure { ids: &ids, known: HashMap::new() }.cost(root, 0)?;
    cost.check()?;
    let mut copy = Copy { ids: &ids, out: String::new() };
    copy.style_sheets(root, cost.elements)?;
    copy.element(root);
    Ok(copy.out)
}

/// An error at a node of the document.
pub(super) fn located(node: Node<'_, '_>, problem: String) -> SketchError {
    let place = node.document().text_pos_at(node.range().start);
    SketchError::Svg { line: place.row, column: place.col, problem }
}

type Ids<'a, 'input> = HashMap<&'a str, Node<'a, 'input>>;

#[derive(Debug, PartialEq)]
enum Kind {
    /// Copied with its children, under this name.
    Container(&'static str),
    Shape(&'static str),
    Use,
    /// Copied as an empty element, so that its siblings keep their place.
    Other,
}

fn kind(node: Node<'_, '_>) -> Kind {
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
        "path" => Kind::Shape("path"),
        "rect" => Kind::Shape("rect"),
        "circle" => Kind::Shape("circle"),
        "ellipse" => Kind::Shape("ellipse"),
        "line" => Kind::Shape("line"),
        "polyline" => Kind::Shape("polyline"),
        "polygon" => Kind::Shape("polygon"),
        "use" => Kind::Use,
        _ => Kind::Other,
    }
}

fn is_plain_id(id: &str) -> bool {
    !id.is_empty() && id.chars().all(|c| c.is_alphanumeric() || "-_.:".contains(c))
}

/// What a `<use>` refers to, if it lies in this document.
fn target<'a, 'input>(node: Node<'a, 'input>, ids: &Ids<'a, 'input>) -> Option<Node<'a, 'input>> {
    let href = node.attribute("href").or_else(|| node.attribute((XLINK, "href")))?;
    ids.get(href.trim().strip_prefix('#')?).copied()
}

/// What an element asks for once every `<use>` in it is replaced.
#[derive(Debug, Clone, Copy, Default)]
struct Cost {
    elements: usize,
    bytes: usize,
    depth: usize,
}

impl Cost {
    fn add(&mut self, inner: Self) {
        self.elements = self.elements.saturating_add(inner.elements);
        self.bytes = self.bytes.saturating_add(inner.bytes);
        self.depth = self.depth.max(inner.depth.saturating_add(1));
    }

    fn check(self) -> Result<(), SketchError> {
        if self.elements > MAX_SVG_ELEMENTS {
            return Err(too_complex("too many elements, each <use> expanded", MAX_SVG_ELEMENTS));
        }
        if self.bytes > MAX_SVG_TEXT {
            return Err(too_complex("too many bytes of attributes, each <use> expanded", MAX_SVG_TEXT));
        }
        if self.depth > MAX_SVG_DEPTH { Err(too_deep()) } else { Ok(()) }
    }
}

fn too_deep() -> SketchError {
    too_complex("elements are nested too deeply, each <use> expanded", MAX_SVG_DEPTH)
}

/// Counts before anything is expanded: each element is visited once, its cost kept for every `<use>` of it.
struct Measure<'m, 'a, 'input> {
    ids: &'m Ids<'a, 'input>,
    /// `None` while an element is being counted: meeting it again is a loop.
    known: HashMap<NodeId, Option<Cost>>,
}

impl<'a, 'input> Measure<'_, 'a, 'input> {
    fn cost(&mut self, node: Node<'a, 'input>, depth: usize) -> Result<Cost, SketchError> {
        match self.known.get(&node.id()) {
            Some(Some(cost)) => return Ok(*cost),
            Some(None) => {
                return Err(located(
                    node,
                    format!("<{}> contains itself through <use>", shorten(node.tag_name().name())),
                ));
            }
            None if depth > MAX_SVG_DEPTH => return Err(too_deep()),
            None => {}
        }
        self.known.insert(node.id(), None);
        let bytes = node.attributes().map(|attribute| attribute.value().len()).fold(0, usize::saturating_add);
        let mut cost = Cost { elements: 1, bytes, depth: 1 };
        match kind(node) {
            Kind::Container(_) => {
                for child in node.children().filter(Node::is_element) {
                    cost.add(self.cost(child, depth + 1)?);
                }
            }
            Kind::Use => {
                if let Some(target) = target(node, self.ids) {
                    cost.add(self.cost(target, depth + 1)?);
                }
            }
            Kind::Shape(_) | Kind::Other => {}
        }
        self.known.insert(node.id(), Some(cost));
        Ok(cost)
    }
}

/// Writes the copy. Recursion is bounded: the document was measured first.
struct Copy<'c, 'a, 'input> {
    ids: &'c Ids<'a, 'input>,
    out: String,
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

    fn element(&mut self, node: Node<'a, 'input>) {
        let (name, is_container) = match kind(node) {
            Kind::Container(name) => (name, true),
            Kind::Shape(name) => (name, false),
            Kind::Use => ("use", false),
            Kind::Other => {
                self.out.push_str("<desc/>");
                return;
            }
        };
        let is_root = node.parent_element().is_none();
        let sheet = if is_root { std::mem::take(&mut self.out) } else { String::new() };
        let _ = write!(self.out, "<{name}");
        if is_root {
            let _ = write!(self.out, " xmlns=\"{SVG}\"");
        }
        self.attributes(node, name);
        self.out.push('>');
        if !sheet.is_empty() {
            let _ = write!(self.out, "<style>{sheet}</style>");
        }
        if is_container {
            for child in node.children().filter(Node::is_element) {
                self.element(child);
            }
        }
        let _ = write!(self.out, "</{name}>");
    }

    fn attributes(&mut self, node: Node<'a, 'input>, name: &str) {
        for attribute in node.attributes().filter(|attribute| attribute.namespace().is_none()) {
            let (key, value) = (attribute.name(), attribute.value());
            if key == "id" {
                // The first of its name keeps it, as references are resolved.
                if self.ids.get(value).is_some_and(|first| *first == node) {
                    self.attribute(key, value);
                }
            } else if key == "style" {
                self.attribute(key, &clean_declarations(value));
            } else if key == "class" {
                let classes: Vec<&str> = value.split_ascii_whitespace().take(MAX_CLASSES).collect();
                self.attribute(key, &classes.join(" "));
            } else if ATTRIBUTES.contains(&key) {
                self.attribute(key, value);
            } else if is_kept_property(key)
                && let Some(value) = clean_value(key, value)
            {
                self.attribute(key, value);
            }
        }
        if name == "use"
            && let Some(id) = target(node, self.ids).and_then(|target| target.attribute("id"))
        {
            self.attribute("href", &format!("#{id}"));
        }
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

/// A name from the file, short enough for a message.
fn shorten(name: &str) -> String {
    name.chars().take(40).collect()
}
