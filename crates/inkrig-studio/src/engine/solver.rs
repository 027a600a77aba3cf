//! The thread on which the engine works. What a pen asks for comes first, and only its newest state; then, once nothing
//! moves, the whole result; then jobs that were asked for. All of them give way to the pen.

use super::media::Media;
use super::poses::{PoseHead, PoseKind, encode};
use super::results::{Finished, Origin, Results};
use super::{Prepared, SourceKey, over_ground};
use crate::StudioError;
use crate::document::Document;
use crate::events::{Event, Events, JobKind, JobState, JobStatus};
use crate::project::Folder;
use inkrig_align::{
    AlignError, Alternative, LiveAlignment, LiveAnswer, LiveEvent, Options, Progress, align, alternatives,
};
use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// How long nothing has to move before the whole result is made.
const REST: Duration = Duration::from_millis(150);
/// How long newer ink waits for the finer answers to what came before it.
const PATIENCE: Duration = Duration::from_millis(25);
/// Between two reports of progress.
const TELL: Duration = Duration::from_millis(50);
/// Jobs that are remembered.
const MOST_JOBS: usize = 50;

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

#[derive(Debug)]
struct Inbox {
    work: Mutex<Work>,
    changed: Condvar,
    /// Something is there that does not wait.
    urgent: AtomicBool,
}

#[derive(Debug, Default)]
struct Work {
    live: Option<Live>,
    /// The newest that was shown is of a stroke that goes on.
    pen_is_down: bool,
    /// The document whose whole result is wanted once nothing moves.
    settle: Option<(Arc<Document>, u32, Instant)>,
    jobs: VecDeque<Job>,
    states: VecDeque<JobState>,
    next_job: u64,
    /// Jobs that shall stop.
    cancelled: Vec<String>,
    current: Option<String>,
    stop: bool,
}

#[derive(Debug, Clone)]
struct Job {
    id: String,
    kind: JobKind,
    document: Arc<Document>,
    revision: u32,
    /// Nobody asked: it follows a change.
    automatic: bool,
}

enum Task {
    Live(Live),
    Job(Job),
    Stop,
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
        let inbox = Arc::new(Inbox {
            work: Mutex::default(),
            changed: Condvar::new(),
            urgent: AtomicBool::new(false),
        });
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

impl Inbox {
    fn lock(&self) -> MutexGuard<'_, Work> {
        lock(&self.work)
    }

    fn wake(&self) {
        self.changed.notify_all();
    }

