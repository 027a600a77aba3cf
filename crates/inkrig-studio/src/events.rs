//! What the page is told while it waits: changes, progress, results.

use crate::StudioError;
use crate::project::HistoryState;
use inkrig_align::Progress;
use serde::{Deserialize, Serialize};
use tokio::sync::broadcast;
use utoipa::ToSchema;

/// Something that happened.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[serde(tag = "type", rename_all = "camelCase")]
pub enum Event {
    /// The document changed, here or in another window.
    Project {
        /// Its new revision.
        revision: u32,
        /// What can be undone and redone now.
        history: HistoryState,
    },
    /// A job got on.
    Job(JobState),
    /// The current result is new.
    Result {
        /// Its id.
        id: String,
        /// Revision of the document that it is of.
        revision: u32,
        /// The job that was asked for, if one was.
        job: Option<String>,
    },
    /// The document as it is cannot be solved; the next result says that it can be again.
    Problem {
        /// Why.
        message: String,
        /// What to do.
        hint: Option<String>,
    },
}

impl Event {
    /// Why a document cannot be solved.
    pub fn problem(error: &StudioError) -> Self {
        Self::Problem { message: error.to_string(), hint: None }
    }

    /// The name by which a page listens for it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Project { .. } => "project",
            Self::Job(_) => "job",
            Self::Result { .. } => "result",
            Self::Problem { .. } => "problem",
        }
    }
}

/// Where events go.
#[derive(Debug, Clone)]
pub struct Events {
    sender: broadcast::Sender<Event>,
}

impl Default for Events {
    fn default() -> Self {
        Self { sender: broadcast::channel(256).0 }
    }
}

impl Events {
    /// Tells everybody who listens.
    pub fn send(&self, event: Event) {
        let _ = self.sender.send(event);
    }

    /// Listens from now on.
    pub fn listen(&self) -> broadcast::Receiver<Event> {
        self.sender.subscribe()
    }
}

/// What to work on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "camelCase")]
pub enum JobKind {
    /// The result of the document as it is.
    Solve,
    /// Solutions that differ and fit about as well.
    Alternatives {
        /// At most so many, 2 to 8.
        most: usize,
    },
}

/// A job and how far it is.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct JobState {
    /// Its id.
    pub id: String,
    /// What it works on: `solve`, `alternatives` or `storyboard`.
    pub kind: &'static str,
    /// Whether it runs.
    pub state: JobStatus,
    /// Level that is worked on, 1 is the coarsest; of a storyboard the frame, 0 while all are read or joined.
    pub level: usize,
    /// Number of levels, or of frames.
    pub levels: usize,
    /// Gradients done, or steps of a storyboard.
    pub done: usize,
    /// Gradients of all, or steps.
    pub total: usize,
    /// Its result, the first of several; of a storyboard the clip.
    pub result: Option<String>,
    /// All results.
    pub results: Vec<String>,
    /// Why it failed.
    pub error: Option<String>,
}

/// Whether a job runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum JobStatus {
    /// It runs or waits.
    Running,
    /// It has results.
    Done,
    /// It was stopped.
    Cancelled,
    /// It cannot be done.
    Failed,
}

impl JobState {
    pub(crate) fn new(id: String, kind: JobKind) -> Self {
        let kind = match kind {
            JobKind::Solve => "solve",
            JobKind::Alternatives { .. } => "alternatives",
        };
        Self::named(id, kind)
    }

    pub(crate) fn named(id: String, kind: &'static str) -> Self {
        Self {
            id,
            kind,
            state: JobStatus::Running,
            level: 0,
            levels: 0,
            done: 0,
            total: 0,
            result: None,
            results: Vec::new(),
            error: None,
        }
    }

    pub(crate) fn see(&mut self, progress: Progress) {
        (self.level, self.levels) = (progress.level, progress.levels);
        (self.done, self.total) = (progress.done, progress.total);
    }
}
