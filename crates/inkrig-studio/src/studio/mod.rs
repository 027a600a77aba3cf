//! The studio itself, without the web: one project, what is loaded, the thread that solves, and who is told.

mod files;
mod strokes;

pub use files::UploadOptions;

use crate::StudioError;
use crate::document::{Command, Document};
use crate::engine::media::Media;
use crate::engine::solver::{Live, Solver};
use crate::events::{Event, Events, JobState};
use crate::project::{HistoryState, Project};
use crate::storyboard::{Boards, Storyboarder};
use files::Uploads;
use serde::Serialize;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;
use strokes::Stroke;
use utoipa::ToSchema;

/// The studio. Everything that returns is on the disk.
#[derive(Debug)]
pub struct Studio {
    project: Mutex<Project>,
    stroke: Mutex<Option<Stroke>>,
    uploads: Mutex<Uploads>,
    /// Clips and sounds.
    pub media: Arc<Media>,
    /// The thread that solves.
    pub solver: Solver,
    /// What makes animations of storyboards.
    pub(crate) boards: Boards,
    /// Who is told.
    pub events: Events,
}

/// A project as the page loads it.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ProjectState {
    /// Rises with every change.
    pub revision: u32,
    /// Everything that can be undone.
    pub document: Document,
    /// What can be undone and redone.
    pub history: HistoryState,
    /// The newest result, if it is of this revision or an earlier one.
    pub result: Option<String>,
    /// The job that runs.
    pub job: Option<JobState>,
}

/// What a change came to.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct Applied {
    /// The new revision.
    pub revision: u32,
    /// What can be undone and redone.
    pub history: HistoryState,
}

impl Studio {
    /// Opens a project. Without a storyboarder storyboards are kept only.
    ///
    /// # Errors
    /// When its folder cannot be used.
    pub fn open(
        folder: &Path,
        threads: usize,
        storyboarder: Option<Arc<dyn Storyboarder>>,
    ) -> Result<Arc<Self>, StudioError> {
        let project = Project::open(folder)?;
        // What was made of a project that was begun anew in the same folder says nothing of this one.
        let known = |id: &str| project.document().clips.iter().any(|clip| clip.id == id);
        let made = project.folder().made().filter(|kept| kept.shown().is_none_or(known));
        let boards = Boards::new(storyboarder, threads, made);
        let (media, events) = (Arc::new(Media::default()), Events::default());
        let solver = Solver::start(project.folder().clone(), media.clone(), events.clone(), threads)?;
        let studio = Self {
            project: Mutex::new(project),
            stroke: Mutex::default(),
            uploads: Mutex::default(),
            media,
            solver,
            boards,
            events,
        };
        let (document, revision) = studio.now();
        studio.solve(document, revision);
        Ok(Arc::new(studio))
    }

    /// The project; held for a moment only.
    pub fn project(&self) -> MutexGuard<'_, Project> {
        lock(&self.project)
    }

    /// The document as it is, and its revision.
    pub fn now(&self) -> (Arc<Document>, u32) {
        let project = self.project();
        (Arc::new(project.document().clone()), project.revision())
    }

    /// Everything that the page needs to begin.
    pub fn state(&self) -> ProjectState {
        let result = self.solver.results().newest();
        let job = self.solver.current_job();
        let project = self.project();
        ProjectState {
            revision: project.revision(),
            document: project.document().clone(),
            history: project.history(),
            result,
            job,
        }
    }

    /// Changes the document as one step.
    ///
    /// # Errors
    /// When a command refers to what is not there; when the folder cannot be written to.
    pub fn commands(
        &self,
        label: &str,
        gesture: Option<&str>,
        commands: Vec<Command>,
    ) -> Result<Applied, StudioError> {
        self.change(label, gesture, |document| {
            commands.into_iter().try_for_each(|command| document.apply(command))
        })
    }

    /// As [`commands`](Self::commands), by code.
    ///
    /// # Errors
    /// What `change` says; when the folder cannot be written to.
    pub fn change(
        &self,
        label: &str,
        gesture: Option<&str>,
        change: impl FnOnce(&mut Document) -> Result<(), StudioError>,
    ) -> Result<Applied, StudioError> {
        let mut project = self.project();
        let before = project.revision();
        project.change(label, gesture, change)?;
        let changed = project.revision() != before;
        Ok(self.tell(project, changed))
    }

    /// Takes the last step back, or takes it again.
    ///
    /// # Errors
    /// When there is none.
    pub fn step(&self, back: bool) -> Result<(), StudioError> {
        let mut project = self.project();
        if back { project.undo() } else { project.redo() }?;
        self.tell(project, true);
        Ok(())
    }

    fn tell(&self, project: MutexGuard<'_, Project>, changed: bool) -> Applied {
        let applied = Applied { revision: project.revision(), history: project.history() };
        if changed {
            let document = Arc::new(project.document().clone());
            drop(project);
            self.media.keep(&document);
            let Applied { revision, history } = applied.clone();
            self.events.send(Event::Project { revision, history });
            self.solve(document, revision);
        }
        applied
    }

    fn solve(&self, document: Arc<Document>, revision: u32) {
        if document.control.is_some() && !document.source.clips.is_empty() {
            self.solver.show(Live {
                document: document.clone(),
                revision,
                stroke: (0, 0),
                arrived: Instant::now(),
            });
            self.solver.settle(document, revision);
        }
    }
}

pub(crate) fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}
