//! Steps back and forth. Which there are stands in `project.json`; what each changes, in a file of its own.

use crate::document::Part;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Steps that are kept.
pub(super) const MOST_STEPS: usize = 200;

#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct History {
    /// Oldest first.
    pub(super) undo: Vec<Step>,
    /// The next to take again last.
    pub(super) redo: Vec<Step>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Step {
    pub(super) id: String,
    pub(super) label: String,
    /// What goes on in the same gesture is the same step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) gesture: Option<String>,
}

/// The parts as they are on the other side of a step.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Entry {
    pub(super) parts: Vec<Part>,
}

/// What can be undone and redone, by name; the next is the last.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct HistoryState {
    /// Names of steps that can be undone.
    pub undo: Vec<String>,
    /// Names of steps that can be redone.
    pub redo: Vec<String>,
}

impl History {
    pub(super) fn state(&self) -> HistoryState {
        let labels = |steps: &[Step]| steps.iter().map(|step| step.label.clone()).collect();
        HistoryState { undo: labels(&self.undo), redo: labels(&self.redo) }
    }
}

/// The file of a step.
pub(super) fn file(id: &str) -> String {
    format!("history/{id}.json")
}
