//! The numbers of objects: the same in every file of the same shape.

/// Each kind of object has a block of numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ids {
    pub(super) joints: usize,
    pub(super) curve_nodes: usize,
}

/// The first number; 0 is the scene's root.
const FIRST: i64 = 1_000_000;

impl Ids {
    pub(super) const ROOT: i64 = 0;
    pub(super) const DOCUMENT: i64 = FIRST;
    pub(super) const STACK: i64 = FIRST + 1;
    pub(super) const LAYER: i64 = FIRST + 2;

    pub(super) fn model(&self, joint: usize) -> i64 {
        Self::LAYER + 1 + joint as i64
    }

    pub(super) fn attribute(&self, joint: usize) -> i64 {
        self.model(self.joints + joint)
    }

    pub(super) fn curve_node(&self, index: usize) -> i64 {
        self.attribute(self.joints + index)
    }

    pub(super) fn mesh(&self) -> i64 {
        self.curve(self.curve_nodes, 0)
    }

    pub(super) fn geometry(&self) -> i64 {
        self.mesh() + 1
    }

    pub(super) fn material(&self) -> i64 {
        self.mesh() + 2
    }

    pub(super) fn skin(&self) -> i64 {
        self.mesh() + 3
    }

    pub(super) fn pose(&self) -> i64 {
        self.mesh() + 4
    }

    pub(super) fn cluster(&self, index: usize) -> i64 {
        self.mesh() + 5 + index as i64
    }

    /// The curve of an axis, 0 to 2.
    pub(super) fn curve(&self, index: usize, axis: usize) -> i64 {
        self.curve_node(self.curve_nodes + 3 * index + axis)
    }
}
