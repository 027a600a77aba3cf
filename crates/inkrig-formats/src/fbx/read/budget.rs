//! How much memory a file may take: 16 bytes for each of its bytes and 64 MiB, whatever it says and unpacks to.

use super::{Span, Stack};
use crate::{FormatError, Limits, figure::Figure};
use ufbx::Scene;

/// What any file may take, bytes.
const FLOOR: usize = 64 << 20;

/// What a byte of the file may become, bytes.
const TIMES: usize = 16;

/// A node's places, names and turns beside what `ufbx` keeps of it, bytes, generously.
const NODE: usize = 1200;

/// A rotation and a translation, bytes.
const CELL: usize = 28;

/// Bytes that may be taken, and those that are.
#[derive(Debug)]
pub(super) struct Budget {
    all: usize,
    taken: usize,
}

impl Budget {
    pub(super) fn of(bytes: usize) -> Self {
        Self { all: bytes.saturating_mul(TIMES).saturating_add(FLOOR), taken: 0 }
    }

    /// For what `ufbx` keeps.
    pub(super) fn scene_bytes(&self) -> usize {
        self.all / 2
    }

    /// For what `ufbx` needs on the way.
    pub(super) fn working_bytes(&self) -> usize {
        self.all / 8 * 3
    }

    /// Single pieces of memory; `ufbx` takes few and large ones.
    pub(super) fn pieces(&self) -> usize {
        10_000 + self.all / 4096
    }

    /// Counts a scene that was read, and what is made of its nodes.
    pub(super) fn take_scene(&mut self, scene: &Scene) {
        // A time of each key may be sorted; a key is 40 bytes in the scene.
        let scene_bytes = scene.metadata.result_memory_used;
        self.taken = scene_bytes + scene_bytes / 5 + scene.nodes.count.saturating_mul(NODE);
    }

    /// Frames times joints that a clip may have.
    pub(super) fn cells(&self, limits: &Limits) -> usize {
        limits.cells.min(self.all.saturating_sub(self.taken) / CELL)
    }

    /// The number of frames, when they are not too many.
    pub(super) fn frames(
        &self,
        span: &Span,
        stack: &Stack<'_>,
        figure: &Figure,
        limits: &Limits,
    ) -> Result<usize, FormatError> {
        // Nodes above joints are work as well, and each layer of each moving one.
        let work = figure.chain.len() + stack.moving.len() * stack.layers();
        let work = work.max(figure.joints.len());
        let cells = span.frames * work as f64;
        let limit = self.cells(limits);
        if cells <= limit as f64 {
            return Ok(span.frames as usize);
        }
        Err(FormatError::Limit {
            what: format!("{} frames of {work} nodes and layers make {cells} places", span.frames),
            limit,
            place: None,
            hint: "cut the motion into shorter ones, or read it at a lower rate with `--source-fps`".into(),
        })
    }
}
