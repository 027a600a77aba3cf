//! The thread on which animations are made, one at a time, beside the one that solves: a pen never waits for it.

use super::{BoardExact, BoardProgress, MadeBoard, MadeFrame, NotMade, Storyboarder};
use crate::events::{Event, JobState, JobStatus};
use crate::studio::Studio;
use crate::{StudioError, studio};
use inkrig_sketch::storyboard::Storyboard;
use serde::Serialize;
use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use utoipa::ToSchema;

/// Jobs that are remembered.
const MOST_JOBS: usize = 50;

/// What makes animations, and what came of it.
#[derive(Debug, Default)]
pub(crate) struct Boards {
    maker: Option<Arc<dyn Storyboarder>>,
    work: Mutex<Work>,
    /// Held by the thread that makes one.
    turn: Mutex<()>,
}

#[derive(Debug, Default)]
struct Work {
    next: u64,
    states: VecDeque<JobState>,
    /// The job whose result is put into the project just now: it can no longer be stopped.
    finishing: Option<String>,
    made: Option<Arc<BoardMade>>,
}

/// The newest animation of this run of the program.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub(crate) struct BoardMade {
    /// The job.
    job: String,
    /// Id of the clip.
    clip: String,
    /// What is told of each frame.
    frames: Vec<MadeFrame>,
    /// What the user should know of the whole.
    notes: Vec<String>,
}

impl Boards {
    pub(crate) fn new(maker: Option<Arc<dyn Storyboarder>>) -> Self {
        Self { maker, ..Self::default() }
    }

    /// Words to suggest; `None` where this program makes no animations.
    pub(crate) fn words(&self) -> Option<Vec<String>> {
        self.maker.as_ref().map(|maker| maker.words())
    }

    pub(crate) fn job(&self, id: &str) -> Option<JobState> {
        self.lock().states.iter().find(|state| state.id == id).cloned()
    }

    /// The job that runs.
    pub(crate) fn current(&self) -> Option<JobState> {
        self.lock().running().cloned()
    }

    pub(crate) fn made(&self) -> Option<Arc<BoardMade>> {
        self.lock().made.clone()
    }

    /// Stops a job; `None` when there is none. What it makes from now on is thrown away.
    pub(crate) fn cancel(&self, id: &str) -> Option<JobState> {
        let mut work = self.lock();
        let finishing = work.finishing.as_deref() == Some(id);
        let state = work.states.iter_mut().find(|state| state.id == id)?;
        if state.state == JobStatus::Running && !finishing {
            state.state = JobStatus::Cancelled;
        }
        Some(state.clone())
    }

    /// Begins to make an animation, which becomes a clip of the project.
    pub(crate) fn begin(
        studio: &Arc<Studio>,
        board: Storyboard,
        exact: BoardExact,
    ) -> Result<JobState, StudioError> {
        let boards = &studio.boards;
        let maker = boards.maker.clone().ok_or_else(|| {
            StudioError::invalid(
                "this program makes no animations of storyboards: it was built without a model",
            )
        })?;
        let mut work = boards.lock();
        if work.running().is_some() {
            return Err(StudioError::invalid("a storyboard is being made already: stop it first"));
        }
        work.next += 1;
        let state = JobState::named(format!("b{}", work.next), "storyboard");
        work.states.push_back(state.clone());
        while work.states.len() > MOST_JOBS {
            work.states.pop_front();
        }
        drop(work);
        let (studio, id) = (studio.clone(), state.id.clone());
        let spawned = std::thread::Builder::new().name("storyboard".into()).spawn(move || {
            let boards = &studio.boards;
            // One that was stopped may not have come to where it looks.
            let _turn = boards.turn.lock().unwrap_or_else(PoisonError::into_inner);
            let making = AssertUnwindSafe(|| {
                maker.make(&board, exact, &mut |progress| boards.progress(&studio, &id, progress))
            });
            let done = catch_unwind(making)
                .unwrap_or_else(|_| Err(NotMade::Failed("the model failed: this should not happen".into())));
            boards.finish(&studio, &id, &board.title, done);
        });
        if let Err(cause) = spawned {
            boards.cancel(&state.id);
            return Err(StudioError::Internal(cause.to_string()));
        }
        Ok(state)
    }

    fn progress(&self, studio: &Studio, id: &str, progress: BoardProgress) -> ControlFlow<()> {
        let mut work = self.lock();
        let Some(state) = work.states.iter_mut().find(|state| state.id == id) else {
            return ControlFlow::Break(());
        };
        if state.state != JobStatus::Running {
            return ControlFlow::Break(());
        }
        (state.done, state.total) = (progress.done, progress.total);
        (state.level, state.levels) = (progress.frame, progress.frames);
        let state = state.clone();
        drop(work);
        studio.events.send(Event::Job(state));
        ControlFlow::Continue(())
    }

    fn finish(&self, studio: &Studio, id: &str, title: &str, done: Result<MadeBoard, NotMade>) {
        let mut work = self.lock();
        let stopped = work.states.iter().any(|state| state.id == id && state.state != JobStatus::Running);
        let done = if stopped { Err(NotMade::Stopped) } else { done };
        if done.is_ok() {
            work.finishing = Some(id.to_string());
        }
        drop(work);
        let done = done.and_then(|made| {
            let kept = studio.add_made(title, &made.bvh);
            kept.map(|clip| (clip, made)).map_err(|error| NotMade::Failed(error.to_string()))
        });
        let mut work = self.lock();
        work.finishing = None;
        let Some(state) = work.states.iter_mut().find(|state| state.id == id) else { return };
        let made = match done {
            Ok((clip, MadeBoard { frames, notes, .. })) => {
                state.state = JobStatus::Done;
                state.done = state.total;
                state.result = Some(clip.clone());
                state.results = vec![clip.clone()];
                Some(Arc::new(BoardMade { job: id.to_string(), clip, frames, notes }))
            }
            Err(NotMade::Stopped) => {
                state.state = JobStatus::Cancelled;
                None
            }
            Err(NotMade::Failed(why)) => {
                state.state = JobStatus::Failed;
                state.error = Some(why);
                None
            }
        };
        let state = state.clone();
        if made.is_some() {
            work.made = made;
        }
        drop(work);
        studio.events.send(Event::Job(state));
    }

    fn lock(&self) -> MutexGuard<'_, Work> {
        studio::lock(&self.work)
    }
}

impl Work {
    fn running(&self) -> Option<&JobState> {
        self.states.iter().rev().find(|state| state.state == JobStatus::Running)
    }
}