    /// The next thing to do. Waits for it.
    fn next(&self) -> Task {
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
    fn add(&mut self, kind: JobKind, document: Arc<Document>, revision: u32, automatic: bool) -> JobState {
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

/// What the thread keeps.
struct Worker {
    inbox: Arc<Inbox>,
    folder: Arc<Folder>,
    media: Arc<Media>,
    events: Events,
    threads: usize,
    shown: watch::Sender<Option<Shown>>,
    results: Arc<Mutex<Results>>,
    source: Option<(SourceKey, Prepared)>,
    live: Option<Ready>,
}

/// A clip that is ready to follow.
struct Ready {
    source: SourceKey,
    alignment: LiveAlignment,
    /// For every matched frame the frame counted through all clips.
    counted: Vec<u32>,
}

impl Worker {
    fn run(mut self) {
        loop {
            match self.inbox.next() {
                Task::Stop => return,
                Task::Live(live) => self.show(&live),
                Task::Job(job) => self.work(job),
            }
        }
    }

    fn show(&mut self, live: &Live) {
        let waiting = |error: &StudioError| {
            live.stroke.0 > 0
                && matches!(
                    error,
                    StudioError::Align(AlignError::ControlTooShort { .. } | AlignError::StillControl)
                        | StudioError::Align(AlignError::Sketch(_))
                        | StudioError::Sketch(_)
                )
        };
        match self.update(live) {
            Ok(()) | Err(StudioError::Align(AlignError::Cancelled)) => {}
            Err(error) => {
                let not = Shown::Not {
                    stroke: live.stroke.0,
                    message: error.to_string(),
                    waiting: waiting(&error),
                };
                self.shown.send_replace(Some(not));
            }
        }
    }

    fn update(&mut self, live: &Live) -> Result<(), StudioError> {
        let document = &live.document;
        let prepared = self.prepared(document)?;
        let (control, mut options) = prepared.wishes(document, &self.folder, &self.media)?;
        options.threads = self.threads;
        let key = SourceKey::of(document);
        let known = self.live.take().and_then(|mut ready| {
            (ready.source == key && ready.alignment.set_options(&options)).then_some(ready)
        });
        let ready = match known {
            Some(ready) => ready,
            None => {
                let alignment = LiveAlignment::new(&prepared.takes, &options)?;
                let counted = |frame| prepared.map.counted_through(frame).unwrap_or(0) as u32;
                let counted = alignment.moments().iter().map(|moment| counted(moment.frame)).collect();
                Ready { source: key, alignment, counted }
            }
        };
        let Ready { alignment, counted, .. } = self.live.insert(ready);
        let (inbox, shown) = (&self.inbox, &self.shown);
        let mut failed = None;
        let (mut told, begun) = (false, Instant::now());
        let done = alignment.update(&control, &mut |event| {
            match event {
                LiveEvent::Step(_) => {}
                LiveEvent::Answer(answer) => {
                    told = true;
                    match answer_bytes(*answer, live, counted, options.matching_rate) {
                        Ok(bytes) => {
                            shown.send_replace(Some(Shown::Poses(Arc::new(bytes))));
                        }
                        Err(error) => failed = Some(error),
                    }
                }
            }
            // Ink that never gets an answer would stand still under the pen, and coarse ones alone look like nothing.
            let late = begun.elapsed() >= PATIENCE;
            if told && late && inbox.urgent.load(Ordering::Acquire) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        if let Some(error) = failed {
            return Err(error);
        }
        match done {
            Ok(()) => Ok(()),
            Err(AlignError::Cancelled) => Err(AlignError::Cancelled.into()),
            Err(error) => {
                // What it kept is of a control that it could not take.
                alignment.forget();
                Err(error.into())
            }
        }
    }

    fn prepared(&mut self, document: &Document) -> Result<Prepared, StudioError> {
        let key = SourceKey::of(document);
        if let Some((known, prepared)) = &self.source
            && *known == key
        {
            return Ok(prepared.clone());
        }
        let prepared = Prepared::source(document, &self.folder, &self.media)?;
        self.source = Some((key, prepared.clone()));
        Ok(prepared)
    }

    fn work(&mut self, job: Job) {
        let done = self.solve(&job);
        let mut work = self.inbox.lock();
        work.current = None;
        let stopped = work.cancelled.contains(&job.id);
        work.cancelled.retain(|id| *id != job.id);
        let outcome = match done {
            Ok(ids) => Ok(ids),
            Err(StudioError::Align(AlignError::Cancelled)) if !stopped && !work.stop => {
                // A pen was in the way. What follows a change follows the next one.
                if job.automatic {
                    let newer = work.settle.is_some();
                    if !newer {
                        work.settle = Some((job.document.clone(), job.revision, Instant::now()));
                    }
                    Err(None)
                } else {
                    work.jobs.push_back(job);
                    return;
                }
            }
            Err(StudioError::Align(AlignError::Cancelled)) => Err(None),
            Err(error) => Err(Some(error)),
        };
        let Some(state) = work.states.iter_mut().find(|state| state.id == job.id) else { return };
        match &outcome {
            Ok(ids) => {
                state.state = JobStatus::Done;
                state.done = state.total;
                state.result = ids.first().cloned();
                state.results.clone_from(ids);
            }
            Err(None) => state.state = JobStatus::Cancelled,
            Err(Some(error)) => {
                state.state = JobStatus::Failed;
                state.error = Some(error.to_string());
            }
        }
        let state = state.clone();
        drop(work);
        self.events.send(Event::Job(state));
        match outcome {
            Ok(ids) => {
                let chosen = if job.kind == JobKind::Solve { ids.first() } else { None };
                if let Some(id) = chosen {
                    let result = lock(&self.results).get(id);
                    if let Some(result) = result {
                        self.shown.send_replace(Some(Shown::Poses(Arc::new(result.poses()))));
                    }
                    let job = (!job.automatic).then(|| job.id.clone());
                    self.events.send(Event::Result { id: id.clone(), revision: self.revision_of(id), job });
                }
            }
            Err(Some(error)) if job.automatic => self.events.send(Event::problem(&error)),
            Err(_) => {}
        }
    }

    fn revision_of(&self, id: &str) -> u32 {
        lock(&self.results).get(id).map_or(0, |result| result.facts.revision)
    }

    fn solve(&mut self, job: &Job) -> Result<Vec<String>, StudioError> {
        let document = &job.document;
        let prepared = self.prepared(document)?;
        let (control, mut options) = prepared.wishes(document, &self.folder, &self.media)?;
        options.threads = self.threads;
        let mut told = Instant::now();
        let observer = &mut |progress: Progress| self.progress(job, progress, &mut told);
        let chosen = document.settings.solution;
        let (solutions, several) = match job.kind {
            JobKind::Solve if chosen == 0 => {
                let alignment = align(&prepared.takes, &control, &options, observer)?;
                (vec![Alternative { alignment, objective: 0.0, distance: 0.0 }], false)
            }
            JobKind::Solve => {
                let mut all = alternatives(&prepared.takes, &control, &options, chosen + 1, observer)?;
                let one = all.swap_remove(chosen.min(all.len() - 1));
                (vec![one], true)
            }
            JobKind::Alternatives { most } => {
                (alternatives(&prepared.takes, &control, &options, most, observer)?, true)
            }
        };
        solutions
            .into_iter()
            .map(|solution| self.finish(solution, several, job, &prepared, &options))
            .collect()
    }

    fn finish(
        &self,
        solution: Alternative,
        several: bool,
        job: &Job,
        prepared: &Prepared,
        options: &Options,
    ) -> Result<String, StudioError> {
        let document = &job.document;
        let mut written_as = prepared.written_as.clone();
        let (clip, notes) =
            over_ground(solution.alignment.clip.clone(), &document.settings, Some(&mut written_as))?;
        let id = lock(&self.results).new_id();
        let origin = Origin {
            id: id.clone(),
            revision: job.revision,
            document,
            map: &prepared.map,
            options,
            written_as,
        };
        let result = Finished::of(solution, clip, several, notes, origin);
        lock(&self.results).put(Arc::new(result));
        Ok(id)
    }

    fn progress(&self, job: &Job, progress: Progress, told: &mut Instant) -> ControlFlow<()> {
        let mut work = self.inbox.lock();
        if work.stop || work.cancelled.contains(&job.id) || work.live.is_some() {
            return ControlFlow::Break(());
        }
        // A newer document is there.
        if job.automatic && work.settle.as_ref().is_some_and(|(_, revision, _)| *revision != job.revision) {
            return ControlFlow::Break(());
        }
        if let Some(state) = work.states.iter_mut().find(|state| state.id == job.id) {
            state.see(progress);
            if told.elapsed() >= TELL {
                *told = Instant::now();
                let state = state.clone();
                drop(work);
                self.events.send(Event::Job(state));
            }
        }
        ControlFlow::Continue(())
    }
}

fn answer_bytes(answer: LiveAnswer, live: &Live, counted: &[u32], rate: f64) -> Result<Vec<u8>, StudioError> {
    let settings = &live.document.settings;
    let (clip, _) = over_ground(answer.clip, settings, None)?;
    let used: Vec<u32> = (0..answer.weights.rows())
        .map(|row| {
            let row = answer.weights.row(row).iter().enumerate();
            let best = row.max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(column, _)| column);
            counted.get(best).copied().unwrap_or(0)
        })
        .collect();
    let head = PoseHead {
        stroke: live.stroke.0,
        message: live.stroke.1,
        level: answer.level as u16,
        levels: answer.levels as u16,
        is_final: answer.is_final,
        warm: answer.warm,
        milliseconds: live.arrived.elapsed().as_secs_f32() * 1000.0,
        sample_rate: rate as f32,
        ..PoseHead::of(PoseKind::Live, live.revision, settings.cyclic)
    };
    Ok(encode(&clip, &head, &used))
}

fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}
