//! What waits to be done, and in which order it is.

use super::{Live, lock};
use crate::document::Document;
use crate::events::{JobKind, JobState, JobStatus};
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How long nothing has to move before the whole result is made.
const REST: Duration = Duration::from_millis(150);
/// Jobs that are remembered.
const MOST_JOBS: usize = 50;

/// The way into the thread.
#[derive(Debug, Default)]
pub(super) struct Inbox {
    pub(super) work: Mutex<Work>,
    pub(super) changed: Condvar,
    /// Something is there that does not wait.
    pub(super) urgent: AtomicBool,
}

#[derive(Debug, Default)]
pub(super) struct Work {
    pub(super) live: Option<Live>,
    /// The newest that was shown is of a stroke that goes on.
    pub(super) pen_is_down: bool,
    /// The document whose whole result is wanted once nothing moves.
    pub(super) settle: Option<(Arc<Document>, u32, Instant)>,
    pub(super) jobs: VecDeque<Job>,
    pub(super) states: VecDeque<JobState>,
    next_job: u64,
    /// Jobs that shall stop.
    pub(super) cancelled: Vec<String>,
    pub(super) current: Option<String>,
    pub(super) stop: bool,
}

#[derive(Debug, Clone)]
pub(super) struct Job {
    pub(super) id: String,
    pub(super) kind: JobKind,
    pub(super) document: Arc<Document>,
    pub(super) revision: u32,
    /// Nobody asked: it follows a change.
    pub(super) automatic: bool,
}

pub(super) enum Task {
    Live(Live),
    Job(Job),
    Stop,
}

impl Inbox {
    pub(super) fn lock(&self) -> MutexGuard<'_, Work> {
        lock(&self.work)
    }

    pub(super) fn wake(&self) {
        self.changed.notify_all();
    }

    /// The next thing to do. Waits for it.
    pub(super) fn next(&self) -> Task {
        let mut work = self.lock();
        loop {
            if work.stop {
                return Task::Stop;
            }
            self.urgent.store(false, Ordering::Release);
            if let Some(live) = work.live.take() {
                return Task::Live(live);
            }
            let mut wait = Duration::from_secs(3600);
            // What is drawn over just now is of no interest.
            if !work.pen_is_down
                && let Some((document, revision, since)) = work.settle.take()
            {
                let rested = since.elapsed();
                if rested >= REST {
                    let state = work.add(JobKind::Solve, document, revision, true);
                    tracing::debug!("result of revision {revision} as {}", state.id);
                } else {
                    wait = REST - rested;
                    work.settle = Some((document, revision, since));
                }
            }
            if let Some(job) = work.jobs.pop_front() {
                work.current = Some(job.id.clone());
                return Task::Job(job);
            }
            work = self.changed.wait_timeout(work, wait).unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

impl Work {
    pub(super) fn add(
        &mut self,
        kind: JobKind,
        document: Arc<Document>,
        revision: u32,
        automatic: bool,
    ) -> JobState {
        self.next_job += 1;
        let id = format!("j{}", self.next_job);
        let state = JobState::new(id.clone(), kind);
        self.states.push_back(state.clone());
        while self.states.len() > MOST_JOBS {
            self.states.pop_front();
        }
        // What was made of an older state is of no use.
        let (jobs, states) = (&mut self.jobs, &mut self.states);
        jobs.retain(|job| {
            let keep = !(automatic && job.automatic);
            if !keep && let Some(state) = states.iter_mut().find(|state| state.id == job.id) {
                state.state = JobStatus::Cancelled;
            }
            keep
        });
        self.jobs.push_back(Job { id, kind, document, revision, automatic });
        state
    }
}
