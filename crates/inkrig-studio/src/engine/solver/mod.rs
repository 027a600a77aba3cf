//! The thread on which the engine works. What a pen asks for comes first, and only its newest state; then, once nothing
//! moves, the whole result; then jobs that were asked for. All of them give way to the pen.

mod inbox;
mod jobs;
mod preview;
mod worker;

use super::media::Media;
use super::results::Results;
use crate::StudioError;
use crate::document::Document;
use crate::events::{Events, JobKind, JobState, JobStatus};
use crate::project::Folder;
use inbox::Inbox;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;
use tokio::sync::watch;
use worker::{Refused, Worker};

/// A document to be seen at once.
#[derive(Debug, Clone)]
pub struct Live {
    /// What it is, strokes that go on included.
    pub document: Arc<Document>,
    /// Its revision.
    pub revision: u32,
    /// Stroke and number of its messages that are in it; 0 for none.
    pub stroke: (u32, u32),
    /// When the newest of it came.
    pub arrived: Instant,
}

/// A message for the page in front of which a pen draws.
#[derive(Debug, Clone)]
pub enum Shown {
    /// Poses.
    Poses(Arc<Vec<u8>>),
    /// There is nothing to see yet, and why; whether more ink will help.
    Not {
        /// Number of the stroke, 0 for none.
        stroke: u32,
        /// Why.
        message: String,
        /// Whether more ink will help.
        waiting: bool,
    },
}

/// The way to the thread. Dropping it ends the thread.
#[derive(Debug)]
pub struct Solver {
    inbox: Arc<Inbox>,
    shown: watch::Receiver<Option<Shown>>,
    results: Arc<Mutex<Results>>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Solver {
    /// Starts the thread.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub fn start(
        folder: Arc<Folder>,
        media: Arc<Media>,
        events: Events,
        threads: usize,
    ) -> Result<Self, StudioError> {
        let inbox = Arc::new(Inbox::default());
        let results = Arc::new(Mutex::new(Results::default()));
        let (sender, shown) = watch::channel(None);
        let worker = Worker {
            inbox: inbox.clone(),
            folder,
            media,
            events,
            threads,
            shown: sender,
            results: results.clone(),
            source: None,
            live: None,
            refused: Refused::default(),
        };
        let spawned = std::thread::Builder::new().name("solver".into()).spawn(move || worker.run());
        let thread = spawned.map_err(|cause| StudioError::Internal(cause.to_string()))?;
        Ok(Self { inbox, shown, results, thread: Some(thread) })
    }

    /// Shows a document; a newer one takes its place.
    pub fn show(&self, live: Live) {
        let mut work = self.inbox.lock();
        work.pen_is_down = live.stroke.0 > 0;
        work.live = Some(live);
        // With the lock held: later it might be taken for something newer than this.
        self.inbox.urgent.store(true, Ordering::Release);
        drop(work);
        self.inbox.wake();
    }

    /// Makes the whole result of a document once nothing moves.
    pub fn settle(&self, document: Arc<Document>, revision: u32) {
        self.inbox.lock().settle = Some((document, revision, Instant::now()));
        self.inbox.wake();
    }

    /// Begins a job.
    pub fn begin(&self, kind: JobKind, document: Arc<Document>, revision: u32) -> JobState {
        let state = self.inbox.lock().add(kind, document, revision, false);
        self.inbox.wake();
        state
    }

    /// The state of a job.
    pub fn job(&self, id: &str) -> Option<JobState> {
        self.inbox.lock().states.iter().find(|state| state.id == id).cloned()
    }

    /// The job that runs.
    pub fn current_job(&self) -> Option<JobState> {
        let work = self.inbox.lock();
        work.states.iter().rev().find(|state| state.state == JobStatus::Running).cloned()
    }

    /// Stops a job; `None` when there is none.
    pub fn cancel(&self, id: &str) -> Option<JobState> {
        let mut work = self.inbox.lock();
        let state = work.states.iter_mut().find(|state| state.id == id)?;
        if state.state == JobStatus::Running {
            state.state = JobStatus::Cancelled;
        }
        let state = state.clone();
        work.jobs.retain(|job| job.id != id);
        if work.current.as_deref() == Some(id) {
            work.cancelled.push(id.to_string());
        }
        drop(work);
        self.inbox.wake();
        Some(state)
    }

    /// What is shown; the newest only.
    pub fn shown(&self) -> watch::Receiver<Option<Shown>> {
        self.shown.clone()
    }

    /// The results.
    pub fn results(&self) -> MutexGuard<'_, Results> {
        lock(&self.results)
    }
}

impl Drop for Solver {
    fn drop(&mut self) {
        let mut work = self.inbox.lock();
        work.stop = true;
        self.inbox.urgent.store(true, Ordering::Release);
        drop(work);
        self.inbox.wake();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}
