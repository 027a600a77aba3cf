//! What an SVG document becomes once every `<use>` is replaced, counted before anything is.

use std::collections::HashMap;

use roxmltree::{Node, NodeId};

use super::clean::{Ids, Kind, kind, located, shorten, target};
use super::guard::too_complex;
use crate::SketchError;
use crate::limits::{MAX_SVG_DEPTH, MAX_SVG_ELEMENTS, MAX_SVG_TEXT};

/// What an element asks for once every `<use>` in it is replaced.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Cost {
    pub(super) elements: usize,
    bytes: usize,
    depth: usize,
}

impl Cost {
    fn add(&mut self, inner: Self) {
        self.elements = self.elements.saturating_add(inner.elements);
        self.bytes = self.bytes.saturating_add(inner.bytes);
        self.depth = self.depth.max(inner.depth.saturating_add(1));
    }

    pub(super) fn check(self) -> Result<(), SketchError> {
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
pub(super) struct Measure<'m, 'a, 'input> {
    ids: &'m Ids<'a, 'input>,
    /// `None` while an element is being counted: meeting it again is a loop.
    known: HashMap<NodeId, Option<Cost>>,
}

impl<'m, 'a, 'input> Measure<'m, 'a, 'input> {
    pub(super) fn new(ids: &'m Ids<'a, 'input>) -> Self {
        Self { ids, known: HashMap::new() }
    }

    pub(super) fn cost(&mut self, node: Node<'a, 'input>, depth: usize) -> Result<Cost, SketchError> {
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
            Kind::Shape(_) | Kind::Path | Kind::Other => {}
        }
        self.known.insert(node.id(), Some(cost));
        Ok(cost)
    }
}
